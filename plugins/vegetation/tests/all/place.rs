//! Roots on the GPU are those of the CPU, to the bit.

use dolomite_vegetation::place::{Lattice, RANK_BITS, threshold};

use super::support::{Random, probe, run};

const PROBE: &str = "
#import dolomite::vegetation::place::{clump_of, first_root, local_place, root_of, threshold}
@group(0) @binding(0) var<storage, read> given: array<u32>;
@group(0) @binding(1) var<storage, read_write> found: array<u32>;
@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if 13u * id.x >= arrayLength(&found) { return; }
    let at = 6u * id.x;
    let seed = given[at];
    let cell = vec2(bitcast<i32>(given[at + 1u]), bitcast<i32>(given[at + 2u]));
    let level = given[at + 3u];
    let size = given[at + 4u];
    let root = root_of(seed, cell);
    let first = first_root(seed, cell >> vec2(level), level);
    let clump = clump_of(root, seed + 1u, size);
    let local = local_place(root, bitcast<i32>(given[at + 5u]), vec2(5, -7));
    let out = array(root.at, root.rank, root.hash, bitcast<u32>(first.cell.x), bitcast<u32>(first.cell.y),
        first.at, first.rank, clump.hash, clump.near, clump.next, bitcast<u32>(local.x), bitcast<u32>(local.y),
        threshold(bitcast<f32>(seed)));
    for (var k = 0u; k < 13u; k++) { found[13u * id.x + k] = out[k]; }
}
";

/// The least rank below a cell of a level, found by looking at all; small levels alone.
fn least(lattice: Lattice, cell: [i32; 2], level: u32) -> ([i32; 2], u32, u32) {
    let side = 1 << level;
    let [x, z] = cell.map(|k| (k >> level) << level);
    let all = (0..side * side).map(|k| lattice.root([x + k % side, z + k / side]));
    let root = all
        .min_by_key(|root| root.rank >> (RANK_BITS - 16))
        .expect("some");
    (root.cell, root.at, root.rank)
}

#[test]
fn roots_are_the_same_to_the_bit() {
    let Some(gpu) = dolomite_testkit::gpu::for_test() else {
        return;
    };
    let kernel = probe(&gpu, PROBE, "probe");
    let mut random = Random(3);
    let count = 4096;
    let given: Vec<[u32; 6]> = (0..count)
        .map(|k| {
            let near = !random.bits().is_multiple_of(3);
            let mut cell = || {
                let bits = random.bits();
                if near { bits % 4096 } else { bits }
                    .cast_signed()
                    .wrapping_sub(2048)
            };
            let cell = [cell(), cell()].map(i32::cast_unsigned);
            let pitch: i32 = k % 13 - 6;
            [
                random.bits(),
                cell[0],
                cell[1],
                random.bits() % 5,
                random.bits() % 13,
                pitch.cast_unsigned(),
            ]
        })
        .collect();
    let words: Vec<u32> = given.iter().flatten().copied().collect();
    let found = run(&gpu, &kernel, &words, given.len(), 13);
    for (given, found) in given.iter().zip(found.chunks(13)) {
        let [seed, x, z, level, size, pitch] = *given;
        let pitch_log2 = pitch.cast_signed();
        let lattice = Lattice { seed, pitch_log2 };
        let cell = [x, z].map(u32::cast_signed);
        let root = lattice.root(cell);
        assert_eq!(found[..3], [root.at, root.rank, root.hash], "{given:?}");
        let (first, at, rank) = least(lattice, cell, level);
        let [fx, fz] = first.map(i32::cast_unsigned);
        assert_eq!(found[3..7], [fx, fz, at, rank], "first of {given:?}");
        let clump = lattice.clump(root, seed.wrapping_add(1), size);
        assert_eq!(
            found[7..10],
            [clump.hash, clump.near, clump.next],
            "clump of {given:?}"
        );
        // In steps of 2^-12 m, rounded down, wrapping.
        let [px, pz] = lattice.place(root).to_fixed().map(|k| (k >> 20) as u32);
        assert_eq!(
            found[10..12],
            [px.wrapping_sub(5), pz.wrapping_add(7)],
            "place of {given:?}"
        );
        assert_eq!(
            found[12],
            threshold(f32::from_bits(seed)),
            "threshold of {seed}"
        );
    }
}
