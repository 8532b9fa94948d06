//! What the oracle says against what is known in closed form.
//!
//! Where a number is deterministic, the bound is 1e-12 relative, or it says why it is another. Where it is a mean of
//! random rays, the bound is some standard deviations, or what the even set of rays was measured to keep.

#![expect(clippy::disallowed_methods, reason = "closed forms in f64")]

mod arriving;
mod lens;
mod models;
mod occluded;
mod shadows;
mod traced;

use dolomite_light_oracle::model::SplitSum;
use dolomite_light_oracle::scene::{Ambient, BlinnPhong, Lamp, LampKind, Material, Object, Pose};
use dolomite_light_oracle::scene::{Scene, Shape};
use dolomite_light_oracle::shade::{Lights, Texel};
use glam::DVec3;

/// Fails unless `is` is within `bound`, relative, of `exact`.
#[track_caller]
fn close(is: f64, exact: f64, bound: f64) {
    let error = (is / exact - 1.0).abs();
    assert!(error <= bound, "{is} is not {exact}: off by {error:e}");
}

/// A white surface that reflects as Lambert has it: its radiance is `E / π`.
const WHITE: Material = Material::BlinnPhong(BlinnPhong {
    diffuse: DVec3::ONE,
    specular: DVec3::ZERO,
    exponent: 1.0,
    emissive: DVec3::ZERO,
    lobe: dolomite_light_oracle::scene::Lobe::Blinn,
    interpolation: dolomite_light_oracle::scene::Interpolation::Pixel,
});

/// Illuminance of a surface by one light.
fn illuminance(lamp: Lamp, position: DVec3, normal: DVec3) -> f64 {
    let lights = Lights::new(&[lamp], &Ambient::default(), 1.0, SplitSum::Karis);
    let texel = Texel {
        position,
        normal,
        view: normal,
        material: WHITE,
        occlusion: 1.0,
    };
    std::f64::consts::PI * lights.radiance(&texel, |_, _| true).x
}

/// A light of 1 candela.
fn candela(position: DVec3, range: f64) -> Lamp {
    Lamp::new(
        4.0 * std::f64::consts::PI,
        LampKind::Point { position, range },
    )
}

/// A scene of exact shapes.
fn exact(shapes: &[(Shape, Pose)]) -> Scene {
    Scene {
        objects: shapes
            .iter()
            .map(|(shape, pose)| Object::new(*shape, *pose, 0))
            .collect(),
        materials: vec![WHITE],
        ..Scene::default()
    }
}

/// A pose with this place and size.
fn placed(translation: DVec3, scale: DVec3) -> Pose {
    Pose {
        translation,
        scale,
        ..Pose::default()
    }
}
