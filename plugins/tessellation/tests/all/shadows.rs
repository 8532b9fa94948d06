//! Shadows of patches under more suns than one has room for at first: whole kinds, and kinds with bounds.

use crate::app;

use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;

use bevy::camera::RenderTarget;
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::light::DirectionalLightShadowMap;
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_resource::AsBindGroup;
use bevy::shader::Shader;
use dolomite_geometry::GeometryCamera;
use dolomite_geometry::render::{GeometryMaterial, Producers};
use dolomite_tessellation::render::{PatchKind, PatchPlugin, PatchShader};
use dolomite_tessellation::{PatchLayout, PatchMesh, Patches};

/// Bright without light: what is dark is the floor's.
fn white() -> Vec<GeometryMaterial> {
    vec![GeometryMaterial {
        base_color: LinearRgba::WHITE,
        unlit: true,
        fog: false,
        ..default()
    }]
}

/// Quads, all of which every shadow view draws.
#[derive(Resource, AsBindGroup, Clone)]
struct Whole {}

impl PatchKind for Whole {
    const LAYOUT: PatchLayout = PatchLayout::QUAD;

    fn shader() -> PatchShader {
        PatchShader::Library("dolomite::stage::user")
    }

    fn materials(&self) -> Vec<GeometryMaterial> {
        white()
    }
}

/// The same with bounds.
#[derive(Resource, AsBindGroup, Clone)]
struct Bounded {}

impl PatchKind for Bounded {
    const LAYOUT: PatchLayout = PatchLayout::QUAD;
    const BOUNDED: bool = true;

    fn shader() -> PatchShader {
        PatchShader::Library("tests::bounded")
    }

    fn materials(&self) -> Vec<GeometryMaterial> {
        white()
    }
}

/// The sphere about a flat quad.
const BOUNDS: &str = "
fn bounds(input: Patch, view: StageView) -> vec4<f32> {
    let a = stage_position(input, patch_point(input, 0u, 0u).xyz);
    let c = stage_position(input, patch_point(input, 2u, 0u).xyz);
    return vec4((a + c) * 0.5, distance(a, c) * 0.5);
}
";

#[derive(Resource)]
struct Library(#[expect(dead_code, reason = "held, never read")] Handle<Shader>);

/// The stage's own example functions and [`BOUNDS`], as a library.
fn add_bounded(app: &mut App) {
    let own = dolomite_shaders::find("stage/user.wgsl").source.replace(
        "#define_import_path dolomite::stage::user",
        "#define_import_path tests::bounded",
    );
    let shader = Shader::from_wgsl(own + BOUNDS, "tests/bounded.wgsl");
    let handle = app.world_mut().resource_mut::<Assets<Shader>>().add(shader);
    app.insert_resource(Library(handle));
}

/// A floor below a quad, both seen from above, and five suns with shadow maps.
fn scene<K: PatchKind>(app: &mut App, target: &Handle<Image>) -> (Entity, Vec<Entity>) {
    app.insert_resource(DirectionalLightShadowMap { size: 256 })
        .insert_resource(GlobalAmbientLight::NONE);
    let world = app.world_mut();
    let floor = Plane3d::default().mesh().size(20.0, 20.0);
    let floor = world.resource_mut::<Assets<Mesh>>().add(floor);
    let grey = StandardMaterial {
        perceptual_roughness: 1.0,
        ..default()
    };
    let grey = world.resource_mut::<Assets<StandardMaterial>>().add(grey);
    world.spawn((Mesh3d(floor), MeshMaterial3d(grey)));
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let points = corners.map(|[x, y]| [x, y, 0.0, 1.0]);
    let mesh = PatchMesh::from_patches(PatchLayout::QUAD, &points).expect("one patch");
    // Its front, +z, looks up.
    let lying = Transform::from_xyz(0.0, 1.5, 0.0).with_rotation(Quat::from_rotation_x(-FRAC_PI_2));
    let patches = Patches::<K>::new(Arc::new(mesh)).with(0, Vec4::ONE);
    let quad = world.spawn((patches, lying)).id();
    world.spawn((
        Camera3d::default(),
        Msaa::Off,
        Tonemapping::None,
        RenderTarget::Image(target.clone().into()),
        GeometryCamera::default(),
        Transform::from_xyz(0.0, 8.0, 0.0).looking_to(Vec3::NEG_Y, Vec3::NEG_Z),
    ));
    let suns = (0..5_u8).map(|k| {
        let sun = DirectionalLight {
            shadow_maps_enabled: true,
            ..default()
        };
        let towards = Vec3::new(0.5 * (f32::from(k) - 2.0), -1.0, -1.0);
        let place = Transform::default().looking_to(towards, Vec3::Y);
        world.spawn((sun, place)).id()
    });
    let suns = suns.collect();
    (quad, suns)
}

/// Pixels without light under one of the suns, the others nearly out.
fn dark(app: &mut App, target: &Handle<Image>, suns: &[Entity], shining: usize) -> usize {
    for (k, sun) in suns.iter().enumerate() {
        let mut light = app.world_mut().get_mut::<DirectionalLight>(*sun);
        light.as_mut().expect("a sun").illuminance = if k == shining { 10_000.0 } else { 0.1 };
    }
    app::frames(app, 3);
    let picture = app::picture(app, target);
    app::count(&picture, 0, 32, |c| c.green < 0.05)
}

/// Twenty shadow views: each has its slot, and the shadow of each sun falls where it should, the last one's too.
fn every_sun_has_its_shadow<K: PatchKind>(mut app: App) {
    let target = app::target(&mut app, [32, 32]);
    let (quad, suns) = scene::<K>(&mut app, &target);
    app::frames(&mut app, 12);
    let producers = app.sub_app(RenderApp).world().resource::<Producers>();
    let views: Vec<_> = producers
        .iter()
        .flat_map(|producer| producer.views.values())
        .collect();
    let [view] = views[..] else {
        panic!("{} views, not one", views.len());
    };
    let numbers: Vec<u32> = view.shadows.iter().map(|slot| slot.number()).collect();
    assert_eq!(numbers, (0..20).collect::<Vec<_>>());
    let ranges = view.ranges.as_ref().map(|ranges| ranges.count());
    assert_eq!(ranges, K::BOUNDED.then_some(20));
    for shining in 0..suns.len() {
        let dark = dark(&mut app, &target, &suns, shining);
        // 4.8 pixels a metre; of the 4 m² of its shadow the quad itself hides up to 1.5.
        assert!((30..=110).contains(&dark), "sun {shining}: {dark}");
    }
    app.world_mut().despawn(quad);
    for shining in [0, 4] {
        assert_eq!(dark(&mut app, &target, &suns, shining), 0);
    }
}

#[test]
fn there_is_no_last_shadow_view_gpu() {
    let app = app::app(|app| {
        app::bevys(app);
        app.add_plugins(PatchPlugin(Whole {}));
    });
    if let Some(app) = app {
        every_sun_has_its_shadow::<Whole>(app);
    }
}

#[test]
fn there_is_no_last_shadow_view_of_patches_with_bounds_gpu() {
    let app = app::app(|app| {
        app::bevys(app);
        add_bounded(app);
        app.add_plugins(PatchPlugin(Bounded {}));
    });
    if let Some(app) = app {
        every_sun_has_its_shadow::<Bounded>(app);
    }
}
