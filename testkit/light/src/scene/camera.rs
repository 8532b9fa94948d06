//! The camera: a pinhole, or a thin lens.

use glam::{DQuat, DVec3};

use crate::trace::Ray;

/// A perspective camera with a viewport.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// The pinhole, or the middle of the lens, in metres.
    pub position: DVec3,
    /// The camera looks along its −Z, +Y is up.
    pub rotation: DQuat,
    /// Full vertical angle of view in radians.
    pub fov_y: f64,
    /// What is nearer than this depth along −Z is not seen, in metres.
    pub near: f64,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Factor on all light but the emissive one; Bevy's `2^−EV100 / 1.2`. It is 1 for `EV100 = −log2 1.2`.
    pub exposure: f64,
    /// Without one, everything is sharp.
    pub lens: Option<Lens>,
    /// Metres a second, for shutters.
    pub velocity: DVec3,
}

/// A thin lens.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lens {
    /// Radius of the aperture in metres.
    pub radius: f64,
    /// Depth of the plane that is sharp, in metres.
    pub focus: f64,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            position: DVec3::ZERO,
            rotation: DQuat::IDENTITY,
            fov_y: std::f64::consts::FRAC_PI_4,
            near: 0.1,
            width: 64,
            height: 64,
            exposure: 1.0,
            lens: None,
            velocity: DVec3::ZERO,
        }
    }
}

impl Camera {
    /// The ray through a point of the viewport, in pixels from the top left: pixel `i` reaches from `i` to `i + 1`.
    /// Its parameter is the depth along −Z.
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        Ray::new(self.position, self.rotation * self.local(x, y))
    }

    /// The same through a point of the lens, `disc` of the unit disc: all rays of one point of the viewport meet where
    /// the pinhole's ray reaches the depth of the focus.
    pub fn lens_ray(&self, x: f64, y: f64, lens: &Lens, disc: [f64; 2]) -> Ray {
        let start = lens.radius * DVec3::new(disc[0], disc[1], 0.0);
        let direction = self.local(x, y) - start / lens.focus;
        Ray::new(
            self.position + self.rotation * start,
            self.rotation * direction,
        )
    }

    /// In the camera's space, with z = −1.
    fn local(&self, x: f64, y: f64) -> DVec3 {
        let (width, height) = (f64::from(self.width), f64::from(self.height));
        let tan = (0.5 * self.fov_y).tan();
        DVec3::new(
            (2.0 * x / width - 1.0) * tan * width / height,
            (1.0 - 2.0 * y / height) * tan,
            -1.0,
        )
    }

    /// Where a point of the world lies in the viewport, in pixels, and its depth; `None` if it is not before the camera.
    pub fn project(&self, point: DVec3) -> Option<([f64; 2], f64)> {
        let local = self.rotation.inverse() * (point - self.position);
        let depth = -local.z;
        if depth <= 0.0 {
            return None;
        }
        let (width, height) = (f64::from(self.width), f64::from(self.height));
        let tan = (0.5 * self.fov_y).tan();
        let x = 0.5 * width * (1.0 + local.x / (depth * tan * width / height));
        let y = 0.5 * height * (1.0 - local.y / (depth * tan));
        Some(([x, y], depth))
    }

    /// Radius in pixels of the circle that a thin lens makes of a point at this depth (Potmesil and Chakravarty 1981):
    /// the cone from the aperture to the plane of focus, as it cuts the image plane.
    ///
    /// ```text
    /// c = R |z − f| / (z f) · height / (2 tan(fov_y / 2))
    /// ```
    pub fn circle_of_confusion(&self, lens: &Lens, depth: f64) -> f64 {
        let pixels = f64::from(self.height) / (2.0 * (0.5 * self.fov_y).tan());
        lens.radius * (depth - lens.focus).abs() / (depth * lens.focus) * pixels
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_projected_point_lies_on_its_ray() {
        let camera = Camera {
            position: DVec3::new(3.0, -2.0, 7.0),
            rotation: DQuat::from_euler(glam::EulerRot::YXZ, 0.7, -0.3, 0.1),
            width: 320,
            height: 180,
            ..Camera::default()
        };
        let point = camera.ray(17.25, 160.5).at(9.0);
        let ([x, y], depth) = camera.project(point).unwrap();
        assert!(
            (x - 17.25).abs() < 1e-11 && (y - 160.5).abs() < 1e-11,
            "{x} {y}"
        );
        assert!((depth - 9.0).abs() < 1e-13);
        assert!(
            camera
                .project(camera.position + camera.rotation * DVec3::Z)
                .is_none()
        );
    }

    #[test]
    fn rays_of_a_lens_meet_in_the_plane_of_focus() {
        let camera = Camera::default();
        let lens = Lens {
            radius: 0.3,
            focus: 5.0,
        };
        let sharp = camera.ray(40.0, 3.0).at(5.0);
        for disc in [[1.0, 0.0], [-0.3, 0.8]] {
            let there = camera.lens_ray(40.0, 3.0, &lens, disc).at(5.0);
            assert!(there.distance(sharp) < 1e-14, "{there} {sharp}");
        }
    }
}
