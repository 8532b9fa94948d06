//! The classic scene: its levels by hand, both sides of each edge, counts by another formula, and its
//! WGSL on the adapter against the CPU reference.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use bevy::math::{DMat4, DVec3, Vec3};
use bytemuck::cast_slice;
use dolomite_classic::functions::{classic_level, patches};
use dolomite_classic::heights::{FILE, SAMPLES};
use dolomite_classic::{
    CLASSIC_LAYOUT, CLASSIC_SPACING, ClassicHeights, ClassicLevels, ClassicScene,
};
use dolomite_shaders::ShaderFile;
use dolomite_tessellation::half_edge::check;
use dolomite_tessellation::layout::StageView;
use dolomite_tessellation::patches::REVERSED;
use dolomite_tessellation::tables::Instance;
use dolomite_tessellation::{
    Domain, HostFunctions, HostPatch, HostTessellation, Levels, Mode, PatchMesh, Tessellator,
    Winding, tessellate_host,
};
use dolomite_testkit::gpu::{Gpu, for_test};
use dolomite_testkit::stage::{Emitted, StageOptions, StagePasses, StageRun};
use wgpu::BufferBindingType;

const TESSELLATOR: Tessellator = Tessellator {
    domain: Domain::Quads,
    spacing: CLASSIC_SPACING,
    winding: Winding::Ccw,
    mode: Mode::Exact,
};

const POOLS: [u32; 2] = [1 << 21, 1 << 22];

const FUNCTIONS: ShaderFile = ShaderFile {
    path: "stage/user.wgsl",
    source: "#define_import_path dolomite::stage::user

#import dolomite::stage::api::{Patch, PatchLevels, StageView, Vertex}
#import dolomite::classic::functions as classic

fn control(input: Patch, view: StageView) -> PatchLevels {
    return classic::control(input, view);
}

fn evaluate(input: Patch, at: vec3<f32>) -> Vertex {
    return classic::evaluate(input, at);
}
",
};

const DATA: [BufferBindingType; 1] = [BufferBindingType::Storage { read_only: true }];

/// Hills of the scene's height, for machines without its file: two waves of whole periods, so that the
/// borders meet, and roughness from sample to sample.
fn made() -> ClassicHeights {
    let triangle = |k: u32, period: u32| {
        let k = k % period;
        let half = period / 2;
        (if k < half { k } else { period - k }) as f32 / half as f32
    };
    let bytes: Vec<u8> = (0..SAMPLES * SAMPLES)
        .flat_map(|k| {
            let (i, j) = (k % SAMPLES, k / SAMPLES);
            let rough = (k.wrapping_mul(2_654_435_761) >> 24) as f32 / 6000.0;
            (triangle(i, 256) * triangle(j, 128) - 0.5 + rough).to_le_bytes()
        })
        .collect();
    ClassicHeights::decode(&bytes, Path::new("made")).expect("heights")
}

/// The scene's own heights; `None`, after a line that says so, without the shared data.
fn shared() -> Option<ClassicHeights> {
    let beside = || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    let folder = std::env::var_os("DOLOMITE_SHARED").map_or_else(beside, PathBuf::from);
    match ClassicHeights::load(&folder.join(FILE)) {
        Ok(heights) => Some(heights),
        Err(error) => {
            assert!(
                std::env::var_os("DOLOMITE_REQUIRE_SHARED").is_none(),
                "{error}, though the shared data are there"
            );
            eprintln!("skipped: {error}");
            None
        }
    }
}

/// The view of the path's frame `k` of 120.
fn view(k: u32) -> StageView {
    let angle = std::f64::consts::TAU * f64::from(k) / 120.0;
    let (sin, cos) = (
        bevy::math::ops::sin(angle as f32),
        bevy::math::ops::cos(angle as f32),
    );
    let (sin, cos) = (f64::from(sin), f64::from(cos));
    let eye = DVec3::new(200.0 * cos, 70.0, 200.0 * sin);
    let anchor = eye.floor();
    let to = DVec3::new(-sin, -0.25, cos);
    let projection =
        DMat4::perspective_infinite_reverse_rh(60_f64.to_radians(), 1280.0 / 720.0, 0.1);
    let clip = projection * DMat4::look_to_rh(eye - anchor, to.normalize(), DVec3::Y);
    let rows = clip.transpose();
    let (x, y, z, w) = (rows.x_axis, rows.y_axis, rows.z_axis, rows.w_axis);
    StageView {
        planes: [w + x, w - x, w + y, w - y, w - z, z].map(|plane| {
            let length = plane.truncate().length();
            let unit = if length > 0.0 { plane / length } else { plane };
            unit.as_vec4().to_array()
        }),
        eye: (eye - anchor).as_vec3().to_array(),
        anchor: anchor.as_vec3().to_array(),
        // 360 pixels over the tangent of 30 degrees.
        pixels_per_radian: 623.5383,
        pixels_per_edge: 8.0,
        ..bytemuck::Zeroable::zeroed()
    }
}

fn entity(levels: ClassicLevels, cull: bool) -> Instance {
    let mut instance = Instance::IDENTITY;
    instance.params[0] = levels.params(cull);
    instance
}

/// The CPU reference's levels of every patch.
fn levels(heights: &ClassicHeights, mesh: &PatchMesh, instance: &Instance, k: u32) -> Vec<Levels> {
    let scene = ClassicScene {
        heights: heights.clone(),
    };
    let view = view(k);
    (0..mesh.patches() as u32)
        .map(|number| {
            let patch = HostPatch {
                mesh,
                number,
                instance,
            };
            scene.control(&patch, &view)
        })
        .collect()
}

#[test]
fn levels_are_those_of_the_definition() {
    let eye = Vec3::new(0.0, 70.0, 0.0);
    let level = |x: f32, low: f32, high: f32| {
        classic_level(
            Vec3::new(x - 8.0, low, 0.0),
            Vec3::new(x + 8.0, high, 0.0),
            0.0,
            eye,
        )
    };
    // Under the eye, 70 m away: 32 - 31 (0.6 * 70 / 400 + 0.4 (1 - relief)).
    for (low, high, wanted) in [
        (0.0, 0.0, 32.0 - 31.0 * 0.505),
        // How high the edge lies does not count.
        (55.0, 55.0, 32.0 - 31.0 * 0.505),
        (-2.5, 2.5, 32.0 - 31.0 * 0.305),
        (10.0, 0.0, 32.0 - 31.0 * 0.105),
        (0.0, 99.0, 32.0 - 31.0 * 0.105),
    ] {
        // A handful of roundings of numbers up to 32.
        assert!(
            (level(0.0, low, high) - wanted).abs() < 1e-5,
            "{low} {high}"
        );
    }
    // 240 m along and 70 m down are 250 m: 32 - 31 (0.375 + 0.4).
    assert!((level(240.0, 3.0, 3.0) - 7.975).abs() < 1e-5);
    // 394 m along: 400.2 m away.
    assert_eq!(level(394.0, 0.0, 50.0), 1.0);
    assert!(level(393.0, 0.0, 50.0) > 13.0);
}

#[test]
fn both_sides_of_every_edge_agree() {
    let heights = made();
    let mesh = patches(&heights);
    let topology = mesh.topology();
    // 65 x 64 edges along each axis.
    assert_eq!(
        (topology.edges.len(), topology.corners.len()),
        (2 * 65 * 64, 65 * 65)
    );
    for rule in [ClassicLevels::Classic, ClassicLevels::EdgeLength] {
        for k in [0, 17, 61] {
            let mut seen = vec![Vec::new(); topology.edges.len()];
            let found = levels(&heights, &mesh, &entity(rule, false), k);
            for (own, levels) in topology.patches.iter().zip(&found) {
                for side in 0..4 {
                    let edge = (own[4 + side] & !REVERSED) as usize;
                    seen[edge].push(levels.outer[side].to_bits());
                }
                assert_eq!(levels.inner[0], levels.outer[1].max(levels.outer[3]));
                assert_eq!(levels.inner[1], levels.outer[0].max(levels.outer[2]));
            }
            assert!(
                seen.iter()
                    .all(|both| both.iter().all(|level| *level == both[0]))
            );
            assert_eq!(
                seen.iter().filter(|both| both.len() == 2).count(),
                2 * 63 * 64
            );
        }
    }
}

/// Triangles of a quad of equal spacing: a grid of (n - 2)(m - 2) cells inside, and strips between
/// each side and the row inside of it.
fn counted(levels: &Levels) -> u64 {
    let whole = |level: f32| level.clamp(1.0, 64.0).ceil() as u64;
    let sides: u64 = levels.outer.iter().map(|level| whole(*level)).sum();
    let [n, m] = levels.inner.map(whole);
    if sides == 4 && n * m == 1 {
        return 2;
    }
    let (n, m) = (n.max(2), m.max(2));
    2 * (n - 2) * (m - 2) + sides + 2 * (n - 2) + 2 * (m - 2)
}

#[test]
fn the_cpu_reference_makes_as_many_triangles_as_counted() {
    let heights = shared();
    let of_the_scene = heights.is_some();
    let heights = heights.unwrap_or_else(made);
    let mesh = Arc::new(patches(&heights));
    let mut sum = 0;
    for k in (0..120).step_by(20) {
        let entity = entity(ClassicLevels::Classic, false);
        let wanted: u64 = levels(&heights, &mesh, &entity, k)
            .iter()
            .map(counted)
            .sum();
        let made = reference(&heights, &mesh, entity, k);
        assert_eq!(u64::from(made.head.primitives), wanted, "frame {k}");
        assert_eq!(made.head.lowered, 0);
        sum += wanted;
    }
    if of_the_scene {
        // 1 298 789 over every fourth frame by a program of its own in f64; frames differ by 2 %.
        assert!((1_270_000..1_330_000).contains(&(sum / 6)), "{}", sum / 6);
    }
}

fn reference(
    heights: &ClassicHeights,
    mesh: &Arc<PatchMesh>,
    entity: Instance,
    k: u32,
) -> HostTessellation {
    let scene = ClassicScene {
        heights: heights.clone(),
    };
    let entities = [(mesh.clone(), entity)];
    tessellate_host(&TESSELLATOR, &entities, &scene, &view(k), POOLS, 1.0)
}

fn passes(gpu: &Gpu) -> StagePasses {
    let options = StageOptions {
        functions: &[FUNCTIONS],
        data: &DATA,
        ..Default::default()
    };
    StagePasses::with_options(gpu, TESSELLATOR, &options).expect("the scene's functions")
}

fn run(
    gpu: &Gpu,
    passes: &StagePasses,
    heights: &ClassicHeights,
    mesh: &Arc<PatchMesh>,
    entity: Instance,
    k: u32,
) -> Emitted {
    let entities = [(mesh.clone(), entity)];
    let mut run =
        StageRun::new(gpu, passes, CLASSIC_LAYOUT, &entities, POOLS).expect("4096 patches");
    run.set_data(&[cast_slice(heights.samples())], &DATA);
    run.set_view(view(k), 1.0);
    run.tessellate(1).expect("a run");
    run.read().expect("what was emitted")
}

#[test]
fn gpu_the_adapter_agrees_with_the_cpu_reference() {
    let Some(gpu) = for_test() else { return };
    let passes = passes(&gpu);
    let heights = shared().unwrap_or_else(made);
    let mesh = Arc::new(patches(&heights));
    let mut same = 0;
    for (rule, cull, k) in [
        (ClassicLevels::Static(5.0), false, 0),
        (ClassicLevels::Static(1.0), true, 40),
        (ClassicLevels::Classic, false, 0),
        (ClassicLevels::Classic, false, 77),
        (ClassicLevels::Classic, true, 30),
        (ClassicLevels::EdgeLength, false, 101),
    ] {
        let entity = entity(rule, cull);
        let ours = run(&gpu, &passes, &heights, &mesh, entity, k);
        let reference = reference(&heights, &mesh, entity, k);
        let what = format!("{rule:?}, cull {cull}, frame {k}");
        assert!(ours.guarded, "{what}");
        // A box that touches the frustum to the rounding of a distance may be in or out.
        let discarded = ours.head.discarded.abs_diff(reference.head.discarded);
        assert!(
            discarded <= 2,
            "{what}: {discarded} patches are seen by one alone"
        );
        assert_eq!(reference.head.discarded > 0, cull, "{what}");
        let triangles: Vec<[u32; 3]> = ours
            .indices
            .chunks_exact(3)
            .map(|t| [t[0], t[1], t[2]])
            .collect();
        if !cull {
            // One sheet without a hole: a border, and as many vertices and faces as edges but one.
            let manifold = check(&triangles, ours.vertices.len()).expect("a manifold");
            assert_eq!((manifold.borders.len(), manifold.euler), (1, 1), "{what}");
        }
        if ours.indices != reference.indices {
            // Levels differ by the rounding of distances: some edge in tens of thousands has a segment
            // more on one side.
            let (a, b) = (ours.head.primitives, reference.head.primitives);
            assert!(a.abs_diff(b) <= 64 + b / 1000, "{what}: {a} and {b}");
            continue;
        }
        same += 1;
        for (a, b) in ours.vertices.iter().zip(&reference.vertices) {
            for axis in 0..3 {
                // Heights: a handful of roundings of 110 m, on slopes of 8 at places that differ by
                // the rounding of 1024 m. Places: that rounding.
                let bound = if axis == 1 { 1e-3 } else { 1.3e-4 };
                let (x, y) = (f32::from_bits(a[axis]), f32::from_bits(b[axis]));
                assert!((x - y).abs() <= bound, "{what}: {x} and {y}");
            }
        }
    }
    assert!(same >= 2, "{same} runs with the very same triangles");
}

/// Without a shared edge's one owner the comparison above would see it: a sheet with one patch less
/// has another border.
#[test]
fn a_missing_patch_is_seen() {
    let heights = made();
    let mesh = patches(&heights);
    let inner = 5 * (64 * 20 + 20);
    let mut indices = mesh.indices().to_vec();
    indices.drain(inner..inner + 5);
    let fewer = PatchMesh::new(CLASSIC_LAYOUT, mesh.points().to_vec(), indices).expect("patches");
    let made = reference(
        &heights,
        &Arc::new(fewer),
        entity(ClassicLevels::Static(2.0), false),
        0,
    );
    let triangles: Vec<[u32; 3]> = made
        .indices
        .chunks_exact(3)
        .map(|t| [t[0], t[1], t[2]])
        .collect();
    let manifold = check(&triangles, made.vertices.len()).expect("a manifold");
    assert_eq!((manifold.borders.len(), manifold.euler), (2, 0));
}
