#define_import_path dolomite::geometry::user_material

// What stands where a user's material function goes: the row of the table that the vertex chose.

#import dolomite::geometry::draw_types::{Shaded, Surface, table_material}

fn material(surface: Surface) -> Shaded {
    return table_material(surface);
}
