//! What samples at a spacing may miss altogether.

use super::hidden::Samples;
use crate::ground::GroundRect;
use crate::noise::{Octave, Sum};
use crate::terrain::{Mask, Prepared, Terrain};
use bevy::math::DVec2;

impl Terrain {
    /// By how much the ground between samples `spacing` metres apart, anywhere in `rect` and at its corners, may differ
    /// from what they tell. Metres, 0 and above. Counted are
    ///
    /// - what stands alone: hills less than four samples in radius, and height maps and edits that have samples of
    ///   their own in between;
    /// - octaves of noise that samples do not meet because all of them stand at the same place of its cells (see
    ///   `hidden.rs`). Of all others nothing: noise is the same everywhere, so that samples tell of it;
    /// - what a mask lets in or leaves out where the ground below it is missed by so much. Of a map behind a mask that is as
    ///   much as lies between its lowest and its highest height.
    #[must_use]
    pub fn unseen(&self, rect: &GroundRect, spacing: f64) -> f32 {
        let samples = Samples::new(rect, spacing);
        let mut missed = 0.0;
        for (source, mask) in self.prepared() {
            let own = match source {
                Prepared::Hill(hill) => {
                    let radius = f64::from(hill.radius);
                    let away = (rect.min - hill.centre).max(hill.centre - rect.max);
                    let near = away.max(DVec2::ZERO).length() < radius;
                    if near && radius < 4.0 * spacing {
                        hill.height.abs()
                    } else {
                        0.0
                    }
                }
                Prepared::Map(map) => map.missed(rect, spacing),
                Prepared::Edits(edits) => edits.missed(rect, spacing),
                Prepared::Fractal(fractal) => {
                    swing(fractal.sum) * samples.hidden(&fractal.octaves) as f32
                }
                Prepared::Permutation(noise) => samples.hidden(&noise.octaves) as f32,
            };
            // A mask that is missed by so much is open by so much more or less, of what there is of its layer.
            if let Some(mask) = mask.filter(|_| missed > 0.0) {
                missed += turned(mask, missed) * size(source);
            }
            missed += own;
        }
        missed
    }
}

/// By how much a sum may change as the noise of an octave goes from 0 to its amplitude and back: 2|n| − 1 by twice that; a ridge
/// by as much, and by as much again as it weighs the next octave.
const fn swing(sum: Sum) -> f32 {
    match sum {
        Sum::Fbm | Sum::Eroded => 1.0,
        Sum::Ridged | Sum::Billow => 2.0,
    }
}

/// By how much a mask is open more or less where the ground below is off by `missed` metres: t²(3 − 2t) is nowhere steeper than 3/2.
fn turned(mask: Mask, missed: f32) -> f32 {
    (1.5 * missed / (mask.high - mask.low).abs()).min(1.0)
}

/// How far from 0 a source may be, metres; of a map and of edits its whole range.
fn size(source: &Prepared) -> f32 {
    let of = |octaves: &[Octave]| {
        let all: f64 = octaves.iter().map(|octave| octave.amplitude.abs()).sum();
        all as f32
    };
    match source {
        Prepared::Fractal(fractal) => of(&fractal.octaves),
        Prepared::Permutation(noise) => of(&noise.octaves),
        Prepared::Map(map) => map.range(),
        Prepared::Hill(hill) => hill.height.abs(),
        // They are never behind a mask.
        Prepared::Edits(_) => 0.0,
    }
}

#[cfg(test)]
mod tests {
    use crate::{
        Filter, Fractal, GroundRect, HeightMap, Hill, Layer, Mask, PermutationNoise, Source, Sum,
        Terrain, TerrainData,
    };
    use bevy::math::DVec2;

    fn terrain(source: Source) -> Terrain {
        Terrain::new(TerrainData {
            extent: GroundRect::square(DVec2::ZERO, 4096.0),
            layers: vec![Layer { source, mask: None }],
            base: 0.0,
            sea_level: None,
        })
        .expect("valid")
    }

    #[test]
    fn a_lone_hill_is_missed_only_where_it_stands_and_by_wide_samples() {
        let terrain = terrain(Source::Hill(Hill {
            centre: DVec2::new(100.0, 0.0),
            radius: 20.0,
            height: -30.0,
        }));
        let unseen = |x: f64, side: f64| {
            let rect = GroundRect::square(DVec2::new(x, 0.0), side);
            terrain.unseen(&rect, side / 8.0)
        };
        assert_eq!(unseen(100.0, 512.0), 30.0);
        assert_eq!(unseen(100.0, 32.0), 0.0, "samples 4 m apart see it");
        assert_eq!(unseen(-1000.0, 512.0), 0.0);
    }

    #[test]
    fn a_map_is_missed_between_its_samples() {
        let samples = (0..64).map(|k| (k % 7) as f32).collect();
        let map = HeightMap::new(
            8,
            8,
            samples,
            DVec2::ZERO,
            DVec2::splat(10.0),
            Filter::Bilinear,
        )
        .expect("valid");
        let terrain = terrain(Source::Map(map));
        let rect = GroundRect::square(DVec2::splat(35.0), 40.0);
        // Samples of 0 to 6 m in each window: within 3 m of a level plane.
        let missed = terrain.unseen(&rect, 20.0);
        assert!((3.0..=12.0).contains(&missed), "{missed}");
        assert_eq!(terrain.unseen(&rect, 10.0), 0.0);
    }

    /// Noise with all of its lattices about the origin, and ground whose samples stand on them.
    #[test]
    fn noise_is_missed_by_samples_on_its_lattices() {
        let terrain = terrain(Source::Permutation(PermutationNoise {
            octaves: 4,
            amplitude: 80.0,
            wavelength: 256.0,
            ..PermutationNoise::default()
        }));
        let unseen = |side: f64| terrain.unseen(&GroundRect::square(DVec2::ZERO, side), side / 8.0);
        assert_eq!(unseen(4096.0), 150.0);
        // Steps of 128 m: the octave of cells twice as wide is met in the middle of every second one.
        assert_eq!(unseen(1024.0), 70.0);
        assert_eq!(unseen(128.0), 0.0);
        // Not a multiple: they drift through its cells.
        assert_eq!(unseen(2048.0 / 3.0), 0.0);
    }

    /// A hill that no sample meets opens a mask.
    #[test]
    fn what_is_missed_below_a_mask_opens_it() {
        let hill = Layer {
            source: Source::Hill(Hill {
                centre: DVec2::ZERO,
                radius: 5.0,
                height: 4.0,
            }),
            mask: None,
        };
        let above = |source| Layer {
            source,
            mask: Some(Mask {
                low: 0.0,
                high: 12.0,
            }),
        };
        let unseen = |source| {
            let terrain = Terrain::new(TerrainData {
                extent: GroundRect::square(DVec2::ZERO, 4096.0),
                layers: vec![hill.clone(), above(source)],
                base: 0.0,
                sea_level: None,
            })
            .expect("valid");
            terrain.unseen(&GroundRect::square(DVec2::ZERO, 77.0), 77.0 / 8.0)
        };
        let wide = |height| {
            Source::Hill(Hill {
                centre: DVec2::ZERO,
                radius: 400.0,
                height,
            })
        };
        assert_eq!(unseen(wide(60.0)), 34.0);
        assert_eq!(unseen(wide(-60.0)), 34.0);
        // Three octaves of 10, 5, 2.5 m, which samples meet.
        let fractal = Source::Fractal(Fractal {
            sum: Sum::Ridged,
            octaves: 3,
            amplitude: 10.0,
            wavelength: 300.0,
            ..Fractal::default()
        });
        assert_eq!(unseen(fractal), 4.0 + 8.75);
    }
}
