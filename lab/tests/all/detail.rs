//! The level of detail through its passes on whatever adapter there is, against the CPU reference.

use bevy::math::{DVec2, EulerRot, IVec2, Mat4, Quat, Vec2, Vec3, Vec4};
use bytemuck::Zeroable;
use dolomite_ground::detail::layout::{DEPTH_PASSES, DetailParams, LAST_PASSES};
use dolomite_ground::detail::{
    CullView, DetailCells, DetailMesh, DetailView, Horizon, HorizonView, Metric, TerrainLod, mesh,
    select,
};
use dolomite_terrain::{
    Fractal, GroundPoint, GroundRect, Hill, Layer, Mask, Source, Terrain, TerrainData,
};
use dolomite_testkit::detail::{DetailRun, DetailStage};
use dolomite_testkit::gpu::for_test;
use std::collections::{HashMap, HashSet};

/// Hills on rough ground, a sea, at 10⁵ m from the origin.
fn terrain() -> Terrain {
    let fractal = |seed, octaves, amplitude, wavelength| {
        Source::Fractal(Fractal {
            seed,
            octaves,
            amplitude,
            wavelength,
            ..Fractal::default()
        })
    };
    let centre = DVec2::new(1e5, -1e5);
    Terrain::new(TerrainData {
        extent: GroundRect::new(
            centre - DVec2::new(2048.0, 1024.0),
            centre + DVec2::new(2048.0, 1024.0),
        ),
        layers: vec![
            Layer {
                source: fractal(1, 10, 120.0, 900.0),
                mask: None,
            },
            Layer {
                source: Source::Hill(Hill {
                    centre: centre + DVec2::new(300.0, 100.0),
                    radius: 20.0,
                    height: 30.0,
                }),
                mask: None,
            },
            Layer {
                source: fractal(2, 4, 3.0, 40.0),
                mask: Some(Mask {
                    low: 5.0,
                    high: 40.0,
                }),
            },
        ],
        base: 10.0,
        sea_level: Some(0.0),
    })
    .expect("valid")
}

fn view(terrain: &Terrain, yaw: f32, above: f32, metric: Metric) -> DetailView {
    let xz = DVec2::new(1e5 + 37.25, -1e5 - 110.5);
    let anchor = xz.floor();
    let ground = terrain.sample_f64(xz).height.max(0.0) as f32;
    let at = (xz - anchor).as_vec2();
    let eye = Vec3::new(at.x, ground + above, at.y);
    let rotation = Quat::from_euler(EulerRot::YXZ, yaw, -0.15, 0.0);
    let (fov, aspect, near) = (1.0_f32, 16.0 / 9.0, 0.1);
    let tan = bevy::math::ops::tan(fov / 2.0);
    let clip = Mat4::perspective_infinite_reverse_rh(fov, aspect, near)
        * Mat4::from_rotation_translation(rotation, eye).inverse();
    let row = |k| clip.row(k);
    let planes = [
        row(3) + row(0),
        row(3) - row(0),
        row(3) + row(1),
        row(3) - row(1),
        row(3) - row(2),
        Vec4::W,
    ];
    let mut view = DetailView::zeroed();
    view.planes = planes.map(|plane| plane.to_array());
    view.eye = eye.to_array();
    view.scale = 540.0 / 2.0 / tan;
    view.right = (rotation * Vec3::X).to_array();
    view.up = (rotation * Vec3::Y).to_array();
    view.forward = (rotation * Vec3::NEG_Z).to_array();
    view.near = near;
    view.cos_corner = 1.0 / (1.0 + tan * tan * (1.0 + aspect * aspect)).sqrt();
    view.anchor = IVec2::new(anchor.x as i32, anchor.y as i32).to_array();
    view.set_metric(&TerrainLod {
        metric,
        ..TerrainLod::default()
    });
    view
}

/// Corners of triangles by their places, from the least on, to 1/1024 m: the same on CPU and GPU.
fn by_place(corners: impl Iterator<Item = [[f32; 3]; 3]>) -> HashSet<[[i32; 2]; 3]> {
    corners
        .map(|corners| {
            let places = corners.map(|[x, _, z]| [x, z].map(|v| (v * 1024.0).round() as i32));
            let least = (0..3).min_by_key(|&k| places[k]).expect("three");
            [0, 1, 2].map(|k| places[(least + k) % 3])
        })
        .collect()
}

fn of_run(run: &DetailRun) -> HashSet<[[i32; 2]; 3]> {
    let at = |k: u32| run.positions[k as usize];
    by_place(run.triangles.iter().map(|triangle| triangle.map(at)))
}

fn of_mesh(mesh: &DetailMesh, view: &DetailView) -> HashSet<[[i32; 2]; 3]> {
    let anchor = GroundPoint::from(view.anchor().as_dvec2());
    let at = |k: u32| {
        let vertex = mesh.vertices[k as usize];
        let place = vertex.point.relative_to(anchor);
        [place.x, vertex.height, place.y]
    };
    by_place(mesh.triangles.iter().map(|triangle| triangle.map(at)))
}

fn params(cells: &DetailCells, view: DetailView) -> DetailParams {
    DetailParams::new(cells, view, 0, [1 << 17, 1 << 18])
}

#[test]
fn gpu_the_passes_choose_and_place_what_the_cpu_reference_does() {
    let Some(gpu) = for_test() else { return };
    let terrain = terrain();
    let mut cells = DetailCells::new(terrain.clone(), 0.25);
    let mut stage = DetailStage::new(&gpu, &cells, 1 << 18).expect("passes");
    let metrics = [
        Metric::ErrorBound { pixels: 2.0 },
        Metric::EdgeLength { pixels: 24.0 },
        Metric::Classic {
            patch: 64.0,
            least: 1.0,
            greatest: 16.0,
            reach: 800.0,
            height: 10.0,
        },
    ];
    for (k, metric) in metrics.into_iter().enumerate() {
        let view = view(&terrain, k as f32 * 2.0, 2.0 + 30.0 * k as f32, metric);
        let selection = select(&mut cells, &view, 1 << 20);
        let reference = mesh::mesh(&cells, &selection);
        let run = stage.run(params(&cells, view)).expect("runs");
        assert_eq!(run.coarsening, 1.0);
        let (ours, theirs) = (of_run(&run), of_mesh(&reference, &view));
        assert_eq!(ours.len(), run.triangles.len(), "no triangle twice");
        assert!(theirs.len() > 2000, "{metric:?}: {}", theirs.len());
        // A GPU may fuse and reorder, so that heights, hence errors, differ by roundings: error ratios a
        // hair from the threshold fall on the other side of it.
        let other = ours.symmetric_difference(&theirs).count();
        assert!(
            other as f64 <= 2e-3 * theirs.len() as f64,
            "{metric:?}: {other} of {} triangles differ",
            theirs.len()
        );
        let heights: HashMap<[u32; 2], f32> = run
            .positions
            .iter()
            .map(|&[x, y, z]| ([x.to_bits(), z.to_bits()], y))
            .collect();
        let anchor = GroundPoint::from(view.anchor().as_dvec2());
        let mut compared = 0;
        for vertex in &reference.vertices {
            let place = vertex.point.relative_to(anchor);
            if let Some(height) = heights.get(&[place.x.to_bits(), place.y.to_bits()]) {
                // Heights of 160 m: 1e-4 m are some roundings. A geomorphing vertex moves by its error
                // times the difference of error ratios, both small.
                assert!(
                    (height - vertex.height).abs() < 1e-3,
                    "{place} {height} {vertex:?}"
                );
                compared += 1;
            }
        }
        assert!(compared * 100 > reference.vertices.len() * 99, "{compared}");
    }
}

#[test]
fn gpu_the_oldest_cells_are_dropped_and_made_again_the_same() {
    let Some(gpu) = for_test() else { return };
    let terrain = terrain();
    let cells = DetailCells::new(terrain.clone(), 0.25);
    let mut stage = DetailStage::new(&gpu, &cells, 1 << 18).expect("passes");
    let metric = Metric::ErrorBound { pixels: 4.0 };
    let [north, south] = [0.0, 3.0].map(|yaw| params(&cells, view(&terrain, yaw, 4.0, metric)));
    let run = |stage: &mut DetailStage, params, oldest| {
        let params = DetailParams { oldest, ..params };
        stage.run(params).expect("runs")
    };
    // Choices 1, 2 and 3.
    let first = run(&mut stage, north, 0);
    let second = run(&mut stage, south, 0);
    assert!(second.used > first.used, "two views look at more than one");
    let third = run(&mut stage, south, 0);
    assert_eq!(third.used, second.used, "all is there");
    // What choice 1 alone looked at goes, a layer of blocks a sweep: from the leaves up.
    let mut used = third.used;
    for sweep in 0.. {
        let swept = run(&mut stage, south, 2);
        assert_eq!(of_run(&swept), of_run(&second), "what the view needs stays");
        assert!(swept.used <= used, "{} of {used}", swept.used);
        if swept.used == used {
            assert!(sweep > 2, "{sweep}");
            break;
        }
        used = swept.used;
    }
    assert!(
        used < second.used && used > second.used / 4,
        "{used} of {}",
        second.used
    );
    // Blocks that were dropped are taken again, for cells elsewhere.
    let again = run(&mut stage, north, 0);
    assert_eq!(of_run(&again), of_run(&first));
    assert_eq!(again.used, second.used);
    assert_eq!(of_run(&run(&mut stage, south, 0)), of_run(&second));
    // Where everything that is old goes, roots stay.
    let alone = run(&mut stage, south, u32::MAX);
    assert_eq!(of_run(&alone), of_run(&second));
}

#[test]
fn gpu_the_mesh_is_closed_and_the_same_after_looking_away() {
    let Some(gpu) = for_test() else { return };
    let terrain = terrain();
    let cells = DetailCells::new(terrain.clone(), 0.25);
    let mut stage = DetailStage::new(&gpu, &cells, 1 << 18).expect("passes");
    let metric = Metric::ErrorBound { pixels: 4.0 };
    let mut all = view(&terrain, 0.0, 3.0, metric);
    all.planes = [[0.0, 0.0, 0.0, 1.0]; 6];
    let run = stage.run(params(&cells, all)).expect("runs");
    assert!(run.triangles.len() > 10_000);
    let mut edges = HashSet::new();
    for &[a, b, c] in &run.triangles {
        for edge in [(a, b), (b, c), (c, a)] {
            assert!(edges.insert(edge), "an edge is used twice in one direction");
        }
    }
    let mut border = 0.0;
    for &(a, b) in &edges {
        if !edges.contains(&(b, a)) {
            let [a, b] = [a, b].map(|k| run.positions[k as usize]);
            assert!(a[0] == b[0] || a[2] == b[2], "a gap");
            border += f64::from((a[0] - b[0]).abs() + (a[2] - b[2]).abs());
        }
    }
    assert!((border - 2.0 * (4096.0 + 2048.0)).abs() < 0.01, "{border}");

    let sorted = |run: &DetailRun| {
        let at = |k: u32| run.positions[k as usize].map(f32::to_bits);
        let mut all: Vec<_> = run
            .triangles
            .iter()
            .map(|triangle| {
                let corners = triangle.map(at);
                let least = (0..3).min_by_key(|&k| corners[k]).expect("three");
                [0, 1, 2].map(|k| corners[(least + k) % 3])
            })
            .collect();
        all.sort_unstable();
        all
    };
    let look = |stage: &mut DetailStage, yaw| {
        let view = view(&terrain, yaw, 3.0, metric);
        sorted(&stage.run(params(&cells, view)).expect("runs"))
    };
    let before = look(&mut stage, 0.0);
    let away = look(&mut stage, 2.5);
    assert!(before != away);
    assert!(before == look(&mut stage, 0.0), "the same bits");
    let mut fresh = DetailStage::new(&gpu, &cells, 1 << 18).expect("passes");
    assert!(before == look(&mut fresh, 0.0), "whatever was kept");
}

#[test]
fn gpu_pools_that_are_too_small_coarsen_evenly_and_stay_closed() {
    let Some(gpu) = for_test() else { return };
    let terrain = terrain();
    let cells = DetailCells::new(terrain.clone(), 0.25);
    let metric = Metric::ErrorBound { pixels: 4.0 };
    let mut all = view(&terrain, 0.0, 3.0, metric);
    all.planes = [[0.0, 0.0, 0.0, 1.0]; 6];
    // Too few vertices, and too few cells: then nothing is drawn that asks for less than the cells for
    // whose quarters there was no room, and those near the eye ask for very much: little is left.
    for (capacity, pools, least) in [
        (1 << 18, [4000, 1 << 18], 2000),
        (1 << 13, [1 << 17, 1 << 18], 4),
    ] {
        let mut stage = DetailStage::new(&gpu, &cells, capacity).expect("passes");
        let given = DetailParams {
            max_vertices: pools[0],
            max_triangles: pools[1],
            ..params(&cells, all)
        };
        let run = stage.run(given).expect("runs");
        assert!(run.coarsening > 1.2, "{}", run.coarsening);
        let found = run.positions.len();
        assert!((least..=pools[0] as usize).contains(&found), "{found}");
        let edges: HashSet<_> = run
            .triangles
            .iter()
            .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
            .collect();
        for &(a, b) in &edges {
            if !edges.contains(&(b, a)) {
                let [a, b] = [a, b].map(|k| run.positions[k as usize]);
                // The eye stands (37, −111) m from the middle.
                let off = |v: f32, middle: f32, side: f32| ((v + middle).abs() - side).abs();
                let on_border = a[0] == b[0] && off(a[0], 37.0, 2048.0) < 0.1
                    || a[2] == b[2] && off(a[2], -111.0, 1024.0) < 0.1;
                assert!(on_border, "a gap at {a:?} {b:?}");
            }
        }
    }
}

/// Corners of triangles by their bits, from the least on.
fn by_bits(run: &DetailRun, triangles: &[[u32; 3]]) -> HashSet<[[u32; 3]; 3]> {
    let at = |k: u32| run.positions[k as usize].map(f32::to_bits);
    triangles
        .iter()
        .map(|triangle| {
            let corners = triangle.map(at);
            let least = (0..3).min_by_key(|&k| corners[k]).expect("three");
            [0, 1, 2].map(|k| corners[(least + k) % 3])
        })
        .collect()
}

#[test]
fn gpu_what_a_picture_does_not_show_is_left_out_and_kept_for_shadows() {
    let Some(gpu) = for_test() else { return };
    let terrain = terrain();
    let cells = DetailCells::new(terrain.clone(), 0.25);
    let mut stage = DetailStage::new(&gpu, &cells, 1 << 18).expect("passes");
    let metric = Metric::ErrorBound { pixels: 4.0 };
    for (yaw, above, most) in [(0.0, 3.0, 0.8), (2.0, 60.0, 0.9)] {
        let mut view = view(&terrain, yaw, above, metric);
        // The sun is low: cells beside the picture throw their shadows into it.
        view.sweep = [150.0, -20.0, 80.0];
        view.shadow_share = 0.25;
        let given = params(&cells, view);
        let all = stage.run(given).expect("runs");
        assert!(all.others.is_empty());
        let eye = Vec3::from(view.eye);
        let rotation = Quat::from_euler(EulerRot::YXZ, yaw, -0.15, 0.0);
        let clip = Mat4::perspective_infinite_reverse_rh(1.0, 16.0 / 9.0, 0.1)
            * Mat4::from_rotation_translation(rotation, eye).inverse();
        let picture = CullView {
            clip,
            half_size: Vec2::new(960.0, 540.0),
            one_sided: true,
        };
        let run = stage.run(given.cull(&picture, true)).expect("runs");
        let (whole, seen) = (by_bits(&all, &all.triangles), by_bits(&run, &run.triangles));
        let others = by_bits(&run, &run.others);
        assert!(seen.is_disjoint(&others));
        assert!(
            whole == seen.union(&others).copied().collect(),
            "none is lost or moved"
        );
        assert!(
            (seen.len() as f32) < most * whole.len() as f32,
            "{} of {}",
            seen.len(),
            whole.len()
        );
        // By the CPU reference. On the threshold, which has its margin, roundings may differ.
        let at = |k: u32| Vec3::from(run.positions[k as usize]);
        let wrong = |list: &[[u32; 3]], hidden: bool| {
            let differs = |triangle: &&[u32; 3]| picture.hides(triangle.map(at)) != hidden;
            list.iter().filter(differs).count()
        };
        let wrong = wrong(&run.triangles, false) + wrong(&run.others, true);
        assert!(wrong * 500 <= whole.len(), "{wrong} of {}", whole.len());
        // Without shadows nobody asks for the others.
        let run = stage.run(given.cull(&picture, false)).expect("runs");
        assert_eq!(by_bits(&run, &run.triangles), seen);
        assert!(run.others.is_empty());
    }
}

/// What nearer ground hides is left out, as the CPU reference says; the times of its passes are printed.
#[test]
fn gpu_ground_behind_ridges_is_left_out_and_kept_for_shadows() {
    let Some(gpu) = for_test() else { return };
    let terrain = terrain();
    let mut cells = DetailCells::new(terrain.clone(), 0.25);
    let mut stage = DetailStage::new(&gpu, &cells, 1 << 18).expect("passes");
    let metric = Metric::ErrorBound { pixels: 4.0 };
    for (yaw, above, least) in [(0.0, 3.0, 0.2), (2.0, 30.0, 0.05)] {
        let view = view(&terrain, yaw, above, metric);
        let rotation = Quat::from_euler(EulerRot::YXZ, yaw, -0.15, 0.0);
        let clip = Mat4::perspective_infinite_reverse_rh(1.0, 16.0 / 9.0, 0.1)
            * Mat4::from_rotation_translation(rotation, Vec3::from(view.eye)).inverse();
        let picture = CullView {
            clip,
            half_size: Vec2::new(960.0, 540.0),
            one_sided: true,
        };
        let horizon =
            HorizonView::new(&cells, &view, &picture, 0.0).expect("level, over the ground");
        let given = params(&cells, view).cull(&picture, true);
        let before = stage.run(given).expect("runs");
        let (run, times) = stage.run_timed(given.occlude(horizon)).expect("runs");
        let left_out = before.triangles.len() - run.triangles.len();
        assert_eq!(run.others.len(), before.others.len() + left_out);
        let bits = |list: &[[u32; 3]]| by_bits(&run, list);
        let all: HashSet<_> = bits(&run.triangles)
            .union(&bits(&run.others))
            .copied()
            .collect();
        let known: HashSet<_> = by_bits(&before, &before.triangles)
            .union(&by_bits(&before, &before.others))
            .copied()
            .collect();
        assert!(all == known, "none is lost or moved");
        let share = left_out as f32 / before.triangles.len() as f32;
        let seconds = |entry: &str| {
            let of = times.iter().filter(|pass| pass.entry == entry);
            of.map(|pass| pass.time.as_secs_f64()).sum::<f64>()
        };
        println!(
            "{left_out} of {} are behind others; ms: map {:.2} and {:.2}, triangles {:.2}",
            before.triangles.len(),
            1e3 * seconds("draw_horizon"),
            1e3 * seconds("close_horizon"),
            1e3 * seconds("emit_triangles"),
        );
        assert!(share > least, "{share}");
        // By the CPU reference, whose logarithms and quotients are rounded otherwise: a square may be drawn into another
        // layer, which decides over what is behind it.
        let selection = select(&mut cells, &view, 1 << 20);
        let reference = Horizon::of(horizon, &cells, &selection, &view, 0.0);
        let at = |k: u32| Vec3::from(run.positions[k as usize]);
        let hides = |triangle: &[u32; 3]| {
            let corners = triangle.map(at);
            picture.hides(corners) || reference.hides(corners)
        };
        let wrong = run.triangles.iter().filter(|t| hides(t)).count()
            + run.others.iter().filter(|t| !hides(t)).count();
        assert!(wrong * 200 <= all.len(), "{wrong} of {}", all.len());
    }
}

#[test]
fn gpu_a_timed_choice_is_the_same_and_names_every_dispatch() {
    let Some(gpu) = for_test() else { return };
    let terrain = terrain();
    let cells = DetailCells::new(terrain.clone(), 0.25);
    let mut stage = DetailStage::new(&gpu, &cells, 1 << 18).expect("passes");
    let view = view(&terrain, 0.0, 3.0, Metric::ErrorBound { pixels: 8.0 });
    let run = stage.run(params(&cells, view)).expect("runs");
    let (timed, times) = stage.run_timed(params(&cells, view)).expect("runs");
    assert!(by_bits(&run, &run.triangles) == by_bits(&timed, &timed.triangles));
    // None where the device has no timestamps.
    if !times.is_empty() {
        let depths = cells.lattice.depth as usize + 1;
        let given = params(&cells, view);
        let last = LAST_PASSES.iter().filter(|(.., count)| given.needs(*count));
        assert_eq!(times.len(), depths * DEPTH_PASSES.len() + last.count());
        assert_eq!(times.last().map(|pass| pass.entry), Some("finish"));
        let all: std::time::Duration = times.iter().map(|pass| pass.time).sum();
        assert!(
            !all.is_zero() && all <= timed.time,
            "{all:?} of {:?}",
            timed.time
        );
    }
}
