//! Several maps beside each other that are one ground.

use super::{HeightMap, HeightMapError};
use dolomite_elevation::{Options, Tile, fill_holes, mosaic};

impl HeightMap {
    /// Columns and rows from this map's first sample to another's, if both lie on one grid: with the same spacing and
    /// filter, and no farther from whole steps than a thousandth.
    fn steps_to(&self, other: &Self) -> Option<[i64; 2]> {
        if self.spacing() != other.spacing() || self.filter() != other.filter() {
            return None;
        }
        let steps = (other.origin() - self.origin()) / self.spacing();
        let whole = steps.round();
        ((steps - whole).abs().max_element() < 1e-3 && whole.abs().max_element() < 1e9)
            .then_some([whole.x as i64, whole.y as i64])
    }

    /// Whether another map goes on where this one ends: on the same grid, side by side or sharing a column or row at most, and
    /// with no sample between them.
    #[must_use]
    pub fn goes_on_in(&self, other: &Self) -> bool {
        let Some(at) = self.steps_to(other) else {
            return false;
        };
        let mine = [self.width(), self.height()].map(i64::from);
        let others = [other.width(), other.height()].map(i64::from);
        // Samples that both have along each axis; 0: they stand side by side.
        let shared = [0, 1].map(|k| mine[k].min(at[k] + others[k]) - at[k].max(0));
        let [narrow, wide] = [shared[0].min(shared[1]), shared[0].max(shared[1])];
        (0..=1).contains(&narrow) && wide > 1
    }

    /// All these maps, on one grid, as one. Where two have a sample at one place, both must be the same to the bit. What none
    /// covers is filled from around.
    ///
    /// # Errors
    /// Maps that disagree, that are read by tiles, that are not on one grid, or that are too large together; see [`mosaic`].
    pub fn joined(maps: &[(&str, Self)]) -> Result<Self, HeightMapError> {
        let Some((name, first)) = maps.first() else {
            return Err(HeightMapError::Empty {
                file: "(no maps)".to_owned(),
                width: 0,
                height: 0,
            });
        };
        let mut tiles = Vec::new();
        for (other, map) in maps {
            let at = first
                .steps_to(map)
                .ok_or_else(|| HeightMapError::NotOneGrid {
                    file: (*name).to_owned(),
                    other: (*other).to_owned(),
                })?;
            if map.stream().is_some() {
                return Err(HeightMapError::ByTiles {
                    file: (*other).to_owned(),
                });
            }
            tiles.push(Tile {
                name: other,
                size: [map.width(), map.height()],
                samples: map.samples(),
                at,
            });
        }
        let options = Options {
            max_samples: Self::MAX_SAMPLES as u64,
            ..Options::default()
        };
        let ([width, height], mut samples, corner) = mosaic(&tiles, &options)?;
        if fill_holes(&mut samples, width as usize).is_none() {
            return Err(HeightMapError::AllHoles {
                file: (*name).to_owned(),
            });
        }
        let mut origin = first.origin();
        for k in 0..2 {
            let begins = tiles
                .iter()
                .zip(maps)
                .find(|(tile, _)| tile.at[k] == corner[k]);
            if let Some((_, (_, map))) = begins {
                origin[k] = map.origin()[k];
            }
        }
        Self::named(
            name,
            [width, height],
            samples,
            (origin, first.spacing()),
            first.filter(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Filter;
    use bevy::math::DVec2;

    fn ground(column: u32, row: u32) -> f32 {
        ((column * 37 + row * 101) % 53) as f32 * 1.25 + 900.0
    }

    /// A window of the ground.
    fn window(from: [u32; 2], size: [u32; 2]) -> HeightMap {
        let samples =
            (0..size[0] * size[1]).map(|k| ground(from[0] + k % size[0], from[1] + k / size[0]));
        let spacing = DVec2::new(7.5, 2.5);
        let origin =
            DVec2::new(-1e4, 3e3) + spacing * DVec2::new(f64::from(from[0]), f64::from(from[1]));
        HeightMap::new(
            size[0],
            size[1],
            samples.collect(),
            origin,
            spacing,
            Filter::Bicubic,
        )
        .expect("valid")
    }

    #[test]
    fn sixteen_tiles_are_one_map_to_the_bit() {
        let whole = window([0, 0], [4 * 16 + 1, 4 * 12 + 1]);
        for shared in [0, 1] {
            let tiles: Vec<_> = (0..16_u32)
                .map(|k| {
                    let at = [k % 4 * 16, k / 4 * 12];
                    // The last of each line reaches to the end.
                    let last = |n: u32| u32::from(n == 3).max(shared);
                    window(at, [16 + last(k % 4), 12 + last(k / 4)])
                })
                .collect();
            // In any order.
            let named: Vec<_> = [5, 0, 10, 15, 3, 12, 1, 2, 4, 6, 7, 8, 9, 11, 13, 14]
                .iter()
                .map(|&k: &usize| ("tile", tiles[k].clone()))
                .collect();
            let joined = HeightMap::joined(&named).expect("they agree");
            assert_eq!(
                (joined.width(), joined.height()),
                (whole.width(), whole.height())
            );
            assert_eq!(joined.origin(), whole.origin());
            for k in 0..40_000 {
                let at = whole.origin()
                    + DVec2::new(f64::from(k % 233), f64::from(k / 233)) * 2.113
                    - 11.0;
                let (a, b) = (whole.sample_f64(at), joined.sample_f64(at));
                assert_eq!(a.height.to_bits(), b.height.to_bits(), "{at}");
                let at = crate::GroundPoint::new(at);
                let (a, b) = (whole.sample(at), joined.sample(at));
                assert_eq!(a.value.to_bits(), b.value.to_bits(), "{at:?}");
            }
        }
    }

    #[test]
    fn neighbours_are_told_from_maps_that_lie_over_each_other() {
        let base = window([0, 0], [10, 10]);
        for (from, size, next) in [
            ([9, 0], [10, 10], true),
            ([10, 0], [10, 10], true),
            ([0, 9], [10, 10], true),
            ([11, 0], [10, 10], false),
            ([8, 0], [10, 10], false),
            ([0, 0], [10, 10], false),
            ([2, 2], [4, 4], false),
            // Corner to corner: a third one joins them.
            ([9, 9], [10, 10], false),
        ] {
            let other = window(from, size);
            assert_eq!(base.goes_on_in(&other), next, "{from:?}");
            assert_eq!(other.goes_on_in(&base), next, "{from:?}");
        }
        let other = HeightMap::new(3, 3, vec![0.0; 9], DVec2::ZERO, DVec2::ONE, Filter::Bicubic)
            .expect("valid");
        assert!(!base.goes_on_in(&other));
        let error = HeightMap::joined(&[("a", base.clone()), ("b", other)]);
        assert!(matches!(error, Err(HeightMapError::NotOneGrid { .. })));
        let mut samples = base.samples().to_vec();
        samples[9] += 1.0;
        let origin = base.origin() + DVec2::new(9.0 * 7.5, 0.0);
        let wrong = HeightMap::new(10, 10, samples, origin, base.spacing(), Filter::Bicubic)
            .expect("valid");
        let error = HeightMap::joined(&[("a", base), ("b", wrong)])
            .expect_err("they disagree")
            .to_string();
        assert!(error.contains("column 9, row 0"), "{error}");
    }
}
