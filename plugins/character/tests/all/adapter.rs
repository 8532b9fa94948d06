//! Skinning from the palette on whatever adapter there is, against the CPU reference in f32 and the truth in f64:
//! every vertex of every mesh.

use crate::support;

use bevy::math::Vec3;
use dolomite_character::crowd::{CrowdFigure, Palette};
use dolomite_testkit::gpu::for_test;
use dolomite_testkit::skinning::{Probe, truth};
use support::person;

fn greatest(errors: &[f64]) -> f64 {
    errors.iter().copied().fold(0.0, f64::max)
}

#[test]
fn every_vertex_is_where_the_cpu_reference_has_it() {
    let Some(gpu) = for_test() else { return };
    let probe = Probe::new(gpu).unwrap();
    let mut rigs = vec![person::rig_with_mesh()];
    rigs.extend(support::knight());
    for rig in &rigs {
        let clips: Vec<usize> = (0..rig.clips.len()).collect();
        let palette = Palette::bake(rig, 0, &clips, 30.0).unwrap();
        let distances = probe.measure(&palette, &rig.meshes, 21).unwrap();
        let [reference, exact, normals] =
            [&distances.reference, &distances.exact, &distances.normals]
                .map(|errors| greatest(errors));
        eprintln!(
            "{} vertices on {}: reference {reference:.2e} m, f64 {exact:.2e} m, normals {normals:.2e}",
            distances.reference.len(),
            probe.device()
        );
        // The bound.
        assert!(
            reference <= 1e-5 && exact <= 1e-5,
            "{reference:e} m, {exact:e} m"
        );
        // An inverse square root of the GPU may be off by 2 ulp, directions by some more roundings.
        assert!(normals <= 5e-6, "{normals:e}");
        // A wrong joint is seen: the same figure with every joint the next one.
        let mut wrong = palette.clone();
        wrong.rows.rotate_left(3);
        let mesh = &rig.meshes[0];
        let figure = CrowdFigure::new(Vec3::ZERO, 0.0, palette.frame(0, 0.1, true), 0);
        let answers = probe.run(&wrong, mesh, &[figure]).unwrap();
        let off: Vec<f64> = (0..mesh.positions.len())
            .map(|vertex| {
                let place = answers[vertex][0].as_dvec3();
                place.distance(truth(&palette, mesh, vertex, &figure))
            })
            .collect();
        assert!(greatest(&off) > 1e-3, "{off:?}");
    }
}
