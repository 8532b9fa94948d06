//! Hands the histograms that have arrived to the budgets of cameras.

use bevy::prelude::*;
use dolomite_geometry::render::ExtractedGeometryCamera;

use super::DetailKind;
use super::counted::Counted;
use super::prepare::DetailViews;
use crate::detail::work::GroundWork;

/// Hands what has arrived to the budgets.
pub fn hand_in<K: DetailKind>(
    mut details: ResMut<DetailViews<K>>,
    cameras: Query<&ExtractedGeometryCamera>,
    work: Option<Res<GroundWork>>,
) {
    for (view, own) in &mut details.views {
        let Some(arrived) = own.counted.as_mut().and_then(Counted::advance) else {
            continue;
        };
        if let (Some(work), Ok(camera)) = (&work, cameras.get(*view)) {
            work.set(camera.main, arrived);
        }
    }
}
