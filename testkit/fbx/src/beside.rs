//! The truth beside ufbx: two readings of the format that share no line. A difference means that one of them is wrong, or
//! that no document says what is right; how each was settled stands in [`truth`](crate::truth).

use crate::file::document;
use crate::hold::{Failure, GRAIN, farthest, reach};
use crate::random::Random;
use crate::scene::{Scene, Shows, Target};
use crate::truth::{Reading, Truth, seconds};
use dolomite_fbx::Origin;
use dolomite_fbx::check::Truth as Theirs;
use glam::DVec3;

/// Holds the truth of a scene against what ufbx makes of its file, at some times of each clip whose layers it hears as
/// the format says: it knows neither mute nor solo, and takes another node's curves where one layer moves a property
/// that another does not.
///
/// # Errors
/// The first difference.
pub fn beside(scene: &Scene, seed: u64) -> Result<(), Failure> {
    let failure = |detail: String| Failure {
        kind: "beside",
        detail,
    };
    let theirs = Theirs::load(&document(scene), &Origin::default())
        .map_err(|error| failure(error.to_string()))?;
    let ours = Truth::of(scene, Reading::ROUNDED);
    let space = theirs.space();
    let mut random = Random::new(seed);
    let mut looks = vec![(None, 0.0)];
    for (number, stack) in scene.stacks.iter().enumerate() {
        if stack.heard().len() == stack.layers.len() && !confused(scene, number) {
            let (begin, end) = (seconds(stack.start), seconds(stack.stop));
            looks.extend((0..12).map(|_| (Some(number), random.between(begin, end))));
        }
    }
    for (stack, time) in looks {
        let (bodies, places) = theirs
            .at(stack, time)
            .map_err(|error| failure(error.to_string()))?;
        let pose = ours.at(stack, time);
        let allowed = GRAIN * reach(scene, &pose);
        for (node, (place, _)) in scene.nodes.iter().zip(&pose.nodes) {
            let Some(there) = places.get(&node.name) else {
                return Err(failure(format!("ufbx has no node {}", node.name)));
            };
            let off = space.to_gltf(*there).distance(*place);
            if off > allowed || off.is_nan() {
                return Err(failure(format!(
                    "{} at {time} s of {stack:?}: {off:e} m",
                    node.name
                )));
            }
        }
        for (node, points) in &pose.shapes {
            let Shows::Mesh(mesh) = scene.nodes[*node].shows else {
                continue;
            };
            let off = |body: &dolomite_fbx::check::Body| {
                let there: Vec<DVec3> = body.points.iter().map(|p| space.to_gltf(*p)).collect();
                farthest(&there, points)
            };
            let same = bodies.iter().filter(|body| body.mesh as usize == mesh);
            let off = same.map(off).fold(f64::INFINITY, f64::min);
            if off > allowed || off.is_nan() {
                let name = &scene.nodes[*node].name;
                return Err(failure(format!(
                    "vertices of {name} at {time} s of {stack:?}: {off:e} m"
                )));
            }
        }
    }
    Ok(())
}

/// ufbx 0.11 walks the properties that a layer moves without a look at whose they are: a property of a node that is moved
/// in another layer, or another clip, but not in one that moves the node, may be given the next node's curves.
fn confused(scene: &Scene, stack: usize) -> bool {
    let node = |target: Target| match target {
        Target::Translation(node)
        | Target::Rotation(node)
        | Target::Scaling(node)
        | Target::Visibility(node) => Some(node),
        _ => None,
    };
    let layers = || scene.stacks.iter().flat_map(|stack| &stack.layers);
    scene.stacks[stack].layers.iter().any(|layer| {
        let moved = |node_of: usize| {
            layer
                .tracks
                .iter()
                .any(|track| node(track.target) == Some(node_of))
        };
        let elsewhere = layers()
            .flat_map(|other| &other.tracks)
            .map(|track| track.target);
        let mut missing =
            elsewhere.filter(|target| layer.tracks.iter().all(|track| track.target != *target));
        missing.any(|target| node(target).is_some_and(moved))
    })
}
