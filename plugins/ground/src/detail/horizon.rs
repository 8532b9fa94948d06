//! How a view looks for ground that other ground hides: what `shaders/src/detail/horizon.wgsl` and the passes
//! `draw_horizon`, `close_horizon` and `stand` are told.
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
//! **Who writes.** The cells of every block that is drawn, as far as they are drawn themselves or by their quarters: the
//! drawn ground in one is nowhere below its lowest height, so it hides what a flat square of that height would hide
//! (`square.wgsl`). In u and q = 1/x a square has straight sides, and s of a flat square is its height times q: over a
//! column the least s of the far side (of squares below the eye) or the near one (above) is at one of the column's
//! borders. Small cells are narrower than a column and write nothing; the cells around them do. A column that the
//! border of two cells crosses would stay empty: so a cell and the next one to the east, and to the south, are
//! drawn once more as one rectangle of the lower height of both.
//!
//! **Who is hidden.** A triangle whose greatest s, which is one of its corners', lies below what all the
//! columns hold that it touches, in the layer before its nearest corner; and a block of which nothing is higher than a
//! flat square that is hidden.
//!
//! **Where it holds.** The first crossing of a ray is from above, so that its triangle faces the eye, if the
//! eye and the whole part of the picture nearer than the near plane are above the drawn ground: cells near
//! the eye that reach as high make it blind, and then nothing is hidden. So does an eye beyond the ground's
//! border, which may look below it. Both
//! sides keep a distance of a quarter pixel in all directions: a corner may be drawn off its place by a tenth
//! ([`super::cull`]).

use bevy::math::{DVec2, DVec3};
use bytemuck::{Pod, Zeroable};

use super::cull::CullView;
use super::ground::DetailGround;
use super::view::DetailView;

/// Columns over the width of the picture.
pub const COLUMNS: usize = 512;
/// Layers of depth.
pub const LAYERS: usize = 96;
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

impl HorizonView {
    /// Of a view that sees ground through a picture; `None` where nothing is looked for: parallel rays, a
    /// camera that looks down so steeply that the map would be wider than it is useful, an eye that is not
    /// over the ground.
    #[must_use]
    pub fn new(
        ground: &DetailGround,
        view: &DetailView,
        picture: &CullView,
        anchor_height: f32,
    ) -> Option<Self> {
        if view.orthographic == 1.0 {
            return None;
        }
        let [x, y, z] = view.eye.map(f64::from);
        let eye = DVec3::new(x, y - f64::from(anchor_height), z);
        let extent = ground.terrain().extent();
        let place = view.anchor().as_dvec2() + DVec2::new(x, z);
        let [fx, _, fz] = view.forward.map(f64::from);
        let ahead = DVec2::new(fx, fz).try_normalize()?;
        let world_from_clip = picture.clip.as_dmat4().inverse();
        let (mut reach, mut nearest, mut near_reach) = (0.0_f64, 0.0_f64, 0.0_f64);
        for corner in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
            let at = |z: f64| world_from_clip.project_point3(DVec3::new(corner[0], corner[1], z));
            // Depth of clip space is reversed: 1 is the near plane.
            let near = at(1.0);
            let along = at(0.5) - near;
            let along = DVec2::new(along.x, along.z);
            let (forward, side) = (ahead.dot(along), ahead.perp_dot(along));
            if !(forward > 0.0 && side.abs() <= GREATEST_REACH * forward) {
                return None;
            }
            reach = reach.max(side.abs() / forward);
            let near = near - eye;
            nearest = nearest.max(ahead.dot(DVec2::new(near.x, near.z)));
            near_reach = near_reach.max(near.length());
        }
        let rounding = f64::from(f32::EPSILON) * eye.abs().max_element();
        nearest = nearest.max(rounding * f64::from(view.scale) / ROUNDED_PIXELS);
        let inside = |at: DVec2| {
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
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::detail::Lens;
    use bevy::math::{DMat4, DQuat, EulerRot, UVec2, Vec2};
    use dolomite_terrain::{GroundRect, Terrain, TerrainData};

    const CENTRE: DVec2 = DVec2::new(-7e4, 5e4);
    const ANCHOR_HEIGHT: f32 = 16.0;

    fn look(eye: DVec3, pitch: f64, parallel: bool) -> Option<HorizonView> {
        let terrain = Terrain::new(TerrainData {
            extent: GroundRect::square(CENTRE, 2048.0),
            layers: Vec::new(),
            base: 0.0,
            sea_level: None,
        });
        let ground = DetailGround::new(terrain.expect("valid"), 0.5);
        let turn = DQuat::from_euler(EulerRot::YXZ, 0.3, pitch, 0.0);
        let tangent = f64::from(bevy::math::ops::tan(0.5));
        let lens = Lens::Perspective(tangent);
        let mut view = DetailView::new(eye, turn, lens, UVec2::new(320, 180), 0.1);
        let anchor = view.anchor().as_dvec2();
        let at = eye - DVec3::new(anchor.x, ANCHOR_HEIGHT.into(), anchor.y);
        let clip = DMat4::perspective_infinite_reverse_rh(1.0, 16.0 / 9.0, 0.1)
            * DMat4::from_rotation_translation(turn, at).inverse();
        let picture = CullView {
            clip: clip.as_mat4(),
            half_size: Vec2::new(160.0, 90.0),
            one_sided: true,
        };
        view.orthographic = f32::from(u8::from(parallel));
        HorizonView::new(&ground, &view, &picture, ANCHOR_HEIGHT)
    }

    fn over(xz: DVec2) -> DVec3 {
        DVec3::new(xz.x, 20.0, xz.y)
    }

    #[test]
    fn a_level_view_over_the_ground_is_told_where_it_looks() {
        let seen = look(over(CENTRE), -0.1, false).expect("level");
        assert_eq!(seen.eye[1], 20.0 - ANCHOR_HEIGHT);
        // A corner of the picture is farther to the side than its middle, by what the view looks down.
        let side = bevy::math::ops::tan(0.5) * 16.0 / 9.0;
        assert!(seen.reach > side && seen.reach < 1.2 * side, "{seen:?}");
        let ahead = [-bevy::math::ops::sin(0.3), -bevy::math::ops::cos(0.3)];
        let off = Vec2::from(seen.ahead).distance(Vec2::from(ahead));
        assert!(off < 1e-6, "{seen:?}");
        assert!(seen.nearest >= 0.09 && seen.near_reach < 0.15, "{seen:?}");
    }

    #[test]
    fn nothing_is_looked_for_straight_down_beyond_the_border_and_along_parallel_rays() {
        assert_eq!(look(over(CENTRE), -1.5, false), None);
        assert_eq!(
            look(over(CENTRE + DVec2::new(1500.0, 0.0)), -0.1, false),
            None
        );
        assert_eq!(look(over(CENTRE), -0.1, true), None);
        assert_eq!(look(DVec3::NAN, -0.1, false), None);
    }
}
