//! What decides how finely the ground is drawn.

use bevy::prelude::*;

use crate::range::within;

/// What a vertex is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Default)]
pub enum Metric {
    /// By the distance alone, and by how much the ground rises: the method of the literature, as a
    /// baseline. A square patch of side `patch` gets as many segments along a side as
    /// `mix(greatest, least, 0.6·d/reach + 0.4·(1 − clamp(relief/height, 0, 1)))`, `least` beyond
    /// `reach`; d is the distance from the eye, relief the height range of the cell that a vertex
    /// belongs to.
    Classic {
        /// Side of the patches that levels count for, metres.
        patch: f32,
        /// Segments where it is far or flat.
        least: f32,
        /// Segments where it is near and steep.
        greatest: f32,
        /// From here on `least`, metres.
        reach: f32,
        /// Height range that counts as steep, metres.
        height: f32,
    },
    /// No edge longer than this in the picture, as if it were seen from its side.
    EdgeLength {
        /// Pixels, above 0.
        pixels: f32,
    },
    /// The ground as drawn is nowhere farther than this from the true one, vertically, in the picture.
    ErrorBound {
        /// Pixels, above 0.
        pixels: f32,
    },
}

impl Default for Metric {
    fn default() -> Self {
        Self::ErrorBound { pixels: 1.0 }
    }
}

/// Least tolerance, pixels: far below what a picture can show.
pub const LEAST_PIXELS: f32 = 1.0 / 64.0;
/// Greatest tolerance, pixels: more than a picture is wide.
pub const GREATEST_PIXELS: f32 = 16_384.0;

impl Metric {
    /// The same with every number in its range: pixels from [`LEAST_PIXELS`] to [`GREATEST_PIXELS`]; what
    /// is not a number becomes the default.
    #[must_use]
    pub fn clamped(self) -> Self {
        let pixels =
            |value: f32, default: f32| within(value, LEAST_PIXELS, GREATEST_PIXELS, default);
        match self {
            Self::Classic {
                patch,
                least,
                greatest,
                reach,
                height,
            } => {
                let least = within(least, 1e-3, 4096.0, 1.0);
                Self::Classic {
                    patch: within(patch, 1e-3, 1e6, 16.0),
                    least,
                    greatest: within(greatest, least, 4096.0, least.max(32.0)),
                    reach: within(reach, 1e-3, 1e9, 400.0),
                    height: within(height, 1e-6, 1e6, 10.0),
                }
            }
            Self::EdgeLength { pixels: given } => Self::EdgeLength {
                pixels: pixels(given, 8.0),
            },
            Self::ErrorBound { pixels: given } => Self::ErrorBound {
                pixels: pixels(given, 1.0),
            },
        }
    }

    /// The same with its tolerance times `factor`: pixels, or segments of a patch the fewer.
    #[must_use]
    pub fn coarser(self, factor: f32) -> Self {
        match self {
            Self::Classic {
                patch,
                least,
                greatest,
                reach,
                height,
            } => Self::Classic {
                patch: patch * factor,
                least,
                greatest,
                reach,
                height,
            },
            Self::EdgeLength { pixels } => Self::EdgeLength {
                pixels: pixels * factor,
            },
            Self::ErrorBound { pixels } => Self::ErrorBound {
                pixels: pixels * factor,
            },
        }
        .clamped()
    }
}

/// How finely a camera sees the ground.
///
/// Required by [`TerrainView`](crate::TerrainView). A camera from which it was taken away sees the ground as by the
/// default.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Default)]
pub struct TerrainLod {
    /// What is asked of the drawn surface.
    pub metric: Metric,
    /// Side of the smallest cell, metres; 2⁻¹⁰ to 1024, default 0.125.
    ///
    /// Views with the same value share the blocks of a terrain; others have their own, made and kept once more.
    pub finest: f32,
    /// Most vertices of a view; where a view asks for more, the tolerance grows until it fits. 2¹⁰ to 2²²,
    /// default 2¹⁸.
    ///
    /// Pools grow as a view needs them, from 1.4 MiB on, and a vertex that is drawn takes 55 bytes of them. Each vertex of
    /// this number takes six more of a view (of the block that there is room for with every 38) and 364 of the blocks that
    /// all views of the terrain with the same `finest` share, as large as the greatest of them asks for; what is being made
    /// takes 4 MiB of a terrain: by default 3 to 13 MiB a view, and 95 MiB a terrain and value of `finest`. They are
    /// published as `dolomite/geometry/allocated/…` and in `GeometryStats::pools`, with the terrain's relief map, its
    /// textures and its heights.
    pub max_vertices: u32,
    /// Share of the detail that ground gets which is seen through its shadow alone, 0 to 1.
    pub shadow_share: f32,
    /// Leaves out the triangles of which the view shows nothing: beyond its borders, or facing away. The
    /// picture is the same without; it is there to be compared with.
    pub culled: bool,
    /// Leaves out the triangles that nearer ground hides, with those that `culled` leaves out; nothing without
    /// it, and nothing where a camera does not fill triangles. The picture is the same without.
    pub occluded: bool,
}

/// How many blocks of ground a frame makes, for all views of a terrain together. May be changed at any time; without it
/// the default counts. An edit makes as many anew as four frames may, coarse ones
/// first; what else it reaches is dropped, and made as what is missing.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq, Reflect)]
#[reflect(Resource, Default)]
pub struct MakingBudget {
    /// Most blocks; more than 1024 count as that many. 0: what there is is drawn, by a tolerance that it allows. `None`,
    /// the default: as many as take a millisecond on this device, which is measured; a quarter of a second where the
    /// processor draws, whose frames take as long.
    pub blocks: Option<u32>,
}

impl Default for TerrainLod {
    fn default() -> Self {
        Self {
            metric: Metric::default(),
            finest: 0.125,
            max_vertices: 1 << 18,
            shadow_share: 0.25,
            culled: true,
            occluded: true,
        }
    }
}

impl TerrainLod {
    /// The same with every field in its range.
    #[must_use]
    pub fn clamped(self) -> Self {
        Self {
            metric: self.metric.clamped(),
            finest: within(self.finest, 1.0 / 1024.0, 1024.0, 0.125),
            max_vertices: self.max_vertices.clamp(1 << 10, 1 << 22),
            shadow_share: within(self.shadow_share, 0.0, 1.0, 0.25),
            ..self
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hostile_tolerances_become_usable_ones() {
        for (given, expected) in [
            (0.0, LEAST_PIXELS),
            (-3.0, LEAST_PIXELS),
            (f32::NAN, 1.0),
            (f32::INFINITY, GREATEST_PIXELS),
            (2.0, 2.0),
        ] {
            let metric = Metric::ErrorBound { pixels: given }.clamped();
            assert_eq!(metric, Metric::ErrorBound { pixels: expected }, "{given}");
        }
        let detail = TerrainLod {
            finest: f32::NAN,
            max_vertices: 0,
            shadow_share: -1.0,
            ..default()
        };
        let clamped = detail.clamped();
        assert_eq!(clamped.finest, 0.125);
        assert_eq!(clamped.max_vertices, 1 << 10);
        assert_eq!(clamped.shadow_share, 0.0);
    }

    #[test]
    fn a_coarser_metric_asks_for_less() {
        let metric = Metric::EdgeLength { pixels: 8.0 }.coarser(2.0);
        assert_eq!(metric, Metric::EdgeLength { pixels: 16.0 });
    }
}
