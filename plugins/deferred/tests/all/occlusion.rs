//! Ambient occlusion: the passes on the adapter against those on the CPU, and both against rays.

use bevy::camera::Viewport;
use bevy::math::{UVec2, Vec2, Vec3};
use bevy::prelude::*;
use bevy::render::RenderApp;
use bevy::render::render_resource::{PipelineCache, PipelineDescriptor};
use dolomite_deferred::occlusion::reference::{Projection, Screen, parts, pattern, share};
use dolomite_deferred::{
    AmbientOcclusion, DeferredLighting, DeferredPlugin, DeferredStats, OcclusionQuality,
    OcclusionResolution,
};
use dolomite_light_oracle::occlusion::Occlusion;
use dolomite_light_oracle::{Recipe, Scene, generate, per_pixel};
use dolomite_testkit::light::occlusion::{Seen, in_ambient_light, shares};
use dolomite_testkit::light::{self as support, GBufferPlugin};

fn app() -> Option<App> {
    support::app_with(|app| {
        app.add_plugins((DeferredPlugin, GBufferPlugin));
    })
}

fn scene(seed: u64) -> Scene {
    in_ambient_light(&generate(&Recipe {
        seed,
        width: 160,
        height: 90,
        ..Recipe::default()
    }))
}

fn set(app: &mut App, camera: Entity, occlusion: Option<AmbientOcclusion>) {
    let mut camera = app.world_mut().entity_mut(camera);
    match occlusion {
        Some(occlusion) => camera.insert(occlusion),
        None => camera.remove::<AmbientOcclusion>(),
    };
}

fn off(a: &[Option<f64>], b: impl Iterator<Item = Option<f64>>) -> Vec<f64> {
    let both = a.iter().zip(b);
    both.filter_map(|(a, b)| Some((a.as_ref()? - b?).abs()))
        .collect()
}

fn rms(errors: &[f64]) -> f64 {
    (errors.iter().map(|x| x * x).sum::<f64>() / errors.len() as f64).sqrt()
}

#[test]
fn adapter_cpu_and_rays_agree_gpu() {
    let Some(mut app) = app() else { return };
    let mut against_rays = [0.0_f64; 2];
    for seed in [1, 2] {
        let scene = scene(seed);
        let spawned = support::spawn(&mut app, &scene, DeferredLighting::default());
        let without = support::picture(&mut app, spawned.camera, 4);
        let seen = Seen::new(&support::pixels(&app), &scene.camera);
        let radius = 0.25;
        let how = Occlusion {
            rays: 256,
            distance: radius.into(),
            ..Occlusion::default()
        };
        let truth = per_pixel::occlusions(&scene, &how);
        for (k, resolution) in [OcclusionResolution::Full, OcclusionResolution::Half]
            .into_iter()
            .enumerate()
        {
            let occlusion = AmbientOcclusion {
                radius,
                quality: OcclusionQuality::High,
                resolution,
                ..default()
            };
            set(&mut app, spawned.camera, Some(occlusion));
            let with = support::picture(&mut app, spawned.camera, 4);
            support::keep(&with, 0.5, &format!("occlusion-{seed}-{resolution:?}"));
            assert_eq!(with.nonsense(), 0);
            let drawn = shares(&with, &without);
            let settings = occlusion.settings().expect("a radius");
            let on_cpu = seen.screen().shares(&settings, k == 1);
            let errors = off(&drawn, on_cpu.iter().map(|x| Some(f64::from(*x))));
            let many = errors.iter().filter(|x| **x > 0.01).count();
            let mean = errors.iter().sum::<f64>() / errors.len() as f64;
            eprintln!(
                "seed {seed} {resolution:?}: mean {mean:.1e} from the CPU, {many} of {} beyond 0.01",
                errors.len()
            );
            // An arc that ends at the middle of a part takes that part or leaves it, by the last bit of an arc cosine: a
            // part is 1/96 of a pixel before the mean of 16.
            assert!(mean < 1e-3 && many * 200 <= errors.len(), "{mean} {many}");
            let errors = off(&drawn, truth.iter().copied());
            eprintln!("seed {seed} {resolution:?}: {:.4} from rays", rms(&errors));
            against_rays[k] += rms(&errors) / 2.0;
        }
        app.world_mut().despawn(spawned.camera);
        for other in spawned.others {
            app.world_mut().despawn(other);
        }
    }
    // Asked for: 0.06, and 1.2 times that of all pixels for half of them. No light at all would be off by 1.
    let [full, half] = against_rays;
    assert!(full <= 0.06 && half <= 1.2 * full, "{against_rays:?}");
}

#[test]
fn a_floor_in_the_open_is_not_dark() {
    // Looked at from straight above to nearly along it, through a wide lens: the only surface hides nothing of itself.
    let size = UVec2::new(48, 27);
    for tilt in [0.01_f32, 0.3, 0.8, 1.2, 1.5] {
        for orthographic in [false, true] {
            let tangents = Vec2::new(2.0, 1.125);
            let normal = Vec3::new(0.0, bevy::math::ops::sin(tilt), bevy::math::ops::cos(tilt));
            let (mut depths, mut normals) = (Vec::new(), Vec::new());
            for y in 0..size.y {
                for x in 0..size.x {
                    let pixel = Vec2::new(x as f32 + 0.5, y as f32 + 0.5) / size.as_vec2();
                    let flat = (pixel * Vec2::new(2.0, -2.0) + Vec2::new(-1.0, 1.0)) * tangents;
                    // The plane `normal · p = −10`.
                    let depth = if orthographic {
                        (10.0 + normal.dot(flat.extend(0.0))) / normal.z
                    } else {
                        10.0 / normal.dot(-flat.extend(-1.0))
                    };
                    depths.push(if depth > 0.0 { depth } else { 0.0 });
                    normals.push(normal);
                }
            }
            let screen = Screen {
                size,
                depths: &depths,
                normals: &normals,
                projection: Projection {
                    tangents,
                    orthographic,
                },
            };
            for radius in [1.0, 5.0, 1e4] {
                let occlusion = AmbientOcclusion {
                    radius,
                    ..default()
                };
                let shares = screen.shares(&occlusion.settings().expect("a radius"), false);
                let least = shares.iter().copied().fold(1.0_f32, f32::min);
                // f32 leaves some 1e-6 of a slope; a part of a slice is 1/64.
                assert!(least > 0.999, "tilt {tilt} radius {radius}: {least}");
            }
        }
    }
}

#[test]
fn a_scene_of_any_size_looks_the_same() {
    let scene = scene(3);
    let texels = per_pixel::texels(&scene);
    let to_view = scene.camera.rotation.inverse();
    let at = |scale: f64| {
        let depths: Vec<f32> = texels
            .iter()
            .map(|texel| {
                texel.map_or(0.0, |texel| {
                    let place = to_view * (texel.position - scene.camera.position);
                    (-place.z * scale) as f32
                })
            })
            .collect();
        let normals: Vec<Vec3> = texels
            .iter()
            .map(|texel| {
                texel.map_or(Vec3::Z, |texel| {
                    let normal = to_view * texel.normal;
                    Vec3::new(normal.x as f32, normal.y as f32, normal.z as f32)
                })
            })
            .collect();
        let screen = Screen {
            size: UVec2::new(160, 90),
            depths: &depths,
            normals: &normals,
            projection: Projection {
                tangents: Vec2::new(16.0 / 9.0, 1.0)
                    * bevy::math::ops::tan(0.5 * scene.camera.fov_y as f32),
                orthographic: false,
            },
        };
        let occlusion = AmbientOcclusion {
            radius: (0.5 * scale) as f32,
            thickness: scale as f32,
            ..default()
        };
        screen.shares(&occlusion.settings().expect("a radius"), true)
    };
    let own = at(1.0);
    let dark = own.iter().filter(|share| **share < 0.8).count();
    assert!(dark > 100, "{dark} pixels have something to show");
    for scale in [1e-3, 1e3, 1e6] {
        let other = at(scale);
        let apart = own.iter().zip(&other).map(|(a, b)| (a - b).abs());
        let many = apart.clone().filter(|x| *x > 1.0 / 255.0).count();
        // A part of one slice of one pixel, 1/64 before the mean, may fall to the other side of a rounding.
        assert!(many * 1000 <= own.len(), "scale {scale}: {many} pixels");
        assert!(apart.fold(0.0, f32::max) < 1.0 / 32.0, "scale {scale}");
    }
}

#[test]
fn every_part_and_every_turn_counts_once() {
    assert_eq!(parts(0.0, 1.0), u32::MAX);
    assert_eq!(parts(0.25, 0.25), 0);
    assert_eq!(parts(0.0, 0.5) | parts(0.5, 1.0), u32::MAX);
    assert_eq!(parts(0.0, 0.5) & parts(0.5, 1.0), 0);
    for low in 0..=32 {
        for high in low..=32 {
            let bits = parts(low as f32 / 32.0, high as f32 / 32.0);
            assert_eq!(bits.count_ones(), high - low);
        }
    }
    let mut turns: Vec<Vec2> = (0..16)
        .map(|k| pattern(bevy::math::IVec2::new(k % 4, k / 4)))
        .collect();
    for axis in 0..2 {
        turns.sort_by(|a, b| a[axis].total_cmp(&b[axis]));
        for (k, turn) in turns.iter().enumerate() {
            assert_eq!(turn[axis], (k as f32 + 0.5) / 16.0);
        }
    }
    // Each of four columns weighs the same in the filter, at both places of a halved pixel.
    for rest in [0.0, 0.5] {
        let mut columns = [0.0; 4];
        for k in -2..=2_i32 {
            columns[k.rem_euclid(4) as usize] += share(k as f32 - rest);
        }
        assert_eq!(columns, [1.0; 4], "{rest}");
    }
}

#[test]
fn what_makes_no_sense_is_left_out_gpu() {
    let Some(mut app) = app() else { return };
    let scene = scene(4);
    let spawned = support::spawn(&mut app, &scene, DeferredLighting::default());
    let without = support::picture(&mut app, spawned.camera, 4);
    let passes = |app: &App| app.world().resource::<DeferredStats>().views()[0].passes;
    let first = passes(&app);
    let made = |app: &App| {
        let cache = app.sub_app(RenderApp).world().resource::<PipelineCache>();
        let of_ours = |descriptor: &PipelineDescriptor| match descriptor {
            PipelineDescriptor::ComputePipelineDescriptor(descriptor) => {
                descriptor.label.as_deref() == Some("dolomite_deferred_occlusion")
            }
            PipelineDescriptor::RenderPipelineDescriptor(_) => false,
        };
        cache.pipelines().filter(|p| of_ours(&p.descriptor)).count()
    };
    for radius in [0.0, -1.0, f32::NAN, f32::NEG_INFINITY] {
        let occlusion = AmbientOcclusion {
            radius,
            ..default()
        };
        set(&mut app, spawned.camera, Some(occlusion));
        let with = support::picture(&mut app, spawned.camera, 3);
        assert_eq!(with.pixels, without.pixels, "{radius}");
        assert_eq!((passes(&app), made(&app)), (first, 0), "{radius}");
    }
    for radius in [1e-30, f32::INFINITY] {
        let occlusion = AmbientOcclusion {
            radius,
            ..default()
        };
        set(&mut app, spawned.camera, Some(occlusion));
        let with = support::picture(&mut app, spawned.camera, 3);
        assert_eq!(with.nonsense(), 0, "{radius}");
        assert_eq!((passes(&app), made(&app)), (first + 1, 2), "{radius}");
        // A radius of nothing hides nothing, one of everything something.
        assert_eq!(with.pixels == without.pixels, radius < 1.0, "{radius}");
    }
    // Taken away, its pass and its memory are.
    set(&mut app, spawned.camera, None);
    let with = support::picture(&mut app, spawned.camera, 3);
    assert_eq!(with.pixels, without.pixels);
    assert_eq!(passes(&app), first);
}

/// The pipeline that reads it is drawn with until the one without it is compiled, which is a frame at least.
#[test]
fn occlusion_that_was_always_there_can_be_taken_away_gpu() {
    let Some(mut app) = app() else { return };
    let occlusion = AmbientOcclusion::default();
    let lit = (DeferredLighting::default(), occlusion);
    let spawned = support::spawn(&mut app, &scene(4), lit);
    support::frames(&mut app, 6);
    let passes = |app: &App| app.world().resource::<DeferredStats>().views()[0].passes;
    let with = passes(&app);
    for radius in [None, Some(0.0), Some(f32::NAN)] {
        let none = radius.map(|radius| AmbientOcclusion {
            radius,
            ..occlusion
        });
        set(&mut app, spawned.camera, none);
        // Asserts that rendering did not stop.
        support::frames(&mut app, 4);
        assert_eq!(passes(&app) + 1, with, "{radius:?}");
        set(&mut app, spawned.camera, Some(occlusion));
        support::frames(&mut app, 4);
        assert_eq!(passes(&app), with, "{radius:?}");
    }
}

#[test]
fn a_part_of_a_target_is_as_a_target_of_its_size_gpu() {
    let Some(mut app) = app() else { return };
    let mut small = scene(2);
    (small.camera.width, small.camera.height) = (64, 36);
    let mut large = small.clone();
    (large.camera.width, large.camera.height) = (96, 60);
    let corner = UVec2::new(17, 9);
    for resolution in [OcclusionResolution::Full, OcclusionResolution::Half] {
        let occlusion = AmbientOcclusion {
            radius: 1.0,
            resolution,
            ..default()
        };
        let mut pictures = Vec::new();
        for scene in [&small, &large] {
            let lit = (DeferredLighting::default(), occlusion);
            let spawned = support::spawn(&mut app, scene, lit);
            if scene.camera.width > 64 {
                let mut camera = app
                    .world_mut()
                    .get_mut::<Camera>(spawned.camera)
                    .expect("it is there");
                camera.viewport = Some(Viewport {
                    physical_position: corner,
                    physical_size: UVec2::new(64, 36),
                    ..default()
                });
            }
            pictures.push(support::picture(&mut app, spawned.camera, 4).pixels);
            app.world_mut().despawn(spawned.camera);
            for other in spawned.others {
                app.world_mut().despawn(other);
            }
        }
        let mut beyond = 0;
        for y in 0..36_u32 {
            let row = ((y + corner.y) * 96 + corner.x) as usize;
            let part = &pictures[1][row..row + 64];
            let own = &pictures[0][(y * 64) as usize..][..64];
            let apart = part.iter().zip(own).map(|(a, b)| (a[0] - b[0]).abs());
            beyond += apart.filter(|x| *x > 1.0 / 255.0).count();
        }
        // Depth differs in its last bits where triangles lie elsewhere in a target, and with them the edge of a few.
        assert!(beyond <= 4, "{beyond} pixels, {resolution:?}");
    }
}
