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
