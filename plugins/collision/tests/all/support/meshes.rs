//! Meshes to ask, ordinary and hostile.

use super::random::{direction, place};
use bevy::math::{DVec3, Vec3};
use dolomite_collision::TriangleMesh;
use dolomite_testkit::mesh::bumpy_sphere;
use dolomite_testkit::random::Random;

/// Triangles of some size in a cube.
pub fn soup(random: &mut Random, count: usize, half: f64, size: f64) -> Vec<[DVec3; 3]> {
    (0..count)
        .map(|_| {
            let center = place(random, half);
            [(); 3].map(|()| center + place(random, size))
        })
        .collect()
}

/// A closed surface: see [`bumpy_sphere`].
pub fn closed(random: &mut Random, rings: u32, origin: DVec3) -> TriangleMesh {
    let (vertices, triangles) = bumpy_sphere(random, rings);
    TriangleMesh::new(origin, vertices, triangles).expect("a mesh")
}

/// A floor of squares cut in two, heights by a function.
pub fn floor(cells: u32, step: f32, height: impl Fn(f32, f32) -> f32) -> TriangleMesh {
    let side = cells + 1;
    let half = cells as f32 * step * 0.5;
    let vertices = (0..side * side).map(|i| {
        let (x, z) = (
            (i % side) as f32 * step - half,
            (i / side) as f32 * step - half,
        );
        Vec3::new(x, height(x, z), z)
    });
    let squares = (0..cells * cells).flat_map(|i| {
        let a = i / cells * side + i % cells;
        [[a, a + side, a + 1], [a + 1, a + side, a + side + 1]]
    });
    TriangleMesh::new(DVec3::ZERO, vertices.collect(), squares.collect()).expect("a mesh")
}

/// All that trees are held to a list on.
pub fn all(random: &mut Random) -> Vec<(&'static str, TriangleMesh)> {
    let from = |triangles: &[[DVec3; 3]]| TriangleMesh::from_triangles(triangles).expect("a mesh");
    let needles: Vec<_> = (0..500)
        .map(|_| {
            let a = place(random, 5.0);
            let along = direction(random) * 10.0;
            [a, a + along, a + along * 0.5 + place(random, 1e-5)]
        })
        .collect();
    let one = soup(random, 1, 1.0, 1.0);
    let points: Vec<_> = (0..500).map(|_| [place(random, 3.0); 3]).collect();
    let far: Vec<_> = soup(random, 500, 20.0, 1.0)
        .into_iter()
        .map(|corners| corners.map(|corner| corner + DVec3::new(1e5, -3e4, 7e4)))
        .collect();
    vec![
        ("soup", from(&soup(random, 2000, 5.0, 0.5))),
        ("large triangles", from(&soup(random, 300, 5.0, 8.0))),
        ("needles", from(&needles)),
        ("one triangle", from(&one)),
        ("the same many times", from(&vec![one[0]; 3000])),
        ("points", from(&points)),
        ("1e5 m away", from(&far)),
        ("closed", closed(random, 24, DVec3::new(-3e4, 10.0, 5.0))),
        ("flat", floor(20, 0.5, |_, _| 0.0)),
        ("none", TriangleMesh::default()),
    ]
}
