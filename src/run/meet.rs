//! Soldiers before the player, for a picture of them.

use bevy::math::ops;
use bevy::prelude::*;

use crate::level::parts::{MIDDLE, Numbered, Soldier};
use crate::level::{Level, LevelSystems, arms};

/// Metres between two of them.
const APART: f32 = 2.2;

/// The first soldiers of a level stand before the player's start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Meet {
    /// How far ahead, metres.
    pub ahead: f32,
    /// How many.
    pub count: usize,
    /// How many of them fell before anybody saw it: they lie.
    pub fallen: usize,
}

impl Meet {
    /// Arranges it once.
    pub fn add(self, app: &mut App) {
        let arrange =
            move |level: Res<Level>,
                  mut soldiers: Query<(&Numbered, Entity, &mut Transform), With<Soldier>>,
                  mut commands: Commands| {
                let mut all: Vec<_> = soldiers.iter_mut().collect();
                all.sort_by_key(|(number, ..)| **number);
                let (x, z, yaw) = level.file.start;
                let (sin, cos) = ops::sin_cos(yaw.to_radians());
                let (ahead, aside) = (Vec2::new(-sin, -cos), Vec2::new(cos, -sin));
                for (at, (_, soldier, transform)) in all.into_iter().take(self.count).enumerate() {
                    let off = at as f32 - 0.5 * (self.count as f32 - 1.0);
                    let place = Vec2::new(x, z) + ahead * self.ahead + aside * (off * APART);
                    let turn = Quat::from_rotation_y(yaw.to_radians() + std::f32::consts::PI);
                    *transform.into_inner() =
                        Transform::from_xyz(place.x, level.grid.height(place) + MIDDLE, place.y)
                            .with_rotation(turn);
                    if at < self.fallen {
                        arms::fall(&mut commands.entity(soldier));
                    }
                }
            };
        app.add_systems(Startup, arrange.after(LevelSystems::Begin));
    }
}
