//! Dolomite: a data-oriented 3D engine layer on Bevy.
//!
//! Each part is a Bevy plugin in a crate of its own, which an app can add without the others.
//! This crate gathers them:
//!
//! | plugin | crate | gives | needs a renderer |
//! |---|---|---|---|
//! | [`TerrainPlugin`](terrain::TerrainPlugin) | [`terrain`] | heights, slopes and height queries from noise and height maps, in f64 | no |
//! | [`CharacterPlugin`](character::CharacterPlugin) | [`character`] | animated figures with feet on the ground, sampled as large as they are seen | no |
//! | [`CrowdPlugin`](character::render::CrowdPlugin) | [`character`] | crowds drawn from a palette of poses, 16 bytes a figure | yes |
//! | [`CollisionPlugin`](collision::CollisionPlugin) | [`collision`] | movers that slide over triangles and ground, blockers, triggers; with the feature `rapier` ground under Rapier's bodies | no |
//! | [`LogicPlugin`](logic::LogicPlugin) | [`logic`] | values and actions, lifts and doors, behaviours as data, senses, crowds | no |
//! | [`SoundPlugin`](sound::SoundPlugin) | [`sound`] | emitters and one-shots in space, voices by priority; with the feature `device` on the system's device | no |
//! | [`FbxPlugin`](fbx::FbxPlugin) | [`fbx`] | `load("hero.fbx")`, with the sub-assets of Bevy's glTF loader | no |
//! | [`PatchPlugin`](tessellation::render::PatchPlugin) | [`tessellation`] | patches of your own, tessellated by your control and evaluate functions | yes |
//! | [`GroundPlugin`](ground::GroundPlugin) | [`ground`] | terrain refined and drawn on the GPU | yes |
//! | [`VegetationPlugin`](vegetation::VegetationPlugin) | [`vegetation`] | what grows on the ground, by a file of kinds | no; to be seen, yes |
//! | [`SkyPlugin`](sky::SkyPlugin) | [`sky`] | sun, moon, stars, dusk, haze and exposure from the place of the sun | no; to be seen, yes |
//! | [`CityPlugin`](city::CityPlugin) | [`city`] | streets, houses and lamps by a rule file, as patches | yes |
//! | `InspectorPlugin` | `inspector` (feature `inspector`) | settings, entities and diagnostics on the screen; a console | to be seen, yes |
//! | [`DeferredPlugin`](deferred::DeferredPlugin) | [`deferred`] | thousands of lights by tiles or volumes, shading models of your own | yes |
//!
//! [`DolomitePlugins`] adds all of them; [`DolomiteMinimalPlugins`] those that need neither a renderer nor
//! assets. A plugin with none of its components in the world adds nothing to the GPU.
//!
//! ```
//! use bevy::prelude::*;
//! use dolomite::DolomiteMinimalPlugins;
//! use dolomite::terrain::{Ground, GroundProbe};
//!
//! let mut app = App::new();
//! app.add_plugins((MinimalPlugins, DolomiteMinimalPlugins));
//! ```
//!
//! Coordinates everywhere: metres and radians (places of the sun: degrees), right-handed, +Y up, −Z forward (north).

pub use dolomite_character as character;
pub use dolomite_city as city;
pub use dolomite_collision as collision;
pub use dolomite_deferred as deferred;
pub use dolomite_fbx as fbx;
pub use dolomite_geometry as geometry;
pub use dolomite_ground as ground;
#[cfg(feature = "inspector")]
pub use dolomite_inspector as inspector;
pub use dolomite_logic as logic;
pub use dolomite_sky as sky;
pub use dolomite_sound as sound;
pub use dolomite_terrain as terrain;
pub use dolomite_tessellation as tessellation;
pub use dolomite_vegetation as vegetation;

#[cfg(feature = "inspector")]
mod described;
#[cfg(feature = "inspector")]
mod pictures;

use bevy::app::{PluginGroup, PluginGroupBuilder};

#[cfg(feature = "inspector")]
pub use described::describe;
#[cfg(feature = "inspector")]
pub use pictures::{WAYS, pictures};

/// Every plugin of Dolomite. Add after Bevy's `DefaultPlugins`.
pub struct DolomitePlugins;

impl PluginGroup for DolomitePlugins {
    fn build(self) -> PluginGroupBuilder {
        PluginGroupBuilder::start::<Self>()
            .add_group(DolomiteMinimalPlugins)
            .add(fbx::FbxPlugin)
            .add(character::render::CrowdPlugin)
            .add(ground::GroundPlugin::default())
            .add(vegetation::VegetationPlugin)
            .add(sky::SkyPlugin)
            .add(city::CityPlugin)
            .add(deferred::DeferredPlugin)
    }
}

/// The plugins of Dolomite that need no renderer. Add after Bevy's `MinimalPlugins`.
pub struct DolomiteMinimalPlugins;

impl PluginGroup for DolomiteMinimalPlugins {
    fn build(self) -> PluginGroupBuilder {
        PluginGroupBuilder::start::<Self>()
            .add(terrain::TerrainPlugin)
            .add(character::CharacterPlugin)
            .add(collision::CollisionPlugin)
            .add(logic::LogicPlugin)
            .add(sound::SoundPlugin)
    }
}
