#define_import_path dolomite::blocks::edited

// Whether heights that count for a block may be others, by where the ground was edited. CPU reference: meets in
// plugins/ground/src/blocks/changed.rs.

#import dolomite::detail::bindings::detail

// Cells about a block that are sampled with it, and one for the windows of a map: RING in changed.rs.
const RING: u32 = 4u;

fn is_edited(centre: vec2<u32>, half: u32) -> bool {
    // Sixteen cells are a side.
    let cell = half / 8u;
    var found = false;
    for (var k = 0u; k < detail.edited_count; k++) {
        let rect = detail.edited[k];
        let reach = vec2(half + cell * select(RING, rect.wide_cells, half >= rect.wide_from));
        found = found || (all(centre - min(centre, reach) <= rect.high) && all(centre + reach >= rect.low));
    }
    return found;
}
