//! The panel, for scripts and for hands that stay on the keys.

use clap::{Arg, Command};

use super::text;
use crate::Inspector;
use crate::console::table::{Mistake, Step, Table};
use crate::panel::state::{Shell, Tab};

const TABS: [(&str, Tab); 4] = [
    ("settings", Tab::Settings),
    ("entities", Tab::Entities),
    ("diagnostics", Tab::Diagnostics),
    ("views", Tab::Views),
];

pub(super) fn add(table: &mut Table) {
    let names = TABS.iter().map(|(name, _)| *name).chain(["off"]);
    table.add(
        Command::new("inspect")
            .about("Open the panel on a tab, or close it")
            .arg(
                Arg::new("tab")
                    .value_name("TAB")
                    .default_value("settings")
                    .value_parser(names.collect::<Vec<_>>()),
            )
            .arg(
                Arg::new("filter")
                    .long("filter")
                    .value_name("TEXT")
                    .help("What is searched for in it"),
            ),
        |world, matches| {
            if !world.contains_resource::<Shell>() {
                return Err(Mistake("this app draws no panel".to_owned()));
            }
            let name = text(matches, "tab").unwrap_or_default();
            let tab = TABS.iter().find(|(known, _)| *known == name);
            let mut shell = world.resource_mut::<Shell>();
            if let Some((_, tab)) = tab {
                shell.tab = *tab;
                text(matches, "filter")
                    .unwrap_or_default()
                    .clone_into(&mut shell.filter);
            }
            world.resource_mut::<Inspector>().panel = tab.is_some();
            Ok(Step::Said(String::new()))
        },
    );
}
