//! A ray, and what its tests against boxes and triangles need.

use glam::DVec3;

/// Points `origin + t direction`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// At t = 0.
    pub origin: DVec3,
    /// Any length but 0.
    pub direction: DVec3,
    pub(super) inverse: DVec3,
    /// The axis along which the direction is longest last.
    axes: [usize; 3],
    shear: DVec3,
}

impl Ray {
    /// A ray with a direction of any length.
    pub fn new(origin: DVec3, direction: DVec3) -> Self {
        let a = direction.abs();
        let z = if a.x > a.y {
            if a.x > a.z { 0 } else { 2 }
        } else if a.y > a.z {
            1
        } else {
            2
        };
        let (mut x, mut y) = ((z + 1) % 3, (z + 2) % 3);
        // Keeps the winding.
        if direction[z] < 0.0 {
            std::mem::swap(&mut x, &mut y);
        }
        Self {
            origin,
            direction,
            inverse: direction.recip(),
            axes: [x, y, z],
            shear: DVec3::new(
                direction[x] / direction[z],
                direction[y] / direction[z],
                1.0 / direction[z],
            ),
        }
    }

    /// The point at `t`.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + t * self.direction
    }

    /// Woop, Benthin, Wald, "Watertight ray/triangle intersection" (JCGT 2013): two triangles that share an edge leave no
    /// gap there, because the edge's determinant is the same for both but for its sign. Returns t, the weights of the
    /// second and third corner, and whether the corners are seen counter-clockwise. No hit for a triangle that is seen
    /// exactly from its side or has no area.
    pub(super) fn triangle(&self, corners: &[DVec3; 3]) -> Option<(f64, [f64; 2], bool)> {
        let [x, y, z] = self.axes;
        let sheared = corners.map(|corner| {
            let p = corner - self.origin;
            (
                p[x] - self.shear.x * p[z],
                p[y] - self.shear.y * p[z],
                self.shear.z * p[z],
            )
        });
        let [a, b, c] = sheared;
        let u = c.0 * b.1 - c.1 * b.0;
        let v = a.0 * c.1 - a.1 * c.0;
        let w = b.0 * a.1 - b.1 * a.0;
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let det = u + v + w;
        if det == 0.0 || !det.is_finite() {
            return None;
        }
        let t = (u * a.2 + v * b.2 + w * c.2) / det;
        t.is_finite().then(|| (t, [v / det, w / det], det > 0.0))
    }
}
