//! Rays a second: methods on meshes, and our trees by the size of their leaves.

use super::meshes::Scene;
use super::method::{Method, tree};
use dolomite_collision::{Ray, TreeKind, TreeSettings};
use dolomite_testkit::metrics::{Hash64, median};
use std::hint::black_box;
use std::time::Instant;

/// Most triangles of a leaf that are tried.
pub const LEAVES: [usize; 6] = [1, 2, 4, 8, 16, 32];

/// One method on one mesh.
pub struct Speed {
    /// The method.
    pub name: &'static str,
    /// Nanoseconds a ray.
    pub ns: f64,
    /// Milliseconds of building.
    pub build_ms: f64,
    /// Bytes held, of ours.
    pub bytes: Option<usize>,
    /// Of what was hit.
    pub hash: u64,
}

/// Nanoseconds a ray of a pass over all, and a hash of what they hit.
fn pass(method: &Method, rays: &[Ray]) -> (f64, u64) {
    let mut hash = Hash64::default();
    let start = Instant::now();
    for ray in rays {
        hash.add(black_box(method.first(black_box(ray))).to_bits());
    }
    let seconds = start.elapsed().as_secs_f64();
    (seconds * 1e9 / rays.len().max(1) as f64, hash.finish())
}

/// Medians of rounds in which every method has its turn.
fn rounds(methods: &[&Method], rays: &[Ray], repeats: usize) -> Vec<(f64, u64)> {
    let mut times = vec![Vec::new(); methods.len()];
    let mut hashes = vec![0; methods.len()];
    for _ in 0..repeats.max(1) {
        for (i, method) in methods.iter().enumerate() {
            let (ns, hash) = pass(method, rays);
            times[i].push(ns);
            hashes[i] = hash;
        }
    }
    let medians = times.into_iter().map(median);
    medians
        .map(|ns| ns.unwrap_or(f64::NAN))
        .zip(hashes)
        .collect()
}

/// All methods on a mesh.
pub fn methods(scene: &Scene, rays: &[Ray], repeats: usize) -> Vec<Speed> {
    let made = Method::all(&scene.mesh);
    let asked: Vec<&Method> = made.iter().map(|(_, method, _)| method).collect();
    let times = rounds(&asked, rays, repeats);
    let speeds = made.iter().zip(times);
    speeds
        .map(|((name, method, build_ms), (ns, hash))| Speed {
            name,
            ns,
            build_ms: *build_ms,
            bytes: match method {
                Method::Tree(tree) => Some(tree.bytes()),
                Method::Parry(_) => None,
            },
            hash,
        })
        .collect()
}

/// Nanoseconds a ray of each tree for each size of [`LEAVES`].
pub fn leaves(scene: &Scene, rays: &[Ray], repeats: usize) -> [(TreeKind, Vec<f64>); 2] {
    [TreeKind::Bvh, TreeKind::Octree].map(|kind| {
        let trees = LEAVES.map(|leaf_triangles| {
            let settings = TreeSettings {
                kind,
                leaf_triangles,
                ..TreeSettings::default()
            };
            Method::Tree(tree(&scene.mesh, settings))
        });
        let asked: Vec<&Method> = trees.iter().collect();
        let times = rounds(&asked, rays, repeats);
        (kind, times.into_iter().map(|(ns, _)| ns).collect())
    })
}
