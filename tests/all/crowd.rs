//! A crowd in Bevy's renderer: the picture is that of the same figures skinned on the CPU, and 16 bytes a
//! figure go up.

use crate::person;

use crate::support::app;
use crate::support::camera;
use crate::support::picture;

use std::time::Duration;

use bevy::app::App;
use bevy::asset::RenderAssetUsages;
use bevy::core_pipeline::prepass::{DeferredPrepass, DepthPrepass, MotionVectorPrepass};
use bevy::core_pipeline::tonemapping::Tonemapping;
use bevy::mesh::{Indices, PrimitiveTopology};
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::storage::ShaderBuffer;
use dolomite::character::SkinnedMesh;
use dolomite::character::crowd::{CrowdFigure, Palette, skin};
use dolomite::character::render::{Crowd, CrowdLook, CrowdMaterial, CrowdPlugin, CrowdUploads};

const SIZE: u32 = 160;

fn app() -> Option<App> {
    app::app(Duration::from_millis(16), |app| {
        app.add_plugins(CrowdPlugin);
    })
}

/// Some frames, and then what the camera saw: red, green, blue of every pixel.
fn picture(app: &mut App, target: &Handle<Image>) -> Vec<[u8; 3]> {
    let image = picture::picture(app, target, 20);
    let colour = |index: u32| {
        let pixel = image
            .get_color_at(index % SIZE, index / SIZE)
            .expect("a pixel")
            .to_srgba();
        [pixel.red, pixel.green, pixel.blue].map(|part| (part * 255.0).round() as u8)
    };
    (0..SIZE * SIZE).map(colour).collect()
}

fn figures(palette: &Palette, time: f32) -> Vec<CrowdFigure> {
    (0..5)
        .map(|index| {
            let place = Vec3::new(index as f32 - 2.0, 0.1 * index as f32, 0.2 * index as f32);
            let frame = palette.frame(1 + index % 2, time + 0.13 * index as f32, true);
            CrowdFigure::new(place, 0.7 * index as f32, frame, 0)
        })
        .collect()
}

/// The figure as the CPU reference skins it, in the world.
fn skinned(palette: &Palette, mesh: &SkinnedMesh, figure: &CrowdFigure, anchor: Vec3) -> Mesh {
    let mut positions = Vec::new();
    let mut normals = Vec::new();
    for vertex in 0..mesh.positions.len() {
        let rows = skin::vertex_rows(palette, figure, mesh.joints[vertex], mesh.weights[vertex]);
        let position = skin::skinned_position(&rows, Vec3::from(mesh.positions[vertex]));
        positions.push((figure.placed(position) + anchor).to_array());
        let normal = skin::skinned_normal(&rows, Vec3::from(mesh.normals[vertex]));
        normals.push(figure.turned(normal).to_array());
    }
    Mesh::new(PrimitiveTopology::TriangleList, RenderAssetUsages::all())
        .with_inserted_attribute(Mesh::ATTRIBUTE_POSITION, positions)
        .with_inserted_attribute(Mesh::ATTRIBUTE_NORMAL, normals)
        .with_inserted_attribute(Mesh::ATTRIBUTE_UV_0, mesh.uvs.clone())
        .with_inserted_indices(Indices::U32(mesh.indices.clone()))
}

/// Part of the pixels that are more than two levels apart.
fn apart(a: &[[u8; 3]], b: &[[u8; 3]]) -> f64 {
    let far = |(a, b): &(&[u8; 3], &[u8; 3])| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 2);
    a.iter().zip(b).filter(far).count() as f64 / a.len() as f64
}

fn uploaded(app: &App) -> u64 {
    app.sub_app(RenderApp)
        .world()
        .resource::<CrowdUploads>()
        .bytes
}

#[test]
fn gpu_a_crowd_looks_as_the_cpu_reference_has_it() {
    let Some(mut app) = app() else { return };
    let rig = person::rig_with_mesh();
    let clips: Vec<usize> = (0..rig.clips.len()).collect();
    let palette = Palette::bake(&rig, 0, &clips, 30.0).unwrap();
    let mesh = &rig.meshes[0];
    let anchor = Vec3::new(0.5, -1.0, -6.0);
    let prepasses = (DepthPrepass, DeferredPrepass, MotionVectorPrepass);
    let (_, target) = camera::camera(&mut app, UVec2::splat(SIZE), (Tonemapping::None, prepasses));
    let light = DirectionalLight {
        shadow_maps_enabled: true,
        ..default()
    };
    let slanted = Transform::from_xyz(1.0, 2.0, 1.5).looking_at(Vec3::ZERO, Vec3::Y);
    app.world_mut().spawn((light, slanted));
    let floor = Mesh::from(Plane3d::default().mesh().size(20.0, 20.0));
    let floor = app.world_mut().resource_mut::<Assets<Mesh>>().add(floor);
    let base = StandardMaterial {
        base_color: Color::srgb(0.8, 0.5, 0.3),
        ..default()
    };
    let grey = app
        .world_mut()
        .resource_mut::<Assets<StandardMaterial>>()
        .add(Color::srgb(0.5, 0.5, 0.5));
    app.world_mut().spawn((
        Mesh3d(floor),
        MeshMaterial3d(grey),
        Transform::from_xyz(0.0, -1.0, -6.0),
    ));
    let empty = picture(&mut app, &target);

    let look = {
        let world = app.world_mut();
        let mut meshes = world.remove_resource::<Assets<Mesh>>().unwrap();
        let mut materials = world.remove_resource::<Assets<CrowdMaterial>>().unwrap();
        let mut buffers = world.remove_resource::<Assets<ShaderBuffer>>().unwrap();
        // Room for two: it has to grow.
        let parts = [(mesh, base.clone())];
        let look = CrowdLook::new(
            &palette,
            &parts,
            2,
            &mut meshes,
            &mut materials,
            &mut buffers,
        );
        world.insert_resource(meshes);
        world.insert_resource(materials);
        world.insert_resource(buffers);
        look
    };
    let crowd = Crowd {
        anchor,
        figures: figures(&palette, 0.0),
    };
    let crowd = app.world_mut().spawn((crowd, look)).id();
    picture(&mut app, &target);
    // Another moment: the same entities, other bytes.
    let before = uploaded(&app);
    app.world_mut().get_mut::<Crowd>(crowd).unwrap().figures = figures(&palette, 0.4);
    app.update();
    app.update();
    assert_eq!(uploaded(&app) - before, 5 * 16);
    let drawn = picture(&mut app, &target);
    assert_eq!(uploaded(&app) - before, 5 * 16, "what rests is not sent");
    // Fewer, and none.
    app.world_mut()
        .get_mut::<Crowd>(crowd)
        .unwrap()
        .figures
        .clear();
    let gone = picture(&mut app, &target);

    let moved = figures(&palette, 0.4);
    let material = app
        .world_mut()
        .resource_mut::<Assets<StandardMaterial>>()
        .add(base);
    for figure in &moved {
        let mesh = skinned(&palette, mesh, figure, anchor);
        let mesh = app.world_mut().resource_mut::<Assets<Mesh>>().add(mesh);
        app.world_mut()
            .spawn((Mesh3d(mesh), MeshMaterial3d(material.clone())));
    }
    let wanted = picture(&mut app, &target);
    let covered = apart(&empty, &wanted);
    let wrong = apart(&drawn, &wanted);
    eprintln!(
        "figures and shadows cover {covered:.3} of the picture; {wrong:.5} of it differs; gone {:.5}",
        apart(&empty, &gone)
    );
    if let Some(folder) = std::env::var_os("DOLOMITE_PICTURES") {
        for (name, pixels) in [("crowd", &drawn), ("reference", &wanted)] {
            let path = std::path::Path::new(&folder).join(format!("crowd_{name}.png"));
            let bytes: Vec<u8> = pixels.iter().flatten().copied().collect();
            image::save_buffer(path, &bytes, SIZE, SIZE, image::ColorType::Rgb8).unwrap();
        }
    }
    assert!(covered > 0.05, "{covered}");
    // Edges of triangles whose corners differ by a rounding may fall on either side of a pixel's middle.
    assert!(wrong < 0.002, "{wrong}");
    assert!(apart(&empty, &gone) == 0.0);
}
