//! What a level builds in a city: walls and bridges, lifts with their buttons, flat roofs, the gate.

use bevy::prelude::*;
use dolomite::collision::Blocker;

use crate::level::gate::Bars;
use crate::level::lifts::{Panel, RoofLift, Wall};
use crate::level::menu::MenuSystems;
use crate::level::parts::{Level, LevelPart, Numbered};
use crate::level::town::PLATE;
use crate::scene::CurrentScene;

/// Side of the posts of a shaft, metres, and how far they stand above the roof.
const POST: f32 = 0.12;
const OVER: f32 = 1.2;

/// Walls that are thinner than this are rails, metres.
const RAIL: f32 = 0.25;

/// Dresses what a level has built.
pub struct TownPlugin;

impl Plugin for TownPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(
            Update,
            (
                dress_boxes.run_if(any_with_component::<Blocker>),
                dress_lifts.run_if(any_with_component::<RoofLift>),
                dress_panels.run_if(any_with_component::<Panel>),
            )
                .after(MenuSystems),
        );
    }
}

fn matt(r: f32, g: f32, b: f32) -> StandardMaterial {
    StandardMaterial {
        base_color: Color::srgb(r, g, b),
        perceptual_roughness: 0.85,
        ..default()
    }
}

fn metal(r: f32, g: f32, b: f32) -> StandardMaterial {
    StandardMaterial {
        metallic: 0.6,
        perceptual_roughness: 0.5,
        ..matt(r, g, b)
    }
}

/// Everything that is a box is drawn as the box that it is.
fn dress_boxes(
    mut commands: Commands,
    boxes: Query<
        (Entity, &Blocker, Has<Wall>, Has<Bars>),
        (Added<Blocker>, Or<(With<Wall>, With<Bars>, With<RoofLift>)>),
    >,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    if boxes.is_empty() {
        return;
    }
    let stone = materials.add(matt(0.42, 0.40, 0.37));
    let rail = materials.add(matt(0.34, 0.24, 0.16));
    let iron = materials.add(metal(0.16, 0.17, 0.18));
    let plate = materials.add(metal(0.40, 0.38, 0.30));
    for (entity, blocker, wall, bars) in &boxes {
        let half = blocker.half_size;
        let material = match (wall, bars) {
            (true, _) if half.min_element() < RAIL => &rail,
            (true, _) => &stone,
            (false, true) => &iron,
            (false, false) => &plate,
        };
        commands.entity(entity).insert((
            Mesh3d(meshes.add(Cuboid::from_size(half * 2.0))),
            MeshMaterial3d(material.clone()),
        ));
    }
}

/// The posts of a shaft, and the flat roof that it leads to in place of a pitched one: the box that is stood on.
fn dress_lifts(
    mut commands: Commands,
    level: Res<Level>,
    scene: Res<CurrentScene>,
    lifts: Query<&Numbered, Added<RoofLift>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    let Some(city) = scene.city.as_ref().filter(|_| !lifts.is_empty()) else {
        return;
    };
    let iron = materials.add(metal(0.16, 0.17, 0.18));
    let render = materials.add(matt(0.50, 0.46, 0.40));
    for number in &lifts {
        let Some(Some(roof)) = level.built.roofs.get(number.0 as usize) else {
            continue;
        };
        let [low, high] = roof.house;
        let attic = city.rules.roof.height;
        // A hand wider than the walls, as eaves are.
        let size = Vec3::new(high.x - low.x + 0.3, attic, high.z - low.z + 0.3);
        let middle = Vec3::new(
            (low.x + high.x) / 2.0,
            high.y - attic / 2.0,
            (low.z + high.z) / 2.0,
        );
        commands.spawn((
            LevelPart,
            Mesh3d(meshes.add(Cuboid::from_size(size))),
            MeshMaterial3d(render.clone()),
            Transform::from_translation(middle),
        ));
        let [ground, top] = roof.floors;
        let height = top + OVER - ground;
        let post = meshes.add(Cuboid::new(POST, height, POST));
        for side in [-1.0, 1.0] {
            let at = roof.shaft - roof.out * PLATE.x + roof.along() * (side * (PLATE.x + POST));
            commands.spawn((
                LevelPart,
                Mesh3d(post.clone()),
                MeshMaterial3d(iron.clone()),
                Transform::from_xyz(at.x, ground + height / 2.0, at.y),
            ));
        }
    }
}

fn dress_panels(
    mut commands: Commands,
    panels: Query<Entity, Added<Panel>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    if panels.is_empty() {
        return;
    }
    let (case, stem) = (
        meshes.add(Cuboid::new(0.18, 0.24, 0.18)),
        meshes.add(Cuboid::new(0.07, 1.0, 0.07)),
    );
    let yellow = materials.add(StandardMaterial {
        emissive: LinearRgba::rgb(0.5, 0.32, 0.02),
        ..matt(0.75, 0.55, 0.10)
    });
    let iron = materials.add(metal(0.16, 0.17, 0.18));
    for panel in &panels {
        commands
            .entity(panel)
            .insert((Mesh3d(case.clone()), MeshMaterial3d(yellow.clone())))
            .with_child((
                Mesh3d(stem.clone()),
                MeshMaterial3d(iron.clone()),
                Transform::from_xyz(0.0, -0.6, 0.0),
            ));
    }
}
