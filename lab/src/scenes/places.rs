//! Where errors are looked for: half of the places are spread over the screen, half over the ground
//! that is seen.

use super::camera::View;
use super::truth::Truth;
use bevy::math::{DVec2, DVec3};
use dolomite_terrain::{GroundPoint, HeightTile, Planes};
use dolomite_testkit::cores::on_all_cores;
use dolomite_testkit::random::{Random, mixed};

/// Places of the ground plane with the height of the true surface there.
#[derive(Debug, Clone, Default)]
pub struct Places {
    /// (x, z), metres.
    pub xz: Vec<DVec2>,
    /// Height of the surface, and how far it may be off, metres: see [`Truth::heights`].
    pub height: Vec<(f64, f64)>,
}

/// Places handed to a core at once.
const CHUNK: usize = 1 << 14;
/// Heights in f32 are kept where they are known to within this, pixels; a tenth of the least error
/// that anybody asks for.
pub const KEPT_PIXELS: f64 = 0.1;

impl Places {
    /// Some `count` places that the view may see: fewer where rays meet the sky, none if no ground is
    /// seen. Same seed, same places, on any number of cores.
    ///
    /// The screen is cut into a square lattice of cells, one jittered ray each. Rays are marched over
    /// a stored relief that has a sample for every 2 % of the distance or so; where one ends is only
    /// a place to measure at, the heights there are those of the terrain. Places on the ground are
    /// drawn uniformly over the extent and kept if the relief is in the frustum. Hidden ground counts.
    #[must_use]
    pub fn new(truth: &Truth, view: &View, count: usize, seed: u32) -> Self {
        let relief = Relief::new(truth, view);
        let screen = count / 2;
        // Cells of the screen: columns × rows ≈ screen, square.
        let aspect = view.half.x / view.half.y;
        let rows = (screen as f64 / aspect).sqrt().ceil().max(1.0);
        let columns = (rows * aspect).ceil();
        let cell = view.half * 2.0 / DVec2::new(columns, rows);
        let cells = (columns * rows) as usize;
        let wanted = count - screen;
        let jobs: Vec<(bool, usize)> = (0..cells.div_ceil(CHUNK))
            .map(|k| (true, k))
            .chain((0..wanted.div_ceil(CHUNK)).map(|k| (false, k)))
            .collect();
        let parts = on_all_cores(&jobs, |&(on_screen, k)| {
            let mut random = Random::new(mixed(seed, 2 * k as u32 + u32::from(on_screen)));
            let xz: Vec<DVec2> = if on_screen {
                (k * CHUNK..cells.min((k + 1) * CHUNK))
                    .filter_map(|index| {
                        let at = DVec2::new(
                            (index % columns as usize) as f64,
                            (index / columns as usize) as f64,
                        );
                        let jitter = DVec2::new(random.unit(), random.unit());
                        relief.hit(view, (at + jitter) * cell - view.half)
                    })
                    .collect()
            } else {
                relief.scattered(view, CHUNK.min(wanted - k * CHUNK), &mut random)
            };
            let height = truth.heights(view, &xz, KEPT_PIXELS);
            Self { xz, height }
        });
        let mut all = Self::default();
        for part in parts {
            all.xz.extend(part.xz);
            all.height.extend(part.height);
        }
        all
    }
}

/// Samples along a side of a level of the relief.
const SIDE: usize = 257;
/// Spacing of the finest level, metres.
const FINEST: f64 = 0.03;
/// Step of a ray, as a share of the depth that it has reached.
const STEP: f64 = 0.02;

/// Heights in squares about the eye, each half as wide as the last, all with as many samples: the
/// surface as coarsely as it matters from the eye.
struct Relief {
    extent: dolomite_terrain::GroundRect,
    sea: f64,
    low: f64,
    high: f64,
    levels: Vec<Level>,
    footprint: (Vec<DVec2>, DVec2),
}

struct Level {
    min: DVec2,
    spacing: f64,
    heights: Vec<f32>,
}

impl Relief {
    fn new(truth: &Truth, view: &View) -> Self {
        let extent = truth.terrain.extent();
        let eye = DVec2::new(view.eye.x, view.eye.z);
        // An orthographic camera sees all at one scale, around where its axis meets the ground.
        let centre = match view.visible_height {
            Some(_) if view.forward.y < -0.05 => {
                let along = (extent_height(truth) - view.eye.y) / view.forward.y;
                eye + DVec2::new(view.forward.x, view.forward.z) * along
            }
            _ => eye,
        };
        let widest = 2.0
            * (centre - extent.centre())
                .abs()
                .max_element()
                .max(extent.size().max_element())
            + extent.size().max_element();
        let mut spacings = Vec::new();
        let mut spacing = widest / (SIDE - 1) as f64;
        while spacing > FINEST {
            spacings.push(spacing);
            spacing /= 2.0;
        }
        let levels = on_all_cores(&spacings, |&spacing| {
            let min = centre - spacing * (SIDE - 1) as f64 / 2.0;
            let tile = HeightTile {
                origin: GroundPoint::new(min),
                spacing: DVec2::splat(spacing),
                width: SIDE,
                height: SIDE,
            };
            let [mut heights, mut dx, mut dz] = [(); 3].map(|()| vec![0.0; tile.len()]);
            let planes = Planes {
                value: &mut heights,
                dx: &mut dx,
                dz: &mut dz,
            };
            truth
                .terrain
                .fill_tile(&tile, planes)
                .expect("the planes have the size of the tile");
            Level {
                min,
                spacing,
                heights,
            }
        });
        let (low, high) = truth.bounds(&extent);
        let mut relief = Self {
            extent,
            sea: truth.sea(),
            low: low.max(truth.sea()),
            high: high.max(truth.sea()),
            levels,
            footprint: (Vec::new(), DVec2::ZERO),
        };
        relief.footprint = relief.footprint(view);
        relief
    }

    /// Bilinear, in the finest level that holds the place; nothing outside of the terrain.
    fn height(&self, xz: DVec2) -> Option<f64> {
        if !self.extent.contains(xz) {
            return None;
        }
        for level in self.levels.iter().rev() {
            let at = (xz - level.min) / level.spacing;
            let last = (SIDE - 1) as f64;
            if !(at.cmpge(DVec2::ZERO).all() && at.cmplt(DVec2::splat(last)).all()) {
                continue;
            }
            let (column, row) = (at.x as usize, at.y as usize);
            let part = at - at.floor();
            let sample =
                |c: usize, r: usize| f64::from(level.heights[(row + r) * SIDE + column + c]);
            let north = sample(0, 0) * (1.0 - part.x) + sample(1, 0) * part.x;
            let south = sample(0, 1) * (1.0 - part.x) + sample(1, 1) * part.x;
            return Some((north * (1.0 - part.y) + south * part.y).max(self.sea));
        }
        None
    }

    /// Where the ray through a pixel first crosses the relief.
    fn hit(&self, view: &View, pixel: DVec2) -> Option<DVec2> {
        let (from, along) = view.ray(pixel);
        let at = |t: f64| from + along * t;
        let flat = |p: DVec3| DVec2::new(p.x, p.z);
        // How far above the relief; nothing beyond the terrain.
        let above = |t: f64| self.height(flat(at(t))).map(|h| at(t).y - h);
        let far = (view.eye.distance(DVec3::new(
            self.extent.centre().x,
            self.low,
            self.extent.centre().y,
        )) + self.extent.size().length())
        .max(view.near * 2.0);
        let (mut t, mut last) = (view.near, above(view.near));
        while t < far {
            // Rays from above the highest place skip down to it.
            let skip = match view.visible_height {
                None if at(t).y > self.high && along.y >= 0.0 => return None,
                _ if at(t).y > self.high && along.y < 0.0 => (self.high - at(t).y) / along.y,
                _ => 0.0,
            };
            let step = match view.visible_height {
                // As many steps as an orthographic view has to tell apart.
                Some(visible) => STEP * visible,
                None => STEP * t,
            };
            let next = t + step.max(skip);
            let now = above(next);
            if let (Some(before), Some(after)) = (last, now)
                && (before > 0.0) != (after > 0.0)
            {
                let (mut near, mut beyond) = (t, next);
                for _ in 0..12 {
                    let middle = (near + beyond) / 2.0;
                    if above(middle).is_some_and(|a| (a > 0.0) == (before > 0.0)) {
                        near = middle;
                    } else {
                        beyond = middle;
                    }
                }
                let place = flat(at(beyond));
                return self.extent.contains(place).then_some(place);
            }
            (t, last) = (next, now);
        }
        None
    }

    /// Places on the ground whose relief is in the frustum, drawn uniformly; fewer if they are hard
    /// to find.
    fn scattered(&self, view: &View, count: usize, random: &mut Random) -> Vec<DVec2> {
        let mut places = Vec::with_capacity(count);
        let (cells, size) = &self.footprint;
        if cells.is_empty() {
            return places;
        }
        for _ in 0..count * 64 {
            if places.len() == count {
                break;
            }
            let cell = cells[(random.unit() * cells.len() as f64) as usize];
            let xz = cell + *size * DVec2::new(random.unit(), random.unit());
            if let Some(height) = self.height(xz)
                && view.sees(DVec3::new(xz.x, height, xz.y))
            {
                places.push(xz);
            }
        }
        places
    }

    /// Cells of the ground, all of one size, that the view may see: quartered until there are a
    /// thousand. Nine heights of a cell and a slope of 1 between them are taken for all of it, which
    /// serves to spread places, not to prove anything.
    fn footprint(&self, view: &View) -> (Vec<DVec2>, DVec2) {
        let mut cells = vec![self.extent.min];
        let mut size = self.extent.size();
        while cells.len() < 1000 && size.max_element() > FINEST {
            size /= 2.0;
            let quarters = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
            cells = cells
                .iter()
                .flat_map(|&min| quarters.map(|q| min + q * size))
                .filter(|&min| {
                    let nine = (0..9).filter_map(|k| {
                        let share = DVec2::new(f64::from(k % 3), f64::from(k / 3)) / 2.0;
                        self.height((min + size * share).min(self.extent.max))
                    });
                    let (low, high) = nine.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), y| {
                        (l.min(y), h.max(y))
                    });
                    let margin = size.max_element();
                    let max = min + size;
                    view.may_see_box(
                        DVec3::new(min.x, low - margin, min.y),
                        DVec3::new(max.x, high + margin, max.y),
                    )
                })
                .collect();
        }
        (cells, size)
    }
}

/// Middle height of the terrain, metres.
fn extent_height(truth: &Truth) -> f64 {
    truth.height(truth.terrain.extent().centre())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::{cameras, terrains};

    #[test]
    fn places_are_seen_and_fill_the_screen_for_every_camera() {
        let truth = Truth::new(&terrains::fbm(2));
        for (kind, camera) in cameras::KINDS
            .into_iter()
            .zip(cameras::over(&truth.terrain, 3))
        {
            let view = camera.view();
            let places = Places::new(&truth, &view, 4000, 1);
            let again = Places::new(&truth, &view, 4000, 1);
            assert_eq!(places.xz, again.xz);
            assert!(places.xz.len() > 1000, "{kind:?}: {}", places.xz.len());
            let on_screen: Vec<_> = places
                .xz
                .iter()
                .filter_map(|&xz| view.project(DVec3::new(xz.x, truth.height(xz), xz.y)))
                .filter(|at| at.abs().cmple(view.half).all())
                .collect();
            // The relief is not the ground, so some places near the border are not seen.
            assert!(
                on_screen.len() * 10 > places.xz.len() * 8,
                "{kind:?}: {} of {}",
                on_screen.len(),
                places.xz.len()
            );
            // Ground is seen from left to right; the whole terrain, from above, in the middle.
            let mut strips = [0; 8];
            for at in &on_screen {
                strips[((at.x / view.half.x + 1.0) * 3.999) as usize] += 1;
            }
            let part = if kind == cameras::Kind::Above {
                2..6
            } else {
                0..8
            };
            // The near plane hides most of the ground on one side.
            let least = if kind == cameras::Kind::NearPlane {
                0
            } else {
                20
            };
            assert!(
                strips[part].iter().all(|&n| n > least),
                "{kind:?}: {strips:?}"
            );
        }
    }
}
