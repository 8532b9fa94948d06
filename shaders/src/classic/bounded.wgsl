#define_import_path dolomite::classic::bounded

// The classic scene whose triangles the terrain LOD makes: the same colours and the same light, from
// place and normal of a vertex.

#import dolomite::geometry::draw_types::{Shaded, Surface, geometry_draw}
#import dolomite::classic::look::{coloured, lit}

fn material(surface: Surface) -> Shaded {
    let seen = lit(surface.position + geometry_draw.anchor, surface.normal);
    return coloured(surface.normal, seen.x, seen.y);
}
