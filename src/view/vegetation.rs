//! What grows on the ground, where the settings ask for it.

use std::sync::Arc;

use bevy::prelude::*;
use dolomite::vegetation::{PressesGrass, Vegetation, Wind};

use crate::input::PlayerInput;
use crate::play::Landscape;
use crate::play::figure::Figure;
use crate::scene::CurrentScene;
use crate::settings::Settings;
use crate::settings::quality::DeviceKind;

use super::quality::DrawnBy;

/// Gives the landscape what the scene says that grows there.
pub struct PlantPlugin;

impl Plugin for PlantPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            Update,
            (
                (
                    switch.run_if(|input: Res<PlayerInput>| input.switch_vegetation),
                    plant,
                )
                    .chain(),
                press,
            ),
        );
    }
}

/// As the settings say; else where a GPU draws a window: pictures and measurements shall be the same on each device, and
/// a program on the CPU has no time for it.
fn grows(settings: &Settings, device: DrawnBy) -> bool {
    let gpu = device.0.is_some_and(|kind| kind != DeviceKind::Software);
    settings.vegetation.unwrap_or(gpu)
}

fn switch(mut settings: ResMut<Settings>, device: Res<DrawnBy>) {
    settings.vegetation = Some(!grows(&settings, *device));
}

fn plant(
    mut commands: Commands,
    scene: Res<CurrentScene>,
    settings: Res<Settings>,
    device: Res<DrawnBy>,
    landscapes: Query<(Entity, Option<&Vegetation>), With<Landscape>>,
) {
    if !scene.is_changed() && !settings.is_changed() {
        return;
    }
    let kinds = scene
        .vegetation
        .as_ref()
        .filter(|_| grows(&settings, *device));
    for (entity, known) in &landscapes {
        match kinds {
            Some(kinds) => {
                let wanted = Vegetation {
                    kinds: Arc::clone(kinds),
                    density: settings.vegetation_density,
                    reach: settings.vegetation_reach,
                    ..default()
                };
                if known != Some(&wanted) {
                    commands.entity(entity).insert((wanted, Wind::default()));
                }
            }
            None if known.is_some() => {
                commands.entity(entity).remove::<(Vegetation, Wind)>();
            }
            None => {}
        }
    }
}

/// The figure presses grass aside.
fn press(mut commands: Commands, figures: Query<Entity, Added<Figure>>) {
    for figure in &figures {
        commands.entity(figure).insert(PressesGrass::default());
    }
}
