//! The plugin, and its simulation half: which patches each camera needs.

use std::collections::HashMap;

use bevy::math::UVec2;
use bevy::prelude::*;
use bevy::tasks::{ComputeTaskPool, TaskPool};
use dolomite_terrain::{Ground, GroundPoint, Planes, Terrain};

use crate::detail::Detail;

use super::lattice::{Lattice, Node, clamped, selection_height};
use super::patches::GroundPatches;
use super::settings::TerrainView;
use dolomite_tessellation::{PatchMeshError, StageCamera};

/// Refines the [`Terrain`] in the world for every camera that carries a [`TerrainView`].
///
/// Under `MinimalPlugins` it keeps each camera's [`TerrainCover`]; with the `render` feature and
/// a render app it also tessellates and draws. Without a terrain, or without a `TerrainView`, it
/// creates no pipeline and no buffer and runs no pass.
#[derive(Default)]
pub struct GroundPlugin;

/// The system that keeps [`TerrainCover`] runs in this set, in `PostUpdate`, after transforms
/// are propagated.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub struct TerrainCoverSystems;

impl Plugin for GroundPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<PatchBounds>().add_systems(
            PostUpdate,
            update_covers
                .in_set(TerrainCoverSystems)
                .after(bevy::transform::TransformSystems::Propagate),
        );
        app.add_plugins(crate::detail::budget::DetailBudgetPlugin);
        #[cfg(feature = "render")]
        crate::render::build(app);
    }

    #[cfg(feature = "render")]
    fn finish(&self, app: &mut App) {
        crate::render::finish(app);
    }
}

/// The patches that a camera needs now. Required by [`TerrainView`].
#[derive(Component, Clone, Debug, Default)]
pub struct TerrainCover {
    /// The patches; replaced, never changed, when the focus asks for others.
    pub patches: GroundPatches,
    /// Why the newest leaves could not be taken, if they could not; the patches are older then.
    pub fault: Option<PatchMeshError>,
    /// The leaves that they were made from.
    leaves: Vec<Node>,
}

/// Height bounds of quadtree nodes, kept while the terrain and the lattice stay the same.
#[derive(Resource, Default)]
pub struct PatchBounds {
    lattice: Option<Lattice>,
    bounds: HashMap<(UVec2, u32), (f32, f32)>,
}

/// Bounds kept at most; some 64 bytes each. Beyond it the cache starts anew.
const MAX_BOUNDS: usize = 1 << 17;

impl PatchBounds {
    /// Finds the bounds of all `nodes` that are not known yet, on all cores.
    fn fill(&mut self, terrain: &Terrain, lattice: Lattice, nodes: &[Node]) {
        if self.lattice != Some(lattice) || self.bounds.len() > MAX_BOUNDS {
            self.bounds.clear();
            self.lattice = Some(lattice);
        }
        let missing: Vec<Node> = nodes
            .iter()
            .filter(|node| !self.bounds.contains_key(&(node.corner, node.side)))
            .copied()
            .collect();
        if missing.is_empty() {
            return;
        }
        // Nodes cost alike: four tasks a thread even out what difference there is.
        let pool = ComputeTaskPool::get_or_init(TaskPool::default);
        let chunk = missing.len().div_ceil(pool.thread_num() * 4).max(1);
        let found = pool.scope(|scope| {
            for nodes in missing.chunks(chunk) {
                scope.spawn(async move {
                    let bounds = |node: &Node| {
                        let bounds = terrain.bounds(&lattice.rect(*node));
                        (bounds.min, bounds.max)
                    };
                    nodes.iter().map(bounds).collect::<Vec<_>>()
                });
            }
        });
        let found = found.into_iter().flatten();
        self.bounds.extend(
            missing
                .iter()
                .map(|node| (node.corner, node.side))
                .zip(found),
        );
    }
}

/// Heights at points, on this thread.
fn heights(terrain: &Terrain, points: &[GroundPoint]) -> Vec<f32> {
    let [mut value, mut dx, mut dz] = [(); 3].map(|()| vec![0.0; points.len()]);
    let planes = Planes {
        value: &mut value,
        dx: &mut dx,
        dz: &mut dz,
    };
    let filled = terrain.fill_points(points, planes);
    debug_assert!(filled.is_ok(), "the planes are as long as the list");
    value
}

/// Chooses the patches of every view whose focus, settings or terrain changed.
fn update_covers(
    terrain: Query<Ref<Terrain>>,
    mut views: Query<(
        Ref<TerrainView>,
        Ref<StageCamera>,
        Ref<GlobalTransform>,
        &mut TerrainCover,
        Has<Detail>,
    )>,
    mut cache: ResMut<PatchBounds>,
) {
    let Some(terrain) = terrain.iter().next() else {
        for (.., mut cover, _) in &mut views {
            if !cover.leaves.is_empty() {
                *cover = TerrainCover::default();
            }
        }
        return;
    };
    if terrain.is_changed() {
        cache.lattice = None;
    }
    for (view, camera, transform, mut cover, detailed) in &mut views {
        // The level of detail chooses for itself.
        if detailed {
            continue;
        }
        let changed = view.is_changed() || camera.is_changed() || transform.is_changed();
        if !(terrain.is_changed() || changed) {
            continue;
        }
        let settings = clamped(&view);
        let focus = camera
            .focus
            .unwrap_or_else(|| transform.translation().as_dvec3());
        if !focus.is_finite() {
            continue;
        }
        let lattice = Lattice::new(terrain.extent(), f64::from(settings.finest_patch));
        let ground = terrain.height(focus.xz());
        let height = selection_height(focus, ground);
        let leaves = lattice.leaves(focus.xz(), height, f64::from(settings.split_distance));
        if leaves == cover.leaves && cache.lattice == Some(lattice) {
            continue;
        }
        cache.fill(&terrain, lattice, &leaves);
        let bounds = |node: Node| cache.bounds[&(node.corner, node.side)];
        let heights = |points: &[GroundPoint]| heights(&terrain, points);
        match GroundPatches::new(&lattice, &leaves, bounds, heights) {
            Ok(patches) => {
                *cover = TerrainCover {
                    patches,
                    fault: None,
                    leaves,
                };
            }
            Err(fault) => cover.fault = Some(fault),
        }
    }
}
