//! The quadtree's promises: an exact cover, balanced, the same from the same focus; and no crack
//! in what the twin makes of it.

mod support;

use bevy::math::{DVec2, DVec3};
use dolomite_terrain::{GroundPoint, GroundRect};
use dolomite_tessellation::cover::{Cover, Lattice};
use dolomite_tessellation::layout::{Edge, NONE, Patch};
use dolomite_tessellation::twin;
use support::{Random, cracks, params, random_view, terrain};

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
    let mut random = Random(2);
    for round in 0..100 {
        let focus = DVec2::new(random.within(-2e4, 2e4), random.within(-5e3, 4e4));
        let leaves = lattice.leaves(focus, random.within(0.0, 300.0), random.within(1.5, 3.0));
        let cover = Cover::new(&lattice, &leaves, |_| (0.0, 1.0));
        // Where neighbours differ by more, an edge of the finer one has no patch on its other
        // side, though it does not lie on the extent's border.
        let steps = lattice.steps();
        let border = |corner: u32| {
            let at = cover.corners[corner as usize];
            let point = GroundPoint {
                cell: at.cell.into(),
                frac: at.frac.into(),
            };
            [DVec2::ZERO.as_uvec2(), steps].map(|lattice_corner| {
                let limit = GroundPoint::new(lattice.position(lattice_corner));
                [
                    point.to_fixed()[0] == limit.to_fixed()[0],
                    point.to_fixed()[1] == limit.to_fixed()[1],
                ]
            })
        };
        for edge in cover.edges.iter().filter(|edge| edge.patches[1] == NONE) {
            let [a, b] = edge.corners.map(border);
            let on_border = (0..2).any(|end| (0..2).any(|axis| a[end][axis] && b[end][axis]));
            assert!(on_border, "round {round}: edge {edge:?} hangs");
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
    assert_eq!(before, lattice.leaves(here, 12.0, 2.0));
}

/// The outline of a patch along one side as the twin would index it: bits of the positions.
fn outline(cover: &Cover, edge: &Edge, own: impl Fn(&Edge, u32) -> [i64; 2]) -> Vec<[i64; 2]> {
    let corner = |c: u32| {
        let corner = &cover.corners[c as usize];
        GroundPoint {
            cell: corner.cell.into(),
            frac: corner.frac.into(),
        }
        .to_fixed()
    };
    let mut points = vec![corner(edge.corners[0])];
    points.extend((1..edge.level).map(|i| own(edge, i)));
    points.push(corner(edge.corners[1]));
    points
}

/// Vertex `i` of an edge as a patch that did not share it would compute it: from the patch's own
/// corner and size.
fn from_patch(cover: &Cover, patch: &Patch, edge: &Edge, i: u32) -> [i64; 2] {
    let point = |c: u32| {
        let corner = &cover.corners[c as usize];
        GroundPoint {
            cell: corner.cell.into(),
            frac: corner.frac.into(),
        }
    };
    let (low, high) = (point(patch.corners[0]), point(patch.corners[3]));
    let size = high.relative_to(low);
    let [from, to] = edge.corners.map(point);
    let start = from.relative_to(low) / size;
    let end = to.relative_to(low) / size;
    let t = start + (end - start) * (i as f32 / edge.level as f32);
    low.offset((size * t).as_dvec2()).to_fixed()
}

/// Vertex `i` of an edge as its owner computes it, as in `twin::emit`.
fn from_edge(cover: &Cover, edge: &Edge, i: u32) -> [i64; 2] {
    let point = |c: u32| {
        let corner = &cover.corners[c as usize];
        GroundPoint {
            cell: corner.cell.into(),
            frac: corner.frac.into(),
        }
    };
    let [from, to] = edge.corners.map(point);
    let length = to.relative_to(from);
    from.offset((length * (i as f32 / edge.level as f32)).as_dvec2())
        .to_fixed()
}

/// Positions that the two patches beside an edge give to its vertices, and where they differ.
fn mismatches(cover: &Cover, shared: bool) -> usize {
    let pairs = cover.edges.iter().filter(|edge| edge.patches[1] != NONE);
    pairs
        .map(|edge| {
            let [left, right] = edge.patches.map(|id| {
                let patch = &cover.patches[id as usize];
                // The patch must know this very edge as a piece of one of its sides.
                assert!(
                    patch
                        .edges
                        .iter()
                        .any(|e| *e != NONE && cover.edges[*e as usize].corners == edge.corners)
                );
                outline(cover, edge, |edge, i| {
                    if shared {
                        from_edge(cover, edge, i)
                    } else {
                        from_patch(cover, patch, edge, i)
                    }
                })
            });
            left.iter().zip(&right).filter(|(a, b)| a != b).count()
        })
        .sum()
}

#[test]
fn ten_thousand_cameras_and_level_sets_share_every_edge_bit_for_bit() {
    let terrain = terrain(1);
    let mut random = Random(3);
    let mut edges = 0;
    for _ in 0..10_000 {
        let (mut cover, mut params) = random_view(&mut random, &terrain, 512.0);
        for edge in &mut cover.edges {
            edge.wanted = (1.0 + 15.0 * random.unit() as f32).to_bits();
        }
        for patch in &mut cover.patches {
            patch.visible = 1;
        }
        params.max_vertices = u32::MAX;
        twin::plan(&mut cover, &params);
        edges += cover.edges.len();
        assert_eq!(mismatches(&cover, true), 0);
    }
    assert!(
        edges > 100_000,
        "{edges} edges are enough to mean something"
    );
}

#[test]
fn edges_without_an_owner_would_crack() {
    let terrain = terrain(1);
    let mut random = Random(4);
    let mut found = 0;
    for _ in 0..20 {
        let (mut cover, params) = random_view(&mut random, &terrain, 64.0);
        for edge in &mut cover.edges {
            edge.wanted = 13.0_f32.to_bits();
        }
        for patch in &mut cover.patches {
            patch.visible = 1;
        }
        twin::plan(&mut cover, &params);
        found += mismatches(&cover, false);
    }
    assert!(
        found > 0,
        "computing an edge from each patch's own corner must differ somewhere"
    );
}

#[test]
fn meshes_of_random_cameras_have_no_crack() {
    let terrain = terrain(4);
    let mut random = Random(5);
    for round in 0..60 {
        let (mut cover, params) = random_view(&mut random, &terrain, 64.0);
        twin::levels(&mut cover, &params, &terrain);
        let result = twin::plan(&mut cover, &params);
        let mesh = twin::emit(&cover, &params, &terrain, &result);
        assert_eq!(mesh.vertices.len(), result.vertices as usize);
        assert_eq!(mesh.indices.len(), result.triangles as usize * 3);
        assert_eq!(
            cracks(&cover, &mesh.vertices, &mesh.indices),
            Some(0),
            "round {round}"
        );
    }
}

#[test]
fn the_search_sees_a_crack() {
    let terrain = terrain(2);
    let (mut cover, params) = random_view(&mut Random(6), &terrain, 256.0);
    for patch in &mut cover.patches {
        patch.visible = 1;
    }
    for edge in &mut cover.edges {
        edge.wanted = 4.0_f32.to_bits();
    }
    let result = twin::plan(&mut cover, &params);
    let mut mesh = twin::emit(&cover, &params, &terrain, &result);
    let used = mesh.indices[mesh.indices.len() / 2] as usize;
    // A second vertex, one bit higher, for one triangle only.
    let mut moved = mesh.vertices[used];
    moved.position[1] = f32::from_bits(moved.position[1].to_bits() + 1);
    mesh.vertices.push(moved);
    let place = mesh.indices.len() / 2;
    mesh.indices[place] = mesh.vertices.len() as u32 - 1;
    assert_ne!(cracks(&cover, &mesh.vertices, &mesh.indices), Some(0));
}

#[test]
fn what_is_behind_the_camera_emits_nothing() {
    let terrain = terrain(2);
    let extent = terrain.extent();
    let lattice = Lattice::new(extent, 64.0);
    // Outside the extent, its back to it.
    let eye = DVec3::new(extent.max.x + 500.0, 300.0, extent.centre().y);
    let leaves = lattice.leaves(DVec2::new(eye.x, eye.z), 300.0, 2.0);
    let bounds = terrain.bounds(&extent);
    let mut cover = Cover::new(&lattice, &leaves, |_| (bounds.min, bounds.max));
    let params = params(&cover, eye, -std::f64::consts::FRAC_PI_2, 0.0, 8.0);
    twin::levels(&mut cover, &params, &terrain);
    let result = twin::plan(&mut cover, &params);
    assert_eq!((result.vertices, result.triangles, result.drawn), (0, 0, 0));
    assert_eq!(result.culled, params.patch_count);
    assert_eq!(result.indexed, [0, 1, 0, 0, 0]);
}

#[test]
fn small_pools_lower_all_levels_and_are_never_overrun() {
    let terrain = terrain(2);
    let (mut cover, mut params) = random_view(&mut Random(8), &terrain, 64.0);
    twin::levels(&mut cover, &params, &terrain);
    for patch in &mut cover.patches {
        patch.visible = 1;
    }
    let full = twin::plan(&mut cover, &params);
    params.max_vertices = full.vertices / 3;
    let less = twin::plan(&mut cover, &params);
    assert!(
        less.lowered > 0 && less.vertices <= params.max_vertices,
        "{less:?}"
    );
    params.max_vertices = 10;
    let none = twin::plan(&mut cover, &params);
    assert_eq!(none.indexed[0], 0, "what cannot fit is not drawn");
}
