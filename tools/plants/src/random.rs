//! Random numbers of one seed, in order.

use glam::Vec3;

/// A sequence: PCG of a counter.
pub struct Random(u32);

impl Random {
    /// The sequence of a seed.
    #[must_use]
    pub fn new(seed: u32) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9))
    }

    fn word(&mut self) -> u32 {
        self.0 = self.0.wrapping_add(1);
        let state = self.0.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
        let mixed = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
        (mixed >> 22) ^ mixed
    }

    /// In [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.word() >> 8) as f32 / 16_777_216.0
    }

    /// In [least, most).
    pub fn within(&mut self, least: f32, most: f32) -> f32 {
        least + (most - least) * self.unit()
    }

    /// In the unit ball.
    pub fn in_ball(&mut self) -> Vec3 {
        loop {
            let [x, y, z] = [(); 3].map(|()| self.within(-1.0, 1.0));
            let point = Vec3::new(x, y, z);
            if point.length_squared() <= 1.0 {
                return point;
            }
        }
    }

    /// On the unit sphere.
    pub fn direction(&mut self) -> Vec3 {
        loop {
            let point = self.in_ball();
            if point.length_squared() > 0.01 {
                return point.normalize();
            }
        }
    }
}
