#define_import_path dolomite::stage::source

// What the vertices of an item have in common, and where each lies in the domain of its patch. One
// way for corners, edges and patches: software Vulkan runs every branch for every thread.

#import dolomite::stage::types::{Rules, UNIT, EQUAL, TRIANGLES, QUADS, ISOLINES, INNER}
#import dolomite::stage::api::{stage, tables}
#import dolomite::stage::coordinate::{ring_at, ring_place, side_coordinate}
#import dolomite::stage::counts::work
#import dolomite::stage::divide::divide_small
#import dolomite::stage::place::{place, stage_edge}
#import dolomite::stage::work::{SHARE, edge_word, inner_word, lower}

struct Source {
    // The patch that evaluates.
    id: u32,
    // Its side on which the vertices lie, or whose end the corner is; INNER for its inner vertices.
    side: u32,
    corner: bool,
    // Levels: of the edge; of the patch along u and v; of the segments and of the lines of isolines.
    levels: vec2<u32>,
}

// What stands behind the vertices of an item.
fn source_of(rules: Rules, item: u32) -> Source {
    let patches = stage.corners + stage.edges;
    if rules.domain == ISOLINES {
        let at = inner_word(stage, item);
        return Source(item, INNER, false, vec2(work[at + 1u], work[at]));
    }
    let inner = item >= patches;
    let corner = item < stage.corners;
    // Patch and side in one word; the owners of the edges stand behind those of the corners.
    let owner = tables[stage.corner_table + select(item, 0u, inner)];
    let id = select(owner >> 2u, item - patches, inner);
    let edge = edge_word(stage, select(item - stage.corners, 0u, corner));
    let at = select(edge, inner_word(stage, item - patches), inner);
    var levels = vec2(work[at]);
    levels.x = select(lower(rules, levels.x, work[SHARE]), levels.x, inner);
    if rules.domain == QUADS {
        levels.y = work[at + select(0u, 1u, inner)];
    }
    return Source(id, select(owner & 3u, INNER, inner), corner, levels);
}

// Where vertex `local` of the item lies, in units of 2^-24.
fn source_coordinate(rules: Rules, source: Source, local: u32) -> vec3<u32> {
    let edge = stage_edge(source.levels.x, rules.spacing);
    if rules.domain == ISOLINES {
        let columns = edge.count + 1u;
        let line = divide_small(local, columns);
        let across = stage_edge(source.levels.y, EQUAL);
        return vec3(place(edge, local - line * columns, rules.mode), place(across, line, rules.mode), 0u);
    }
    let inner = source.side == INNER;
    if rules.domain == TRIANGLES {
        let ring = ring_place(edge.count, local);
        var along = place(edge, select(local + 1u, ring.k + ring.i, inner), rules.mode);
        // Corner k is the end of side k.
        along = select(along, UNIT, source.corner);
        let outline = side_coordinate(rules.domain, source.side, along);
        return select(outline, ring_at(edge, ring, along, rules.mode), inner);
    }
    let columns = max(edge.count, 2u) - 1u;
    let row = divide_small(local, columns);
    var along = place(edge, 1u + select(local, local - row * columns, inner), rules.mode);
    along = select(along, UNIT, source.corner);
    let across = place(stage_edge(source.levels.y, rules.spacing), 1u + row, rules.mode);
    return select(side_coordinate(rules.domain, source.side, along), vec3(along, across, 0u), inner);
}
