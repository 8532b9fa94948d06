//! Lights and cameras.

use super::convert::finite;
use super::frame::Frame;
use crate::model::{Camera, Light, LightKind, Projection};
use crate::report::Report;
use ufbx::{ApertureMode, LightDecay, LightType, ProjectionMode};

/// A light, if glTF's extension knows its kind.
pub(crate) fn read_light(light: &ufbx::Light, report: &mut Report) -> Option<Light> {
    let name = light.element.name.to_string();
    let kind = match light.type_ {
        LightType::Directional => LightKind::Directional,
        LightType::Point => LightKind::Point,
        LightType::Spot => spot(light),
        LightType::Area | LightType::Volume => {
            report.lose(
                "light-kind",
                &name,
                "area and volume lights are not in glTF",
            );
            return None;
        }
    };
    if !matches!(light.decay, LightDecay::Quadratic) && !matches!(kind, LightKind::Directional) {
        let detail = "glTF's lights fade with the square of the distance; this one does not";
        report.lose("light-decay", &name, detail);
    }
    let (colour, intensity) = shine(light);
    if light.cast_light && colour.iter().any(|c| *c < 0.0) {
        let detail = "takes light away, which glTF's lights cannot; there it gives none";
        report.lose("light-negative", &name, detail);
    }
    let colour = colour.map(|c| c.max(0.0));
    // glTF's colours end at 1; what is above is in the intensity.
    let most = colour.into_iter().fold(1.0, f64::max);
    Some(Light {
        name,
        colour: colour.map(|c| finite(c / most)),
        intensity: match light.cast_light {
            true => finite(intensity * most),
            false => 0.0,
        },
        kind,
    })
}

/// Colour and intensity of a light, the second not below 0.
fn shine(light: &ufbx::Light) -> ([f64; 3], f64) {
    let intensity = f64::from(finite(light.intensity));
    let sign = if intensity < 0.0 { -1.0 } else { 1.0 };
    let colour = [light.color.x, light.color.y, light.color.z];
    (colour.map(|c| sign * f64::from(finite(c))), intensity.abs())
}

/// The extension wants 0 <= inner < outer <= a quarter turn; FBX says whole angles in degrees.
fn spot(light: &ufbx::Light) -> LightKind {
    let quarter = std::f64::consts::FRAC_PI_2;
    let half = |degrees: f64| (degrees.to_radians() / 2.0).clamp(0.0, quarter);
    let outer = half(light.outer_angle).max(1e-3);
    let inner = half(light.inner_angle).min(outer * 0.999);
    LightKind::Spot {
        inner: finite(inner),
        outer: finite(outer).min(std::f32::consts::FRAC_PI_2),
    }
}

/// What FBX's own SDK gives a camera that says nothing: near and far in the file's unit, degrees.
const NEAR: f64 = 10.0;
const FAR: f64 = 4000.0;
const FIELD: f64 = 25.115;
/// Farther than this is as good as infinitely far, and f32 still holds it; metres.
const FARTHEST: f64 = 1e30;
/// An orthographic camera needs an end: metres.
const FAR_ENOUGH: f64 = 1e9;

/// A camera. ufbx has scaled its lengths to metres already; `unit` is what it scaled them by, for what the
/// file does not say.
pub(crate) fn read_camera(camera: &ufbx::Camera, unit: f64, report: &mut Report) -> Camera {
    let name = camera.element.name.to_string();
    let frame = Frame::of(camera);
    let mut projection = match camera.projection_mode {
        ProjectionMode::Perspective => perspective(camera, &frame),
        ProjectionMode::Orthographic => {
            let [x, y] = frame
                .orthographic
                .map(|size| finite(sound(size / 2.0, 15.0 * unit).clamp(1e-30, FARTHEST)));
            Projection::Orthographic(x, y)
        }
    };
    let (near, far) = planes(camera, unit, &name, report);
    if let (Projection::Perspective(_, aspect), true) = (&mut projection, aspect_is_lost(camera)) {
        *aspect = finite(16.0 / 9.0);
        let detail = "says no width over height; 16 : 9 is taken";
        report.lose("camera-aspect", &name, detail);
    }
    let number = |name| {
        let prop = ufbx::find_prop(&camera.element.props, name);
        prop.map_or(0.0, |prop| prop.value_vec4.x)
    };
    let shift = ["FilmOffsetX", "FilmOffsetY"].map(number);
    if shift != [0.0, 0.0] {
        let detail = format!(
            "its film is shifted by {} and {} inches, which glTF's cameras are not",
            shift[0], shift[1]
        );
        report.lose("camera-shift", &name, detail);
    }
    for property in ["Roll", "TurnTable", "FilmRollValue"] {
        let degrees = number(property);
        if degrees != 0.0 {
            let detail = format!(
                "its {property} is {degrees} degrees, which glTF's cameras do not have; it is not turned by it"
            );
            report.lose("camera-roll", &name, detail);
        }
    }
    Camera {
        name,
        projection,
        near,
        far,
    }
}

fn sound(x: f64, without: f64) -> f64 {
    if x.is_finite() && x > 0.0 { x } else { without }
}

fn aspect_is_lost(camera: &ufbx::Camera) -> bool {
    sound(camera.aspect_ratio, 0.0) == 0.0
        && !matches!(camera.aperture_mode, ApertureMode::HorizontalAndVertical)
}

/// Vertical angle and width over height. Where a file gives both angles they say the ratio too; else it
/// is that of the picture.
fn perspective(camera: &ufbx::Camera, frame: &Frame) -> Projection {
    let field = sound(frame.vertical_degrees, FIELD).clamp(0.1, 179.0);
    let both = matches!(camera.aperture_mode, ApertureMode::HorizontalAndVertical);
    let tangents = camera.field_of_view_tan;
    let aspect = match both {
        true => sound(tangents.x / tangents.y, 1.0),
        false => sound(frame.aspect, 1.0),
    };
    Projection::Perspective(finite(field.to_radians()), finite(aspect.clamp(1e-6, 1e6)))
}

/// Distances of the near and the far plane, metres, as glTF wants them: 0 < near < far.
fn planes(camera: &ufbx::Camera, unit: f64, name: &str, report: &mut Report) -> (f32, f32) {
    let (wanted_near, wanted_far) = (camera.near_plane, camera.far_plane);
    // What is not there is 0 here, and 0 is no distance that glTF's projections could have.
    let near = sound(wanted_near, NEAR * unit).min(FARTHEST / 4.0);
    let far = match wanted_far > 0.0 {
        true => wanted_far,
        false => FAR * unit,
    };
    let ends = !matches!(camera.projection_mode, ProjectionMode::Perspective);
    let far = match (far >= FARTHEST, ends) {
        (true, false) => f64::INFINITY,
        (true, true) => FAR_ENOUGH.max(near * 2.0),
        (false, _) => far,
    };
    let (first, last) = (finite(near).max(f32::MIN_POSITIVE), far as f32);
    let turned = first >= last;
    if turned || wanted_near < 0.0 || wanted_near.is_nan() || wanted_far.is_nan() {
        let detail = format!(
            "shows from {wanted_near:e} m to {wanted_far:e} m in the file, which glTF cannot; other distances stand in"
        );
        report.lose("camera-planes", name, detail);
    }
    match turned {
        true => (first, first * 2.0),
        false => (first, last),
    }
}
