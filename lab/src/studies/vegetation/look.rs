//! Cover and colour by distance, and how fast widths change.

use dolomite_vegetation::density::NO_CLUMPS;
use dolomite_vegetation::kind::Blade;
use dolomite_vegetation::reference::{Field, Seen, draw, mean};
use dolomite_vegetation::shade::FarField;
use dolomite_vegetation::{Fade, Growth};
use serde_json::{Value, json};

use super::rows::row;
use crate::csv::Row;

/// Side of the measured ground, metres.
pub const SIDE: f32 = 8.0;

/// Squares of that side that a ring is the mean of.
pub const FIELDS: i32 = 8;

/// Up to here blades are drawn, beyond is the ground's own shade, metres.
pub const HAND_OVER: f64 = 120.0;

/// All blades have their own width up to here: one of 11 mm is then a pixel wide at 935 pixels a radian.
const NEAR: f32 = 9.4;

/// Pixels a radian: 1080 lines over 60 degrees.
const PIXELS: f64 = 935.0;

/// The least sine of an elevation that is measured.
const LEAST: f64 = 0.005;

/// Distances of the rings, metres.
const RINGS: [f64; 8] = [5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0, 1000.0];

/// Heights of the eye, metres.
const EYES: [f64; 3] = [1.7, 8.0, 60.0];

pub struct Ring {
    eye: f64,
    distance: f64,
    all: Seen,
    ours: Seen,
}

impl Ring {
    pub fn cover_error(&self) -> f64 {
        (self.ours.cover - self.all.cover).abs()
    }

    /// Of the colour that covers, weighed by the cover: what a pixel differs by over black soil.
    pub fn colour_error(&self) -> f64 {
        let parts = self.ours.colour.iter().zip(self.all.colour);
        let differ = parts.map(|(ours, all)| (ours - all).abs());
        differ.fold(0.0, f64::max) * self.all.cover
    }

    pub fn row(&self) -> Row {
        let method = if self.distance <= HAND_OVER {
            "blades by rank"
        } else {
            "far field"
        };
        let mut row = row("rings", method, "distance", self.distance, "cover");
        row.parameter = format!(
            "eye={} cover={:.5} all={:.5}",
            self.eye, self.ours.cover, self.all.cover
        );
        row.error_unit = "share".into();
        row
    }

    pub fn summary(&self) -> Value {
        json!({
            "eye_m": self.eye,
            "distance_m": self.distance,
            "cover_all": self.all.cover,
            "cover": self.ours.cover,
            "colour_255": 255.0 * self.colour_error(),
        })
    }
}

pub fn rings(blade: &Blade, growth: Growth, seed: u32) -> Vec<Ring> {
    let growth = Growth {
        clump_size: NO_CLUMPS,
        ..growth
    };
    let far = FarField::fit(blade, &growth);
    let fade = Fade::new(NEAR, 1e9);
    let field = Field {
        cells: (SIDE / growth.lattice.pitch()) as i32,
        samples: 512,
        first: [(seed as i32 & 0xFFF) * 64, -7 * 64],
    };
    let mut rings = Vec::new();
    for eye in EYES {
        for distance in RINGS {
            let sine = (eye / slant(eye, distance)).max(LEAST) as f32;
            let all = mean(field, FIELDS, |field| {
                draw(field, blade, &growth, sine, |_| 1.0, 7)
            });
            let ours = if distance <= HAND_OVER {
                let shown = fade.at(slant(eye, distance) as f32);
                mean(field, FIELDS, |field| {
                    draw(field, blade, &growth, sine, |rank| shown.width_of(rank), 3)
                })
            } else {
                let cover = far.at(sine, 1.0);
                Seen {
                    cover: f64::from(cover.share),
                    colour: cover.colour.map(f64::from),
                }
            };
            rings.push(Ring {
                eye,
                distance,
                all,
                ours,
            });
        }
    }
    rings
}

pub struct Popping {
    pub walking: f64,
    pub flying: f64,
    pub entering: f64,
}

/// By how much the width of a blade of 11 mm changes on the screen in a frame of 1/60 s, beyond what its distance
/// alone does.
pub fn popping() -> Popping {
    let fade = Fade::new(NEAR, 1e9);
    let pixels = |rank: f32, distance: f64, from: f64| {
        f64::from(fade.at(distance as f32).width_of(rank)) * 0.011 * PIXELS / from
    };
    let fastest = |step: f64| {
        let mut most: f64 = 0.0;
        for rank in (0..200).map(|k| (k as f32 + 0.5) / 200.0) {
            let mut distance = 1.0;
            while distance < HAND_OVER {
                // On the screen at the same distance: what is left is the level of detail's own.
                let change =
                    pixels(rank, distance + step, distance) - pixels(rank, distance, distance);
                most = most.max(change.abs());
                distance += step.max(0.05);
            }
        }
        most
    };
    // The width at which a blade is first seen: that of the last frame in which it was not.
    let entering = |step: f64| {
        let mut most: f64 = 0.0;
        for rank in (1..200).map(|k| k as f32 / 200.0) {
            let mut distance = HAND_OVER;
            while distance > 1.0 && pixels(rank, distance, distance) == 0.0 {
                distance -= step;
            }
            if distance < HAND_OVER {
                most = most.max(pixels(rank, distance, distance));
            }
        }
        most
    };
    Popping {
        walking: fastest(2.0 / 60.0),
        flying: fastest(50.0 / 60.0),
        entering: entering(2.0 / 60.0),
    }
}

/// How far away the ring is through the air.
fn slant(eye: f64, distance: f64) -> f64 {
    (eye * eye + distance * distance).sqrt()
}
