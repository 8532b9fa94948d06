//! What a picture needs of cameras, for as long as it is shown: a component each, lent and taken back.

use std::marker::PhantomData;

use bevy::app::{App, PostUpdate};
use bevy::ecs::prelude::*;
use bevy::ecs::query::QueryFilter;
use dolomite_deferred::{DeferredLighting, LightingDifference};
use dolomite_ground::{GroundInspection, TerrainView};
use dolomite_inspector::picture::FramePicture;
use dolomite_vegetation::{VegetationRanks, VegetationView};

/// A component that pictures read of cameras with some others.
trait Lends: Component + Clone + PartialEq {
    /// The cameras that it says something of.
    type Cameras: QueryFilter + 'static;

    /// What a picture of this name needs.
    fn of(picture: &str) -> Option<Self>;
}

impl Lends for GroundInspection {
    type Cameras = With<TerrainView>;

    fn of(picture: &str) -> Option<Self> {
        match picture {
            "ground_level" => Some(Self::Level),
            "ground_error" => Some(Self::Error),
            "ground_overdraw" => Some(Self::Overdraw),
            _ => None,
        }
    }
}

impl Lends for LightingDifference {
    type Cameras = With<DeferredLighting>;

    fn of(picture: &str) -> Option<Self> {
        (picture == "light_difference").then_some(Self)
    }
}

impl Lends for VegetationRanks {
    type Cameras = With<VegetationView>;

    fn of(picture: &str) -> Option<Self> {
        (picture == "grass_rank").then_some(Self)
    }
}

/// A camera has it for a picture alone.
#[derive(Component)]
struct Lent<T: Send + Sync + 'static>(PhantomData<T>);

/// Lends what pictures need, while one is shown that needs it.
pub(super) fn build(app: &mut App) {
    add::<GroundInspection>(app);
    add::<LightingDifference>(app);
    add::<VegetationRanks>(app);
}

fn add<T: Lends>(app: &mut App) {
    app.add_systems(PostUpdate, lend::<T>.run_if(is_needed::<T>));
}

fn is_needed<T: Lends>(shown: Option<Res<FramePicture>>, lent: Query<(), With<Lent<T>>>) -> bool {
    !lent.is_empty() || shown.is_some_and(|shown| T::of(&shown.shown).is_some())
}

/// Lends cameras what the picture reads, and takes it back. What a camera has of its own stays.
fn lend<T: Lends>(
    mut commands: Commands,
    shown: Res<FramePicture>,
    cameras: Query<(Entity, Option<&T>, Has<Lent<T>>), T::Cameras>,
) {
    let wanted = T::of(&shown.shown);
    for (camera, own, lent) in &cameras {
        let mut camera = commands.entity(camera);
        match &wanted {
            Some(what) if own.is_none() || (lent && own != Some(what)) => {
                camera.insert((what.clone(), Lent::<T>(PhantomData)));
            }
            None if lent => {
                camera.remove::<(T, Lent<T>)>();
            }
            _ => {}
        }
    }
}
