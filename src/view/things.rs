//! What things look like.

use bevy::asset::RenderAssetUsages;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;

use crate::play::things::{Solid, boulder};
use crate::scene::things::Thing;

/// Gives things meshes and materials. A stone has a stripe, so that one sees it roll.
pub struct ThingViewPlugin;

impl Plugin for ThingViewPlugin {
    fn build(&self, app: &mut App) {
        app.add_systems(Update, dress);
    }
}

/// Linear parts of light that are given back.
fn colour(thing: &Thing) -> (Color, f32) {
    match thing {
        Thing::Boulder { .. } => (Color::srgb(0.42, 0.40, 0.37), 0.95),
        Thing::Block { .. } => (Color::srgb(0.55, 0.47, 0.36), 0.9),
        Thing::Lift { .. } => (Color::srgb(0.20, 0.33, 0.42), 0.5),
        Thing::Stone { .. } => (Color::srgb(0.52, 0.50, 0.48), 0.85),
    }
}

fn dress(
    mut commands: Commands,
    things: Query<(Entity, &Solid), Added<Solid>>,
    mut meshes: ResMut<Assets<Mesh>>,
    mut materials: ResMut<Assets<StandardMaterial>>,
) {
    for (entity, Solid(thing)) in &things {
        let (base_color, perceptual_roughness) = colour(thing);
        let mesh = match thing {
            Thing::Boulder { .. } => boulder(thing).map(rough),
            Thing::Block { size, .. } | Thing::Lift { size, .. } => {
                Some(Cuboid::new(size.0, size.1, size.2).into())
            }
            Thing::Stone { radius, .. } => Some(Sphere::new(*radius).mesh().uv(24, 12)),
        };
        let Some(mesh) = mesh else { continue };
        let mut entity = commands.entity(entity);
        // The next scene may have taken its place by then.
        entity.try_insert((
            Mesh3d(meshes.add(mesh)),
            MeshMaterial3d(materials.add(StandardMaterial {
                base_color,
                perceptual_roughness,
                reflectance: 0.3,
                ..default()
            })),
        ));
        if let Thing::Stone { radius, .. } = thing {
            let stripe = Torus::new(radius * 0.93, radius * 1.02);
            entity.with_child((
                Mesh3d(meshes.add(stripe)),
                MeshMaterial3d(materials.add(StandardMaterial {
                    base_color: Color::srgb(0.30, 0.12, 0.08),
                    perceptual_roughness: 0.9,
                    ..default()
                })),
                Transform::default(),
            ));
        }
    }
}

/// A mesh with a normal for each triangle, as rock breaks.
fn rough((vertices, triangles): (Vec<Vec3>, Vec<[u32; 3]>)) -> Mesh {
    let indices = triangles.into_iter().flatten().collect();
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::default(),
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, vertices)
    .with_inserted_indices(Indices::U32(indices))
    .with_duplicated_vertices()
    .with_computed_flat_normals()
}
