//! The parts of a frame: what each takes, and what the frame would cost without it.
//!
//! A part that can be switched is switched off and on in turns, in one run and at one place; the difference of the
//! medians is what it costs *alone*: on a device that overlaps passes that is less than the time of its passes, and
//! where it makes others work (bloom reads what was drawn, shadows let the ground choose more) it is more. Parts of
//! the CPU cannot be switched off; the spans between them are measured, and they add up to the frame.

use std::borrow::Cow;
use std::fmt::Write;

use bevy::anti_alias::smaa::Smaa;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::light::{EnvironmentMapLight, Skybox};
use bevy::pbr::DistanceFog;
use bevy::post_process::bloom::Bloom;
use bevy::prelude::*;
use dolomite::deferred::{AmbientOcclusion, DeferredLighting};
use dolomite::ground::detail::{Metric, TerrainLod};
use dolomite::ground::{PatchDetail, TerrainView};
use serde::Serialize;

use super::path::Path;
use super::spans::{self, Spans};
use super::{BenchError, PassTimes, Spread, put_camera, spread};
use crate::play::Switches;
use crate::play::figure::Figure;
use crate::run::offscreen::{Offscreen, STEP};
use crate::scene::CurrentScene;
use crate::settings::Settings;
use crate::view::UiCamera;
use crate::view::unlit::{self, Unlit};

/// Frames after a switch that are not measured: pipelines are there from the first turn on, and ground that is asked
/// for anew is chosen in the first.
const SETTLE: usize = 2;

/// Measured frames of a turn.
const MEASURED: usize = 3;

/// A part of a frame. Times are milliseconds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Part {
    /// What it is.
    pub name: Cow<'static, str>,
    /// What the frame would cost less without it: the median over the turns. Absent where it cannot be switched off.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alone_ms: Option<f64>,
    /// The least and the greatest of the turns.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub turns_ms: Option<[f64; 2]>,
    /// Its own time: of its passes on the GPU, added up, or of its span on the CPU. Absent where nothing times it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub own_ms: Option<f64>,
    /// The passes of which that is the sum; a span of the CPU has none.
    pub passes: &'static [&'static str],
    /// What has to be known of the numbers.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub note: &'static str,
}

/// A part that can be switched.
struct Switched {
    name: &'static str,
    passes: &'static [&'static str],
    note: &'static str,
    /// Whether frames have it unless it is asked for; what they do not have is switched on in turns.
    usual: bool,
    /// Whether there is such a part in this scene.
    there: fn(&mut World) -> bool,
    switch: fn(&mut World, bool),
}

/// What was taken from the cameras.
#[derive(Resource)]
struct Taken<C>(Vec<(Entity, C)>);

fn has<C: Component>(world: &mut World) -> bool {
    world.query::<&C>().iter(world).next().is_some()
}

/// Takes a component from whoever has it, or puts it back.
fn component<C: Component + Clone>(world: &mut World, on: bool) {
    if on {
        let Some(taken) = world.remove_resource::<Taken<C>>() else {
            return;
        };
        for (entity, component) in taken.0 {
            world.entity_mut(entity).insert(component);
        }
    } else {
        let found: Vec<(Entity, C)> = world
            .query::<(Entity, &C)>()
            .iter(world)
            .map(|(entity, component)| (entity, component.clone()))
            .collect();
        for (entity, _) in &found {
            world.entity_mut(*entity).remove::<C>();
        }
        world.insert_resource(Taken(found));
    }
}

fn always(_: &mut World) -> bool {
    true
}

fn occluded(world: &mut World) -> bool {
    let mut views = world.query_filtered::<(), (With<AmbientOcclusion>, With<DeferredLighting>)>();
    views.iter(world).next().is_some()
}

fn fill(world: &mut World, on: bool) {
    world.resource_mut::<Switches>().fill = on;
}

fn figure(world: &mut World, on: bool) {
    let mut figures = world.query_filtered::<&mut Visibility, With<Figure>>();
    for mut visibility in figures.iter_mut(world) {
        *visibility = if on {
            Visibility::Inherited
        } else {
            Visibility::Hidden
        };
    }
}

fn casts(world: &mut World) -> bool {
    let mut lights = world.query::<&DirectionalLight>();
    lights.iter(world).any(|light| light.shadow_maps_enabled)
}

fn shadows(world: &mut World, on: bool) {
    let mut lights = world.query::<&mut DirectionalLight>();
    for mut light in lights.iter_mut(world) {
        light.shadow_maps_enabled = on;
    }
}

fn lighting(world: &mut World, on: bool) {
    let mut cameras = world.query_filtered::<Entity, With<TerrainView>>();
    let cameras: Vec<Entity> = cameras.iter(world).collect();
    component::<DeferredLighting>(world, on);
    for camera in cameras {
        let mut camera = world.entity_mut(camera);
        if on {
            camera.remove::<Unlit>();
        } else {
            camera.insert(Unlit);
        }
    }
}

fn tone_mapping(world: &mut World, on: bool) {
    let mut cameras = world.query_filtered::<&mut Tonemapping, With<TerrainView>>();
    for mut mapping in cameras.iter_mut(world) {
        *mapping = if on {
            Tonemapping::AgX
        } else {
            Tonemapping::None
        };
    }
}

fn panel(world: &mut World, on: bool) {
    world.resource_mut::<Settings>().panel = on;
    // It is looked at when these change.
    world.resource_mut::<Switches>().set_changed();
}

/// In the world while the ground is chosen anew in every frame.
#[derive(Resource)]
struct Nudged;

fn bounded(world: &mut World) -> bool {
    let mut views =
        world.query_filtered::<&TerrainLod, (With<TerrainView>, Without<PatchDetail>)>();
    let bounds = |lod: &TerrainLod| matches!(lod.metric, Metric::ErrorBound { .. });
    views.iter(world).any(bounds)
}

fn choice(world: &mut World, on: bool) {
    if on {
        world.insert_resource(Nudged);
    } else {
        world.remove_resource::<Nudged>();
    }
}

/// Asks for a bound that differs by a millionth from frame to frame: the same ground, chosen anew.
fn nudge(mut views: Query<&mut TerrainLod, With<TerrainView>>, mut turn: Local<bool>) {
    *turn = !*turn;
    for mut detail in &mut views {
        let factor = if *turn { 1.0 + 1e-6 } else { 1.0 };
        if let Metric::ErrorBound { pixels } = &mut detail.metric {
            *pixels *= factor;
        }
    }
}

const SWITCHED: &[Switched] = &[
    Switched {
        name: "choice",
        passes: &["detail"],
        note: "chosen anew in every frame, of cells that are made; a view at rest pays nothing",
        usual: false,
        there: bounded,
        switch: choice,
    },
    Switched {
        name: "ground",
        passes: &["geometry_gbuffer", "geometry_shadow"],
        note: "its draws into G-buffer and shadow maps, with its material",
        usual: true,
        there: always,
        switch: fill,
    },
    Switched {
        name: "figure",
        passes: &["early deferred prepass"],
        note: "and whatever else is of Bevy's meshes",
        usual: true,
        there: has::<Figure>,
        switch: figure,
    },
    Switched {
        name: "shadows",
        passes: &["geometry_shadow"],
        note: "maps, and reading them",
        usual: true,
        there: casts,
        switch: shadows,
    },
    Switched {
        name: "lighting",
        passes: &[],
        note: "nothing times it by itself; sun, its shadows, light of the sky, haze: of all pixels of the G-buffer",
        usual: true,
        there: has::<Camera3d>,
        switch: lighting,
    },
    Switched {
        name: "light of the sky",
        passes: &[],
        note: "a part of the lighting",
        usual: true,
        there: has::<EnvironmentMapLight>,
        switch: component::<EnvironmentMapLight>,
    },
    Switched {
        name: "ambient occlusion",
        passes: &["dolomite_deferred_occlusion"],
        note: "of the light of the sky, where Dolomite lights",
        usual: true,
        there: occluded,
        switch: component::<AmbientOcclusion>,
    },
    Switched {
        name: "haze",
        passes: &[],
        note: "a part of the lighting",
        usual: true,
        there: has::<DistanceFog>,
        switch: component::<DistanceFog>,
    },
    Switched {
        name: "sky",
        passes: &["main_opaque_pass_3d"],
        note: "what is behind the ground",
        usual: true,
        there: has::<Skybox>,
        switch: component::<Skybox>,
    },
    Switched {
        name: "bloom",
        passes: &["bloom"],
        note: "",
        usual: true,
        there: has::<Bloom>,
        switch: component::<Bloom>,
    },
    Switched {
        name: "tone mapping",
        passes: &["tonemapping"],
        note: "with the grading of colours",
        usual: true,
        there: has::<Tonemapping>,
        switch: tone_mapping,
    },
    Switched {
        name: "anti-aliasing",
        passes: &["smaa"],
        note: "",
        usual: true,
        there: has::<Smaa>,
        switch: component::<Smaa>,
    },
    Switched {
        name: "panel",
        passes: &[],
        note: "these frames are drawn without it",
        usual: false,
        there: has::<UiCamera>,
        switch: panel,
    },
];

/// What cannot be switched off, and is not timed without a window.
const UNMEASURED: Part = Part {
    name: Cow::Borrowed("presenting"),
    alone_ms: None,
    turns_ms: None,
    own_ms: None,
    passes: &[],
    note: "not measured: there is no window",
};

/// Lets parts be switched in an app.
pub fn prepare(app: &mut App) {
    spans::add(app);
    unlit::add(app);
    app.add_systems(Last, nudge.run_if(resource_exists::<Nudged>));
}

/// Measures the parts at the start of `path`, each in so many turns off and on. `passes` are the times of passes that
/// are known already. Scenes that draw themselves have none that could be switched.
pub(super) fn measure(
    offscreen: &mut Offscreen,
    path: Path,
    scene: &CurrentScene,
    turns: u32,
    passes: &std::collections::BTreeMap<String, PassTimes>,
) -> Result<Vec<Part>, BenchError> {
    let mut parts = Vec::new();
    put_camera(&mut offscreen.app, path, scene, 0.0);
    offscreen.settle()?;
    let mut spans = Vec::new();
    frames(offscreen, SETTLE)?;
    for _ in 0..MEASURED * turns as usize {
        frames(offscreen, 1)?;
        spans.push(*offscreen.app.world().resource::<Spans>());
    }
    for (name, of) in Spans::ALL {
        let own = spread(spans.iter().map(of));
        parts.push(Part {
            name: name.into(),
            own_ms: own.map(|spread| spread.median),
            note: "a span of the CPU",
            ..UNMEASURED
        });
    }
    if scene.own.is_some() {
        return Ok(parts);
    }
    let flown = passes.get("detail").and_then(|times| times.gpu_ms);
    parts.push(Part {
        name: "choice and making".into(),
        own_ms: flown.map(|spread| spread.median),
        passes: &["detail"],
        note: "along the path; making cannot be switched off: it is what this is above the choice alone",
        ..UNMEASURED
    });
    for part in SWITCHED {
        let world = offscreen.app.world_mut();
        if !(part.there)(world) {
            continue;
        }
        eprintln!(
            "dolomite: what the frame costs without its part {}",
            part.name
        );
        // Pipelines that differ are made once.
        turn(offscreen, part, !part.usual, 0)?;
        let mut differences = Vec::new();
        for _ in 0..turns {
            let with = turn(offscreen, part, true, MEASURED)?;
            let without = turn(offscreen, part, false, MEASURED)?;
            differences.push(with - without);
        }
        (part.switch)(offscreen.app.world_mut(), part.usual);
        frames(offscreen, SETTLE)?;
        parts.push(part_of(part, &differences, passes));
    }
    let named: Vec<&str> = SWITCHED
        .iter()
        .flat_map(|part| part.passes)
        .copied()
        .collect();
    for (pass, times) in passes {
        if let (false, Some(own)) = (is_of(&named, pass), times.gpu_ms) {
            parts.push(Part {
                name: pass.clone().into(),
                own_ms: Some(own.median),
                note: "a pass that is not switched",
                ..UNMEASURED
            });
        }
    }
    parts.push(UNMEASURED);
    Ok(parts)
}

fn part_of(
    part: &Switched,
    differences: &[f64],
    passes: &std::collections::BTreeMap<String, PassTimes>,
) -> Part {
    let fold = |pick: fn(f64, f64) -> f64| differences.iter().copied().reduce(pick);
    let timed: Vec<f64> = passes
        .iter()
        .filter(|(name, _)| is_of(part.passes, name))
        .filter_map(|(_, times)| times.gpu_ms.map(|Spread { median, .. }| median))
        .collect();
    Part {
        name: part.name.into(),
        alone_ms: spread(differences.iter().copied()).map(|spread| spread.median),
        turns_ms: fold(f64::min).zip(fold(f64::max)).map(|(a, b)| [a, b]),
        own_ms: (!timed.is_empty()).then(|| timed.iter().sum()),
        passes: part.passes,
        note: part.note,
    }
}

/// Whether a pass, as diagnostics name it, is one of these: nested passes stand behind a slash, and those of one kind
/// are numbered.
fn is_of(passes: &[&str], name: &str) -> bool {
    passes.iter().any(|pass| {
        let rest = name.strip_prefix(pass);
        rest.is_some_and(|rest| {
            !rest.starts_with(|letter: char| letter.is_alphanumeric() || letter == '_')
        })
    })
}

/// Switches a part, lets the view settle, and measures frames; their median, milliseconds.
fn turn(
    offscreen: &mut Offscreen,
    part: &Switched,
    on: bool,
    measured: usize,
) -> Result<f64, BenchError> {
    (part.switch)(offscreen.app.world_mut(), on);
    frames(offscreen, SETTLE)?;
    let times = frames(offscreen, measured)?;
    Ok(spread(times.into_iter()).map_or(0.0, |spread| spread.median))
}

/// Draws frames at rest; what each took, milliseconds.
fn frames(offscreen: &mut Offscreen, count: usize) -> Result<Vec<f64>, BenchError> {
    let mut times = Vec::with_capacity(count);
    for _ in 0..count {
        let start = std::time::Instant::now();
        offscreen.step(STEP)?;
        times.push(start.elapsed().as_secs_f64() * 1e3);
    }
    Ok(times)
}

/// The parts as a table in Markdown.
pub fn table(parts: &[Part]) -> String {
    let mut text = String::from(
        "| part | costs alone, ms | least to greatest of the turns | own time, ms | |\n|---|--:|--:|--:|---|\n",
    );
    for part in parts {
        let number =
            |value: Option<f64>| value.map_or("-".to_owned(), |value| format!("{value:.2}"));
        let turns = part.turns_ms.map_or("-".to_owned(), |[least, most]| {
            format!("{least:.2} to {most:.2}")
        });
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "| {} | {} | {turns} | {} | {} |",
            part.name,
            number(part.alone_ms),
            number(part.own_ms),
            part.note,
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_are_known_by_whole_names() {
        assert!(is_of(&["bloom"], "bloom"));
        assert!(is_of(&["bloom"], "bloom/first"));
        assert!(is_of(&["bloom"], "bloom 2"));
        assert!(!is_of(&["bloom"], "blooming"));
        assert!(!is_of(&["ui"], "ui_layout"));
        assert!(!is_of(&[], "bloom"));
    }

    #[test]
    fn what_is_taken_comes_back() {
        let mut world = World::new();
        let entity = world.spawn(Bloom::NATURAL).id();
        component::<Bloom>(&mut world, false);
        assert!(!has::<Bloom>(&mut world));
        component::<Bloom>(&mut world, true);
        assert_eq!(
            world.get::<Bloom>(entity).map(|b| b.intensity),
            Some(Bloom::NATURAL.intensity)
        );
        // And nothing comes twice.
        component::<Bloom>(&mut world, true);
    }

    #[test]
    fn the_median_of_the_turns_is_told_with_its_ends() {
        let times = PassTimes {
            gpu_ms: Some(Spread {
                median: 2.0,
                p99: 3.0,
            }),
            cpu_ms: None,
        };
        let passes = [
            ("bloom".to_owned(), times.clone()),
            ("smaa".to_owned(), times),
        ];
        let bloom = SWITCHED.iter().find(|part| part.name == "bloom").unwrap();
        let part = part_of(bloom, &[3.0, 1.0, 2.0], &passes.into());
        assert_eq!(
            (part.alone_ms, part.turns_ms),
            (Some(2.0), Some([1.0, 3.0]))
        );
        assert_eq!(part.own_ms, Some(2.0));
        let text = table(&[part, UNMEASURED]);
        assert!(
            text.contains("| bloom | 2.00 | 1.00 to 3.00 | 2.00 |"),
            "{text}"
        );
        assert!(
            text.contains("| presenting | - | - | - | not measured"),
            "{text}"
        );
    }
}
