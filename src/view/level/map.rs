//! The map of a level, in the lower right corner: its ground in relief, beacons, the player, and soldiers who are
//! alarmed or near.

use bevy::asset::RenderAssetUsages;
use bevy::math::IVec2;
use bevy::prelude::*;
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat};
use dolomite::logic::Lamp;
use dolomite::logic::movement::WalkGrid;

use super::look::{DANGER, FIRE, GLASS, Hud};
use crate::level::gate::Bars;
use crate::level::parts::{Beacon, Fallen, Level, LevelState, Player, Soldier, ground_of};
use crate::view::{Dress, DressSystems, UiCamera};

/// Sides of the map, logical pixels.
const SIDE: f32 = 176.0;

/// Soldiers who are nearer than this are on the map, metres: who goes there has eyes.
const NEAR: f32 = 90.0;

/// Height between two contour lines, metres.
const CONTOUR: f32 = 25.0;

/// The map of a level.
pub struct MapPlugin;

impl Plugin for MapPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Dress, spawn.in_set(DressSystems::Panels))
            .add_systems(Update, mark.run_if(any_with_component::<Map>));
    }
}

#[derive(Component)]
struct Map;

/// A mark, and for whom.
#[derive(Component)]
struct Mark(Entity);

/// Relief, lit from the north-west, with contour lines; what cannot be walked is brown.
fn relief(grid: &WalkGrid) -> Vec<u8> {
    let size = grid.size().as_ivec2();
    let mut pixels = Vec::with_capacity((size.x * size.y * 4) as usize);
    let height = |x: i32, z: i32| grid.height(grid.middle(IVec2::new(x, z)));
    for z in 0..size.y {
        for x in 0..size.x {
            let cell = grid.cell();
            let slope = Vec2::new(
                height(x + 1, z) - height(x - 1, z),
                height(x, z + 1) - height(x, z - 1),
            ) / (2.0 * cell);
            let light = (0.62 + 0.32 * (slope.x + slope.y)).clamp(0.12, 1.0);
            let here = height(x, z);
            let level = |h: f32| (h / CONTOUR).floor();
            let line =
                level(here) != level(height(x - 1, z)) || level(here) != level(height(x, z - 1));
            let ground = match grid.is_walkable(IVec2::new(x, z)) {
                true => Vec3::new(0.60, 0.64, 0.50),
                false => Vec3::new(0.52, 0.42, 0.34),
            };
            let shade = light * if line { 0.72 } else { 1.0 };
            let colour = ground * shade * 255.0;
            pixels.extend([colour.x as u8, colour.y as u8, colour.z as u8, 235]);
        }
    }
    pixels
}

/// The map of the level that is played.
pub(super) fn spawn(
    mut commands: Commands,
    level: Res<Level>,
    mut images: ResMut<Assets<Image>>,
    camera: Single<Entity, With<UiCamera>>,
) {
    let size = level.grid.size();
    let image = Image::new(
        Extent3d {
            width: size.x,
            height: size.y,
            depth_or_array_layers: 1,
        },
        TextureDimension::D2,
        relief(&level.grid),
        TextureFormat::Rgba8UnormSrgb,
        RenderAssetUsages::RENDER_WORLD,
    );
    commands.spawn((
        Hud,
        UiTargetCamera(*camera),
        Node {
            position_type: PositionType::Absolute,
            right: px(14),
            bottom: px(14),
            padding: UiRect::all(px(5)),
            border_radius: BorderRadius::all(px(7)),
            ..default()
        },
        BackgroundColor(GLASS),
        children![(
            Map,
            ImageNode::new(images.add(image)),
            Node {
                width: px(SIDE),
                height: px(SIDE),
                ..default()
            },
        )],
    ));
}

fn mark(
    mut commands: Commands,
    level: Res<Level>,
    map: Single<Entity, With<Map>>,
    players: Query<(Entity, &Transform), With<Player>>,
    beacons: Query<(Entity, &Transform, &Lamp), With<Beacon>>,
    soldiers: Query<(Entity, &Transform, &Soldier), Without<Fallen>>,
    gates: Query<(Entity, &Transform), With<Bars>>,
    state: Res<LevelState>,
    mut marks: Query<(Entity, &Mark, &mut Node, &mut BackgroundColor)>,
) {
    let Some((player, at)) = players.iter().next() else {
        return;
    };
    let me = ground_of(at);
    let mut wanted: Vec<(Entity, Vec2, f32, Color)> = Vec::new();
    for (entity, at, lamp) in &beacons {
        let color = if lamp.lit {
            FIRE
        } else {
            Color::srgb(0.12, 0.10, 0.09)
        };
        wanted.push((entity, ground_of(at), 9.0, color));
    }
    for (entity, at, soldier) in &soldiers {
        let place = ground_of(at);
        if soldier.alarmed || place.distance(me) < NEAR {
            let color = match soldier.alarmed {
                true => DANGER,
                false => Color::srgb(0.20, 0.34, 0.72),
            };
            wanted.push((entity, place, 6.0, color));
        }
    }
    for (entity, at) in gates.iter().filter(|_| state.open) {
        wanted.push((entity, ground_of(at), 9.0, FIRE));
    }
    wanted.push((player, me, 7.0, Color::WHITE));
    let origin = level.grid.origin();
    let whole = level.grid.size().as_vec2() * level.grid.cell();
    let node = |place: Vec2, size: f32| {
        let part = ((place - origin) / whole).clamp(Vec2::ZERO, Vec2::ONE);
        Node {
            position_type: PositionType::Absolute,
            left: px(part.x * SIDE - size / 2.0),
            top: px(part.y * SIDE - size / 2.0),
            width: px(size),
            height: px(size),
            border: UiRect::all(px(1)),
            border_radius: BorderRadius::all(px(size / 2.0)),
            ..default()
        }
    };
    for (entity, mark, mut old, mut color) in &mut marks {
        match wanted.iter().position(|(of, ..)| *of == mark.0) {
            Some(at) => {
                let (_, place, size, now) = wanted.swap_remove(at);
                old.set_if_neq(node(place, size));
                color.set_if_neq(BackgroundColor(now));
            }
            None => commands.entity(entity).despawn(),
        }
    }
    for (of, place, size, color) in wanted {
        let dot = (
            Mark(of),
            node(place, size),
            BackgroundColor(color),
            BorderColor::all(Color::srgba(1.0, 1.0, 1.0, 0.85)),
        );
        commands.entity(*map).with_child(dot);
    }
}
