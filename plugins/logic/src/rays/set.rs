//! Several answers as one.

use super::answer::{Rays, Stop};
use bevy::math::Vec3;
use std::sync::Arc;

/// Several that stop ways: ground and blocks and meshes. At most 256.
#[derive(Clone, Default)]
pub struct RaySet(pub Vec<Arc<dyn Rays>>);

/// Where the number of a member stands in a blocker.
const MEMBER: u32 = 56;

impl Rays for RaySet {
    fn cast(&self, from: Vec3, to: Vec3) -> Option<Stop> {
        let mut first: Option<Stop> = None;
        for (number, rays) in self.0.iter().enumerate().take(256) {
            if let Some(stop) = rays.cast(from, to)
                && first.is_none_or(|first| stop.time < first.time)
            {
                first = Some(Stop {
                    time: stop.time,
                    blocker: stop.blocker & ((1 << MEMBER) - 1) | (number as u64) << MEMBER,
                });
            }
        }
        first
    }

    fn hide(&self, from: Vec3, to: &[Vec3], blockers: &mut [Option<u64>]) {
        let mut own = vec![None; to.len()];
        for (number, rays) in self.0.iter().enumerate().take(256) {
            // What is hidden already is left out by a blocker that nobody reads.
            own.clone_from_slice(blockers);
            rays.hide(from, to, &mut own);
            for (blocker, own) in blockers.iter_mut().zip(&own) {
                if blocker.is_none() {
                    *blocker = own.map(|own| own & ((1 << MEMBER) - 1) | (number as u64) << MEMBER);
                }
            }
        }
    }

    fn still_blocks(&self, blocker: u64, from: Vec3, to: Vec3) -> bool {
        let member = self.0.get((blocker >> MEMBER) as usize);
        member.is_some_and(|rays| rays.still_blocks(blocker & ((1 << MEMBER) - 1), from, to))
    }
}

#[cfg(test)]
mod tests {
    use super::super::{BoxRays, GroundRays};
    use super::*;
    use bevy::math::Vec2;

    #[test]
    fn ground_hides_behind_a_ridge_and_a_set_says_which() {
        let ridge = |at: Vec2| 5.0 - (at.x - 20.0).abs();
        let ground: Arc<dyn Rays> = Arc::new(GroundRays::new(ridge, 0.5));
        let wall = BoxRays::new(
            [[Vec3::new(50.0, -9.0, -9.0), Vec3::new(51.0, 9.0, 9.0)]],
            4.0,
        );
        let set = RaySet(vec![ground, Arc::new(wall)]);
        let (eye, low) = (Vec3::new(0.0, 1.0, 0.0), Vec3::new(40.0, 1.0, 0.0));
        let stop = set.cast(eye, low).expect("the ridge is in the way");
        assert!((stop.time - 0.4).abs() < 1e-3, "{stop:?}");
        assert!(set.still_blocks(stop.blocker, eye, low));
        let over = Vec3::new(40.0, 12.0, 0.0);
        assert_eq!(set.cast(eye, over), None);
        assert!(!set.still_blocks(stop.blocker, eye, over));
        let stop = set.cast(over, Vec3::new(60.0, 0.0, 0.0)).expect("the wall");
        assert_eq!(stop.blocker >> MEMBER, 1);
        assert_eq!(set.cast(Vec3::NAN, low), None);
        assert_eq!(set.cast(eye, Vec3::INFINITY), None);
    }
}
