//! Triangles as collision takes them: indexed, f32 around an origin in f64.
//!
//! Conventions: metres; corner = origin + vertex. A tile of ground far away has its own origin, so that its
//! vertices keep their digits. Both sides of a triangle count. Triangles without area stay: they are segments or
//! points to whatever moves, and nothing to rays.

use bevy::math::{DVec3, Vec3};
use thiserror::Error;

/// How far from the origin of its mesh a vertex may be, metres: products of two such numbers stay finite in f32.
pub const FARTHEST: f32 = 1e12;

/// A list of triangles.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    origin: DVec3,
    vertices: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

/// A mesh that cannot be used.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum MeshError {
    /// A vertex that is no place.
    #[error("vertex {index} at {place} is not within {FARTHEST} m of the mesh's origin")]
    Vertex {
        /// Which.
        index: usize,
        /// Where.
        place: Vec3,
    },
    /// The origin is no place.
    #[error("a mesh has its origin at {0}, which is no place")]
    Origin(DVec3),
    /// A corner without a vertex.
    #[error("triangle {triangle} names vertex {vertex}, but there are {vertices}")]
    Index {
        /// Which.
        triangle: usize,
        /// What it names.
        vertex: u32,
        /// How many there are.
        vertices: usize,
    },
    /// More than can be numbered.
    #[error("a mesh has {0} triangles; at most 2^31 can be numbered")]
    TooMany(usize),
    /// Another number of vertices than before.
    #[error("a mesh of {expected} vertices is moved to {found}")]
    Count {
        /// How many there are.
        expected: usize,
        /// How many were given.
        found: usize,
    },
}

impl TriangleMesh {
    /// Of vertices around an origin.
    ///
    /// # Errors
    /// [`MeshError`].
    pub fn new(
        origin: DVec3,
        vertices: Vec<Vec3>,
        triangles: Vec<[u32; 3]>,
    ) -> Result<Self, MeshError> {
        if !origin.is_finite() {
            return Err(MeshError::Origin(origin));
        }
        if triangles.len() > 1 << 31 {
            return Err(MeshError::TooMany(triangles.len()));
        }
        check(&vertices)?;
        for (index, corners) in triangles.iter().enumerate() {
            for &vertex in corners {
                if vertex as usize >= vertices.len() {
                    return Err(MeshError::Index {
                        triangle: index,
                        vertex,
                        vertices: vertices.len(),
                    });
                }
            }
        }
        Ok(Self {
            origin,
            vertices,
            triangles,
        })
    }

    /// Of triangles with corners of their own, around the middle of their box.
    ///
    /// # Errors
    /// [`MeshError`].
    pub fn from_triangles(triangles: &[[DVec3; 3]]) -> Result<Self, MeshError> {
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for corner in triangles.iter().flatten() {
            (min, max) = (min.min(*corner), max.max(*corner));
        }
        let origin = if triangles.is_empty() {
            DVec3::ZERO
        } else {
            ((min + max) * 0.5).as_vec3().as_dvec3()
        };
        let corners = triangles.iter().flatten();
        let vertices = corners.map(|corner| (corner - origin).as_vec3()).collect();
        let numbers = 0..u32::try_from(triangles.len()).unwrap_or(u32::MAX);
        let indices = numbers.map(|i| [0, 1, 2].map(|corner| i.wrapping_mul(3) + corner));
        Self::new(origin, vertices, indices.collect())
    }

    /// Of a box, its triangles outwards.
    ///
    /// # Errors
    /// [`MeshError`].
    pub fn cuboid(center: DVec3, half_size: Vec3) -> Result<Self, MeshError> {
        let corner = |i: u8| {
            let side = |bit: u8| if i >> bit & 1 == 1 { 1.0 } else { -1.0 };
            Vec3::new(side(0), side(1), side(2)) * half_size
        };
        // Each side as the corners of a square, anticlockwise from outside.
        let sides: [[u32; 4]; 6] = [
            [1, 3, 7, 5],
            [0, 4, 6, 2],
            [2, 6, 7, 3],
            [0, 1, 5, 4],
            [4, 5, 7, 6],
            [0, 2, 3, 1],
        ];
        let triangles = sides
            .iter()
            .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
        Self::new(center, (0..8).map(corner).collect(), triangles.collect())
    }

    /// Where its vertices are relative to.
    #[must_use]
    pub const fn origin(&self) -> DVec3 {
        self.origin
    }

    /// Its vertices, relative to the origin.
    #[must_use]
    pub fn vertices(&self) -> &[Vec3] {
        &self.vertices
    }

    /// The vertices of each triangle.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Its vertices in f64, for volumes to be put around.
    pub fn places(&self) -> impl ExactSizeIterator<Item = DVec3> {
        let places = self.vertices.iter();
        places.map(|vertex| self.origin + vertex.as_dvec3())
    }

    /// The corners of a triangle, relative to the origin.
    ///
    /// # Panics
    /// If there is no such triangle.
    #[inline]
    #[must_use]
    pub fn local_corners(&self, triangle: u32) -> [Vec3; 3] {
        self.triangles[triangle as usize].map(|vertex| self.vertices[vertex as usize])
    }

    /// The corners of a triangle.
    ///
    /// # Panics
    /// If there is no such triangle.
    #[inline]
    #[must_use]
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.local_corners(triangle)
            .map(|corner| self.origin + corner.as_dvec3())
    }

    /// Moves the vertices.
    ///
    /// # Errors
    /// [`MeshError::Count`] and [`MeshError::Vertex`]; the mesh is then as it was.
    pub fn move_vertices(&mut self, vertices: &[Vec3]) -> Result<(), MeshError> {
        if vertices.len() != self.vertices.len() {
            return Err(MeshError::Count {
                expected: self.vertices.len(),
                found: vertices.len(),
            });
        }
        check(vertices)?;
        self.vertices.copy_from_slice(vertices);
        Ok(())
    }
}

fn check(vertices: &[Vec3]) -> Result<(), MeshError> {
    let within = |vertex: &Vec3| vertex.abs().max_element() <= FARTHEST && !vertex.is_nan();
    match vertices.iter().position(|vertex| !within(vertex)) {
        Some(index) => Err(MeshError::Vertex {
            index,
            place: vertices[index],
        }),
        None => Ok(()),
    }
}
