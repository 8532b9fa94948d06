//! The plugin, and its simulation half: which patches each camera needs.

use std::collections::HashMap;
use std::sync::Arc;

use bevy::math::{DVec3, UVec2};
use bevy::prelude::*;
use bevy::tasks::{ComputeTaskPool, TaskPool};
use dolomite_terrain::{Ground, Terrain};

use crate::cover::{Cover, Lattice, Node, clamped, selection_height};
use crate::settings::TerrainView;
use crate::stats::TessellationStats;

/// Refines the [`Terrain`] in the world for every camera that carries a [`TerrainView`].
///
/// Under `MinimalPlugins` it keeps each camera's [`TerrainCover`]; with the `render` feature and
/// a render app it also tessellates and draws. Without a terrain, or without a `TerrainView`, it
/// creates no pipeline and no buffer and runs no pass.
#[derive(Default)]
pub struct TerrainTessellationPlugin;

/// The system that keeps [`TerrainCover`] runs in this set, in `PostUpdate`, after transforms
/// are propagated.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub struct TerrainCoverSystems;

impl Plugin for TerrainTessellationPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<TessellationStats>()
            .init_resource::<PatchBounds>()
            .add_systems(
                PostUpdate,
                update_covers
                    .in_set(TerrainCoverSystems)
                    .after(bevy::transform::TransformSystems::Propagate),
            );
        #[cfg(feature = "render")]
        crate::render::build(app);
    }
}

/// The patches that a camera needs now. Required by [`TerrainView`].
#[derive(Component, Clone, Debug, Default)]
pub struct TerrainCover {
    /// The patches; replaced, never changed, when the focus asks for others.
    pub cover: Arc<Cover>,
    /// The leaves that `cover` was made from.
    leaves: Vec<Node>,
    /// The point that detail follows, world space, metres.
    pub focus: DVec3,
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

/// Chooses the patches of every view whose focus, settings or terrain changed.
fn update_covers(
    terrain: Query<Ref<Terrain>>,
    mut views: Query<(Ref<TerrainView>, Ref<GlobalTransform>, &mut TerrainCover)>,
    mut cache: ResMut<PatchBounds>,
) {
    let Some(terrain) = terrain.iter().next() else {
        for (_, _, mut cover) in &mut views {
            if !cover.cover.patches.is_empty() {
                *cover = TerrainCover::default();
            }
        }
        return;
    };
    if terrain.is_changed() {
        cache.lattice = None;
    }
    for (view, transform, mut cover) in &mut views {
        if !(terrain.is_changed() || view.is_changed() || transform.is_changed()) {
            continue;
        }
        let settings = clamped(&view);
        let focus = settings
            .focus
            .unwrap_or_else(|| transform.translation().as_dvec3());
        if !focus.is_finite() {
            continue;
        }
        let lattice = Lattice::new(terrain.extent(), f64::from(settings.finest_patch));
        let ground = terrain.height(focus.xz());
        let height = selection_height(focus, ground);
        let leaves = lattice.leaves(focus.xz(), height, f64::from(settings.split_distance));
        let same = leaves == cover.leaves && cache.lattice == Some(lattice);
        if !same {
            cache.fill(&terrain, lattice, &leaves);
            let bounds = |node: Node| cache.bounds[&(node.corner, node.side)];
            cover.cover = Arc::new(Cover::new(&lattice, &leaves, bounds));
            cover.leaves = leaves;
        }
        if cover.focus != focus {
            cover.focus = focus;
        }
    }
}
