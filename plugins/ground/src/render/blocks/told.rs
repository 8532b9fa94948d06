//! What has come back of choices: to budgets of cameras, and to the pace of making.

use bevy::prelude::*;
use bevy::render::renderer::RenderQueue;
use dolomite_geometry::render::{ExtractedGeometryCamera, Producers};

use super::prepare::BlockViews;
use crate::detail::Metric;
use crate::detail::work::GroundWork;
use crate::render::detail::{DetailKind, detail_key};

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
