//! The ground of a level as its logic knows it: a grid of heights, and where soldiers walk.
//!
//! Logic stands on the heights of the grid and not on those of the terrain: they are a table look-up, where the
//! terrain is a sum of tens of octaves, and what sees, hears and shoots has to agree with itself and not with the last
//! decimetre of a stone. Who is drawn is drawn on the terrain.

use std::sync::Arc;

use bevy::math::{DVec2, UVec2, Vec2};
use dolomite::logic::movement::{GridError, WalkGrid, WalkLimits};
use dolomite::logic::rays::{BoxRays, GroundRays, RayWorld};
use dolomite::terrain::{GroundPoint, HeightTile, Planes, Terrain};

use super::town::{BOXES, Built};

/// Side of a cell, metres: some steps of a figure.
pub const CELL: f32 = 4.0;

/// The steepest slope that soldiers walk, rise over run: 45°.
const SLOPE: f32 = 1.0;

/// Deepest water that soldiers wade, metres.
const WADE: f32 = 0.4;

/// Rays look at the ground this often, metres; half a cell, so that they miss no cell.
const LOOKS: f32 = CELL / 2.0;

/// Rays pass this far below the heights of the grid, metres: between its corners the ground is a plane there and has
/// bumps in truth, and nobody is hidden by what is not there.
const SLACK: f32 = 0.25;

/// The grid over a square area: the bits are the same for any number of threads.
///
/// # Errors
/// [`GridError`] where the area is not finite, or holds no cell or too many.
pub fn walk_grid(terrain: &Terrain, middle: DVec2, side: f32) -> Result<WalkGrid, GridError> {
    let cells = UVec2::splat((side / CELL).ceil().max(0.0) as u32);
    let origin = middle.as_vec2() - cells.as_vec2() * (CELL / 2.0);
    // Refuses what cannot be before the heights are computed.
    WalkGrid::flat(origin, CELL, cells)?;
    let row = cells.x as usize + 1;
    let tile = HeightTile {
        origin: GroundPoint::new(origin.as_dvec2()),
        spacing: DVec2::splat(f64::from(CELL)),
        width: row,
        height: cells.y as usize + 1,
    };
    let [mut value, mut dx, mut dz] = [(); 3].map(|()| vec![0.0; tile.len()]);
    let planes = Planes {
        value: &mut value,
        dx: &mut dx,
        dz: &mut dz,
    };
    terrain
        .fill_tile_parallel(&tile, planes)
        .expect("the planes were made as long as the tile");
    let limits = WalkLimits {
        slope: SLOPE,
        water: terrain
            .sea_level()
            .map_or(f32::NEG_INFINITY, |sea| sea - WADE),
    };
    WalkGrid::over(origin, CELL, cells, limits, |place| {
        // Corners are asked for, exactly.
        let at = ((place - origin) / CELL).round().as_uvec2();
        value[at.y as usize * row + at.x as usize]
    })
}

/// What hides and stops shots in a level: its boxes, one of which is its level ground; or the ground of its grid.
pub fn rays(grid: Arc<WalkGrid>, built: &Built) -> RayWorld {
    if !built.hides.is_empty() {
        let boxes = built.hides.iter().copied();
        return RayWorld(Arc::new(BoxRays::new(boxes, BOXES)));
    }
    RayWorld(Arc::new(GroundRays::new(
        move |place: Vec2| grid.height(place) - SLACK,
        LOOKS,
    )))
}
