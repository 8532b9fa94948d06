//! The walk against a search through all triangles, and its bound against the true surface.

use super::*;
use crate::detail::settings::{Metric, TerrainLod};
use crate::detail::{DetailMesh, DetailView, Lens, mesh, select};
use bevy::math::{DQuat, EulerRot};
use dolomite_terrain::{Fractal, GroundRect, Hill, Layer, Source, Terrain, TerrainData};

fn hash(k: u32, salt: u32) -> f64 {
    let mut h = k.wrapping_mul(0x9e37_79b9) ^ salt.wrapping_mul(0x85eb_ca6b);
    h = (h ^ (h >> 16)).wrapping_mul(0x7feb_352d);
    h = (h ^ (h >> 15)).wrapping_mul(0x846c_a68b);
    f64::from(h ^ (h >> 16)) / f64::from(u32::MAX)
}

/// Rough ground with a sea, 2 × 1 roots with sides of an odd length, about `centre`.
fn terrain(centre: DVec2) -> Terrain {
    let half = DVec2::new(1024.3, 512.7);
    Terrain::new(TerrainData {
        extent: GroundRect::new(centre - half, centre + half),
        layers: vec![
            Layer {
                source: Source::Fractal(Fractal {
                    octaves: 11,
                    amplitude: 90.0,
                    wavelength: 700.0,
                    ..Fractal::default()
                }),
                mask: None,
            },
            Layer {
                source: Source::Hill(Hill {
                    centre: centre + DVec2::new(60.0, 40.0),
                    radius: 25.0,
                    height: 20.0,
                }),
                mask: None,
            },
        ],
        base: 15.0,
        sea_level: Some(0.0),
    })
    .expect("valid")
}

fn view(cells: &DetailCells, k: u32) -> DetailView {
    let extent = cells.terrain().extent();
    let xz = extent.min + extent.size() * DVec2::new(hash(k, 1), hash(k, 2));
    let ground = cells.terrain().sample_f64(xz).height.max(0.0);
    let eye = DVec3::new(xz.x, ground + 1.0 + 80.0 * hash(k, 3) * hash(k, 4), xz.y);
    let turn = DQuat::from_euler(EulerRot::YXZ, 6.3 * hash(k, 5), 0.6 * hash(k, 6) - 0.5, 0.0);
    let lens = Lens::Perspective(0.2 + hash(k, 7));
    let mut view = DetailView::new(eye, turn, lens, UVec2::new(960, 540), 0.1);
    let metric = match k % 3 {
        0 => Metric::EdgeLength { pixels: 40.0 },
        _ => Metric::ErrorBound {
            pixels: 1.0 + 15.0 * hash(k, 8) as f32,
        },
    };
    view.set_metric(&TerrainLod {
        metric,
        ..TerrainLod::default()
    });
    if k.is_multiple_of(4) {
        // All is seen.
        view.planes = [[0.0, 0.0, 0.0, 1.0]; 6];
    }
    view
}

/// A point as whole steps of 2⁻³² m from the lattice's origin.
fn local(cells: &DetailCells, point: GroundPoint) -> [i128; 2] {
    let ([x, z], [ox, oz]) = (point.to_fixed(), cells.lattice.origin.to_fixed());
    [
        i128::from(x) - i128::from(ox),
        i128::from(z) - i128::from(oz),
    ]
}

/// The least of the areas between a place and the sides of a triangle, twice: 0 on its border, above
/// inside.
fn inside(cells: &DetailCells, mesh: &DetailMesh, triangle: [u32; 3], p: [i128; 2]) -> i128 {
    let at = triangle.map(|k| local(cells, mesh.vertices[k as usize].point));
    let area = |k: usize| {
        let (a, b) = (at[k], at[(k + 1) % 3]);
        // Counter-clockwise seen from above: z before x.
        (b[1] - a[1]) * (p[0] - a[0]) - (b[0] - a[0]) * (p[1] - a[1])
    };
    area(0).min(area(1)).min(area(2))
}

/// Triangles that hold a place, their borders included, by exact integers.
fn holding(cells: &DetailCells, mesh: &DetailMesh, place: GroundPoint) -> Vec<[u32; 3]> {
    let p = local(cells, place);
    let holds = |triangle: &&[u32; 3]| inside(cells, mesh, **triangle, p) >= 0;
    mesh.triangles.iter().filter(holds).copied().collect()
}

/// Random places, vertices, places on edges, and some outside, some at the very border.
fn places(cells: &DetailCells, mesh: &DetailMesh, k: u32) -> Vec<GroundPoint> {
    let extent = cells.terrain().extent();
    let mut places = Vec::new();
    for j in 0..120_u32 {
        let unit = DVec2::new(hash(j, 100 + k), hash(j, 200 + k));
        places.push(GroundPoint::new(
            extent.min + extent.size() * (unit * 1.04 - 0.02),
        ));
        let pick = |salt: u32| (hash(j, salt + k) * (mesh.vertices.len() - 1) as f64) as usize;
        let vertex = mesh.vertices[pick(300)].point;
        places.push(vertex);
        let triangle =
            mesh.triangles[(hash(j, 400 + k) * (mesh.triangles.len() - 1) as f64) as usize];
        let [a, b, c] = triangle.map(|k| mesh.vertices[k as usize].point.to_fixed());
        let mix = |a: [i64; 2], b: [i64; 2]| {
            GroundPoint::from_fixed([0, 1].map(|k| a[k] + (b[k] - a[k]) / 2))
        };
        places.push(mix(a, b));
        let inner = [0, 1].map(|k| a[k] + (b[k] - a[k]) / 3 + (c[k] - a[k]) / 5);
        places.push(GroundPoint::from_fixed(inner));
    }
    let far = cells.lattice.roots << (cells.lattice.depth + 1);
    for corner in [UVec2::ZERO, far, UVec2::new(far.x, 0), UVec2::new(0, far.y)] {
        let [x, z] = cells.lattice.point(corner).to_fixed();
        places.push(GroundPoint::from_fixed([x, z]));
        places.push(GroundPoint::from_fixed([x - 1, z]));
        places.push(GroundPoint::from_fixed([x, z + 1]));
    }
    places.push(GroundPoint::new(DVec2::splat(f64::INFINITY)));
    places.push(GroundPoint::new(DVec2::splat(-1e300)));
    places
}

#[test]
fn the_walk_finds_the_triangle_that_a_search_finds() {
    let (mut hits, mut misses, mut shared, mut coarsened) = (0, 0, 0, 0);
    for centre in [DVec2::ZERO, DVec2::new(1e6, -1e6)] {
        let mut cells = DetailCells::new(terrain(centre), 0.25);
        for k in 0..8_u32 {
            let view = view(&cells, k);
            let most = if k % 3 == 1 { 1500 } else { 1 << 20 };
            let selection = select(&mut cells, &view, most);
            coarsened += u32::from(selection.coarsening > 1.0);
            let mesh = mesh::mesh(&cells, &selection);
            for place in places(&cells, &mesh, k) {
                let found = locate(&cells, &selection, place);
                let expected = holding(&cells, &mesh, place);
                let Some(found) = found else {
                    // What is not drawn may have a border in common with what is.
                    let p = local(&cells, place);
                    for triangle in expected {
                        assert_eq!(inside(&cells, &mesh, triangle, p), 0, "{place:?}");
                    }
                    misses += 1;
                    continue;
                };
                let corners = found.corners.map(|at| cells.lattice.point(at));
                let same = |triangle: &[u32; 3]| {
                    let theirs = triangle.map(|k| mesh.vertices[k as usize].point);
                    (0..3).any(|k| [0, 1, 2].map(|j| theirs[(j + k) % 3]) == corners)
                };
                assert!(expected.iter().any(same), "{place:?}: {corners:?}");
                hits += 1;
                shared += u32::from(expected.len() > 1);
            }
        }
    }
    assert!(
        hits > 4000 && misses > 500 && shared > 1500 && coarsened >= 2,
        "{hits} {misses} {shared} {coarsened}"
    );
}

#[test]
fn answers_lie_on_the_triangle_and_within_their_bound_of_the_true_surface() {
    let mut largest: f64 = 0.0;
    for centre in [DVec2::ZERO, DVec2::new(1e6, -1e6)] {
        let mut cells = DetailCells::new(terrain(centre), 0.25);
        for k in 0..8_u32 {
            let view = view(&cells, k);
            let selection = select(&mut cells, &view, 1 << 20);
            let mesh = mesh::mesh(&cells, &selection);
            for place in places(&cells, &mesh, k) {
                let Some(found) = drawn_at(&cells, &selection, place) else {
                    continue;
                };
                // On borders all triangles agree: the surface is continuous.
                for triangle in holding(&cells, &mesh, place) {
                    let corners = triangle.map(|k| &mesh.vertices[k as usize]);
                    let [a, b, c] =
                        corners.map(|vertex| vertex.point.relative_to(place).as_dvec2());
                    let area = (b - a).perp_dot(c - a);
                    let weights = DVec3::new(b.perp_dot(c), c.perp_dot(a), a.perp_dot(b)) / area;
                    let heights = corners.map(|vertex| f64::from(vertex.height));
                    let height = weights.dot(DVec3::from(heights));
                    // Places relative in f32: 2⁻²³ of a side of 1000 m, on slopes up to 1.
                    assert!((found.height - height).abs() < 3e-4, "{found:?} {height}");
                }
                let truth = cells.terrain().sample_f64(place.to_dvec2()).height.max(0.0);
                let off = (found.height - truth).abs();
                assert!(off <= found.bound, "{place:?}: {off} > {}", found.bound);
                if found.bound > 0.05 {
                    largest = largest.max(off / found.bound);
                }
            }
        }
    }
    assert!(largest > 0.3, "the bound is of what it bounds: {largest}");
}

#[test]
fn hostile_places_have_no_answer() {
    let mut cells = DetailCells::new(terrain(DVec2::ZERO), 1.0);
    let mut view = view(&cells, 1);
    view.planes = [[0.0, 0.0, 0.0, 1.0]; 6];
    let selection = select(&mut cells, &view, 1 << 20);
    for xz in [
        DVec2::new(f64::INFINITY, 0.0),
        DVec2::new(0.0, -1e300),
        DVec2::splat(2e9),
        DVec2::new(-1024.31, 0.0),
    ] {
        assert_eq!(drawn_at(&cells, &selection, GroundPoint::new(xz)), None);
    }
    assert!(drawn_at(&cells, &selection, GroundPoint::new(DVec2::ZERO)).is_some());
}
