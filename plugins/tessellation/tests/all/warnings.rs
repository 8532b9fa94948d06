//! What is left out is said once, however long it goes on.

use crate::app;

use std::sync::Arc;

use bevy::camera::RenderTarget;
use bevy::camera::visibility::RenderLayers;
use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass};
use bevy::prelude::*;
use bevy::render::render_resource::AsBindGroup;
use dolomite_geometry::GeometryCamera;
use dolomite_tessellation::render::{PatchKind, PatchPlugin, PatchShader};
use dolomite_tessellation::{PatchLayout, PatchMesh, Patches};
use dolomite_testkit::logs;

#[derive(Resource, AsBindGroup, Clone)]
struct Plain {}

impl PatchKind for Plain {
    const LAYOUT: PatchLayout = PatchLayout::QUAD;

    fn shader() -> PatchShader {
        PatchShader::Library("dolomite::stage::user")
    }
}

#[test]
fn each_warning_comes_once_gpu() {
    logs::keep();
    let Some(mut app) = app::app(|app| {
        app::bevys(app);
        app.add_plugins(PatchPlugin(Plain {}));
    }) else {
        return;
    };
    let target = app::target(&mut app, [32, 32]);
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let points = corners.map(|[x, y]| [x, y, 0.0, 1.0]);
    let mesh = PatchMesh::from_patches(PatchLayout::QUAD, &points).expect("one patch");
    let patches = Patches::<Plain>::new(Arc::new(mesh)).with(0, Vec4::ONE);
    let world = app.world_mut();
    // Layers that the stage does not tell apart.
    let places = [40, 50].map(|layer| {
        let layers = RenderLayers::from_layers(&[0, layer]);
        let place = Transform::from_xyz(0.0, 0.0, -4.0);
        world.spawn((patches.clone(), place, layers)).id()
    });
    // Two suns with shadows.
    for x in [-1.0, 1.0] {
        let sun = DirectionalLight {
            shadow_maps_enabled: true,
            ..default()
        };
        let travels = Transform::default().looking_to(Vec3::new(x, -2.0, -1.0), Vec3::Y);
        world.spawn((sun, travels));
    }
    // Straight into a picture of several samples.
    let camera = (
        Camera3d::default(),
        Msaa::Sample4,
        RenderTarget::Image(target.clone().into()),
        GeometryCamera::default(),
    );
    world
        .spawn(camera)
        .remove::<(DepthPrepass, DeferredPrepass)>();
    for step in 0..6_u8 {
        for place in places {
            let mut place = app.world_mut().get_mut::<Transform>(place);
            place.as_mut().expect("a quad").translation.x = f32::from(step) * 0.01;
        }
        app::frames(&mut app, 3);
    }
    for text in [
        "render layers 0 to 31",
        "decides what beside a camera's picture",
        "give it Msaa::Off",
    ] {
        let said = logs::with(text);
        assert_eq!(said.len(), 1, "{text}: {said:?}");
    }
}
