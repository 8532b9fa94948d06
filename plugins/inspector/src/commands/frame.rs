//! What a frame costs, and what of it is shown.

use bevy::diagnostic::DiagnosticsStore;
use bevy::ecs::prelude::*;
use clap::{Arg, ArgAction, Command};

use super::{joined, needed, rest, text};
use crate::console::table::{Mistake, Step, Table};
use crate::measures::{Watched, measures, skipped, totals, view_totals};
use crate::views::FrameViews;

pub(super) fn add(table: &mut Table) {
    table.add(
        Command::new("stat")
            .about("Say the diagnostics of this frame, all or those with this in their path")
            .arg(rest("filter", "DIAGNOSTIC"))
            .arg(
                Arg::new("plugins")
                    .long("plugins")
                    .action(ArgAction::SetTrue)
                    .help("Sums of dispatches, primitives, bytes and GPU time by plugin"),
            )
            .arg(
                Arg::new("views")
                    .long("views")
                    .action(ArgAction::SetTrue)
                    .help("Passes, primitives and bytes by view"),
            )
            .arg(
                Arg::new("skipped")
                    .long("skipped")
                    .action(ArgAction::SetTrue)
                    .help("What was left out, and why"),
            ),
        |world, matches| {
            let store = store(world)?;
            if matches.get_flag("plugins") {
                return Ok(Step::Said(sums(store)));
            }
            if matches.get_flag("views") {
                return Ok(Step::Said(of_views(store)));
            }
            if matches.get_flag("skipped") {
                let lines = skipped(store).into_iter().map(|(measure, reason)| {
                    let value = measure.value.map_or("-".to_owned(), |v| format!("{v:.0}"));
                    format!("{:<40} {value:>10}  {reason}\n", measure.path)
                });
                return Ok(Step::Said(lines.collect()));
            }
            let list = measures(store, &joined(matches, "filter"));
            if list.is_empty() {
                return Err(Mistake("no such diagnostic".to_owned()));
            }
            let lines = list.iter().map(|measure| {
                let value =
                    |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{v:.3}"));
                format!(
                    "{:<56} {:>14} {:>14} {}\n",
                    measure.path,
                    value(measure.value),
                    value(measure.average),
                    measure.unit
                )
            });
            Ok(Step::Said(lines.collect()))
        },
    );
    table.add(
        Command::new("watch")
            .about("Draw a diagnostic as a plot over time; --off: no more")
            .arg(needed("diagnostic", "DIAGNOSTIC"))
            .arg(Arg::new("off").long("off").action(ArgAction::SetTrue)),
        |world, matches| {
            let path = text(matches, "diagnostic").unwrap_or_default();
            let mut watched = world.get_resource_or_init::<Watched>().clone();
            if matches.get_flag("off") {
                watched.forget(path).map_err(Mistake::of)?;
            } else {
                watched.watch(store(world)?, path).map_err(Mistake::of)?;
            }
            *world.resource_mut::<Watched>() = watched;
            Ok(Step::Said(String::new()))
        },
    );
    table.add(
        Command::new("views")
            .about("List the views of the frame, or switch one")
            .arg(Arg::new("view").value_name("VIEW"))
            .arg(Arg::new("state").value_parser(["on", "off"])),
        |world, matches| {
            let views = world.get_resource_or_init::<FrameViews>().clone();
            let Some(name) = text(matches, "view") else {
                let lines = views.list().iter().map(|view| {
                    let state = if view.is_on(world) { "on" } else { "off" };
                    format!("{:<16} {state:<4} {}\n", view.name, view.about)
                });
                let lines: String = lines.collect();
                return Ok(Step::Said(if lines.is_empty() {
                    "this app has no views of the frame".to_owned()
                } else {
                    lines
                }));
            };
            let view = views
                .get(name)
                .ok_or_else(|| Mistake(format!("no view `{name}`; `views` lists them")))?;
            let on = text(matches, "state").map_or_else(|| !view.is_on(world), |on| on == "on");
            view.switch(world, on).map_err(Mistake)?;
            let state = if view.is_on(world) { "on" } else { "off" };
            Ok(Step::Said(format!("{name} {state}")))
        },
    );
}

fn store(world: &World) -> Result<&DiagnosticsStore, Mistake> {
    world.get_resource::<DiagnosticsStore>().ok_or_else(|| {
        Mistake("this app has no diagnostics: it lacks Bevy's DiagnosticsPlugin".to_owned())
    })
}

fn sums(store: &DiagnosticsStore) -> String {
    let mut text = format!(
        "{:<14} {:>12} {:>14} {:>16} {:>16} {:>10}\n",
        "plugin", "dispatches", "primitives", "bytes", "allocated", "GPU ms"
    );
    for row in totals(store) {
        let whole = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{v:.0}"));
        let gpu = row.gpu.map_or("-".to_owned(), |v| format!("{v:.3}"));
        text += &format!(
            "{:<14} {:>12} {:>14} {:>16} {:>16} {gpu:>10}\n",
            row.group,
            whole(row.dispatches),
            whole(row.primitives),
            whole(row.bytes),
            whole(row.allocated)
        );
    }
    text
}

fn of_views(store: &DiagnosticsStore) -> String {
    let mut text = format!(
        "{:<10} {:<14} {:<24} {:>8} {:>12} {:>14}\n",
        "view", "plugin", "of it", "passes", "primitives", "bytes"
    );
    for row in view_totals(store) {
        let whole = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{v:.0}"));
        text += &format!(
            "{:<10} {:<14} {:<24} {:>8} {:>12} {:>14}\n",
            row.view,
            row.group,
            row.kind,
            whole(row.passes),
            whole(row.primitives),
            whole(row.bytes)
        );
    }
    text
}
