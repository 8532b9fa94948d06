//! Study `paths`: ways for one beside the shortest: a graph of all corners that see each other, in f64, on random
//! grids. It has the length that any exact planner has, polyanya's too.

mod oracle;

use std::time::Instant;

use bevy::math::{IVec2, UVec2, Vec2};
use dolomite_logic::movement::{PathScratch, WalkGrid, find_path, is_clear, path_length};
use dolomite_logic::random::Random;
use dolomite_testkit::cores::on_all_cores;
use dolomite_testkit::metrics::median;
use serde_json::json;

use super::agents::asked;
use crate::study::{Asked, Options, Report, Study};
use oracle::{Corners, units};

/// As the command line knows it.
pub const STUDY: Study = Study {
    name: "paths",
    about: "any-angle ways on random grids: length over the shortest, ways missed, time",
    run,
    asked: &ASKED,
};

const ASKED: [Asked; 8] = [
    asked("Ways that were compared", "1e4", "/ways", ""),
    asked(
        "Length over the shortest, mean",
        "≤ 1.02",
        "/over_mean",
        "ratio",
    ),
    asked(
        "Length over the shortest, at most",
        "≤ 1.10",
        "/over_max",
        "ratio",
    ),
    asked("Ways that were missed or invented", "0", "/missed", ""),
    asked(
        "Parts of ways that go through walls",
        "0",
        "/through_walls",
        "",
    ),
    asked("Places between which there is none", "", "/none", ""),
    asked("Time of a way, median", "", "/time_us", "µs"),
    asked(
        "Time of a way, largest of the medians of a grid",
        "",
        "/time_max_us",
        "µs",
    ),
];

/// Pairs of places of a grid.
const PAIRS: usize = 100;

/// Cells of a side.
const SIDE: u32 = 40;

fn random_grid(random: &mut Random, closed: f32) -> WalkGrid {
    let mut grid = WalkGrid::flat(Vec2::new(-3.0, 7.0), 0.5, UVec2::splat(SIDE))
        .expect("a grid of this size is one");
    // Walls of some cells along an axis, and single cells.
    for _ in 0..((SIDE * SIDE) as f32 * closed / 4.0) as u32 {
        let at = IVec2::new(random.below(SIDE) as i32, random.below(SIDE) as i32);
        let way = if random.bits() & 1 == 0 {
            IVec2::X
        } else {
            IVec2::Y
        };
        for step in 0..1 + random.below(7) as i32 {
            grid.set(at + way * step, false);
        }
    }
    grid
}

fn open_place(grid: &WalkGrid, random: &mut Random) -> Vec2 {
    loop {
        let span = grid.size().as_vec2() * grid.cell();
        let at = grid.origin() + Vec2::new(random.unit(), random.unit()) * span;
        if grid.is_open(at) {
            return at;
        }
    }
}

#[derive(Default)]
struct Tally {
    ratios: Vec<f64>,
    missed: usize,
    through: usize,
    none: usize,
    times: Vec<f64>,
}

fn one_grid(seed: u64) -> Tally {
    let mut random = Random::new(seed);
    let grid = random_grid(&mut random, 0.1 + 0.02 * (seed % 8) as f32);
    let corners = Corners::new(&grid);
    let mut scratch = PathScratch::default();
    let mut tally = Tally::default();
    for _ in 0..PAIRS {
        let (from, to) = (
            open_place(&grid, &mut random),
            open_place(&grid, &mut random),
        );
        let start = Instant::now();
        let path = find_path(&grid, from, to, &mut scratch);
        tally.times.push(start.elapsed().as_secs_f64() * 1e6);
        match (path, corners.shortest(&grid, from, to)) {
            (None, None) => tally.none += 1,
            (Some(path), Some(best)) => {
                let walls = path
                    .windows(2)
                    .filter(|pair| !is_clear(&grid, units(&grid, pair[0]), units(&grid, pair[1])));
                tally.through += walls.count();
                // Ends are rounded to 1/512 of a cell, which counts on a way shorter than a metre.
                if best > 1.0 {
                    tally.ratios.push(path_length(&path) / best);
                }
            }
            _ => tally.missed += 1,
        }
    }
    tally
}

fn run(options: &Options) -> Report {
    let grids = options
        .count
        .unwrap_or(10_000)
        .max(1)
        .div_ceil(PAIRS * 9 / 10);
    let seeds: Vec<u64> = (0..grids as u64)
        .map(|k| u64::from(options.seed) * 1_000_003 + k)
        .collect();
    let tallies = on_all_cores(&seeds, |seed| one_grid(*seed));
    let ratios: Vec<f64> = tallies.iter().flat_map(|t| &t.ratios).copied().collect();
    let sum = |of: fn(&Tally) -> usize| tallies.iter().map(of).sum::<usize>();
    let medians: Vec<f64> = tallies
        .iter()
        .filter_map(|t| median(t.times.clone()))
        .collect();
    Report {
        study: STUDY.name,
        rows: Vec::new(),
        figures: Vec::new(),
        notes: vec![format!(
            "{grids} grids of {SIDE} × {SIDE} cells, 10 to 24 % of them begun as walls; ways of a metre and more."
        )],
        summary: json!({
            "ways": ratios.len(),
            "over_mean": ratios.iter().sum::<f64>() / ratios.len().max(1) as f64,
            "over_max": ratios.iter().copied().fold(0.0, f64::max),
            "shorter_than_shortest": ratios.iter().filter(|ratio| **ratio < 1.0 - 0.01).count(),
            "missed": sum(|t| t.missed),
            "through_walls": sum(|t| t.through),
            "none": sum(|t| t.none),
            "time_us": median(medians.clone()),
            "time_max_us": medians.iter().copied().fold(0.0, f64::max),
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_are_nearly_the_shortest() {
        let options = Options {
            count: Some(700),
            ..Options::default()
        };
        let summary = run(&options).summary;
        assert!(summary["ways"].as_u64() >= Some(500), "{summary}");
        for what in ["missed", "through_walls", "shorter_than_shortest"] {
            assert_eq!(summary[what], 0, "{what}: {summary}");
        }
        assert!(summary["over_mean"].as_f64() <= Some(1.02), "{summary}");
        assert!(summary["over_max"].as_f64() <= Some(1.10), "{summary}");
    }
}
