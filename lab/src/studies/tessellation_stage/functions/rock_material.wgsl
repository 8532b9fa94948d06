#define_import_path dolomite::geometry::user_material

// The very function of assets/shaders/rock.wgsl.

#import dolomite::geometry::draw_types::{Shaded, Surface}
#import dolomite::lab::rock

fn material(surface: Surface) -> Shaded {
    return rock::material(surface);
}
