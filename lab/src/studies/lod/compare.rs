//! Methods beside each other under the same cameras, each with its knob turned to the same error.

use super::baseline::{AtMost, Baseline};
use super::bisected::{Bisected, Priority};
use super::cdlod::Cdlod;
use super::tune::{TuneError, Tuned, tune};
use super::uniform::Uniform;
use crate::scenes::camera::Camera;
use crate::scenes::places::Places;
use crate::scenes::truth::Truth;
use dolomite_terrain::Terrain;

/// A method under a camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Number of the camera.
    pub camera: usize,
    /// [`Baseline::name`].
    pub baseline: &'static str,
    /// What its knob is, with its unit.
    pub knob: &'static str,
    /// What came out.
    pub tuned: Result<Tuned, TuneError>,
}

/// The methods that others are compared with.
#[must_use]
pub fn all_baselines() -> Vec<Box<dyn Baseline>> {
    vec![
        Box::new(Uniform),
        Box::new(Cdlod::default()),
        Box::new(Bisected::new(Priority::Edge)),
        Box::new(Bisected::new(Priority::Error)),
    ]
}

/// Places that [`baselines`] measures at, for each camera.
pub const PLACES: usize = 1 << 17;

/// Every method of [`all_baselines`] under every camera at `wanted` pixels of error.
#[must_use]
pub fn baselines(terrain: &Terrain, cameras: &[Camera], wanted: f64, seed: u32) -> Vec<Row> {
    let budget = (wanted, PLACES);
    compare(&all_baselines(), terrain, cameras, budget, None, seed)
}

/// These methods under every camera at `wanted` pixels of error over some `places` places, the same
/// for all methods. `most`: as many vertices a method may draw, as a multiple of the first method's. A line
/// a method goes to standard error.
#[must_use]
pub fn compare(
    methods: &[Box<dyn Baseline>],
    terrain: &Terrain,
    cameras: &[Camera],
    (wanted, places): (f64, usize),
    most: Option<f64>,
    seed: u32,
) -> Vec<Row> {
    let truth = Truth::new(terrain);
    let mut rows = Vec::new();
    for (number, camera) in cameras.iter().enumerate() {
        let view = camera.view();
        let here = Places::new(&truth, &view, places, seed);
        let fresh = Places::new(&truth, &view, places, seed.wrapping_add(1));
        let mut limit = u64::MAX;
        for (k, method) in methods.iter().enumerate() {
            let method = AtMost {
                baseline: &**method,
                vertices: limit,
            };
            let tuned = tune(&method, &truth, camera, (&here, &fresh), wanted);
            if let (0, Some(most), Ok(first)) = (k, most, &tuned) {
                limit = (first.vertices as f64 * most) as u64;
            }
            match &tuned {
                Ok(tuned) => eprintln!(
                    "lod: camera {number}: {}: {} vertices, {} triangles, knob {}, error {:.4} \
                     ({:.4} elsewhere), p99 {:.4}, {} draws",
                    method.name(),
                    tuned.vertices,
                    tuned.triangles,
                    tuned.knob,
                    tuned.measured.max,
                    tuned.fresh.max,
                    tuned.measured.p99,
                    tuned.draws,
                ),
                Err(error) => eprintln!("lod: camera {number}: {}: {error}", method.name()),
            }
            rows.push(Row {
                camera: number,
                baseline: method.name(),
                knob: method.knob().name,
                tuned,
            });
        }
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::{cameras, terrains};

    #[test]
    fn all_baselines_meet_the_error_and_the_one_that_knows_it_draws_least() {
        let terrain = terrains::fbm(1);
        let cameras = cameras::ordinary(&terrain);
        let wanted = 16.0;
        let rows = compare(
            &all_baselines(),
            &terrain,
            &cameras[1..],
            (wanted, 4000),
            None,
            1,
        );
        assert_eq!(rows.len(), 8);
        for rows in rows.chunks(4) {
            let tuned: Vec<Tuned> = rows.iter().map(|row| row.tuned.unwrap()).collect();
            let [uniform, cdlod, edges, greedy] = tuned[..] else {
                panic!("four baselines");
            };
            for tuned in &tuned {
                assert!(tuned.measured.max <= wanted, "{tuned:?}");
                assert_eq!(tuned.measured.holes, 0);
            }
            assert!(greedy.vertices < cdlod.vertices && greedy.vertices < edges.vertices);
            assert!(greedy.vertices < uniform.vertices, "{rows:?}");
            // The error that greedy found for itself is the one that is measured, but for places
            // between its own; a knob beyond it would mean that one of the two is blind.
            let own = greedy.knob / greedy.measured.max;
            assert!((0.5..1.5).contains(&own), "{own}");
        }
    }
}
