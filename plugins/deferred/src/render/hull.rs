//! The hulls that lights are drawn as: they enclose the unit sphere, and the unit cone or cylinder.

use bevy::math::{Vec3, ops};
use bevy::render::render_resource::{Buffer, BufferInitDescriptor, BufferUsages};
use bevy::render::renderer::RenderDevice;

/// Triangles of a hull, outwards counter-clockwise.
pub struct Hull {
    /// Corners, three a triangle.
    pub corners: Vec<[f32; 3]>,
}

/// Sides of the hull of spots.
const SIDES: usize = 12;

/// An icosahedron with each face in four, larger by as much as its faces cut into the sphere.
pub fn sphere() -> Hull {
    let golden = 0.5 * (1.0 + 5_f32.sqrt());
    let mut points = Vec::new();
    for (s, t) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        points.push(Vec3::new(0.0, s, t * golden).normalize());
        points.push(Vec3::new(s, t * golden, 0.0).normalize());
        points.push(Vec3::new(t * golden, 0.0, s).normalize());
    }
    let edge = 2.0 / (1.0 + golden * golden).sqrt();
    let near = |a: Vec3, b: Vec3| (a.distance(b) - edge).abs() < 1e-3;
    let mut faces: Vec<[Vec3; 3]> = Vec::new();
    for (i, a) in points.iter().enumerate() {
        for (j, b) in points.iter().enumerate().skip(i + 1) {
            for c in points.iter().skip(j + 1) {
                if near(*a, *b) && near(*b, *c) && near(*a, *c) {
                    let outwards = (*b - *a).cross(*c - *a).dot(*a) > 0.0;
                    faces.push(if outwards { [*a, *b, *c] } else { [*a, *c, *b] });
                }
            }
        }
    }
    let mut fine: Vec<[Vec3; 3]> = Vec::new();
    for [a, b, c] in faces {
        let [ab, bc, ca] = [a + b, b + c, c + a].map(Vec3::normalize);
        fine.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
    }
    let inside = fine
        .iter()
        .map(|[a, b, c]| (*b - *a).cross(*c - *a).normalize().dot(*a))
        .fold(f32::MAX, f32::min);
    let corners = fine
        .into_iter()
        .flatten()
        .map(|corner| (corner / inside).to_array())
        .collect();
    Hull { corners }
}

/// Two circles, closed: x and y on a circle around the axis (or its middle), z 0 at the light and 1 at the base;
/// the shader places them. A polygon around the unit circle.
pub fn spot() -> Hull {
    let around = 1.0 / ops::cos(std::f32::consts::PI / SIDES as f32);
    let at = |k: usize, z: f32| {
        let angle = std::f32::consts::TAU * (k % SIDES) as f32 / SIDES as f32;
        [ops::cos(angle) * around, ops::sin(angle) * around, z]
    };
    let mut corners = Vec::new();
    for k in 0..SIDES {
        let (a, b, c, d) = (at(k, 0.0), at(k + 1, 0.0), at(k, 1.0), at(k + 1, 1.0));

        corners.extend([
            a,
            b,
            d,
            a,
            d,
            c,
            [0.0, 0.0, 1.0],
            c,
            d,
            [0.0, 0.0, 0.0],
            b,
            a,
        ]);
    }
    Hull { corners }
}

impl Hull {
    /// As a vertex buffer.
    pub fn buffer(&self, device: &RenderDevice, label: &str) -> (Buffer, u32) {
        let buffer = device.create_buffer_with_data(&BufferInitDescriptor {
            label: Some(label),
            contents: bytemuck::cast_slice(&self.corners),
            usage: BufferUsages::VERTEX,
        });
        (buffer, self.corners.len() as u32)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Triangles of a hull as vectors.
    fn triangles(hull: &Hull) -> impl Iterator<Item = [Vec3; 3]> + '_ {
        hull.corners
            .chunks_exact(3)
            .map(|t| [t[0], t[1], t[2]].map(Vec3::from))
    }

    #[test]
    fn the_sphere_lies_inside_of_its_hull() {
        let hull = sphere();
        assert_eq!(hull.corners.len(), 3 * 80);
        for [a, b, c] in triangles(&hull) {
            let normal = (b - a).cross(c - a).normalize();
            assert!(normal.dot(a) >= 1.0 - 1e-6, "{normal}");
        }
    }

    #[test]
    fn the_hull_of_spots_is_closed_and_faces_outwards() {
        let hull = spot();
        let mut volume = 0.0;
        for [a, b, c] in triangles(&hull) {
            let normal = (b - a).cross(c - a);
            assert!(
                normal.dot(a - Vec3::new(0.0, 0.0, 0.5)) > 0.0,
                "{a} {b} {c}"
            );
            volume += a.dot(b.cross(c)) / 6.0;
        }
        // A prism around the cylinder: its twelve sides touch the unit circle.
        let exact = 12.0 * ops::tan(std::f32::consts::PI / 12.0);
        assert!((volume - exact).abs() < 1e-4, "{volume} {exact}");
    }
}
