//! Is an error ever above the tolerance that was asked for? Many cameras, hostile ones too, and many
//! places.
//!
//! Every triangle that may be seen is looked at in its centre and in the middles of its sides, where the
//! errors of smooth ground are largest, and at random places; so places are as dense as triangles are. The
//! rest of the ground, which is not drawn, is looked at as well: a place of it that is seen is a hole.
//!
//! An error in pixels is the same thing in a picture of any size: with a fourth of the pixels a
//! tolerance asks for a fourth of the angle. Most pictures are small, so that more of them fit a run, and
//! a larger part of their triangles is looked at; of a hundred rounds nine have pictures of 480 × 270, and one has
//! 1920 × 1080 (`size_of`).

use super::measure::{Measured, Sample, Tally};
use crate::scenes::camera::{Camera, View};
use crate::scenes::cameras::{BURST, KINDS, Kind, around};
use crate::scenes::selection::{FINEST, bound, cells_of, choose, detail_view, positions};
use crate::scenes::terrains;
use crate::scenes::truth::Truth;
use bevy::math::{DVec2, DVec3, UVec2};
use dolomite_ground::detail::{DetailCells, DetailMesh, Selection, mesh};
use dolomite_terrain::Terrain;
use dolomite_testkit::cores::on_all_cores;
use dolomite_testkit::random::Random;
use std::sync::atomic::AtomicU64;

/// Tolerances, pixels.
pub const TAUS: [f64; 4] = [4.0, 2.0, 1.0, 0.5];
/// Cameras at a place: a burst of each kind.
pub const AT_A_PLACE: usize = BURST * KINDS.len();
/// Of this many places one is for ground that is not drawn.
const UNDRAWN: usize = 16;

/// Errors over one tolerance, and one kind of camera.
#[derive(Debug, Clone)]
pub struct Count {
    /// Pixels.
    pub tau: f64,
    /// What the camera is there for.
    pub kind: Kind,
    /// Whether the finest cell was reached: the bound that holds is then the one that the selection
    /// reports.
    pub reached: bool,
    /// Views that were measured.
    pub views: u64,
    /// Errors over the bound: 1 is the bound itself.
    pub(super) tally: Tally,
    /// Where the largest is.
    pub worst: Option<(Camera, f64)>,
}

impl Count {
    /// Errors over the bound.
    #[must_use]
    pub fn measured(&self) -> Option<Measured> {
        self.tally.finish()
    }

    /// How many errors are above the bound.
    #[must_use]
    pub fn above(&self) -> u64 {
        self.tally.above
    }
}

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
    let mut cells = cells_of(terrain, FINEST);
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
                &mut cells,
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

/// One camera at one tolerance.
#[must_use]
pub fn view(
    truth: &Truth,
    cells: &mut DetailCells,
    (kind, camera): (Kind, Camera),
    tau: f64,
    samples: usize,
    random: &mut Random,
) -> Count {
    let selection = choose(cells, &detail_view(&camera, bound(tau)));
    let reached = selection.held > 1.0;
    let limit = if reached {
        tau * f64::from(selection.held)
    } else {
        tau
    };
    let own = camera.view();
    let mut known = Vec::with_capacity(samples + samples / 8);
    let drawn = triangles_of(&mesh::mesh(cells, &selection));
    places(drawn, &own, samples, random, |at| known.push(at));
    let mut tally = errors(truth, &own, limit, &known);
    let rest = triangles_of(&mesh::mesh(cells, &unseen(selection)));
    known.clear();
    places(rest, &own, samples / UNDRAWN, random, |at| known.push(at));
    for xz in known.iter().map(|at| DVec2::new(at.x, at.z)) {
        tally.hole(&own, DVec3::new(xz.x, truth.height(xz), xz.y));
    }
    Count {
        tau,
        kind,
        reached,
        views: 1,
        worst: Some((camera, limit)),
        tally,
    }
}

/// Errors over the bound at places of the drawn surface: 1 is `limit` pixels.
pub(super) fn errors(truth: &Truth, view: &View, limit: f64, drawn: &[DVec3]) -> Tally {
    // In units of the bound: as if a pixel were as large.
    let scaled = View {
        scale: view.scale / limit,
        half: view.half / limit,
        ..*view
    };
    let mut tally = Tally::counting_above(1.0);
    let best = AtomicU64::new(0);
    for part in drawn.chunks(1 << 13) {
        let xz: Vec<DVec2> = part.iter().map(|at| DVec2::new(at.x, at.z)).collect();
        // Of the bound: so much may the percentile be off, the maximum and the count are of f64.
        let heights = truth.heights(&scaled, &xz, 0.1);
        let with = part.iter().zip(xz).zip(heights);
        let with = with.map(|((at, xz), truth)| Sample {
            xz,
            truth,
            drawn: Some(at.y),
        });
        tally.add(truth, &scaled, with.collect(), &best);
    }
    tally
}

/// The corners of every triangle, world metres.
fn triangles_of(mesh: &DetailMesh) -> Vec<[DVec3; 3]> {
    let positions = positions(mesh);
    let corners = |t: &[u32; 3]| t.map(|k| positions[k as usize]);
    mesh.triangles.iter().map(corners).collect()
}

/// The ground that is not drawn in place of that which is.
fn unseen(mut selection: Selection) -> Selection {
    for cell in selection.depths.iter_mut().flatten() {
        cell.seen = !cell.seen;
    }
    for root in &mut selection.whole_roots {
        root.1 = !root.1;
    }
    selection
}

/// Calls `found` with some `count` places of triangles that may be seen: each triangle as often as another,
/// or every k-th if there are too many.
pub(super) fn places(
    mut triangles: Vec<[DVec3; 3]>,
    view: &View,
    count: usize,
    random: &mut Random,
    mut found: impl FnMut(DVec3),
) {
    triangles.retain(|&[a, b, c]| {
        // What is drawn may lie beside what is there: by a quarter of the triangle.
        let lift = DVec3::Y * 0.25 * a.distance(b).max(b.distance(c)).max(c.distance(a));
        view.may_see(&[a + lift, b + lift, c + lift, a - lift, b - lift, c - lift])
    });
    // Four places a triangle at least.
    let every = (4 * triangles.len()).div_ceil(count.max(4)).max(1);
    let first = (random.unit() * every as f64) as usize;
    triangles = triangles.into_iter().skip(first).step_by(every).collect();
    let each = count / triangles.len().max(1);
    for [a, b, c] in triangles {
        let fixed = [
            (a + b + c) / 3.0,
            (a + b) / 2.0,
            (b + c) / 2.0,
            (c + a) / 2.0,
        ];
        for k in 0..each.max(fixed.len()) {
            let at = fixed.get(k).copied().unwrap_or_else(|| {
                let (mut u, mut v) = (random.unit(), random.unit());
                if u + v > 1.0 {
                    (u, v) = (1.0 - u, 1.0 - v);
                }
                a + (b - a) * u + (c - a) * v
            });
            found(at);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn a_hole_and_an_error_above_the_bound_are_seen() {
        let terrain = terrains::fbm(1);
        let truth = Truth::new(&terrain);
        let mut cells = cells_of(&terrain, FINEST);
        let (kind, camera) = around(&terrain, 2, 1)[1];
        let of = |cells: &mut DetailCells, tau: f64, camera: Camera| {
            view(
                &truth,
                cells,
                (kind, camera),
                tau,
                2000,
                &mut Random::new(1),
            )
        };
        assert_eq!(of(&mut cells, 4.0, camera).above(), 0);
        // A mesh for 32 pixels is measured against 1.
        let coarse = choose(&mut cells, &detail_view(&camera, bound(32.0)));
        let drawn = triangles_of(&mesh::mesh(&cells, &coarse));
        let mut known = Vec::new();
        let mut random = Random::new(1);
        places(drawn, &camera.view(), 2000, &mut random, |at| {
            known.push(at)
        });
        let sample = |at: DVec3, hole: bool| {
            let xz = DVec2::new(at.x, at.z);
            Sample {
                xz,
                truth: (truth.height(xz), 0.0),
                drawn: (!hole).then_some(at.y),
            }
        };
        for hole in [false, true] {
            let mut tally = Tally::counting_above(1.0);
            let samples = known.iter().map(|&known| sample(known, hole)).collect();
            tally.add(&truth, &camera.view(), samples, &AtomicU64::new(0));
            assert!(
                tally.above > 100 && (tally.holes > 100) == hole,
                "{tally:?}"
            );
        }
    }

    /// Eroded noise that is calm where a cell has its samples and rough between them: with half the tail the
    /// error here was 1.2 times the tolerance.
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
        let mut cells = cells_of(&terrain, FINEST);
        let with = (Kind::Narrow, camera);
        let count = view(&truth, &mut cells, with, 0.5, 30_000, &mut Random::new(1));
        let measured = count.measured().expect("seen");
        println!("{measured:?}");
        assert!(count.above() == 0 && measured.max > 0.4, "{measured:?}");
    }
}
