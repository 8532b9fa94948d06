//! Level, error and overdraw of the drawn ground in each pixel, against rays in f64 through the triangles that the pools
//! hold, and the ground in f64.

use crate::app;

use bevy::math::{DVec2, DVec3, Vec3Swizzles as _, ops};
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_resource::{
    Buffer, BufferDescriptor, BufferUsages, Extent3d, MapMode, PipelineCache, PollType,
    TexelCopyBufferInfo, TexelCopyBufferLayout,
};
use bevy::render::renderer::{RenderDevice, RenderQueue};
use dolomite_geometry::layout::GeometryHead;
use dolomite_geometry::render::Producers;
use dolomite_ground::blocks::kept::lattice_of;
use dolomite_ground::detail::{DetailLattice, Metric, TerrainLod};
use dolomite_ground::render::inspect::{InspectionPasses, ViewInspection};
use dolomite_ground::{GroundInspection, GroundLayer, GroundMaterial, Sea, Surface, TerrainView};
use dolomite_terrain::{
    Fractal, GroundPoint, GroundRect, Layer, Source, Sum, Terrain, TerrainData,
};
use half::f16;

const WIDTH: u32 = 96;
const HEIGHT: u32 = 64;
const FINEST: f32 = 1.0;

/// Hills of 512 m off the origin, some of them below the sea.
fn terrain() -> Terrain {
    let fractal = Fractal {
        sum: Sum::Fbm,
        octaves: 5,
        amplitude: 40.0,
        wavelength: 150.0,
        ..Fractal::default()
    };
    Terrain::new(TerrainData {
        extent: GroundRect::square(DVec2::new(4000.0, -3000.0), 512.0),
        layers: vec![Layer {
            source: Source::Fractal(fractal),
            mask: None,
        }],
        base: 15.0,
        sea_level: Some(0.0),
    })
    .expect("valid hills")
}

struct Scene {
    app: App,
    terrain: Terrain,
    camera: Entity,
    place: Transform,
    lattice: DetailLattice,
}

fn scene(pixels: f32) -> Option<Scene> {
    let mut app = app::app()?;
    let terrain = terrain();
    let surface = Surface::Flat {
        colour: [0.5; 3],
        roughness: 0.9,
    };
    let material = GroundMaterial {
        layers: vec![GroundLayer::new("", surface)],
    };
    app.world_mut()
        .spawn((terrain.clone(), material, Sea::default()));
    let target = app::target(&mut app, WIDTH, HEIGHT);
    let eye = Vec3::new(3900.0, 60.0, -2830.0);
    let place = Transform::from_translation(eye).looking_to(Vec3::new(0.5, -0.2, -0.8), Vec3::Y);
    let detail = TerrainLod {
        metric: Metric::ErrorBound { pixels },
        finest: FINEST,
        // So that there is overdraw.
        occluded: false,
        ..default()
    };
    let camera = app::camera(&mut app, &target, (TerrainView, detail, place));
    app::frames(&mut app, 20);
    let lattice = lattice_of(&terrain, FINEST);
    Some(Scene {
        app,
        terrain,
        camera,
        place,
        lattice,
    })
}

fn read(app: &App, size: u64, copy: impl FnOnce(&mut wgpu::CommandEncoder, &Buffer)) -> Vec<u8> {
    let world = app.sub_app(RenderApp).world();
    let (device, queue) = (
        world.resource::<RenderDevice>(),
        world.resource::<RenderQueue>(),
    );
    let staging = device.create_buffer(&BufferDescriptor {
        label: None,
        size,
        usage: BufferUsages::COPY_DST | BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    let mut encoder = device.create_command_encoder(&default());
    copy(&mut encoder, &staging);
    queue.submit([encoder.finish()]);
    staging.slice(..).map_async(MapMode::Read, |mapped| {
        mapped.expect("it is read back");
    });
    device.poll(PollType::wait_indefinitely()).expect("done");
    staging.slice(..).get_mapped_range().to_vec()
}

/// Pixels of a unit of x over depth, by Bevy's usual field of view.
fn focal() -> f64 {
    f64::from(0.5 * HEIGHT as f32 / ops::tan(std::f32::consts::FRAC_PI_8))
}

impl Scene {
    fn inspected(&mut self) -> Option<ViewInspection> {
        let world = self.app.sub_app_mut(RenderApp).world_mut();
        world.query::<&ViewInspection>().iter(world).next().cloned()
    }

    /// What is found in each pixel.
    fn found(&mut self, what: GroundInspection) -> Vec<[f32; 2]> {
        self.app.world_mut().entity_mut(self.camera).insert(what);
        app::frames(&mut self.app, 3);
        let own = self.inspected().expect("it is inspected");
        assert_eq!(own.what, what);
        let texel: u32 = if what == GroundInspection::Overdraw {
            4
        } else {
            8
        };
        // Rows of a multiple of 256 bytes.
        let row = (WIDTH * texel).next_multiple_of(256);
        let bytes = read(&self.app, u64::from(row * HEIGHT), |encoder, staging| {
            encoder.copy_texture_to_buffer(
                own.found.texture.as_image_copy(),
                TexelCopyBufferInfo {
                    buffer: staging,
                    layout: TexelCopyBufferLayout {
                        offset: 0,
                        bytes_per_row: Some(row),
                        rows_per_image: None,
                    },
                },
                Extent3d {
                    width: WIDTH,
                    height: HEIGHT,
                    depth_or_array_layers: 1,
                },
            );
        });
        let mut found = Vec::new();
        for line in bytes.chunks_exact(row as usize) {
            let line = &line[..(WIDTH * texel) as usize];
            if texel == 8 {
                found.extend_from_slice(bytemuck::cast_slice::<u8, [f32; 2]>(line));
            } else {
                let halves = bytemuck::cast_slice::<u8, [u16; 2]>(line).iter();
                found.extend(halves.map(|pair| pair.map(|bits| f16::from_bits(bits).to_f32())));
            }
        }
        found
    }

    /// The triangles that the camera's pools hold, in the order in which they are drawn, in the world.
    fn triangles(&self) -> Vec<[DVec3; 3]> {
        let world = self.app.sub_app(RenderApp).world();
        let producers = world.resource::<Producers>();
        let states: Vec<_> = producers
            .iter()
            .flat_map(|producer| producer.views.values())
            .filter(|state| state.is_shown())
            .collect();
        let [state] = states[..] else {
            panic!("{} views of grounds", states.len());
        };
        let whole = |buffer: &Buffer, size: u64| {
            read(&self.app, size, |encoder, staging| {
                encoder.copy_buffer_to_buffer(buffer, 0, staging, 0, size);
            })
        };
        let head = whole(&state.work, size_of::<GeometryHead>() as u64);
        let head: GeometryHead = *bytemuck::from_bytes(&head);
        let vertices = whole(&state.vertices, 20 * u64::from(head.vertices));
        let indices = whole(&state.indices, 12 * u64::from(head.primitives));
        let vertices: &[[f32; 5]] = bytemuck::cast_slice(&vertices);
        let corner = |index: u32| {
            let [x, y, z, ..] = vertices[index as usize];
            Vec3::new(x, y, z).as_dvec3() + state.frame.anchor
        };
        let indices: &[[u32; 3]] = bytemuck::cast_slice(&indices);
        indices.iter().map(|three| three.map(corner)).collect()
    }

    /// Pixels from the middle of the picture.
    fn project(&self, point: DVec3) -> DVec2 {
        let (eye, turn) = (self.place.translation, self.place.rotation);
        let seen = turn.as_dquat().inverse() * (point - eye.as_dvec3());
        seen.truncate() / -seen.z * focal()
    }

    /// The ray through the middle of a pixel.
    fn ray(&self, pixel: usize) -> DVec3 {
        let at = DVec2::new(
            (pixel % WIDTH as usize) as f64 + 0.5 - 0.5 * f64::from(WIDTH),
            0.5 * f64::from(HEIGHT) - (pixel / WIDTH as usize) as f64 - 0.5,
        );
        self.place.rotation.as_dquat() * (at / focal()).extend(-1.0)
    }
}

/// How far along a ray a triangle is hit whose corners are counter-clockwise from there (Möller and Trumbore, 1997).
fn hit(eye: DVec3, ray: DVec3, [a, b, c]: [DVec3; 3]) -> Option<f64> {
    let (first, second) = (b - a, c - a);
    let across = ray.cross(second);
    let size = first.dot(across);
    if size <= 0.0 {
        return None;
    }
    let from = eye - a;
    let u = from.dot(across) / size;
    let around = from.cross(first);
    let v = ray.dot(around) / size;
    let along = second.dot(around) / size;
    (u >= 0.0 && v >= 0.0 && u + v <= 1.0 && along > 0.1).then_some(along)
}

/// What each pixel sees by rays: the triangle, where it is hit, and how many are shaded in the order of drawing.
fn seen(scene: &Scene, triangles: &[[DVec3; 3]]) -> Vec<Option<(usize, DVec3, u32)>> {
    let eye = scene.place.translation.as_dvec3();
    let pixels = 0..(WIDTH * HEIGHT) as usize;
    let seen = pixels.map(|pixel| {
        let ray = scene.ray(pixel);
        let (mut nearest, mut best, mut shaded) = (f64::INFINITY, None, 0);
        for (at, triangle) in triangles.iter().enumerate() {
            if let Some(along) = hit(eye, ray, *triangle).filter(|along| *along <= nearest) {
                (nearest, best, shaded) = (along, Some(at), shaded + 1);
            }
        }
        best.map(|at| (at, eye + ray * nearest, shaded))
    });
    seen.collect()
}

/// Of the pixels in which rays and rasteriser see ground, the share that is as expected; of all the pixels, few are ground
/// for one of them alone.
fn share(
    found: &[[f32; 2]],
    expected: &[Option<f64>],
    is_ground: impl Fn(f32) -> bool,
    is_same: impl Fn(f64, f64) -> bool,
) -> f64 {
    let (mut same, mut all, mut other) = (0, 0, 0);
    for ([found, _], expected) in found.iter().zip(expected) {
        match (is_ground(*found), expected) {
            (true, Some(expected)) => {
                all += 1;
                same += usize::from(is_same(f64::from(*found), *expected));
            }
            (false, None) => {}
            _ => other += 1,
        }
    }
    assert!(all > found.len() / 3, "{all} pixels of ground");
    // Silhouettes may run through the middle of a pixel.
    assert!(
        other * 100 < found.len(),
        "{other} pixels are ground for one"
    );
    same as f64 / all as f64
}

#[test]
fn gpu_pixels_are_inspected_as_rays_in_f64_see_them() {
    let tau = 4.0_f32;
    let Some(mut scene) = scene(tau) else {
        return;
    };
    let census = |scene: &mut Scene| {
        let is_there = scene.inspected().is_some();
        let world = scene.app.sub_app(RenderApp).world();
        let queued = world.resource::<PipelineCache>().pipelines();
        let label = "label: Some(\"ground_inspection\")";
        let queued = queued.filter(|one| format!("{:?}", one.descriptor).contains(label));
        let passes = world.resource::<InspectionPasses>().count();
        (is_there, queued.count(), passes)
    };
    assert_eq!(census(&mut scene), (false, 0, 0), "off, nothing");
    let eye = scene.place.translation.as_dvec3();
    assert!(scene.terrain.sample_f64(eye.xz()).height < eye.y - 5.0);
    let triangles = scene.triangles();
    let seen = seen(&scene, &triangles);

    // Within 1 % of the tolerance at 99 % of the pixels.
    let found = scene.found(GroundInspection::Error);
    let errors: Vec<_> = seen
        .iter()
        .map(|seen| {
            let (_, point, _) = (*seen)?;
            let truth = scene.terrain.sample_f64(point.xz()).height.max(0.0);
            let there = DVec3::new(point.x, truth, point.z);
            Some(scene.project(point).distance(scene.project(there)))
        })
        .collect();
    let near = |found: f64, expected: f64| (found - expected).abs() <= 0.01 * f64::from(tau);
    let same = share(&found, &errors, |found| found >= 0.0, near);
    let worst = errors.iter().flatten().copied().fold(0.0, f64::max);
    println!(
        "{} triangles, worst error {worst:.2} px, {same:.4} alike",
        triangles.len()
    );
    assert!(same >= 0.99, "{same} of the pixels are as measured");
    assert!(
        worst > 0.3 * f64::from(tau) && worst <= f64::from(tau),
        "{worst}"
    );
    assert!(
        found.iter().all(|[_, own]| *own == tau),
        "the tolerance, everywhere"
    );
    // The comparison can fail: by a twentieth of the tolerance.
    let off: Vec<_> = errors
        .iter()
        .map(|error| error.map(|e| e + 0.05 * f64::from(tau)))
        .collect();
    assert!(share(&found, &off, |found| found >= 0.0, near) < 0.05);

    let found = scene.found(GroundInspection::Level);
    let root = f64::from(2 * scene.lattice.root_half());
    let levels: Vec<_> = seen
        .iter()
        .map(|seen| {
            let (triangle, ..) = (*seen)?;
            let corners = triangles[triangle].map(|corner| {
                let place = GroundPoint::new(corner.xz());
                scene.lattice.coordinates(place).round()
            });
            let area = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]);
            let halved = (root * root / area.abs()) as u64;
            assert!(
                halved.is_power_of_two(),
                "{halved}: no triangle of the lattice"
            );
            Some(f64::from(halved.ilog2()))
        })
        .collect();
    let equal = |found: f64, expected: f64| found == expected;
    let same = share(&found, &levels, |found| found >= 0.0, equal);
    assert!(
        same >= 0.99,
        "{same} of the levels are those of the lattice"
    );
    let mut kinds: Vec<_> = levels.iter().flatten().map(|level| *level as u32).collect();
    kinds.sort_unstable();
    kinds.dedup();
    assert!(kinds.len() >= 4, "{kinds:?}");

    let found = scene.found(GroundInspection::Overdraw);
    let counts: Vec<_> = seen
        .iter()
        .map(|seen| seen.map(|(.., n)| f64::from(n)))
        .collect();
    let same = share(&found, &counts, |found| found > 0.0, equal);
    assert!(same >= 0.99, "{same} of the counts are those of the rays");
    let most = counts.iter().flatten().copied().fold(0.0, f64::max);
    assert!(most >= 2.0, "{most}: nothing is drawn over");

    let (_, queued, passes) = census(&mut scene);
    assert!(
        queued == 3 && passes > 0,
        "the counts count: {queued} {passes}"
    );
    scene
        .app
        .world_mut()
        .entity_mut(scene.camera)
        .remove::<GroundInspection>();
    app::frames(&mut scene.app, 2);
    let (is_there, _, passes) = census(&mut scene);
    app::frames(&mut scene.app, 2);
    assert!(!is_there, "off, no texture");
    assert_eq!(census(&mut scene), (false, 3, passes), "off, no pass");
}

#[test]
fn every_variant_of_the_shader_is_valid() {
    let all = dolomite_ground::render::inspect::inspection_variants();
    assert!(all.len() > 2 && all.contains(&vec!["INSPECT_LEVEL"]));
    for defines in all {
        dolomite_shaders::compose("ground/inspect.wgsl", &defines)
            .unwrap_or_else(|error| panic!("{defines:?}: {error}"));
    }
}
