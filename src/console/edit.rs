//! `edit`: the landscape by commands.

use std::path::{Path, PathBuf};

use bevy::math::DVec2;
use bevy::prelude::*;
use clap::{Arg, ArgMatches, Command, value_parser};
use dolomite::inspector::console::table::{Mistake, Step, Table};
use dolomite::terrain::{Edit, EditKind, Filter, HeightMapFile};

use crate::play::camera::FreeCamera;
use crate::play::edits;
use crate::scene::CurrentScene;

/// Radius where none is said, metres.
const RADIUS: &str = "20";

/// Adds it.
pub fn add(table: &mut Table) {
    let number = |name: &'static str| {
        Arg::new(name)
            .value_name("NUMBER")
            .allow_negative_numbers(true)
            .value_parser(value_parser!(f64))
    };
    let brush = |name: &'static str, about: &'static str| {
        Command::new(name)
            .about(about)
            .disable_version_flag(true)
            .arg(
                number("radius")
                    .long("radius")
                    .value_name("METRES")
                    .default_value(RADIUS),
            )
            .arg(
                number("falloff")
                    .long("falloff")
                    .value_name("SHARE")
                    .help("Outer share of the radius over which it fades")
                    .default_value("0.6"),
            )
            .arg(
                number("at")
                    .long("at")
                    .value_names(["X", "Z"])
                    .num_args(2)
                    .help("Metres; where the camera looks, if it is not said"),
            )
    };
    let file = |name: &'static str, about: &'static str| {
        Command::new(name)
            .about(about)
            .disable_version_flag(true)
            .arg(
                Arg::new("file")
                    .value_name("FILE")
                    .value_parser(value_parser!(PathBuf)),
            )
    };
    let share = || number("value").value_name("SHARE").default_value("1");
    table.add(
        Command::new("edit")
            .about("Edit the ground with a round brush, take steps back, save them with the scene")
            .subcommand_required(true)
            .arg_required_else_help(true)
            .subcommand(
                brush("raise", "Raise it by metres")
                    .arg(number("value").value_name("METRES").required(true)),
            )
            .subcommand(
                brush("lower", "Lower it by metres")
                    .arg(number("value").value_name("METRES").required(true)),
            )
            .subcommand(
                brush("flatten", "Level it at a height, or at that of its middle")
                    .arg(number("value").value_name("HEIGHT")),
            )
            .subcommand(brush("smooth", "Bring it to the mean of what is around").arg(share()))
            .subcommand(
                brush("stamp", "Add the heights of a map")
                    .arg(
                        Arg::new("map")
                            .value_name("MAP")
                            .help("A file of elevation; its samples are metres")
                            .required(true),
                    )
                    .arg(number("value").value_name("FACTOR").default_value("1")),
            )
            .subcommand(Command::new("undo").about("Take the last step back"))
            .subcommand(Command::new("redo").about("Make it again"))
            .subcommand(file("save", "Save all steps beside the scene's file"))
            .subcommand(file("load", "Load what was saved, in place of all steps")),
        run,
    );
}

fn run(world: &mut World, matches: &ArgMatches) -> Result<Step, Mistake> {
    let Some((name, matches)) = matches.subcommand() else {
        return Err(Mistake("say what to edit: help edit".to_owned()));
    };
    let named = || matches.get_one::<PathBuf>("file").cloned();
    let said = match name {
        "undo" => edits::undo(world).map(|()| String::new()),
        "redo" => edits::redo(world).map(|()| String::new()),
        "save" => edits::save(world, named()).map(|path| format!("wrote {}", path.display())),
        "load" => edits::load(world, named()).map(|path| format!("read {}", path.display())),
        name => {
            let brush = brush(world, name, matches)?;
            edits::edit(world, &brush, false)
                .map(|made| format!("{} samples in {} tiles", made.samples, made.tiles))
        }
    };
    said.map(Step::Said).map_err(Mistake::of)
}

fn brush(world: &mut World, name: &str, matches: &ArgMatches) -> Result<Edit, Mistake> {
    let number = |id: &str| matches.get_one::<f64>(id).copied();
    let value = number("value");
    let (kind, strength) = match name {
        "raise" => (EditKind::Raise, value.unwrap_or(0.0)),
        "lower" => (EditKind::Lower, value.unwrap_or(0.0)),
        "flatten" => (EditKind::Flatten { height: value }, 1.0),
        "smooth" => (EditKind::Smooth, value.unwrap_or(1.0)),
        _ => {
            let path = matches.get_one::<String>("map").cloned();
            // It is stretched over the brush: what its samples are apart counts nothing.
            let map = HeightMapFile {
                path: path.unwrap_or_default(),
                spacing: Some([1.0; 2]),
                filter: Filter::Bicubic,
                ..HeightMapFile::default()
            };
            let map = map.load(Path::new("")).map_err(Mistake::of)?;
            (EditKind::Stamp(map), value.unwrap_or(1.0))
        }
    };
    let at: Vec<f64> = matches
        .get_many::<f64>("at")
        .into_iter()
        .flatten()
        .copied()
        .collect();
    let place = match at[..] {
        [x, z] => DVec2::new(x, z),
        _ => {
            let terrain = world.resource::<CurrentScene>().terrain.clone();
            let mut cameras = world.query::<&FreeCamera>();
            let camera = cameras.iter(world).next();
            let camera = camera.ok_or_else(|| Mistake("no camera looks: say --at X Z".into()))?;
            edits::looked_at(&terrain, &camera.pose)
        }
    };
    Ok(Edit {
        kind,
        place,
        radius: number("radius").unwrap_or(20.0),
        strength,
        falloff: number("falloff").unwrap_or(0.6),
    })
}
