//! The game's own commands.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Instant;

use bevy::app::AppExit;
use bevy::math::DVec3;
use bevy::prelude::*;
use bevy::render::view::screenshot::{Screenshot, ScreenshotCaptured};
use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};
use dolomite::inspector::console::table::{Mistake, Step, Table};

use super::bot::Bot;
use crate::play::camera::FreeCamera;
use crate::play::{Switches, start_camera};
use crate::scene::{self, CurrentScene, PITCH_LIMIT, Pose, SceneRequest};
use crate::settings::Settings;
use crate::settings::paths::AssetsDir;
use crate::view::OffscreenTarget;

/// Frames within which a picture comes back from the device.
const PICTURE: u32 = 600;

/// Farthest place of the camera from the origin, metres: what f32 view matrices can hold to a metre.
const FARTHEST: f64 = 1e7;

/// Adds them.
pub fn add(table: &mut Table) {
    table.add(
        Command::new("scene")
            .about("Show another landscape: a name, a scene file or a height map")
            .arg(Arg::new("scene").value_name("SCENE").required(true)),
        |world, matches| show(world, text(matches, "scene")),
    );
    table.add(
        Command::new("go")
            .about("Put the camera somewhere: metres, and yaw and pitch in degrees")
            .arg(
                Arg::new("place")
                    .value_name("X Y Z YAW PITCH")
                    .num_args(5)
                    .required(true)
                    .allow_negative_numbers(true)
                    .value_parser(value_parser!(f64)),
            ),
        go,
    );
    table.add(
        Command::new("shot")
            .about("Write the picture as a PNG")
            .arg(
                Arg::new("file")
                    .value_name("FILE")
                    .required(true)
                    .value_parser(value_parser!(PathBuf)),
            ),
        shot,
    );
    table.add(
        Command::new("bench")
            .about("Say what the next frames take")
            .arg(
                Arg::new("frames")
                    .long("frames")
                    .value_name("FRAMES")
                    .default_value("60")
                    .value_parser(value_parser!(u32).range(2..=100_000)),
            ),
        bench,
    );
    table.add(
        Command::new("bot")
            .about("Let the figure walk, as the camera sees it: 1 0 is ahead, 0 1 to the right")
            .arg(share("ahead").required(true))
            .arg(share("right").default_value("0"))
            .arg(
                Arg::new("seconds")
                    .long("seconds")
                    .value_name("SECONDS")
                    .default_value("1")
                    .value_parser(value_parser!(f32)),
            )
            .arg(Arg::new("run").long("run").action(ArgAction::SetTrue))
            .arg(Arg::new("jump").long("jump").action(ArgAction::SetTrue)),
        bot,
    );
    table.add(Command::new("quit").about("Leave the game"), |world, _| {
        world.write_message(AppExit::Success);
        Ok(Step::Said(String::new()))
    });
}

fn share(name: &'static str) -> Arg {
    Arg::new(name)
        .value_name("SHARE")
        .help("-1 to 1")
        .allow_negative_numbers(true)
        .value_parser(value_parser!(f32))
}

fn text<'a>(matches: &'a ArgMatches, id: &str) -> &'a str {
    matches.get_one::<String>(id).map_or("", String::as_str)
}

fn show(world: &mut World, name: &str) -> Result<Step, Mistake> {
    let wrong = |what: &str| {
        Mistake(format!(
            "{what} draws itself: start the game with --scene to see it"
        ))
    };
    if world.resource::<CurrentScene>().own.is_some() {
        return Err(wrong("the scene that is shown"));
    }
    let request = SceneRequest {
        scene: name.to_owned(),
        ..world.resource::<SceneRequest>().clone()
    };
    let assets = world.resource::<AssetsDir>().0.clone();
    let loaded = scene::load(&request, &assets).map_err(Mistake::of)?;
    if loaded.own.is_some() {
        return Err(wrong(name));
    }
    *world.resource_mut::<SceneRequest>() = request;
    let name = loaded.name.clone();
    let scene = CurrentScene(loaded);
    let camera = start_camera(scene.camera, &scene, world.resource::<Settings>());
    let mut cameras = world.query::<&mut FreeCamera>();
    for mut free in cameras.iter_mut(world) {
        *free = camera;
    }
    *world.resource_mut::<CurrentScene>() = scene;
    Ok(Step::Said(format!("{name} is shown")))
}

fn go(world: &mut World, matches: &ArgMatches) -> Result<Step, Mistake> {
    let numbers = matches.get_many::<f64>("place").into_iter().flatten();
    let numbers: Vec<f64> = numbers.copied().collect();
    let [x, y, z, yaw, pitch] = numbers[..] else {
        return Err(Mistake("five numbers are needed".to_owned()));
    };
    let limit = f64::from(PITCH_LIMIT.to_degrees());
    if pitch.is_nan() || pitch.abs() > limit || !yaw.is_finite() {
        return Err(Mistake(format!(
            "the pitch must be -{limit:.0} to {limit:.0} degrees, and the yaw finite"
        )));
    }
    let position = DVec3::new(x, y, z);
    if position.is_nan() || position.abs().max_element() > FARTHEST {
        return Err(Mistake(
            "the place must be within 10000 km of the origin".to_owned(),
        ));
    }
    let pose = Pose {
        position,
        yaw: (yaw as f32).to_radians(),
        pitch: (pitch as f32).to_radians(),
    };
    // Who follows the figure would be back in the next frame.
    let mut switches = world.resource_mut::<Switches>();
    if switches.follow {
        switches.follow = false;
    }
    let mut cameras = world.query::<&mut FreeCamera>();
    for mut camera in cameras.iter_mut(world) {
        camera.pose = pose;
        camera.velocity = Vec3::ZERO;
    }
    Ok(Step::Said(String::new()))
}

type Written = Arc<Mutex<Option<Result<(), String>>>>;

fn shot(world: &mut World, matches: &ArgMatches) -> Result<Step, Mistake> {
    let file = matches
        .get_one::<PathBuf>("file")
        .cloned()
        .unwrap_or_default();
    let picture = match world.get_resource::<OffscreenTarget>() {
        Some(target) => Screenshot::image(target.0.clone()),
        None => Screenshot::primary_window(),
    };
    let written = Written::default();
    let (path, slot) = (file.clone(), written.clone());
    world
        .spawn(picture)
        .observe(move |captured: On<ScreenshotCaptured>| {
            let done = write(&captured.image, &path);
            if let Ok(mut slot) = slot.lock() {
                *slot = Some(done);
            }
        });
    let mut left = PICTURE;
    Ok(Step::Wait(Box::new(move |_| {
        let done = written.lock().ok().and_then(|mut written| written.take());
        left -= 1;
        let name = file.display();
        match (done, left) {
            (Some(Ok(())), _) => Some(Ok(format!("wrote {name}"))),
            (Some(Err(reason)), _) => Some(Err(Mistake(format!("{name}: {reason}")))),
            (None, 0) => Some(Err(Mistake(format!(
                "{name}: no picture came back from the device"
            )))),
            (None, _) => None,
        }
    })))
}

fn write(image: &Image, path: &Path) -> Result<(), String> {
    let picture = image.clone().try_into_dynamic();
    let picture = picture.map_err(|error| error.to_string())?.into_rgb8();
    picture
        .save_with_format(path, image::ImageFormat::Png)
        .map_err(|error| error.to_string())
}

fn bench(_: &mut World, matches: &ArgMatches) -> Result<Step, Mistake> {
    let frames = matches.get_one::<u32>("frames").copied().unwrap_or(60) as usize;
    let mut times = Vec::with_capacity(frames);
    let mut last: Option<Instant> = None;
    Ok(Step::Wait(Box::new(move |_| {
        let now = Instant::now();
        if let Some(last) = last.replace(now) {
            times.push(1e3 * (now - last).as_secs_f64());
        }
        if times.len() < frames {
            return None;
        }
        times.sort_by(f64::total_cmp);
        let at = |share: f64| times[((times.len() - 1) as f64 * share) as usize];
        Some(Ok(format!(
            "{frames} frames: median {:.2} ms, p99 {:.2} ms, longest {:.2} ms",
            at(0.5),
            at(0.99),
            at(1.0)
        )))
    })))
}

fn bot(world: &mut World, matches: &ArgMatches) -> Result<Step, Mistake> {
    let number = |id: &str| matches.get_one::<f32>(id).copied().unwrap_or(0.0);
    let walk = Vec2::new(number("right"), number("ahead"));
    let seconds = number("seconds");
    if walk.is_nan() || walk.abs().max_element() > 1.0 {
        return Err(Mistake("shares are -1 to 1".to_owned()));
    }
    if !(0.0..=3600.0).contains(&seconds) {
        return Err(Mistake("the seconds are 0 to 3600".to_owned()));
    }
    world.insert_resource(Bot {
        walk,
        fast: matches.get_flag("run"),
        jump: matches.get_flag("jump"),
        seconds,
    });
    Ok(Step::Wait(Box::new(|world| {
        (!world.contains_resource::<Bot>()).then(|| Ok(String::new()))
    })))
}
