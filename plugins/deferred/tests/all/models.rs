//! Shading models: the second one of the house, and one of a stranger's.

use bevy::asset::{RenderAssetUsages, uuid_handle};
use bevy::image::ImageSampler;
use bevy::material::OpaqueRendererMethod;
use bevy::pbr::{Material, MaterialPlugin};
use bevy::prelude::*;
use bevy::reflect::TypePath;
use bevy::render::render_resource::{AsBindGroup, Extent3d, TextureDimension, TextureFormat};
use bevy::shader::{Shader, ShaderRef};
use dolomite_deferred::render::Lobe;
use dolomite_deferred::{
    BlinnPhongMaterial, BlinnPhongPlugin, DeferredLighting, DeferredPlugin, ShadingModels, gbuffer,
};

use dolomite_testkit::light::{self as support, GBufferPlugin, Pixel, WAYS};

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

/// An image of bytes, rows from the top, whose texels are not mixed.
fn texels(app: &mut App, width: u32, bytes: &[u8], format: TextureFormat) -> Handle<Image> {
    let size = Extent3d {
        width,
        height: bytes.len() as u32 / 4 / width,
        depth_or_array_layers: 1,
    };
    let usage = RenderAssetUsages::RENDER_WORLD;
    let mut image = Image::new(size, TextureDimension::D2, bytes.to_vec(), format, usage);
    image.sampler = ImageSampler::nearest();
    app.world_mut().resource_mut::<Assets<Image>>().add(image)
}

/// What the G-buffer holds of a mesh with a material, seen from +z.
fn written(
    mesh: Mesh,
    material: impl FnOnce(&mut App) -> BlinnPhongMaterial,
) -> Option<Vec<Pixel>> {
    let mut app = support::app_with(|app| {
        app.add_plugins((DeferredPlugin, BlinnPhongPlugin, GBufferPlugin));
    })?;
    let material = material(&mut app);
    let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
    let material = app
        .world_mut()
        .resource_mut::<Assets<BlinnPhongMaterial>>()
        .add(material);
    app.world_mut()
        .spawn((Mesh3d(mesh), MeshMaterial3d(material)));
    let eye = Transform::from_xyz(0.0, 0.0, 3.0);
    support::camera(&mut app, [64, 64], eye, DeferredLighting::default());
    support::frames(&mut app, 8);
    Some(support::pixels(&app))
}

#[test]
fn maps_are_read_where_there_are_some() {
    let plane = Rectangle::new(2.0, 2.0).mesh().build();
    let plane = plane.with_generated_tangents().expect("coordinates");
    let pixels = written(plane, |app| BlinnPhongMaterial {
        diffuse: LinearRgba::WHITE,
        specular: LinearRgba::gray(0.8),
        lobe: Lobe::Phong,
        diffuse_map: Some(texels(
            app,
            2,
            &[255, 0, 0, 255, 0, 0, 255, 255],
            TextureFormat::Rgba8UnormSrgb,
        )),
        specular_map: Some(texels(
            app,
            1,
            &[128, 128, 128, 255],
            TextureFormat::Rgba8Unorm,
        )),
        // To the right: 0.6, 0, 0.8.
        normal_map: Some(texels(
            app,
            1,
            &[204, 128, 230, 255],
            TextureFormat::Rgba8Unorm,
        )),
        ..default()
    });
    let Some(pixels) = pixels else { return };
    let [left, right] = [20, 44].map(|x| pixels[32 * 64 + x]);
    assert_eq!((left.id, right.id), (2, 2));
    assert_eq!(gbuffer::unpack_bytes(left.words[0])[..3], [1.0, 0.0, 0.0]);
    assert_eq!(gbuffer::unpack_bytes(right.words[0])[..3], [0.0, 0.0, 1.0]);
    let specular = gbuffer::decode_color(gbuffer::unpack_bytes(left.words[2])[0]);
    // Bytes of a gamma curve.
    assert!((specular - 0.8 * 128.0 / 255.0).abs() < 0.005, "{specular}");
    let normal = gbuffer::unpack_normal(left.words[3]);
    assert!(
        normal.distance(Vec3::new(0.6, 0.004, 0.804).normalize()) < 0.002,
        "{normal}"
    );
    assert_ne!(gbuffer::unpack_flags(left.words[3]) & gbuffer::PHONG, 0);
}

#[test]
fn facets_have_one_normal_each_and_it_faces_the_eye() {
    let count = |faceted: bool| {
        let pixels = written(Sphere::new(1.0).mesh().uv(8, 6), |_| BlinnPhongMaterial {
            faceted,
            ..default()
        })?;
        let lit = pixels.iter().filter(|pixel| pixel.id == 2);
        let mut normals: Vec<u32> = lit.map(|pixel| pixel.words[3] & 0xff_ffff).collect();
        assert!(normals.len() > 500);
        let facing = |word: &u32| gbuffer::unpack_normal(*word).z > -0.2;
        assert!(normals.iter().all(facing));
        // A step of the code is the rounding of a derivative.
        normals.sort_unstable();
        normals.dedup_by_key(|word| {
            gbuffer::unpack_normal(*word)
                .to_array()
                .map(|c| (c * 200.0).round() as i32)
        });
        Some(normals.len())
    };
    let (Some(smooth), Some(faceted)) = (count(false), count(true)) else {
        return;
    };
    eprintln!("{faceted} normals of facets, {smooth} of a smooth sphere");
    assert!(faceted * 3 < smooth, "{faceted} of {smooth}");
}
