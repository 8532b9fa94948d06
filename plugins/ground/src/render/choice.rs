//! Both ways of choosing the triangles of a kind of ground, and what either has come to in each view, for
//! [`GroundProgress`].

use bevy::prelude::*;
use bevy::render::{Render, RenderApp, RenderSystems};
use dolomite_geometry::layout::OWN;
use dolomite_geometry::render::{ExtractedGeometryCamera, GeometryView, Producers};

use super::blocks;
use super::blocks::prepare::BlockViews;
use super::detail::prepare::DetailViews;
use super::detail::{self, DetailKind, detail_key};
use super::drawn::{DrawnGround, GroundProgress, Telling};
use super::inspect;
use crate::detail::Metric;
use crate::detail::layout::{HEAD_COARSENING, HEAD_LEFT};

/// Adds the systems of a kind to an app that renders, from `Plugin::finish` on; does nothing where they are.
/// The app needs [`GeometryPlugin`](dolomite_geometry::GeometryPlugin).
pub fn build<K: DetailKind>(app: &mut App) {
    if !detail::build::<K>(app) {
        return;
    }
    blocks::build::<K>(app);
    inspect::build::<K>(app);
    if let Some(render_app) = app.get_sub_app_mut(RenderApp) {
        let reports = report::<K>.in_set(RenderSystems::Cleanup);
        render_app.add_systems(Render, reports.in_set(Telling));
    }
}

/// Says of every view of a kind what was drawn in the frame that has just been recorded.
fn report<K: DetailKind>(
    producers: Res<Producers>,
    (details, blocks): (Res<DetailViews<K>>, Res<BlockViews<K>>),
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
        if let Some(ground) = state.and_then(|state| blocks.drawn(*view, state)) {
            progress.add(camera.main, ground);
            continue;
        }
        let metric = details.metric(*view);
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
