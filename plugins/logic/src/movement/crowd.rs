//! The arrays of a crowd, in the order of a grid, and what each sees of the others there.
//!
//! The order is kept for some steps: a walker is looked for in the cell that it was in when all were sorted, and cells
//! are looked through so much farther as anybody may have gone since ([`SLACK`]). Whoever went farther, came, or left
//! makes it be sorted anew. So the neighbours found are those of a grid that is sorted in every step, except that of
//! more than [`WalkSettings::looks`] others those are looked at that were near first.

use super::orca::{Disc, Line, NEIGHBOURS, half_plane, velocity};
use super::walker::{WalkSettings, Walker};
use crate::grid::Grid;
use bevy::ecs::prelude::*;
use bevy::math::Vec2;

/// Steps after which all are sorted anew, so that who is near stays near in memory.
const SORTS: u32 = 8;

/// How far somebody may get from where it was sorted, as a part of the reach.
const SLACK: f32 = 0.125;

/// Places that are compared at once: what a compiler keeps in two registers of a processor of 2008.
const WIDE: usize = 8;

/// One walker of a step.
#[derive(Clone, Copy, Debug, Default)]
struct Walk {
    /// 0 of one who stands or is nobody's neighbour.
    speed: f32,
    field: u16,
    due: bool,
    calm: bool,
}

/// What becomes of a walker.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Step {
    /// Where it is.
    pub place: Vec2,
    /// The wish, then the velocity.
    pub velocity: Vec2,
    /// Whether nobody hindered it.
    pub calm: bool,
}

/// All walkers in the order of a grid.
#[derive(Default)]
pub(super) struct Ranks {
    /// In the order of the world, when they were sorted.
    entities: Vec<Entity>,
    grid: Grid,
    /// Steps since they were.
    age: u32,
    /// Where each was then, in the order of the grid, as all that follows.
    homes: Vec<Vec2>,
    /// With [`WIDE`] more that are nowhere.
    x: Vec<f32>,
    z: Vec<f32>,
    discs: Vec<Disc>,
    walks: Vec<Walk>,
    /// In the order of the world.
    places: Vec<Vec2>,
}

/// A walker as others see it, and what it wants. Who has no place, or no size, is nobody's neighbour and stays.
fn read(walker: &Walker, due: bool) -> (Disc, Walk) {
    let moves = walker.velocity.is_finite();
    let whole =
        walker.place.is_finite() && moves && walker.radius.is_finite() && walker.radius >= 0.0;
    let disc = Disc {
        place: walker.place,
        velocity: if moves { walker.velocity } else { Vec2::ZERO },
        radius: if whole { walker.radius } else { 0.0 },
    };
    let speed = if whole && walker.speed.is_finite() {
        walker.speed.max(0.0)
    } else {
        0.0
    };
    let walk = Walk {
        speed,
        field: walker.field,
        due,
        calm: walker.calm,
    };
    (disc, walk)
}

impl Ranks {
    /// Fills the arrays in the order that there is; whether it still holds.
    pub fn fill<'a>(
        &mut self,
        reach: f32,
        walkers: impl Iterator<Item = (Entity, &'a Walker, bool)>,
    ) -> bool {
        self.age += 1;
        if self.age >= SORTS {
            return false;
        }
        let slack = (reach * SLACK) * (reach * SLACK);
        let mut count = 0;
        for (entity, walker, due) in walkers {
            if self.entities.get(count) != Some(&entity) {
                return false;
            }
            let rank = self.grid.slots()[count] as usize;
            let far = walker.place.distance_squared(self.homes[rank]);
            let is_near = far <= slack || !walker.place.is_finite();
            if !is_near {
                return false;
            }
            self.put(rank, walker, due);
            count += 1;
        }
        count == self.entities.len()
    }

    fn put(&mut self, rank: usize, walker: &Walker, due: bool) {
        let (disc, walk) = read(walker, due);
        self.x[rank] = disc.place.x;
        self.z[rank] = disc.place.y;
        self.discs[rank] = disc;
        self.walks[rank] = walk;
    }

    /// Sorts all into the grid; they are gone over twice.
    pub fn sort<'a, I: Iterator<Item = (Entity, &'a Walker, bool)>>(
        &mut self,
        reach: f32,
        walkers: impl Fn() -> I,
    ) {
        self.age = 0;
        self.entities.clear();
        self.places.clear();
        for (entity, walker, _) in walkers() {
            self.entities.push(entity);
            self.places.push(walker.place);
        }
        self.grid.build(&self.places, reach);
        let count = self.places.len();
        self.homes.resize(count, Vec2::ZERO);
        self.x.clear();
        self.x.resize(count + WIDE, f32::NAN);
        self.z.clear();
        self.z.resize(count + WIDE, f32::NAN);
        self.discs.resize(count, Disc::default());
        self.walks.resize(count, Walk::default());
        for (number, (_, walker, due)) in walkers().enumerate() {
            let rank = self.grid.slots()[number] as usize;
            self.homes[rank] = walker.place;
            self.put(rank, walker, due);
        }
    }

    /// Where each stands, in the order of the world.
    pub fn of_each(&self) -> &[u32] {
        self.grid.slots()
    }

    /// Bytes that they take.
    pub fn bytes(&self) -> usize {
        size_of::<Entity>() * self.entities.capacity()
            + size_of::<Vec2>() * (self.homes.capacity() + self.places.capacity())
            + size_of::<f32>() * (self.x.capacity() + self.z.capacity())
            + size_of::<Disc>() * self.discs.capacity()
            + size_of::<Walk>() * self.walks.capacity()
            + self.grid.bytes()
    }
}

/// What a walker sees of the others.
pub(super) struct Crowd<'a> {
    ranks: &'a Ranks,
    settings: &'a WalkSettings,
    reach: f32,
    delta: f32,
}

impl<'a> Crowd<'a> {
    /// Of all walkers, in a step of `delta` seconds.
    pub const fn new(ranks: &'a Ranks, settings: &'a WalkSettings, reach: f32, delta: f32) -> Self {
        Self {
            ranks,
            settings,
            reach,
            delta,
        }
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.ranks.walks.len()
    }

    /// How many decide in this step.
    pub fn due(&self) -> u32 {
        self.ranks
            .walks
            .iter()
            .map(|walk| u32::from(walk.due))
            .sum()
    }

    /// Where one is.
    pub fn place(&self, at: usize) -> Vec2 {
        self.ranks.discs[at].place
    }

    /// The speed that one wants.
    pub fn speed(&self, at: usize) -> f32 {
        self.ranks.walks[at].speed
    }

    /// Field, place and speed of one who wants to know the way in this step.
    pub fn asks(&self, at: usize) -> Option<(u16, Vec2, f32)> {
        let walk = self.ranks.walks[at];
        (walk.due && walk.speed > 0.0).then(|| (walk.field, self.place(at), walk.speed))
    }

    /// The nearest others of a walker, and how many.
    #[inline]
    fn nearest(&self, at: usize) -> ([u32; NEIGHBOURS], usize) {
        let Ranks { grid, x, z, .. } = self.ranks;
        let own = self.place(at);
        let mut near = Nearest::new(self.reach);
        let far = Vec2::splat(self.reach * (1.0 + SLACK));
        let ([x0, z0], [x1, z1]) = (grid.cell_of(own - far), grid.cell_of(own + far));
        let middle = grid.cell_of(own)[1];
        let mut left = self.settings.looks as usize;
        // Its own row first, then those beside it, so that of too many the nearer ones are looked at.
        let rows = (0..=(middle - z0).max(z1 - middle)).flat_map(|apart| {
            let above = (apart > 0 && middle + apart <= z1).then(|| middle + apart);
            let below = (middle >= z0 + apart).then(|| middle - apart);
            [below, above].into_iter().flatten()
        });
        for row in rows {
            let span = grid.span(row, x0, x1);
            let end = span
                .end
                .min(span.start + left + usize::from(span.contains(&at)));
            left -= (end - span.start).min(left);
            let mut first = span.start;
            while first < end {
                let squares = squares(own, x, z, first);
                let mut found = below(&squares, near.limit);
                // Of the last ones some are of another row.
                if end - first < WIDE {
                    found &= (1 << (end - first)) - 1;
                }
                while found != 0 {
                    let lane = found.trailing_zeros() as usize;
                    found &= found - 1;
                    if first + lane != at {
                        near.add(squares[lane], (first + lane) as u32);
                    }
                }
                first += WIDE;
            }
            if left == 0 {
                break;
            }
        }
        (near.numbers, near.count)
    }

    /// The next velocity of the walker that is so far down the order of the grid, and whether nobody hindered it.
    pub fn steer(&self, at: usize, wish: Vec2) -> (Vec2, bool) {
        let walk = &self.ranks.walks[at];
        let discs = &self.ranks.discs;
        let own = &discs[at];
        if !walk.due {
            return (own.velocity, walk.calm);
        }
        if walk.speed == 0.0 {
            return (Vec2::ZERO, true);
        }
        let (near, count) = self.nearest(at);
        let mut lines = [Line::default(); NEIGHBOURS];
        let step = self.delta * self.settings.every.max(1) as f32;
        let horizon = self.settings.horizon.max(step);
        for (line, &other) in lines.iter_mut().zip(&near[..count]) {
            let other = other as usize;
            *line = half_plane(own, &discs[other], horizon, step, at < other);
        }
        let result = velocity(&lines[..count], walk.speed, wish);
        if result.is_finite() {
            // What is longer than the speed is shortened, which hinders nobody.
            (result, result.distance_squared(wish) < 1e-6)
        } else {
            (Vec2::ZERO, false)
        }
    }
}

/// Squares of distances to [`WIDE`] places.
#[inline]
fn squares(own: Vec2, x: &[f32], z: &[f32], first: usize) -> [f32; WIDE] {
    let (x, z) = (&x[first..first + WIDE], &z[first..first + WIDE]);
    let mut squares = [0.0; WIDE];
    for lane in 0..WIDE {
        let (x, z) = (x[lane] - own.x, z[lane] - own.y);
        squares[lane] = x * x + z * z;
    }
    squares
}

/// A bit for each that is below the limit; NaN is not.
#[inline]
fn below(squares: &[f32; WIDE], limit: f32) -> u32 {
    let mut bits = 0;
    for (lane, &square) in squares.iter().enumerate() {
        bits |= u32::from(square < limit) << lane;
    }
    bits
}

/// The nearest so far, the nearest first.
struct Nearest {
    squares: [f32; NEIGHBOURS],
    numbers: [u32; NEIGHBOURS],
    count: usize,
    limit: f32,
}

impl Nearest {
    fn new(reach: f32) -> Self {
        Self {
            squares: [f32::INFINITY; NEIGHBOURS],
            numbers: [0; NEIGHBOURS],
            count: 0,
            limit: reach * reach,
        }
    }

    #[inline]
    fn add(&mut self, square: f32, number: u32) {
        // The limit may have come down since all of a row's part were compared.
        if square >= self.limit {
            return;
        }
        self.count = (self.count + 1).min(NEIGHBOURS);
        let mut to = self.count - 1;
        while to > 0 && self.squares[to - 1] > square {
            self.squares[to] = self.squares[to - 1];
            self.numbers[to] = self.numbers[to - 1];
            to -= 1;
        }
        self.squares[to] = square;
        self.numbers[to] = number;
        if self.count == NEIGHBOURS {
            self.limit = self.squares[NEIGHBOURS - 1];
        }
    }
}
