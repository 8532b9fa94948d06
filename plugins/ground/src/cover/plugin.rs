//! Which patches each camera needs.

use std::collections::HashMap;

use bevy::math::UVec2;
use bevy::prelude::*;
use bevy::tasks::{ComputeTaskPool, TaskPool};
use dolomite_terrain::{Ground, GroundPoint, Planes, Terrain};

use super::lattice::{Lattice, Node, selection_height};
use super::patches::GroundPatches;
use super::settings::{PatchDetail, TerrainView};
use crate::shown::ShownTerrains;
use dolomite_tessellation::{GeometryCamera, PatchMeshError};

/// The system that keeps [`TerrainCover`] runs in this set, in `PostUpdate`, after transforms
/// are propagated.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub struct TerrainCoverSystems;

/// The patches that a camera with a [`PatchDetail`] needs now; none for others. Required by [`TerrainView`].
///
/// They are of the first visible terrain: patches of several terrains are not drawn.
#[derive(Component, Clone, Debug, Default)]
pub struct TerrainCover {
    /// Which terrain they cover.
    pub terrain: Option<Entity>,
    /// The patches; replaced, never changed, when the focus asks for others.
    pub patches: GroundPatches,
    /// Why the newest leaves could not be taken, if they could not; the patches are older then.
    pub fault: Option<PatchMeshError>,
    /// The leaves that they were made from.
    leaves: Vec<Node>,
}

/// Height bounds of quadtree nodes, kept while the terrain and the lattice stay the same.
#[derive(Resource, Default)]
pub(crate) struct PatchBounds {
    lattice: Option<Lattice>,
    known: HashMap<(UVec2, u32), Known>,
    /// Counts the choices.
    round: u32,
}

struct Known {
    heights: (f32, f32),
    /// Of the newest choice that asked for it.
    round: u32,
}

/// Bounds kept at most; some 64 bytes each. Beyond it those go that were asked for longest ago.
const MAX_BOUNDS: usize = 1 << 17;

impl PatchBounds {
    /// Finds the bounds of all `nodes` that are not known yet, on all cores.
    fn fill(&mut self, terrain: &Terrain, lattice: Lattice, nodes: &[Node]) {
        if self.lattice != Some(lattice) {
            self.known.clear();
            self.lattice = Some(lattice);
        }
        self.round += 1;
        let round = self.round;
        let mut missing = Vec::new();
        for node in nodes {
            match self.known.get_mut(&(node.corner, node.side)) {
                Some(known) => known.round = round,
                None => missing.push(*node),
            }
        }
        if missing.is_empty() {
            return;
        }
        if self.known.len() + missing.len() > MAX_BOUNDS {
            self.forget_oldest();
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
        let known = found.map(|heights| Known { heights, round });
        self.known.extend(
            missing
                .iter()
                .map(|node| (node.corner, node.side))
                .zip(known),
        );
    }

    /// Halves what is kept. What the present choice asked for stays.
    fn forget_oldest(&mut self) {
        let mut rounds: Vec<u32> = self.known.values().map(|known| known.round).collect();
        let middle = rounds.len() / 2;
        let (_, median, _) = rounds.select_nth_unstable(middle);
        let (oldest, newest) = (*median, self.round);
        self.known
            .retain(|_, known| known.round > oldest || known.round == newest);
    }

    fn of(&self, node: Node) -> (f32, f32) {
        self.known[&(node.corner, node.side)].heights
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
pub(crate) fn update_covers(
    shown: Res<ShownTerrains>,
    terrains: Query<Ref<Terrain>>,
    mut views: Query<
        (
            Option<Ref<PatchDetail>>,
            Ref<GeometryCamera>,
            Ref<GlobalTransform>,
            &mut TerrainCover,
        ),
        With<TerrainView>,
    >,
    mut cache: ResMut<PatchBounds>,
    mut told: Local<bool>,
) {
    let first = shown.slot(0);
    let terrain = first.and_then(|first| terrains.get(first).ok());
    for (detail, camera, transform, mut cover) in &mut views {
        // Without a PatchDetail the level of detail chooses for itself.
        let (Some(detail), Some(terrain)) = (detail, &terrain) else {
            if cover.terrain.is_some() {
                *cover = TerrainCover::default();
            }
            continue;
        };
        if shown.count() > 1 && !*told {
            *told = true;
            tell!(
                "{} terrains are visible, but a camera with a PatchDetail sees the first of them alone",
                shown.count()
            );
        }
        let other = cover.terrain != first;
        let moved = detail.is_changed() || camera.is_changed() || transform.is_changed();
        if !(other || moved || terrain.is_changed()) {
            continue;
        }
        let settings = detail.clamped();
        let focus = camera
            .focus
            .unwrap_or_else(|| transform.translation().as_dvec3());
        if !focus.is_finite() {
            continue;
        }
        if other || terrain.is_changed() {
            cache.lattice = None;
        }
        let lattice = Lattice::new(terrain.extent(), f64::from(settings.finest_patch));
        let ground = terrain.height(focus.xz());
        let height = selection_height(focus, ground);
        let leaves = lattice.leaves(focus.xz(), height, f64::from(settings.split_distance));
        if leaves == cover.leaves && cache.lattice == Some(lattice) {
            continue;
        }
        cache.fill(terrain, lattice, &leaves);
        let bounds = |node: Node| cache.of(node);
        let heights = |points: &[GroundPoint]| heights(terrain, points);
        match GroundPatches::new(&lattice, &leaves, bounds, heights) {
            Ok(patches) => {
                *cover = TerrainCover {
                    terrain: first,
                    patches,
                    fault: None,
                    leaves,
                };
            }
            Err(fault) => cover.fault = Some(fault),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::DVec2;
    use dolomite_terrain::{GroundRect, TerrainData};

    #[test]
    fn full_bounds_lose_their_oldest() {
        let terrain = Terrain::new(TerrainData {
            extent: GroundRect::square(DVec2::ZERO, 4096.0),
            layers: Vec::new(),
            base: 0.0,
            sea_level: None,
        })
        .expect("valid");
        let lattice = Lattice::new(terrain.extent(), 1.0);
        let row = |y: u32| -> Vec<Node> {
            let corner = |x| UVec2::new(x, y);
            (0..4096)
                .map(|x| Node {
                    corner: corner(x),
                    side: 1,
                })
                .collect()
        };
        let mut bounds = PatchBounds::default();
        for y in 0..40 {
            bounds.fill(&terrain, lattice, &row(y));
            assert!(bounds.known.len() <= MAX_BOUNDS);
        }
        let kept = |y: u32| bounds.known.contains_key(&(UVec2::new(7, y), 1));
        // 32 rows fit: the 33rd drops the older half.
        assert!((17..40).all(kept) && !(0..16).any(kept));
    }
}
