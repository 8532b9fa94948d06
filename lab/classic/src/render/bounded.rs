//! The classic surface with its error bounded in pixels: the same samples as a terrain, drawn by the
//! level of detail with the same colours.

use bevy::asset::RenderAssetUsages;
use bevy::prelude::*;
use bevy::render::render_resource::AsBindGroup;
use bevy::render::storage::ShaderBuffer;
use dolomite_terrain::Terrain;

use super::ClassicSettings;
use crate::ClassicHeights;
use dolomite_geometry::GeometryPlugin;
use dolomite_ground::detail::TerrainLod;
use dolomite_ground::render::detail::DetailKind;
use dolomite_ground::render::{HeightUniform, add_kind};

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
    shown: bool,
    on_host: bool,
}

impl DetailKind for BoundedClassicKind {
    type Cameras = With<TerrainLod>;
    const MATERIAL: &'static str = "dolomite::classic::bounded";
    const VERTEX_SHADED: bool = true;
    const SHADOWS: bool = false;

    fn ground(&self) -> Option<&Terrain> {
        self.terrain.as_ref()
    }

    fn relief(&self) -> f32 {
        self.relief
    }

    fn is_shown(&self) -> bool {
        self.shown
    }

    fn on_host(&self) -> bool {
        self.on_host
    }
}

/// The surface as a terrain, uploaded when it is first shown.
#[derive(Resource)]
struct Surface(ClassicHeights);

/// Adds the kind, which shows nothing until the settings ask for it.
pub(super) fn build(app: &mut App, heights: &ClassicHeights) {
    app.add_plugins(GeometryPlugin)
        .init_resource::<BoundedClassicKind>()
        .insert_resource(Surface(heights.clone()))
        .add_systems(
            PostUpdate,
            follow.run_if(resource_exists_and_changed::<ClassicSettings>),
        );
}

/// The render half, when all plugins have been built.
pub(super) fn finish(app: &mut App) {
    add_kind::<BoundedClassicKind>(app);
}

/// Shows or hides the surface.
fn follow(
    settings: Res<ClassicSettings>,
    surface: Res<Surface>,
    mut kind: ResMut<BoundedClassicKind>,
    buffers: Option<ResMut<Assets<ShaderBuffer>>>,
) {
    let shown = settings.is_bounded();
    if kind.shown != shown {
        kind.shown = shown;
    }
    if !shown {
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
}
