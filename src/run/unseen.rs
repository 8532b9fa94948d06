//! Frames that nobody sees: the ground is made in them, and what only makes pixels is left out.
//!
//! Where a picture is to be settled before anybody looks, its pixels are drawn in the last frame alone: on a device that
//! draws with the processor they take most of a frame's time. Compute passes, read-back and pipelines go on as ever.

use bevy::core_pipeline::{Core3d, Core3dSystems};
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::extract_resource::{ExtractResource, ExtractResourcePlugin};
use dolomite::geometry::render::GeometrySystems;

/// Whether the frame is seen by nobody; the same in both worlds.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Unseen(pub bool);

impl ExtractResource for Unseen {
    type Source = Self;

    fn extract_resource(source: &Self) -> Self {
        *source
    }
}

/// Lets an app that has all its plugins leave out pixels while it is [`Unseen`].
pub fn add(app: &mut App) {
    app.init_resource::<Unseen>()
        .add_plugins(ExtractResourcePlugin::<Unseen>::default());
    let Some(renderer) = app.get_sub_app_mut(RenderApp) else {
        return;
    };
    renderer.configure_sets(
        Core3d,
        (
            GeometrySystems::Draw,
            Core3dSystems::MainPass,
            Core3dSystems::EarlyPostProcess,
            Core3dSystems::PostProcess,
        )
            .distributive_run_if(is_seen),
    );
}

fn is_seen(unseen: Option<Res<Unseen>>) -> bool {
    unseen.is_none_or(|unseen| !unseen.0)
}
