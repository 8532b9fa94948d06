//! A level as it stands in its file: RON, held to rules that need no ground. `assets/levels/mountain.ron` and
//! `assets/levels/city.ron` are the annotated examples.

use std::path::Path;

use bevy::math::Vec2;
use serde::Deserialize;

use super::error::LevelError;
use super::quarter::{GATE, GateFile, Side, WeaponFile};
use super::words::Words;
use crate::settings::ron_options;

/// A place on the ground, (x, z), metres.
type Place = (f32, f32);

/// A level, ready to be checked against its ground.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LevelFile {
    /// What it is called.
    pub title: String,
    /// One line on what is to be done.
    #[serde(default)]
    pub about: String,
    /// What is said while it is played.
    #[serde(default)]
    pub words: Words,
    /// The scene that it is played in.
    pub scene: String,
    /// The square that soldiers know.
    pub area: Area,
    /// Where the player starts, (x, z), and looks, degrees.
    pub start: (f32, f32, f32),
    /// The hour at the start, 0 to 24.
    pub hour: f32,
    /// Seconds of the day that pass in one.
    pub pace: f32,
    /// After how long it is lost, seconds.
    pub seconds: f32,
    /// Seconds until a beacon catches fire.
    pub hold: f32,
    /// From how far away it is lit, metres.
    pub reach: f32,
    /// Who is so near to a beacon that burns is seen as by day, metres; 0: nobody is.
    #[serde(default)]
    pub glow: f32,
    /// Of the player.
    pub health: f32,
    /// Health that comes back a second.
    pub mends: f32,
    /// Seconds without a hit until then.
    pub rests: f32,
    /// Health that a landing takes, for each metre a second above what knees bear; 0: none.
    #[serde(default)]
    pub falls: f32,
    /// What the player shoots with, if with anything.
    #[serde(default)]
    pub weapon: Option<WeaponFile>,
    /// The way out: the area has a wall, and the level is won by who leaves through this gate, which opens when all
    /// beacons burn. Needs a city.
    #[serde(default)]
    pub gate: Option<GateFile>,
    /// At least one.
    pub beacons: Vec<BeaconFile>,
    /// What gives health back.
    #[serde(default)]
    pub bandages: Bandages,
    /// What all soldiers have in common.
    pub soldiers: Soldiers,
    /// Who walks where.
    #[serde(default)]
    pub patrols: Vec<PatrolFile>,
}

/// A square of ground.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Area {
    /// Its middle.
    pub middle: Place,
    /// Metres.
    pub side: f32,
}

/// A beacon.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BeaconFile {
    /// What it is called; no two are the same.
    pub name: String,
    /// Where.
    pub at: Place,
    /// It stands on the roof of the house there, and a lift goes up to it on this side, along a street. Needs a city.
    #[serde(default)]
    pub lift: Option<Side>,
}

/// What gives health back.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Bandages {
    /// Health.
    pub gives: f32,
    /// Where they lie.
    pub at: Vec<Place>,
}

/// What all soldiers have in common. Metres, seconds, degrees.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Soldiers {
    /// Metres a second on patrol.
    pub walk: f32,
    /// The same after somebody.
    pub run: f32,
    /// How far they see by day.
    pub day: f32,
    /// How far they see by night.
    pub night: f32,
    /// From the middle of the field to its edge.
    pub field: f32,
    /// How far somebody who runs is heard.
    pub hears_run: f32,
    /// How far somebody who walks is heard.
    pub hears_walk: f32,
    /// How far they call one another.
    pub calls: f32,
    /// Health that a bolt takes.
    pub damage: f32,
    /// Metres a second of a bolt.
    pub bolt: f32,
    /// How far they shoot.
    pub range: f32,
    /// Seconds between shots.
    pub every: f32,
    /// How far a shot may go astray.
    pub spread: f32,
    /// Health of each, where the player has a weapon.
    #[serde(default = "usual_health")]
    pub bears: f32,
}

const fn usual_health() -> f32 {
    100.0
}

/// A patrol.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PatrolFile {
    /// What it is called; no two are the same.
    pub name: String,
    /// Through which places, and back to the first; at least two.
    pub way: Vec<Place>,
}

/// A value that was refused: where to look for its line, and what is wrong.
pub type Refused = (String, String);

impl LevelFile {
    /// Reads a level; `path` is named in errors.
    ///
    /// # Errors
    /// [`LevelError::Parse`] and [`LevelError::Value`], with the line.
    pub fn parse(text: &str, path: &Path) -> Result<Self, LevelError> {
        let file: Self = ron_options()
            .from_str(text)
            .map_err(|source| LevelError::Parse {
                path: path.to_owned(),
                source: Box::new(source),
            })?;
        file.check()
            .map_err(|refused| refuse(text, path, refused))?;
        Ok(file)
    }

    fn check(&self) -> Result<(), Refused> {
        let s = &self.soldiers;
        let mut numbers = vec![
            ("seconds", self.seconds, 1.0, 86_400.0),
            ("side", self.area.side, 64.0, 8192.0),
            ("hour", self.hour, 0.0, 24.0),
            ("pace", self.pace, 0.0, 3600.0),
            ("hold", self.hold, 0.1, 60.0),
            ("reach", self.reach, 0.5, 50.0),
            ("glow", self.glow, 0.0, 200.0),
            ("health", self.health, 1.0, 1e6),
            ("bears", s.bears, 1.0, 1e6),
            ("falls", self.falls, 0.0, 1e6),
            ("mends", self.mends, 0.0, 1e6),
            ("rests", self.rests, 0.0, 3600.0),
            ("gives", self.bandages.gives, 0.0, 1e6),
            ("walk", s.walk, 0.1, 20.0),
            ("run", s.run, 0.1, 20.0),
            ("day", s.day, 0.0, 1000.0),
            ("night", s.night, 0.0, 1000.0),
            ("field", s.field, 0.0, 180.0),
            ("hears_run", s.hears_run, 0.0, 1000.0),
            ("hears_walk", s.hears_walk, 0.0, 1000.0),
            ("calls", s.calls, 0.0, 10_000.0),
            ("soldiers:>damage", s.damage, 0.0, 1e6),
            ("soldiers:>bolt", s.bolt, 1.0, 1e4),
            ("soldiers:>range", s.range, 0.0, 1000.0),
            ("soldiers:>every", s.every, 0.05, 3600.0),
            ("spread", s.spread, 0.0, 45.0),
        ];
        if let Some(w) = &self.weapon {
            numbers.extend([
                ("weapon:>damage", w.damage, 0.0, 1e6),
                ("weapon:>bolt", w.bolt, 1.0, 1e4),
                ("weapon:>range", w.range, 0.0, 1000.0),
                ("weapon:>every", w.every, 0.05, 3600.0),
                ("weapon:>noise", w.noise, 0.0, 1000.0),
            ]);
        }
        if let Some(gate) = &self.gate {
            // Half of the gate and a metre of wall beside it.
            let most = self.area.side / 2.0 - GATE - 1.0;
            numbers.push(("along", gate.along, -most, most));
        }
        for (name, value, low, high) in numbers {
            // Also refuses NaN.
            if !(low..=high).contains(&value) {
                let field = name.replace(":>", ".");
                let reason = format!("`{field}` is {value}, but must be {low} to {high}");
                return Err((format!("{name}:"), reason));
            }
        }
        if self.beacons.is_empty() {
            return Err((
                "beacons:".into(),
                "`beacons` is empty: there is nothing to win".into(),
            ));
        }
        let names = self.beacons.iter().map(|beacon| &beacon.name);
        let names: Vec<_> = names
            .chain(self.patrols.iter().map(|patrol| &patrol.name))
            .collect();
        for (at, name) in names.iter().enumerate() {
            if names[..at].contains(name) {
                let reason = format!("two are called `{name}`: names tell them apart");
                return Err((format!("\"{name}\""), reason));
            }
        }
        for patrol in &self.patrols {
            if patrol.way.len() < 2 {
                let reason = format!("patrol `{}` needs two places or more", patrol.name);
                return Err((format!("\"{}\"", patrol.name), reason));
            }
        }
        for (name, place) in self.places() {
            let inside = (place - Vec2::from(self.area.middle)).abs().max_element();
            // Also refuses NaN.
            if inside.is_nan() || inside >= self.area.side / 2.0 {
                let reason = format!("{place} of `{name}` lies outside of the area");
                return Err((quoted(&name), reason));
            }
        }
        if !self.start.2.is_finite() {
            return Err(("start:".into(), "`start` looks nowhere".into()));
        }
        Ok(())
    }

    /// Every place, with what it belongs to.
    pub fn places(&self) -> Vec<(String, Vec2)> {
        let mut all = vec![("start".to_owned(), Vec2::new(self.start.0, self.start.1))];
        for beacon in &self.beacons {
            all.push((beacon.name.clone(), beacon.at.into()));
        }
        for at in &self.bandages.at {
            all.push(("bandages".to_owned(), (*at).into()));
        }
        for patrol in &self.patrols {
            all.extend(
                patrol
                    .way
                    .iter()
                    .map(|at| (patrol.name.clone(), Vec2::from(*at))),
            );
        }
        all
    }
}

/// What stands in the file for a name: fields are followed by a colon, names stand in quotes.
pub fn quoted(name: &str) -> String {
    match name {
        "start" | "bandages" => format!("{name}:"),
        _ => format!("\"{name}\""),
    }
}

/// The error of a value: the last line, comments aside, in which what was looked for begins a word. Of `a:>b:` it is
/// the first with `b:` from the last with `a:` on.
pub fn refuse(text: &str, path: &Path, (needle, reason): Refused) -> LevelError {
    let begins = |line: &str, needle: &str| {
        let line = line.split("//").next().unwrap_or_default();
        line.match_indices(needle).any(|(at, _)| {
            let before = line[..at].chars().next_back();
            !before.is_some_and(|c| c.is_alphanumeric() || c == '_')
        })
    };
    let lines: Vec<_> = text.lines().collect();
    let last = |needle: &str| lines.iter().rposition(|line| begins(line, needle));
    let line = match needle.split_once(":>") {
        Some((part, field)) => last(&format!("{part}:")).map(|from| {
            let below = lines[from..].iter().position(|line| begins(line, field));
            from + below.unwrap_or(0)
        }),
        None => last(&needle),
    };
    LevelError::Value {
        path: path.to_owned(),
        line: line.map_or(1, |at| at + 1),
        reason,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = include_str!("../../assets/levels/mountain.ron");

    fn error(from: &str, to: &str) -> String {
        assert!(GOOD.contains(from), "{from}");
        let text = GOOD.replacen(from, to, 1);
        let error = LevelFile::parse(&text, Path::new("a.ron"));
        error.expect_err(to).to_string()
    }

    #[test]
    fn what_makes_no_sense_is_refused_with_file_and_line() {
        let level = LevelFile::parse(GOOD, Path::new("a.ron")).unwrap();
        assert_eq!(level.beacons.len(), 4);
        let line = |needle: &str| {
            let at = GOOD.lines().position(|line| line.contains(needle)).unwrap();
            format!("a.ron:{}:", at + 1)
        };
        for (from, to, word) in [
            ("seconds: 1500.0", "seconds: 0.0", "seconds: 1500"),
            ("hold: 3.0", "hold: NaN", "hold: 3"),
            ("damage: 6.0", "damage: -1.0", "damage: 6"),
            ("\"North Horn\"", "\"The Needle\"", "\"North Horn\""),
            ("at: (162.0, 1686.0)", "at: (9162.0, 1686.0)", "Broad Back"),
            ("(390.0, 1900.0)]", "(inf, 1900.0)]", "\"knoll\""),
            ("hour: 17.4", "hour: 25.0", "hour: 17.4"),
        ] {
            let error = error(from, to);
            assert!(
                error.contains(&line(word)),
                "{to}: {error} is not at {}",
                line(word)
            );
        }
        let unknown = error("hold: 3.0", "holds: 3.0");
        assert!(
            unknown.contains("a.ron:") && unknown.contains("holds"),
            "{unknown}"
        );
    }
}
