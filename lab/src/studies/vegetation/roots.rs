//! Roots and ranks: what moves, how many stand, how many candidates a core looks at.

use std::collections::HashMap;
use std::hint::black_box;
use std::time::Instant;

use bevy::math::DVec2;
use dolomite_terrain::GroundPoint;
use dolomite_testkit::metrics::{Hash64, median};
use dolomite_testkit::random::Random;
use dolomite_vegetation::density::NO_CLUMPS;
use dolomite_vegetation::place::{RANK_BITS, salted, threshold};
use dolomite_vegetation::{Growth, Lattice, Root};

use super::rows::row;
use crate::csv::Row;

/// How far from the origin half of the cameras are, metres.
pub const FAR: f64 = 1e6;

pub struct Moved {
    pub moved: u64,
    pub looked_at: u64,
    pub hash: u64,
}

/// Cameras that wander and come back: each lists the roots in a square about it. A root that any camera sees
/// elsewhere, with another rank or another hash than the first one did, has moved.
pub fn moved(lattice: Lattice, seed: u32, cameras: usize) -> Moved {
    let mut random = Random::new(seed);
    let mut known: HashMap<[i32; 2], (Root, GroundPoint)> = HashMap::new();
    let mut found = Moved {
        moved: 0,
        looked_at: 0,
        hash: 0,
    };
    for camera in 0..cameras {
        // Some 12 m of ground in all, so that cameras see the same roots again and again.
        let far = if camera % 2 == 0 { 0.0 } else { FAR };
        let at = DVec2::new(far + 12.0 * random.unit(), -far + 12.0 * random.unit());
        let reach = DVec2::splat(0.2 + 0.8 * random.unit());
        let [least, most] = [at - reach, at + reach].map(GroundPoint::new);
        let mut seen = 0_u64;
        for cell in lattice.cells(least, most) {
            let root = lattice.root(cell);
            let place = lattice.place(root);
            seen += 1;
            let first = known.entry(cell).or_insert((root, place));
            found.moved += u64::from(*first != (root, place));
        }
        found.looked_at += seen;
        // Each cell of the square once: fewer would be roots that are not there for this camera.
        let [from, to] = [least, most].map(|place| lattice.cell_of(place));
        let cells = i64::from(to[0] - from[0] + 1) * i64::from(to[1] - from[1] + 1);
        found.moved += seen.abs_diff(cells as u64);
    }
    let mut all: Vec<_> = known.into_values().collect();
    all.sort_by_key(|(root, _)| root.cell);
    let mut hash = Hash64::default();
    for (root, _) in all {
        hash.add((u64::from(root.hash) << 32) | u64::from(root.rank));
    }
    found.hash = hash.finish();
    found
}

pub struct Density {
    pub error: f64,
    pub outside: u64,
    pub count: u64,
}

/// Roots on a field whose heights and slopes go past both borders of the bands, against the integral in f64.
pub fn density(growth: Growth) -> Density {
    let growth = Growth {
        clump_size: NO_CLUMPS,
        ..growth
    };
    let ([low, high, steep], [least, most, edge]) = (growth.height, growth.slope);
    let side = 1024;
    let (mut count, mut outside, mut integral) = (0_u64, 0_u64, 0.0);
    for z in 0..side {
        for x in 0..side {
            let root = growth.lattice.root([x, z]);
            let height = low - 20.0 + (high - low + 40.0) * x as f32 / side as f32;
            let slope = z as f32 / side as f32;
            if growth.stands(root, height, slope) {
                count += 1;
                let inside = height > low && height < high && slope > least && slope < most;
                outside += u64::from(!inside);
            }
            let ramp = |x: f32, from: f32, to: f32, steep: f32| {
                let [x, from, to, steep] = [x, from, to, steep].map(f64::from);
                ((x - from).min(to - x) * steep).clamp(0.0, 1.0)
            };
            integral += f64::from(growth.full)
                * ramp(height, low, high, steep)
                * ramp(slope, least, most, edge);
        }
    }
    Density {
        error: (count as f64 / integral - 1.0).abs(),
        outside,
        count,
    }
}

/// Cover of discs, all of them and 1/16 of them with 16 times the area.
pub struct Share {
    pub lambda_a: f64,
    pub full: f64,
    pub nested: f64,
    pub random: f64,
}

impl Share {
    pub fn nested_lost(&self) -> f64 {
        (1.0 - self.nested / self.full).abs()
    }

    pub fn random_lost(&self) -> f64 {
        (1.0 - self.random / self.full).abs()
    }

    pub fn row(&self) -> Row {
        let mut row = row(
            "cover by share",
            "nested rank",
            "discs",
            self.lambda_a,
            "cover at 1/16",
        );
        row.error_unit = "share".into();
        row.parameter = format!(
            "full={:.4} nested={:.4} random={:.4}",
            self.full, self.nested, self.random
        );
        row
    }
}

/// Cells along a side of a square of discs, a torus.
const SIDE: i32 = 128;

/// Samples along a side of a cell.
const FINE: usize = 4;

pub fn shares(lattice: Lattice) -> Vec<Share> {
    [0.25, 1.0, 2.0]
        .into_iter()
        .map(|lambda_a| {
            // The mean over squares of the plane: one square of 64 discs is a sample of its own.
            let mean = |share: f64, nested: bool| {
                let covers =
                    (0..6).map(|k| cover(lattice, [k * SIDE, -k * SIDE], lambda_a, share, nested));
                covers.sum::<f64>() / 6.0
            };
            Share {
                lambda_a,
                full: mean(1.0, true),
                nested: mean(1.0 / 16.0, true),
                random: mean(1.0 / 16.0, false),
            }
        })
        .collect()
}

fn cover(lattice: Lattice, first: [i32; 2], lambda_a: f64, share: f64, nested: bool) -> f64 {
    let samples = SIDE as usize * FINE;
    let radius = (lambda_a / share / std::f64::consts::PI).sqrt() * FINE as f64;
    let limit = threshold(share as f32);
    let mut hit = vec![false; samples * samples];
    for k in 0..SIDE * SIDE {
        let root = lattice.root([first[0] + k % SIDE, first[1] + k / SIDE]);
        let rank = if nested {
            root.rank
        } else {
            salted(root.hash, 77) >> (32 - RANK_BITS)
        };
        if rank >= limit {
            continue;
        }
        let part = |k: u32| f64::from(k) / 65_536.0;
        let at = [
            (f64::from(k % SIDE) + part(root.at >> 16)) * FINE as f64,
            (f64::from(k / SIDE) + part(root.at & 0xFFFF)) * FINE as f64,
        ];
        let span =
            |x: f64| ((x - radius - 0.5).ceil() as i64)..=((x + radius - 0.5).floor() as i64);
        for y in span(at[1]) {
            for x in span(at[0]) {
                let d = [x as f64 + 0.5 - at[0], y as f64 + 0.5 - at[1]];
                if d[0] * d[0] + d[1] * d[1] < radius * radius {
                    let wrap = |k: i64| k.rem_euclid(samples as i64) as usize;
                    hit[wrap(y) * samples + wrap(x)] = true;
                }
            }
        }
    }
    hit.iter().filter(|hit| **hit).count() as f64 / hit.len() as f64
}

pub struct Speed {
    pub candidates_ms: f64,
    pub standing_ms: f64,
}

/// Candidates that one core makes in a millisecond, and those that it also holds to a density with clumps.
pub fn speed(growth: Growth, repeats: usize) -> Speed {
    const COUNT: i32 = 200_000;
    let timed = |work: &dyn Fn(i32) -> u32| {
        let times = (0..repeats.max(1)).map(|_| {
            let start = Instant::now();
            let sum = (0..COUNT).fold(0_u32, |sum, k| sum.wrapping_add(work(k)));
            black_box(sum);
            start.elapsed().as_secs_f64() * 1e3
        });
        f64::from(COUNT) / median(times.collect()).unwrap_or(f64::NAN)
    };
    Speed {
        candidates_ms: timed(&|k| growth.lattice.root([k & 511, k >> 9]).rank),
        standing_ms: timed(&|k| {
            let root = growth.lattice.root([k & 511, k >> 9]);
            u32::from(growth.stands(root, 200.0, 0.1))
        }),
    }
}
