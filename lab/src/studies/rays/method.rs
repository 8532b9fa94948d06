//! Who is asked.

use super::meshes::Triangles;
use crate::studies::beside::Mesh;
use bevy::math::DVec3;
use dolomite_collision::{Ray, TreeKind, TreeSettings, TriangleMesh, TriangleTree};
use std::time::Instant;

/// What can be asked for the first hit.
pub enum Method {
    /// Ours.
    Tree(TriangleTree),
    /// Parry's.
    Parry(Mesh),
}

/// The names of all methods, ours first.
pub const NAMES: [&str; 3] = ["bvh", "octree", "parry"];

/// One of our trees.
pub fn tree((vertices, triangles): &Triangles, settings: TreeSettings) -> TriangleTree {
    let mesh = TriangleMesh::new(DVec3::ZERO, vertices.clone(), triangles.clone())
        .expect("the meshes of this study are finite");
    TriangleTree::new(mesh, settings)
}

impl Method {
    /// All that there are, each with its name and the milliseconds of its building.
    pub fn all(mesh: &Triangles) -> Vec<(&'static str, Self, f64)> {
        let ours = |kind| {
            let settings = TreeSettings {
                kind,
                ..TreeSettings::default()
            };
            Some(Self::Tree(tree(mesh, settings)))
        };
        let timed = |name, make: &dyn Fn() -> Option<Self>| {
            let start = Instant::now();
            let made = make()?;
            Some((name, made, start.elapsed().as_secs_f64() * 1e3))
        };
        let methods = [
            timed(NAMES[0], &|| ours(TreeKind::Bvh)),
            timed(NAMES[1], &|| ours(TreeKind::Octree)),
            timed(NAMES[2], &|| Mesh::new(&mesh.0, &mesh.1).map(Self::Parry)),
        ];
        methods.into_iter().flatten().collect()
    }

    /// When a ray hits; NaN if it does not.
    pub fn first(&self, ray: &Ray) -> f64 {
        match self {
            Self::Tree(tree) => tree.first_hit(ray).map_or(f64::NAN, |hit| hit.time),
            Self::Parry(mesh) => mesh.first(ray),
        }
    }
}
