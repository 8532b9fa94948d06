#define_import_path dolomite::vegetation::rank

// The rank of what a record draws. A record keeps the place of its root and not its rank, but the place tells the cell, and
// the cell the rank: right within 500 km of the world's origin.

#import dolomite::vegetation::draw_view::view
#import dolomite::vegetation::place::{cell_hash, rank_from}
#import dolomite::vegetation::types::Record

struct Ranks {
    // Of each kind: seed and pitch of its lattice, and bits of the density where it grows best.
    kinds: array<vec4<u32>, 8>,
}

@group(1) @binding(0) var<uniform> ranks: Ranks;

// The rank as a share of all ranks, and that below which ranks stand where the kind grows best.
fn rank_of(record: Record) -> vec2<f32> {
    let kind = ranks.kinds[record.layer];
    // A record counts in steps of 2^-12 m from the anchor, which stands on a whole metre.
    let steps = vec2<i32>(round(record.position.xz * 4096.0)) + (view.anchor << vec2(12u));
    let cell = steps >> vec2(u32(bitcast<i32>(kind.y) + 12));
    let rank = rank_from(kind.x, cell, cell_hash(kind.x, cell), 0u);
    return vec2(f32(rank) * 5.9604644775390625e-8, bitcast<f32>(kind.z));
}
