//! The quadtree's promises: an exact cover, balanced, the same from the same focus; and no crack
//! in what the CPU reference makes of it.

use crate::support;

use bevy::math::{DVec2, DVec3};
use dolomite_ground::cover::lattice::Lattice;
use dolomite_terrain::GroundRect;
use dolomite_tessellation::coordinate::side_coordinate;
use dolomite_tessellation::patches::{REVERSED, WHOLE};
use dolomite_tessellation::{Domain, Levels};
use support::{POOLS, Random, Scene, TESSELLATOR, cover, cracks, random_scene, terrain, view};

fn lattice() -> Lattice {
    Lattice::new(
        GroundRect::new(DVec2::new(-15_000.0, 3.0), DVec2::new(15_010.0, 31_900.0)),
        16.0,
    )
}

#[test]
fn leaves_cover_the_extent_once() {
    let lattice = lattice();
    let mut random = Random(1);
    for _ in 0..50 {
        let focus = DVec2::new(random.within(-2e4, 2e4), random.within(-5e3, 4e4));
        let leaves = lattice.leaves(focus, random.within(0.0, 500.0), random.within(1.5, 4.0));
        let area: u64 = leaves
            .iter()
            .map(|leaf| u64::from(leaf.side) * u64::from(leaf.side))
            .sum();
        let steps = lattice.steps();
        assert_eq!(
            area,
            u64::from(steps.x) * u64::from(steps.y),
            "areas add up"
        );
        let mut corners: Vec<_> = leaves.iter().map(|leaf| leaf.corner.to_array()).collect();
        corners.sort_unstable();
        corners.dedup();
        assert_eq!(corners.len(), leaves.len(), "no leaf twice");
    }
}

#[test]
fn neighbours_differ_by_one_level_at_most() {
    let lattice = lattice();
    let ground = terrain(1);
    let mut random = Random(2);
    for round in 0..100 {
        let focus = DVec2::new(random.within(-2e4, 2e4), random.within(-5e3, 4e4));
        let leaves = lattice.leaves(focus, random.within(0.0, 300.0), random.within(1.5, 3.0));
        // Where neighbours differ by more, an edge of the finer one has no patch on its other side,
        // though it does not lie on the extent's border.
        let patches = cover(&ground, &lattice, &leaves);
        let topology = patches.mesh.topology();
        let mut beside = vec![0; topology.edges.len()];
        for (patch, halves) in topology.patches.iter().zip(&topology.halves) {
            let seconds = halves[4..].iter().filter(|word| **word != WHOLE);
            for word in patch[4..].iter().chain(seconds) {
                beside[(word & !REVERSED) as usize] += 1;
            }
        }
        let steps = lattice.steps();
        for (owner, beside) in topology.edges.iter().zip(beside) {
            let leaf = leaves[(owner >> 2) as usize];
            let on_border = match owner & 3 {
                0 => leaf.corner.x == 0,
                1 => leaf.corner.y + leaf.side == steps.y,
                2 => leaf.corner.x + leaf.side == steps.x,
                _ => leaf.corner.y == 0,
            };
            let due = if on_border { 1 } else { 2 };
            assert_eq!(beside, due, "round {round}: side {} of {leaf:?}", owner & 3);
        }
    }
}

#[test]
fn looking_away_and_back_gives_the_same_patches() {
    let lattice = lattice();
    let here = DVec2::new(1234.5, 8000.25);
    let before = lattice.leaves(here, 12.0, 2.0);
    let away = lattice.leaves(here + 5000.0, 12.0, 2.0);
    assert_ne!(before, away, "moving changes the patches");
    let again = lattice.leaves(here, 12.0, 2.0);
    assert_eq!(before, again);
    let ground = terrain(2);
    assert_eq!(
        cover(&ground, &lattice, &before),
        cover(&ground, &lattice, &again),
        "and their points, to the bit"
    );
}

fn drawn(scene: &Scene) -> Vec<bool> {
    let functions = scene.functions();
    (0..scene.patches.mesh.patches() as u32)
        .map(|patch| functions.control(patch).outer[0] > 0.0)
        .collect()
}

fn found_cracks(scene: &Scene, mesh: &dolomite_tessellation::MeshTessellation) -> Option<usize> {
    let positions: Vec<[f32; 3]> = scene
        .vertices(mesh)
        .iter()
        .map(|vertex| vertex.position.to_array())
        .collect();
    cracks(
        &scene.patches,
        &drawn(scene),
        &mesh.edge_segments,
        &positions,
        mesh.primitives.triangles(),
    )
}

#[test]
fn meshes_of_random_cameras_have_no_crack() {
    let terrain = terrain(4);
    let mut random = Random(5);
    for round in 0..60 {
        let scene = random_scene(&mut random, &terrain, 64.0);
        let mesh = scene.tessellate(POOLS);
        assert_eq!(found_cracks(&scene, &mesh), Some(0), "round {round}");
    }
}

#[test]
fn the_search_sees_a_crack() {
    let terrain = terrain(2);
    let scene = random_scene(&mut Random(6), &terrain, 256.0);
    let mesh = TESSELLATOR.tessellate_mesh(&scene.patches.mesh, |_| Levels::uniform(4.0), POOLS);
    let all = vec![true; scene.patches.mesh.patches()];
    let mut positions: Vec<[f32; 3]> = scene
        .vertices(&mesh)
        .iter()
        .map(|vertex| vertex.position.to_array())
        .collect();
    let mut triangles = mesh.primitives.triangles().to_vec();
    let search = |positions: &[[f32; 3]], triangles: &[[u32; 3]]| {
        cracks(
            &scene.patches,
            &all,
            &mesh.edge_segments,
            positions,
            triangles,
        )
    };
    assert_eq!(search(&positions, &triangles), Some(0));
    // A second vertex, one bit higher, for one triangle only.
    let middle = triangles.len() / 2;
    let mut moved = positions[triangles[middle][0] as usize];
    moved[1] = f32::from_bits(moved[1].to_bits() + 1);
    positions.push(moved);
    triangles[middle][0] = positions.len() as u32 - 1;
    assert_ne!(search(&positions, &triangles), Some(0));
}

/// Positions that the patches on both sides of an edge would give to its vertices, each from its own
/// corners, and how many differ.
fn mismatches_without_owners(scene: &Scene) -> usize {
    let topology = scene.patches.mesh.topology();
    let functions = scene.functions();
    let unit = 1.0 / (1 << 24) as f32;
    // Of each edge: the patch sides that are wholly along it.
    let mut sides: Vec<Vec<(u32, u32, bool)>> = vec![Vec::new(); topology.edges.len()];
    for (patch, (own, halves)) in (0_u32..).zip(topology.patches.iter().zip(&topology.halves)) {
        for side in 0..4_u32 {
            if halves[side as usize] == WHOLE {
                let word = own[4 + side as usize];
                sides[(word & !REVERSED) as usize].push((patch, side, word & REVERSED != 0));
            }
        }
    }
    let segments = 13;
    sides
        .iter()
        .filter(|sides| sides.len() == 2)
        .map(|sides| {
            let outline = |&(patch, side, reversed): &(u32, u32, bool)| {
                (1..segments)
                    .map(|i| {
                        let i = if reversed { segments - i } else { i };
                        let place = (i * (1 << 24)) / segments;
                        let at = side_coordinate(Domain::Quads, side, place);
                        let at = bevy::math::Vec2::new(at[0] as f32, at[1] as f32) * unit;
                        functions
                            .evaluate(patch, at)
                            .position
                            .to_array()
                            .map(f32::to_bits)
                    })
                    .collect::<Vec<_>>()
            };
            let (one, other) = (outline(&sides[0]), outline(&sides[1]));
            one.iter().zip(&other).filter(|(a, b)| a != b).count()
        })
        .sum()
}

#[test]
fn edges_without_an_owner_would_crack() {
    let terrain = terrain(1);
    let mut random = Random(4);
    let found: usize = (0..20)
        .map(|_| mismatches_without_owners(&random_scene(&mut random, &terrain, 64.0)))
        .sum();
    assert!(
        found > 0,
        "computing an edge from each patch's own corners must differ somewhere"
    );
}

#[test]
fn what_is_behind_the_camera_emits_nothing() {
    let terrain = terrain(2);
    let extent = terrain.extent();
    let lattice = Lattice::new(extent, 64.0);
    // Outside the extent, its back to it.
    let eye = DVec3::new(extent.max.x + 500.0, 300.0, extent.centre().y);
    let leaves = lattice.leaves(DVec2::new(eye.x, eye.z), 300.0, 2.0);
    let scene = Scene {
        patches: cover(&terrain, &lattice, &leaves),
        view: view(eye, -std::f64::consts::FRAC_PI_2, 0.0, 8.0),
        relief: 400.0,
        terrain,
    };
    let mesh = scene.tessellate(POOLS);
    assert_eq!((mesh.vertices.len(), mesh.primitives.len()), (0, 0));
    assert_eq!(mesh.discarded as usize, leaves.len());
}

#[test]
fn small_pools_lower_all_levels_and_are_never_overrun() {
    let terrain = terrain(2);
    let mut random = Random(8);
    let (scene, full) = loop {
        let scene = random_scene(&mut random, &terrain, 64.0);
        let full = scene.tessellate(POOLS);
        // Some look at the sky.
        if full.vertices.len() > 10_000 {
            break (scene, full);
        }
    };
    assert_eq!(full.lowered, 0);
    let third = full.vertices.len() as u32 / 3;
    let less = scene.tessellate([third, POOLS[1]]);
    assert!(less.lowered > 0 && less.vertices.len() as u32 <= third);
    assert_eq!(
        found_cracks(&scene, &less),
        Some(0),
        "lowered levels crack no more"
    );
}

#[test]
fn ground_under_deep_water_is_two_triangles_a_patch() {
    let terrain = terrain(2);
    let mut scene = random_scene(&mut Random(9), &terrain, 64.0);
    let lattice = Lattice::new(terrain.extent(), 64.0);
    let centre = terrain.extent().centre();
    let leaves = lattice.leaves(centre, 5.0, 2.0);
    // All of it 100 m below the sea, by its bounds.
    scene.patches = dolomite_ground::cover::GroundPatches::new(
        &lattice,
        &leaves,
        |_| (-120.0, -100.0),
        |points| vec![-110.0; points.len()],
    )
    .expect("a balanced quadtree");
    scene.view = view(DVec3::new(centre.x, 30.0, centre.y), 0.3, -0.4, 8.0);
    let mesh = scene.tessellate(POOLS);
    let whole = |halves: &[u32; 8]| halves.iter().all(|word| *word == WHOLE);
    let topology = scene.patches.mesh.topology();
    let plain = drawn(&scene)
        .iter()
        .zip(&topology.halves)
        .filter(|(drawn, halves)| **drawn && whole(halves))
        .count();
    let split = drawn(&scene)
        .iter()
        .zip(&topology.halves)
        .filter(|(drawn, halves)| **drawn && !whole(halves))
        .count();
    assert!(plain > 10 && mesh.primitives.len() >= 2 * plain);
    // A patch with split sides has three inner segments each way, the least odd number above one:
    // 2 triangles in the middle, 4 more on its outline, one for each of up to 8 edges.
    assert!(mesh.primitives.len() <= 2 * plain + 14 * split);
}
