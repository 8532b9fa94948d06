//! Whether triangles hold places is decided on the GPU as by 128-bit integers.

use dolomite_vegetation::render::edges::holds;

use super::support::{Random, probe, run};

const PROBE: &str = "
#import dolomite::vegetation::edges::{holds, side_of}
@group(0) @binding(0) var<storage, read> given: array<vec2<i32>>;
@group(0) @binding(1) var<storage, read_write> found: array<u32>;
@compute @workgroup_size(64)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&found) { return; }
    let at = 4u * id.x;
    let a = given[at];
    var b = given[at + 1u];
    var c = given[at + 2u];
    let side = side_of(a, b, c);
    if side < 0 { let swapped = b; b = c; c = swapped; }
    found[id.x] = u32(side != 0 && holds(a, b, c, given[at + 3u]));
}
";

#[test]
fn the_gpu_decides_as_exact_integers_do() {
    let Some(gpu) = dolomite_testkit::gpu::for_test() else {
        return;
    };
    let kernel = probe(&gpu, PROBE, "probe");
    let mut random = Random(9);
    let count = 16384;
    // Small grids, where places lie on edges and corners; large ones; and multiples of small ones, on edges that no f32
    // tells apart.
    let given: Vec<[[i32; 2]; 4]> = (0..count)
        .map(|k| {
            let (range, scale) = [(7, 1), (1 << 24, 1), (7, 70_000_001), (1 << 29, 1)][k % 4];
            std::array::from_fn(|_| {
                std::array::from_fn(|_| {
                    let bits = random.bits() % (2 * range);
                    (bits.cast_signed() - range.cast_signed()) * scale
                })
            })
        })
        .collect();
    let words: Vec<u32> = given
        .iter()
        .flatten()
        .flatten()
        .map(|k| k.cast_unsigned())
        .collect();
    let found = run(&gpu, &kernel, &words, given.len(), 1);
    let mut inside = 0;
    for ([a, b, c, p], found) in given.iter().zip(found) {
        let expected = holds([*a, *b, *c], *p);
        assert_eq!(found == 1, expected, "{a:?} {b:?} {c:?} {p:?}");
        inside += usize::from(expected);
    }
    assert!(inside > count / 20, "{inside} were inside");
}
