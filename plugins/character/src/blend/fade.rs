//! Cross-fades that may be turned round at any moment.
//!
//! A fade goes from *whatever is shown now* to a target, and what is shown now may be a fade that is under
//! way: it runs on beneath the new one. With S rising from 0 to 1 the weights are
//! `(1 − S) · (weights beneath) + S · (target)`: never negative, of sum 1, and as smooth as S, whose first
//! and second derivatives are 0 at both ends. Nothing is reset when a fade is turned round, so no joint
//! jumps or jerks.

/// A cross-fade between targets, such as clips or states.
#[derive(Clone, Debug, PartialEq)]
pub struct Fade<T> {
    base: T,
    steps: Vec<Step<T>>,
}

/// A fade to `target`, over all that is beneath.
#[derive(Clone, Debug, PartialEq)]
struct Step<T> {
    target: T,
    /// Seconds since its begin.
    elapsed: f32,
    /// Seconds until it is over.
    duration: f32,
}

/// What lies beneath and weighs less than this is let go: 1e-5 of a metre-long difference is 10 µm.
const LEAST: f32 = 1e-5;

/// 6 x⁵ − 15 x⁴ + 10 x³: from 0 to 1 with no speed and no acceleration at both ends (K. Perlin,
/// *Improving Noise*, 2002).
pub(crate) fn smooth(x: f32) -> f32 {
    let x = if x > 0.0 { x.min(1.0) } else { 0.0 };
    x * x * x * (x * (x * 6.0 - 15.0) + 10.0)
}

impl<T: Copy + PartialEq> Fade<T> {
    /// All weight on `start`.
    #[must_use]
    pub const fn new(start: T) -> Self {
        Self {
            base: start,
            steps: Vec::new(),
        }
    }

    /// Where the last fade leads.
    #[must_use]
    pub fn target(&self) -> T {
        self.steps.last().map_or(self.base, |step| step.target)
    }

    /// Begins a fade to `target` that takes `duration` seconds; nothing if it leads there already. A
    /// duration that is not positive means at once.
    pub fn go(&mut self, target: T, duration: f32) {
        if target == self.target() {
            return;
        }
        if duration > 0.0 {
            self.steps.push(Step {
                target,
                elapsed: 0.0,
                duration,
            });
        } else {
            *self = Self::new(target);
        }
    }

    /// Goes on by `dt` seconds; what is negative or no number counts as 0.
    pub fn advance(&mut self, dt: f32) {
        let dt = if dt > 0.0 { dt } else { 0.0 };
        let mut left = 1.0;
        let mut covered = None;
        for (index, step) in self.steps.iter_mut().enumerate().rev() {
            step.elapsed += dt;
            left *= 1.0 - smooth(step.elapsed / step.duration);
            if left < LEAST && covered.is_none() {
                covered = Some(index);
            }
        }
        // All beneath step `index` is hidden by it and those above. Their weights stay as they are, and
        // what is let go was less than LEAST.
        if let Some(index) = covered {
            self.base = self.steps[index].target;
            self.steps.drain(..=index);
        }
    }

    /// Calls `each` with every target that has a weight, the newest first. Weights sum to 1. A target may
    /// come more than once.
    pub fn weights(&self, mut each: impl FnMut(T, f32)) {
        let mut left = 1.0;
        for step in self.steps.iter().rev() {
            let weight = smooth(step.elapsed / step.duration);
            if weight > 0.0 {
                each(step.target, left * weight);
            }
            left *= 1.0 - weight;
        }
        if left > 0.0 {
            each(self.base, left);
        }
    }

    /// The weight of one target.
    #[must_use]
    pub fn weight(&self, of: T) -> f32 {
        let mut sum = 0.0;
        self.weights(|target, weight| {
            if target == of {
                sum += weight;
            }
        });
        sum
    }

    /// Whether only the target has weight.
    #[must_use]
    pub fn is_over(&self) -> bool {
        self.steps.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn weights(fade: &Fade<char>) -> [f32; 3] {
        ['a', 'b', 'c'].map(|target| fade.weight(target))
    }

    #[test]
    fn weights_sum_to_one_whatever_happens() {
        let mut fade = Fade::new('a');
        let plan = [
            ('b', 0.3),
            ('a', 0.2),
            ('c', 0.5),
            ('b', 0.1),
            ('c', 0.4),
            ('a', 1.0),
        ];
        let mut before = weights(&fade);
        let mut most = 0.0_f32;
        for frame in 0..1200 {
            if frame % 97 == 0 {
                let (target, duration) = plan[(frame / 97) % plan.len()];
                fade.go(target, duration);
            }
            fade.advance(1.0 / 1000.0);
            let now = weights(&fade);
            // A product of a few factors, each rounded.
            assert!((now.iter().sum::<f32>() - 1.0).abs() < 1e-6, "{now:?}");
            assert!(now.iter().all(|weight| (0.0..=1.0).contains(weight)));
            for (now, before) in now.iter().zip(before) {
                most = most.max((now - before).abs());
            }
            before = now;
        }
        // The steepest slope of `smooth` is 15/8; the shortest fade takes 0.1 s, and two of them overlap
        // at most with all of it.
        assert!(most < 1.875 / 100.0 * 1.5, "{most}");
    }

    #[test]
    fn a_fade_that_is_over_is_forgotten() {
        let mut fade = Fade::new('a');
        fade.go('b', 0.2);
        assert_eq!(
            (fade.weight('a'), fade.target(), fade.is_over()),
            (1.0, 'b', false)
        );
        fade.advance(0.1);
        assert_eq!(fade.weight('b'), 0.5);
        fade.go('b', 5.0);
        fade.advance(0.1);
        assert!(fade.is_over() && fade.weight('b') == 1.0);
        fade.go('c', 0.0);
        assert!(fade.is_over() && fade.target() == 'c');
        fade.advance(f32::NAN);
        assert_eq!(fade.weight('c'), 1.0);
    }

    #[test]
    fn turning_round_every_frame_does_not_pile_up() {
        let mut fade = Fade::new('a');
        for frame in 0..1000 {
            fade.go(if frame % 2 == 0 { 'b' } else { 'a' }, 0.25);
            fade.advance(1.0 / 60.0);
        }
        // Those of the last quarter of a second.
        assert!(fade.steps.len() <= 16, "{}", fade.steps.len());
    }
}
