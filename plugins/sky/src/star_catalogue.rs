//! The stars: where they stand, how bright they are, what colour they have.
//!
//! Made by an integer hash from nothing: the same in every run, on every machine.

use bevy::math::{Vec3, ops};

use crate::galaxy;
use crate::math::{pcg, smooth};

/// Stars of the catalogue, all above 2 degrees below the horizon.
pub const STARS: u32 = 6000;

/// Magnitude of the brightest: that of Sirius.
pub const BRIGHTEST: f32 = -1.5;
/// Magnitude of the faintest: what a good eye sees in the mountains.
pub const FAINTEST: f32 = 6.5;

/// Sine of the least elevation: 2 degrees below the horizon, which a camera on a height may see.
const LOWEST: f32 = -0.035;

/// Temperatures of their surfaces, kelvin.
const COOLEST: f32 = 3_000.0;
const HOTTEST: f32 = 20_000.0;

/// Classes of colour.
pub const COLOURS: u32 = 8;
/// Classes of magnitude: 256 in all, what the material of a vertex can hold.
pub const MAGNITUDES: u32 = 32;

/// How many times as dense the faintest stars are in the brightest clouds of the Milky Way.
const CLUSTERED: f32 = 7.0;

/// One star.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CatalogueStar {
    /// Where it stands; of length 1.
    pub direction: Vec3,
    /// Apparent magnitude outside the air, [`BRIGHTEST`] to [`FAINTEST`].
    pub magnitude: f32,
    /// Temperature, kelvin.
    pub kelvin: f32,
}

/// Numbers in [0, 1): a hash of a counter.
struct Numbers(u32);

impl Numbers {
    fn next(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(1);
        // 24 bits: what an f32 below 1 can hold.
        (pcg(self.0) >> 8) as f32 / (1 << 24) as f32
    }
}

/// All stars, the brightest first.
///
/// The number of stars up to a magnitude grows by √10 for each magnitude, as in the sky; so many
/// over the hemisphere that there is one of [`BRIGHTEST`]. Most are hotter than the sun, as those are that are seen
/// from far.
pub fn catalogue() -> Vec<CatalogueStar> {
    let mut numbers = Numbers(0x5157_a25e);
    (0..STARS)
        .map(|rank| {
            let share = (rank as f32 + 0.5) / STARS as f32;
            let magnitude = (FAINTEST + 2.0 * ops::log10(share)).max(BRIGHTEST);
            CatalogueStar {
                direction: direction(&mut numbers, magnitude),
                magnitude,
                kelvin: COOLEST * ops::powf(HOTTEST / COOLEST, ops::powf(numbers.next(), 0.6)),
            }
        })
        .collect()
}

/// Evenly over the sky; faint ones denser in the Milky Way.
fn direction(numbers: &mut Numbers, magnitude: f32) -> Vec3 {
    let clustered = CLUSTERED * smooth(2.0, 6.0, magnitude);
    let mut found = Vec3::Y;
    // Rejection; a hundred misses in a row, of which each has odds of 7 in 8 at worst, would leave
    // the last place, which is as good.
    for _ in 0..100 {
        let y = LOWEST + (1.0 - LOWEST) * numbers.next();
        let level = (1.0 - y * y).max(0.0).sqrt();
        let (sin, cos) = ops::sin_cos(std::f32::consts::TAU * numbers.next());
        found = Vec3::new(level * sin, y, level * cos);
        let density = 1.0 + clustered * galaxy::brightness(found).min(1.0);
        if numbers.next() * (1.0 + clustered) < density {
            break;
        }
    }
    found
}

/// Class of a star, 0 to 255: magnitude times [`COLOURS`], plus colour.
pub fn class(star: &CatalogueStar) -> u32 {
    let share = (star.magnitude - BRIGHTEST) / (FAINTEST - BRIGHTEST);
    let magnitude = (share * (MAGNITUDES - 1) as f32).round() as u32;
    let hot = ops::ln(star.kelvin / COOLEST) / ops::ln(HOTTEST / COOLEST);
    let colour = (hot * COLOURS as f32) as u32;
    magnitude.min(MAGNITUDES - 1) * COLOURS + colour.min(COLOURS - 1)
}

/// Colour of a class of colour, linear sRGB of luminance 1: that of a black body in its middle.
pub fn colour(class: u32) -> Vec3 {
    let share = (class as f32 + 0.5) / COLOURS as f32;
    black_body(COOLEST * ops::powf(HOTTEST / COOLEST, share))
}

/// Colour of a black body, linear sRGB of luminance 1; what lies outside is moved to the edge.
///
/// Planck's law over the colour matching functions of CIE 1931 as Wyman, Sloan and Shirley fit them
/// (JCGT 2, 2013).
pub fn black_body(kelvin: f32) -> Vec3 {
    let lobe = |nm: f32, middle: f32, left: f32, right: f32| {
        let t = (nm - middle) / if nm < middle { left } else { right };
        ops::exp(-0.5 * t * t)
    };
    let xyz: Vec3 = (0..80_u16)
        .map(|k| {
            let nm = 382.5 + 5.0 * f32::from(k);
            // Second radiation constant, nm K; relative to 560 nm, so that f32 holds it.
            let power = ops::powf(560.0 / nm, 5.0) / (ops::exp(1.438_777e7 / (nm * kelvin)) - 1.0);
            let x = 1.056 * lobe(nm, 599.8, 37.9, 31.0) + 0.362 * lobe(nm, 442.0, 16.0, 26.7)
                - 0.065 * lobe(nm, 501.1, 20.4, 26.2);
            let y = 0.821 * lobe(nm, 568.8, 46.9, 40.5) + 0.286 * lobe(nm, 530.9, 16.3, 31.1);
            let z = 1.217 * lobe(nm, 437.0, 11.8, 36.0) + 0.681 * lobe(nm, 459.0, 26.0, 13.8);
            Vec3::new(x, y, z) * power
        })
        .sum();
    let rgb = Vec3::new(
        xyz.dot(Vec3::new(3.2406, -1.5372, -0.4986)),
        xyz.dot(Vec3::new(-0.9689, 1.8758, 0.0415)),
        xyz.dot(Vec3::new(0.0557, -0.2040, 1.0570)),
    )
    .max(Vec3::ZERO);
    rgb / rgb.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_number_of_stars_grows_by_the_root_of_ten_a_magnitude() {
        let stars = catalogue();
        assert_eq!(stars.len(), STARS as usize);
        let up_to = |magnitude: f32| {
            let brighter = stars.iter().filter(|star| star.magnitude < magnitude);
            brighter.count() as f32
        };
        for magnitude in [2.0, 3.0, 4.0, 5.0] {
            let growth = up_to(magnitude + 1.0) / up_to(magnitude);
            // Whole stars: 34 of them up to 2.0, so a star is 3 %.
            assert!((growth - 3.162).abs() < 0.12, "{magnitude}: {growth}");
        }
        assert_eq!(stars[0].magnitude, BRIGHTEST);
        assert!(up_to(0.0) < 6.0 && stars.iter().all(|star| star.magnitude <= FAINTEST));
    }

    #[test]
    fn every_run_has_the_same_stars() {
        let stars = catalogue();
        assert_eq!(stars, catalogue());
        let bits = stars.iter().fold(0, |hash, star| {
            let [x, y, z] = star.direction.to_array().map(f32::to_bits);
            [x, y, z, star.magnitude.to_bits(), star.kelvin.to_bits()]
                .into_iter()
                .fold(hash, |hash: u32, bits| pcg(hash ^ bits))
        });
        assert_eq!(bits, BITS);
    }

    /// The catalogue of this version; another is another sky.
    const BITS: u32 = 3_344_538_520;

    #[test]
    fn they_stand_on_the_sky_and_the_faint_ones_crowd_the_milky_way() {
        let stars = catalogue();
        let lower = stars.iter().all(|star| star.direction.y >= LOWEST);
        let on_sphere = |star: &CatalogueStar| (star.direction.length() - 1.0).abs() < 1e-6;
        assert!(lower && stars.iter().all(on_sphere));
        let mean = |from: f32, to: f32| {
            let of: Vec<f32> = stars
                .iter()
                .filter(|star| (from..to).contains(&star.magnitude))
                .map(|star| galaxy::brightness(star.direction))
                .collect();
            of.iter().sum::<f32>() / of.len() as f32
        };
        let (bright, faint) = (mean(-2.0, 3.0), mean(6.0, 7.0));
        assert!(faint > 1.6 * bright, "{bright} {faint}");
    }

    #[test]
    fn cool_stars_are_red_and_hot_ones_blue() {
        let warm = black_body(3_000.0);
        assert!(warm.x > 1.5 * warm.y && warm.y > 2.0 * warm.z, "{warm}");
        let hot = black_body(20_000.0);
        assert!(hot.z > 1.5 * hot.y && hot.y > hot.x, "{hot}");
        // 6504 K has the colour of the display's white, but for what is green in daylight.
        let white = black_body(6_504.0);
        assert!((white - Vec3::ONE).abs().max_element() < 0.06, "{white}");
        let blue: Vec<f32> = (0..COLOURS).map(|k| colour(k).z / colour(k).x).collect();
        assert!(blue.windows(2).all(|pair| pair[0] < pair[1]), "{blue:?}");
    }

    #[test]
    fn a_class_tells_magnitude_and_colour() {
        let star = |magnitude, kelvin| {
            class(&CatalogueStar {
                direction: Vec3::Y,
                magnitude,
                kelvin,
            })
        };
        assert_eq!(star(BRIGHTEST, COOLEST), 0);
        assert_eq!(star(FAINTEST, HOTTEST), 255);
        assert_eq!(star(2.5, 7_746.0) / COLOURS, 16);
        assert_eq!(star(BRIGHTEST, 7_740.0), 3);
        assert_eq!(star(BRIGHTEST, 7_750.0), 4);
    }
}
