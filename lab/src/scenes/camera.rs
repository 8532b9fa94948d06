//! Pinhole and orthographic cameras in f64, and distances on their screens.
//!
//! Conventions: +Y up, −Z forward, metres, radians, right-handed. A camera is turned by roll about
//! its own Z, then pitch about X, then yaw about Y; yaw 0 looks north (−Z) and grows to the left,
//! pitch grows upwards. `w` is the depth of a point before the camera, metres. Pixels are counted
//! from the middle of the screen, x to the right, y upwards, and not rounded.

use bevy::math::{DMat3, DVec2, DVec3, UVec2};

/// Where it stands, where it looks, and what it looks through.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Place of the eye, metres.
    pub eye: DVec3,
    /// About +Y, radians.
    pub yaw: f64,
    /// Upwards, radians.
    pub pitch: f64,
    /// About the view's axis, radians.
    pub roll: f64,
    /// Angle from the lower to the upper edge of the screen, radians, between 0 and π.
    pub fov_y: f64,
    /// Pixels across and down.
    pub size: UVec2,
    /// Nothing nearer than this depth is drawn, metres, above 0.
    pub near: f64,
    /// Visible height of an orthographic camera, metres; `None` is a pinhole.
    pub orthographic: Option<f64>,
}

impl Camera {
    /// The camera's axes and scale, worked out once.
    #[must_use]
    pub fn view(&self) -> View {
        let turn = DMat3::from_rotation_y(self.yaw)
            * DMat3::from_rotation_x(self.pitch)
            * DMat3::from_rotation_z(self.roll);
        let height = f64::from(self.size.y);
        View {
            eye: self.eye,
            right: turn.x_axis,
            up: turn.y_axis,
            forward: -turn.z_axis,
            scale: match self.orthographic {
                Some(metres) => height / metres,
                None => height / 2.0 / (self.fov_y / 2.0).tan(),
            },
            half: self.size.as_dvec2() / 2.0,
            near: self.near,
            visible_height: self.orthographic,
        }
    }

    /// See [`View::pixels`].
    #[must_use]
    pub fn pixels(&self, a: DVec3, b: DVec3) -> Option<f64> {
        self.view().pixels(a, b)
    }

    /// See [`View::sees`].
    #[must_use]
    pub fn sees(&self, point: DVec3) -> bool {
        self.view().sees(point)
    }
}

/// A [`Camera`], ready to project.
#[derive(Debug, Clone, Copy)]
pub struct View {
    /// Place of the eye, metres.
    pub eye: DVec3,
    /// Unit vector to the right of the screen.
    pub right: DVec3,
    /// Unit vector to its upper edge.
    pub up: DVec3,
    /// Unit vector into it.
    pub forward: DVec3,
    /// Pixels: of a pinhole for a unit of x/w, of an orthographic camera for a metre.
    pub scale: f64,
    /// Half the screen, pixels.
    pub half: DVec2,
    /// Depth of the near plane, metres.
    pub near: f64,
    /// Visible height, metres, if orthographic.
    pub visible_height: Option<f64>,
}

impl View {
    /// (right, up, depth) of a point, metres.
    #[must_use]
    pub fn to_camera(&self, point: DVec3) -> DVec3 {
        let d = point - self.eye;
        DVec3::new(d.dot(self.right), d.dot(self.up), d.dot(self.forward))
    }

    /// Where the point lies on the screen; `None` before the near plane.
    #[must_use]
    pub fn project(&self, point: DVec3) -> Option<DVec2> {
        let c = self.to_camera(point);
        (c.z >= self.near).then(|| self.on_screen(c))
    }

    fn on_screen(&self, c: DVec3) -> DVec2 {
        match self.visible_height {
            Some(_) => c.truncate() * self.scale,
            None => c.truncate() * (self.scale / c.z),
        }
    }

    /// Pixels between the projections of two points; `None` unless both lie beyond the near plane.
    #[must_use]
    pub fn pixels(&self, a: DVec3, b: DVec3) -> Option<f64> {
        Some(self.project(a)?.distance(self.project(b)?))
    }

    /// The same of the part of the line from `a` to `b` that lies beyond the near plane: a lower
    /// bound of what an observer sees of an error where only one end can be seen. `None` if no part
    /// does.
    #[must_use]
    pub fn pixels_beyond_near(&self, a: DVec3, b: DVec3) -> Option<f64> {
        let (a, b) = (self.to_camera(a), self.to_camera(b));
        let cut = |from: DVec3, to: DVec3| {
            if from.z >= self.near {
                return Some(from);
            }
            if to.z < self.near {
                return None;
            }
            let at = from.lerp(to, (self.near - from.z) / (to.z - from.z));
            Some(at.with_z(self.near))
        };
        let (from, to) = (cut(a, b)?, cut(b, a)?);
        Some(self.on_screen(from).distance(self.on_screen(to)))
    }

    /// Whether the point lies inside the frustum, borders included. What stands before it does not
    /// count.
    #[must_use]
    pub fn sees(&self, point: DVec3) -> bool {
        self.project(point)
            .is_some_and(|at| at.abs().cmple(self.half).all())
    }

    /// No displacement of a point by up to `metres` moves its projection by more pixels than this;
    /// infinite if it may reach the near plane.
    ///
    /// With p = (x, y, w) and a displacement d, w(x + dₓ) − x(w + d_w) = w·dₓ − x·d_w, which is at
    /// most |d|·|p| over both axes, and is divided by w(w − |d|).
    #[must_use]
    pub fn pixels_at_most(&self, point: DVec3, metres: f64) -> f64 {
        let c = self.to_camera(point);
        let nearest = c.z - metres;
        if nearest < self.near {
            return f64::INFINITY;
        }
        match self.visible_height {
            Some(_) => self.scale * metres,
            None => self.scale * metres * c.length() / (c.z * nearest),
        }
    }

    /// Distance that decides about detail, metres: of a pinhole to the eye; of an orthographic
    /// camera always its visible height, because all that it sees has the same scale.
    #[must_use]
    pub fn distance(&self, point: DVec3) -> f64 {
        self.visible_height
            .unwrap_or_else(|| point.distance(self.eye))
    }

    /// Direction and start of the ray through a place of the screen, pixels; a step of 1 along it is
    /// 1 m of depth.
    #[must_use]
    pub fn ray(&self, pixel: DVec2) -> (DVec3, DVec3) {
        let at = pixel / self.scale;
        let aside = self.right * at.x + self.up * at.y;
        match self.visible_height {
            Some(_) => (self.eye + aside, self.forward),
            None => (self.eye, aside + self.forward),
        }
    }

    /// Signed distances of a point to the near plane and the four sides, positive inside. Those to
    /// the sides of a pinhole are scaled by a positive number each.
    fn sides(&self, point: DVec3) -> [f64; 5] {
        let c = self.to_camera(point);
        let reach = match self.visible_height {
            Some(_) => self.half / self.scale,
            None => self.half * (c.z / self.scale),
        };
        [
            c.z - self.near,
            reach.x - c.x,
            reach.x + c.x,
            reach.y - c.y,
            reach.y + c.y,
        ]
    }

    /// Whether the hull of these points may reach into the frustum: false only if all of them lie
    /// beyond one of its planes.
    #[must_use]
    pub fn may_see(&self, points: &[DVec3]) -> bool {
        let mut inside = [false; 5];
        for &point in points {
            for (inside, side) in inside.iter_mut().zip(self.sides(point)) {
                *inside |= side >= 0.0;
            }
        }
        inside.iter().all(|&inside| inside)
    }

    /// [`Self::may_see`] of a box.
    #[must_use]
    pub fn may_see_box(&self, low: DVec3, high: DVec3) -> bool {
        let corner = |k: usize| {
            DVec3::new(
                if k & 1 == 0 { low.x } else { high.x },
                if k & 2 == 0 { low.y } else { high.y },
                if k & 4 == 0 { low.z } else { high.z },
            )
        };
        self.may_see(&[0, 1, 2, 3, 4, 5, 6, 7].map(corner))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        Camera {
            eye: DVec3::new(1.0, 2.0, 3.0),
            yaw: 0.0,
            pitch: 0.0,
            roll: 0.0,
            fov_y: 90.0_f64.to_radians(),
            size: UVec2::new(400, 200),
            near: 0.5,
            orthographic: None,
        }
    }

    #[test]
    fn projection_against_a_case_by_hand() {
        // tan 45° = 1, so that x/w = 1 is 100 pixels. 4 m ahead, 2 m to the right, 1 m up.
        let view = camera().view();
        let at = view.project(DVec3::new(3.0, 3.0, -1.0)).unwrap();
        assert!((at - DVec2::new(50.0, 25.0)).length() < 1e-12);
        let error = view.pixels(DVec3::new(3.0, 3.0, -1.0), DVec3::new(3.0, 3.5, -1.0));
        assert!((error.unwrap() - 12.5).abs() < 1e-12);
        assert_eq!(view.project(DVec3::new(1.0, 2.0, 2.6)), None);
        // Turned left by 90° it looks along −X; a quarter roll puts the world's up to the right.
        let turned = Camera {
            yaw: 90.0_f64.to_radians(),
            roll: 90.0_f64.to_radians(),
            ..camera()
        };
        let at = turned.view().project(DVec3::new(-3.0, 4.0, 3.0)).unwrap();
        assert!((at - DVec2::new(50.0, 0.0)).length() < 1e-12, "{at}");
        let flat = Camera {
            orthographic: Some(20.0),
            ..camera()
        };
        let at = flat.view().project(DVec3::new(3.0, 3.0, -100.0)).unwrap();
        assert!((at - DVec2::new(20.0, 10.0)).length() < 1e-12);
    }

    #[test]
    fn the_frustum_ends_at_the_screen_and_the_near_plane() {
        let view = camera().view();
        let ahead = |x: f64, y: f64, w: f64| DVec3::new(1.0 + x, 2.0 + y, 3.0 - w);
        assert!(view.sees(ahead(19.9, -9.9, 10.0)));
        assert!(!view.sees(ahead(20.1, 0.0, 10.0)));
        assert!(!view.sees(ahead(0.0, 10.1, 10.0)));
        assert!(!view.sees(ahead(0.0, 0.0, 0.4)));
        // A triangle across the whole screen, no corner of which is seen; one to the right of it.
        let wide = [
            ahead(-90.0, -50.0, 10.0),
            ahead(90.0, -50.0, 10.0),
            ahead(0.0, 90.0, 10.0),
        ];
        assert!(view.may_see(&wide));
        assert!(!view.may_see(&wide.map(|p| p + DVec3::X * 120.0)));
        assert!(!view.may_see_box(ahead(-9.0, -9.0, 0.4), ahead(9.0, 9.0, -3.0)));
    }

    #[test]
    fn no_displacement_moves_a_point_further_than_its_bound() {
        let view = camera().view();
        let mut random = dolomite_testkit::random::Random::new(3);
        let mut vector = || {
            DVec3::new(
                random.signed_unit(),
                random.signed_unit(),
                random.signed_unit(),
            )
        };
        let mut closest = 0.0_f64;
        for _ in 0..20_000 {
            let point = view.eye + DVec3::new(0.0, 0.0, -9.0) + vector() * 8.0;
            let step = vector().normalize() * 0.3;
            let bound = view.pixels_at_most(point, 0.3);
            if let Some(moved) = view.pixels(point, point + step) {
                assert!(moved <= bound * (1.0 + 1e-12), "{moved} {bound}");
                closest = closest.max(moved / bound);
            }
        }
        assert!(closest > 0.9, "the bound is loose: {closest}");
    }

    #[test]
    fn rays_run_through_their_pixels_and_lines_are_cut_at_the_near_plane() {
        for orthographic in [None, Some(30.0)] {
            let view = Camera {
                yaw: 0.3,
                pitch: -0.8,
                roll: 2.0,
                orthographic,
                ..camera()
            }
            .view();
            let pixel = DVec2::new(-120.0, 44.0);
            let (from, along) = view.ray(pixel);
            let at = view.project(from + along * 70.0).unwrap();
            assert!((at - pixel).length() < 1e-9);
        }
        let view = camera().view();
        // From 1 m ahead to 1 m behind, both 0.5 m up: seen from depth 1 (50 px) to 0.5 (100 px).
        let (a, b) = (DVec3::new(1.0, 2.5, 2.0), DVec3::new(1.0, 2.5, 4.0));
        assert!((view.pixels_beyond_near(a, b).unwrap() - 50.0).abs() < 1e-9);
        assert_eq!(view.pixels(a, b), None);
    }
}
