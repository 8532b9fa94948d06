//! What has come back of choices: to budgets of cameras, to the pace of making, and to [`GroundProgress`].

use bevy::prelude::*;
use bevy::render::renderer::RenderQueue;
use dolomite_geometry::render::{ExtractedGeometryCamera, GeometryView, Producers};

use super::prepare::BlockViews;
use crate::detail::Metric;
use crate::detail::work::GroundWork;
use crate::render::detail::{DetailKind, detail_key};
use crate::render::drawn::{DrawnGround, GroundProgress};

/// Hands out what has arrived.
pub fn hand_in<K: DetailKind>(
    producers: Res<Producers>,
    mut blocks: ResMut<BlockViews<K>>,
    cameras: Query<&ExtractedGeometryCamera>,
    work: Option<Res<GroundWork>>,
    queue: Res<RenderQueue>,
) {
    let BlockViews {
        views,
        stores,
        pace,
        ..
    } = &mut *blocks;
    if let Some(pace) = pace {
        pace.advance(queue.get_timestamp_period());
    }
    let (Some(work), Some(producer)) = (work, producers.get(detail_key::<K>())) else {
        return;
    };
    for (view, own) in views {
        let (Some(handed), Some(state), Ok(camera)) =
            (own.counted, producer.views.get(view), cameras.get(*view))
        else {
            continue;
        };
        let detail = own.inputs.detail;
        let store = stores.get(&detail.finest.to_bits());
        let (Some(head), Some(store)) = (own.news(state), store) else {
            continue;
        };
        let (Metric::ErrorBound { pixels } | Metric::EdgeLength { pixels }) = detail.metric else {
            continue;
        };
        if head.stamp == handed {
            continue;
        }
        let roots = store.ground.lattice.roots;
        if let Some(counts) = head.work(pixels, roots.x * roots.y) {
            work.set(camera.main, counts);
        }
        own.counted = Some(head.stamp);
    }
}

/// Says of every view of a kind what was drawn in the frame that has just been recorded.
pub fn report<K: DetailKind>(
    producers: Res<Producers>,
    blocks: Res<BlockViews<K>>,
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
        let ground = state.and_then(|state| blocks.drawn(*view, state));
        progress.add(
            camera.main,
            ground.unwrap_or(DrawnGround {
                drawn: state.is_some_and(GeometryView::is_shown),
                ..DrawnGround::default()
            }),
        );
    }
}
