//! What the choice has come to in each view, for [`GroundProgress`].

use bevy::prelude::*;
use dolomite_geometry::layout::OWN;
use dolomite_geometry::render::{ExtractedGeometryCamera, GeometryView, Producers};

use super::prepare::DetailViews;
use super::{DetailKind, detail_key};
use crate::detail::Metric;
use crate::detail::layout::{HEAD_COARSENING, HEAD_LEFT};
use crate::render::drawn::{DrawnGround, GroundProgress};

/// Says of every view of a kind what was drawn in the frame that has just been recorded.
pub fn report<K: DetailKind>(
    producers: Res<Producers>,
    details: Res<DetailViews<K>>,
    cameras: Query<&ExtractedGeometryCamera>,
    progress: Option<Res<GroundProgress>>,
) {
    let (Some(progress), Some(producer)) = (progress, producers.get(detail_key::<K>())) else {
        return;
    };
    // What is wanted and has no pools yet is not settled either.
    for (view, _) in &producer.wanted {
        let Ok(camera) = cameras.get(*view) else {
            continue;
        };
        let state = producer.views.get(view);
        let metric = details.views.get(view).map(|own| own.detail.metric);
        let ground = DrawnGround {
            drawn: state.is_some_and(GeometryView::is_shown),
            settled: state.is_some_and(|state| state.settled && state.filled),
            held: state
                .zip(metric)
                .and_then(|(state, metric)| held(state, metric)),
        };
        progress.add(camera.main, ground);
    }
}

/// The bound that a view's choice keeps. Error ratios are in units of the tolerance: it was raised by the coarsening,
/// and the smallest cells leave what they leave.
fn held(state: &GeometryView, metric: Metric) -> Option<f32> {
    let pixels = match metric {
        Metric::ErrorBound { pixels } | Metric::EdgeLength { pixels } => pixels,
        Metric::Classic { .. } => return None,
    };
    if !(state.filled && state.counters.is_current()) {
        return None;
    }
    let word = |at: usize| f32::from_bits(state.counters.newest.own[at - OWN as usize]);
    Some(pixels * word(HEAD_COARSENING).max(word(HEAD_LEFT)).max(1.0))
}
