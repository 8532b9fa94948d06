//! Trees beside lists: what overlaps a volume.

use bevy::math::DVec3;
use dolomite_collision::{
    Aabb, Capsule, Ellipsoid, Sphere, TreeKind, TreeSettings, TriangleMesh, TriangleTree, Volume,
};
use dolomite_testkit::places::{direction, place, size, turn};
use dolomite_testkit::random::Random;

/// Of one of the four kinds.
fn volume(random: &mut Random, kind: usize) -> Volume {
    let center = place(random, 5.0);
    let mut some = || size(random, 0.01, 2.0);
    let (a, b, c) = (some(), some(), some());
    match kind {
        0 => Sphere { center, radius: a }.into(),
        1 => Aabb::around(center, DVec3::new(a, b, c)).into(),
        2 => Ellipsoid {
            center,
            radii: DVec3::new(a, b, c),
            rotation: turn(random),
        }
        .into(),
        _ => {
            let arm = direction(random) * b;
            Capsule {
                segment: [center - arm, center + arm],
                radius: a,
            }
            .into()
        }
    }
}

/// Of so many queries those that a tree answers unlike a list of all triangles, and triangles that were found.
pub fn differences(random: &mut Random, count: usize) -> (u64, u64) {
    const TRIANGLES: usize = 500;
    let triangles: Vec<_> = (0..TRIANGLES)
        .map(|_| {
            let center = place(random, 5.0);
            let half = size(random, 0.05, 2.0);
            [(); 3].map(|()| center + place(random, half))
        })
        .collect();
    let Ok(mesh) = TriangleMesh::from_triangles(&triangles) else {
        return (count as u64, 0);
    };
    let tree = |kind| {
        let settings = TreeSettings {
            kind,
            ..TreeSettings::default()
        };
        TriangleTree::new(mesh.clone(), settings)
    };
    let (bvh, octree, list) = (
        tree(TreeKind::Bvh),
        tree(TreeKind::Octree),
        tree(TreeKind::List),
    );
    let (mut wrong, mut found) = (0, 0);
    for number in 0..count {
        let volume = volume(random, number % 4);
        let expected = list.overlapping(&volume);
        wrong += u64::from(bvh.overlapping(&volume) != expected);
        wrong += u64::from(octree.overlapping(&volume) != expected);
        found += expected.len() as u64;
    }
    (wrong, found)
}
