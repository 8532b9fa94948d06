//! `bevy_animation` 0.19, as an app uses it: a graph that blends three clips, an entity for each joint.

use super::method::{Input, Method};
use super::model::Model;
use bevy::MinimalPlugins;
use bevy::app::App;
use bevy::ecs::prelude::*;
use bevy::math::curve::{ConstantCurve, Interval};
use bevy::math::{Quat, Vec3, Vec4};
use bevy::time::TimeUpdateStrategy;
use bevy::transform::components::Transform;
use bevy_animation::animation_curves::AnimatedField;
use bevy_animation::gltf_curves::{CubicKeyframeCurve, CubicRotationCurve, SteppedKeyframeCurve};
use bevy_animation::graph::{AnimationGraph, AnimationGraphHandle, AnimationNodeIndex};
use bevy_animation::prelude::{AnimatableCurve, AnimatableKeyframeCurve, VariableCurve};
use bevy_animation::{
    AnimatedBy, AnimationClip, AnimationPlayer, AnimationPlugin, AnimationTargetId,
    RepeatAnimation, animated_field,
};
use bevy_asset::{AssetPlugin, Assets, Handle};
use dolomite_character::clip::oracle::Transform64;
use dolomite_character::{Channel, ClipData, Interpolation, Skeleton, Values};
use std::time::Duration;

/// An app with one figure, or a crowd.
pub struct Bevy {
    app: App,
    skeleton: Skeleton,
    /// Blends the three clips, in their order.
    graph: Handle<AnimationGraph>,
    blended: Vec<(usize, AnimationNodeIndex)>,
    /// Of every clip: a graph of its own, for single samples.
    singles: Vec<(Handle<AnimationGraph>, AnimationNodeIndex)>,
    /// The player and the joints of the figure that single blends are made with.
    probe: (Entity, Vec<Entity>),
}

fn target(joint: usize) -> AnimationTargetId {
    AnimationTargetId::from_iter([format!("joint {joint}")])
}

impl Bevy {
    /// Of a model; blends are of these clips, in this order.
    pub fn new(model: &Model, clips: [usize; 3]) -> Self {
        let mut app = App::new();
        app.add_plugins((MinimalPlugins, AssetPlugin::default(), AnimationPlugin))
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
        let handles: Vec<Handle<AnimationClip>> = model
            .rig
            .sources
            .iter()
            .map(|data| {
                app.world_mut()
                    .resource_mut::<Assets<AnimationClip>>()
                    .add(clip(data))
            })
            .collect();
        let mut graphs = app.world_mut().resource_mut::<Assets<AnimationGraph>>();
        let mut graph = AnimationGraph::new();
        let blended = clips
            .iter()
            .map(|clip| {
                (
                    *clip,
                    graph.add_clip(handles[*clip].clone(), 1.0, graph.root),
                )
            })
            .collect();
        let graph = graphs.add(graph);
        let singles = handles
            .iter()
            .map(|handle| {
                let (graph, node) = AnimationGraph::from_clip(handle.clone());
                (graphs.add(graph), node)
            })
            .collect();
        let mut bevy = Self {
            probe: (Entity::PLACEHOLDER, Vec::new()),
            app,
            skeleton: model.rig.skeleton.clone(),
            graph,
            blended,
            singles,
        };
        bevy.probe = bevy.spawn();
        bevy.app.update();
        bevy
    }

    /// A player, and an entity for each joint, in the tree that the skeleton is.
    fn spawn(&mut self) -> (Entity, Vec<Entity>) {
        let graph = AnimationGraphHandle(self.graph.clone());
        let world = self.app.world_mut();
        let player = world
            .spawn((AnimationPlayer::default(), graph, Transform::default()))
            .id();
        let mut joints: Vec<Entity> = Vec::with_capacity(self.skeleton.len());
        for joint in 0..self.skeleton.len() {
            let rest = self.skeleton.rest().get(joint);
            let above = self
                .skeleton
                .parent(joint)
                .map_or(player, |parent| joints[parent]);
            let transform = Transform {
                translation: rest.translation,
                rotation: rest.rotation,
                scale: rest.scale,
            };
            let spawned =
                world.spawn((transform, target(joint), AnimatedBy(player), ChildOf(above)));
            joints.push(spawned.id());
        }
        (player, joints)
    }

    /// Takes joints that a clip does not move back to rest.
    fn rest(&mut self) {
        for (joint, entity) in self.probe.1.iter().enumerate() {
            let rest = self.skeleton.rest().get(joint);
            let mut transform = self
                .app
                .world_mut()
                .get_mut::<Transform>(*entity)
                .expect("a joint that was spawned");
            *transform = Transform {
                translation: rest.translation,
                rotation: rest.rotation,
                scale: rest.scale,
            };
        }
    }
}

/// The curves that Bevy's glTF loader makes.
fn clip(data: &ClipData) -> AnimationClip {
    let mut clip = AnimationClip::default();
    for channel in &data.channels {
        let id = target(channel.joint);
        match &channel.values {
            Values::Translation(values) => {
                let field = || animated_field!(Transform::translation);
                match vectors(channel, values) {
                    Curve::Linear(curve) => {
                        clip.add_curve_to_target(id, AnimatableCurve::new(field(), curve))
                    }
                    Curve::Step(curve) => {
                        clip.add_curve_to_target(id, AnimatableCurve::new(field(), curve))
                    }
                    Curve::Cubic(curve) => {
                        clip.add_curve_to_target(id, AnimatableCurve::new(field(), curve))
                    }
                    Curve::Still(curve) => {
                        clip.add_curve_to_target(id, AnimatableCurve::new(field(), curve));
                    }
                }
            }
            Values::Scale(values) => {
                let field = || animated_field!(Transform::scale);
                match vectors(channel, values) {
                    Curve::Linear(curve) => {
                        clip.add_curve_to_target(id, AnimatableCurve::new(field(), curve))
                    }
                    Curve::Step(curve) => {
                        clip.add_curve_to_target(id, AnimatableCurve::new(field(), curve))
                    }
                    Curve::Cubic(curve) => {
                        clip.add_curve_to_target(id, AnimatableCurve::new(field(), curve))
                    }
                    Curve::Still(curve) => {
                        clip.add_curve_to_target(id, AnimatableCurve::new(field(), curve));
                    }
                }
            }
            Values::Rotation(values) => rotations(&mut clip, id, channel, values),
        }
    }
    clip
}

enum Curve {
    Linear(AnimatableKeyframeCurve<Vec3>),
    Step(SteppedKeyframeCurve<Vec3>),
    Cubic(CubicKeyframeCurve<Vec3>),
    /// Of a single key.
    Still(ConstantCurve<Vec3>),
}

fn vectors(channel: &Channel, values: &[[f32; 3]]) -> Curve {
    let keys = channel
        .times
        .iter()
        .copied()
        .zip(values.iter().map(|value| Vec3::from(*value)));
    let curve = match channel.interpolation {
        Interpolation::Linear => AnimatableKeyframeCurve::new(keys).map(Curve::Linear).ok(),
        Interpolation::Step => SteppedKeyframeCurve::new(keys).map(Curve::Step).ok(),
        Interpolation::Cubic => {
            let values = values.iter().map(|value| Vec3::from(*value));
            CubicKeyframeCurve::new(channel.times.clone(), values)
                .map(Curve::Cubic)
                .ok()
        }
    };
    // As Bevy's loader does it.
    curve.unwrap_or_else(|| {
        Curve::Still(ConstantCurve::new(
            Interval::EVERYWHERE,
            Vec3::from(values[0]),
        ))
    })
}

fn rotations(
    clip: &mut AnimationClip,
    id: AnimationTargetId,
    channel: &Channel,
    values: &[[f32; 4]],
) {
    let field = || animated_field!(Transform::rotation);
    let keys = channel
        .times
        .iter()
        .copied()
        .zip(values.iter().map(|value| Quat::from_array(*value)));
    let curve = match channel.interpolation {
        Interpolation::Linear => AnimatableKeyframeCurve::new(keys)
            .ok()
            .map(|curve| VariableCurve::new(AnimatableCurve::new(field(), curve))),
        Interpolation::Step => SteppedKeyframeCurve::new(keys)
            .ok()
            .map(|curve| VariableCurve::new(AnimatableCurve::new(field(), curve))),
        Interpolation::Cubic => {
            let values = values.iter().map(|value| Vec4::from(*value));
            CubicRotationCurve::new(channel.times.clone(), values)
                .ok()
                .map(|curve| VariableCurve::new(AnimatableCurve::new(field(), curve)))
        }
    };
    let curve = curve.unwrap_or_else(|| {
        let key = ConstantCurve::new(Interval::EVERYWHERE, Quat::from_array(values[0]));
        VariableCurve::new(AnimatableCurve::new(field(), key))
    });
    clip.add_variable_curve_to_target(id, curve);
}

impl Method for Bevy {
    fn name(&self) -> &'static str {
        "bevy_animation 0.19"
    }

    fn blend(&mut self, inputs: &[Input]) -> Vec<Transform64> {
        self.rest();
        let nodes: Vec<AnimationNodeIndex> = match inputs {
            [one] => vec![self.singles[one.clip].1],
            _ => self.blended.iter().map(|(_, node)| *node).collect(),
        };
        let graph = match inputs {
            [one] => self.singles[one.clip].0.clone(),
            _ => {
                let same = inputs
                    .iter()
                    .zip(&self.blended)
                    .all(|(input, (clip, _))| input.clip == *clip);
                assert!(same, "the graph blends its own clips, in its own order");
                self.graph.clone()
            }
        };
        let mut player = self.app.world_mut().entity_mut(self.probe.0);
        player.insert(AnimationGraphHandle(graph));
        let mut player = player
            .get_mut::<AnimationPlayer>()
            .expect("a player that was spawned");
        player.stop_all();
        for (node, input) in nodes.into_iter().zip(inputs) {
            player
                .play(node)
                .seek_to(input.time)
                .set_weight(input.weight)
                .pause();
        }
        self.app
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::ZERO));
        self.app.update();
        let world = self.app.world();
        self.probe
            .1
            .iter()
            .map(|joint| {
                let local = world
                    .get::<Transform>(*joint)
                    .expect("a joint that was spawned");
                Transform64 {
                    translation: local.translation.to_array().map(f64::from),
                    rotation: local.rotation.to_array().map(f64::from),
                    scale: local.scale.to_array().map(f64::from),
                }
            })
            .collect()
    }

    fn crowd(&mut self, figures: &[[Input; 3]]) {
        for inputs in figures {
            let (player, _) = self.spawn();
            let nodes = self.blended.clone();
            let mut player = self
                .app
                .world_mut()
                .get_mut::<AnimationPlayer>(player)
                .expect("just spawned");
            for ((_, node), input) in nodes.iter().zip(inputs) {
                player
                    .play(*node)
                    .set_repeat(RepeatAnimation::Forever)
                    .seek_to(input.time)
                    .set_weight(input.weight);
            }
        }
        let probe = self.probe.0;
        self.app
            .world_mut()
            .get_mut::<AnimationPlayer>(probe)
            .expect("a player that was spawned")
            .stop_all();
        self.app.update();
    }

    fn frame(&mut self, dt: f32, model: bool) -> bool {
        if model {
            return false;
        }
        self.app
            .insert_resource(TimeUpdateStrategy::ManualDuration(Duration::from_secs_f32(
                dt,
            )));
        self.app.update();
        true
    }

    fn bytes(&self) -> Option<usize> {
        None
    }
}
