//! Meshes of patches to start from.

use super::{PatchLayout, PatchMesh};

/// An octahedron of radius 1 around the origin whose faces are cut into `parts`² triangles each, 8
/// in all at 1; counter-clockwise from outside. Vertices normalised by `evaluate` make it a sphere.
///
/// `parts` is clamped to [1, 64]. A patch has at most 64 segments a side: take more parts where a
/// sphere fills the screen.
///
/// # Panics
/// Never: its numbers are right.
#[must_use]
pub fn octahedron(parts: u32) -> PatchMesh {
    let parts = parts.clamp(1, 64);
    let mut points = Vec::new();
    for y in [1, -1_i32] {
        // Quarter turns from +z over +x, seen from above counter-clockwise.
        let around = [[0, 1], [1, 0], [0, -1], [-1, 0], [0, 1]];
        for quarter in around.windows(2) {
            let [[ax, az], [bx, bz]] = [quarter[0], quarter[1]];
            // Point (i, j) of the face: i parts towards b, j parts towards the pole; whole numbers,
            // so that faces have the bits of their common points in common.
            let point = |i: u32, j: u32| {
                let (i, j) = (i as i32, j as i32);
                let a = parts as i32 - i - j;
                let at = |k: i32| k as f32 / parts as f32;
                [at(a * ax + i * bx), at(j * y), at(a * az + i * bz), 0.0]
            };
            for j in 0..parts {
                for i in 0..parts - j {
                    let mut push =
                        |a, b, c| points.extend(if y > 0 { [a, b, c] } else { [b, a, c] });
                    push(point(i, j), point(i + 1, j), point(i, j + 1));
                    if i + j + 2 <= parts {
                        push(point(i + 1, j), point(i + 1, j + 1), point(i, j + 1));
                    }
                }
            }
        }
    }
    PatchMesh::from_patches(PatchLayout::TRIANGLE, &points).expect("whole triangles")
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::Vec3;

    #[test]
    fn an_octahedron_faces_outwards_and_shares_everything() {
        for (parts, counts) in [(1, (6, 12, 8)), (5, (102, 300, 200))] {
            let mesh = octahedron(parts);
            let topology = mesh.topology();
            let found = (topology.corners.len(), topology.edges.len(), mesh.patches());
            assert_eq!(found, counts);
        }
        let mesh = octahedron(3);
        for patch in mesh.indices().chunks(3) {
            let [a, b, c] = [0, 1, 2].map(|k| {
                let [x, y, z, _] = mesh.points()[patch[k] as usize];
                Vec3::new(x, y, z)
            });
            assert!((b - a).cross(c - a).dot(a + b + c) > 0.0);
        }
    }
}
