//! Cameras without perspective: hulls beyond their far plane, and light along the one direction that they look in.

use bevy::prelude::*;
use dolomite_testkit::light::{self as support, WAYS};

use super::hostile::{check, floor, lamp, torch};

/// A far plane that the hulls of lights reach beyond: where it cut off their back faces, what they cover stayed dark.
#[test]
fn hulls_that_reach_beyond_the_far_plane_are_not_cut_gpu() {
    let Some(mut app) = support::app(true) else {
        return;
    };
    floor(&mut app);
    let flat = |far| {
        Projection::Orthographic(OrthographicProjection {
            near: 0.0,
            far,
            scale: 0.1,
            ..OrthographicProjection::default_3d()
        })
    };
    let eye = Transform::from_xyz(0.0, 8.0, 0.0).looking_to(Vec3::NEG_Y, Vec3::NEG_Z);
    let camera = support::camera(&mut app, [64, 64], eye, flat(9.0));
    // The light is 6 m away and reaches 2.9 m, the floor is 8 m away; the hull of a cone of 60 degrees reaches 5.9 m.
    for outer_angle in [0.8, 1.04, 1.5] {
        let (light, _) = torch(|l| (l.range, l.outer_angle) = (2.9, outer_angle));
        for towards in [Vec3::new(1.0, -1.0, 0.0), Vec3::new(1.0, -0.5, 0.0)] {
            let place = Transform::from_xyz(0.0, 2.0, 0.0).looking_to(towards, Vec3::Y);
            let light = app.world_mut().spawn((light, place)).id();
            for far in [8.3, 9.0, 20.0] {
                app.world_mut().entity_mut(camera).insert(flat(far));
                check(&mut app, camera, &WAYS);
            }
            app.world_mut().despawn(light);
        }
    }
}

/// A light from exactly opposite the eye has no direction halfway to it; it lights nothing that the eye sees, and takes
/// nothing from what else does.
#[test]
fn a_sun_exactly_behind_what_is_seen_blacks_nothing_out_gpu() {
    let Some(mut app) = support::app(true) else {
        return;
    };
    let shape = Cuboid::new(1.6, 1.6, 1.6);
    let mesh = app
        .world_mut()
        .resource_mut::<Assets<Mesh>>()
        .add(shape.mesh().build());
    let mut materials = app.world_mut().resource_mut::<Assets<StandardMaterial>>();
    let [plain, coated] = [0.0, 0.5].map(|clearcoat| {
        materials.add(StandardMaterial {
            clearcoat,
            ..default()
        })
    });
    // No side is seen end on.
    let turned = Quat::from_euler(EulerRot::XYZ, 0.5, 0.6, 0.0);
    for (x, material) in [(-1.5, plain), (1.5, coated)] {
        let place = Transform::from_xyz(x, 0.0, 0.0).with_rotation(turned);
        app.world_mut()
            .spawn((Mesh3d(mesh.clone()), MeshMaterial3d(material), place));
    }
    let (lamp, _) = lamp(|_| {});
    app.world_mut()
        .spawn((lamp, Transform::from_xyz(0.0, 0.0, 3.0)));
    let flat = Projection::Orthographic(OrthographicProjection {
        scale: 0.1,
        ..OrthographicProjection::default_3d()
    });
    let camera = support::camera(&mut app, [64, 64], Transform::from_xyz(0.0, 0.0, 5.0), flat);
    let without = WAYS.map(|way| support::lit_by(&mut app, camera, Some(way)));
    let sun = DirectionalLight::default();
    app.world_mut()
        .spawn((sun, Transform::default().looking_to(Vec3::Z, Vec3::Y)));
    for (way, without) in WAYS.iter().zip(&without) {
        assert!(without.lit() > 300, "{way:?}");
        let with = support::lit_by(&mut app, camera, Some(*way));
        let apart = with.relative_difference(without, 1e-3);
        assert!(apart <= 1e-5 && with.nonsense() == 0, "{way:?}: {apart}");
    }
}
