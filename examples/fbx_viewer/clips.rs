//! Plays the clips of the model, by Bevy's own animation.

use bevy::prelude::*;

use super::{Arguments, Model, Shown, State};

/// Which clip plays, and how.
#[derive(Resource, Default)]
pub struct Playing {
    /// Names, in the file's order.
    pub names: Vec<String>,
    /// Seconds of each.
    pub seconds: Vec<f32>,
    /// The one that plays.
    pub clip: usize,
    /// Seconds into it.
    pub at: f32,
    /// 1 is as fast as it was made.
    pub speed: f32,
    /// Stands still.
    pub paused: bool,
    nodes: Vec<AnimationNodeIndex>,
}

/// Clips.
pub struct ClipsPlugin;

impl Plugin for ClipsPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<Playing>()
            .add_systems(Update, (begin, keys, play).chain());
    }
}

/// Finds the clips of a model that has come.
fn begin(
    mut commands: Commands,
    shown: Res<Shown>,
    arguments: Res<Arguments>,
    gltfs: Res<Assets<Gltf>>,
    clips: Res<Assets<AnimationClip>>,
    mut graphs: ResMut<Assets<AnimationGraph>>,
    mut playing: ResMut<Playing>,
    models: Query<Entity, With<Model>>,
    children: Query<&Children>,
    players: Query<(), With<AnimationPlayer>>,
    mut was: Local<Option<State>>,
) {
    if was.replace(shown.state.clone()).as_ref() == Some(&shown.state) {
        return;
    }
    *playing = Playing {
        speed: 1.0,
        ..default()
    };
    let Some(gltf) = gltfs
        .get(&shown.gltf)
        .filter(|_| shown.state == State::Ready)
    else {
        return;
    };
    let (graph, nodes) = AnimationGraph::from_clips(gltf.animations.iter().cloned());
    let graph = AnimationGraphHandle(graphs.add(graph));
    for model in &models {
        for below in children.iter_descendants(model) {
            if players.contains(below) {
                commands.entity(below).insert(graph.clone());
            }
        }
    }
    let name_of = |number: usize| {
        let named = gltf.named_animations.iter();
        let mut same = named.filter(|(_, clip)| clip.id() == gltf.animations[number].id());
        same.next()
            .map_or_else(|| format!("clip {number}"), |(name, _)| name.to_string())
    };
    playing.names = (0..nodes.len()).map(name_of).collect();
    let length = |clip: &Handle<AnimationClip>| clips.get(clip).map_or(0.0, |clip| clip.duration());
    playing.seconds = gltf.animations.iter().map(length).collect();
    playing.nodes = nodes;
    let wanted = arguments.clip.as_ref().and_then(|wanted| {
        let by_name = playing.names.iter().position(|name| name == wanted);
        by_name.or_else(|| {
            wanted
                .parse()
                .ok()
                .filter(|number| *number < playing.names.len())
        })
    });
    playing.clip = wanted.unwrap_or(0);
    if arguments.shot.is_some() {
        playing.at = arguments.at;
        playing.paused = true;
    }
}

fn keys(keys: Res<ButtonInput<KeyCode>>, mut playing: ResMut<Playing>) {
    let count = playing.names.len();
    if count == 0 {
        return;
    }
    let pressed = |key| keys.just_pressed(key);
    if pressed(KeyCode::ArrowDown) || pressed(KeyCode::Tab) {
        playing.clip = (playing.clip + 1) % count;
        playing.at = 0.0;
    }
    if pressed(KeyCode::ArrowUp) {
        playing.clip = (playing.clip + count - 1) % count;
        playing.at = 0.0;
    }
    if pressed(KeyCode::Space) {
        playing.paused ^= true;
    }
    for (key, factor) in [(KeyCode::Minus, 0.5), (KeyCode::Equal, 2.0)] {
        if pressed(key) {
            playing.speed = (playing.speed * factor).clamp(1.0 / 16.0, 16.0);
        }
    }
    for (key, step) in [(KeyCode::ArrowLeft, -1.0), (KeyCode::ArrowRight, 1.0)] {
        if pressed(key) {
            playing.paused = true;
            playing.at += step / 30.0;
        }
    }
}

/// The moment is ours, so that it can be stepped; Bevy puts the joints there.
fn play(time: Res<Time>, mut playing: ResMut<Playing>, mut players: Query<&mut AnimationPlayer>) {
    let Some(&node) = playing.nodes.get(playing.clip) else {
        return;
    };
    let length = playing.seconds[playing.clip];
    if !playing.paused {
        playing.at += time.delta_secs() * playing.speed;
    }
    if length > 0.0 {
        playing.at = playing.at.rem_euclid(length);
    }
    for mut player in &mut players {
        if !player.is_playing_animation(node) {
            player.stop_all();
        }
        player.play(node).pause().seek_to(playing.at);
    }
}
