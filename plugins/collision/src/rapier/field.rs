//! A tile as casts and sensors meet it: triangles that know those beyond the border.
//!
//! Parry keeps bodies from catching on edges between flush triangles by holding the normal of a contact between that
//! of the triangle and those of its neighbours. Its own height field has none beyond its border, where it allows 45°
//! outwards, so that a ball that rolls onto a tile is braked by its edge; and where cells are cut from north-west to
//! south-east it asks triangles that share a corner alone. This shape has the samples one step around the tile, and
//! asks those that share the edge. Contacts with bodies are those of the whole ground, `surface.rs`, where Rapier's world
//! knows how to ask it; where it does not they are those of these tiles.

use super::cells::{Lattice, Part, around};
use crate::ground::{Diagonals, GroundTiles};
use bevy::math::{IVec2, Vec3};
use bevy_rapier3d::parry::bounding_volume::{Aabb, BoundingSphere};
use bevy_rapier3d::parry::mass_properties::MassProperties;
use bevy_rapier3d::parry::math::{Pose, Vector};
use bevy_rapier3d::parry::partitioning::{Bvh, BvhBuildStrategy};
use bevy_rapier3d::parry::query::details::NormalConstraints;
use bevy_rapier3d::parry::query::{PointProjection, PointQuery, Ray, RayCast, RayIntersection};
use bevy_rapier3d::parry::shape::{
    CompositeShape, FeatureId, HeightField, HeightFieldCellStatus, Shape, ShapeType, TypedShape,
};
use bevy_rapier3d::parry::utils::Array2;
use std::f32::consts::FRAC_PI_4;
use std::sync::Arc;

/// Triangles of a tile around its middle, those of a cell one after the other.
#[derive(Clone)]
pub(super) struct TileShape {
    /// Parry's own, for rays, points and continuous collision detection, where normals do not count.
    field: HeightField,
    /// Those of the tile and of one step around it, columns along Z together.
    samples: Arc<[f32]>,
    cells: i32,
    lattice: Lattice,
    /// The first cell, on the lattice of the world.
    first: IVec2,
    bvh: Bvh,
}

impl TileShape {
    /// Of samples of the tile whose first cell is `first`, and of one step around it.
    pub fn new(
        samples: Arc<[f32]>,
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
            lattice: Lattice { step, diagonals },
            first,
            bvh: Bvh::new(),
        };
        let count = 2 * (cells * cells) as u32;
        let leaves = (0..count).map(|id| {
            let (part, place) = shape.part(id);
            (id as usize, part.triangle.aabb(&place))
        });
        let bvh = Bvh::from_iter(BvhBuildStrategy::Binned, leaves);
        shape.bvh = bvh;
        shape
    }

    /// Bytes that it holds.
    pub fn bytes(&self) -> u64 {
        let cells = (self.cells * self.cells) as usize;
        let heights = size_of_val(self.field.heights().data());
        let samples = size_of_val(&*self.samples);
        (samples + heights + cells + self.bvh.total_memory_size()) as u64
    }

    /// A triangle by its number, and where the frame of its cell lies in that of the tile.
    fn part(&self, id: u32) -> (Part, Pose) {
        let (cell, right) = (id as i32 / 2, id & 1 == 1);
        let cell = IVec2::new(cell / self.cells, cell % self.cells);
        let height = |at: IVec2| {
            let at = at - self.first + 1;
            self.samples[(at.x * around(self.cells) + at.y) as usize]
        };
        let part = self.lattice.part(self.first + cell, right, &height);
        // Exact: half of a side is a multiple of half a step.
        let from = cell.as_vec2() * self.lattice.step - 0.5 * self.lattice.step * self.cells as f32;
        let place = Pose::from_translation(Vec3::new(from.x, part.base, from.y));
        (part, place)
    }
}

impl CompositeShape for TileShape {
    fn map_part_at(
        &self,
        id: u32,
        f: &mut dyn FnMut(Option<&Pose>, &dyn Shape, Option<&dyn NormalConstraints>),
    ) {
        let (part, place) = self.part(id);
        f(Some(&place), &part.triangle, Some(&part.normals));
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

impl GroundTiles {
    /// The samples of a tile and of one step around it, those of a column along Z together.
    pub(super) fn samples(&self, tile: IVec2) -> Arc<[f32]> {
        let cells = self.cells() as i32;
        let first = tile * cells;
        let side = -1..around(cells) - 1;
        let columns = side
            .clone()
            .flat_map(|x| side.clone().map(move |z| IVec2::new(x, z)));
        columns.map(|at| self.sample(first + at)).collect()
    }

    /// A tile of these samples.
    pub(super) fn shape(&self, tile: IVec2, samples: Arc<[f32]>) -> TileShape {
        let cells = self.cells() as i32;
        TileShape::new(samples, cells, self.step(), tile * cells, self.diagonals())
    }

    /// Where the middle of a tile lies.
    pub(super) fn place(&self, tile: IVec2) -> Vec3 {
        let middle = (tile.as_dvec2() + 0.5) * f64::from(self.side());
        Vec3::new(middle.x as f32, 0.0, middle.y as f32)
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

    /// The same triangle of two tiles that overlap.
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
                let ((a, _), (b, _)) = (part.part(id), whole.part(there));
                assert_eq!(a.normals.face, b.normals.face);
                assert_eq!(a.normals.edges, b.normals.edges);
                assert_eq!(a.triangle, b.triangle);
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
                for (parry, ours) in [(left, 0), (right, 1)] {
                    let (ours, place) = tile.part(((x * 3 + z) * 2 + ours) as u32);
                    let ours = ours.triangle.transformed(&place);
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
