//! What the heat map of the ground's error says of a point, against what the lab measures of it in f64 through the same
//! camera. (`plugins/ground/tests/all/inspect.rs` holds the pixels of the adapter to rays through its own triangles.)

use bevy::math::{DMat4, DVec2, DVec3, Vec2, Vec3};
use dolomite_ground::detail::{DetailLattice, Metric};
use dolomite_ground::inspection::InspectionParams;
use dolomite_lab::scenes::camera::Camera;
use dolomite_lab::scenes::cameras::over;
use dolomite_lab::scenes::terrains;
use dolomite_lab::scenes::truth::Truth;
use dolomite_testkit::random::Random;

/// Places a camera.
const PLACES: usize = 2000;
/// Pixels.
const TAU: f64 = 4.0;

/// As the renderer has them: relative to an anchor near the eye, on whole metres, in f32.
fn params(camera: &Camera, lattice: &DetailLattice) -> (InspectionParams, DVec3) {
    let view = camera.view();
    let anchor = camera.eye.floor();
    let size = camera.size.as_dvec2();
    let aspect = size.x / size.y;
    // Depth is reversed; pixels do not depend on it.
    let projection = match camera.orthographic {
        Some(height) => {
            let (x, y) = (0.5 * height * aspect, 0.5 * height);
            DMat4::orthographic_rh(-x, x, -y, y, 1e6, camera.near)
        }
        None => DMat4::perspective_infinite_reverse_rh(camera.fov_y, aspect, camera.near),
    };
    let from_anchor = DMat4::look_to_rh(camera.eye - anchor, view.forward, view.up);
    let clip = (projection * from_anchor).as_mat4();
    let metric = Metric::ErrorBound { pixels: TAU as f32 };
    let size = Vec2::new(camera.size.x as f32, camera.size.y as f32);
    (
        InspectionParams::new(lattice, anchor, clip, size, metric),
        anchor,
    )
}

#[test]
fn a_pixel_of_the_heat_map_is_the_error_that_the_lab_measures() {
    for (number, terrain) in terrains::all(5).iter().enumerate() {
        let truth = Truth::new(terrain);
        let extent = terrain.extent();
        let lattice = DetailLattice::new(extent, 1.0);
        let mut random = Random::new(number as u32);
        for camera in over(terrain, 5 + number as u32) {
            let (params, anchor) = params(&camera, &lattice);
            assert_eq!(f64::from(params.tolerance), TAU);
            let view = camera.view();
            let (mut all, mut near, mut off) = (0_u32, 0_u32, 0_u32);
            for _ in 0..400 * PLACES {
                if all as usize == PLACES {
                    break;
                }
                // More of them where the camera stands than far away.
                let away = 4000.0 * random.unit() * random.unit() * random.unit();
                let turn = std::f64::consts::TAU * random.unit();
                let xz = DVec2::new(camera.eye.x, camera.eye.z) + DVec2::from_angle(turn) * away;
                if !extent.contains(xz) {
                    continue;
                }
                let there = DVec3::new(xz.x, truth.height(xz).max(truth.sea()), xz.y);
                // Drawn up to one and a half tolerances off.
                let Some(a_metre) = view.pixels(there, there + DVec3::Y) else {
                    continue;
                };
                let up = 1.5 * TAU * random.signed_unit() / a_metre.max(1e-3);
                let drawn = there + DVec3::Y * up;
                if !view.sees(drawn) || !view.sees(there) {
                    continue;
                }
                let Some(expected) = view.pixels(there, drawn) else {
                    continue;
                };
                let point: Vec3 = (drawn - anchor).as_vec3();
                let height = (there.y - anchor.y) as f32;
                let found = f64::from(params.pixels(point, height - point.y));
                all += 1;
                near += u32::from((found - expected).abs() <= 0.01 * TAU);
                // A picture half as high again would be seen.
                off += u32::from((1.5 * found - expected).abs() <= 0.01 * TAU);
            }
            let share = f64::from(near) / f64::from(all.max(1));
            println!("ground {number}, {camera:?}: {share:.4} of {all} places");
            assert!(all > 100, "{camera:?} sees nothing: {all}");
            assert!(
                share >= 0.99,
                "{share} of {all} within a hundredth of the tolerance"
            );
            assert!(f64::from(off) < 0.2 * f64::from(all), "anything would do");
        }
    }
}
