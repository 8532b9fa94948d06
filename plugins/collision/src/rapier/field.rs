//! A tile as Rapier meets it: triangles that know those beyond the border.
//!
//! Parry keeps bodies from catching on edges between flush triangles by holding the normal of a contact between that
//! of the triangle and those of its neighbours. Its own height field has none beyond its border, where it allows 45°
//! outwards, so that a ball that rolls onto a tile is braked by its edge; and where cells are cut from north-west to
//! south-east it asks triangles that share a corner alone. This shape has the samples one step around the tile, and
//! asks those that share the edge. Contacts are therefore to the bit those of one field without borders.

use super::diagonals::Diagonals;
use bevy::math::{IVec2, Vec3};
use bevy_rapier3d::parry::bounding_volume::{Aabb, BoundingSphere};
use bevy_rapier3d::parry::mass_properties::MassProperties;
use bevy_rapier3d::parry::math::{Pose, Vector};
use bevy_rapier3d::parry::partitioning::{Bvh, BvhBuildStrategy};
use bevy_rapier3d::parry::query::details::NormalConstraints;
use bevy_rapier3d::parry::query::{PointProjection, PointQuery, Ray, RayCast, RayIntersection};
use bevy_rapier3d::parry::shape::{
    CompositeShape, FeatureId, HeightField, HeightFieldCellStatus, Shape, ShapeType, Triangle,
    TrianglePseudoNormals, TypedShape,
};
use bevy_rapier3d::parry::utils::Array2;
use std::f32::consts::FRAC_PI_4;

/// Triangles of a tile around its middle, those of a cell one after the other.
#[derive(Clone)]
pub(super) struct TileShape {
    /// Parry's own, for rays, points and continuous collision detection, where normals do not count.
    field: HeightField,
    /// Those of the tile and of one step around it, columns along Z together.
    samples: Vec<f32>,
    cells: i32,
    step: f32,
    /// The first cell, on the lattice of the world.
    first: IVec2,
    diagonals: Diagonals,
    bvh: Bvh,
}

/// What a side of a tile of `cells` has of samples with those of one step around it.
pub(super) const fn around(cells: i32) -> i32 {
    cells + 3
}

/// Which way the two neighbours of a triangle lie that are not of its cell: of a cell cut from north-west to south-east
/// the left triangle has the sides in the west and south, of another those in the west and north.
const fn neighbours(falls: bool, right: bool) -> [IVec2; 2] {
    match (falls, right) {
        (true, false) => [IVec2::NEG_X, IVec2::Y],
        (true, true) => [IVec2::X, IVec2::NEG_Y],
        (false, false) => [IVec2::NEG_X, IVec2::NEG_Y],
        (false, true) => [IVec2::X, IVec2::Y],
    }
}

impl TileShape {
    /// Of samples of the tile whose first cell is `first`, and of one step around it.
    pub fn new(
        samples: Vec<f32>,
        cells: i32,
        step: f32,
        first: IVec2,
        diagonals: Diagonals,
    ) -> Self {
        let row = around(cells);
        let corners = cells as usize + 1;
        let own =
            (1..=cells + 1).flat_map(|x| (1..=cells + 1).map(move |z| (x * row + z) as usize));
        let heights = own.map(|at| samples[at]).collect();
        let side = step * cells as f32;
        let mut field = HeightField::new(
            Array2::new(corners, corners, heights),
            Vec3::new(side, 1.0, side),
        );
        for x in 0..cells {
            for z in 0..cells {
                if diagonals.falls(first + IVec2::new(x, z)) {
                    let falls = HeightFieldCellStatus::ZIGZAG_SUBDIVISION;
                    field.set_cell_status(z as usize, x as usize, falls);
                }
            }
        }
        let mut shape = Self {
            field,
            samples,
            cells,
            step,
            first,
            diagonals,
            bvh: Bvh::new(),
        };
        let count = 2 * (cells * cells) as u32;
        let leaves = (0..count).map(|id| (id as usize, shape.part(id).0.local_aabb()));
        let bvh = Bvh::from_iter(BvhBuildStrategy::Binned, leaves);
        shape.bvh = bvh;
        shape
    }

    /// Bytes that it holds.
    pub fn bytes(&self) -> u64 {
        let cells = (self.cells * self.cells) as usize;
        let heights = size_of_val(self.field.heights().data());
        let samples = size_of_val(self.samples.as_slice());
        (samples + heights + cells + self.bvh.total_memory_size()) as u64
    }

    fn corner(&self, at: IVec2) -> Vector {
        let height = self.samples[((at.x + 1) * around(self.cells) + at.y + 1) as usize];
        // Exact: half of a side is a multiple of half a step.
        let half = self.step * self.cells as f32 * 0.5;
        Vec3::new(
            at.x as f32 * self.step - half,
            height,
            at.y as f32 * self.step - half,
        )
    }

    /// A triangle of a cell, from one beside the tile on, with its front upwards.
    fn triangle(&self, cell: IVec2, right: bool) -> Triangle {
        let at = |x, z| self.corner(cell + IVec2::new(x, z));
        let (nw, ne, sw, se) = (at(0, 0), at(1, 0), at(0, 1), at(1, 1));
        match (self.falls(cell), right) {
            (true, false) => Triangle::new(nw, sw, se),
            (true, true) => Triangle::new(nw, se, ne),
            (false, false) => Triangle::new(nw, sw, ne),
            (false, true) => Triangle::new(sw, se, ne),
        }
    }

    fn falls(&self, cell: IVec2) -> bool {
        self.diagonals.falls(self.first + cell)
    }

    /// A triangle and what its normals lie between, by its number.
    fn part(&self, id: u32) -> (Triangle, TrianglePseudoNormals) {
        let (cell, right) = (id as i32 / 2, id & 1 == 1);
        let cell = IVec2::new(cell / self.cells, cell % self.cells);
        let triangle = self.triangle(cell, right);
        let face = triangle.normal().unwrap_or(Vec3::Y);
        let halfway = |other: Triangle| {
            let normal = other.normal().unwrap_or(face);
            // Both point upwards: they are never opposite.
            (face + normal).normalize_or(face)
        };
        let falls = self.falls(cell);
        let [one, two] = neighbours(falls, right).map(|by| {
            let there = cell + by;
            // West of an edge along Z is a right triangle, east of it a left one; north of one along X is the left one
            // of a cell that falls and the right one of another, south of it the other way round.
            let its_right = match by {
                IVec2::NEG_X => true,
                IVec2::X => false,
                IVec2::NEG_Y => !self.falls(there),
                _ => self.falls(there),
            };
            halfway(self.triangle(there, its_right))
        });
        let edges = [one, two, halfway(self.triangle(cell, !right))];
        (triangle, TrianglePseudoNormals { face, edges })
    }
}

impl CompositeShape for TileShape {
    fn map_part_at(
        &self,
        id: u32,
        f: &mut dyn FnMut(Option<&Pose>, &dyn Shape, Option<&dyn NormalConstraints>),
    ) {
        let (triangle, normals) = self.part(id);
        f(None, &triangle, Some(&normals));
    }

    fn bvh(&self) -> &Bvh {
        &self.bvh
    }
}

impl RayCast for TileShape {
    fn cast_local_ray_and_get_normal(
        &self,
        ray: &Ray,
        end: f32,
        solid: bool,
    ) -> Option<RayIntersection> {
        self.field.cast_local_ray_and_get_normal(ray, end, solid)
    }
}

impl PointQuery for TileShape {
    fn project_local_point(&self, point: Vector, solid: bool) -> PointProjection {
        self.field.project_local_point(point, solid)
    }

    fn project_local_point_and_get_feature(&self, point: Vector) -> (PointProjection, FeatureId) {
        self.field.project_local_point_and_get_feature(point)
    }

    fn project_local_point_with_max_dist(
        &self,
        point: Vector,
        solid: bool,
        most: f32,
    ) -> Option<PointProjection> {
        self.field
            .project_local_point_with_max_dist(point, solid, most)
    }
}

impl Shape for TileShape {
    fn compute_local_aabb(&self) -> Aabb {
        self.field.local_aabb()
    }

    fn compute_local_bounding_sphere(&self) -> BoundingSphere {
        self.field.local_bounding_sphere()
    }

    fn clone_dyn(&self) -> Box<dyn Shape> {
        Box::new(self.clone())
    }

    /// Tiles are not scaled.
    fn scale_dyn(&self, _scale: Vector, _subdivisions: u32) -> Option<Box<dyn Shape>> {
        None
    }

    fn mass_properties(&self, density: f32) -> MassProperties {
        self.field.mass_properties(density)
    }

    /// Not that of a height field, or contacts would not ask for its parts.
    fn shape_type(&self) -> ShapeType {
        ShapeType::Custom
    }

    /// That of a height field, which continuous collision detection takes as one-sided and searches by cells.
    fn as_typed_shape(&self) -> TypedShape<'_> {
        TypedShape::HeightField(&self.field)
    }

    fn ccd_thickness(&self) -> f32 {
        0.0
    }

    fn ccd_angular_thickness(&self) -> f32 {
        FRAC_PI_4
    }

    fn as_composite_shape(&self) -> Option<&dyn CompositeShape> {
        Some(self)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Heights without any order.
    fn rough(at: IVec2) -> f32 {
        let mixed = at.x.wrapping_mul(7919) ^ at.y.wrapping_mul(104_729);
        (mixed.rem_euclid(1000) as f32) * 1e-3
    }

    fn tile(first: IVec2, cells: i32, diagonals: Diagonals) -> TileShape {
        let side = -1..=cells + 1;
        let samples = side
            .clone()
            .flat_map(|x| side.clone().map(move |z| rough(first + IVec2::new(x, z))));
        TileShape::new(samples.collect(), cells, 0.5, first, diagonals)
    }

    /// Every neighbour shares two corners with the triangle, and each of its edges has one.
    #[test]
    fn neighbours_share_an_edge() {
        for diagonals in [Diagonals::Alternating, Diagonals::Alike] {
            let tile = tile(IVec2::new(-3, 6), 4, diagonals);
            for id in 0..32 {
                let (triangle, normals) = tile.part(id);
                let corners = [triangle.a, triangle.b, triangle.c];
                // The triangles around, by brute force: all that share two corners.
                let mut expected = Vec::new();
                for x in -1..5 {
                    for z in -1..5 {
                        for right in [false, true] {
                            let other = tile.triangle(IVec2::new(x, z), right);
                            let theirs = [other.a, other.b, other.c];
                            let shared = corners.iter().filter(|c| theirs.contains(c)).count();
                            if shared == 2 {
                                expected.push((normals.face + other.normal().unwrap()).normalize());
                            }
                        }
                    }
                }
                assert_eq!(expected.len(), 3, "{id}");
                for edge in normals.edges {
                    assert!(expected.iter().any(|e| e.distance(edge) < 1e-6), "{id}");
                }
                for other in expected {
                    assert!(
                        normals.edges.iter().any(|e| e.distance(other) < 1e-6),
                        "{id}"
                    );
                }
            }
        }
    }

    /// The same triangle of two tiles that overlap, but for where they lie.
    #[test]
    fn a_border_is_as_the_inside_to_the_bit() {
        let whole = tile(IVec2::ZERO, 8, Diagonals::Alternating);
        for corner in [
            IVec2::ZERO,
            IVec2::new(4, 0),
            IVec2::new(0, 4),
            IVec2::splat(4),
        ] {
            let part = tile(corner, 4, Diagonals::Alternating);
            for id in 0..32_u32 {
                let cell = IVec2::new(id as i32 / 2 / 4, id as i32 / 2 % 4) + corner;
                let there = (cell.x * 8 + cell.y) as u32 * 2 + (id & 1);
                let ((a, of_part), (b, of_whole)) = (part.part(id), whole.part(there));
                assert_eq!(of_part.face, of_whole.face);
                assert_eq!(of_part.edges, of_whole.edges);
                assert_eq!(a.b - a.a, b.b - b.a);
            }
        }
    }

    #[test]
    fn parts_are_the_triangles_of_the_field() {
        let tile = tile(IVec2::new(5, -2), 3, Diagonals::Alternating);
        for x in 0..3 {
            for z in 0..3 {
                let cell = IVec2::new(x, z);
                let (left, right) = tile.field.triangles_at(z as usize, x as usize);
                for (parry, ours) in [(left, false), (right, true)] {
                    let ours = tile.triangle(cell, ours);
                    let parry = parry.unwrap();
                    // Its corners are products of thirds.
                    assert!(parry.a.distance(ours.a) < 1e-6, "{cell}");
                    assert!(parry.b.distance(ours.b) < 1e-6, "{cell}");
                    assert!(parry.c.distance(ours.c) < 1e-6, "{cell}");
                }
            }
        }
    }
}
