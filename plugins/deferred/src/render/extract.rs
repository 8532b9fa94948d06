//! From the camera to its view.

use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass};
use bevy::ecs::query::QueryItem;
use bevy::log::warn_once;
use bevy::pbr::deferred::SkipDeferredLighting;
use bevy::prelude::*;
use bevy::render::extract_component::ExtractComponent;
use bevy::render::sync_component::SyncComponent;

use super::difference::ViewDifference;
use super::prepare::ViewLighting;
use crate::components::{DeferredLighting, LightingDifference};
use crate::occlusion::AmbientOcclusion;

impl SyncComponent for DeferredLighting {
    // With the component goes all that was made for it, and Bevy's pass is back.
    type Target = (Self, SkipDeferredLighting, ViewLighting, ViewDifference);
}

impl ExtractComponent for DeferredLighting {
    type QueryData = (&'static Self, Has<DeferredPrepass>, Has<DepthPrepass>);
    type QueryFilter = ();
    type Out = (Self, SkipDeferredLighting);

    fn extract_component(
        (lighting, deferred, depth): QueryItem<'_, '_, Self::QueryData>,
    ) -> Option<Self::Out> {
        if !(deferred && depth) {
            warn_once!(
                "a camera with DeferredLighting has lost its DeferredPrepass or DepthPrepass: there is no G-buffer to light"
            );
            return None;
        }
        Some((*lighting, SkipDeferredLighting))
    }
}

impl SyncComponent for AmbientOcclusion {
    type Target = Self;
}

impl ExtractComponent for AmbientOcclusion {
    type QueryData = &'static Self;
    type QueryFilter = With<DeferredLighting>;
    type Out = Self;

    fn extract_component(occlusion: QueryItem<'_, '_, Self::QueryData>) -> Option<Self> {
        Some(*occlusion)
    }
}

impl SyncComponent for LightingDifference {
    type Target = (Self, ViewDifference);
}

impl ExtractComponent for LightingDifference {
    type QueryData = &'static Self;
    type QueryFilter = With<DeferredLighting>;
    type Out = Self;

    fn extract_component(difference: QueryItem<'_, '_, Self::QueryData>) -> Option<Self> {
        Some(*difference)
    }
}
