//! Ground that other ground hides: the CPU reference of `shaders/src/detail/horizon.wgsl` and of the passes
//! `draw_horizon` and `close_horizon`.
//!
//! Heights have one value at a place, so whatever lies on a ray from the eye beyond a point of it that is
//! below the drawn ground is behind the ground. It is found in this frame alone: nothing is remembered
//! from the last one, and the picture is the same without it.
//!
//! **The map.** The upright plane one metre ahead of the eye: along it u, upwards s. A place at depth x, y to
//! the side, h above the eye lies at u = y/x, s = h/x; triangles stay triangles. What the view shows of u
//! is divided into [`COLUMNS`], depths into [`LAYERS`], four an octave. A column of a layer holds the
//! greatest s below which all rays in the column are below the drawn ground somewhere in the layers up to
//! this one.
//!
//! **Who writes.** Every cell that is drawn, itself or by its quarters: the drawn ground in it is nowhere
//! below its lowest height, so it hides what a flat square of that height would hide. In u and q = 1/x a
//! square has straight sides, and s of a flat square is its height times q: over a column the least s of
//! the far side (of squares below the eye) or the near one (above) is at one of the column's borders.
//! Small cells are narrower than a column and write nothing; the cells around them do. A column that the
//! border of two cells crosses would stay empty: so a cell and the next one to the east, and to the south, are
//! drawn once more as one rectangle of the lower height of both.
//!
//! **Who is hidden.** A triangle whose greatest s, which is one of its corners', lies below what all the
//! columns hold that it touches, in the layer before its nearest corner.
//!
//! **Where it holds.** The first crossing of a ray is from above, so that its triangle faces the eye, if the
//! eye and the whole part of the picture nearer than the near plane are above the drawn ground: cells near
//! the eye that reach as high make it blind, and then nothing is hidden. So does an eye beyond the ground's
//! border, which may look below it. Both
//! sides keep a distance of a quarter pixel in all directions: a corner may be drawn off its place by a tenth
//! ([`super::cull`]).

use bevy::math::{DVec3, Vec2, Vec3};
use bytemuck::{Pod, Zeroable};

use super::cell::DetailCells;
use super::cull::CullView;
use super::select::{Selection, cell_box};
use super::view::DetailView;

/// Columns over the width of the picture.
pub const COLUMNS: usize = 512;
/// Layers of depth.
pub const LAYERS: usize = 96;
/// Layers in which the depth doubles.
const AN_OCTAVE: f32 = 4.0;
/// What the logarithm of a depth may be off by, in layers.
const LAYER_ROUNDING: f32 = 0.01;
/// Pixels that occluders are smaller by, and what they hide is larger by.
const MARGIN: f32 = 0.25;
/// More than anything is: beyond are infinities.
const MOST: f32 = 1e30;
/// Greatest u of the map: 83 degrees to the side. Who looks farther down sees little that is hidden.
const GREATEST_REACH: f64 = 8.0;
/// Pixels that a direction may be off where coordinates are rounded to f32.
const ROUNDED_PIXELS: f64 = 0.1;

/// How a view looks at its horizon; of `types.wgsl`. Relative to the stage's anchor, its height too.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct HorizonView {
    /// The eye.
    pub eye: [f32; 3],
    /// Depth at which the first layer begins: what is nearer hides nothing and is not hidden. Metres.
    pub nearest: f32,
    /// Unit direction (x, z) of depth.
    pub ahead: [f32; 2],
    /// Greatest |u| that the view shows.
    pub reach: f32,
    /// u of a pixel straight ahead.
    pub pixel: f32,
    /// Distance from the eye to the corners of the near plane, metres.
    pub near_reach: f32,
    /// Nothing.
    pub pad: [f32; 3],
}

/// Where a place is on the map, and its depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mapped {
    /// To the side.
    pub u: f32,
    /// Upwards.
    pub s: f32,
    /// Depth, metres.
    pub depth: f32,
}

impl HorizonView {
    /// Of a view that sees ground through a picture; `None` where nothing is looked for: parallel rays, a
    /// camera that looks down so steeply that the map would be wider than it is useful, an eye that is not
    /// over the ground.
    #[must_use]
    pub fn new(
        cells: &DetailCells,
        view: &DetailView,
        picture: &CullView,
        anchor_height: f32,
    ) -> Option<Self> {
        if view.orthographic == 1.0 {
            return None;
        }
        let [x, y, z] = view.eye.map(f64::from);
        let eye = DVec3::new(x, y - f64::from(anchor_height), z);
        let extent = cells.terrain().extent();
        let place = view.anchor().as_dvec2() + bevy::math::DVec2::new(x, z);
        let [fx, _, fz] = view.forward.map(f64::from);
        let ahead = bevy::math::DVec2::new(fx, fz).try_normalize()?;
        let world_from_clip = picture.clip.as_dmat4().inverse();
        let (mut reach, mut nearest, mut near_reach) = (0.0_f64, 0.0_f64, 0.0_f64);
        for corner in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
            let at = |z: f64| world_from_clip.project_point3(DVec3::new(corner[0], corner[1], z));
            // Depth of clip space is reversed: 1 is the near plane.
            let near = at(1.0);
            let along = at(0.5) - near;
            let along = bevy::math::DVec2::new(along.x, along.z);
            let (forward, side) = (ahead.dot(along), ahead.perp_dot(along));
            if !(forward > 0.0 && side.abs() <= GREATEST_REACH * forward) {
                return None;
            }
            reach = reach.max(side.abs() / forward);
            let near = near - eye;
            nearest = nearest.max(ahead.dot(bevy::math::DVec2::new(near.x, near.z)));
            near_reach = near_reach.max(near.length());
        }
        let rounding = f64::from(f32::EPSILON) * eye.abs().max_element();
        nearest = nearest.max(rounding * f64::from(view.scale) / ROUNDED_PIXELS);
        let inside = |at: bevy::math::DVec2| {
            let border = extent.min + near_reach;
            at.cmpge(border).all() && at.cmple(extent.max - near_reach).all()
        };
        let found = [reach, nearest, near_reach, f64::from(view.scale)];
        let usable = found.iter().all(|v| v.is_finite() && *v > 0.0) && inside(place);
        usable.then(|| Self {
            eye: eye.as_vec3().to_array(),
            nearest: nearest as f32,
            ahead: ahead.as_vec2().to_array(),
            reach: reach as f32,
            pixel: 1.0 / view.scale,
            near_reach: near_reach as f32,
            pad: [0.0; 3],
        })
    }

    /// Where a place is on the map.
    #[must_use]
    pub fn map(&self, place: Vec3) -> Mapped {
        let from = place - Vec3::from(self.eye);
        let ahead = Vec2::from(self.ahead);
        let from_xz = Vec2::new(from.x, from.z);
        let depth = ahead.dot(from_xz);
        let q = 1.0 / depth;
        Mapped {
            u: ahead.perp_dot(from_xz) * q,
            s: from.y * q,
            depth,
        }
    }

    /// In units of columns.
    fn column(&self, u: f32) -> f32 {
        (u + self.reach) * (COLUMNS as f32 / (2.0 * self.reach))
    }

    /// The margin where |u| and |s| are at most these.
    fn margin(&self, u: f32, s: f32) -> f32 {
        MARGIN * self.pixel * (1.0 + u * u + s * s)
    }

    fn layer(&self, depth: f32) -> f32 {
        bevy::math::ops::log2(depth / self.nearest) * AN_OCTAVE
    }
}

/// s of a flat square, `lift` above the eye, at u: of its far side where it is below the eye, else of its
/// near side; −∞ beside it.
fn side_of(corners: &[Mapped; 4], lift: f32, u: f32) -> f32 {
    let mut highest = f32::NEG_INFINITY;
    for k in 0..4 {
        let (a, b) = (corners[k], corners[(k + 1) & 3]);
        if (a.u - u) * (b.u - u) <= 0.0 && a.u != b.u {
            let (qa, qb) = (1.0 / a.depth, 1.0 / b.depth);
            let q = qa + (qb - qa) * ((u - a.u) / (b.u - a.u));
            highest = highest.max(lift * q);
        }
    }
    highest
}

/// What a view's ground hides.
#[derive(Clone, Debug)]
pub struct Horizon {
    view: HorizonView,
    /// By layers, then columns.
    steepest: Vec<f32>,
    /// Whether drawn ground may be as high as the eye beside it.
    blind: bool,
}

impl Horizon {
    /// Nothing yet.
    #[must_use]
    pub fn new(view: HorizonView) -> Self {
        Self {
            view,
            steepest: vec![f32::NEG_INFINITY; COLUMNS * LAYERS],
            blind: false,
        }
    }

    /// Of what a selection draws; `view` is the one that it was made for, `anchor_height` the height of the
    /// stage's anchor.
    #[must_use]
    pub fn of(
        horizon: HorizonView,
        cells: &DetailCells,
        selection: &Selection,
        view: &DetailView,
        anchor_height: f32,
    ) -> Self {
        let mut all = Self::new(horizon);
        let lowered = Vec3::Y * anchor_height;
        let mut take = |place, number, drawn_quarters: [bool; 4]| {
            let (low, high) = cell_box(view, &cells.lattice, place, cells.cell(number));
            all.draw(low - lowered, high - lowered);
            all.stand(low - lowered, high - lowered, drawn_quarters);
            (low - lowered, high - lowered)
        };
        let mut pairs = Vec::new();
        for cell in selection.cells() {
            let drawn = |corner| {
                let child = cell.place.child(corner);
                child.is_some_and(|child| selection.find(&cells.lattice, child).is_some())
            };
            let (low, high) = take(cell.place, cell.number, [0, 1, 2, 3].map(drawn));
            for side in [2, 3] {
                let next = selection.find(&cells.lattice, cell.place.neighbour(side));
                if let Some(next) = next {
                    let (_, end) =
                        cell_box(view, &cells.lattice, next.place, cells.cell(next.number));
                    let lowest = low.y.min(cells.cell(next.number).low - anchor_height);
                    pairs.push((low.with_y(lowest), end.with_y(high.y)));
                }
            }
        }
        for &(place, _) in &selection.whole_roots {
            if let Some(number) = cells.number(place) {
                take(place, number, [false; 4]);
            }
        }
        for (low, high) in pairs {
            all.draw(low, high);
        }
        all.close();
        all
    }

    /// Ground in this box is drawn, and nowhere below it.
    fn draw(&mut self, low: Vec3, high: Vec3) {
        let view = self.view;
        let lift = low.y - view.eye[1];
        let corners = [
            Vec3::new(low.x, low.y, low.z),
            Vec3::new(high.x, low.y, low.z),
            Vec3::new(high.x, low.y, high.z),
            Vec3::new(low.x, low.y, high.z),
        ]
        .map(|corner| view.map(corner));
        let fold = |pick: fn(f32, f32) -> f32, of: fn(Mapped) -> f32| {
            corners.map(of).into_iter().reduce(pick).expect("four")
        };
        // What is no number hides nothing.
        if !(fold(f32::min, |at| at.depth) >= view.nearest && lift.abs() < MOST) {
            return;
        }
        let layer = (view.layer(fold(f32::max, |at| at.depth)) + LAYER_ROUNDING).ceil();
        if layer >= LAYERS as f32 {
            return;
        }
        let (left, right) = (fold(f32::min, |at| at.u), fold(f32::max, |at| at.u));
        let steepness = fold(f32::max, |at| at.s.abs());
        let margin = view.margin(left.abs().max(right.abs()), steepness);
        let first = view.column(left + margin).ceil().max(0.0) as usize;
        let last = view
            .column(right - margin)
            .floor()
            .clamp(0.0, COLUMNS as f32) as usize;
        let width = 2.0 * view.reach / COLUMNS as f32;
        for column in first..last {
            let u = column as f32 * width - view.reach;
            let from = side_of(&corners, lift, u - margin);
            let to = side_of(&corners, lift, u + width + margin);
            let at = &mut self.steepest[layer.max(0.0) as usize * COLUMNS + column];
            *at = at.max(from.min(to) - margin);
        }
    }

    /// Looks whether ground in this box, of which these quarters are drawn as cells of their own, may be as
    /// high as the eye beside it.
    fn stand(&mut self, low: Vec3, high: Vec3, drawn_quarters: [bool; 4]) {
        let eye = Vec3::from(self.view.eye);
        let reach = self.view.near_reach;
        // A height that is no number is as high.
        if high.y < eye.y - reach {
            return;
        }
        let middle = (low + high) * 0.5;
        for (corner, drawn) in drawn_quarters.into_iter().enumerate() {
            let east = corner == 1 || corner == 2;
            let south = corner >= 2;
            let (x0, x1) = if east {
                (middle.x, high.x)
            } else {
                (low.x, middle.x)
            };
            let (z0, z1) = if south {
                (middle.z, high.z)
            } else {
                (low.z, middle.z)
            };
            let near = eye.x >= x0 - reach
                && eye.x <= x1 + reach
                && eye.z >= z0 - reach
                && eye.z <= z1 + reach;
            self.blind |= near && !drawn;
        }
    }

    /// What a layer hides, those beyond it hide as well.
    fn close(&mut self) {
        for at in COLUMNS..COLUMNS * LAYERS {
            self.steepest[at] = self.steepest[at].max(self.steepest[at - COLUMNS]);
        }
    }

    /// Whether a triangle is behind drawn ground wherever the view shows it. Corners relative to the
    /// stage's anchor.
    #[must_use]
    pub fn hides(&self, triangle: [Vec3; 3]) -> bool {
        if self.blind {
            return false;
        }
        let view = &self.view;
        let corners = triangle.map(|corner| view.map(corner));
        let [a, b, c] = corners;
        let depth = a.depth.min(b.depth).min(c.depth);
        let sound =
            |at: &Mapped| at.depth >= view.nearest && at.s.abs() < MOST && at.u.abs() < MOST;
        let sound = corners.iter().all(sound);
        let layer = (view.layer(depth) - LAYER_ROUNDING).floor();
        // No comparison with what is not a number holds.
        let within = sound && layer >= 0.0;
        if !within {
            return false;
        }
        let layer = layer.min((LAYERS - 1) as f32) as usize;
        let (left, right) = (a.u.min(b.u).min(c.u), a.u.max(b.u).max(c.u));
        let top = a.s.max(b.s).max(c.s);
        let steepness = a.s.abs().max(b.s.abs()).max(c.s.abs());
        let margin = view.margin(left.abs().max(right.abs()), steepness);
        let most = (COLUMNS - 1) as f32;
        let first = view.column(left - margin).floor().clamp(0.0, most) as usize;
        let last = view.column(right + margin).floor().clamp(0.0, most) as usize;
        let row = &self.steepest[layer * COLUMNS..][..COLUMNS];
        row[first..=last].iter().all(|&held| top + margin < held)
    }
}

#[cfg(test)]
mod tests;
