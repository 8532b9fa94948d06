//! Crowds as components.

use super::material::{CrowdExtension, CrowdMaterial, CrowdUniform, JOINTS, WEIGHTS};
use crate::crowd::{CrowdFigure, Palette};
use crate::load::SkinnedMesh;
use bevy::asset::{AssetId, Assets, Handle, RenderAssetUsages};
use bevy::camera::visibility::{NoFrustumCulling, Visibility};
use bevy::ecs::prelude::*;
use bevy::math::Vec3;
use bevy::mesh::{Indices, Mesh, Mesh3d, MeshTag, PrimitiveTopology};
use bevy::pbr::{MeshMaterial3d, StandardMaterial};
use bevy::reflect::{Reflect, std_traits::ReflectDefault};
use bevy::render::storage::ShaderBuffer;
use bevy::transform::components::Transform;

/// Figures that are drawn from a palette. Write `figures` every frame, or only when they change: a crowd
/// that rests uploads nothing.
#[derive(Component, Reflect, Clone, Debug, Default)]
#[reflect(Component, Default)]
#[require(Transform, Visibility)]
pub struct Crowd {
    /// World coordinates that figures are placed from, metres. Near the camera, so that f32 is enough.
    pub anchor: Vec3,
    /// The figures that are to be seen; leave out whom no camera and no light sees.
    pub figures: Vec<CrowdFigure>,
}

/// How a crowd looks: made once by [`CrowdLook::new`].
#[derive(Component, Clone, Debug)]
pub struct CrowdLook {
    parts: Vec<CrowdPart>,
    figures: Handle<ShaderBuffer>,
    /// Figures that the buffer holds.
    room: usize,
    /// Entities of each figure, one for each part.
    instances: Vec<Vec<Entity>>,
    shown: usize,
}

/// A mesh of a crowd, with its material.
#[derive(Clone, Debug, PartialEq)]
pub struct CrowdPart {
    /// The mesh.
    pub mesh: Handle<Mesh>,
    /// Its material.
    pub material: Handle<CrowdMaterial>,
}

/// Bytes of a figure.
const FIGURE: usize = size_of::<CrowdFigure>();

impl CrowdLook {
    /// Uploads a palette, and meshes with their materials. There is room for `room` figures; more make it
    /// grow.
    #[must_use]
    pub fn new(
        palette: &Palette,
        meshes: &[(&SkinnedMesh, StandardMaterial)],
        room: usize,
        mesh_assets: &mut Assets<Mesh>,
        materials: &mut Assets<CrowdMaterial>,
        buffers: &mut Assets<ShaderBuffer>,
    ) -> Self {
        let room = room.max(1).next_power_of_two();
        let rows = bytemuck::cast_slice(&palette.rows);
        let palette_buffer = buffers.add(ShaderBuffer::new(rows, RenderAssetUsages::RENDER_WORLD));
        let figures = buffers.add(ShaderBuffer::new(
            &vec![0; room * FIGURE],
            RenderAssetUsages::all(),
        ));
        let parts = meshes
            .iter()
            .map(|(mesh, base)| CrowdPart {
                mesh: mesh_assets.add(to_mesh(mesh)),
                material: materials.add(CrowdMaterial {
                    base: base.clone(),
                    extension: CrowdExtension {
                        palette: palette_buffer.clone(),
                        figures: figures.clone(),
                        crowd: CrowdUniform {
                            anchor: Vec3::ZERO,
                            joints: palette.joints,
                        },
                    },
                }),
            })
            .collect();
        Self {
            parts,
            figures,
            room,
            instances: Vec::new(),
            shown: 0,
        }
    }

    pub(super) fn buffer(&self) -> AssetId<ShaderBuffer> {
        self.figures.id()
    }

    /// Its meshes and materials.
    #[must_use]
    pub fn parts(&self) -> &[CrowdPart] {
        &self.parts
    }
}

fn to_mesh(mesh: &SkinnedMesh) -> Mesh {
    let vertices = mesh.positions.len();
    let or = |given: &Vec<[f32; 3]>, other: [f32; 3]| match given.len() == vertices {
        true => given.clone(),
        false => vec![other; vertices],
    };
    let uvs = match mesh.uvs.len() == vertices {
        true => mesh.uvs.clone(),
        false => vec![[0.0; 2]; vertices],
    };
    Mesh::new(
        PrimitiveTopology::TriangleList,
        RenderAssetUsages::RENDER_WORLD,
    )
    .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, mesh.positions.clone())
    .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, or(&mesh.normals, [0.0, 1.0, 0.0]))
    .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, uvs)
    .with_inserted_attribute(
        JOINTS,
        bevy::mesh::VertexAttributeValues::Uint16x4(mesh.joints.clone()),
    )
    .with_inserted_attribute(WEIGHTS, mesh.weights.clone())
    .with_inserted_indices(Indices::U32(mesh.indices.clone()))
}

/// Makes buffers grow, and brings a new anchor to the material.
pub(super) fn grow(
    mut crowds: Query<(&Crowd, &mut CrowdLook), Or<(Changed<Crowd>, Added<CrowdLook>)>>,
    mut buffers: ResMut<Assets<ShaderBuffer>>,
    mut materials: ResMut<Assets<CrowdMaterial>>,
) {
    for (crowd, mut look) in &mut crowds {
        let count = crowd.figures.len();
        let grown = count > look.room;
        if grown {
            look.room = count.next_power_of_two();
        }
        if grown && let Some(mut buffer) = buffers.get_mut(&look.figures) {
            buffer.data = Some(vec![0; look.room * FIGURE]);
        }
        for part in &look.parts {
            let moved = materials
                .get(&part.material)
                .is_some_and(|material| material.extension.crowd.anchor != crowd.anchor);
            // A buffer that grew is another one, and the material has to bind it.
            if (moved || grown)
                && let Some(mut material) = materials.get_mut(&part.material)
            {
                material.extension.crowd.anchor = crowd.anchor;
            }
        }
    }
}

/// Has as many instances seen as there are figures; they are made as they are needed, and kept.
pub(super) fn show(
    mut commands: Commands,
    mut crowds: Query<(Entity, &Crowd, &mut CrowdLook), Or<(Changed<Crowd>, Added<CrowdLook>)>>,
    mut seen: Query<&mut Visibility, With<MeshTag>>,
) {
    for (entity, crowd, mut look) in &mut crowds {
        let (before, now) = (look.shown, crowd.figures.len());
        if before == now {
            continue;
        }
        look.shown = now;
        for index in look.instances.len()..now {
            let instances = look
                .parts
                .iter()
                .map(|part| {
                    let instance = (
                        Mesh3d(part.mesh.clone()),
                        MeshMaterial3d(part.material.clone()),
                        MeshTag(index as u32),
                        // Where it stands is not in its transform.
                        NoFrustumCulling,
                        ChildOf(entity),
                    );
                    commands.spawn(instance).id()
                })
                .collect();
            look.instances.push(instances);
        }
        let changed = before.min(now)..before.max(now);
        for instance in look.instances[changed].iter().flatten() {
            // What was spawned in this frame is seen as it is.
            if let Ok(mut visibility) = seen.get_mut(*instance) {
                *visibility = if now > before {
                    Visibility::Inherited
                } else {
                    Visibility::Hidden
                };
            }
        }
    }
}
