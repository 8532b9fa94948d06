//! Crowds draw by Bevy's mesh pipeline, whose definitions depend on the view: what it asks for is seen in frames that
//! are drawn.

use bevy::app::App;
use bevy::camera::{Hdr, RenderTarget};
use bevy::core_pipeline::prepass::{
    DeferredPrepass, DepthPrepass, MotionVectorPrepass, NormalPrepass,
};
use bevy::pbr::DefaultOpaqueRendererMethod;
use bevy::prelude::*;
use bevy::render::render_resource::TextureFormat;
use bevy::render::storage::ShaderBuffer;
use dolomite::character::crowd::{CrowdFigure, Palette};
use dolomite::character::render::{Crowd, CrowdLook, CrowdMaterial};

use super::variants::{Variant, drawn};
use crate::person;

/// Draws a crowd into views of each sort, with shadows, and gives what was asked for.
pub fn draw(app: &mut App) -> Vec<Variant> {
    let mut variants: Vec<Variant> = Vec::new();
    spawn(app);
    for (deferred, method) in [
        (false, DefaultOpaqueRendererMethod::forward()),
        (true, DefaultOpaqueRendererMethod::deferred()),
    ] {
        app.insert_resource(method);
        let cameras: Vec<Entity> = (0..4)
            .map(|order| {
                let target = Image::new_target_texture(16, 16, TextureFormat::Rgba8UnormSrgb, None);
                let target = app.world_mut().resource_mut::<Assets<Image>>().add(target);
                let view = (
                    Camera3d::default(),
                    Camera { order, ..default() },
                    Msaa::Off,
                    RenderTarget::Image(target.into()),
                );
                let mut camera = app.world_mut().spawn(view);
                if order % 2 == 1 {
                    camera.insert((Hdr, NormalPrepass, DepthPrepass));
                }
                if order / 2 == 1 {
                    camera.insert((MotionVectorPrepass, DepthPrepass));
                }
                if deferred {
                    camera.insert((DeferredPrepass, DepthPrepass));
                }
                camera.id()
            })
            .collect();
        for _ in 0..10 {
            app.update();
        }
        for variant in drawn(app, "crowd") {
            if variants.iter().all(|known| known.defs != variant.defs) {
                variants.push(variant);
            }
        }
        for camera in cameras {
            app.world_mut().despawn(camera);
        }
    }
    // Shadow maps, prepasses with and without normals and motion, and the pictures themselves.
    assert!(variants.len() >= 6, "{} variants", variants.len());
    variants
}

fn spawn(app: &mut App) {
    let rig = person::rig_with_mesh();
    let palette = Palette::bake(&rig, 0, &[0], 30.0).expect("a palette");
    let world = app.world_mut();
    let mut meshes = std::mem::take(&mut *world.resource_mut::<Assets<Mesh>>());
    let mut materials = std::mem::take(&mut *world.resource_mut::<Assets<CrowdMaterial>>());
    let mut buffers = std::mem::take(&mut *world.resource_mut::<Assets<ShaderBuffer>>());
    let parts = [(&rig.meshes[0], StandardMaterial::default())];
    let look = CrowdLook::new(
        &palette,
        &parts,
        2,
        &mut meshes,
        &mut materials,
        &mut buffers,
    );
    *world.resource_mut() = meshes;
    *world.resource_mut() = materials;
    *world.resource_mut() = buffers;
    let figure = CrowdFigure::new(Vec3::ZERO, 0.0, palette.frame(0, 0.0, true), 0);
    let crowd = Crowd {
        anchor: Vec3::new(0.0, -1.0, -4.0),
        figures: vec![figure],
    };
    world.spawn((crowd, look));
    let sun = DirectionalLight {
        shadow_maps_enabled: true,
        ..default()
    };
    let lamp = PointLight {
        shadow_maps_enabled: true,
        ..default()
    };
    world.spawn((sun, Transform::default().looking_to(Vec3::NEG_ONE, Vec3::Y)));
    world.spawn((lamp, Transform::from_xyz(0.0, 2.0, -3.0)));
}
