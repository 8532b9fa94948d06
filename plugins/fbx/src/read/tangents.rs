//! Tangents for normal maps, by MikkTSpace, which bakers of normal maps use.

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};

/// Corners of triangles, three a triangle.
pub(crate) struct Corners<'a> {
    pub(crate) positions: &'a [[f32; 3]],
    pub(crate) normals: &'a [[f32; 3]],
    pub(crate) uvs: &'a [[f32; 2]],
}

struct Work<'a> {
    corners: &'a Corners<'a>,
    tangents: Vec<[f32; 4]>,
}

impl Geometry for Work<'_> {
    fn num_faces(&self) -> usize {
        self.tangents.len() / 3
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.corners.positions[face * 3 + corner]
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.corners.normals[face * 3 + corner]
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        self.corners.uvs[face * 3 + corner]
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        if let Some(space) = space {
            let [x, y, z, side] = space.tangent_encoded();
            // V grows downwards in glTF and upwards where the method was defined: the bitangent is
            // the other way round.
            self.tangents[face * 3 + corner] = [x, y, z, -side];
        }
    }
}

/// One tangent a corner, of unit length and at right angles to the normal.
pub(crate) fn tangents(corners: &Corners) -> Vec<[f32; 4]> {
    let mut work = Work {
        corners,
        tangents: vec![[0.0; 4]; corners.positions.len()],
    };
    // Its error type has no value.
    if generate_tangents(&mut work).is_err() {
        work.tangents.fill([0.0; 4]);
    }
    for (tangent, normal) in work.tangents.iter_mut().zip(corners.normals) {
        let [x, y, z, side] = *tangent;
        let length = (x * x + y * y + z * z).sqrt();
        let side = if side < 0.0 { -1.0 } else { 1.0 };
        *tangent = match (length - 1.0).abs() < 1e-3 {
            true => [x / length, y / length, z / length, side],
            false => {
                let [x, y, z] = beside(*normal);
                [x, y, z, side]
            }
        };
    }
    work.tangents
}

/// A unit vector at right angles to a unit vector, for corners whose texture coordinates say nothing.
fn beside(n: [f32; 3]) -> [f32; 3] {
    let n = glam::Vec3::from(n);
    n.any_orthonormal_vector().to_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(uvs: [[f32; 2]; 3]) -> Vec<[f32; 4]> {
        tangents(&Corners {
            positions: &[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]],
            normals: &[[0.0, 0.0, 1.0]; 3],
            uvs: &uvs,
        })
    }

    #[test]
    fn tangents_follow_u_and_bitangents_upwards() {
        // glTF's V grows downwards; a picture that stands upright has bitangents upwards (+Y).
        for [x, y, z, side] in square([[0.0, 1.0], [1.0, 1.0], [0.0, 0.0]]) {
            assert!((x - 1.0).abs() < 1e-6 && y.abs() < 1e-6 && z.abs() < 1e-6);
            assert_eq!(side, 1.0, "cross(n, t) * side must be +Y");
        }
    }

    #[test]
    fn without_texture_coordinates_they_are_still_unit_vectors() {
        for [x, y, z, side] in square([[0.0; 2]; 3]) {
            assert!((x * x + y * y + z * z - 1.0).abs() < 1e-6);
            assert_eq!(side.abs(), 1.0);
            assert!(z.abs() < 1e-6, "at right angles to the normal");
        }
    }
}
