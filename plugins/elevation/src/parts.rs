//! Work on many samples, in parts that fit a cache, on all cores where that pays.

/// Runs `work` over parts of the samples, each part in cache, on all cores where that pays.
pub(crate) fn in_parts<R: Send>(
    samples: &mut [f32],
    work: impl Fn(&mut [f32]) -> R + Sync,
) -> Vec<R> {
    const PART: usize = 1 << 14;
    let threads = threads(samples.len());
    let share = samples.len().div_ceil(threads).next_multiple_of(PART);
    if threads == 1 {
        return samples.chunks_mut(PART).map(&work).collect();
    }
    std::thread::scope(|scope| {
        let shares: Vec<_> = samples
            .chunks_mut(share)
            .map(|share| {
                let work = &work;
                scope.spawn(move || share.chunks_mut(PART).map(work).collect::<Vec<_>>())
            })
            .collect();
        let shares = shares.into_iter().map(|share| match share.join() {
            Ok(results) => results,
            Err(panic) => std::panic::resume_unwind(panic),
        });
        shares.flatten().collect()
    })
}

/// How many threads so many samples are worth.
pub(crate) fn threads(samples: usize) -> usize {
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZeroUsize::get);
    // A thread costs some 50 us, a million samples a millisecond.
    (samples >> 20).clamp(1, cores.min(16))
}
