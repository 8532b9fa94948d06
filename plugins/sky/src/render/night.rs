//! Who sees stars and moon, and when: they are spawned as they come out, and taken away by day.

use std::sync::Arc;

use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass};
use bevy::ecs::component::Mutable;
use bevy::prelude::*;
use dolomite_tessellation::render::PatchKind;
use dolomite_tessellation::{GeometryCamera, PatchMesh, Patches};

use super::dome::Dome;
use super::dress::DrawnSky;
use crate::components::Sky;
use crate::seen::SeenSky;

/// How something hangs in the sky.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hung {
    /// Place seen from the camera, metres.
    pub offset: Vec3,
    pub rotation: Quat,
    pub scale: f32,
}

/// A kind of patches in the night sky.
pub(super) trait NightKind:
    PatchKind + Component<Mutability = Mutable> + Default + PartialEq
{
    /// What it is called.
    const NAME: &'static str;

    /// Its light in the sky of a camera; `None` while nothing of it is seen.
    fn of(seen: &SeenSky, drawn: &DrawnSky) -> Option<Self>;

    /// Where it hangs.
    fn hung(seen: &SeenSky) -> Hung;

    /// Its patches; made once, when they are first seen. `None`, after a line that says so, if they
    /// cannot be.
    fn mesh() -> Option<PatchMesh>;
}

/// The patches of a kind, once they were needed.
#[derive(Resource)]
pub(super) struct NightMesh<K: Send + Sync + 'static>(
    Arc<PatchMesh>,
    std::marker::PhantomData<fn() -> K>,
);

/// On cameras that tessellate for the sky's sake alone.
#[derive(Component)]
pub(super) struct StageForSky;

/// What has been said.
#[derive(Default)]
pub(super) struct Told {
    samples: bool,
    others: bool,
}

type NightCamera<'a> = (
    Entity,
    &'a SeenSky,
    &'a DrawnSky,
    Option<&'a Msaa>,
    Has<GeometryCamera>,
    Has<DepthPrepass>,
    Has<DeferredPrepass>,
);

/// Spawns, moves and despawns what of a kind is seen, and gives it its light.
///
/// A kind has one light for all its views: that of the first camera. Cameras whose sky gives another
/// see none of the kind.
pub(super) fn show<K: NightKind>(
    mut commands: Commands,
    mut kind: ResMut<K>,
    mesh: Option<Res<NightMesh<K>>>,
    cameras: Query<NightCamera>,
    mut hanging: Query<(Entity, &mut Dome, &mut Transform), With<Patches<K>>>,
    mut told: Local<Told>,
) {
    let mut seen_by: Vec<(Entity, Hung)> = Vec::new();
    let mut wanted: Option<K> = None;
    let mut cameras: Vec<_> = cameras.iter().collect();
    cameras.sort_by_key(|(camera, ..)| camera.index_u32());
    for (camera, seen, drawn, msaa, staged, depth, deferred) in cameras {
        let Some(of) = K::of(seen, drawn) else {
            continue;
        };
        if msaa.is_some_and(|msaa| msaa.samples() > 1) {
            if !std::mem::replace(&mut told.samples, true) {
                let name = K::NAME;
                warn!("{camera} does not see {name}, drawn with one sample: give it Msaa::Off");
            }
            continue;
        }
        match &wanted {
            Some(first) if *first != of => {
                if !std::mem::replace(&mut told.others, true) {
                    let name = K::NAME;
                    warn!(
                        "{camera} does not see {name}: all cameras that do have skies alike, and it \
                         has another Sky or exposure than the first"
                    );
                }
                continue;
            }
            Some(_) => {}
            None => wanted = Some(of),
        }
        if !staged {
            let mut camera = commands.entity(camera);
            camera.insert((GeometryCamera::default(), StageForSky));
            // Required by it, and needed for surfaces that receive light alone.
            if !deferred {
                camera.remove::<DeferredPrepass>();
            }
            if !depth {
                camera.remove::<DepthPrepass>();
            }
        }
        seen_by.push((camera, K::hung(seen)));
    }
    for (entity, mut dome, mut place) in &mut hanging {
        let found = seen_by
            .iter()
            .position(|(camera, _)| *camera == dome.camera);
        let Some(found) = found else {
            commands.entity(entity).despawn();
            continue;
        };
        let (_, hung) = seen_by.swap_remove(found);
        if dome.offset != hung.offset {
            dome.offset = hung.offset;
        }
        place.set_if_neq(Transform {
            rotation: hung.rotation,
            scale: Vec3::splat(hung.scale),
            ..*place
        });
    }
    // Nothing seen: the map of the last night is let go of.
    kind.set_if_neq(wanted.unwrap_or_default());
    if seen_by.is_empty() {
        return;
    }
    let mesh = match mesh {
        Some(mesh) => mesh.0.clone(),
        None => {
            let Some(mesh) = K::mesh() else {
                return;
            };
            let mesh = Arc::new(mesh);
            commands.insert_resource(NightMesh::<K>(mesh.clone(), std::marker::PhantomData));
            mesh
        }
    };
    for (camera, hung) in seen_by {
        let mut patches = Patches::<K>::new(mesh.clone());
        patches.camera = Some(camera);
        commands.spawn((
            Dome {
                camera,
                offset: hung.offset,
            },
            patches,
            Transform {
                rotation: hung.rotation,
                scale: Vec3::splat(hung.scale),
                ..default()
            },
        ));
    }
}

/// Takes the stage away that was there for the sky's sake, once all is gone that goes with the sky.
pub(super) fn unstage(
    removed: On<Remove, Sky>,
    mut commands: Commands,
    staged: Query<(), With<StageForSky>>,
) {
    let camera = removed.entity;
    if staged.contains(camera) {
        commands.queue(move |world: &mut World| take_stage(world, camera));
    }
}

fn take_stage(world: &mut World, camera: Entity) {
    // It may have been despawned with its sky.
    let Ok(entity) = world.get_entity(camera) else {
        return;
    };
    let needed = is_needed(world, entity);
    let mut camera = world.entity_mut(camera);
    camera.remove::<StageForSky>();
    if !needed {
        camera.remove::<GeometryCamera>();
    }
}

/// Whether the camera's stage is somebody else's too: it has settings of its own by now, or another component of the
/// camera requires it, as the view of a terrain does.
fn is_needed(world: &World, camera: EntityRef) -> bool {
    let own = camera.get::<GeometryCamera>();
    if own.is_some_and(|own| *own != GeometryCamera::default()) {
        return true;
    }
    let components = world.components();
    let Some(stage) = components.component_id::<GeometryCamera>() else {
        return false;
    };
    camera.archetype().iter_components().any(|id| {
        components
            .get_info(id)
            .is_some_and(|info| info.required_components().iter_ids().any(|id| id == stage))
    })
}
