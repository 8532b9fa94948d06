//! Where blades end, the ground shows what they look like: the far field of each kind of blades, fitted by a task, goes
//! to the terrain as a [`GroundCanopy`].
//!
//! Flowers and kelp have none: they are few.

use std::sync::Arc;

use bevy::prelude::*;
use bevy::tasks::{AsyncComputeTaskPool, Task, block_on, poll_once};
use dolomite_ground::{CanopyLayer, GroundCanopy};
use dolomite_terrain::Terrain;

use crate::components::{Vegetation, VegetationState};
use crate::density::Growth;
use crate::kind::{Kind, Kinds, Shape};
use crate::law::FADE_FROM;
use crate::sets::VegetationSystems;
use crate::shade::FarField;

/// Of which list of kinds the far fields are known or being fitted: in the order of the list, [`None`] for what has none.
#[derive(Component, Default)]
pub(super) struct FarFields {
    of: Option<(Arc<Kinds>, u32)>,
    task: Option<Task<Vec<Option<FarField>>>>,
    pub(super) fitted: Arc<[Option<FarField>]>,
}

/// Adds the systems.
pub(super) fn build(app: &mut App) {
    app.add_systems(
        PostUpdate,
        (follow, forget)
            .in_set(VegetationSystems::Place)
            .run_if(any_with_component::<Vegetation>.or_else(any_with_component::<FarFields>)),
    );
}

fn fit(kinds: &Kinds, seed: u32) -> Vec<Option<FarField>> {
    let fit = |kind: &Kind| match &kind.shape {
        Shape::Blade(blade) => Some(FarField::fit(blade, &Growth::new(kind, seed))),
        _ => None,
    };
    kinds.kinds.iter().map(fit).collect()
}

/// What the ground shows of a kind.
fn layer(kind: &Kind, far: &FarField, grown: &Vegetation, sea: f32) -> CanopyLayer {
    let growth = Growth::new(kind, grown.seed);
    let [from, to, steep] = growth.height;
    let clumps = kind.clumps.as_ref();
    // Clumps are told apart near by alone: their mean is left.
    let share = clumps.map_or(1.0, |clumps| {
        (clumps.to - clumps.from) * (1.0 - 0.5 * clumps.uneven)
    });
    let share = share * grown.density.clamp(0.0, 1.0);
    let reach = kind.reach * grown.reach.clamp(0.0, 4.0);
    CanopyLayer {
        height: [from + sea, to + sea, steep],
        slope: growth.slope,
        fade: [FADE_FROM * reach, reach],
        entries: far.entries.map(|[depth, r, g, b]| [depth * share, r, g, b]),
    }
}

type Grown<'a> = (
    Entity,
    Ref<'a, Vegetation>,
    Ref<'a, VegetationState>,
    Option<Ref<'a, Terrain>>,
    Option<&'a mut FarFields>,
);

/// Fits far fields when the kinds have changed, and tells the ground of them.
fn follow(mut commands: Commands, mut all: Query<Grown>) {
    for (entity, grown, state, terrain, fields) in &mut all {
        let (Some(kinds), Some(terrain)) = (&state.kinds, terrain) else {
            continue;
        };
        let Some(mut fields) = fields else {
            commands.entity(entity).insert(FarFields::default());
            continue;
        };
        let known = fields.of.as_ref();
        if known.is_none_or(|(of, seed)| !Arc::ptr_eq(of, kinds) || *seed != grown.seed) {
            fields.of = Some((Arc::clone(kinds), grown.seed));
            fields.fitted = Arc::default();
            let (kinds, seed) = (Arc::clone(kinds), grown.seed);
            let task = AsyncComputeTaskPool::get().spawn(async move { fit(&kinds, seed) });
            fields.task = Some(task);
        }
        let found = fields.task.as_mut().map(|task| block_on(poll_once(task)));
        let is_new = match found {
            Some(Some(fitted)) => {
                fields.fitted = fitted.into();
                fields.task = None;
                true
            }
            Some(None) => false,
            None => grown.is_changed() || terrain.is_changed(),
        };
        if is_new {
            let sea = terrain.sea_level().unwrap_or(0.0);
            let layers = kinds.kinds.iter().zip(fields.fitted.iter());
            let layers =
                layers.filter_map(|(kind, far)| Some(layer(kind, far.as_ref()?, &grown, sea)));
            commands.entity(entity).insert(GroundCanopy {
                layers: layers.take(GroundCanopy::MOST_LAYERS).collect(),
            });
        }
    }
}

/// What no longer grows covers nothing.
fn forget(mut commands: Commands, left: Query<Entity, (With<FarFields>, Without<Vegetation>)>) {
    for entity in &left {
        commands
            .entity(entity)
            .remove::<(FarFields, GroundCanopy)>();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::law::Law;

    /// What the ground shows and what blades cover sum to the whole, wherever blades are thin.
    #[test]
    fn ground_and_blades_are_one_cover() {
        let kinds = Kinds::small_set();
        let (_, grass) = kinds.find("grass").expect("there");
        let far = FarField {
            entries: [[0.5, 0.1, 0.2, 0.05]; 17],
        };
        let grown = Vegetation::default();
        let law = Law::new(0.013, 935.0, grass.reach);
        let shown = layer(grass, &far, &grown, 20.0);
        for k in 0..100 {
            let distance = 40.0 + k as f32;
            let ground = shown.density(120.0, 0.0, distance);
            let sum = ground + law.cover(distance);
            assert!((sum - 1.0).abs() < 1e-5, "{distance}: {sum}");
        }
        // Below the shore that lies at 20 m, and of clumps the mean.
        assert_eq!(shown.density(20.5, 0.0, 1e4), 0.0);
        let clumps = 0.95 * (1.0 - 0.5 * 0.55);
        assert!((shown.entries[3][0] - 0.5 * clumps).abs() < 1e-6);
    }
}
