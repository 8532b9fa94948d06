//! Eyes close to the ground, and how far what is drawn about them is off.
//!
//! **What is promised there.** A place counts if the drawn or the true surface is seen at it. Where the other one lies
//! nearer than the near plane, or behind the eye, its place in the picture is none; what counts is the part of the way
//! between them that lies beyond the near plane, which is all that a picture can show. By the same formula as if a depth
//! below that of the near plane were seen, it would be any number of pixels.

use bevy::math::{DVec2, DVec3};
use dolomite_terrain::Terrain;

use super::grounds::{Camera, Random};

/// Metres about the eye in which it is looked at.
const REACH: f64 = 12.0;
/// Tolerance, pixels of a picture 180 pixels high.
pub const TOLERANCE: f32 = 12.0;

/// Height of the true surface.
pub fn height(terrain: &Terrain, xz: DVec2) -> f64 {
    let sea = terrain.sea_level().map_or(f64::NEG_INFINITY, f64::from);
    terrain.sample_f64(xz).height.max(sea)
}

/// From 0.3 to 3 m above a place, looking any way.
pub fn eye_at(terrain: &Terrain, xz: DVec2, random: &mut Random) -> Camera {
    let above = 0.3 + 2.7 * random.unit() * random.unit();
    let yaw = random.unit() * std::f64::consts::TAU;
    let pitch = (random.unit() - 0.5) * 2.8;
    let near = [0.01, 0.1, 0.5, 1.5][(random.unit() * 4.0) as usize & 3];
    Camera {
        near,
        ..Camera::at(terrain, xz, above, yaw, pitch)
    }
}

/// What was found about the eyes.
#[derive(Debug, Default)]
pub struct Found {
    /// Largest error over what is said to be held.
    pub largest: f64,
    /// Pictures.
    pub views: usize,
    /// Places in them.
    pub places: usize,
    /// Of which so many err by more than is held.
    pub above: usize,
    /// Places that are seen where nothing is drawn.
    pub holes: usize,
}

impl Found {
    /// Looks at places about the eye: at `drawn` triangles, whose errors are said to be `limit` pixels at most.
    pub fn look(
        &mut self,
        terrain: &Terrain,
        drawn: &[[DVec3; 3]],
        limit: f64,
        camera: &Camera,
        random: &mut Random,
    ) {
        let flat = |at: DVec3| DVec2::new(at.x, at.z);
        let eye = flat(camera.eye);
        let near: Vec<_> = drawn
            .iter()
            .filter(|&&[a, b, c]| {
                let (low, high) = (flat(a.min(b).min(c)), flat(a.max(b).max(c)));
                low.cmplt(eye + REACH).all() && high.cmpgt(eye - REACH).all()
            })
            .collect();
        self.views += 1;
        for _ in 0..500 {
            let turn = DVec2::from_angle(random.unit() * std::f64::consts::TAU);
            let share = random.unit();
            let at = eye + turn * REACH * (0.02 + 0.98 * share * share * share);
            let found = near.iter().find_map(|&&[a, b, c]| {
                let area = |a: DVec2, b: DVec2, c: DVec2| (b - a).perp_dot(c - a);
                let [p, q, r] = [a, b, c].map(flat);
                let weights = [area(at, q, r), area(p, at, r), area(p, q, at)];
                let [u, v, w] = weights.map(|weight| weight / area(p, q, r));
                // On a side both triangles are the same.
                let inside = u.min(v).min(w) >= -1e-9;
                inside.then_some(u * a.y + v * b.y + w * c.y)
            });
            let truth = height(terrain, at);
            let place = |y: f64| DVec3::new(at.x, y, at.y);
            let Some(drawn) = found else {
                let extent = terrain.extent();
                let inside = at.cmpgt(extent.min).all() && at.cmplt(extent.max).all();
                self.holes += usize::from(inside && camera.sees(place(truth)));
                continue;
            };
            if let Some(pixels) = camera.pixels(place(truth), place(drawn)) {
                self.places += 1;
                self.above += usize::from(pixels > limit);
                self.largest = self.largest.max(pixels / limit);
            }
        }
    }
}
