#define_import_path dolomite::detail::room

// How many vertices there is room for.

#import dolomite::detail::bindings::detail

fn corner_count() -> u32 {
    return (detail.roots.x + 1u) * (detail.roots.y + 1u);
}

// In halves, beside the corners of the roots, which are always there; of two triangles a vertex a few are
// spared.
fn room() -> u32 {
    let most = min(detail.max_vertices, detail.max_triangles / 2u);
    return 2u * (most - min(most, 2u * corner_count()));
}
