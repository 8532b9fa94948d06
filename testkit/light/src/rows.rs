//! Rows of an image on all cores, in order.

use std::sync::atomic::{AtomicUsize, Ordering};

/// Computes `rows` rows with `row(y)`, on all cores, and puts them one after the other. The values do not depend on how
/// many cores there are.
pub fn in_parallel<T: Send>(rows: u32, row: impl Fn(u32) -> Vec<T> + Sync) -> Vec<T> {
    let rows = rows as usize;
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let next = AtomicUsize::new(0);
    let mut done: Vec<(usize, Vec<T>)> = std::thread::scope(|scope| {
        let worker = || {
            let mut own = Vec::new();
            loop {
                let y = next.fetch_add(1, Ordering::Relaxed);
                if y >= rows {
                    return own;
                }
                own.push((y, row(y as u32)));
            }
        };
        let workers: Vec<_> = (0..cores.min(rows)).map(|_| scope.spawn(worker)).collect();
        let joined = workers.into_iter().flat_map(|worker| match worker.join() {
            Ok(own) => own,
            Err(panic) => std::panic::resume_unwind(panic),
        });
        joined.collect()
    });
    done.sort_by_key(|(y, _)| *y);
    done.into_iter().flat_map(|(_, values)| values).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_come_in_order() {
        let all = in_parallel(300, |y| vec![2 * y, 2 * y + 1]);
        assert_eq!(all, (0..600).collect::<Vec<_>>());
        assert!(in_parallel(0, |y| vec![y]).is_empty());
    }
}
