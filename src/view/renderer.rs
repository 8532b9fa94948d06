//! Who lights the picture: Bevy's deferred pass, or Dolomite's.

use bevy::prelude::*;
use dolomite::deferred::DeferredLighting;
use dolomite::ground::TerrainView;

use crate::input::PlayerInput;
use crate::settings::{Renderer, Settings};

/// Gives cameras the renderer that the settings name.
pub struct RendererPlugin;

impl Plugin for RendererPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            Update,
            (
                switch.run_if(|input: Res<PlayerInput>| input.switch_renderer),
                dress,
            )
                .chain(),
        );
    }
}

fn switch(mut settings: ResMut<Settings>) {
    settings.renderer = match settings.renderer {
        Renderer::Bevy => Renderer::Dolomite,
        Renderer::Dolomite => Renderer::Bevy,
    };
}

/// The renderer that a camera has got; so that what is taken from it otherwise, to measure, stays away.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
struct LitBy(Renderer);

fn dress(
    mut commands: Commands,
    settings: Res<Settings>,
    cameras: Query<(Entity, Option<&LitBy>), With<TerrainView>>,
) {
    let renderer = settings.renderer;
    for (camera, lit) in &cameras {
        if lit.is_some_and(|lit| lit.0 == renderer) {
            continue;
        }
        let mut camera = commands.entity(camera);
        camera.insert(LitBy(renderer));
        match renderer {
            Renderer::Dolomite => camera.insert(DeferredLighting::default()),
            Renderer::Bevy => camera.remove::<DeferredLighting>(),
        };
    }
}
