//! Is an error ever above the tolerance that was asked for? Many cameras, hostile ones too, and many places, on what the
//! CPU reference draws; [`super::drawn`] has the same of the triangles that the adapter drew.
//!
//! An error in pixels is the same thing in a picture of any size: with a fourth of the pixels a
//! tolerance asks for a fourth of the angle. Most pictures are small, so that more of them fit a run, and
//! a larger part of their triangles is looked at; of a hundred rounds nine have pictures of 480 × 270, and one has
//! 1920 × 1080 (`size_of`).

use super::judge::{Count, Surface, judge};
use crate::scenes::camera::Camera;
use crate::scenes::cameras::{BURST, KINDS, Kind, around};
use crate::scenes::selection::{FINEST, blocks_of, bound, choose, detail_view};
use crate::scenes::terrains;
use crate::scenes::truth::Truth;
use bevy::math::UVec2;
use dolomite_ground::blocks::kept::KeptBlocks;
use dolomite_terrain::Terrain;
use dolomite_testkit::cores::on_all_cores;
use dolomite_testkit::random::Random;

/// Tolerances, pixels.
pub const TAUS: [f64; 4] = [4.0, 2.0, 1.0, 0.5];
/// Cameras at a place: a burst of each kind.
pub const AT_A_PLACE: usize = BURST * KINDS.len();

/// Measures `cameras` cameras at the tolerances (pixels, the finest last), at some `samples` places each.
#[must_use]
pub fn guarantee(cameras: usize, taus: &[f64], samples: usize, seed: u32) -> Vec<Count> {
    let groups: Vec<(u32, usize)> = (0..cameras.div_ceil(AT_A_PLACE))
        .map(|k| (k as u32, AT_A_PLACE.min(cameras - k * AT_A_PLACE)))
        .collect();
    let parts = on_all_cores(&groups, |&(group, cameras)| {
        let own = seed.wrapping_mul(1000).wrapping_add(group);
        let terrain = ground_of(group, own);
        let counts = at_a_place(&terrain, cameras, group as usize, taus, samples, own);
        for count in counts.iter().filter(|count| count.above() > 0) {
            eprintln!(
                "lod: guarantee: place {group}: {} above: {:?} tau {} reached {} max {} at {} of {:?}",
                count.above(),
                count.kind,
                count.tau,
                count.reached,
                count.tally.max,
                count.tally.worst,
                count.worst,
            );
        }
        eprintln!("lod: guarantee: place {group} of {}", groups.len());
        counts
    });
    let mut all = Vec::new();
    for part in parts {
        merge(&mut all, part);
    }
    all
}

/// The ground that a place's cameras stand on.
pub(super) fn ground_of(group: u32, own: u32) -> Terrain {
    match group % 3 {
        0 => terrains::mountain(own),
        1 => terrains::fbm(own),
        _ => terrains::dem(own),
    }
}

/// The same over one terrain; `round` is the number of the first round of cameras.
#[must_use]
pub fn at_a_place(
    terrain: &Terrain,
    cameras: usize,
    round: usize,
    taus: &[f64],
    samples: usize,
    seed: u32,
) -> Vec<Count> {
    let truth = Truth::new(terrain);
    let mut blocks = blocks_of(terrain, FINEST);
    let mut counts = Vec::new();
    for (number, (kind, camera)) in around(terrain, cameras, seed).into_iter().enumerate() {
        let rounds = round * AT_A_PLACE / KINDS.len() + number / KINDS.len();
        let camera = Camera {
            size: size_of(rounds),
            ..camera
        };
        for &tau in taus {
            let mut random = Random::new(seed.wrapping_add(number as u32 * 7919));
            let count = view(
                &truth,
                &mut blocks,
                (kind, camera),
                tau,
                samples,
                &mut random,
            );
            merge(&mut counts, vec![count]);
        }
    }
    counts
}

/// Picture of a round of cameras.
pub(super) const fn size_of(round: usize) -> UVec2 {
    match round % 100 {
        99 => UVec2::new(1920, 1080),
        k if k % 10 == 9 => UVec2::new(480, 270),
        _ => UVec2::new(240, 135),
    }
}

pub(super) fn merge(all: &mut Vec<Count>, part: Vec<Count>) {
    for count in part {
        let same = all.iter_mut().find(|known| {
            (known.tau, known.kind, known.reached) == (count.tau, count.kind, count.reached)
        });
        let Some(known) = same else {
            all.push(count);
            continue;
        };
        known.views += count.views;
        if count.tally.max > known.tally.max {
            known.worst = count.worst;
        }
        known.tally.merge(&count.tally);
    }
}

/// One camera at one tolerance, as [`judge`] has it.
#[must_use]
pub fn view(
    truth: &Truth,
    blocks: &mut KeptBlocks,
    with: (Kind, Camera),
    tau: f64,
    samples: usize,
    random: &mut Random,
) -> Count {
    let choice = choose(blocks, &detail_view(&with.1, bound(tau)));
    let surface = Surface::of_choice(blocks, &choice);
    judge(truth, &surface, with, tau, samples, random)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::math::DVec3;

    #[test]
    fn a_camera_of_each_kind_on_three_grounds_keeps_to_its_bound() {
        for (k, terrain) in terrains::all(3).iter().enumerate() {
            let counts = at_a_place(
                terrain,
                KINDS.len(),
                0,
                &[8.0, 4.0, 2.0],
                1500,
                5 + k as u32,
            );
            let mut samples = 0;
            for count in &counts {
                let measured = count.measured();
                assert_eq!(count.above(), 0, "{measured:?} {count:?}");
                assert!(measured.is_none_or(|m| m.max <= 1.0 && m.holes == 0));
                samples += count.tally.samples;
            }
            assert!(samples > 10_000, "{samples}");
        }
    }

    /// Eroded noise that is calm at samples and rough between them: with half the tail the error of cells of nine samples a
    /// side was 1.2 times the tolerance here.
    #[test]
    fn a_rough_spot_between_samples_keeps_to_its_bound() {
        let terrain = terrains::dem(1002);
        let eye = DVec3::new(
            6_206.558_701_132_21,
            506.669_648_110_700_7,
            9_548.942_369_941_016,
        );
        let spot = DVec3::new(6277.288, 456.2, 10112.699);
        let away = (spot - eye).normalize();
        // As many pixels a radian as 5 degrees are in 270 lines.
        let size = UVec2::new(96, 54);
        let tangent = 2.5_f64.to_radians().tan() * f64::from(size.y) / 270.0;
        let camera = Camera {
            eye,
            yaw: (-away.x).atan2(-away.z),
            pitch: away.y.asin(),
            roll: 0.0,
            fov_y: 2.0 * tangent.atan(),
            size,
            near: 0.1,
            orthographic: None,
        };
        assert!(camera.view().project(spot).expect("seen").length() < 1e-6);
        let truth = Truth::new(&terrain);
        let mut blocks = blocks_of(&terrain, FINEST);
        let with = (Kind::Narrow, camera);
        let count = view(&truth, &mut blocks, with, 0.5, 30_000, &mut Random::new(1));
        let measured = count.measured().expect("seen");
        println!("{measured:?}");
        assert!(count.above() == 0 && measured.max > 0.4, "{measured:?}");
    }
}
