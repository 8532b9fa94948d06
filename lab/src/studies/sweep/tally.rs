//! Answers beside the truth, counted.

use crate::studies::beside::Touch;
use bevy::math::DVec3;
use dolomite_testkit::metrics::{ErrorStats, Hash64, median};
use dolomite_testkit::sweeps::Swept;
use serde_json::{Value, json};

/// Nearer to a radius than this, in radii, f64 does not say whether it hits.
pub const DOUBT: f64 = 1e-9;

/// A depth, in radii, that f32 sees at any of the places of the study but those 1e5 m away.
pub const CLEARLY: f64 = 1e-3;

/// Of one kind by one method.
#[derive(Default)]
pub struct Tally {
    /// Contacts that were not found.
    pub missed: u64,
    /// Those of them that nobody should miss.
    pub missed_clearly: u64,
    /// Contacts that are none.
    pub invented: u64,
    /// Those of them that nobody should find.
    pub invented_clearly: u64,
    /// Errors of times, parts of the way.
    pub times: Vec<f64>,
    /// Errors of normals, radians; 2 where it points to the wrong side.
    pub normals: Vec<f64>,
    /// Of the times.
    pub hash: Hash64,
}

impl Tally {
    /// Counts an answer.
    pub fn add(&mut self, answer: Touch, truth: &Swept) {
        self.hash.add(answer.map_or(1, |(time, _)| time.to_bits()));
        // What starts in contact is only met if it moves further in.
        let meets = truth.start > 1.0 || truth.rate > 1e-9;
        let must = truth.least < 1.0 - DOUBT && meets;
        let Some((time, normal)) = answer else {
            self.missed += u64::from(must);
            let clearly = truth.start > 1.0 + CLEARLY && truth.least < 1.0 - CLEARLY;
            self.missed_clearly += u64::from(clearly);
            return;
        };
        if truth.least > 1.0 + DOUBT {
            self.invented += 1;
            self.invented_clearly += u64::from(truth.least > 1.0 + CLEARLY);
        } else if must {
            self.times.push((time - truth.time).abs());
            let true_normal = DVec3::from(truth.normal);
            if true_normal != DVec3::ZERO {
                let sine = normal.cross(true_normal).length();
                let same_side = normal.dot(true_normal) > 0.0;
                self.normals.push(if same_side { sine } else { 2.0 });
            }
        }
    }
}

/// Of all kinds by one method.
#[derive(Clone, Default)]
pub struct Total {
    missed: [u64; 2],
    invented: [u64; 2],
    time: [f64; 2],
    normal: [f64; 2],
    /// Nanoseconds of each kind.
    pub ns: Vec<f64>,
}

impl Total {
    /// Adds a kind.
    pub fn add(&mut self, tally: Tally, ns: f64) {
        let counts = [tally.missed, tally.missed_clearly];
        self.missed = [0, 1].map(|i| self.missed[i] + counts[i]);
        let counts = [tally.invented, tally.invented_clearly];
        self.invented = [0, 1].map(|i| self.invented[i] + counts[i]);
        let larger = |known: [f64; 2], errors: Vec<f64>| {
            ErrorStats::of(errors).map_or(known, |stats| {
                [known[0].max(stats.max), known[1].max(stats.p99)]
            })
        };
        self.time = larger(self.time, tally.times);
        self.normal = larger(self.normal, tally.normals);
        self.ns.push(ns);
    }

    /// As the report has it.
    pub fn to_json(&self) -> Value {
        json!({
            "missed": self.missed[0],
            "missed_clearly": self.missed[1],
            "invented": self.invented[0],
            "invented_clearly": self.invented[1],
            "time_max": self.time[0],
            "time_p99": self.time[1],
            "normal_max_rad": self.normal[0],
            "normal_p99_rad": self.normal[1],
            "ns": median(self.ns.clone()),
        })
    }
}
