//! What a file without meshes shows: a bone from each node to the one above it.

use bevy::prelude::*;

use super::{Model, Shown, State};

/// Width of a bone as a part of its length.
const WIDTH: f32 = 0.12;

/// Bones.
pub struct BonesPlugin;

impl Plugin for BonesPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Update, (grow, rest));
    }
}

/// Hangs a bone on every node that has others below it, once the model has come.
fn grow(
    mut commands: Commands,
    shown: Res<Shown>,
    mut was: Local<Option<State>>,
    models: Query<Entity, With<Model>>,
    children: Query<&Children>,
    meshed: Query<(), With<Mesh3d>>,
    nodes: Query<(&Transform, &ChildOf)>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    if was.replace(shown.state.clone()).as_ref() == Some(&shown.state)
        || shown.state != State::Ready
    {
        return;
    }
    let all: Vec<Entity> = models
        .iter()
        .flat_map(|model| children.iter_descendants(model))
        .collect();
    if all.iter().any(|entity| meshed.contains(*entity)) {
        return;
    }
    let bone = meshes.add(Cone::new(0.5 * WIDTH, 1.0).mesh().resolution(8));
    let ivory = materials.add(StandardMaterial {
        base_color: Color::srgb(0.86, 0.80, 0.66),
        perceptual_roughness: 0.6,
        ..default()
    });
    for (place, above) in all.iter().filter_map(|entity| nodes.get(*entity).ok()) {
        let way = place.translation;
        let Some(along) = way.try_normalize() else {
            continue;
        };
        // The way from the scene's root to the first node is no bone.
        if !all.contains(&above.parent()) {
            continue;
        }
        commands.spawn((
            Mesh3d(bone.clone()),
            MeshMaterial3d(ivory.clone()),
            Transform {
                translation: 0.5 * way,
                rotation: Quat::from_rotation_arc(Vec3::Y, along),
                scale: Vec3::splat(way.length()),
            },
            ChildOf(above.parent()),
        ));
    }
}

/// Cameras and lights of the file are not those of the viewer.
fn rest(
    mut cameras: Query<&mut Camera, (Added<Camera>, With<ChildOf>)>,
    mut lights: Query<
        &mut Visibility,
        (
            With<ChildOf>,
            Or<(Added<PointLight>, Added<SpotLight>, Added<DirectionalLight>)>,
        ),
    >,
) {
    for mut camera in &mut cameras {
        camera.is_active = false;
    }
    for mut light in &mut lights {
        *light = Visibility::Hidden;
    }
}
