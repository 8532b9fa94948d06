//! The ground of a level in a city: where one walks among its houses, what hides and stops shots, how roofs are come
//! to, and the wall around the quarter with its gate.
//!
//! All of it follows from the rules of the city and the file of the level; houses are the boxes that also stop the
//! figure.

use bevy::math::{IVec2, UVec2, Vec2, Vec2Swizzles as _, Vec3, Vec3Swizzles as _};
use dolomite::city::streets::{cell_at, has_cell, street_at};
use dolomite::logic::movement::{GridError, WalkGrid, WalkLimits};
use dolomite::logic::parts::Lift;

use super::file::{LevelFile, Refused};
use super::quarter::{GATE, GateFile, Side};
use crate::play::city::{hedges, houses};
use crate::scene::city::{ABOVE, CityScene};

/// Side of a cell of the grid, metres: between a house and a hedge there is room for one.
pub const CELL: f32 = 1.0;

/// How far soldiers keep from walls, metres: the radius of a figure and some centimetres for its arms.
const MARGIN: f32 = 0.4;

/// Half of the plate of a lift, metres: 1.8 m square and 16 cm thick.
pub const PLATE: Vec3 = Vec3::new(0.9, 0.08, 0.9);

/// The top of a plate that is down lies so high above the ground, metres: a step that needs no climbing.
const DOWN: f32 = 0.05;

/// From the kerb to the middle of a shaft, metres: the plate is on the street, and its edge 30 cm from the kerb.
const SHAFT: f32 = 1.2;

/// Between the plate and the bridge, metres: the plate passes by, and no foot fits in.
const GAP: f32 = 0.03;

/// Thickness of a bridge, and of its rails; height of these and of parapets: nobody leaps over them (a leap is 46 cm
/// high). Metres.
const BRIDGE: f32 = 0.2;
const RAIL: f32 = 0.1;
const RAIL_HEIGHT: f32 = 1.0;

/// Metres a second of a lift, and metres a second squared.
const SPEED: (f32, f32) = (2.0, 1.5);

/// Half of the thickness of the wall, its height, and how far it reaches into the ground, metres.
const WALL: f32 = 0.3;
const WALL_HEIGHT: f32 = 3.2;
const FOOT: f32 = 0.5;

/// From the gate to the middle of the place where the player has left, metres, and half the depth of that.
const OUT: (f32, f32) = (3.0, 1.5);

/// Cells of the boxes that hide, metres: of the size of a house.
pub const BOXES: f32 = 8.0;

/// A roof that a lift goes up to.
#[derive(Clone, Debug, PartialEq)]
pub struct Roof {
    /// Low and high corner of the house.
    pub house: [Vec3; 2],
    /// From the house to the street, (x, z), of length 1.
    pub out: Vec2,
    /// The middle of the lift's plate, (x, z).
    pub shaft: Vec2,
    /// The height of the plate's top at its floors.
    pub floors: [f32; 2],
    /// The lift below, at first.
    pub lift: Lift,
}

impl Roof {
    /// The middle of the roof, (x, z).
    pub fn middle(&self) -> Vec2 {
        (self.house[0] + self.house[1]).xz() / 2.0
    }

    /// Along the house, (x, z), of length 1.
    pub const fn along(&self) -> Vec2 {
        Vec2::new(-self.out.y, self.out.x)
    }

    /// Where one stands before the shaft, on the street, and waits for the lift.
    pub fn before(&self) -> Vec2 {
        self.shaft + self.along() * (PLATE.x + 0.9)
    }

    /// The edge of the house on the side of the lift, metres from the middle of the plate.
    fn reach(&self) -> f32 {
        let half = (self.house[1] - self.house[0]).xz() / 2.0;
        (self.shaft - self.middle()).dot(self.out) - half.dot(self.out.abs())
    }

    /// Whether somebody at a place, (x, z), is on the plate, wherever that is.
    pub fn on_plate(&self, place: Vec2) -> bool {
        (place - self.shaft).abs().max_element() <= PLATE.x
    }

    /// A box from low and high corners along: inwards from the middle of the plate, along the house, up.
    fn boxed(&self, low: Vec3, high: Vec3) -> [Vec3; 2] {
        let place = |at: Vec3| {
            let ground = self.shaft - self.out * at.x + self.along() * at.y;
            Vec3::new(ground.x, at.z, ground.y)
        };
        let (a, b) = (place(low), place(high));
        [a.min(b), a.max(b)]
    }

    /// The bridge from the shaft to the roof and its rails, and the parapet around the roof.
    pub fn solids(&self) -> Vec<[Vec3; 2]> {
        let top = self.floors[1];
        let (near, far, side) = (PLATE.x + GAP, self.reach(), PLATE.x);
        let rails = top + RAIL_HEIGHT;
        let size = (self.house[1] - self.house[0]).xz();
        let (deep, wide) = (size.dot(self.out.abs()), size.dot(self.along().abs()) / 2.0);
        let end = far + deep;
        let mut all = vec![self.boxed(
            Vec3::new(near, -side, top - BRIDGE),
            Vec3::new(far, side, top),
        )];
        for sign in [-1.0, 1.0] {
            let rail = |from: f32, to: f32, inner: f32, outer: f32| {
                self.boxed(
                    Vec3::new(from, sign * inner, top),
                    Vec3::new(to, sign * outer, rails),
                )
            };
            // Along the bridge, along the house's other sides, and beside the bridge's end.
            all.push(rail(near, far, side - RAIL, side));
            all.push(rail(far, end, wide - RAIL, wide));
            all.push(rail(far, far + RAIL, side - RAIL, wide));
        }
        all.push(self.boxed(
            Vec3::new(end - RAIL, -wide, top),
            Vec3::new(end, wide, rails),
        ));
        all
    }
}

/// The gate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gate {
    /// Its middle while it is closed.
    pub closed: Vec3,
    /// And while it is open: it sinks into the ground.
    pub open: Vec3,
    /// Half of its size.
    pub half: Vec3,
    /// The middle of the place beyond it, and half of its size.
    pub beyond: (Vec3, Vec3),
}

/// What stands on the ground of a level.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Built {
    /// Low and high corners of everything that hides and stops shots; empty where the ground alone does.
    pub hides: Vec<[Vec3; 2]>,
    /// Those that are the level's own: bridges, rails, walls.
    pub solids: Vec<[Vec3; 2]>,
    /// The roof of each beacon that stands on one.
    pub roofs: Vec<Option<Roof>>,
    /// The way out.
    pub gate: Option<Gate>,
}

/// A value that makes no sense in this city, or an area that is none.
#[derive(Debug)]
pub enum Fault {
    /// What to look for, and why.
    Refused(Refused),
    /// The grid.
    Grid(GridError),
}

impl From<GridError> for Fault {
    fn from(error: GridError) -> Self {
        Self::Grid(error)
    }
}

/// Where one walks in the area of a level, and what stands there.
///
/// # Errors
/// [`Fault`]: the area reaches beyond the city; a roof without a house or without a street beside it.
pub fn build(city: &CityScene, file: &LevelFile) -> Result<(WalkGrid, Built), Fault> {
    let middle = Vec2::from(file.area.middle);
    let half = Vec2::splat(file.area.side / 2.0);
    let (low, high) = (middle - half, middle + half);
    let local = |at: Vec2| (at.as_dvec2() - city.origin.xz()).to_array();
    let refuse = |what: &str, reason: String| Fault::Refused((what.to_owned(), reason));
    let ends = [low, high - 0.01].map(|at| cell_at(&city.rules, local(at)));
    let [Some(first), Some(last)] = ends else {
        return Err(refuse("area:", "the area is no place".to_owned()));
    };
    if !(has_cell(&city.rules, first) && has_cell(&city.rules, last)) {
        return Err(refuse(
            "area:",
            "the area reaches beyond the city".to_owned(),
        ));
    }
    let ground = (city.origin.y - ABOVE) as f32;
    let cells = UVec2::splat((file.area.side / CELL).ceil().max(0.0) as u32);
    let limits = WalkLimits::default();
    // The scene has made sure that the ground below a city is level.
    let mut grid = WalkGrid::over(low, CELL, cells, limits, |_| ground)?;
    let mut built = Built::default();
    // The ground itself: one box, since it is level.
    let wide = |at: Vec2, y: f32| Vec3::new(at.x, y, at.y);
    built
        .hides
        .push([wide(low - 64.0, ground - 20.0), wide(high + 64.0, ground)]);
    let mut all_houses = Vec::new();
    for z in first[1]..=last[1] {
        for x in first[0]..=last[0] {
            let corners = |(middle, half): (Vec3, Vec3)| [middle - half, middle + half];
            let own: Vec<_> = houses(city, [x, z]).into_iter().map(corners).collect();
            built.hides.extend(own.iter().copied());
            built
                .hides
                .extend(hedges(city, [x, z]).into_iter().map(corners));
            all_houses.extend(own);
        }
    }
    for corners in &built.hides[1..] {
        grid.block(corners[0], corners[1], MARGIN);
    }
    for beacon in &file.beacons {
        let place = Vec2::from(beacon.at);
        let roof = match beacon.lift {
            None => None,
            Some(side) => {
                let roof = roof(city, &all_houses, place, side, ground);
                let reason = |reason| refuse(&format!("\"{}\"", beacon.name), reason);
                Some(roof.map_err(reason)?)
            }
        };
        if let Some(roof) = &roof {
            // Nobody walks where the plate comes down.
            let (shaft, half) = (roof.shaft, PLATE.xz());
            grid.block(wide(shaft - half, 0.0), wide(shaft + half, 0.0), 0.0);
            built.solids.extend(roof.solids());
        }
        built.roofs.push(roof);
    }
    if let Some(gate) = file.gate {
        let (walls, gate) = wall(low, high, gate, ground);
        for corners in &walls {
            grid.block(corners[0], corners[1], MARGIN);
        }
        // So is the gate, which is for the player alone.
        let (at, half) = (gate.closed, gate.half);
        grid.block(at - half, at + half, MARGIN);
        built.solids.extend(walls);
        built.gate = Some(gate);
    }
    built.hides.extend(built.solids.iter().copied());
    Ok((grid, built))
}

/// The roof of the house at a place, and the lift at its side.
fn roof(
    city: &CityScene,
    houses: &[[Vec3; 2]],
    place: Vec2,
    side: Side,
    ground: f32,
) -> Result<Roof, String> {
    let holds =
        |house: &&[Vec3; 2]| house[0].xz().cmple(place).all() && place.cmple(house[1].xz()).all();
    let house = *houses
        .iter()
        .find(holds)
        .ok_or_else(|| format!("there is no house at {place}"))?;
    let middle = (house[0] + house[1]).xz() / 2.0;
    let cell = cell_at(
        &city.rules,
        (middle.as_dvec2() - city.origin.xz()).to_array(),
    )
    .ok_or_else(|| format!("there is no house at {place}"))?;
    let beside = || format!("there is no street on the side {side:?} of the house at {place}");
    if !street_at(&city.rules, cell, side.number()) {
        return Err(beside());
    }
    let out = side.out();
    let pitch = city.rules.pitch;
    let corner = city.origin.xz().as_vec2() + IVec2::from(cell).as_vec2() * pitch;
    // The street's middle along the axis: the cell's low side, or its high one.
    let line = corner + pitch * out.max(Vec2::ZERO);
    let kerb = line - out * (city.rules.street / 2.0);
    let shaft = middle * (Vec2::ONE - out.abs()) + (kerb + out * SHAFT) * out.abs();
    let floors = [ground + DOWN, house[1].y];
    let lift = Lift::new(floors.map(|top| top - PLATE.y).to_vec())
        .and_then(|lift| lift.with_speed(SPEED.0, SPEED.1))
        .map_err(|error| error.to_string())?;
    let roof = Roof {
        house,
        out,
        shaft,
        floors,
        lift,
    };
    // The bridge passes over lawn and hedge, and no other house.
    let [low, high] = roof.solids()[0];
    let crosses = |other: &[Vec3; 2]| {
        *other != house && low.cmplt(other[1]).all() && other[0].cmplt(high).all()
    };
    if roof.reach() < PLATE.x || houses.iter().any(crosses) {
        return Err(beside());
    }
    Ok(roof)
}

/// The wall around an area, in pieces, and the gate in it.
fn wall(low: Vec2, high: Vec2, gate: GateFile, ground: f32) -> (Vec<[Vec3; 2]>, Gate) {
    let middle = (low + high) / 2.0;
    let half = (high - low) / 2.0;
    let mut walls = Vec::new();
    let (bottom, top) = (ground - FOOT, ground + WALL_HEIGHT);
    for side in [Side::West, Side::South, Side::East, Side::North] {
        let out = side.out();
        // East or south.
        let along = out.yx().abs();
        let line = middle + out * half;
        let reach = half.dot(along) + WALL;
        let mut piece = |from: f32, to: f32| {
            let a = line + along * from - out.abs() * WALL;
            let b = line + along * to + out.abs() * WALL;
            walls.push([Vec3::new(a.x, bottom, a.y), Vec3::new(b.x, top, b.y)]);
        };
        if side == gate.side {
            piece(-reach, gate.along - GATE);
            piece(gate.along + GATE, reach);
        } else {
            piece(-reach, reach);
        }
    }
    let out = gate.side.out();
    let along = out.yx().abs();
    let at = middle + out * half + along * gate.along;
    let height = (WALL_HEIGHT + FOOT) / 2.0;
    let sized = |wide: f32, deep: f32, high: f32| {
        let flat = along * wide + out.abs() * deep;
        Vec3::new(flat.x, high, flat.y)
    };
    let closed = Vec3::new(at.x, bottom + height, at.y);
    let beyond = at + out * OUT.0;
    let gate = Gate {
        closed,
        // Its top ends a hand below the ground.
        open: closed - Vec3::Y * (WALL_HEIGHT + 0.1),
        half: sized(GATE, WALL / 2.0, height),
        beyond: (
            Vec3::new(beyond.x, ground + 1.0, beyond.y),
            sized(GATE + 1.0, OUT.1, 4.0),
        ),
    };
    (walls, gate)
}
