//! Clips that are held to what they mean.

use super::takes::{CORNERS, Layer, Moved};
use dolomite_fbx::check::Played;
use dolomite_fbx::{Conversion, Limits, Options, Origin, convert};
use glam::{DAffine3, DQuat, DVec3};

pub const ROTATION: &str = "Lcl Rotation";
pub const TRANSLATION: &str = "Lcl Translation";
pub const SCALE: &str = "Lcl Scaling";

pub fn base(curves: Vec<Moved>) -> Layer {
    Layer {
        curves,
        ..Layer::default()
    }
}

pub fn converted(text: &str) -> Conversion {
    // The memory that files of this size get, and work for takes that are far longer than their files.
    let limits = Limits {
        work: 60_000_000,
        ..Limits::of_file(text.len())
    };
    let options = Options {
        limits: Some(limits),
        ..Options::default()
    };
    convert(text.as_bytes(), &Origin::default(), &options).unwrap_or_else(|error| panic!("{error}"))
}

/// Pseudo-random shares of a span.
pub fn shares(count: usize) -> impl Iterator<Item = f64> {
    (0..count).map(|i| (i as f64 * 0.618_033_988_749_894_9 + 0.123).fract())
}

/// The largest distance of a vertex from where `truth` has its node, at `count` times of `span`.
pub fn off(
    made: &Conversion,
    span: (f64, f64),
    count: usize,
    truth: impl Fn(f64) -> Vec<DAffine3>,
) -> f64 {
    let glb = made.to_glb().expect("a model becomes a .glb");
    let played = Played::read(&glb).expect("our own .glb is sound");
    let (_, sources) = &made.sources()[&0];
    let mut farthest = 0.0_f64;
    for share in shares(count) {
        let time = span.0 + (span.1 - span.0) * share;
        let (shapes, _) = played.at(Some(0), time - span.0);
        let places = truth(time);
        assert_eq!(shapes.len(), places.len());
        for (shape, place) in shapes.iter().zip(&places) {
            for (point, &source) in shape.points.iter().zip(sources) {
                let wanted = place.transform_point3(DVec3::from(CORNERS[source as usize]));
                farthest = farthest.max((*point - wanted).length());
            }
        }
    }
    farthest
}

/// Within the bound, and no further off than stated; a hundredth of the bound is f32's, in vertices.
pub fn hold(
    text: &str,
    span: (f64, f64),
    count: usize,
    truth: impl Fn(f64) -> Vec<DAffine3>,
) -> Conversion {
    let made = converted(text);
    let clip = &made.report.clips[0];
    let off = off(&made, span, count, truth);
    let rounding = 0.01 * made.report.bound + 3e-7;
    assert!(
        off <= clip.error + rounding,
        "{off:e} m off, {:e} stated, {:e} allowed",
        clip.error,
        made.report.bound
    );
    assert!(
        clip.keyed_error <= made.report.bound,
        "{:e} of {:e}",
        clip.keyed_error,
        made.report.bound
    );
    made
}

pub fn turned(degrees: DVec3) -> DQuat {
    let [x, y, z] = degrees.to_array().map(f64::to_radians);
    DQuat::from_rotation_z(z) * DQuat::from_rotation_y(y) * DQuat::from_rotation_x(x)
}

pub fn rotated(degrees: DVec3) -> DAffine3 {
    DAffine3::from_quat(turned(degrees))
}
