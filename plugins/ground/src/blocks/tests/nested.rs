//! Nested errors against their definition, in f64 and over triangles; and boxes that grow.

use bevy::math::{IVec2, Vec3};

use super::grounds::{Random, cameras, fbm};
use crate::blocks::errors::{Inside, nested};
use crate::blocks::ratio::factor;
use crate::blocks::record::GROWTH;
use crate::blocks::triangle::{AROUND, SAMPLE_COUNT, SAMPLES, STEPS, Surface, WIDE};

/// Errors by the definition: of a sample that cuts an edge, the largest of its two triangles, and of those that
/// need it.
struct Definition<'a> {
    heights: &'a [f32],
    tails: &'a [f32],
}

impl Definition<'_> {
    fn at(&self, at: IVec2) -> f64 {
        f64::from(self.heights[at.y as usize * SAMPLES + at.x as usize])
    }

    /// Coordinates from a point where the pattern begins.
    fn global(at: IVec2) -> IVec2 {
        at - AROUND * STEPS as i32
    }

    /// The two triangles that a vertex of half size `half` cuts, and those that need it.
    fn around(at: IVec2, half: i32, centre: bool) -> ([[IVec2; 3]; 2], Vec<IVec2>) {
        let axes = [IVec2::X, IVec2::Y].map(|axis| axis * half);
        if centre {
            // The quarter of the larger square tells the diagonal: even ones run from corner 0 to corner 2.
            let quarter = (Self::global(at) / half).map_odd();
            let [x, z] = axes;
            let (a, b, c, d) = if quarter {
                (at - x - z, at + x + z, at + x - z, at - x + z)
            } else {
                (at + x - z, at - x + z, at - x - z, at + x + z)
            };
            let needing = vec![at - x, at + x, at - z, at + z];
            return ([[c, a, b], [d, a, b]], needing);
        }
        let along_x = Self::global(at).x.rem_euclid(2 * half) != 0;
        let (along, across) = if along_x {
            (axes[0], axes[1])
        } else {
            (axes[1], axes[0])
        };
        let ends = [at - along, at + along];
        let triangles = [at - across, at + across].map(|apex| [apex, ends[0], ends[1]]);
        let quarter = [(-1, -1), (1, -1), (1, 1), (-1, 1)];
        let needing = quarter.map(|(x, z)| at + IVec2::new(x, z) * (half / 2));
        (
            triangles,
            if half > 1 {
                needing.to_vec()
            } else {
                Vec::new()
            },
        )
    }

    fn own(&self, [a, b, c]: [IVec2; 3]) -> f64 {
        let area = |p: IVec2, q: IVec2, r: IVec2| f64::from((q - p).perp_dot(r - p));
        let whole = area(a, b, c);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        let mut worst = 0.0_f64;
        for z in low.y..=high.y {
            for x in low.x..=high.x {
                let p = IVec2::new(x, z);
                let w = [area(p, b, c), area(a, p, c), area(a, b, p)].map(|w| w / whole);
                if w.iter().all(|&w| w >= 0.0) {
                    let drawn = w[0] * self.at(a) + w[1] * self.at(b) + w[2] * self.at(c);
                    worst = worst.max((self.at(p) - drawn).abs());
                }
            }
        }
        worst
    }

    /// The largest of the cells that a vertex touches.
    fn touched(at: IVec2, of: impl Fn(IVec2) -> f64) -> f64 {
        [(-1, -1), (0, -1), (-1, 0), (0, 0)]
            .into_iter()
            .map(|(x, z)| of((at + IVec2::new(x, z)) / STEPS as i32))
            .fold(0.0, f64::max)
    }

    fn tail(&self, at: IVec2) -> f64 {
        Self::touched(at, |cell| {
            f64::from(self.tails[cell.y as usize * WIDE + cell.x as usize])
        })
    }

    fn twist(&self, at: IVec2) -> f64 {
        Self::touched(at, |cell| {
            let first = cell * STEPS as i32;
            (0..16)
                .map(|k| {
                    let p = first + IVec2::new(k % 4, k / 4);
                    let [x, z] = [IVec2::X, IVec2::Y];
                    let twist = self.at(p) - self.at(p + x) - self.at(p + z) + self.at(p + x + z);
                    0.25 * twist.abs()
                })
                .fold(0.0, f64::max)
        })
    }

    fn error(&self, at: IVec2, half: i32, centre: bool) -> f64 {
        let (triangles, needing) = Self::around(at, half, centre);
        let own = triangles
            .map(|t| self.own(t))
            .into_iter()
            .fold(0.0, f64::max);
        let next = if centre { half } else { half / 2 };
        let finer = needing
            .into_iter()
            .map(|at| self.error(at, next, !centre))
            .fold(0.0, f64::max);
        let finer = if next == 0 {
            self.tail(at).max(self.twist(at))
        } else {
            finer
        };
        (own + self.tail(at)).max(f64::from(GROWTH) * finer)
    }
}

/// Whether the sum of both coordinates, odd ones, tells an even quarter.
trait MapOdd {
    fn map_odd(self) -> bool;
}

impl MapOdd for IVec2 {
    fn map_odd(self) -> bool {
        (self.x.rem_euclid(4) / 2 + self.y.rem_euclid(4) / 2) % 2 == 0
    }
}

#[test]
fn nested_errors_are_those_of_the_definition() {
    let mut random = Random::new(11);
    for round in 0..2 {
        // Once rough, once an island of roughness on a plane: what it asks of others is all that there is.
        let heights: Vec<f32> = (0..SAMPLE_COUNT)
            .map(|k| {
                let at = IVec2::new((k % SAMPLES) as i32, (k / SAMPLES) as i32);
                let rough = (at - 45).abs().max_element() < 3 || round == 0;
                let noise = if rough { random.unit() as f32 } else { 0.0 };
                0.25 * at.x as f32 - 0.5 * at.y as f32 + noise
            })
            .collect();
        let tails: Vec<f32> = (0..WIDE * WIDE).map(|k| 0.001 * (k % 7) as f32).collect();
        let surfaces = [(Surface(&heights), 1.0)];
        let found = nested(&surfaces, &tails, Inside::ALL, None);
        let definition = Definition {
            heights: &heights,
            tails: &tails,
        };
        let mut compared = 0;
        for k in 0..500 {
            let cells = IVec2::new((random.unit() * 16.0) as i32, (random.unit() * 16.0) as i32);
            let corner = (cells + AROUND) * STEPS as i32;
            let (at, half, centre) = if k % 2 == 0 {
                (corner + STEPS as i32 / 2, 2, true)
            } else if (cells.x + cells.y) % 2 == 1 {
                (corner, 4, false)
            } else {
                continue;
            };
            let expected = definition.error(at, half, centre);
            let found = f64::from(found[at.y as usize * SAMPLES + at.x as usize]);
            // Some roundings of heights up to 45 m.
            assert!(
                (found - expected).abs() < 2e-5,
                "{round} {at} {found} {expected}"
            );
            compared += 1;
        }
        assert!(compared > 300);
    }
}

#[test]
fn larger_boxes_never_ask_for_less() {
    let terrain = fbm();
    let mut random = Random::new(5);
    let mut larger = 0;
    for camera in cameras(&terrain) {
        let mut view = camera.bound(1.0);
        view.sweep = [0.0, -20.0, 35.0];
        let eye = Vec3::from(view.eye);
        for _ in 0..20_000 {
            let mut unit = || random.unit() as f32;
            let away = 300.0 * unit() * unit() * unit();
            let towards = Vec3::new(unit() - 0.5, 0.2 * (unit() - 0.5), unit() - 0.5);
            let low = eye + towards * 2.0 * away;
            let size = Vec3::new(unit(), unit(), unit()) * away * unit();
            let high = low + size;
            // By as little as f32 can tell.
            let more = |x: f32, by: f32| {
                if by < 0.5 {
                    x
                } else {
                    x + (by - 0.5) * 1e-3 * away
                }
            };
            let (wide_low, wide_high) = (
                Vec3::new(
                    -more(-low.x, unit()),
                    -more(-low.y, unit()),
                    -more(-low.z, unit()),
                ),
                Vec3::new(
                    more(high.x, unit()),
                    more(high.y, unit()),
                    more(high.z, unit()),
                ),
            );
            let (own, wide) = (factor(&view, low, high), factor(&view, wide_low, wide_high));
            // Roots and quotients may be rounded either way on other machines; here they are not.
            assert!(wide >= own, "{low} {high}: {own} {wide}");
            larger += usize::from(wide > own);
            // The same bound as by middle and half size, but for rounding.
            let sight = view.sight(low, high);
            let other = sight.share * sight.pixels_per_metre;
            assert!(
                (own - other).abs() <= 2e-3 * other.max(own),
                "{own} {other}"
            );
        }
    }
    assert!(larger > 10_000, "{larger}");
}
