//! The classic surface with its error bounded in pixels: the same samples as a terrain, drawn by the
//! level of detail with the same colours.

use std::sync::Arc;

use bevy::asset::RenderAssetUsages;
use bevy::prelude::*;
use bevy::render::render_resource::AsBindGroup;
use bevy::render::storage::ShaderBuffer;
use dolomite_terrain::Terrain;

use super::ClassicSettings;
use crate::{CLASSIC_LAYOUT, ClassicHeights};
use dolomite_ground::render::HeightUniform;
use dolomite_ground::render::detail::{self, DetailKind};
use dolomite_tessellation::render::{PatchKind, PatchPlugin, PatchPool, PatchShader};
use dolomite_tessellation::{PatchLayout, PatchMesh, Patches};

/// The kind: the height function, and who chooses.
#[derive(Resource, AsBindGroup, Clone, Default)]
pub struct BoundedClassicKind {
    #[storage(0, read_only, visibility(compute))]
    layers: Handle<ShaderBuffer>,
    #[storage(1, read_only, visibility(compute))]
    data: Handle<ShaderBuffer>,
    #[uniform(2)]
    heights: HeightUniform,
    terrain: Option<Terrain>,
    relief: f32,
    on_host: bool,
}

impl PatchKind for BoundedClassicKind {
    const LAYOUT: PatchLayout = CLASSIC_LAYOUT;
    const CUSTOM_MATERIAL: bool = true;
    const VERTEX_SHADED: bool = true;
    const SHADOWS: bool = false;

    fn shader() -> PatchShader {
        PatchShader::Library("dolomite::classic::bounded")
    }

    fn given(&self) -> bool {
        true
    }

    fn pool(&self) -> PatchPool {
        let vertices = MOST_VERTICES;
        PatchPool {
            vertices,
            primitives: 2 * vertices,
        }
    }
}

impl DetailKind for BoundedClassicKind {
    fn ground(&self) -> Option<&Terrain> {
        self.terrain.as_ref()
    }

    fn relief(&self) -> f32 {
        self.relief
    }

    fn on_host(&self) -> bool {
        self.on_host
    }
}

/// Most vertices of a view: the surface is rough down to its samples, of which there are a million.
const MOST_VERTICES: u32 = 1 << 19;

/// The surface as a terrain, uploaded when it is first shown.
#[derive(Resource)]
struct Surface(ClassicHeights);

/// Adds the kind, which shows nothing until the settings ask for it.
pub(super) fn build(app: &mut App, heights: &ClassicHeights) {
    app.add_plugins(PatchPlugin(BoundedClassicKind::default()))
        .insert_resource(Surface(heights.clone()))
        .add_systems(
            PostUpdate,
            follow.run_if(resource_exists_and_changed::<ClassicSettings>),
        );
    detail::build::<BoundedClassicKind>(app);
}

/// Shows or removes the surface.
fn follow(
    settings: Res<ClassicSettings>,
    surface: Res<Surface>,
    mut kind: ResMut<BoundedClassicKind>,
    buffers: Option<ResMut<Assets<ShaderBuffer>>>,
    shown: Query<Entity, With<Patches<BoundedClassicKind>>>,
    mut commands: Commands,
) {
    if !settings.is_bounded() {
        for entity in &shown {
            commands.entity(entity).despawn();
        }
        return;
    }
    if kind.on_host != settings.host {
        kind.on_host = settings.host;
    }
    if kind.terrain.is_none()
        && let Some(mut buffers) = buffers
    {
        let terrain = surface.0.terrain();
        let gpu = terrain.gpu();
        let mut buffer =
            |bytes: &[u8]| buffers.add(ShaderBuffer::new(bytes, RenderAssetUsages::RENDER_WORLD));
        kind.layers = buffer(bytemuck::cast_slice(&gpu.layers));
        kind.data = buffer(bytemuck::cast_slice(&gpu.data));
        kind.heights = gpu.uniform.into();
        let bounds = terrain.bounds(&terrain.extent());
        kind.relief = bounds.max - bounds.min;
        kind.terrain = Some(terrain);
    }
    if shown.is_empty() {
        // The stage draws for an entity; its patch is not looked at.
        let points = vec![[0.0; 4]; CLASSIC_LAYOUT.points as usize];
        let indices = (0..CLASSIC_LAYOUT.points).collect();
        let mesh = PatchMesh::new(CLASSIC_LAYOUT, points, indices).expect("one whole patch");
        commands.spawn(Patches::<BoundedClassicKind>::new(Arc::new(mesh)));
    }
}
