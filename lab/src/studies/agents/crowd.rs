//! A square of ground with pillars, a goal in each corner, and walkers who go there.

use std::sync::Arc;

use bevy::app::App;
use bevy::math::{UVec2, Vec2, Vec3};
use dolomite_logic::grid::Grid;
use dolomite_logic::movement::{FlowField, FlowFields, WalkGrid, WalkGround, Walker};
use dolomite_logic::random::Random;

use super::stepping::app;

/// Metres of a side: 512 for 100 000, as dense for other numbers.
pub fn side(agents: usize) -> u32 {
    ((agents as f32 * (512.0 * 512.0 / 1e5)).sqrt() as u32).clamp(32, 4096)
}

/// So many walkers.
pub fn crowd(agents: usize, seed: u64) -> App {
    let mut app = app();
    let mut random = Random::new(seed);
    let side = side(agents);
    let mut grid =
        WalkGrid::flat(Vec2::ZERO, 1.0, UVec2::splat(side)).expect("a grid of this size is one");
    let end = side as f32;
    for _ in 0..side * side / 200 {
        let at = Vec2::new(random.unit(), random.unit()) * end;
        let low = Vec3::new(at.x, 0.0, at.y);
        grid.block(low, low + 3.0, 0.0);
    }
    let grid = Arc::new(grid);
    let corners = [
        (1.5, 1.5),
        (end - 1.5, 1.5),
        (end - 1.5, end - 1.5),
        (1.5, end - 1.5),
    ];
    let fields = corners.map(|(x, z)| {
        let goal = grid.nearest_open(Vec2::new(x, z), 50);
        let goals: Vec<Vec2> = goal.into_iter().collect();
        Arc::new(FlowField::new(Arc::clone(&grid), &goals))
    });
    for number in 0..agents {
        let at = loop {
            let at = Vec2::new(random.unit(), random.unit()) * end;
            if grid.is_open(at) {
                break at;
            }
        };
        app.world_mut().spawn(Walker::new(at, (number % 4) as u16));
    }
    app.insert_resource(WalkGround(grid))
        .insert_resource(FlowFields(fields.to_vec()));
    app
}

/// Pairs whose middles are nearer than half of both radii together, where both move.
pub fn overlaps(walkers: &[Walker]) -> usize {
    let moving: Vec<&Walker> = walkers
        .iter()
        .filter(|w| w.velocity.length_squared() > 0.25)
        .collect();
    let places: Vec<Vec2> = moving.iter().map(|w| w.place).collect();
    let mut grid = Grid::default();
    grid.build(&places, 1.0);
    let mut count = 0;
    for (number, walker) in moving.iter().enumerate() {
        let (low, high) = (walker.place - 0.6, walker.place + 0.6);
        for other in grid
            .near(low, high)
            .filter(|other| *other as usize > number)
        {
            let other = moving[other as usize];
            let least = 0.5 * (walker.radius + other.radius);
            count += usize::from(walker.place.distance_squared(other.place) < least * least);
        }
    }
    count
}
