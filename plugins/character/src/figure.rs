//! A figure: everything from what gameplay says to a pose, for one frame.

use crate::blend::{Blender, Layer, Mask};
use crate::clip::Sampler;
use crate::feet::{Body, Feet, FeetSettings, Footing, Place, Sole};
use crate::gait::{
    Gait, GaitData, GaitError, Lean, LeanSettings, Locomotion, Motion, RootDelta, root_delta,
    turned,
};
use crate::load::Rig;
use crate::pose::Pose;
use bevy::math::{Affine3A, DVec2, Vec3};

/// What figures of one model share.
#[derive(Clone, Debug)]
pub struct Figure {
    /// Joints and clips.
    pub rig: Rig,
    /// What its clips mean.
    pub gait: Gait,
    /// How it leans.
    pub lean: LeanSettings,
    /// How it stands.
    pub feet: FeetSettings,
    /// The root joint whose way over the ground is the figure's, if it is taken out of the clips.
    pub root_motion: Option<usize>,
    /// Metres from the ground to the top of its head at rest.
    pub height: f32,
    soles: Option<[Sole; 2]>,
}

/// What one figure remembers from frame to frame.
#[derive(Clone, Debug, Default)]
pub struct FigureState {
    /// Its gait.
    pub locomotion: Locomotion,
    /// Its lean.
    pub lean: Lean,
    /// Its feet.
    pub feet: Feet,
}

/// What a frame is told.
#[derive(Clone, Copy, Debug)]
pub struct Input {
    /// Seconds since the last one.
    pub dt: f32,
    /// What gameplay wants.
    pub motion: Motion,
    /// Where the figure is.
    pub place: Place,
}

/// Memory for [`Figure::pose`]; one for each thread is enough. Its history changes no result.
#[derive(Clone, Debug, Default)]
pub struct Workspace {
    sampler: Sampler,
    blender: Blender,
    poses: Vec<Pose>,
    weights: Vec<(f32, Option<usize>)>,
    mixed: Pose,
}

impl Figure {
    /// A figure of `rig` whose clips mean `gaits`.
    ///
    /// # Errors
    /// [`GaitError`], where clips or joints are not there.
    pub fn new(rig: Rig, gaits: &GaitData) -> Result<Self, GaitError> {
        let gait = gaits.resolve(&rig)?;
        let soles = gait
            .legs
            .map(|legs| legs.map(|leg| Sole::new(&rig.skeleton, &leg)));
        let joints = rig.skeleton.rest_model();
        let height = joints
            .iter()
            .map(|joint| joint.translation.y)
            .fold(0.0, f32::max);
        Ok(Self {
            rig,
            gait,
            lean: LeanSettings::default(),
            feet: FeetSettings::default(),
            root_motion: None,
            height,
            soles,
        })
    }

    /// Goes on by `input.dt`, without a pose: what a figure out of sight costs. Gives the way that its
    /// clips carry it, if [`Figure::root_motion`] names a joint.
    pub fn advance(
        &self,
        state: &mut FigureState,
        input: &Input,
        work: &mut Workspace,
    ) -> RootDelta {
        let before = state.locomotion.clone();
        state
            .locomotion
            .advance(&self.gait, &self.rig.clips, &input.motion, input.dt);
        let acceleration = state.locomotion.speed.speed;
        state
            .lean
            .advance(&self.lean, &input.motion, acceleration, input.dt);
        match self.root_motion {
            Some(root) => self.travel(root, &before, &state.locomotion, input.dt, work),
            None => RootDelta::default(),
        }
    }

    /// The weighted mean of what the clips' root does.
    fn travel(
        &self,
        root: usize,
        before: &Locomotion,
        after: &Locomotion,
        dt: f32,
        work: &mut Workspace,
    ) -> RootDelta {
        let clips = &self.rig.clips;
        let mut from = Vec::new();
        before.voices(&self.gait, clips, |voice| from.push(voice));
        let mut sum = RootDelta::default();
        after.voices(&self.gait, clips, |voice| {
            let clip = &clips[voice.clip];
            // The voice's own earlier moment: the nearest one of the same clip, a frame ago.
            let earlier = from
                .iter()
                .filter(|old| old.clip == voice.clip)
                .map(|old| old.time)
                .min_by(|a, b| {
                    (voice.time - a - dt)
                        .abs()
                        .total_cmp(&(voice.time - b - dt).abs())
                })
                .unwrap_or(voice.time);
            // Half a turn back at most: from the end of a repeating clip to its begin is a step on.
            let half = 0.5 * clip.duration();
            let to = match voice.time - earlier {
                way if way < -half => voice.time + clip.duration(),
                way if way > half => voice.time - clip.duration(),
                _ => voice.time,
            };
            let step = root_delta(
                clip,
                root,
                earlier,
                to,
                true,
                &mut work.sampler,
                &mut work.mixed,
            );
            sum.translation += step.translation * voice.weight;
            sum.yaw += step.yaw * voice.weight;
        });
        sum
    }

    /// The pose of this moment, and its matrices in the model's frame. `ground` answers at world places
    /// (x, z); without it, or without legs, the feet are where the clips have them.
    pub fn pose(
        &self,
        state: &mut FigureState,
        input: &Input,
        ground: Option<&mut dyn FnMut(DVec2) -> Option<Footing>>,
        work: &mut Workspace,
        pose: &mut Pose,
        model: &mut Vec<Affine3A>,
    ) {
        self.mix(&state.locomotion, work, pose);
        if let Some(root) = self.root_motion {
            let mut local = pose.get(root);
            local.translation.x = 0.0;
            local.translation.z = 0.0;
            let yaw = crate::gait::yaw_of(local.rotation);
            local.rotation = turned(-yaw) * local.rotation;
            pose.set(root, local);
        }
        let skeleton = &self.rig.skeleton;
        skeleton.local_to_model(pose, model);
        state.lean.apply(skeleton, &self.gait.spine, model, pose);
        skeleton.local_to_model(pose, model);
        let (Some(ground), Some(legs), Some(soles)) = (ground, self.gait.legs, self.soles) else {
            return;
        };
        let body = Body {
            skeleton,
            pelvis: self.gait.pelvis,
            legs,
            soles,
        };
        let step = state.locomotion.step(&self.gait, input.dt);
        state
            .feet
            .plant(&body, &self.feet, &input.place, &step, ground, pose, model);
    }

    /// Samples and blends all voices, and lays one-shots over them.
    fn mix(&self, locomotion: &Locomotion, work: &mut Workspace, pose: &mut Pose) {
        let clips = &self.rig.clips;
        let Workspace {
            sampler,
            blender,
            poses,
            weights,
            mixed,
        } = work;
        weights.clear();
        let mut sample = |clip: usize, time: f32, weight: f32, of: Option<usize>| {
            if poses.len() == weights.len() {
                poses.push(Pose::default());
            }
            sampler.sample(&clips[clip], time, &mut poses[weights.len()]);
            weights.push((weight, of));
        };
        locomotion.voices(&self.gait, clips, |voice| {
            sample(voice.clip, voice.time, voice.weight, None)
        });
        locomotion.overlays(|over| {
            if let Some((clip, _)) = self.gait.one_shots.get(over.one_shot) {
                sample(*clip, over.time, over.weight, Some(over.one_shot));
            }
        });
        let layers = |wanted: Option<usize>| -> Vec<Layer> {
            let chosen = poses
                .iter()
                .zip(weights.iter())
                .filter(|(_, (_, of))| *of == wanted);
            chosen
                .map(|(pose, (weight, _))| Layer {
                    pose,
                    weight: *weight,
                    mask: None,
                })
                .collect()
        };
        let rest = self.rig.skeleton.rest();
        blender.blend(rest, &layers(None), pose);
        for (one_shot, (_, mask)) in self.gait.one_shots.iter().enumerate() {
            let over = layers(Some(one_shot));
            let weight: f32 = over.iter().map(|layer| layer.weight).sum();
            if weight > 0.0 {
                blender.blend(rest, &over, mixed);
                let layer = Layer {
                    pose: mixed,
                    weight,
                    mask: mask.as_ref(),
                };
                blender.lay_over(&layer, pose);
            }
        }
    }

    /// The mask of a branch of joints, for layers of one's own.
    #[must_use]
    pub fn branch(&self, joint: &str) -> Option<Mask> {
        let joint = self.rig.skeleton.find(joint)?;
        Some(Mask::branch(&self.rig.skeleton, joint))
    }

    /// Heel and ball of a foot (0 left, 1 right) under these matrices, in their frame; `None` without legs.
    #[must_use]
    pub fn sole(&self, side: usize, model: &[Affine3A]) -> Option<[Vec3; 2]> {
        let (legs, soles) = (self.gait.legs?, self.soles?);
        let (leg, sole) = (legs.get(side)?, soles.get(side)?);
        let ankle = model.get(leg.ankle)?;
        Some([sole.heel, sole.ball].map(|point| ankle.transform_point3(point)))
    }
}
