//! Work on all cores, with results in order; the time that all of them took.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Runs `work` on every item, on all cores; results in the order of the items.
pub fn on_all_cores<T: Sync, R: Send>(items: &[T], work: impl Fn(&T) -> R + Sync) -> Vec<R> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let next = AtomicUsize::new(0);
    let mut results: Vec<(usize, R)> = std::thread::scope(|scope| {
        let worker = || {
            let mut own = Vec::new();
            loop {
                let k = next.fetch_add(1, Ordering::Relaxed);
                let Some(item) = items.get(k) else {
                    return own;
                };
                own.push((k, work(item)));
            }
        };
        let workers: Vec<_> = (0..cores).map(|_| scope.spawn(worker)).collect();
        workers
            .into_iter()
            .flat_map(|worker| match worker.join() {
                Ok(own) => own,
                Err(panic) => std::panic::resume_unwind(panic),
            })
            .collect()
    });
    results.sort_by_key(|(k, _)| *k);
    results.into_iter().map(|(_, result)| result).collect()
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

    #[test]
    fn results_come_in_the_order_of_the_items() {
        let items: Vec<usize> = (0..1000).collect();
        assert_eq!(on_all_cores(&items, |k| *k), items);
    }
}
