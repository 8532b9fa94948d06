//! Lights and cameras.

use super::convert::finite;
use crate::model::{Camera, Light, LightKind, Projection};
use crate::report::Report;
use ufbx::{LightDecay, LightType, ProjectionMode};

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
    Some(Light {
        name,
        colour: [light.color.x, light.color.y, light.color.z].map(|c| finite(c).clamp(0.0, 1.0)),
        intensity: finite(light.intensity).max(0.0),
        kind,
    })
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

/// A camera; `unit` is what ufbx scaled lengths by, which it does not do to cameras.
pub(crate) fn read_camera(camera: &ufbx::Camera, unit: f64) -> Camera {
    let sound = |x: f64, without: f64| if x.is_finite() && x > 0.0 { x } else { without };
    let near = sound(camera.near_plane * unit, 0.1);
    let far = sound(camera.far_plane * unit, 1000.0);
    let projection = match camera.projection_mode {
        ProjectionMode::Perspective => {
            let fov = sound(camera.field_of_view_deg.y, 45.0).clamp(0.1, 179.0);
            Projection::Perspective(
                finite(fov.to_radians()),
                finite(sound(camera.aspect_ratio, 16.0 / 9.0)),
            )
        }
        ProjectionMode::Orthographic => {
            let size = camera.orthographic_size;
            Projection::Orthographic(
                finite(sound(size.x * unit / 2.0, 1.0)),
                finite(sound(size.y * unit / 2.0, 1.0)),
            )
        }
    };
    Camera {
        name: camera.element.name.to_string(),
        projection,
        near: finite(near),
        far: finite(far.max(near * 1.001 + 1e-3)),
    }
}
