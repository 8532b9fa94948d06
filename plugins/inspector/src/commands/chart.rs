//! Charts of the running scene.

use std::path::PathBuf;

use bevy::ecs::prelude::*;
use bevy::ecs::reflect::AppTypeRegistry;
use clap::{Arg, ArgAction, ArgMatches, Command, value_parser};

use super::{needed, text};
use crate::chart::{Chart, ErrorOf, Order, begin, file};
use crate::console::table::{Mistake, Step, Table};
use crate::settings::place::find;

pub(super) fn add(table: &mut Table) {
    let number = |id: &'static str, value: &'static str| {
        needed(id, value)
            .allow_negative_numbers(true)
            .value_parser(value_parser!(f64))
    };
    let count = |id: &'static str, usual: &'static str| {
        Arg::new(id)
            .long(id)
            .value_name("COUNT")
            .default_value(usual)
            .value_parser(value_parser!(u32))
    };
    table.add(
        Command::new("chart")
            .about("Move a setting, and measure what a frame takes and how far off it is")
            .arg(needed("setting", "SETTING"))
            .arg(number("from", "FROM"))
            .arg(number("to", "TO"))
            .arg(count("steps", "8").help("Values, both ends included"))
            .arg(count("settle", "10").help("Frames before a value is measured"))
            .arg(count("frames", "30").help("Frames that are measured"))
            .arg(
                Arg::new("linear")
                    .long("linear")
                    .action(ArgAction::SetTrue)
                    .help("Equal steps; else equal ratios"),
            )
            .arg(
                Arg::new("time")
                    .long("time")
                    .value_name("DIAGNOSTIC")
                    .help("Its time in place of whole frames"),
            )
            .arg(
                Arg::new("error")
                    .long("error")
                    .value_name("DIAGNOSTIC")
                    .help("The error is this diagnostic"),
            )
            .arg(
                Arg::new("picture")
                    .long("picture")
                    .action(ArgAction::SetTrue)
                    .conflicts_with("error")
                    .help("The error is the picture's distance from that at FROM"),
            )
            .arg(
                Arg::new("out")
                    .long("out")
                    .value_name("FILE")
                    .value_parser(value_parser!(PathBuf))
                    .help("Write it as .json or .csv"),
            ),
        chart,
    );
}

fn chart(world: &mut World, matches: &ArgMatches) -> Result<Step, Mistake> {
    let place = {
        let registry = world.resource::<AppTypeRegistry>().read();
        find(
            world,
            &registry,
            text(matches, "setting").unwrap_or_default(),
        )
        .map_err(Mistake::of)?
    };
    let number = |id: &str| matches.get_one::<f64>(id).copied().unwrap_or(f64::NAN);
    let count = |id: &str| matches.get_one::<u32>(id).copied().unwrap_or(0);
    let out = matches.get_one::<PathBuf>("out").cloned();
    if let Some(out) = &out {
        file::check(out).map_err(Mistake::of)?;
    }
    let order = Order {
        place,
        ends: [number("from"), number("to")],
        steps: count("steps"),
        linear: matches.get_flag("linear"),
        settle: count("settle").min(100_000),
        frames: count("frames"),
        time: text(matches, "time").map(str::to_owned),
        error: match (matches.get_flag("picture"), text(matches, "error")) {
            (true, _) => ErrorOf::Picture,
            (false, Some(path)) => ErrorOf::Diagnostic(path.to_owned()),
            (false, None) => ErrorOf::Nothing,
        },
    };
    let mut run = begin(world, order).map_err(Mistake::of)?;
    Ok(Step::Wait(Box::new(move |world| {
        let answer = run(world)?.map_err(Mistake::of);
        Some(answer.and_then(|chart| {
            if let Some(out) = &out {
                file::write(&chart, out).map_err(Mistake::of)?;
            }
            Ok(rows(&chart))
        }))
    })))
}

fn rows(chart: &Chart) -> String {
    let mut text = format!("{:>14} {:>12} {:>12}\n", "value", "ms", "error");
    for point in &chart.points {
        let error = point
            .error
            .map_or("-".to_owned(), |error| format!("{error:.6}"));
        text += &format!("{:>14.6} {:>12.3} {error:>12}\n", point.value, point.time);
    }
    text
}
