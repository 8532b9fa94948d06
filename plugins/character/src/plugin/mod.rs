//! Figures in a Bevy app, with or without a renderer.
//!
//! | component | who writes it | what it is |
//! |---|---|---|
//! | [`Character`] | you | which figure |
//! | [`CharacterMotion`] | you, or [`MotionFromTransform`] | what it does |
//! | [`CharacterPose`] | the plugin | where its joints are |
//! | [`CharacterLod`] | the plugin | how often it is sampled, and why |
//! | [`CharacterJoints`] | the plugin | entities of a glTF scene below it, whose transforms follow the joints |
//! | [`CharacterEye`] | you, on cameras | from where figures are seen; without one all are sampled every frame |
//!
//! The figure looks along its entity's +z, as glTF models do; its soles are at the entity's origin.

mod animate;
mod diagnostics;
mod ground;
mod joints;
mod lod;
mod motion;

pub use diagnostics::CharacterCounters;
pub use ground::CharacterGround;
pub use joints::CharacterJoints;
pub use lod::{CharacterEye, CharacterLod, Sampling};
pub use motion::MotionFromTransform;

use crate::figure::{Figure, FigureState};
use crate::gait::{Motion, RootDelta};
use crate::pose::Pose;
use bevy::app::{App, Plugin, PostUpdate};
use bevy::ecs::prelude::*;
use bevy::math::Affine3A;
use bevy::reflect::prelude::*;
use bevy::transform::TransformSystems;
use bevy::transform::components::Transform;
use std::sync::Arc;

/// An animated figure.
#[derive(Component, Clone, Debug)]
#[require(
    Transform,
    CharacterMotion,
    CharacterState,
    CharacterPose,
    CharacterLod
)]
pub struct Character {
    /// Its model, clips and gaits; shared by all of its kind.
    pub figure: Arc<Figure>,
}

/// What a figure does: written by gameplay, or by [`MotionFromTransform`]. Where there is ground under it,
/// its `slope` is found by the plugin.
#[derive(Component, Reflect, Clone, Copy, Debug, Default, PartialEq)]
#[reflect(Component, Default, PartialEq)]
pub struct CharacterMotion(pub Motion);

/// What a figure remembers.
#[derive(Component, Clone, Debug, Default)]
pub struct CharacterState(pub FigureState);

impl CharacterState {
    /// Lays a one-shot of its gaits over the rest.
    pub fn play(&mut self, one_shot: usize) {
        self.0.locomotion.play(one_shot);
    }

    /// Lays a one-shot over the rest for as long as it is asked for; when it is over its last pose stays.
    pub fn hold(&mut self, one_shot: Option<usize>) {
        self.0.locomotion.hold(one_shot);
    }

    /// Ends at once what is played: what is held is seen instead.
    pub fn cut(&mut self) {
        self.0.locomotion.cut();
    }
}

/// Where a figure's joints are.
#[derive(Component, Clone, Debug, Default)]
pub struct CharacterPose {
    /// Local transforms.
    pub local: Pose,
    /// Matrices in the model's frame.
    pub model: Vec<Affine3A>,
    /// From the model's frame to the world's, when it was last sampled.
    pub place: Affine3A,
    /// The way that its clips carried it in the last frame, if its figure takes it out of them
    /// ([`Figure::root_motion`]): whoever moves the entity may add it.
    pub root: RootDelta,
    /// What the next frame shows, of a figure that is sampled every second one.
    pub(crate) next: Pose,
}

impl CharacterPose {
    /// The matrix of a joint in the world; `None` before the first sample, or without such a joint.
    #[must_use]
    pub fn world(&self, joint: usize) -> Option<Affine3A> {
        self.model.get(joint).map(|model| self.place * *model)
    }
}

/// Systems of figures, in `PostUpdate`, before transforms are propagated.
#[derive(SystemSet, Clone, Debug, PartialEq, Eq, Hash)]
pub enum CharacterSystems {
    /// What moved, and who is seen.
    Prepare,
    /// Poses.
    Animate,
    /// Entities of joints follow.
    Joints,
}

/// Animates every [`Character`]. Runs under `MinimalPlugins`, with or without the transform plugin.
///
/// May be added before or after Bevy's plugins, and more than once.
///
/// Feet stand on the world's [`CharacterGround`], or else on the [`Terrain`](dolomite_terrain::Terrain) that
/// [`terrain_at`](dolomite_terrain::terrain_at) chooses for each place; a figure with a
/// [`GroundProbe`](dolomite_terrain::GroundProbe) stands on the drawn surface where that is known.
#[derive(Clone, Copy, Debug, Default)]
pub struct CharacterPlugin;

impl Plugin for CharacterPlugin {
    fn build(&self, app: &mut App) {
        if app.world().contains_resource::<CharacterCounters>() {
            return;
        }
        diagnostics::build(app);
        app.register_type::<CharacterCounters>()
            .register_type::<CharacterEye>()
            .register_type::<CharacterJoints>()
            .register_type::<CharacterLod>()
            .register_type::<CharacterMotion>()
            .register_type::<MotionFromTransform>();
        app.configure_sets(
            PostUpdate,
            (
                CharacterSystems::Prepare,
                CharacterSystems::Animate,
                CharacterSystems::Joints,
            )
                .chain()
                .before(TransformSystems::Propagate),
        )
        .add_systems(
            PostUpdate,
            (
                (motion::measure, lod::choose, joints::bind).in_set(CharacterSystems::Prepare),
                (animate::animate, diagnostics::count)
                    .chain()
                    .in_set(CharacterSystems::Animate),
                joints::follow.in_set(CharacterSystems::Joints),
            )
                .run_if(any_with_component::<Character>),
        );
    }

    fn is_unique(&self) -> bool {
        false
    }
}
