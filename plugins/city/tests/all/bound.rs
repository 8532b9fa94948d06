//! The bound of the error: drawn triangles against the surface in f64.

use dolomite_city::hash::{pcg, unit};
use dolomite_city::levels::Eye;
use dolomite_city::{CityPatch, CityRules, ErrorBound};
use dolomite_tessellation::{Domain, Levels, Spacing, tessellate};

use crate::support::{MAPS, patches};

/// Greatest error of samples of a patch, over the tolerance.
fn worst(
    bound: &ErrorBound,
    rules: &CityRules,
    eye: &Eye,
    patch: &CityPatch,
    samples: u32,
) -> Option<f64> {
    let levels = bound.levels(eye, patch);
    if !ErrorBound::is_kept(&levels) {
        return None;
    }
    let mesh = tessellate(
        Domain::Quads,
        Spacing::FractionalOdd,
        Levels {
            outer: levels.outer,
            inner: levels.inner,
        },
    );
    let map = &MAPS[patch.data.map[3] as usize];
    let band = rules.relief.band;
    let drawn: Vec<[f64; 3]> = mesh
        .coordinates
        .iter()
        .map(|[u, v, _]| {
            let height = patch.data.relief(map, band, *u, *v).height;
            [f64::from(*u), f64::from(*v), f64::from(height)]
        })
        .collect();
    let triangles = mesh.primitives.triangles();
    let mut greatest = 0.0_f64;
    for k in 0..samples {
        let hash = pcg(k ^ pcg(patch.corners[0][0].to_bits() ^ eye.at.x.to_bits()));
        let triangle = triangles[hash as usize % triangles.len()];
        let [a, b] = [pcg(hash), pcg(hash ^ 77)].map(|h| f64::from(unit(h)));
        let (a, b) = if a + b > 1.0 {
            (1.0 - a, 1.0 - b)
        } else {
            (a, b)
        };
        let weights = [1.0 - a - b, a, b];
        let mut at = [0.0; 3];
        for (weight, corner) in weights.into_iter().zip(triangle) {
            for (sum, value) in at.iter_mut().zip(drawn[corner as usize]) {
                *sum += weight * value;
            }
        }
        let [u, v, height] = at;
        let exact = patch.data.exact(map, f64::from(band), u, v);
        let place = patch.exact(map, f64::from(band), u, v);
        let away = place.distance(eye.at.as_dvec3());
        let pixels = (exact - height).abs() * f64::from(eye.pixels_per_radian) / away;
        greatest = greatest.max(pixels / f64::from(bound.tolerance));
    }
    Some(greatest)
}

fn eyes() -> impl Iterator<Item = Eye> {
    (0..8_u32).map(|k| {
        let [x, y, z] = [1, 2, 3].map(|salt| unit(pcg(k ^ (salt << 20))));
        Eye {
            at: bevy::math::Vec3::new(x * 160.0, 1.7 + y * y * 20.0, z * 160.0),
            pixels_per_radian: 935.0,
        }
    })
}

/// Patches that the stage's greatest level does not cut off. Faces whose sides taper are off by more: their flat
/// part is not linear in u and v. Rectangles alone are compared at one place of the plane.
#[test]
fn no_sample_is_off_by_more_than_the_tolerance() {
    let rules = CityRules::default();
    let patches = patches(&rules, 5);
    for tolerance in [0.5, 1.0, 4.0] {
        let bound = ErrorBound::new(&rules, &MAPS, tolerance);
        let (mut greatest, mut kept, mut cut) = (0.0_f64, 0, 0);
        for eye in eyes() {
            for patch in patches
                .iter()
                .filter(|p| p.data.face[0] == p.data.across[3])
            {
                match worst(&bound, &rules, &eye, patch, 24) {
                    Some(error) => {
                        greatest = greatest.max(error);
                        kept += 1;
                    }
                    None => cut += 1,
                }
            }
        }
        println!("tolerance {tolerance}: {greatest:.3} of it; {kept} patches kept, {cut} cut off");
        assert!(greatest <= 1.0, "{greatest} at {tolerance}");
        assert!(kept > 1000 && greatest > 0.05, "{kept} {greatest}");
    }
}

/// The comparison can fail: with a bend that is a hundredth of the true one.
#[test]
fn a_bound_that_is_too_small_is_seen() {
    let rules = CityRules::default();
    let patches = patches(&rules, 5);
    let mut bound = ErrorBound::new(&rules, &MAPS, 0.5);
    for bend in &mut bound.bend {
        *bend *= 0.01;
    }
    bound.border_bend *= 0.01;
    let greatest = eyes()
        .flat_map(|eye| patches.iter().step_by(25).map(move |patch| (eye, patch)))
        .filter_map(|(eye, patch)| worst(&bound, &rules, &eye, patch, 24))
        .fold(0.0, f64::max);
    assert!(greatest > 1.0, "{greatest}");
}
