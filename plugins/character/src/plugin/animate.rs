//! The poses of a frame, on all cores.

use super::ground::{CharacterGround, Ground};
use super::lod::Sampling;
use super::{Character, CharacterLod, CharacterMotion, CharacterPose, CharacterState};
use crate::blend::{Blender, Layer};
use crate::feet::{Footing, Place};
use crate::figure::{Figure, Input, Workspace};
use crate::gait::{turned, yaw_of};
use crate::pose::Pose;
use bevy::ecs::prelude::*;
use bevy::math::{Affine3A, DVec2, Quat, Vec2, Vec3};
use bevy::time::Time;
use bevy::transform::components::Transform;
use bevy::transform::helper::TransformHelper;
use bevy::utils::Parallel;
use dolomite_terrain::{GroundProbe, ProbeBatch, Terrain};

/// Memory of one thread.
#[derive(Default)]
pub(super) struct Memory {
    work: Workspace,
    blender: Blender,
    half: Pose,
}

pub(super) fn animate(
    time: Res<Time>,
    own: Option<Res<CharacterGround>>,
    terrains: Query<(Entity, &Terrain)>,
    batch: Option<Res<ProbeBatch>>,
    places: TransformHelper,
    mut figures: Query<(
        Entity,
        &Character,
        &CharacterMotion,
        &Transform,
        Has<ChildOf>,
        Option<&GroundProbe>,
        &mut CharacterState,
        &mut CharacterPose,
        &mut CharacterLod,
    )>,
    memory: Local<Parallel<Memory>>,
) {
    let terrains = in_order(&terrains);
    let ground = Ground {
        own: own.as_deref(),
        terrains: &terrains,
        frame: batch.map_or(0, |batch| batch.frame()),
    };
    let dt = time.delta_secs();
    let memory = &*memory;
    figures.par_iter_mut().for_each(
        |(
            entity,
            character,
            motion,
            own_place,
            has_parent,
            probe,
            mut state,
            mut pose,
            mut lod,
        )| {
            let place = if has_parent {
                // An entity whose chain of parents is broken rests.
                match places.compute_global_transform(entity) {
                    Ok(place) => place.affine(),
                    Err(_) => return,
                }
            } else {
                own_place.compute_affine()
            };
            let memory = &mut *memory.borrow_local_mut();
            let mut input = Input {
                dt,
                motion: motion.0,
                place: upright(&place),
            };
            if let Some(footing) = foot_of(&ground, &input.place, probe) {
                input.motion.slope = slope(&footing, &input.place);
            }
            let figure = &*character.figure;
            pose.root = figure.advance(&mut state.0, &input, &mut memory.work);
            lod.since += dt;
            if std::mem::take(&mut lod.owed) && lod.sampling == Sampling::Half {
                show_rest(figure, &mut pose);
                return;
            }
            if lod.sampling == Sampling::Off {
                return;
            }
            let before = (lod.sampling == Sampling::Half && lod.samples > 0)
                .then(|| std::mem::take(&mut pose.local));
            input.dt = lod.since;
            let mut answer = |xz: DVec2| ground.at(xz, probe);
            let answer = ground
                .is_there()
                .then_some(&mut answer as &mut dyn FnMut(DVec2) -> Option<Footing>);
            let CharacterPose { local, model, .. } = &mut *pose;
            figure.pose(&mut state.0, &input, answer, &mut memory.work, local, model);
            pose.place = place;
            lod.since = 0.0;
            lod.samples += 1;
            if let Some(before) = before {
                show_half(figure, &mut pose, &before, memory);
                lod.owed = true;
            }
        },
    );
}

/// All terrains in the order of their entities, which is also that of ground probes: of two that overlap the
/// same one answers both.
fn in_order<'a>(terrains: &'a Query<(Entity, &Terrain)>) -> Vec<&'a Terrain> {
    let mut found: Vec<(Entity, &Terrain)> = terrains.iter().collect();
    found.sort_unstable_by_key(|(entity, _)| entity.index_u32());
    found.into_iter().map(|(_, terrain)| terrain).collect()
}

/// Half-way between the pose of two frames ago and this one's, which the next frame shows.
fn show_half(figure: &Figure, pose: &mut CharacterPose, before: &Pose, memory: &mut Memory) {
    let skeleton = &figure.rig.skeleton;
    let layers = [before, &pose.local].map(|pose| Layer {
        pose,
        weight: 0.5,
        mask: None,
    });
    memory
        .blender
        .blend(skeleton.rest(), &layers, &mut memory.half);
    pose.next = std::mem::replace(&mut pose.local, memory.half.clone());
    skeleton.local_to_model(&pose.local, &mut pose.model);
}

/// What was sampled a frame ago.
fn show_rest(figure: &Figure, pose: &mut CharacterPose) {
    pose.local = std::mem::take(&mut pose.next);
    let CharacterPose { local, model, .. } = pose;
    figure.rig.skeleton.local_to_model(local, model);
}

/// Legs are bent in a frame that is turned about +y alone.
fn upright(place: &Affine3A) -> Place {
    let (_, rotation, translation) = place.to_scale_rotation_translation();
    Place {
        position: translation.as_dvec3(),
        rotation: turned(yaw_of(rotation)),
    }
}

fn foot_of(ground: &Ground, place: &Place, probe: Option<&GroundProbe>) -> Option<Footing> {
    ground.at(DVec2::new(place.position.x, place.position.z), probe)
}

/// Rise to the figure's left and ahead.
fn slope(footing: &Footing, place: &Place) -> Vec2 {
    let gradient = footing.gradient.as_vec2();
    let along = |rotation: Quat, axis: Vec3| {
        let way = rotation * axis;
        gradient.dot(Vec2::new(way.x, way.z))
    };
    Vec2::new(
        along(place.rotation, Vec3::X),
        along(place.rotation, Vec3::Z),
    )
}
