//! Whether it is won.

use bevy::prelude::*;
use dolomite::logic::parts::Outcome;
use dolomite::logic::{Health, Mission};

use super::parts::{Cast, LevelState, Verdict};

/// Counts steps, and says how the mission ended.
pub(super) fn judge(
    cast: Res<Cast>,
    mut state: ResMut<LevelState>,
    missions: Query<&Mission>,
    healths: Query<&Health>,
) {
    if state.verdict.is_some() {
        return;
    }
    state.steps += 1;
    let alive = healths.get(cast.player).is_ok_and(Health::is_alive);
    state.verdict = match missions.get(cast.mission).map(|mission| mission.outcome) {
        Ok(Outcome::Won) => Some(Verdict::Won),
        Ok(Outcome::Lost) if alive => Some(Verdict::Late),
        Ok(Outcome::Lost) => Some(Verdict::Fell),
        Ok(Outcome::Open) | Err(_) => None,
    };
}
