//! Tiles of ground where movers are: a body each, kept while somebody is near.

use super::GroundTiles;
use super::heights::over_cell;
use crate::mesh::{MeshError, TriangleMesh};
use crate::motion::Pose;
use crate::plugin::{Bodies, CharacterBody, MeetsMovers, MoveState, MoveWish, Placed};
use crate::tree::{TreeKind, TreeSettings, TriangleTree};
use bevy::ecs::entity::EntityHashMap;
use bevy::ecs::prelude::*;
use bevy::math::{DVec2, DVec3, IRect, IVec2, Vec3, Vec3Swizzles as _};
use bevy::transform::components::Transform;
use dolomite_terrain::GroundRect;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Heights are multiples of this, metres, and those of a tile are kept from a multiple of [`STOREY`] near them: as long as
/// a tile rises by less than half a storey both are exact in f32, so that neighbours share their border to the bit, at
/// any height.
const FINEST: f64 = 1.0 / 65_536.0;

/// See [`FINEST`].
const STOREY: f64 = 256.0;

/// Steps after which a tile goes that nobody was near: two seconds at 60 a second, so that who turns back finds it.
const KEPT: u32 = 120;

/// Tiles around one mover, a side: ways that are longer are met about their start alone.
const MOST_TILES: i32 = 32;

/// Triangles up to which a list is tested sooner than a tree is walked.
const FEW: usize = 24;

/// Ground beyond what a mover reaches in a step, metres: movers push and lifts carry.
const MARGIN: f64 = 1.0;

/// Tiles of all grounds that movers meet.
#[derive(Resource, Default)]
pub(super) struct MoverTiles {
    grounds: EntityHashMap<Laid>,
    /// Number of the step.
    step: u32,
    /// How many tiles were made since the app began.
    pub made: u64,
}

/// The tiles of one ground.
struct Laid {
    ground: GroundTiles,
    /// By place, z first: in one order on every machine.
    tiles: BTreeMap<(i32, i32), Tile>,
}

struct Tile {
    /// `None` where heights are out of what a mesh can be.
    tree: Option<Arc<TriangleTree>>,
    /// The last step in which somebody was near.
    used: u32,
}

impl MoverTiles {
    /// Bytes that it holds.
    pub fn bytes(&self) -> usize {
        let tiles = self.grounds.values().flat_map(|laid| laid.tiles.values());
        tiles
            .filter_map(|tile| Some(tile.tree.as_ref()?.bytes()))
            .sum()
    }
}

/// Whether there is anything to forget.
pub(super) fn any(tiles: Res<MoverTiles>) -> bool {
    !tiles.grounds.is_empty()
}

/// Forgets all tiles.
pub(super) fn forget(mut tiles: ResMut<MoverTiles>) {
    tiles.grounds = EntityHashMap::default();
}

/// Puts the tiles that movers may meet in this step among the bodies, and movers that are below all ground onto it.
pub(super) fn lay(
    grounds: Query<(Entity, &GroundTiles), With<MeetsMovers>>,
    mut movers: Query<(&CharacterBody, &MoveWish, &mut MoveState, &mut Transform)>,
    mut tiles: ResMut<MoverTiles>,
    mut bodies: ResMut<Bodies>,
) {
    let MoverTiles {
        grounds: laid,
        step,
        made,
    } = &mut *tiles;
    *step = step.wrapping_add(1);
    laid.retain(|entity, _| grounds.contains(*entity));
    for (entity, ground) in &grounds {
        laid.entry(entity)
            .and_modify(|laid| laid.take(ground))
            .or_insert_with(|| Laid {
                ground: ground.clone(),
                tiles: BTreeMap::new(),
            });
    }
    for (body, wish, mut state, mut place) in &mut movers {
        let center = state.place(&place);
        let reach = body.radii.as_dvec3() + wish.0.as_dvec3().abs() + MARGIN;
        let within = GroundRect::new((center - reach).xz(), (center + reach).xz());
        for laid in laid.values_mut() {
            *made += laid.use_within(center.xz(), &within, *step);
        }
        // Where there is ground below it, it is under a bridge and not under the earth.
        let heights = laid.values().filter_map(|laid| laid.surface(center.xz()));
        let (below, above): (Vec<f64>, Vec<f64>) = heights.partition(|&height| height <= center.y);
        if below.is_empty()
            && let Some(ground) = above.into_iter().reduce(f64::min)
        {
            let over = DVec3::new(center.x, ground + f64::from(body.radii.y), center.z);
            place.translation = over.as_vec3();
            state.put(over, place.translation);
        }
    }
    let mut entities: Vec<Entity> = laid.keys().copied().collect();
    entities.sort_unstable();
    for entity in entities {
        let Some(laid) = laid.get_mut(&entity) else {
            continue;
        };
        laid.tiles
            .retain(|_, tile| step.wrapping_sub(tile.used) < KEPT);
        let used = laid.tiles.values().filter(|tile| tile.used == *step);
        for tree in used.filter_map(|tile| tile.tree.as_ref()) {
            bodies.placed.push(Placed {
                entity,
                tree: Arc::clone(tree),
                before: Pose::IDENTITY,
                after: Pose::IDENTITY,
            });
        }
    }
    bodies.placed.sort_by_key(|body| body.entity);
}

impl Laid {
    /// Goes over to another ground: tiles go that may have become others.
    fn take(&mut self, ground: &GroundTiles) {
        if Arc::ptr_eq(self.ground.ground(), ground.ground()) && self.is_cut_as(ground) {
            return;
        }
        let rects = ground.ground().changed_rects(&**self.ground.ground());
        match rects.filter(|_| self.is_cut_as(ground)) {
            Some(rects) => self.tiles.retain(|&(z, x), _| {
                let own = tile_rect(ground, IVec2::new(x, z));
                !rects.iter().any(|rect| overlap(rect, &own))
            }),
            None => self.tiles.clear(),
        }
        self.ground = ground.clone();
    }

    fn is_cut_as(&self, ground: &GroundTiles) -> bool {
        let of = |ground: &GroundTiles| (ground.step(), ground.cells(), ground.diagonals());
        of(&self.ground) == of(ground)
    }

    /// Marks the tiles within a rectangle as used, and makes those that are missing; how many that were.
    fn use_within(&mut self, around: DVec2, within: &GroundRect, step: u32) -> u64 {
        let ground = &self.ground;
        let tile = |xz: DVec2| ground.cell(xz).map(|cell| ground.tile_of(cell));
        let Some(middle) = tile(around) else {
            return 0;
        };
        let half = IVec2::splat(MOST_TILES / 2);
        let near = IRect::from_corners(middle - half, middle + half);
        let least = tile(within.min).unwrap_or(near.min).max(near.min);
        let most = tile(within.max).unwrap_or(near.max).min(near.max);
        let mut made = 0;
        for z in least.y..=most.y {
            for x in least.x..=most.x {
                let tile = self.tiles.entry((z, x)).or_insert_with(|| {
                    made += 1;
                    Tile {
                        tree: tree(ground, IVec2::new(x, z)),
                        used: step,
                    }
                });
                tile.used = step;
            }
        }
        made
    }

    /// The height of a tile's triangle, metres; `None` where no tile is.
    fn surface(&self, xz: DVec2) -> Option<f64> {
        let ground = &self.ground;
        let cell = ground.cell(xz)?;
        let tile = ground.tile_of(cell);
        let mesh = self.tiles.get(&(tile.y, tile.x))?.tree.as_ref()?.mesh();
        let cells = ground.cells() as i32;
        let corner = |x: i32, z: i32| {
            let at = cell - tile * cells + IVec2::new(x, z);
            let vertex = mesh.vertices()[(at.y * (cells + 1) + at.x) as usize];
            mesh.origin().y + f64::from(vertex.y)
        };
        let corners = [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)];
        let at = xz / f64::from(ground.step()) - cell.as_dvec2();
        Some(over_cell(ground.diagonals().falls(cell), at, corners))
    }
}

fn tile_rect(ground: &GroundTiles, tile: IVec2) -> GroundRect {
    let side = f64::from(ground.side());
    GroundRect::new(tile.as_dvec2() * side, (tile + 1).as_dvec2() * side)
}

/// Whether both have a place in common. A rectangle with a side that is no number has all.
fn overlap(a: &GroundRect, b: &GroundRect) -> bool {
    !(a.max.cmplt(b.min).any() || b.max.cmplt(a.min).any())
}

fn tree(ground: &GroundTiles, tile: IVec2) -> Option<Arc<TriangleTree>> {
    let mesh = mesh(ground, tile).ok()?;
    let kind = match mesh.triangles().len() {
        0..=FEW => TreeKind::List,
        _ => TreeKind::default(),
    };
    let settings = TreeSettings {
        kind,
        ..TreeSettings::default()
    };
    Some(Arc::new(TriangleTree::new(mesh, settings)))
}

/// The triangles of a tile, front upwards; vertices by rows along X.
fn mesh(ground: &GroundTiles, tile: IVec2) -> Result<TriangleMesh, MeshError> {
    let cells = ground.cells() as i32;
    let first = tile * cells;
    let step = f64::from(ground.step());
    let height = |at: IVec2| {
        let height = ground.ground().height(at.as_dvec2() * step);
        // As `GroundTiles::sample` has it: a hole would let movers fall.
        let height = if height.is_finite() { height } else { 0.0 };
        (height / FINEST).round() * FINEST
    };
    let corners = || (0..=cells).flat_map(|z| (0..=cells).map(move |x| IVec2::new(x, z)));
    let heights: Vec<f64> = corners().map(|at| height(first + at)).collect();
    let storey = (heights[heights.len() / 2] / STOREY).round() * STOREY;
    let vertices = corners()
        .zip(&heights)
        .map(|(at, height)| {
            let at = at.as_vec2() * ground.step();
            Vec3::new(at.x, (height - storey) as f32, at.y)
        })
        .collect();
    let number = |x: i32, z: i32| (z * (cells + 1) + x) as u32;
    let mut triangles = Vec::with_capacity(2 * (cells * cells) as usize);
    for z in 0..cells {
        for x in 0..cells {
            let [nw, ne] = [number(x, z), number(x + 1, z)];
            let [sw, se] = [number(x, z + 1), number(x + 1, z + 1)];
            if ground.diagonals().falls(first + IVec2::new(x, z)) {
                triangles.extend([[nw, sw, se], [nw, se, ne]]);
            } else {
                triangles.extend([[nw, sw, ne], [ne, sw, se]]);
            }
        }
    }
    let corner = first.as_dvec2() * step;
    TriangleMesh::new(DVec3::new(corner.x, storey, corner.y), vertices, triangles)
}
