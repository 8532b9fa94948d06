//! The colour of a blade before light: the functions of `shaders/src/vegetation/colour.wgsl`, in Rust.
//!
//! It is evaluated at each fragment, so that strips of few vertices have the colours of those of many. What differs from blade
//! to blade is evaluated once a blade: its [`Tint`].
//!
//! Colours differ from blade to blade, from clump to clump and over metres. Of what is less than a pixel only the mean is
//! drawn (*calm*): one blade in a pixel would stand for a hundred, and flicker.

use bevy::math::{Vec2, Vec3};

use crate::blade::Own;
use crate::kind::Look;

/// What differs from blade to blade.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tint {
    /// A factor of the colour.
    pub value: f32,
    /// How dry its tip is, 0 to 1.
    pub dry: f32,
}

/// The tint of a blade. `noise` is the smooth noise of the place in two sizes, 0 to 1 each; `calm` how much of what differs
/// from blade to blade is drawn as its mean.
#[inline]
#[must_use]
pub fn blade_tint(look: &Look, own: Own, noise: Vec2, calm: f32) -> Tint {
    let of_clump = own.of_clump(10) - 0.5;
    let dryness = (0.5 * noise.x + 0.8 * noise.y - 0.35 + 0.4 * of_clump).clamp(0.0, 1.0);
    let is_dry = if own.number(11) < look.dry_share {
        1.0
    } else {
        0.0
    };
    let dry = 1.4 * dryness * look.dry_share.sqrt() + 0.7 * mix(is_dry, look.dry_share, calm);
    let value =
        mix(0.75 + 0.5 * own.number(12), 1.0, 0.8 * calm) * (0.9 + 0.25 * noise.x + 0.2 * of_clump);
    Tint {
        value,
        dry: dry.clamp(0.0, 1.0),
    }
}

/// Linear colour at a share `along` of the way from the root to the tip, 0 to 1.
#[inline]
#[must_use]
pub fn blade_colour(look: &Look, tint: Tint, along: f32) -> Vec3 {
    let green = Vec3::from(look.root).lerp(look.tip.into(), along * (1.6 - 0.6 * along));
    let dry = tint.dry * smoothstep(0.05, 0.9, along);
    tint.value * green.lerp(look.dry.into(), dry)
}

/// Light stands above: what is below is in the shade of the others. A factor of the colour.
#[inline]
#[must_use]
pub fn shade_at(along: f32) -> f32 {
    mix(0.48, 1.0, smoothstep(0.0, 0.8, along))
}

/// How calm colours and normals are at a distance, metres, of a kind that is a pixel wide at `first`; 0 to 1.
#[inline]
#[must_use]
pub fn calm_at(first: f32, distance: f32) -> f32 {
    smoothstep(0.0, 1.0, distance / (5.0 * first))
}

/// The normal by which a face reflects `share`, 0 to 1, of the light that comes from behind it, and all of what comes from the
/// sky: of the same angle to the sun as that light is less. As it is where the sun stands before it. Both are unit vectors;
/// `sun` points to the sun.
#[inline]
#[must_use]
pub fn lit_through(normal: Vec3, sun: Vec3, share: f32) -> Vec3 {
    let from_sun = normal.dot(sun);
    if from_sun >= 0.0 {
        return normal;
    }
    let to_sun = -from_sun * share;
    // Straight from behind any direction is aside: one that is not near the sun's.
    let other = if sun.x.abs() > 0.7 { Vec3::Y } else { Vec3::X };
    let beside = normal - from_sun * sun;
    let aside = if beside.length_squared() > 1e-6 {
        beside
    } else {
        sun.cross(other)
    };
    to_sun * sun + (1.0 - to_sun * to_sun).max(0.0).sqrt() * aside.normalize()
}

fn mix(a: f32, b: f32, share: f32) -> f32 {
    a + (b - a) * share
}

fn smoothstep(from: f32, to: f32, x: f32) -> f32 {
    let t = ((x - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kind::defaults;
    use crate::place::Lattice;

    /// What is calm is the mean of what is not, within what the clamp of the driest takes.
    #[test]
    fn calm_keeps_the_mean() {
        let (blade, _) = defaults::grass();
        let lattice = Lattice::of_density(3, 64.0);
        for (noise, along) in [(0.2, 0.3), (0.5, 0.7), (0.5, 1.0)] {
            let mean = |calm: f32| {
                let all = (0..40_000).map(|k| {
                    let own = Own::new(lattice.root([k & 255, k >> 8]), None);
                    let tint = blade_tint(&blade.look, own, Vec2::splat(noise), calm);
                    blade_colour(&blade.look, tint, along).as_dvec3()
                });
                all.sum::<bevy::math::DVec3>() / 40_000.0
            };
            // 40 000 of a spread of a seventh are a thousandth of it off; 1/255 is a hundredth of the brightest.
            let (own, calm) = (mean(0.0), mean(1.0));
            assert!(
                (own - calm).abs().max_element() < 0.5 / 255.0,
                "{own} {calm}"
            );
        }
    }

    /// Light from behind is the share that comes through; nothing jumps where the sun goes behind, and the side that a face
    /// turns to the sky stays.
    #[test]
    fn light_from_behind_comes_through_by_its_share() {
        let sun = Vec3::new(0.48, 0.6, 0.64);
        let aside = Vec3::new(0.8, 0.0, -0.6);
        for share in [0.0, 0.3, 1.0] {
            for k in -10_i16..=10 {
                let sine = f32::from(k) * 0.1;
                let normal = sine * sun + (1.0 - sine * sine).sqrt() * aside;
                let lit = lit_through(normal, sun, share);
                let expected = if sine < 0.0 { -sine * share } else { sine };
                assert!((lit.length() - 1.0).abs() < 1e-6, "{lit}");
                assert!((lit.dot(sun) - expected).abs() < 1e-6, "{sine} {lit}");
                if k > -10 && k < 10 {
                    let ahead = lit.dot(aside);
                    assert!(
                        (ahead - (1.0 - expected * expected).sqrt()).abs() < 1e-6,
                        "{sine} {lit}"
                    );
                }
            }
        }
    }

    #[test]
    fn shade_rises_to_the_light() {
        assert_eq!(
            (shade_at(0.0), shade_at(0.8), shade_at(1.0)),
            (0.48, 1.0, 1.0)
        );
        assert_eq!((calm_at(10.0, 0.0), calm_at(10.0, 50.0)), (0.0, 1.0));
        assert_eq!(calm_at(10.0, 25.0), 0.5);
    }
}
