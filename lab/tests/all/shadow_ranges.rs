//! The pass that chooses what shadow views draw, on whatever adapter there is.

use crate::support;

use dolomite_tessellation::render::record::record_shadow_ranges;
use dolomite_tessellation::tables::Instance;
use dolomite_tessellation::{PatchLayout, PatchMesh, Tessellator, shapes};
use dolomite_testkit::gpu::{Binding, Recorder, for_test};
use dolomite_testkit::stage::{StagePasses, StageRun};
use std::sync::Arc;
use support::by_points;

/// Half-spaces of a shadow view: x and y within ±`reach` of a centre.
fn shadow_view(centre: [f32; 2], reach: f32) -> [[f32; 4]; 5] {
    let [x, y] = centre;
    [
        [1.0, 0.0, 0.0, reach - x],
        [-1.0, 0.0, 0.0, reach + x],
        [0.0, 1.0, 0.0, reach - y],
        [0.0, -1.0, 0.0, reach + y],
        [0.0, 0.0, 0.0, 1.0],
    ]
}

/// The pass that chooses what shadow views draw: of each group of patches, from the first to the last
/// whose bounds meet the view; discarded patches count for nothing.
#[test]
fn gpu_shadow_views_draw_what_they_may_see() {
    let Some(gpu) = for_test() else { return };
    let bounds = dolomite_shaders::ShaderFile {
        path: "stage/user_bounds.wgsl",
        source: "#define_import_path dolomite::stage::user_bounds
#import dolomite::stage::api::{Patch, StageView, patch_point, stage_position}
// Around the middle of the three control points.
fn bounds(input: Patch, view: StageView) -> vec4<f32> {
    let a = stage_position(input, patch_point(input, 0u, 0u).xyz);
    let b = stage_position(input, patch_point(input, 1u, 0u).xyz);
    let c = stage_position(input, patch_point(input, 2u, 0u).xyz);
    let middle = (a + b + c) / 3.0;
    return vec4(middle, max(max(distance(a, middle), distance(b, middle)), distance(c, middle)));
}
",
    };
    let module =
        dolomite_shaders::compose_with("stage/shadow_ranges.wgsl", &["STAGE_READ"], &[bounds]);
    let kernel = gpu
        .kernel(module.expect("valid functions"), "shadow_ranges")
        .expect("a kernel");
    let passes = StagePasses::new(&gpu, Tessellator::default()).expect("passes");
    let mesh = Arc::new(shapes::octahedron(7));
    let patches = mesh.patches() as u32;
    // Level 3 everywhere; the second entity stands 10 m away and is discarded.
    let mut seen = Instance::IDENTITY;
    seen.params[0][0] = 3.0;
    let mut discarded = by_points();
    discarded.rows[0][3] = 10.0;
    let dead: Vec<[f32; 4]> = mesh
        .points()
        .iter()
        .map(|[x, y, z, _]| [*x, *y, *z, -1.0])
        .collect();
    let dead =
        PatchMesh::new(PatchLayout::TRIANGLE, dead, mesh.indices().to_vec()).expect("a mesh");
    let entities = [(mesh.clone(), seen), (Arc::new(dead), discarded)];
    let run = StageRun::new(
        &gpu,
        &passes,
        PatchLayout::TRIANGLE,
        &entities,
        [1 << 16, 1 << 17],
    );
    let run = run.expect("few patches");
    run.tessellate(1).expect("a run");
    let primitives = run.head().expect("counters").primitives;
    assert_eq!(primitives % patches, 0, "every patch has as many");
    let each = primitives / patches;

    let views = [
        shadow_view([0.0, 0.0], 5.0),
        shadow_view([0.7, 0.2], 0.15),
        shadow_view([-3.0, 0.0], 1.0),
        // Where only the discarded entity is.
        shadow_view([10.0, 0.0], 2.0),
    ];
    let mut planes = vec![[[0.0_f32; 4]; 5]; 16];
    planes[..4].copy_from_slice(&views);
    let [params, tables, data, work] = run.inputs().expect("what a pass reads");
    let mut ranges = vec![0xAB_u8; 16 * 64 * 20];
    // As in an app.
    let record: &Recorder<'_> = &|pass, pipeline, groups| {
        record_shadow_ranges(pass, pipeline, (&groups[0], None), views.len() as u32);
    };
    gpu.run_recorded(
        &kernel,
        &mut [vec![
            Binding::Uniform(&params),
            Binding::Read(&tables),
            Binding::Read(&data),
            Binding::Read(&work),
            Binding::Write(&mut ranges),
            Binding::Read(bytemuck::cast_slice(&planes)),
        ]],
        record,
    )
    .expect("the pass runs");
    let ranges: Vec<[u32; 5]> = bytemuck::pod_collect_to_vec(&ranges);

    let sphere = |patch: u32| {
        let corners = [0, 1, 2].map(|k| {
            let [x, y, z, _] = mesh.points()[mesh.indices()[patch as usize * 3 + k] as usize];
            bevy::math::Vec3::new(x, y, z)
        });
        let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
        let radius = corners.map(|c| c.distance(middle));
        (middle, radius[0].max(radius[1]).max(radius[2]))
    };
    let mut drawn = [0; 4];
    let size = (2 * patches).div_ceil(64);
    for (k, planes) in views.iter().enumerate() {
        // What lies within a thousandth of a plane may be taken or not: distances are rounded.
        let meets = |patch: u32, margin: f32| {
            let (middle, radius) = sphere(patch);
            planes.iter().all(|[a, b, c, d]| {
                middle.dot(bevy::math::Vec3::new(*a, *b, *c)) + d >= -radius + margin
            })
        };
        for group in 0..64 {
            let [count, instances, first, base, instance] = ranges[k * 64 + group as usize];
            assert_eq!((instances, base, instance), (1, 0, 0));
            let members = (group * size..(group + 1) * size).filter(|patch| *patch < patches);
            let due = |margin| {
                let seen: Vec<u32> = members
                    .clone()
                    .filter(|patch| meets(*patch, margin))
                    .collect();
                seen.first()
                    .zip(seen.last())
                    .map_or((0, 0), |(first, last)| {
                        ((last + 1 - first) * each * 3, first * each * 3)
                    })
            };
            let found = (count, if count == 0 { 0 } else { first });
            assert!(
                found == due(1e-3) || found == due(-1e-3),
                "view {k}, group {group}: {found:?}, not {:?}",
                due(0.0)
            );
            drawn[k] += count;
        }
    }
    assert_eq!(drawn[0], primitives * 3, "all of the first entity");
    assert!(drawn[1] > 0 && drawn[1] < primitives, "some: {drawn:?}");
    assert_eq!(
        drawn[2..],
        [0, 0],
        "nothing there, or nothing that is drawn"
    );
    // What no shadow view asked for is as it was.
    assert!(
        ranges[4 * 64..]
            .iter()
            .flatten()
            .all(|word| *word == 0xABAB_ABAB)
    );
}
