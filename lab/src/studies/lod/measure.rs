//! The error of what is drawn, in pixels.
//!
//! At a place (x, z) it is the distance on the screen between (x, true, z) and (x, drawn, z), where
//! either of the two is seen; both surfaces are the sea where they lie below it. Where nothing is
//! drawn over ground that is seen, the error is infinite.

use crate::scenes::camera::View;
use crate::scenes::mesh::Drawn;
use crate::scenes::places::{KEPT_PIXELS, Places};
use crate::scenes::truth::Truth;
use bevy::math::{DVec2, DVec3};
use dolomite_testkit::cores::on_all_cores;
use serde::{Deserialize, Serialize};
use std::sync::atomic::{AtomicU64, Ordering};

/// What a measurement comes to, pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measured {
    /// The largest error, in f64.
    pub max: f64,
    /// Where it is, (x, z) in metres.
    pub worst: DVec2,
    /// 99 % of the errors stay at or below this; may be off by the 0.1 pixels to which heights are
    /// kept, and by 1.1 % of itself, the width of a bin.
    pub p99: f64,
    /// Root of the mean square error; may be off by 0.1 pixels as well.
    pub rms: f64,
    /// How many errors went in.
    pub samples: u64,
    /// Of these, places where nothing was drawn.
    pub holes: u64,
}

/// Bins of the histogram for a doubling of the error.
const BINS: f64 = 64.0;
/// Its first bin holds all errors up to 2 to this power, pixels.
const LEAST: f64 = -24.0;
/// Its last bin holds all from 2 to this power on.
const MOST: f64 = 24.0;
/// Places handed to a core at once.
const CHUNK: usize = 1 << 13;
/// Every which place has the centre and the middles of the sides of its triangle measured as well:
/// the errors of a triangle are largest about there.
const PROBED: usize = 8;

/// A place with what is known there.
pub(super) struct Sample {
    /// Where it is, (x, z) in metres.
    pub xz: DVec2,
    /// Height of the true surface, and how far it may be off, metres.
    pub truth: (f64, f64),
    /// Height of the drawn one; `None` where nothing is drawn.
    pub drawn: Option<f64>,
}

/// Measures at `places`, and at the centres and middles of sides of the triangles of one place in
/// eight. `None` if no place is seen.
///
/// Heights of the truth are f32 where that is off by at most 0.1 pixels. Every error that may be the
/// largest when that much is added is found once more in f64: the maximum is that of f64. Only
/// whether a place at the very border of the screen counts is decided by the height that is kept.
#[must_use]
pub fn measure(truth: &Truth, view: &View, drawn: &dyn Drawn, places: &Places) -> Option<Measured> {
    // Bits of the largest f64 error found so far; of numbers from 0 they are ordered like these.
    let best = AtomicU64::new(0);
    let chunks: Vec<usize> = (0..places.xz.len()).step_by(CHUNK).collect();
    let tallies = on_all_cores(&chunks, |&start| {
        let range = start..places.xz.len().min(start + CHUNK);
        let mut tally = Tally::default();
        let mut probes = Vec::new();
        let samples: Vec<Sample> = range
            .map(|k| {
                let xz = places.xz[k];
                let found = drawn.triangle(xz);
                if k % PROBED == 0
                    && let Some((corners, _)) = found
                {
                    probes.extend(middles(corners));
                }
                Sample {
                    xz,
                    truth: places.height[k],
                    drawn: found.map(|([a, b, c], [u, v, w])| a.y * u + b.y * v + c.y * w),
                }
            })
            .collect();
        tally.add(truth, view, samples, &best);
        let heights = truth.heights(view, &probes, KEPT_PIXELS);
        let samples = probes.iter().zip(heights).map(|(&xz, truth)| Sample {
            xz,
            truth,
            drawn: drawn.height(xz),
        });
        tally.add(truth, view, samples.collect(), &best);
        tally
    });
    let mut all = Tally::default();
    for tally in &tallies {
        all.merge(tally);
    }
    all.finish()
}

/// Centre of a triangle and middles of its sides, (x, z).
fn middles([a, b, c]: [DVec3; 3]) -> [DVec2; 4] {
    [
        (a + b + c) / 3.0,
        (a + b) / 2.0,
        (b + c) / 2.0,
        (c + a) / 2.0,
    ]
    .map(|p| DVec2::new(p.x, p.z))
}

/// The error at a place; `None` where neither surface is seen.
fn error(truth: &Truth, view: &View, xz: DVec2, height: f64, drawn: Option<f64>) -> Option<f64> {
    let drawn = drawn.unwrap_or(f64::NEG_INFINITY).max(truth.sea());
    let at = |y: f64| DVec3::new(xz.x, y, xz.y);
    if drawn == f64::NEG_INFINITY {
        return view.sees(at(height)).then_some(f64::INFINITY);
    }
    if !(view.sees(at(height)) || view.sees(at(drawn))) {
        return None;
    }
    view.pixels_beyond_near(at(height), at(drawn))
}

/// Errors of a part of the places. Kept as [`Kept`].
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(from = "Kept", into = "Kept")]
pub(super) struct Tally {
    /// See [`Measured`].
    pub max: f64,
    /// See [`Measured`].
    pub worst: DVec2,
    squares: f64,
    /// See [`Measured`].
    pub samples: u64,
    /// See [`Measured`].
    pub holes: u64,
    /// Errors above this are counted, each found in f64; pixels.
    limit: f64,
    /// How many there are.
    pub above: u64,
    bins: Vec<u64>,
}

/// A [`Tally`] for a file: JSON has no infinities, and most bins are empty.
#[derive(Serialize, Deserialize)]
struct Kept {
    /// `None` where there are no samples, or where there is a hole.
    max: Option<f64>,
    worst: [f64; 2],
    squares: Option<f64>,
    samples: u64,
    holes: u64,
    limit: Option<f64>,
    above: u64,
    bins: Vec<(usize, u64)>,
}

impl From<Tally> for Kept {
    fn from(tally: Tally) -> Self {
        let finite = |x: f64| x.is_finite().then_some(x);
        let filled = tally.bins.iter().copied().enumerate();
        Self {
            max: finite(tally.max),
            worst: tally.worst.to_array(),
            squares: finite(tally.squares),
            samples: tally.samples,
            holes: tally.holes,
            limit: finite(tally.limit),
            above: tally.above,
            bins: filled.filter(|(_, count)| *count > 0).collect(),
        }
    }
}

impl From<Kept> for Tally {
    fn from(kept: Kept) -> Self {
        let mut tally = Self::counting_above(kept.limit.unwrap_or(f64::INFINITY));
        tally.max = match kept.max {
            Some(max) => max,
            None if kept.samples > 0 => f64::INFINITY,
            None => f64::NEG_INFINITY,
        };
        tally.worst = DVec2::from_array(kept.worst);
        tally.squares = kept.squares.unwrap_or(f64::INFINITY);
        (tally.samples, tally.holes, tally.above) = (kept.samples, kept.holes, kept.above);
        for (bin, count) in kept.bins {
            if let Some(known) = tally.bins.get_mut(bin) {
                *known = count;
            }
        }
        tally
    }
}

impl Default for Tally {
    fn default() -> Self {
        Self::counting_above(f64::INFINITY)
    }
}

impl Tally {
    /// Nothing yet; errors above `limit` pixels will be counted.
    pub(super) fn counting_above(limit: f64) -> Self {
        Self {
            limit,
            above: 0,
            max: f64::NEG_INFINITY,
            worst: DVec2::ZERO,
            squares: 0.0,
            samples: 0,
            holes: 0,
            bins: vec![0; ((MOST - LEAST) * BINS) as usize + 1],
        }
    }

    /// Adds samples. `best` holds the bits of the largest f64 error that is known so far.
    pub(super) fn add(
        &mut self,
        truth: &Truth,
        view: &View,
        samples: Vec<Sample>,
        best: &AtomicU64,
    ) {
        let mut open = Vec::new();
        for sample in &samples {
            let &Sample {
                xz,
                truth: (height, off),
                drawn,
            } = sample;
            let Some(found) = error(truth, view, xz, height, drawn) else {
                continue;
            };
            self.samples += 1;
            self.holes += u64::from(drawn.is_none() && found == f64::INFINITY);
            self.squares += found * found;
            self.bins[bin(found)] += 1;
            if off == 0.0 {
                self.take(found, xz, best);
            } else {
                let more = view.pixels_at_most(DVec3::new(xz.x, height, xz.y), off);
                open.push((found + more, sample));
            }
        }
        // The most promising first; once one cannot be the largest, none can.
        open.sort_by(|a, b| b.0.total_cmp(&a.0));
        for (at_most, sample) in open {
            let known = f64::from_bits(best.load(Ordering::Relaxed));
            if at_most < known && at_most <= self.limit {
                break;
            }
            let height = truth.height(sample.xz);
            if let Some(found) = error(truth, view, sample.xz, height, sample.drawn) {
                self.take(found, sample.xz, best);
            }
        }
    }

    fn take(&mut self, error: f64, xz: DVec2, best: &AtomicU64) {
        self.above += u64::from(error > self.limit);
        if error > self.max {
            (self.max, self.worst) = (error, xz);
            best.fetch_max(error.to_bits(), Ordering::Relaxed);
        }
    }

    /// A place of the ground where nothing is drawn: an infinite error if the view sees it.
    pub(super) fn hole(&mut self, view: &View, place: DVec3) {
        if view.sees(place) {
            self.samples += 1;
            self.holes += 1;
            self.above += 1;
            self.bins[bin(f64::INFINITY)] += 1;
            (self.max, self.worst) = (f64::INFINITY, DVec2::new(place.x, place.z));
        }
    }

    /// Takes in what another part has found.
    pub(super) fn merge(&mut self, other: &Self) {
        if other.max > self.max {
            (self.max, self.worst) = (other.max, other.worst);
        }
        self.squares += other.squares;
        self.samples += other.samples;
        self.holes += other.holes;
        self.above += other.above;
        for (bin, more) in self.bins.iter_mut().zip(&other.bins) {
            *bin += more;
        }
    }

    /// What it comes to; `None` without samples.
    pub(super) fn finish(&self) -> Option<Measured> {
        if self.samples == 0 {
            return None;
        }
        let rank = (self.samples * 99).div_ceil(100);
        let mut passed = 0;
        let bin = self.bins.iter().position(|count| {
            passed += count;
            passed >= rank
        });
        // The upper end of the bin, and no more than the maximum.
        let upper = (bin? as f64 / BINS + LEAST).exp2();
        Some(Measured {
            max: self.max,
            worst: self.worst,
            p99: if bin? + 1 == self.bins.len() {
                self.max
            } else {
                upper.min(self.max)
            },
            rms: (self.squares / self.samples as f64).sqrt(),
            samples: self.samples,
            holes: self.holes,
        })
    }
}

/// The bin of an error: bin k ends at 2^(k/64 − 24).
fn bin(error: f64) -> usize {
    ((error.log2().clamp(LEAST, MOST) - LEAST) * BINS).ceil() as usize
}

#[cfg(test)]
mod tests {
    use super::super::baseline::Baseline;
    use super::super::uniform::Uniform;
    use super::*;
    use crate::scenes::mesh::GroundMesh;
    use crate::scenes::{cameras, terrains};
    use dolomite_terrain::{GroundRect, Hill, Layer, Source, Terrain, TerrainData};

    fn flat(sea_level: Option<f32>) -> Truth {
        let data = TerrainData {
            extent: GroundRect::square(DVec2::ZERO, 1000.0),
            layers: Vec::new(),
            base: 12.5,
            sea_level,
        };
        Truth::new(&Terrain::new(data).unwrap())
    }

    /// A square of the extent, its height changed by `lift` at all corners.
    fn square(truth: &Truth, view: &View, lift: f64) -> GroundMesh {
        let e = truth.terrain.extent();
        let at = |x, z| DVec3::new(x, 12.5 + lift, z);
        let corners = vec![
            at(e.min.x, e.min.y),
            at(e.max.x, e.min.y),
            at(e.min.x, e.max.y),
            at(e.max.x, e.max.y),
        ];
        GroundMesh::new(corners, vec![[0, 2, 3], [0, 3, 1]], view)
    }

    #[test]
    fn a_plane_has_no_error_and_a_lifted_one_the_error_by_hand() {
        let truth = flat(None);
        let camera = cameras::Kind::Orthographic;
        let camera = cameras::camera(&truth.terrain, camera, 1);
        let view = camera.view();
        let places = Places::new(&truth, &view, 5000, 1);
        let found = measure(&truth, &view, &square(&truth, &view, 0.0), &places).unwrap();
        // Heights of 12.5 m over coordinates of 500 m: rounding.
        assert!(found.max < 1e-9 && found.samples > 2000, "{found:?}");
        let lifted = measure(&truth, &view, &square(&truth, &view, 0.25), &places).unwrap();
        // A vertical 1/4 m, foreshortened by the cosine of the pitch.
        let expected = 0.25 * view.scale * camera.pitch.cos();
        for error in [lifted.max, lifted.rms] {
            assert!((error / expected - 1.0).abs() < 1e-6, "{error} {expected}");
        }
        assert!((lifted.p99 / expected - 1.0).abs() < 0.012);
        // The sea covers the ground, but not the lifted square all the way.
        let sea = flat(Some(12.65));
        let found = measure(&sea, &view, &square(&truth, &view, 0.25), &places);
        let places_at_sea = Places::new(&sea, &view, 5000, 1);
        let same = measure(&sea, &view, &square(&truth, &view, 0.25), &places_at_sea).unwrap();
        assert!((same.max / expected - 0.4).abs() < 1e-5, "{same:?}");
        assert!(found.is_some());
    }

    #[test]
    fn nothing_drawn_is_an_infinite_error_and_nothing_seen_is_none() {
        let truth = flat(None);
        let camera = cameras::camera(&truth.terrain, cameras::Kind::Standing, 1);
        let view = camera.view();
        let places = Places::new(&truth, &view, 2000, 1);
        let empty = GroundMesh::new(Vec::new(), Vec::new(), &view);
        let found = measure(&truth, &view, &empty, &places).unwrap();
        assert_eq!((found.max, found.holes), (f64::INFINITY, found.samples));
        let sky = crate::scenes::camera::Camera {
            pitch: 80.0_f64.to_radians(),
            ..camera
        };
        let mesh = square(&truth, &sky.view(), 0.0);
        assert_eq!(measure(&truth, &sky.view(), &mesh, &places), None);
    }

    #[test]
    fn the_maximum_is_that_of_f64_over_all_places() {
        let truth = Truth::new(&terrains::mountain(1));
        let camera = cameras::camera(&truth.terrain, cameras::Kind::Flying, 2);
        let view = camera.view();
        let grid = Uniform.draw(&truth, &camera, 40.0).unwrap();
        let places = Places::new(&truth, &view, 1500, 1);
        let found = measure(&truth, &view, &*grid, &places).unwrap();
        let mut all = places.xz.clone();
        for &xz in places.xz.iter().step_by(PROBED) {
            if let Some((corners, _)) = grid.triangle(xz) {
                all.extend(middles(corners));
            }
        }
        let brute = all
            .iter()
            .filter_map(|&xz| error(&truth, &view, xz, truth.height(xz), grid.height(xz)))
            .fold(0.0, f64::max);
        assert_eq!(found.max, brute);
        assert!(found.max > 1.0 && found.p99 < found.max && found.rms < found.p99);
    }

    #[test]
    fn a_grid_over_a_hill_errs_as_its_curvature_says() {
        // h = 100 (1 − r²/R²)³ has the second derivative −600/R² at the top: halfway along a side
        // s the chord lies 300/R² (s/2)² below, in the middle of a diagonal twice that.
        let radius = 10_000.0;
        let truth = Truth::new(
            &Terrain::new(TerrainData {
                extent: GroundRect::square(DVec2::ZERO, 1024.0),
                layers: vec![Layer {
                    source: Source::Hill(Hill {
                        centre: DVec2::ZERO,
                        radius: radius as f32,
                        height: 100.0,
                    }),
                    mask: None,
                }],
                base: 0.0,
                sea_level: None,
            })
            .unwrap(),
        );
        let camera = cameras::camera(&truth.terrain, cameras::Kind::Orthographic, 1);
        let view = camera.view();
        let places = Places::new(&truth, &view, 20_000, 1);
        let grid = Uniform.draw(&truth, &camera, 32.0).unwrap();
        let found = measure(&truth, &view, &*grid, &places).unwrap();
        let sag = 2.0 * 300.0 / (radius * radius) * 16.0 * 16.0;
        let expected = sag * view.scale * camera.pitch.cos();
        // Over 512 m the curvature falls by 1 %.
        assert!(
            (found.max / expected - 1.0).abs() < 0.02,
            "{found:?} {expected}"
        );
    }
}
