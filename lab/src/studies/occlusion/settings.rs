//! Who finds how much light from everywhere arrives, and how much it looks at.

use bevy::pbr::{ScreenSpaceAmbientOcclusion, ScreenSpaceAmbientOcclusionQualityLevel};
use bevy::prelude::*;
use dolomite_deferred::{
    AmbientOcclusion, DeferredLighting, OcclusionQuality, OcclusionResolution,
};

/// By name.
pub const QUALITIES: [(&str, OcclusionQuality); 4] = [
    ("low", OcclusionQuality::Low),
    ("medium", OcclusionQuality::Medium),
    ("high", OcclusionQuality::High),
    ("ultra", OcclusionQuality::Ultra),
];

/// Whose occlusion it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum By {
    /// Ours.
    Ours(OcclusionQuality, OcclusionResolution),
    /// Bevy's, at the quality of the same name.
    Bevy(OcclusionQuality),
    /// Nobody's, in our light.
    Nobody,
    /// Nobody's, in Bevy's light.
    NobodyBevy,
}

impl By {
    /// As the report has it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Ours(_, OcclusionResolution::Full) => "full",
            Self::Ours(_, OcclusionResolution::Half) => "half",
            Self::Bevy(_) => "bevy",
            Self::Nobody | Self::NobodyBevy => "none",
        }
    }

    /// That of its quality.
    pub fn quality_name(self) -> &'static str {
        let (Self::Ours(quality, _) | Self::Bevy(quality)) = self else {
            return "none";
        };
        let found = QUALITIES.iter().find(|(_, other)| *other == quality);
        found.map_or("none", |(name, _)| name)
    }

    /// The frame that it is held against: the same without occlusion.
    pub const fn without(self) -> Self {
        match self {
            Self::Bevy(_) | Self::NobodyBevy => Self::NobodyBevy,
            _ => Self::Nobody,
        }
    }

    /// Puts it on a camera, and takes away all others.
    pub fn put(self, app: &mut App, camera: Entity, radius: f32) {
        let mut camera = app.world_mut().entity_mut(camera);
        camera.remove::<(AmbientOcclusion, ScreenSpaceAmbientOcclusion)>();
        match self {
            Self::Bevy(_) | Self::NobodyBevy => camera.remove::<DeferredLighting>(),
            _ => camera.insert(DeferredLighting::default()),
        };
        match self {
            Self::Ours(quality, resolution) => {
                camera.insert(AmbientOcclusion {
                    radius,
                    quality,
                    resolution,
                    ..default()
                });
            }
            Self::Bevy(quality) => {
                camera.insert(ScreenSpaceAmbientOcclusion {
                    quality_level: level(quality),
                    ..default()
                });
            }
            Self::Nobody | Self::NobodyBevy => {}
        }
    }
}

const fn level(quality: OcclusionQuality) -> ScreenSpaceAmbientOcclusionQualityLevel {
    match quality {
        OcclusionQuality::Low => ScreenSpaceAmbientOcclusionQualityLevel::Low,
        OcclusionQuality::Medium => ScreenSpaceAmbientOcclusionQualityLevel::Medium,
        OcclusionQuality::High => ScreenSpaceAmbientOcclusionQualityLevel::High,
        OcclusionQuality::Ultra => ScreenSpaceAmbientOcclusionQualityLevel::Ultra,
    }
}
