#define_import_path dolomite::geometry::user_material

// Stands in for the file of this name: the ground's material in every draw.

#import dolomite::geometry::draw_types::{Shaded, Surface}
#import dolomite::ground::surface::material as ground_material

fn material(surface: Surface) -> Shaded {
    return ground_material(surface);
}
