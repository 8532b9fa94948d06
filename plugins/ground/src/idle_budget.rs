//! Budgets that move nothing: they are told.

use bevy::prelude::*;
use dolomite_geometry::budget::Budget;

use crate::cover::{PatchDetail, TerrainView};
use crate::detail::{Metric, TerrainLod};

/// Frames for which a budget may move nothing before that is said: settings are put on a camera one after the other.
const PATIENCE: u32 = 30;

/// Why a budget moves nothing of the ground that a camera sees, if it does not.
fn idle(detail: Option<&TerrainLod>, by_patches: bool) -> Option<&'static str> {
    match detail {
        _ if by_patches => Some("a PatchDetail chooses its ground, by no tolerance; remove it"),
        None => Some("it has no TerrainLod"),
        Some(detail) => matches!(detail.metric, Metric::Classic { .. })
            .then_some("Metric::Classic has no tolerance; take ErrorBound or EdgeLength"),
    }
}

/// Says once where a budget moves nothing. Cameras that see no ground may have a budget for something else.
pub fn tell(
    cameras: Query<
        (Entity, Option<&TerrainLod>, Has<PatchDetail>),
        (With<Budget>, With<TerrainView>),
    >,
    mut waited: Local<u32>,
) {
    let mut reasons = cameras
        .iter()
        .filter_map(|(camera, detail, by_patches)| Some((camera, idle(detail, by_patches)?)));
    let Some((camera, reason)) = reasons.next() else {
        if *waited < PATIENCE {
            *waited = 0;
        }
        return;
    };
    *waited = waited.saturating_add(1);
    if *waited == PATIENCE {
        tell!("the Budget of {camera} moves nothing of the ground: {reason}");
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_budget_that_moves_nothing_has_a_reason() {
        let detail = TerrainLod::default();
        assert_eq!(idle(Some(&detail), false), None);
        assert!(idle(Some(&detail), true).is_some_and(|why| why.contains("PatchDetail")));
        assert!(idle(None, false).is_some_and(|why| why.contains("TerrainLod")));
        let classic = TerrainLod {
            metric: Metric::Classic {
                patch: 16.0,
                least: 1.0,
                greatest: 32.0,
                reach: 400.0,
                height: 10.0,
            },
            ..detail
        };
        assert!(idle(Some(&classic), false).is_some_and(|why| why.contains("Classic")));
    }
}
