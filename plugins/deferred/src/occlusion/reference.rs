//! The passes of ambient occlusion on the CPU: the functions of `shaders/src/deferred/occlusion.wgsl`, in Rust.
//!
//! ```text
//! A(p, n) = 1/π ∫_slices |n'| ∫ V(θ) cos(θ − γ) |sin θ| dθ dψ
//! ```
//!
//! A slice is a half-turn of directions in a plane that holds the view direction `v`; `n'` is the normal projected on
//! it, `γ` the angle from `v` to it, `θ` that of a direction (Jimenez, Wu, Pesce, Jarabo, "Practical real-time strategies
//! for accurate indirect occlusion", 2016). Slices are spread evenly about `v` itself, not about the camera's axis, so
//! that wide views are not wrong towards their borders. What a pixel of the picture hides of a slice is the arc between
//! its surface and a place a thickness behind it (Therrien, Levesque, Gilet, "Screen space indirect lighting with
//! visibility bitmask", 2023); arcs are kept in 32 parts of *equal weight* of the inner integral, whose primitive is
//! known, so that no part counts more than it should. The angle of a pixel is found from its height over the surface's
//! own plane: pixels do not lie in the plane of a slice, and a flat floor must not hide itself for that.

use bevy::math::{IVec2, UVec2, Vec2, Vec3, ops};
use core::f32::consts::{FRAC_PI_2, PI};

use super::Settings;

/// Pixels on a side of the pattern of slices and steps, and of the filter that averages it.
pub const PATTERN: i32 = 4;

/// How places of the view come from pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projection {
    /// Of a perspective projection: `x / −z` at the right border, `y / −z` at the upper one; of an orthographic one
    /// `x` and `y` there.
    pub tangents: Vec2,
    /// Whether all rays run along the camera's axis.
    pub orthographic: bool,
}

/// What a camera sees, rows from the top.
pub struct Screen<'a> {
    /// Pixels.
    pub size: UVec2,
    /// Metres along the camera's axis; 0 where there is nothing.
    pub depths: &'a [f32],
    /// In view space: +X right, +Y up, the camera looks along −Z.
    pub normals: &'a [Vec3],
    /// See [`Projection`].
    pub projection: Projection,
}

/// An angle's sine and cosine beside it.
#[derive(Clone, Copy, Debug)]
pub struct Angle {
    theta: f32,
    sine: f32,
    cosine: f32,
}

/// An angle.
#[must_use]
pub fn angle(theta: f32) -> Angle {
    Angle {
        theta,
        sine: ops::sin(theta),
        cosine: ops::cos(theta),
    }
}

/// The inner integral from the view direction to an angle; the normal's is `gamma`.
#[must_use]
pub fn primitive(at: Angle, gamma: Angle) -> f32 {
    // cos(2θ − γ) from the cosines and sines of both.
    let twice =
        (2.0 * at.cosine * at.cosine - 1.0) * gamma.cosine + 2.0 * at.sine * at.cosine * gamma.sine;
    let area = 0.25 * (gamma.cosine - twice + 2.0 * at.theta * gamma.sine);
    if at.theta < 0.0 { -area } else { area }
}

/// The arc cosine to 7e-5, of which a thirty-second part of a slice is several hundred (Abramowitz and Stegun, 4.4.45).
#[must_use]
pub fn arc_cosine(x: f32) -> f32 {
    let a = x.abs().min(1.0);
    let positive =
        (1.0 - a).sqrt() * (1.570_728_8 + a * (-0.212_114_4 + a * (0.074_261 - a * 0.018_729_3)));
    if x < 0.0 { PI - positive } else { positive }
}

/// The bits of the parts between two shares of a slice: those whose middle lies between them.
#[must_use]
pub fn parts(low: f32, high: f32) -> u32 {
    let first = (low * 32.0 + 0.5) as u32;
    let end = (high * 32.0 + 0.5) as u32;
    if first >= end || first >= 32 {
        return 0;
    }
    (u32::MAX >> (32 - (end - first).min(32))) << first
}

/// The turn of the slices and the shift of the steps of a pixel, each a middle of sixteen parts of `0..1`: each once in
/// every 4 × 4 pixels. Neighbours are far apart in both: an ordered dither, and the same mirrored.
#[must_use]
pub fn pattern(pixel: IVec2) -> Vec2 {
    let order = |x: i32, y: i32| {
        let low = (((x ^ y) & 1) << 1) | (y & 1);
        let high = (((x ^ y) >> 1) << 1) | (y >> 1);
        (low << 2) | high
    };
    let at = pixel & (PATTERN - 1);
    Vec2::new(
        (order(at.x, at.y) as f32 + 0.5) / 16.0,
        (order(at.y ^ 1, at.x ^ 2) as f32 + 0.5) / 16.0,
    )
}

/// What a pixel of the filter counts along an axis, at `away` from the pixel that is asked for: with it each of the
/// pattern's four columns counts the same.
#[must_use]
pub fn share(away: f32) -> f32 {
    (2.5 - away.abs()).clamp(0.0, 1.0)
}

/// Of the way from what is seen at `away` through what is behind it, as long as things are thick: where it enters and leaves
/// the ball of the radius, metres. What is seen may lie outside and yet be in the way behind.
fn within(away: Vec3, behind: Vec3, settings: &Settings) -> Option<[f32; 2]> {
    let along = away.dot(behind);
    let aside = away - along * behind;
    let room = settings.radius * settings.radius - aside.length_squared();
    if room <= 0.0 {
        return None;
    }
    let half = room.sqrt();
    let first = (-along - half).max(0.0);
    let last = (half - along).min(settings.thickness);
    (first < last).then_some([first, last])
}

/// A slice of one pixel.
struct Slice {
    tangent: Vec3,
    /// At a right angle to the projected normal, towards the tangent.
    across: Vec3,
    /// Of the projected normal.
    length: f32,
    gamma: Angle,
    /// The inner integral up to the first end, and over all.
    low: f32,
    all: f32,
}

impl Slice {
    fn new(tangent: Vec3, view: Vec3, normal: Vec3) -> Self {
        let axis = tangent.cross(view);
        let projected = normal - axis * normal.dot(axis);
        let length = projected.length();
        let unit = projected / length.max(1e-6);
        let side = if unit.dot(tangent) < 0.0 { -1.0 } else { 1.0 };
        let gamma = angle(side * arc_cosine(unit.dot(view)));
        let low = primitive(angle(gamma.theta - FRAC_PI_2), gamma);
        let high = primitive(angle(gamma.theta + FRAC_PI_2), gamma);
        Self {
            tangent,
            across: tangent * gamma.cosine - view * gamma.sine,
            length,
            gamma,
            low,
            all: (high - low).max(1e-6),
        }
    }

    /// The share of the inner integral up to a place at `away`, which was looked at on a side: 1 or −1.
    fn share(&self, away: Vec3, normal: Vec3, side: f32) -> f32 {
        let height = normal.dot(away);
        // Below the surface's plane is beyond the end of that side.
        if height <= 0.0 {
            return if side < 0.0 { 0.0 } else { 1.0 };
        }
        let of_normal = if self.across.dot(away) < 0.0 {
            -1.0
        } else {
            1.0
        };
        let cosine = height / (away.length() * self.length).max(1e-20);
        let at = angle(self.gamma.theta + of_normal * arc_cosine(cosine));
        ((primitive(at, self.gamma) - self.low) / self.all).clamp(0.0, 1.0)
    }
}

impl Screen<'_> {
    fn index(&self, pixel: IVec2) -> Option<usize> {
        let inside = pixel.cmpge(IVec2::ZERO).all() && pixel.cmplt(self.size.as_ivec2()).all();
        inside.then(|| (pixel.y * self.size.x as i32 + pixel.x) as usize)
    }

    /// The place in view space of the middle of a pixel at a depth.
    fn place(&self, pixel: IVec2, depth: f32) -> Vec3 {
        let ndc = (pixel.as_vec2() + 0.5) / self.size.as_vec2() * Vec2::new(2.0, -2.0)
            + Vec2::new(-1.0, 1.0);
        let flat = ndc * self.projection.tangents;
        let scale = if self.projection.orthographic {
            1.0
        } else {
            depth
        };
        (flat * scale).extend(-depth)
    }

    /// Metres of a pixel across the view at a depth.
    fn footprint(&self, depth: f32) -> f32 {
        let metres = 2.0 * self.projection.tangents.y / self.size.y as f32;
        if self.projection.orthographic {
            metres
        } else {
            metres * depth
        }
    }

    fn towards_camera(&self, place: Vec3) -> Vec3 {
        if self.projection.orthographic {
            Vec3::Z
        } else {
            -place.normalize()
        }
    }

    /// The share of the light from everywhere that reaches a pixel, 0 to 1; 1 where there is nothing. `cell` is the
    /// pixel's place in the pattern: the pixel itself, or that of the half-sized picture.
    #[must_use]
    pub fn visible(&self, pixel: IVec2, cell: IVec2, settings: &Settings) -> f32 {
        let Some(index) = self.index(pixel) else {
            return 1.0;
        };
        let depth = self.depths[index];
        if depth <= 0.0 {
            return 1.0;
        }
        let reach = (settings.radius / self.footprint(depth)).min(settings.most_pixels);
        // Within less than two pixels nothing can be told apart.
        if reach < 2.0 {
            return 1.0;
        }
        let place = self.place(pixel, depth);
        let view = self.towards_camera(place);
        let normal = self.normals[index];
        let told = pattern(cell);
        let across = Vec3::new(view.z, 0.0, -view.x).normalize();
        let up = view.cross(across);
        let (mut sum, mut weights) = (0.0, 0.0);
        for k in 0..settings.slices {
            let psi = PI * (k as f32 + told.x) / settings.slices as f32;
            let tangent = ops::cos(psi) * across + ops::sin(psi) * up;
            let slice = Slice::new(tangent, view, normal);
            let hidden = self.hidden(pixel, (place, normal), &slice, (reach, told.y), settings);
            sum += slice.length * (32 - hidden.count_ones()) as f32 / 32.0;
            weights += slice.length;
        }
        sum / weights.max(1e-6)
    }

    /// The parts of a slice that are hidden.
    fn hidden(
        &self,
        pixel: IVec2,
        (place, normal): (Vec3, Vec3),
        slice: &Slice,
        (reach, shift): (f32, f32),
        settings: &Settings,
    ) -> u32 {
        // The slice's line in the picture.
        let along = if self.projection.orthographic {
            slice.tangent.truncate()
        } else {
            slice.tangent.truncate() * -place.z + place.truncate() * slice.tangent.z
        };
        let along = along.normalize() * Vec2::new(1.0, -1.0);
        let mut hidden = 0;
        for side in [-1.0_f32, 1.0] {
            for step in 0..settings.steps {
                let far = (step as f32 + shift) / settings.steps as f32;
                let offset = (reach * far * far).max(1.0 + step as f32);
                let at = pixel + (along * (side * offset) + 0.5).floor().as_ivec2();
                let Some(index) = self.index(at) else { break };
                let depth = self.depths[index];
                if depth <= 0.0 {
                    continue;
                }
                let other = self.place(at, depth);
                let away = other - place;
                let behind = -self.towards_camera(other);
                let Some([first, last]) = within(away, behind, settings) else {
                    continue;
                };
                let front = slice.share(away + first * behind, normal, side);
                let back = slice.share(away + last * behind, normal, side);
                hidden |= parts(front.min(back), front.max(back));
            }
        }
        hidden
    }

    /// The mean of what was found about a pixel over the pattern, of pixels that lie in its plane. `traced` has what was
    /// found and the depth where; with `halved` that is a picture of half the size, of every second pixel.
    #[must_use]
    pub fn filtered(&self, pixel: IVec2, traced: &[Vec2], halved: bool) -> f32 {
        let Some(index) = self.index(pixel) else {
            return 1.0;
        };
        let depth = self.depths[index];
        if depth <= 0.0 {
            return 1.0;
        }
        let scale = if halved { 2 } else { 1 };
        let size = (self.size.as_ivec2() + scale - 1) / scale;
        let middle = pixel / scale;
        let rest = (pixel - middle * scale).as_vec2() / scale as f32;
        let place = self.place(pixel, depth);
        let normal = self.normals[index];
        // Pixels of the traced picture.
        let unit = self.footprint(depth) * scale as f32;
        let (mut sum, mut weights) = (0.0, 0.0);
        let (mut best, mut nearest) = (1.0, f32::MAX);
        for y in -2..=2 {
            for x in -2..=2 {
                let at = middle + IVec2::new(x, y);
                if at.cmplt(IVec2::ZERO).any() || at.cmpge(size).any() {
                    continue;
                }
                let found = traced[(at.y * size.x + at.x) as usize];
                if found.y <= 0.0 {
                    continue;
                }
                let other = self.place(at * scale, found.y);
                let off = normal.dot(other - place).abs() / unit;
                if off < nearest {
                    (best, nearest) = (found.x, off);
                }
                let weight = share(x as f32 - rest.x)
                    * share(y as f32 - rest.y)
                    * (1.0 - 0.5 * off).max(0.0);
                sum += weight * found.x;
                weights += weight;
            }
        }
        // None in its plane: the one that is the nearest to it.
        if weights < 1e-3 { best } else { sum / weights }
    }

    /// Both passes: the share of the light from everywhere that reaches each pixel, rows from the top.
    #[must_use]
    pub fn shares(&self, settings: &Settings, halved: bool) -> Vec<f32> {
        let scale = if halved { 2 } else { 1 };
        let size = self.size.as_ivec2();
        let cells = (size + scale - 1) / scale;
        let all =
            |size: IVec2| (0..size.y).flat_map(move |y| (0..size.x).map(move |x| IVec2::new(x, y)));
        let traced: Vec<Vec2> = all(cells)
            .map(|cell| {
                let pixel = cell * scale;
                let depth = self.index(pixel).map_or(0.0, |index| self.depths[index]);
                Vec2::new(self.visible(pixel, cell, settings), depth)
            })
            .collect();
        all(size)
            .map(|pixel| self.filtered(pixel, &traced, halved))
            .collect()
    }
}
