//! What is controlled: time by tolerance, frame for frame, along a flight over synthetic terrain.
//!
//! It is not the controller's own model: vertices follow a sum of two power laws and a floor of hard
//! edges, bent towards what the finest level has; time is not proportional to vertices; what the
//! work curve predicts is off by some percent, differently in each place.

use dolomite_geometry::budget::WorkCurve;
use dolomite_testkit::random::Random;

/// Frames a second of the flight.
pub const RATE: f64 = 60.0;
/// Frames of a leg; each begins with a teleport but the first.
pub const LEG: usize = 600;
/// Legs of a flight: two minutes.
pub const LEGS: usize = 12;
/// Standard deviation of the measured time, as a part of it.
pub const NOISE: f64 = 0.03;
/// How often a frame takes longer for no reason of its own, and by which part.
const SPIKE: (f64, f64) = (0.003, 0.2);
/// (frame, factor of all time) of a second app that comes and goes.
const LOADS: [(usize, f64); 4] = [(1500, 1.35), (2700, 1.0), (4500, 1.25), (5900, 1.0)];
/// Range of tolerances of a work curve, pixels.
const CURVE: (f32, f32) = (0.25, 64.0);

/// What happens to a frame that a controller cannot have seen in earlier ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event {
    /// The camera is put elsewhere.
    Teleport,
    /// The load changes.
    Load,
}

/// A flight whose time depends on the tolerance. Real work curves take the place of synthetic ones by
/// another implementation.
pub trait Plant {
    /// How many frames it has.
    fn frames(&self) -> usize;
    /// What the selection predicts of a frame before it is drawn.
    fn curve(&self, frame: usize) -> WorkCurve;
    /// Triangles that are drawn with a tolerance, pixels.
    fn triangles(&self, frame: usize, tau: f64) -> f64;
    /// Time without noise, milliseconds.
    fn milliseconds(&self, frame: usize, tau: f64) -> f64;
    /// Measured over noise-free time.
    fn disturbance(&self, frame: usize) -> f64;
    /// What happens at a frame.
    fn event(&self, frame: usize) -> Option<Event>;
    /// Whether the camera stands or walks.
    fn is_calm(&self, frame: usize) -> bool;
    /// First frames of the legs.
    fn legs(&self) -> Vec<usize> {
        let teleport = |frame: &usize| self.event(*frame) == Some(Event::Teleport);
        core::iter::once(0)
            .chain((0..self.frames()).filter(teleport))
            .collect()
    }
}

/// What a place asks for.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// ln of the millions of vertices at 1 px, of both laws.
    amounts: [f64; 2],
    exponents: [f64; 2],
    /// Millions of vertices of hard edges, and of the finest level.
    edges: f64,
    finest: f64,
    /// ms.
    fixed: f64,
    /// ms a million vertices.
    each: f64,
    /// Predicted over drawn vertices.
    predicted: f64,
}

/// How much a leg moves: standing, walking, flying.
const MOTIONS: [f64; 3] = [0.0, 0.08, 0.6];

/// The synthetic terrain.
pub struct MadeUp {
    places: Vec<Place>,
    disturbances: Vec<f64>,
}

/// A uniform number between two.
fn between(random: &mut Random, low: f64, high: f64) -> f64 {
    low + (high - low) * f64::from(random.next_u32()) / 4_294_967_296.0
}

/// A number of mean 0 and standard deviation 1: twelve uniform ones, centred.
fn normal(random: &mut Random) -> f64 {
    (0..12).map(|_| between(random, 0.0, 1.0)).sum::<f64>() - 6.0
}

#[expect(
    clippy::disallowed_methods,
    reason = "a plant of a study; libm differs by an ulp at most, its noise is 3 %"
)]
mod real {
    pub fn exp(x: f64) -> f64 {
        x.exp()
    }
    pub fn pow(x: f64, y: f64) -> f64 {
        x.powf(y)
    }
    pub fn sin(x: f64) -> f64 {
        x.sin()
    }
}

impl MadeUp {
    /// Same seed, same flight.
    pub fn new(seed: u32) -> Self {
        let mut random = Random::new(seed);
        let places = (0..LEGS)
            .map(|_| {
                let r = &mut random;
                Place {
                    amounts: [between(r, -1.2, 0.9), between(r, -1.2, 0.9)],
                    exponents: [between(r, 0.5, 0.9), between(r, 1.0, 1.5)],
                    edges: between(r, 0.0, 0.05),
                    finest: between(r, 6.0, 12.0),
                    fixed: between(r, 0.15, 0.4),
                    each: between(r, 0.85, 1.15),
                    predicted: between(r, 0.9, 1.1),
                }
            })
            .collect();
        let disturbances = (0..LEG * LEGS)
            .map(|_| {
                let noise = 1.0 + NOISE * normal(&mut random);
                let spike = between(&mut random, 0.0, 1.0) < SPIKE.0;
                noise * if spike { 1.0 + SPIKE.1 } else { 1.0 }
            })
            .collect();
        Self {
            places,
            disturbances,
        }
    }

    /// The place and how far the camera has moved about it, by three waves of 10, 4 and 1.7 s.
    fn place(&self, frame: usize) -> Place {
        let leg = frame / LEG;
        let mut place = self.places[leg];
        let t = (frame % LEG) as f64 / RATE;
        let wave = |period: f64, phase: f64| {
            let turn = |t: f64| real::sin(std::f64::consts::TAU * (t / period + phase));
            turn(t) - turn(0.0)
        };
        let motion = MOTIONS[leg % MOTIONS.len()];
        place.amounts[0] += motion * (wave(10.0, 0.1) + 0.3 * wave(4.0, 0.7));
        place.amounts[1] += motion * (wave(10.0, 0.4) + 0.3 * wave(1.7, 0.2));
        place.fixed *= 1.0 + 0.3 * motion * wave(4.0, 0.3);
        place.each *= 1.0 + 0.1 * motion * wave(10.0, 0.8);
        place.predicted *= 1.0 + 0.05 * motion * wave(4.0, 0.5);
        place
    }
}

impl Place {
    /// Millions of vertices.
    fn millions(&self, tau: f64) -> f64 {
        let law = |i: usize| real::exp(self.amounts[i]) * real::pow(tau, -self.exponents[i]);
        let wanted = law(0) + law(1) + self.edges;
        // A soft least of both.
        let bent = |x: f64| x * x * x * x;
        1.0 / (1.0 / bent(wanted) + 1.0 / bent(self.finest)).sqrt().sqrt()
    }
}

impl Plant for MadeUp {
    fn frames(&self) -> usize {
        LEG * LEGS
    }

    fn curve(&self, frame: usize) -> WorkCurve {
        let place = self.place(frame);
        let tolerances =
            WorkCurve::tolerances(CURVE.0, CURVE.1).expect("the range of the curve is one");
        let counts =
            tolerances.map(|tau| (1e6 * place.predicted * place.millions(f64::from(tau))) as f32);
        WorkCurve::new(CURVE.0, CURVE.1, counts).expect("counts are finite")
    }

    fn triangles(&self, frame: usize, tau: f64) -> f64 {
        1.9e6 * self.place(frame).millions(tau)
    }

    fn milliseconds(&self, frame: usize, tau: f64) -> f64 {
        let place = self.place(frame);
        let millions = place.millions(tau);
        // A half-idle machine at few vertices, quads of small triangles at many.
        let geometry = place.each * (real::pow(millions, 0.95) + 0.03 * millions * millions);
        let load = LOADS.iter().rev().find(|(from, _)| frame >= *from);
        (place.fixed + geometry) * load.map_or(1.0, |load| load.1)
    }

    fn disturbance(&self, frame: usize) -> f64 {
        self.disturbances[frame]
    }

    fn event(&self, frame: usize) -> Option<Event> {
        if frame > 0 && frame.is_multiple_of(LEG) {
            return Some(Event::Teleport);
        }
        let load = LOADS.iter().any(|(from, _)| *from == frame);
        load.then_some(Event::Load)
    }

    fn is_calm(&self, frame: usize) -> bool {
        MOTIONS[frame / LEG % MOTIONS.len()] < 0.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coarser_is_cheaper_everywhere_and_flights_differ_by_seed_alone() {
        let plant = MadeUp::new(3);
        for frame in (0..plant.frames()).step_by(97) {
            let times = [0.25, 0.5, 1.0, 4.0, 16.0, 64.0].map(|tau| plant.milliseconds(frame, tau));
            assert!(times.windows(2).all(|pair| pair[1] < pair[0]), "{times:?}");
        }
        let same = MadeUp::new(3);
        let other = MadeUp::new(4);
        let times = |plant: &MadeUp| plant.milliseconds(1000, 1.0) * plant.disturbance(1000);
        assert_eq!(times(&plant), times(&same));
        assert_ne!(times(&plant), times(&other));
    }

    #[test]
    fn noise_has_the_size_that_is_said() {
        let plant = MadeUp::new(1);
        let n = plant.frames() as f64;
        let off = |frame| plant.disturbance(frame) - 1.0;
        let mean = (0..plant.frames()).map(off).sum::<f64>() / n;
        let squares: f64 = (0..plant.frames()).map(|f| off(f) * off(f)).sum();
        let expected = (NOISE * NOISE + SPIKE.0 * SPIKE.1 * SPIKE.1).sqrt();
        // 7200 samples give a standard deviation to 0.8 %, spikes (22 of them) to some 3 %.
        assert!(((squares / n).sqrt() / expected - 1.0).abs() < 0.1);
        assert!(mean.abs() < 0.003, "{mean}");
    }

    #[test]
    fn a_flight_has_its_legs_and_loads() {
        let plant = MadeUp::new(1);
        assert_eq!(plant.legs().len(), LEGS);
        let loads = (0..plant.frames()).filter(|f| plant.event(*f) == Some(Event::Load));
        assert_eq!(loads.count(), LOADS.len());
        let ratio = plant.milliseconds(1500, 1.0) / plant.milliseconds(1499, 1.0);
        assert!((ratio / 1.35 - 1.0).abs() < 0.02);
    }
}
