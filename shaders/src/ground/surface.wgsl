#define_import_path dolomite::ground::surface

// The ground's material as a draw asks for it.

#import dolomite::geometry::draw_types::{Shaded, Surface, geometry_draw}
#import dolomite::ground::types::GroundView
#import dolomite::ground::material::ground_surface

fn material(surface: Surface) -> Shaded {
    let given = geometry_draw.numbers;
    let view = GroundView(geometry_draw.camera, geometry_draw.time, geometry_draw.anchor.xz, given[3].xy, given[0], given[1], given[2]);
    return ground_surface(view, surface, geometry_draw.anchor.y);
}
