//! The layer itself: heights and gradients of what was edited, and what two layers differ in.

use super::lattice::EditLattice;
use super::tile::{CELLS, SIDE, STEP, Tile, metres};
use super::tree::{self, Link};
use crate::ground::{GroundPoint, GroundRect, GroundSample, Height};
use crate::height_map::{Filter, slopes, weights, weights_f64};
use crate::noise::coordinate::{cell, fraction};
use bevy::math::{DVec2, Vec2};

/// What was edited of a terrain. Immutable and cheap to clone; see [`crate::edits`].
#[derive(Clone, Debug)]
pub struct Edits {
    pub(super) lattice: EditLattice,
    pub(super) root: Link,
}

/// Two layers are equal where they are the same one: as what `Terrain::same` says.
impl PartialEq for Edits {
    fn eq(&self, other: &Self) -> bool {
        self.lattice == other.lattice && tree::same(&self.root, &other.root)
    }
}

impl Edits {
    /// Nothing edited yet.
    #[must_use]
    pub const fn none(lattice: EditLattice) -> Self {
        Self {
            lattice,
            root: None,
        }
    }

    /// Where its samples lie.
    #[must_use]
    pub const fn lattice(&self) -> &EditLattice {
        &self.lattice
    }

    /// Whether nothing is edited.
    #[must_use]
    pub const fn is_empty(&self) -> bool {
        self.root.is_none()
    }

    /// Tiles, and nodes of the tree with them.
    #[must_use]
    pub fn counts(&self) -> [u32; 2] {
        self.root.as_deref().map_or([0; 2], tree::Node::counts)
    }

    /// How much a sample is raised, in [`STEP`]s.
    #[must_use]
    pub fn steps(&self, [x, z]: [i64; 2]) -> i32 {
        self.tile_of([x, z])
            .map_or(0, |(tile, [x, z])| tile.at(x, z))
    }

    /// The tile of a cell, and the cell in it.
    fn tile_of(&self, [x, z]: [i64; 2]) -> Option<(&Tile, [i32; 2])> {
        let [across, down] = self.lattice.samples();
        if !(0..across).contains(&x) || !(0..down).contains(&z) {
            return None;
        }
        let place = [x, z].map(|k| (k >> CELLS.trailing_zeros()) as u32);
        let node = tree::find(&self.root, self.lattice.level(), place, 0)?;
        let inside = [x, z].map(|k| (k & i64::from(CELLS - 1)) as i32);
        Some((node.tile()?, inside))
    }

    pub(crate) fn tile(&self, place: [u32; 2]) -> Option<&Tile> {
        tree::find(&self.root, self.lattice.level(), place, 0)?.tile()
    }

    /// The layer with another tile.
    pub(crate) fn with_tile(&self, place: [u32; 2], tile: Option<Tile>) -> Self {
        Self {
            lattice: self.lattice,
            root: tree::set(&self.root, self.lattice.level(), place, tile),
        }
    }

    /// All tiles with their places, in the order of the tree.
    pub(crate) fn tiles(&self) -> Vec<([u32; 2], &Tile)> {
        let mut all = Vec::new();
        tree::differences(
            &None,
            &self.root,
            self.lattice.level(),
            [0; 2],
            &mut |node| {
                if let Some(tile) = node.now.and_then(tree::Node::tile) {
                    all.push((node.place, tile));
                }
            },
        );
        all
    }

    /// Height and gradient of what was edited, f32: the CPU reference of `edits.wgsl`.
    #[must_use]
    pub fn sample(&self, point: GroundPoint) -> Height {
        let [fx, fz] = self.lattice.frequency;
        let (at, origin) = (point.to_fixed(), self.lattice.origin.to_fixed());
        let x = fx.coordinate(at[0].wrapping_sub(origin[0]));
        let z = fz.coordinate(at[1].wrapping_sub(origin[1]));
        let cells = [cell(x) as i32, cell(z) as i32].map(i64::from);
        let Some((tile, [i, j])) = self.tile_of(cells) else {
            return Height::default();
        };
        let (fx, fz) = (fraction(x), fraction(z));
        let middle = metres(tile.at(i, j));
        let at = |di: i32, dj: i32| metres(tile.at(i + di, j + dj)) - middle;
        let (mut value, mut gradient) = (0.0, Vec2::ZERO);
        match self.lattice.filter {
            Filter::Bilinear => {
                let (east, south, far) = (at(1, 0), at(0, 1), at(1, 1));
                let twist = (far - south) - east;
                value = fx * east + fz * (south + fx * twist);
                gradient = Vec2::new(east + fz * twist, south + fx * twist);
            }
            Filter::Bicubic => {
                let (wx, sx) = (weights(fx), slopes(fx));
                let (wz, sz) = (weights(fz), slopes(fz));
                for (dj, (w, s)) in (-1..).zip(wz.into_iter().zip(sz)) {
                    let row = [at(-1, dj), at(0, dj), at(1, dj), at(2, dj)];
                    let along = |k: [f32; 4]| {
                        (k[0] * row[0] + k[1] * row[1]) + (k[2] * row[2] + k[3] * row[3])
                    };
                    let across = along(wx);
                    value += w * across;
                    gradient += Vec2::new(w * along(sx), s * across);
                }
            }
        }
        Height {
            value: middle + value,
            gradient: gradient * self.lattice.scale().as_vec2(),
        }
    }

    /// Height and gradient in f64 at (x, z) metres.
    #[must_use]
    pub fn sample_f64(&self, xz: DVec2) -> GroundSample {
        let [x, z] = self.lattice.frequency;
        let at = xz - self.lattice.origin.to_dvec2();
        let (i, fx) = x.coordinate_f64(at.x, 0);
        let (j, fz) = z.coordinate_f64(at.y, 0);
        let Some((tile, [i, j])) = self.tile_of([i64::from(i), i64::from(j)]) else {
            return GroundSample::default();
        };
        let at = |di: i32, dj: i32| f64::from(tile.at(i + di, j + dj)) * STEP;
        let scale = self.lattice.scale();
        let mut sum = GroundSample::default();
        match self.lattice.filter {
            Filter::Bilinear => {
                let north = at(0, 0) + fx * (at(1, 0) - at(0, 0));
                let south = at(0, 1) + fx * (at(1, 1) - at(0, 1));
                let east = (1.0 - fz) * (at(1, 0) - at(0, 0)) + fz * (at(1, 1) - at(0, 1));
                sum.height = north + fz * (south - north);
                sum.gradient = DVec2::new(east, south - north);
            }
            Filter::Bicubic => {
                let ((wx, sx), (wz, sz)) = (weights_f64(fx), weights_f64(fz));
                for (dj, (w, s)) in (-1..).zip(wz.into_iter().zip(sz)) {
                    for (di, (v, t)) in (-1..).zip(wx.into_iter().zip(sx)) {
                        let sample = at(di, dj);
                        sum.height += w * v * sample;
                        sum.gradient += DVec2::new(w * t, s * v) * sample;
                    }
                }
            }
        }
        sum.gradient *= scale;
        sum
    }

    /// Rectangles beyond which two layers on one lattice are the same, metres: one about the samples that differ in each
    /// tile, those beside each other joined. `None` where they are on two lattices.
    #[must_use]
    pub fn changed_since(&self, before: &Self) -> Option<Vec<GroundRect>> {
        if self.lattice != before.lattice {
            return None;
        }
        let mut rects: Vec<GroundRect> = Vec::new();
        let level = self.lattice.level();
        tree::differences(&before.root, &self.root, level, [0; 2], &mut |node| {
            if node.level > 0 {
                return;
            }
            let steps = |side: Option<&'_ tree::Node>, k: usize| {
                side.and_then(tree::Node::tile)
                    .map_or(0, |tile| tile.steps()[k])
            };
            let (mut low, mut high) = ([i64::MAX; 2], [i64::MIN; 2]);
            for k in 0..SIDE * SIDE {
                if steps(node.before, k) != steps(node.now, k) {
                    for (axis, k) in [k % SIDE, k / SIDE].into_iter().enumerate() {
                        low[axis] = low[axis].min(k as i64);
                        high[axis] = high[axis].max(k as i64);
                    }
                }
            }
            if low[0] > high[0] {
                return;
            }
            // Interpolation reaches two samples.
            let first = node.place.map(|k| i64::from(k) * i64::from(CELLS) - 1);
            let corner = |inside: [i64; 2], reach: i64| {
                self.lattice
                    .place([first[0] + inside[0] + reach, first[1] + inside[1] + reach])
            };
            join(
                &mut rects,
                GroundRect::new(corner(low, -2), corner(high, 2)),
            );
        });
        Some(rects)
    }
}

/// Adds a rectangle to a list, as a part of one beside it where the two fill theirs well.
fn join(rects: &mut Vec<GroundRect>, mut new: GroundRect) {
    let area = |rect: &GroundRect| rect.size().x * rect.size().y;
    while let Some((k, both)) = rects.iter().enumerate().find_map(|(k, rect)| {
        let both = GroundRect::new(rect.min.min(new.min), rect.max.max(new.max));
        (area(&both) <= 1.5 * (area(rect) + area(&new))).then_some((k, both))
    }) {
        rects.swap_remove(k);
        new = both;
    }
    rects.push(new);
}
