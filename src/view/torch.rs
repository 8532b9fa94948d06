//! The figure's torch: a spot light in its hand, while it is switched on.

use bevy::prelude::*;

use super::quality;
use crate::play::Switches;
use crate::play::figure::Figure;
use crate::settings::quality::Quality;

/// Luminous flux that its intensity is that of, if it shone all around, lumens.
const LUMENS: f32 = 2600.0;

/// Where its light ends, metres.
const RANGE: f32 = 60.0;

/// Angles from the axis at which the cone begins to fade, and at which it ends, radians.
const CONE: (f32, f32) = (0.16, 0.42);

/// In the figure's right hand, the figure looking along +z, metres.
const HAND: Vec3 = Vec3::new(-0.28, 1.25, 0.35);

/// Adds the torch to figures while it is on.
pub struct TorchPlugin;

impl Plugin for TorchPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            Update,
            switch.run_if(resource_changed::<Switches>.or_else(resource_changed::<Quality>)),
        );
    }
}

/// On the light.
#[derive(Component)]
pub struct Torch;

fn switch(
    mut commands: Commands,
    switches: Res<Switches>,
    quality: Res<Quality>,
    figures: Query<Entity, With<Figure>>,
    mut torches: Query<(Entity, &mut SpotLight), With<Torch>>,
) {
    let shadows = quality::torch_casts(&quality);
    if !switches.torch {
        for (torch, _) in &torches {
            commands.entity(torch).despawn();
        }
        return;
    }
    if !torches.is_empty() {
        for (_, mut light) in &mut torches {
            if light.shadow_maps_enabled != shadows {
                light.shadow_maps_enabled = shadows;
            }
        }
        return;
    }
    for figure in &figures {
        let light = SpotLight {
            color: Color::linear_rgb(1.0, 0.92, 0.78),
            intensity: LUMENS,
            range: RANGE,
            radius: 0.02,
            inner_angle: CONE.0,
            outer_angle: CONE.1,
            shadow_maps_enabled: shadows,
            ..default()
        };
        // A little down: to the ground some ten metres ahead.
        let ahead =
            Transform::from_translation(HAND).looking_to(Vec3::new(0.0, -0.11, 1.0), Vec3::Y);
        commands.entity(figure).with_child((Torch, light, ahead));
    }
}
