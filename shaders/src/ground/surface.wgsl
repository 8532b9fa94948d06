#define_import_path dolomite::ground::surface

// The ground's material as a draw asks for it.

#import dolomite::geometry::draw_types::{Shaded, Surface, geometry_draw}
#import dolomite::ground::types::GroundView
#import dolomite::ground::material::ground_surface

// Of a picture of 1080 rows through the view's lens: a metre away, and anywhere.
fn standard_pixel() -> vec2<f32> {
    let clip = geometry_draw.clip_from_anchor;
    let size = 2.0 / (1080.0 * length(vec3(clip[0].y, clip[1].y, clip[2].y)));
    return select(vec2(size, 0.0), vec2(0.0, size), clip[3].w == 1.0 && all(vec3(clip[0].w, clip[1].w, clip[2].w) == vec3(0.0)));
}

fn material(surface: Surface) -> Shaded {
    let given = geometry_draw.numbers;
    let view = GroundView(geometry_draw.camera, geometry_draw.time, standard_pixel(), geometry_draw.anchor.xz, given[3].xy, given[0], given[1], given[2]);
    return ground_surface(view, surface, geometry_draw.anchor.y);
}
