//! What samples at a spacing may miss altogether.

use crate::ground::GroundRect;
use crate::terrain::{Prepared, Terrain};
use bevy::math::DVec2;

impl Terrain {
    /// By how much the ground between samples `spacing` metres apart, anywhere in `rect`, may differ from
    /// what they tell because something stands there alone: hills less than four samples in radius, and
    /// height maps and edits that have samples of their own in between. Metres, 0 and above.
    ///
    /// Noise counts nothing here: it is the same everywhere, so that samples meet all of its octaves.
    #[must_use]
    pub fn unseen(&self, rect: &GroundRect, spacing: f64) -> f32 {
        self.prepared()
            .map(|(source, _)| match source {
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
                Prepared::Fractal(_) | Prepared::Permutation(_) => 0.0,
            })
            .sum()
    }
}

#[cfg(test)]
mod tests {
    use crate::{Filter, GroundRect, HeightMap, Hill, Layer, Source, Terrain, TerrainData};
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
}
