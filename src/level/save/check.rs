//! What nobody could have saved is refused.

use bevy::math::Vec2;

use super::{SaveError, Saved};
use crate::level::parts::Level;

/// Whether a saved game can be one of a level.
///
/// # Errors
/// [`SaveError::Other`], [`SaveError::Value`].
pub(super) fn check(saved: &Saved, level: &Level) -> Result<(), SaveError> {
    let file = &level.file;
    let counts = |a: usize, b: usize, c: usize, d: usize| {
        format!("{a} beacons, {b} bandages, {c} patrols, {d} lifts")
    };
    let has = counts(
        saved.beacons.len(),
        saved.bandages.len(),
        saved.soldiers.len(),
        saved.lifts.len(),
    );
    let needs = counts(
        file.beacons.len(),
        file.bandages.at.len(),
        file.patrols.len(),
        level.built.roofs.iter().flatten().count(),
    );
    if saved.level != level.name || has != needs {
        return Err(SaveError::Other {
            saved: saved.level.clone(),
            has,
            level: level.name.to_owned(),
            needs,
        });
    }
    let range = |name: &str, value: f64, low: f64, high: f64| match (low..=high).contains(&value) {
        true => Ok(()),
        false => Err(SaveError::Value(format!("`{name}` is {value}"))),
    };
    range("passed", saved.passed.into(), 0.0, file.seconds.into())?;
    range("hour", saved.hour.into(), 0.0, 24.0)?;
    // The dead do not die, so that their game would go on without them.
    let least = f64::MIN_POSITIVE;
    range("health", saved.health.into(), least, file.health.into())?;
    let far = 1e7;
    range(
        "figure",
        saved.figure.0.abs().max(saved.figure.1.abs()),
        0.0,
        far,
    )?;
    range("figure", saved.figure.2.into(), -1e4, 1e4)?;
    range("above", saved.above, 0.0, 1000.0)?;
    if let Some(rounds) = saved.rounds {
        let most = file.weapon.map_or(0, |weapon| weapon.rounds);
        range("rounds", rounds.into(), 0.0, most.into())?;
    }
    for floor in &saved.lifts {
        range("lift", *floor as f64, 0.0, 1.0)?;
    }
    for (soldier, patrol) in saved.soldiers.iter().zip(&file.patrols) {
        let (x, z, yaw) = soldier.place;
        range(
            "next",
            soldier.next as f64,
            0.0,
            patrol.way.len() as f64 - 1.0,
        )?;
        range("notice", soldier.notice.into(), 0.0, 1.0)?;
        range("yaw", yaw.into(), -1e4, 1e4)?;
        range("soldier's health", soldier.health.into(), 0.0, 1.0)?;
        if level.grid.nearest_open(Vec2::new(x, z), 4).is_none() {
            let reason = format!("a soldier stands at {x}, {z}, where nobody can");
            return Err(SaveError::Value(reason));
        }
    }
    Ok(())
}
