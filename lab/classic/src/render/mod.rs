//! The [classic scene](crate) as a kind of the stage; and, for the rule by error, as ground whose
//! triangles come from the [level of detail](dolomite_ground::detail).

mod bounded;

pub use bounded::BoundedClassicKind;

use std::sync::Arc;

use bevy::asset::RenderAssetUsages;
use bevy::prelude::*;
use bevy::render::render_resource::AsBindGroup;
use bevy::render::storage::ShaderBuffer;

use crate::functions::{PATCHES, patches};
use crate::{
    CLASSIC_LAYOUT, CLASSIC_SPACING, ClassicHeights, ClassicLevels, ClassicScene, STATIC_LEVEL,
};
use dolomite_tessellation::render::{PatchKind, PatchPlugin, PatchPool, PatchShader};
use dolomite_tessellation::{HostFunctions, PatchLayout, PatchMesh, Patches, Spacing};

/// The kind: the surface, and who tessellates it.
#[derive(Resource, AsBindGroup, Clone)]
pub struct ClassicKind {
    #[storage(0, read_only, visibility(compute))]
    buffer: Handle<ShaderBuffer>,
    scene: Arc<dyn HostFunctions>,
    settings: ClassicSettings,
}

/// What is shown, and how it is made; a resource that may be changed at any time.
#[derive(Resource, Clone, Copy, Debug, PartialEq)]
pub struct ClassicSettings {
    /// How levels are chosen.
    pub levels: ClassicLevels,
    /// Tessellates on the CPU and uploads.
    pub host: bool,
    /// Leaves out patches outside of the frustum, which the scene's definition does not; the picture is
    /// the same. Not for static levels, which no view changes.
    pub cull: bool,
}

impl Default for ClassicSettings {
    fn default() -> Self {
        Self {
            levels: ClassicLevels::default(),
            host: false,
            cull: true,
        }
    }
}

impl ClassicSettings {
    /// Whether patches outside of the frustum are left out.
    #[must_use]
    pub fn culls(&self) -> bool {
        self.cull && !self.is_static()
    }

    fn is_static(&self) -> bool {
        matches!(self.levels, ClassicLevels::Static(_))
    }

    /// Whether the level of detail makes the triangles.
    fn is_bounded(&self) -> bool {
        self.levels == ClassicLevels::ErrorBound
    }

    fn params(&self) -> Vec4 {
        Vec4::from(self.levels.params(self.culls()))
    }
}

impl PatchKind for ClassicKind {
    const LAYOUT: PatchLayout = CLASSIC_LAYOUT;
    const SPACING: Spacing = CLASSIC_SPACING;
    const CUSTOM_MATERIAL: bool = true;
    const VERTEX_SHADED: bool = true;
    const SHADOWS: bool = false;

    fn shader() -> PatchShader {
        PatchShader::Library("dolomite::classic::functions")
    }

    fn host(&self) -> Option<Arc<dyn HostFunctions>> {
        self.settings.host.then(|| self.scene.clone())
    }

    fn still(&self) -> bool {
        self.settings.is_static()
    }

    /// Room for level 32 everywhere: 84 MB of vertices, 101 MB of indices. The other rules ask for a
    /// sixth of it; twice that is left to them.
    fn pool(&self) -> PatchPool {
        let side = PATCHES * STATIC_LEVEL as u32;
        let all = PatchPool {
            vertices: (side + 1) * (side + 1),
            primitives: 2 * side * side,
        };
        if self.still() {
            return all;
        }
        PatchPool {
            vertices: all.vertices / 3,
            primitives: all.primitives / 3,
        }
    }
}

/// Adds the kind over `heights`, and spawns its patches.
pub struct ClassicPlugin {
    /// The surface.
    pub heights: ClassicHeights,
    /// What is shown at the start.
    pub settings: ClassicSettings,
}

impl Plugin for ClassicPlugin {
    fn build(&self, app: &mut App) {
        let mesh = Arc::new(patches(&self.heights));
        let bytes: Vec<u8> = self
            .heights
            .samples()
            .iter()
            .flat_map(|s| s.to_ne_bytes())
            .collect();
        let buffer = ShaderBuffer::new(&bytes, RenderAssetUsages::RENDER_WORLD);
        let buffer = app
            .world_mut()
            .get_resource_mut::<Assets<ShaderBuffer>>()
            .map(|mut buffers| buffers.add(buffer));
        app.add_plugins(PatchPlugin(ClassicKind {
            buffer: buffer.unwrap_or_default(),
            scene: ClassicScene::shared(&self.heights),
            settings: self.settings,
        }))
        .insert_resource(self.settings)
        .add_systems(
            PostUpdate,
            follow.run_if(resource_changed::<ClassicSettings>),
        );
        app.insert_resource(ClassicMesh(mesh.clone()));
        bounded::build(app, &self.heights);
        if !self.settings.is_bounded() {
            app.world_mut()
                .spawn(Patches::<ClassicKind>::new(mesh).with(0, self.settings.params()));
        }
    }

    fn finish(&self, app: &mut App) {
        bounded::finish(app);
    }
}

/// All patches, for when they are shown again.
#[derive(Resource)]
struct ClassicMesh(Arc<PatchMesh>);

/// Takes over changed settings.
fn follow(
    settings: Res<ClassicSettings>,
    mesh: Res<ClassicMesh>,
    mut kind: ResMut<ClassicKind>,
    mut patches: Query<(Entity, &mut Patches<ClassicKind>)>,
    mut commands: Commands,
) {
    if kind.settings == *settings {
        return;
    }
    kind.settings = *settings;
    if settings.is_bounded() {
        for (entity, _) in &patches {
            commands.entity(entity).despawn();
        }
        return;
    }
    for (_, mut patches) in &mut patches {
        patches.params[0] = settings.params();
    }
    if patches.is_empty() {
        commands.spawn(Patches::<ClassicKind>::new(mesh.0.clone()).with(0, settings.params()));
    }
}
