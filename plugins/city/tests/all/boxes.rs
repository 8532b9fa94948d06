//! Boxes hold every displaced vertex, and no more room than displacement takes.

use bevy::math::Vec3;
use dolomite_city::hash::{pcg, unit};
use dolomite_city::{CityBox, CityRules, triangles};

use crate::support::{MAPS, patches};

#[test]
fn boxes_hold_what_is_displaced_and_are_loose_by_the_amplitude_at_most() {
    let rules = CityRules::default();
    let band = rules.relief.band;
    let mut held = 0_u64;
    for (k, patch) in patches(&rules, 4).iter().enumerate() {
        let bounds = CityBox::of_patch(patch);
        let map = &MAPS[patch.data.map[3] as usize];
        let (mut least, mut greatest) = (Vec3::MAX, Vec3::MIN);
        for n in 0..400_u32 {
            let hash = pcg(n ^ ((k as u32) << 10));
            let (u, v) = match n {
                0..4 => ((n & 1) as f32, (n >> 1) as f32),
                _ => (unit(hash), unit(pcg(hash))),
            };
            let (place, _) = patch.evaluate(map, band, u, v);
            assert!(bounds.holds(place), "{place} {bounds:?} {patch:?}");
            least = least.min(place);
            greatest = greatest.max(place);
            held += 1;
        }
        let [_, _, out] = patch.frame();
        // The box reaches beyond the flat face by the greatest displacement, and by its margin.
        let loose = (least - bounds.least).max(bounds.greatest - greatest);
        let allowed = out.abs() * patch.data.face[2] + Vec3::splat(2e-3);
        // Along the face random places do not reach its corners' line but for the corners themselves, which are there.
        assert!(loose.cmple(allowed).all(), "{loose} {allowed}");
    }
    assert!(held > 400_000, "{held}");
}

#[test]
fn triangles_stand_where_patches_do() {
    let rules = CityRules::default();
    let patches = patches(&rules, 1);
    let (points, corners) = triangles(&patches, &MAPS, rules.relief.band, 4);
    assert_eq!(points.len(), 25 * patches.len());
    assert_eq!(corners.len(), 32 * patches.len());
    let all = CityBox::of_patches(&patches).expect("some");
    assert!(points.iter().all(|p| all.holds(*p)));
    let mesh = dolomite_collision::TriangleMesh::new(bevy::math::DVec3::ZERO, points, corners);
    assert!(mesh.is_ok(), "collision takes them");
}
