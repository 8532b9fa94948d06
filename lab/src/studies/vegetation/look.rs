//! Cover and colour by distance, and how fast widths change: by the law, the shapes and the colours that are drawn.

use bevy::math::ops;
use dolomite_vegetation::blade::SEGMENTS;
use dolomite_vegetation::colour::calm_at;
use dolomite_vegetation::density::NO_CLUMPS;
use dolomite_vegetation::kind::Blade;
use dolomite_vegetation::law::evened;
use dolomite_vegetation::reference::{Manner, Seen, crowding_of, draw, field_of, mean};
use dolomite_vegetation::shade::FarField;
use dolomite_vegetation::{Growth, Law};
use serde_json::{Value, json};

use super::rows::row;
use crate::csv::Row;

/// Side of the measured ground, metres.
pub const SIDE: f32 = 8.0;

/// Pixels a radian: 1080 lines over 60 degrees.
pub const PIXELS: f32 = 935.0;

/// Height of a blade in pixels below which it has 7 vertices, and 3: as it is drawn.
const LOD_PIXELS: [f32; 2] = [48.0, 14.0];

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
    blades: Seen,
    ours: Seen,
}

impl Ring {
    /// Whether no blade has begun to end there.
    pub fn is_near(&self, law: Law) -> bool {
        slant(self.eye, self.distance) <= f64::from(law.fade)
    }

    /// With the far-field term where blades end.
    pub fn cover_error(&self) -> f64 {
        (self.ours.cover - self.all.cover).abs()
    }

    /// Of the blades alone.
    pub fn blades_error(&self) -> f64 {
        (self.blades.cover - self.all.cover).abs()
    }

    /// Of the colour that covers, weighed by the cover: what a pixel differs by over black soil.
    pub fn colour_error(&self) -> f64 {
        let parts = self.ours.colour.iter().zip(self.all.colour);
        let differ = parts.map(|(ours, all)| (ours - all).abs());
        differ.fold(0.0, f64::max) * self.all.cover
    }

    pub fn row(&self) -> Row {
        let mut row = row(
            "rings",
            "law and far field",
            "distance",
            self.distance,
            "cover",
        );
        row.parameter = format!(
            "eye={} cover={:.5} blades={:.5} all={:.5}",
            self.eye, self.ours.cover, self.blades.cover, self.all.cover
        );
        row.error_unit = "share".into();
        row
    }

    pub fn summary(&self) -> Value {
        json!({
            "eye_m": self.eye,
            "distance_m": self.distance,
            "cover_all": self.all.cover,
            "cover_blades": self.blades.cover,
            "cover": self.ours.cover,
            "colour_255": 255.0 * self.colour_error(),
        })
    }
}

/// Blades over ground that shows the far field: what a ray meets first.
fn over(blades: Seen, ground: Seen) -> Seen {
    let below = (1.0 - blades.cover) * ground.cover;
    let cover = blades.cover + below;
    let of = |k: usize| blades.cover * blades.colour[k] + below * ground.colour[k];
    Seen {
        cover,
        colour: [0, 1, 2].map(|k| if cover > 0.0 { of(k) / cover } else { 0.0 }),
    }
}

/// Every ring is the mean of so many squares.
pub fn rings(blade: &Blade, (growth, law): (Growth, Law), seed: u32, fields: i32) -> Vec<Ring> {
    let growth = Growth {
        clump_size: NO_CLUMPS,
        ..growth
    };
    let far = FarField::fit(blade, &growth);
    let first = [(seed as i32 & 0xFFF) * 256, -7 * 256];
    let field = field_of(&growth, SIDE, 512, first);
    let mut rings = Vec::new();
    for eye in EYES {
        for distance in RINGS {
            let away = slant(eye, distance);
            let sine = (eye / away).max(LEAST) as f32;
            let all = mean(field, fields, |field| {
                draw(field, blade, &growth, sine, |_| 1.0, Manner::FINEST)
            });
            let away = away as f32;
            let pixels = blade.length.1 * PIXELS / away;
            let lod = LOD_PIXELS.iter().filter(|least| pixels < **least).count();
            let manner = Manner {
                segments: SEGMENTS[lod],
                calm: calm_at(law.first, away),
            };
            let even = evened(crowding_of(blade, &growth), law.kept(away));
            let width = |rank| law.width_of(rank, away) * even;
            let mut blades = mean(field, fields, |field| {
                draw(field, blade, &growth, sine, width, manner)
            });
            let cover = far.at(sine, 1.0 - law.cover(away));
            let ground = Seen {
                cover: f64::from(cover.share),
                colour: cover.colour.map(f64::from),
            };
            let settled = f64::from(law.settled(away));
            for (own, far) in blades.colour.iter_mut().zip(ground.colour) {
                *own += (far - *own) * settled;
            }
            rings.push(Ring {
                eye,
                distance,
                all,
                blades,
                ours: over(blades, ground),
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

/// By how much the width of a blade changes on the screen in a frame of 1/60 s, beyond what its distance alone does.
pub fn popping(blade: &Blade, law: Law) -> Popping {
    let own = f64::from(blade.width) * f64::from(PIXELS);
    let reach = f64::from(law.reach);
    let pixels = |rank: f32, distance: f64, from: f64| {
        f64::from(law.width_of(rank, distance as f32)) * own / from
    };
    // Ranks by ratio: those that stay to the end are few.
    let ranks = || (0..200).map(|k| ops::powf(0.97, k as f32));
    let fastest = |step: f64| {
        let mut most: f64 = 0.0;
        for rank in ranks() {
            let mut distance = 1.0;
            while distance < reach {
                // On the screen at the same distance: what is left is the level of detail's own.
                let change =
                    pixels(rank, distance + step, distance) - pixels(rank, distance, distance);
                most = most.max(change.abs());
                // Frame after frame: a change between two of them is seen wherever it is.
                distance += step;
            }
        }
        most
    };
    // The width at which a blade is first seen: that of the last frame in which it was not.
    let entering = |step: f64| {
        let mut most: f64 = 0.0;
        for rank in ranks() {
            let mut distance = reach;
            while distance > 1.0 && pixels(rank, distance, distance) == 0.0 {
                distance -= step;
            }
            most = most.max(pixels(rank, distance, distance));
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A law that draws half of what it should is seen by the measure.
    #[test]
    fn what_is_missing_is_found() {
        let (blade, growth, law) = super::super::grass(1);
        let half = Growth {
            full: 0.25 * growth.full,
            clump_size: NO_CLUMPS,
            ..growth
        };
        let field = field_of(&growth, 4.0, 256, [0, 0]);
        let seen = |width: f32| {
            mean(field, 2, |field| {
                draw(field, &blade, &half, 0.6, |_| width, Manner::FINEST)
            })
        };
        let [all, less] = [1.0, 0.5].map(seen);
        let ring = Ring {
            eye: 1.7,
            distance: 5.0,
            all,
            blades: less,
            ours: over(less, Seen::default()),
        };
        assert!(ring.cover_error() > 0.05 && ring.blades_error() == ring.cover_error());
        assert!(law.reach > 0.0);
        let whole = over(less, all);
        assert!((whole.cover - (1.0 - (1.0 - all.cover) * (1.0 - less.cover))).abs() < 1e-12);
    }

    /// Widths that appear at once are seen by the measure: a reach without a fade.
    #[test]
    fn jumps_are_found() {
        let (blade, _, law) = super::super::grass(1);
        let sudden = Law {
            fade: law.reach - 0.01,
            ..law
        };
        assert!(popping(&blade, sudden).walking > 0.5);
        assert!(popping(&blade, law).walking < 0.1);
    }
}
