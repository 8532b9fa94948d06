//! What every library is asked to do.

use dolomite_character::clip::oracle::Transform64;
use std::time::{Duration, Instant};

/// A clip at a moment.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Input {
    /// Number in the rig.
    pub clip: usize,
    /// Seconds.
    pub time: f32,
    /// Of all weights' sum.
    pub weight: f32,
}

/// A library that samples and blends clips.
pub trait Method {
    /// With its version.
    fn name(&self) -> &'static str;
    /// Local transforms of one blend, its inputs in this order. Not timed.
    fn blend(&mut self, inputs: &[Input]) -> Vec<Transform64>;
    /// Makes a crowd: for each figure its three inputs.
    fn crowd(&mut self, figures: &[[Input; 3]]);
    /// One frame: every figure's clips go on by `dt` seconds, are sampled and blended, and, if `model`,
    /// become matrices in the model's frame. `false`: it has no such matrices.
    fn frame(&mut self, dt: f32, model: bool) -> bool;
    /// Bytes of all clips, if it says so.
    fn bytes(&self) -> Option<usize>;
}

/// The processor time that this process has used, all its threads together: what "one core" means for a
/// library that spreads its work. From Linux's `/proc`; wall time elsewhere, which is the same where one
/// thread works.
pub fn processor_time(since: Instant) -> Duration {
    let threads = std::fs::read_dir("/proc/self/task")
        .into_iter()
        .flatten()
        .flatten();
    let times = threads.filter_map(|thread| {
        let text = std::fs::read_to_string(thread.path().join("schedstat")).ok()?;
        text.split_whitespace().next()?.parse::<u64>().ok()
    });
    match times.fold(None, |sum: Option<u64>, time| Some(sum.unwrap_or(0) + time)) {
        Some(nanoseconds) => Duration::from_nanos(nanoseconds),
        None => since.elapsed(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_takes_processor_time() {
        let start = Instant::now();
        let before = processor_time(start);
        // The kernel brings the number up to date at every tick of its clock, and others may work too.
        while processor_time(start) - before < Duration::from_millis(20) {
            assert!(
                start.elapsed() < Duration::from_secs(20),
                "no time is counted"
            );
            std::hint::spin_loop();
        }
        // It is no more than all threads of this process can have had.
        let threads = std::thread::available_parallelism().map_or(1, |count| count.get() as u32);
        assert!(
            processor_time(start) - before <= start.elapsed() * threads + Duration::from_millis(40)
        );
    }
}
