#define_import_path dolomite::stage::counts

// Shapes and sizes of items, from the words of the work buffer. The buffer is bound here for the
// passes that read or write it without atomics.

#import dolomite::stage::types::{Rules, Shape, ONE, ISOLINES, TRIANGLES}
#import dolomite::stage::api::{stage, tables, PATCH_WORDS, WHOLE_SIDE}
#import dolomite::stage::level::{lift_inner, segments, shape_from_levels}
#import dolomite::stage::rules::stage_rules
#import dolomite::stage::shape::{corner_count, inner_vertices, primitive_count}
#import dolomite::stage::work::{EDGE_NUMBER, corner_word, edge_word, inner_word, lower}

#ifdef STAGE_READ
@group(0) @binding(3) var<storage, read> work: array<u32>;
#else
@group(0) @binding(3) var<storage, read_write> work: array<u32>;
#endif

// Level of an edge, lowered to `share`.
fn edge_level_of(rules: Rules, word: u32, share: u32) -> u32 {
    return lower(rules, work[edge_word(stage, word & EDGE_NUMBER)], share);
}

// The shape of patch `id`, which is not discarded, with levels lowered to `share`.
fn patch_shape(rules: Rules, id: u32, share: u32) -> Shape {
    let at = inner_word(stage, id);
    let inner = vec2(work[at], work[at + 1u]);
    if rules.domain == ISOLINES {
        return shape_from_levels(rules, vec4(lower_lines(rules, inner.x, share), lower(rules, inner.y, share), ONE, ONE), vec2(ONE));
    }
    let own = stage.patch_table + id * PATCH_WORDS + 8u;
    var outer = vec4(ONE);
    outer.x = edge_level_of(rules, tables[own], share);
    outer.y = edge_level_of(rules, tables[own + 1u], share);
    outer.z = edge_level_of(rules, tables[own + 2u], share);
    if rules.domain != TRIANGLES {
        outer.w = edge_level_of(rules, tables[own + 3u], share);
    }
    let lowered = vec2(lower(rules, inner.x, share), lower(rules, inner.y, share));
#ifdef STAGE_SPLIT
    // A split side has two segments at least.
    var whole = outer;
    for (var side = 0u; side < corner_count(rules.domain); side++) {
        if tables[own + 4u + side] != WHOLE_SIDE {
            whole[side] = max(outer[side], 2u * ONE);
        }
    }
    var shape = shape_from_levels(rules, outer, lift_inner(rules, whole, lowered));
    for (var side = 0u; side < corner_count(rules.domain); side++) {
        if tables[own + 4u + side] != WHOLE_SIDE {
            let second = segments(edge_level_of(rules, tables[own + 8u + side], share), rules.spacing);
            shape.first[side] = shape.sides[side];
            shape.sides[side] += second;
        }
    }
    return shape;
#else
    return shape_from_levels(rules, outer, lift_inner(rules, outer, lowered));
#endif
}

// The number of lines has equal spacing.
fn lower_lines(rules: Rules, level: u32, share: u32) -> u32 {
    return lower(Rules(rules.domain, 0u, rules.mode), level, share);
}

// Vertices and primitives of a patch's shape.
fn shape_size(rules: Rules, shape: Shape) -> vec2<u32> {
    return vec2(inner_vertices(rules.domain, shape), primitive_count(rules.domain, shape));
}

// The segments of a patch as `place` left them; its levels are not filled in.
fn placed_shape(id: u32) -> Shape {
    let at = inner_word(stage, id);
    let sides = work[at + 2u];
    let rows = work[at + 3u];
    var shape: Shape;
    shape.sides = (vec4(sides) >> vec4(0u, 8u, 16u, 24u)) & vec4(255u);
    shape.rows = (vec2(rows) >> vec2(0u, 8u)) & vec2(255u);
#ifdef STAGE_SPLIT
    shape.first = (vec4(work[at + 4u]) >> vec4(0u, 8u, 16u, 24u)) & vec4(255u);
#endif
    return shape;
}

// Vertices of a corner or an edge; it has no primitives.
fn outline_size(item: u32, share: u32) -> vec2<u32> {
    let rules = stage_rules();
    // The words of the edges lie behind those of the corners.
    let word = work[corner_word(item)];
    let inside = segments(lower(rules, word, share), rules.spacing) - 1u;
    return vec2(select(inside, word, item < stage.corners || word == 0u), 0u);
}

// Vertices and primitives of an item.
fn item_size(item: u32, share: u32) -> vec2<u32> {
    let rules = stage_rules();
    if item < stage.corners + stage.edges {
        return outline_size(item, share);
    }
    let id = item - stage.corners - stage.edges;
    if id >= stage.patches || work[inner_word(stage, id)] == 0u {
        return vec2(0u);
    }
    return shape_size(rules, patch_shape(rules, id, share));
}
