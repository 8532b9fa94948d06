//! The bound, and what it rests on.

use std::collections::HashMap;

use bevy::math::UVec2;

use super::grounds::{cameras, errors, fbm, island, triangles};
use crate::blocks::choose::{Limits, choose, settle};
use crate::blocks::kept::KeptBlocks;
use crate::blocks::mesh::mesh;
use crate::blocks::place::{
    CORNER_COUNT, CornerKind, VERTICES, centre_parents, corner_kind, corner_number, mixed_parents,
    vertex_at,
};
use crate::blocks::ratio::reach;
use crate::blocks::record::{ALWAYS, NEST};
use dolomite_terrain::Terrain;

/// Blocks of a terrain as several views made them.
pub fn looked_at(terrain: &Terrain, pixels: f32) -> KeptBlocks {
    let mut blocks = KeptBlocks::new(terrain.clone(), 0.125);
    for camera in cameras(terrain) {
        settle(&mut blocks, &camera.bound(pixels), Limits::default());
    }
    blocks
}

#[test]
fn no_error_is_above_the_bound_and_a_third_of_the_errors_is_too_little() {
    for terrain in [fbm(), island()] {
        let mut blocks = looked_at(&terrain, 2.0);
        let mut looked = 0;
        for (k, camera) in cameras(&terrain).into_iter().enumerate() {
            let choice = choose(&mut blocks, &camera.bound(2.0), Limits::default());
            assert_eq!(choice.coarsening, 1.0, "settled");
            let limit = 2.0 * f64::from(choice.held);
            let drawn = triangles(&blocks, &mesh(&blocks, &choice));
            let (largest, above, count) = errors(&terrain, &camera, limit, &drawn, 4000);
            assert_eq!(above, 0, "view {k}: {largest} of {limit} pixels");
            looked += count;
        }
        assert!(looked > 10_000, "{looked}");

        // The same by errors of a third as much.
        blocks.alter(|block| {
            for error in &mut block.errors {
                *error *= if *error == ALWAYS { 1.0 } else { 1.0 / 3.0 };
            }
        });
        let found: usize = cameras(&terrain)
            .into_iter()
            .map(|camera| {
                let none = Limits {
                    made: 0,
                    ..Limits::default()
                };
                let choice = choose(&mut blocks, &camera.bound(2.0), none);
                let drawn = triangles(&blocks, &mesh(&blocks, &choice));
                errors(&terrain, &camera, 2.0, &drawn, 4000).1
            })
            .sum();
        assert!(found > 10, "{found}");
    }
}

/// All that any block says of a vertex, by place.
type Known = HashMap<UVec2, [u32; 5]>;

/// How many vertices two blocks have different numbers of, and how many are not nested in their parents.
fn faults_of_records(blocks: &KeptBlocks) -> [usize; 4] {
    let mut known = Known::new();
    let mut differ = 0;
    for slot in blocks.used() {
        let (block, place) = (blocks.block(slot), blocks.place(slot));
        for number in 0..VERTICES {
            let numbers = [
                block.heights[number].to_bits(),
                block.gradients[number],
                block.errors[number].to_bits(),
                block.lows[number].to_bits(),
                block.highs[number].to_bits(),
            ];
            let at = place.lattice_point(vertex_at(number));
            differ += usize::from(*known.entry(at).or_insert(numbers) != numbers);
        }
    }
    let (mut errors, mut intervals, mut regions) = (0, 0, 0);
    for slot in blocks.used() {
        let place = blocks.place(slot);
        for number in 0..VERTICES {
            let at = vertex_at(number);
            let parents = match corner_kind(at / 2) {
                _ if number >= CORNER_COUNT => centre_parents(at / 2),
                CornerKind::Mixed => mixed_parents(at / 2),
                _ => continue,
            };
            let own = known[&place.lattice_point(at)];
            if f32::from_bits(own[2]) == ALWAYS {
                continue;
            }
            for parent in parents {
                // A neighbour that was not made says nothing; beyond the lattice there is none.
                let Some(parents) = known.get(&place.lattice_point(parent * 2)) else {
                    continue;
                };
                let f = f32::from_bits;
                errors += usize::from(f(own[2]) > NEST * f(parents[2]));
                intervals += usize::from(f(own[3]) < f(parents[3]) || f(own[4]) > f(parents[4]));
                let away = (parent * 2 - at).abs().max_element();
                let inside = (0..=16).contains(&parent.x) && (0..=16).contains(&parent.y);
                if inside && corner_number(parent) != corner_number(at / 2) {
                    regions += usize::from(reach(at) + away > reach(parent * 2));
                }
            }
        }
    }
    [differ, errors, intervals, regions]
}

#[test]
fn blocks_agree_on_what_they_share_and_everything_is_nested() {
    for terrain in [fbm(), island()] {
        let mut blocks = looked_at(&terrain, 6.0);
        assert!(blocks.len() > 60, "{}", blocks.len());
        assert_eq!(faults_of_records(&blocks), [0; 4]);
        // What was cut from above is known: seldom more than a few parts in a hundred.
        let cuts = blocks.cuts;
        assert!(cuts.cut < cuts.vertices / 3, "{cuts:?}");
        // Errors that grow on the way down, and intervals of small blocks that hold more than those of large ones.
        blocks.alter(|block| {
            for error in &mut block.errors {
                *error *= if *error > 0.1 && *error < 1.0 {
                    1.3
                } else {
                    1.0
                };
            }
            if block.head.half <= 256 {
                block.lows = block.lows.map(|low| low - 1.0);
            }
        });
        let [_, errors, intervals, _] = faults_of_records(&blocks);
        assert!(errors > 100 && intervals > 100, "{errors} {intervals}");
    }
}
