//! Shading models: the second one of the house, and one of a stranger's.

use bevy::asset::uuid_handle;
use bevy::material::OpaqueRendererMethod;
use bevy::pbr::{Material, MaterialPlugin};
use bevy::prelude::*;
use bevy::reflect::TypePath;
use bevy::render::render_resource::AsBindGroup;
use bevy::shader::{Shader, ShaderRef};
use dolomite_deferred::{BlinnPhongMaterial, BlinnPhongPlugin, DeferredPlugin, ShadingModels};

use dolomite_testkit::light::{self as support, WAYS};

const TOON: &str = "#define_import_path test::toon
#import dolomite::deferred::types::{Incident, Surface}
fn toon(surface: Surface, light: Incident) -> vec3<f32> {
    return select(vec3(0.0), vec3(0.25, 0.5, 1.0), dot(surface.normal, light.to_light) > 0.0) * sign(light.color.r);
}";

const WRITE: Handle<Shader> = uuid_handle!("0d2f3f7e-1111-4d6b-8a44-0b8f0a6f5e22");
const WRITE_TEXT: &str = "
#import bevy_pbr::prepass_io::{FragmentOutput, VertexOutput}
#import dolomite::deferred::gbuffer::pack_normal
@fragment
fn fragment(in: VertexOutput) -> FragmentOutput {
    var out: FragmentOutput;
#ifdef DEFERRED_PREPASS
    out.deferred = vec4(0u, 0u, 0u, pack_normal(normalize(in.world_normal), 0u));
    out.deferred_lighting_pass_id = 9u;
#endif
    return out;
}";

#[derive(Asset, AsBindGroup, TypePath, Clone)]
struct Toon {}

impl Material for Toon {
    fn deferred_fragment_shader() -> ShaderRef {
        WRITE.into()
    }
    fn opaque_render_method(&self) -> OpaqueRendererMethod {
        OpaqueRendererMethod::Deferred
    }
}

#[test]
fn blinn_phong_and_a_model_of_ones_own_are_lit_by_every_way() {
    let app = support::app_with(|app| {
        app.add_plugins((
            DeferredPlugin,
            BlinnPhongPlugin,
            MaterialPlugin::<Toon>::default(),
        ));
        let mut models = app.world_mut().resource_mut::<ShadingModels>();
        models.add(9, TOON, "toon").expect("a model");
        let mut shaders = app.world_mut().resource_mut::<Assets<Shader>>();
        let shader = Shader::from_wgsl(WRITE_TEXT, "write_toon.wgsl");
        shaders.insert(&WRITE, shader).expect("a place");
    });
    let Some(mut app) = app else { return };
    let mesh = app
        .world_mut()
        .resource_mut::<Assets<Mesh>>()
        .add(Sphere::new(1.0).mesh().uv(64, 32));
    let shiny = BlinnPhongMaterial {
        diffuse: LinearRgba::rgb(0.5, 0.1, 0.1),
        specular: LinearRgba::rgb(0.3, 0.3, 0.3),
        exponent: 64.0,
        ..default()
    };
    let shiny = app
        .world_mut()
        .resource_mut::<Assets<BlinnPhongMaterial>>()
        .add(shiny);
    let toon = app.world_mut().resource_mut::<Assets<Toon>>().add(Toon {});
    app.world_mut().spawn((
        Mesh3d(mesh.clone()),
        MeshMaterial3d(shiny),
        Transform::from_xyz(-1.2, 0.0, 0.0),
    ));
    app.world_mut().spawn((
        Mesh3d(mesh),
        MeshMaterial3d(toon),
        Transform::from_xyz(1.2, 0.0, 0.0),
    ));
    let lamp = PointLight {
        intensity: 2000.0,
        range: 30.0,
        ..default()
    };
    app.world_mut()
        .spawn((lamp, Transform::from_xyz(0.0, 3.0, 4.0)));
    let eye = Transform::from_xyz(0.0, 0.0, 6.0);
    let camera = support::camera(&mut app, [160, 90], eye, ());
    let pictures = WAYS.map(|way| support::lit_by(&mut app, camera, Some(way)));
    support::keep(&pictures[0], 8.0, "models");
    for picture in &pictures {
        assert_eq!(picture.nonsense(), 0);
        assert!(picture.relative_difference(&pictures[0], 1e-3) <= 1e-5);
        let at = |x: usize, y: usize| picture.pixels[y * 160 + x];
        // Where the lamp shines on the toon sphere, all is one colour.
        assert_eq!(at(110, 40), [0.25, 0.5, 1.0, 1.0]);
        let lit = picture
            .pixels
            .iter()
            .filter(|p| **p == [0.25, 0.5, 1.0, 1.0])
            .count();
        assert!(lit > 500, "{lit}");
        // By hand: the point of the shiny sphere that is seen in the middle of its disc.
        let red = at(50, 45);
        assert!(red[0] > 2.0 * red[1] && red[1] > 0.0, "{red:?}");
    }
}
