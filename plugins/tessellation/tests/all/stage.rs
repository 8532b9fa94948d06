//! The stage in an app with nothing else of Dolomite: the README's example, parts of a target, what is
//! hidden, and the order of plugins.

use crate::app;
use crate::torus;

use std::sync::Arc;

use bevy::camera::visibility::RenderLayers;
use bevy::camera::{ClearColorConfig, RenderTarget, Viewport};
use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_resource::AsBindGroup;
use dolomite_geometry::render::{GeometryCensus, GeometryMaterial, census};
use dolomite_geometry::{GeometryCamera, GeometryPlugin, GeometryStats};
use dolomite_tessellation::render::{PatchKind, PatchPlugin, PatchShader};
use dolomite_tessellation::{PatchLayout, PatchMesh, Patches};

/// White quads, cut into two triangles: the stage's own example functions.
#[derive(Resource, AsBindGroup, Clone)]
struct White {}

impl PatchKind for White {
    const LAYOUT: PatchLayout = PatchLayout::QUAD;

    fn shader() -> PatchShader {
        PatchShader::Library("dolomite::stage::user")
    }

    fn materials(&self) -> Vec<GeometryMaterial> {
        vec![GeometryMaterial {
            base_color: LinearRgba::WHITE,
            unlit: true,
            fog: false,
            ..default()
        }]
    }
}

fn white_app() -> Option<App> {
    app::app(|app| {
        app::bevys(app);
        app.add_plugins(PatchPlugin(White {}));
    })
}

/// A quad from −1 to 1, facing +z. Control functions take their levels from it.
fn quad(app: &mut App, components: impl Bundle) -> Entity {
    let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    let points = corners.map(|[x, y]| [x, y, 0.0, 1.0]);
    let mesh = PatchMesh::from_patches(PatchLayout::QUAD, &points).expect("one patch");
    let patches = Patches::<White>::new(Arc::new(mesh)).with(0, Vec4::ONE);
    app.world_mut().spawn((patches, components)).id()
}

fn camera(app: &mut App, target: &Handle<Image>, components: impl Bundle) -> Entity {
    let bundle = (
        Camera3d::default(),
        Msaa::Off,
        Tonemapping::None,
        RenderTarget::Image(target.clone().into()),
        GeometryCamera::default(),
        components,
    );
    app.world_mut().spawn(bundle).id()
}

/// A part of the target, from column `x` on.
fn part(x: u32, order: isize) -> Camera {
    Camera {
        viewport: Some(Viewport {
            physical_position: UVec2::new(x, 0),
            physical_size: UVec2::new(32, 32),
            ..default()
        }),
        order,
        // The first clears for both.
        clear_color: match order {
            0 => ClearColorConfig::Default,
            _ => ClearColorConfig::None,
        },
        ..default()
    }
}

fn white(image: &Image, from: u32, to: u32) -> usize {
    app::count(image, from, to, |c| c.green > 0.5)
}

fn held(app: &App) -> GeometryCensus {
    census(app.sub_app(RenderApp).world())
}

/// Ahead of a camera at the origin, and behind it.
const AHEAD: Transform = Transform::from_xyz(0.0, 0.0, -4.0);

#[test]
fn the_torus_of_the_readme_is_drawn_gpu() {
    let Some(mut app) = app::app(|app| {
        app::bevys(app);
        app.add_plugins(PatchPlugin(torus::Torus {}))
            .add_systems(Startup, torus::setup);
    }) else {
        return;
    };
    app.update();
    let target = app::target(&mut app, [640, 360]);
    app::retarget(&mut app, &target);
    app::frames(&mut app, 100);
    let picture = app::picture(&mut app, &target);
    let lit = app::count(&picture, 0, 640, |c| c.green > 0.02);
    assert!(lit > 30_000, "{lit}");
    app::keep(picture, "torus.png");
    let stats = app.world().resource::<GeometryStats>();
    assert!(stats.patches == 72 && stats.primitives > 2000, "{stats:?}");
}

/// Two cameras share a target. Each draws into its own part: the quad that the first sees is not in the half
/// of the second, and has the size that it has there.
#[test]
fn a_split_screen_keeps_to_its_parts_gpu() {
    for direct in [false, true] {
        let Some(mut app) = white_app() else { return };
        let target = app::target(&mut app, [64, 32]);
        quad(&mut app, AHEAD);
        let seeing = camera(&mut app, &target, part(0, 0));
        let away = Transform::default().looking_to(Vec3::Z, Vec3::Y);
        let blind = camera(&mut app, &target, (part(32, 1), away));
        if direct {
            for camera in [seeing, blind] {
                let mut camera = app.world_mut().entity_mut(camera);
                camera.remove::<(DepthPrepass, DeferredPrepass)>();
            }
        }
        app::frames(&mut app, 20);
        let picture = app::picture(&mut app, &target);
        let (left, right) = (white(&picture, 0, 32), white(&picture, 32, 64));
        // 2 m of the 3.31 m that a picture of 45° is high at 4 m: 19 pixels a side.
        assert!((300..430).contains(&left), "direct {direct}: {left}");
        assert_eq!(right, 0, "direct {direct}");
        // The second looks there too: both see the same, each in its half.
        app.world_mut()
            .entity_mut(blind)
            .insert(Transform::default());
        app::frames(&mut app, 8);
        let picture = app::picture(&mut app, &target);
        assert_eq!(white(&picture, 0, 32), left, "direct {direct}");
        assert_eq!(white(&picture, 32, 64), left, "direct {direct}");
    }
}

/// What is hidden is not drawn and keeps no buffer; layers are those of cameras.
#[test]
fn what_is_hidden_costs_nothing_gpu() {
    let Some(mut app) = white_app() else { return };
    let target = app::target(&mut app, [32, 32]);
    let hidden = quad(&mut app, (AHEAD, Visibility::Hidden));
    let eye = camera(&mut app, &target, RenderLayers::from_layers(&[0, 3]));
    app::frames(&mut app, 10);
    assert_eq!(held(&app), GeometryCensus::default());
    let drawn = |app: &mut App| {
        app::frames(app, 10);
        let picture = app::picture(app, &target);
        white(&picture, 0, 32)
    };
    app.world_mut()
        .entity_mut(hidden)
        .insert(Visibility::Visible);
    let size = drawn(&mut app);
    assert!(size > 300 && held(&app).views == 1, "{size}");
    // By its parent.
    let parent = app
        .world_mut()
        .spawn((Transform::default(), Visibility::Hidden))
        .id();
    let inherited = (ChildOf(parent), Visibility::Inherited);
    app.world_mut().entity_mut(hidden).insert(inherited);
    assert_eq!(drawn(&mut app), 0);
    assert_eq!(held(&app).bytes, 0);
    app.world_mut()
        .entity_mut(parent)
        .insert(Visibility::Visible);
    assert_eq!(drawn(&mut app), size);
    for (layers, seen) in [
        (RenderLayers::layer(1), false),
        (RenderLayers::from_layers(&[1, 3]), true),
        (RenderLayers::none(), false),
        (RenderLayers::layer(31), false),
        (RenderLayers::layer(0), true),
    ] {
        app.world_mut().entity_mut(hidden).insert(layers.clone());
        let expected = if seen { size } else { 0 };
        assert_eq!(drawn(&mut app), expected, "{layers:?}");
    }
    app.world_mut()
        .entity_mut(eye)
        .insert(RenderLayers::layer(31));
    assert_eq!(drawn(&mut app), 0, "the camera's layers changed");
    app.world_mut().entity_mut(hidden).remove::<RenderLayers>();
    app.world_mut().entity_mut(eye).remove::<RenderLayers>();
    assert_eq!(drawn(&mut app), size);
}

/// A camera that can see no patch of a kind has no pools for it: by its layers, or by the camera that patches name.
#[test]
fn a_camera_that_sees_none_of_a_kind_has_no_pool_gpu() {
    let Some(mut app) = white_app() else { return };
    let target = app::target(&mut app, [32, 32]);
    let patches = quad(&mut app, AHEAD);
    let blind = camera(&mut app, &target, RenderLayers::none());
    app::frames(&mut app, 6);
    assert_eq!(held(&app), GeometryCensus::default());
    // Another that sees: one view alone.
    let seeing = camera(&mut app, &target, ());
    app::frames(&mut app, 6);
    assert_eq!(held(&app).views, 1);
    app.world_mut().entity_mut(blind).remove::<RenderLayers>();
    app::frames(&mut app, 6);
    assert_eq!(held(&app).views, 2);
    let only = |app: &mut App, camera: Option<Entity>| {
        let mut entity = app.world_mut().entity_mut(patches);
        entity.get_mut::<Patches<White>>().expect("spawned").camera = camera;
        app::frames(app, 6);
        held(app).views
    };
    assert_eq!(only(&mut app, Some(seeing)), 1);
    assert_eq!(only(&mut app, Some(nobody())), 0);
    assert_eq!(held(&app).bytes, 0, "of nobody's patches nothing is kept");
    assert_eq!(only(&mut app, None), 2);
}

/// An entity that is no camera.
fn nobody() -> Entity {
    Entity::from_raw_u32(1 << 20).expect("a number that can be one")
}

/// Plugins may come before Bevy's, and more than once; without a renderer they do nothing.
#[test]
fn the_order_of_plugins_does_not_matter_gpu() {
    let Some(mut app) = app::app(|app| {
        app.add_plugins(PatchPlugin(White {}));
        app::bevys(app);
        app.add_plugins((PatchPlugin(White {}), GeometryPlugin, GeometryPlugin));
    }) else {
        return;
    };
    let target = app::target(&mut app, [32, 32]);
    quad(&mut app, AHEAD);
    camera(&mut app, &target, ());
    app::frames(&mut app, 20);
    let picture = app::picture(&mut app, &target);
    assert!(white(&picture, 0, 32) > 300);
    let stats = app.world().resource::<GeometryStats>();
    // One producer in one view, and what its views share.
    assert_eq!((stats.patches, stats.pools.len()), (1, 2), "{stats:?}");
}

#[test]
fn an_app_without_a_renderer_keeps_the_resource_alone() {
    let mut app = App::new();
    // Nothing that Bevy registers by itself, where it was built so.
    app.insert_resource(AppTypeRegistry::default());
    app.add_plugins((MinimalPlugins, PatchPlugin(White {}), GeometryPlugin));
    app.finish();
    app.cleanup();
    app.update();
    assert!(app.world().contains_resource::<White>());
    let registry = app.world().resource::<AppTypeRegistry>().clone();
    let settings = registry.read();
    let known = settings.get(std::any::TypeId::of::<GeometryCamera>());
    assert!(known.is_some_and(|known| known.contains::<ReflectComponent>()));
    assert_eq!(
        *app.world().resource::<GeometryStats>(),
        GeometryStats::default()
    );
}
