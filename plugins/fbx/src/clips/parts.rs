//! Work on consecutive parts of a range, on several threads.

use crate::options::Options;
use std::ops::Range;

/// Poses of nodes that one thread is done with before another would have started, on a busy machine:
/// some milliseconds' work.
const ALONE: usize = 16_384;

/// How many threads work on so many poses of nodes.
pub(crate) fn threads(poses: usize, options: &Options) -> usize {
    match poses < ALONE {
        true => 1,
        false => options.thread_count().min(poses / (ALONE / 4)),
    }
}

/// `work` on consecutive parts of `0..count`, on `threads` threads; results in order, so that they do
/// not depend on how many there are.
pub(crate) fn in_parts<T: Send>(
    count: usize,
    threads: usize,
    work: impl Fn(Range<usize>) -> T + Sync,
) -> Vec<T> {
    let share = count.div_ceil(threads.max(1)).max(1);
    let ranges = (0..count).step_by(share);
    let mut ranges = ranges.map(|at| at..(at + share).min(count));
    std::thread::scope(|scope| {
        let work = &work;
        let own = ranges.next();
        let others: Vec<_> = ranges
            .map(|range| scope.spawn(move || work(range)))
            .collect();
        let own = own.map(work);
        own.into_iter()
            .chain(
                others
                    .into_iter()
                    .map(|t| t.join().expect("nothing in it panics")),
            )
            .collect()
    })
}

#[cfg(test)]
mod tests {
    use super::in_parts;

    #[test]
    fn parts_are_in_order_and_whole() {
        for threads in [0, 1, 3, 64] {
            let parts = in_parts(10, threads, |range| range.collect::<Vec<_>>());
            assert_eq!(parts.concat(), (0..10).collect::<Vec<_>>());
        }
        assert!(in_parts(0, 4, |range| range.len()).is_empty());
    }
}
