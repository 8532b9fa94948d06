//! The whole ground as one shape, which has no borders.
//!
//! Rapier solves contacts pair by pair, and starts each from what it was in the step before: a body that rolls from one
//! collider onto another is solved in another order there, and its first contacts start from nothing. So contacts with
//! all tiles are those of one collider, which never changes for Rapier. Its shape looks into the samples of the tiles
//! that there are, and asks the ground itself where there is none. Only `contacts.rs` knows it: for rays, casts, sensors
//! and continuous collision detection there are the tiles.

use super::cells::around;
use super::cells::{Lattice, Part};
use crate::ground::GroundTiles;
use bevy::math::{DVec2, IRect, IVec2, Vec3};
use bevy::platform::collections::HashMap;
use bevy_rapier3d::parry::bounding_volume::{Aabb, BoundingSphere};
use bevy_rapier3d::parry::mass_properties::MassProperties;
use bevy_rapier3d::parry::math::Vector;
use bevy_rapier3d::parry::query::{PointProjection, PointQuery, Ray, RayCast, RayIntersection};
use bevy_rapier3d::parry::shape::{FeatureId, Shape, ShapeType, TypedShape};
use std::f32::consts::FRAC_PI_4;
use std::sync::{Arc, PoisonError, RwLock};

/// Half of the side of what contains every ground, metres: 2²⁴ samples 64 m apart.
const FAR: f32 = 1_073_741_824.0;

/// Cells that contacts of one body are looked for along a side, at most: a body that covers more meets the ground below
/// its middle alone.
const MOST: i32 = 256;

/// The ground, and what is known of it.
struct Store {
    ground: GroundTiles,
    tiles: HashMap<IVec2, Arc<[f32]>>,
}

/// The surface of a ground. Clones are the same surface.
#[derive(Clone)]
pub(super) struct Surface {
    store: Arc<RwLock<Store>>,
}

impl Surface {
    /// Of a ground, none of which has been sampled.
    pub fn new(ground: GroundTiles) -> Self {
        let store = Store {
            ground,
            tiles: HashMap::default(),
        };
        Self {
            store: Arc::new(RwLock::new(store)),
        }
    }

    /// Another ground in the place of this one, of which `tiles` have been sampled.
    pub fn set(&self, ground: GroundTiles, tiles: HashMap<IVec2, Arc<[f32]>>) {
        *self.write() = Store { ground, tiles };
    }

    /// Samples of a tile, which come from the ground.
    pub fn insert(&self, tile: IVec2, samples: Arc<[f32]>) {
        self.write().tiles.insert(tile, samples);
    }

    /// Forgets the samples of a tile.
    pub fn remove(&self, tile: IVec2) {
        self.write().tiles.remove(&tile);
    }

    // Nobody panics with the lock: a store that was written is whole.
    fn write(&self) -> std::sync::RwLockWriteGuard<'_, Store> {
        self.store.write().unwrap_or_else(PoisonError::into_inner)
    }

    /// The cells below a box; `None` where samples are not exact or the box is not finite.
    pub fn patch(&self, bounds: &Aabb) -> Option<Patch> {
        let store = self.store.read().unwrap_or_else(PoisonError::into_inner);
        let ground = &store.ground;
        let flat = |v: Vec3| DVec2::new(f64::from(v.x), f64::from(v.z));
        let (min, max) = (
            ground.cell(flat(bounds.mins))?,
            ground.cell(flat(bounds.maxs))?,
        );
        let middle = ground.cell(flat(bounds.center()))?;
        let most = IVec2::splat(MOST / 2);
        let cells = IRect::from_corners(min.max(middle - most), max.min(middle + most));
        let (first, end) = (cells.min - 1, cells.max + 2);
        let row = end.y - first.y + 1;
        let side = ground.cells() as i32;
        let mut heights = Vec::with_capacity(((end.x - first.x + 1) * row) as usize);
        let mut near: Option<(IVec2, Option<&Arc<[f32]>>)> = None;
        for x in first.x..=end.x {
            for z in first.y..=end.y {
                let at = IVec2::new(x, z);
                let tile = ground.tile_of(at);
                let samples = match near {
                    Some((known, samples)) if known == tile => samples,
                    _ => store.tiles.get(&tile),
                };
                near = Some((tile, samples));
                let height = samples.map_or_else(
                    || ground.sample(at),
                    |samples| {
                        let at = at - tile * side + 1;
                        samples[(at.x * around(side) + at.y) as usize]
                    },
                );
                heights.push(height);
            }
        }
        let lattice = Lattice {
            step: ground.step(),
            diagonals: ground.diagonals(),
        };
        Some(Patch {
            lattice,
            cells,
            first,
            row,
            heights,
        })
    }
}

/// Some cells of a ground, and the samples one step around them.
pub(super) struct Patch {
    pub lattice: Lattice,
    /// The first and the last cell.
    pub cells: IRect,
    first: IVec2,
    row: i32,
    heights: Vec<f32>,
}

impl Patch {
    fn height(&self, at: IVec2) -> f32 {
        let at = at - self.first;
        self.heights[(at.x * self.row + at.y) as usize]
    }

    /// Cells of which a part is between these heights, metres, column after column.
    pub fn between(&self, least: f32, most: f32) -> impl Iterator<Item = IVec2> {
        let each = (self.cells.min.x..=self.cells.max.x)
            .flat_map(|x| (self.cells.min.y..=self.cells.max.y).map(move |z| IVec2::new(x, z)));
        each.filter(move |&cell| {
            let corner = |x, z| self.height(cell + IVec2::new(x, z));
            let heights = [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)];
            let low = heights.iter().copied().fold(f32::INFINITY, f32::min);
            let high = heights.iter().copied().fold(f32::NEG_INFINITY, f32::max);
            low <= most && high >= least
        })
    }

    /// A triangle, and where the frame of its cell lies, metres. Exact: places of samples are.
    pub fn part(&self, cell: IVec2, right: bool) -> (Part, Vec3) {
        let part = self.lattice.part(cell, right, &|at| self.height(at));
        let from = cell.as_vec2() * self.lattice.step;
        let origin = Vec3::new(from.x, part.base, from.y);
        (part, origin)
    }
}

impl RayCast for Surface {
    /// Tiles answer rays.
    fn cast_local_ray_and_get_normal(&self, _: &Ray, _: f32, _: bool) -> Option<RayIntersection> {
        None
    }
}

impl PointQuery for Surface {
    /// Farther than anything: tiles answer where the nearest point is.
    fn project_local_point(&self, _: Vector, _: bool) -> PointProjection {
        PointProjection::new(false, Vec3::splat(FAR * FAR))
    }

    fn project_local_point_and_get_feature(&self, point: Vector) -> (PointProjection, FeatureId) {
        (self.project_local_point(point, true), FeatureId::Unknown)
    }

    fn project_local_point_with_max_dist(
        &self,
        _: Vector,
        _: bool,
        _: f32,
    ) -> Option<PointProjection> {
        None
    }
}

impl Shape for Surface {
    /// All that there may be: it stays the same while tiles come and go.
    fn compute_local_aabb(&self) -> Aabb {
        Aabb::new(Vec3::splat(-FAR), Vec3::splat(FAR))
    }

    fn compute_local_bounding_sphere(&self) -> BoundingSphere {
        self.compute_local_aabb().bounding_sphere()
    }

    fn clone_dyn(&self) -> Box<dyn Shape> {
        Box::new(self.clone())
    }

    /// The ground is not scaled.
    fn scale_dyn(&self, _scale: Vector, _subdivisions: u32) -> Option<Box<dyn Shape>> {
        None
    }

    /// It never moves.
    fn mass_properties(&self, _density: f32) -> MassProperties {
        MassProperties::default()
    }

    fn shape_type(&self) -> ShapeType {
        ShapeType::Custom
    }

    fn as_typed_shape(&self) -> TypedShape<'_> {
        TypedShape::Custom(self)
    }

    fn ccd_thickness(&self) -> f32 {
        0.0
    }

    fn ccd_angular_thickness(&self) -> f32 {
        FRAC_PI_4
    }
}
