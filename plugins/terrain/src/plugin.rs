//! The ECS side: ground answers for entities, in f64, without a GPU.

use crate::ground::GroundSample;
use crate::terrain::Terrain;
use bevy::app::{App, Plugin, PostUpdate};
use bevy::ecs::prelude::*;
use bevy::math::DVec2;
use bevy::transform::{TransformSystems, components::Transform, helper::TransformHelper};

/// Fills every [`GroundProbe`] from the [`Terrain`] of the world.
///
/// Runs under `MinimalPlugins`, with or without the transform plugin. Probes are answered in
/// [`PostUpdate`] when they moved or were added or the terrain changed; a world without
/// terrain clears them. Transforms are f32, so a probe's place is: 1e4 m from the origin it is known to 1 mm.
#[derive(Clone, Copy, Debug, Default)]
pub struct TerrainPlugin;

impl Plugin for TerrainPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(PostUpdate, answer_probes.after(TransformSystems::Propagate));
    }
}

/// Asks for the ground under (or over) an entity.
///
/// The answer is that of the first entity with a [`Terrain`]; its frame is the world's, whatever
/// transform that entity has.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
#[require(Transform, Answered)]
pub struct GroundProbe {
    /// Height and gradient at the entity's (x, z); `None` before the first answer and where the
    /// world has no terrain.
    pub sample: Option<GroundSample>,
}

/// Where a probe was answered last.
#[derive(Component, Clone, Copy, Debug, Default)]
struct Answered(Option<DVec2>);

fn answer_probes(
    terrains: Query<Ref<Terrain>>,
    mut removed: RemovedComponents<Terrain>,
    mut probes: Query<(Entity, &mut GroundProbe, &mut Answered)>,
    places: TransformHelper,
) {
    let terrain = terrains.iter().next();
    let changed = removed.read().count() > 0 || terrains.iter().any(|terrain| terrain.is_changed());
    for (entity, mut probe, mut answered) in &mut probes {
        // An entity whose chain of parents is broken keeps its last answer.
        let Ok(place) = places.compute_global_transform(entity) else {
            continue;
        };
        let place = place.translation();
        let xz = DVec2::new(f64::from(place.x), f64::from(place.z));
        if answered.0 == Some(xz) && !changed {
            continue;
        }
        answered.0 = Some(xz);
        let sample = terrain.as_ref().map(|terrain| terrain.sample_f64(xz));
        probe.set_if_neq(GroundProbe { sample });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{GroundRect, Hill, Layer, Source, TerrainData};
    use bevy::MinimalPlugins;
    use bevy::transform::components::GlobalTransform;

    fn hill(height: f32) -> Terrain {
        let hill = Hill {
            centre: DVec2::ZERO,
            radius: 100.0,
            height,
        };
        Terrain::new(TerrainData {
            extent: GroundRect::square(DVec2::ZERO, 500.0),
            layers: vec![Layer {
                source: Source::Hill(hill),
                mask: None,
            }],
            base: 3.0,
            sea_level: None,
        })
        .expect("valid")
    }

    fn height(app: &App, probe: Entity) -> Option<f64> {
        app.world()
            .get::<GroundProbe>(probe)
            .and_then(|probe| probe.sample)
            .map(|s| s.height)
    }

    #[test]
    fn probes_follow_their_entities_and_the_terrain() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, TerrainPlugin));
        let parent = app
            .world_mut()
            .spawn(Transform::from_xyz(200.0, 0.0, 0.0))
            .id();
        let probe = app
            .world_mut()
            .spawn((GroundProbe::default(), ChildOf(parent)))
            .id();
        app.update();
        assert_eq!(height(&app, probe), None, "no terrain");

        let ground = app.world_mut().spawn(hill(50.0)).id();
        app.update();
        assert_eq!(
            height(&app, probe),
            Some(3.0),
            "beyond the hill, by the parent's place"
        );

        app.world_mut()
            .entity_mut(parent)
            .insert(Transform::default());
        app.update();
        assert_eq!(height(&app, probe), Some(53.0), "the parent moved");

        app.world_mut().entity_mut(ground).insert(hill(-1.0));
        app.update();
        assert_eq!(height(&app, probe), Some(2.0), "the ground changed");

        app.world_mut().entity_mut(ground).despawn();
        app.update();
        assert_eq!(height(&app, probe), None, "the ground is gone");
        assert!(app.world().get::<GlobalTransform>(probe).is_some());
    }

    #[test]
    fn still_probes_are_not_written() {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, TerrainPlugin));
        app.world_mut().spawn(hill(50.0));
        let probe = app.world_mut().spawn(GroundProbe::default()).id();
        app.update();
        let written = |app: &App| {
            app.world()
                .entity(probe)
                .get_change_ticks::<GroundProbe>()
                .map(|ticks| ticks.changed)
        };
        let before = written(&app);
        app.update();
        app.update();
        assert_eq!(written(&app), before);
        assert!(before.is_some());
    }
}
