//! Meshes of patches to start from.

use super::{PatchLayout, PatchMesh};

/// An octahedron of radius 1 around the origin: 8 triangles, counter-clockwise from outside.
/// Vertices normalised by `evaluate` make it a sphere.
///
/// # Panics
/// Never: its numbers are right.
#[must_use]
pub fn octahedron() -> PatchMesh {
    let mut points = Vec::new();
    for y in [1.0, -1.0_f32] {
        // Quarter turns from +z over +x, seen from above counter-clockwise.
        let around = [[0.0, 1.0], [1.0, 0.0], [0.0, -1.0], [-1.0, 0.0], [0.0, 1.0]];
        for quarter in around.windows(2) {
            let [a, b] = [quarter[0], quarter[1]].map(|[x, z]| [x, 0.0, z, 0.0]);
            let top = [0.0, y, 0.0, 0.0];
            points.extend(if y > 0.0 { [a, b, top] } else { [b, a, top] });
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
        let mesh = octahedron();
        let topology = mesh.topology();
        assert_eq!(
            (topology.corners.len(), topology.edges.len(), mesh.patches()),
            (6, 12, 8)
        );
        for patch in mesh.indices().chunks(3) {
            let [a, b, c] = [0, 1, 2].map(|k| {
                let [x, y, z, _] = mesh.points()[patch[k] as usize];
                Vec3::new(x, y, z)
            });
            assert!((b - a).cross(c - a).dot(a + b + c) > 0.0);
        }
    }
}
