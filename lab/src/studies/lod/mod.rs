//! Level of detail of a terrain: vertices against the largest error in pixels.
//!
//! Every method draws the same terrain for the same camera; its one knob is turned until the largest
//! error over the same places is the wanted one ([`tune`]); then vertices are compared. An error is
//! the distance on the screen between the true surface and the drawn one at a place of the ground
//! ([`measure`]). All of it runs on the CPU in f64.
//!
//! | module | what |
//! |---|---|
//! | [`camera`], [`cameras`] | projection; cameras over a terrain, hostile ones too |
//! | [`terrains`], [`truth`] | the grounds; their heights, and what f32 is off by |
//! | [`mesh`] | what is drawn, and its height at a place |
//! | [`places`], [`measure`] | where errors are looked for, and what they come to |
//! | [`rival`] | what a method offers |
//! | [`uniform`], [`cdlod`], [`bisected`] | a static grid; CDLOD; equal edges and greedy |
//! | [`bisection`] | the triangles of the last two |
//! | [`tune`] | turns the knob |

pub mod bisected;
pub mod bisection;
pub mod camera;
pub mod cameras;
pub mod cdlod;
pub mod measure;
pub mod mesh;
pub mod places;
pub mod rival;
pub mod terrains;
pub mod truth;
pub mod tune;
pub mod uniform;

use bisected::{Bisected, Priority};
use camera::Camera;
use cdlod::Cdlod;
use dolomite_terrain::Terrain;
use places::Places;
use rival::Rival;
use truth::Truth;
use tune::{TuneError, Tuned, tune};
use uniform::Uniform;

/// A method under a camera.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    /// Number of the camera.
    pub camera: usize,
    /// [`Rival::name`].
    pub rival: &'static str,
    /// What its knob is, with its unit.
    pub knob: &'static str,
    /// What came out.
    pub tuned: Result<Tuned, TuneError>,
}

/// The methods that others are compared with.
#[must_use]
pub fn all_rivals() -> Vec<Box<dyn Rival>> {
    vec![
        Box::new(Uniform),
        Box::new(Cdlod::default()),
        Box::new(Bisected::new(Priority::Edge)),
        Box::new(Bisected::new(Priority::Error)),
    ]
}

/// Places that [`rivals`] measures at, for each camera.
pub const PLACES: usize = 1 << 17;

/// Every method of [`all_rivals`] under every camera at `wanted` pixels of error.
#[must_use]
pub fn rivals(terrain: &Terrain, cameras: &[Camera], wanted: f64, seed: u32) -> Vec<Row> {
    compare(&all_rivals(), terrain, cameras, (wanted, PLACES), seed)
}

/// These methods under every camera at `wanted` pixels of error over some `places` places, the same
/// for all methods. A line a method goes to standard error.
#[must_use]
pub fn compare(
    methods: &[Box<dyn Rival>],
    terrain: &Terrain,
    cameras: &[Camera],
    (wanted, places): (f64, usize),
    seed: u32,
) -> Vec<Row> {
    let truth = Truth::new(terrain);
    let mut rows = Vec::new();
    for (number, camera) in cameras.iter().enumerate() {
        let view = camera.view();
        let here = Places::new(&truth, &view, places, seed);
        let fresh = Places::new(&truth, &view, places, seed.wrapping_add(1));
        for method in methods {
            let tuned = tune(&**method, &truth, camera, (&here, &fresh), wanted);
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
                rival: method.name(),
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
    use bevy::math::{DVec2, DVec3, UVec2};

    #[test]
    fn zz_numbers() {
        let terrain = terrains::mountain(1);
        let count: usize = std::env::var("LOD_PLACES").map_or(20_000, |s| s.parse().unwrap());
        let truth = Truth::new(&terrain);
        println!("bound {}", truth.f32_bound);
        let xz = DVec2::new(-1500.0, 3200.0);
        let ground = truth.height(xz);
        println!("ground {ground}");
        let t = std::time::Instant::now();
        let mut sum = 0.0;
        for k in 0..10000 {
            sum += truth.height(xz + f64::from(k));
        }
        println!("f64 {:?} {sum}", t.elapsed() / 10000);
        let base = Camera {
            eye: DVec3::new(xz.x, ground + 1.7, xz.y),
            yaw: -38.0_f64.to_radians(),
            pitch: 0.0,
            roll: 0.0,
            fov_y: 60.0_f64.to_radians(),
            size: UVec2::new(1920, 1080),
            near: 0.1,
            orthographic: None,
        };
        let t = std::time::Instant::now();
        let p = Places::new(&truth, &base.view(), count, 1);
        println!("places {} {:?}", p.xz.len(), t.elapsed());
        let flying = Camera {
            eye: base.eye + DVec3::Y * 150.0,
            pitch: -0.2,
            ..base
        };
        let above = Camera {
            eye: DVec3::new(0.0, 4000.0, 6000.0),
            pitch: -0.6,
            yaw: 0.0,
            ..base
        };
        let pick: Vec<usize> = std::env::var("LOD_RIVALS").map_or(vec![0, 1, 2, 3], |s| {
            s.split(',').map(|k| k.parse().unwrap()).collect()
        });
        let mut methods: Vec<_> = all_rivals().into_iter().map(Some).collect();
        let methods: Vec<_> = pick.iter().map(|&k| methods[k].take().unwrap()).collect();
        let wanted = std::env::var("LOD_WANTED").map_or(8.0, |s| s.parse().unwrap());
        let t = std::time::Instant::now();
        for row in compare(
            &methods,
            &terrain,
            &[base, flying, above],
            (wanted, count),
            1,
        ) {
            println!("{row:?}");
        }
        println!("{:?}", t.elapsed());
    }
}
