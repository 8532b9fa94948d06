//! Which curves are to have their keys at the same times.
//!
//! Times are four bytes a key, half of what a rotation in 16 bits takes, and are kept once for all curves
//! whose keys stand at the same. Curves that need about as many keys as each other lose little by
//! that; those that need few lose much.

/// A curve as far as this counts.
#[derive(Debug, Clone, Copy)]
pub(super) struct Need {
    /// Keys that it needs; 0 where it is not to be put with others.
    pub(super) keys: usize,
    /// Bytes of a key's value.
    pub(super) width: usize,
    /// Bytes of its keys with times of their own.
    pub(super) alone: usize,
}

/// Groups of at least two curves with the least bytes, where a group needs `more` times the keys of
/// the one in it that needs most. Curves of no group are best alone.
///
/// Groups are neighbours in the order of how many keys they need: the best way to cut that order is found
/// by looking at all ways to cut its beginnings (dynamic programming), in the square of the number of curves.
pub(super) fn groups(curves: &[Need], more: f64) -> Vec<Vec<usize>> {
    let mut order: Vec<usize> = (0..curves.len()).filter(|&n| curves[n].keys > 0).collect();
    order.sort_by_key(|&n| (curves[n].keys, n));
    // The least bytes of the first so many curves, where the last group of these begins, and whether it
    // is one.
    let mut least: Vec<(f64, usize, bool)> = vec![(0.0, 0, false)];
    for end in 1..=order.len() {
        let last = &curves[order[end - 1]];
        let mut best = (least[end - 1].0 + last.alone as f64, end - 1, false);
        let mut width = 4;
        for begin in (0..end).rev() {
            width += curves[order[begin]].width;
            let bytes = least[begin].0 + more * (last.keys * width) as f64;
            if end - begin > 1 && bytes < best.0 {
                best = (bytes, begin, true);
            }
        }
        least.push(best);
    }
    let mut out = Vec::new();
    let mut end = order.len();
    while end > 0 {
        let (_, begin, grouped) = least[end];
        if grouped {
            let mut group = order[begin..end].to_vec();
            group.sort_unstable();
            out.push(group);
        }
        end = begin;
    }
    out.reverse();
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rotation in 16 bits that needs so many keys.
    fn need(keys: usize) -> Need {
        Need {
            keys,
            width: 8,
            alone: keys * 12,
        }
    }

    fn bytes(curves: &[Need], groups: &[Vec<usize>], more: f64) -> f64 {
        let grouped: Vec<usize> = groups.concat();
        let of = |group: &Vec<usize>| {
            let most = group.iter().map(|&n| curves[n].keys).max().unwrap();
            let width: usize = group.iter().map(|&n| curves[n].width).sum();
            more * (most * (4 + width)) as f64
        };
        let alone = (0..curves.len()).filter(|n| !grouped.contains(n));
        let alone: usize = alone.map(|n| curves[n].alone).sum();
        alone as f64 + groups.iter().map(of).sum::<f64>()
    }

    #[test]
    fn curves_alike_share_their_times_and_others_do_not() {
        let curves = [20, 3, 21, 60, 20, 58].map(need);
        assert_eq!(groups(&curves, 1.0), [vec![0, 2, 4], vec![3, 5]]);
    }

    #[test]
    fn no_curve_is_put_with_others_that_may_not() {
        let curves = [
            need(20),
            Need {
                keys: 0,
                ..need(20)
            },
            need(20),
        ];
        assert_eq!(groups(&curves, 1.0), [vec![0, 2]]);
        assert!(
            groups(&curves, 2.0).is_empty(),
            "twice the keys are too many"
        );
    }

    #[test]
    fn no_other_cut_of_the_order_is_smaller() {
        let curves = [9, 4, 30, 11, 12, 29, 40, 8].map(need);
        for more in [0.8, 1.0, 1.1, 1.3] {
            let found = bytes(&curves, &groups(&curves, more), more);
            let mut order: Vec<usize> = (0..curves.len()).collect();
            order.sort_by_key(|&n| curves[n].keys);
            // Each bit of `cuts` cuts between two neighbours; pieces of one stay alone.
            for cuts in 0..1_u32 << (curves.len() - 1) {
                let mut pieces = vec![vec![order[0]]];
                for (i, &n) in order.iter().enumerate().skip(1) {
                    match cuts >> (i - 1) & 1 {
                        1 => pieces.push(vec![n]),
                        _ => pieces.last_mut().unwrap().push(n),
                    }
                }
                pieces.retain(|piece| piece.len() > 1);
                assert!(found <= bytes(&curves, &pieces, more) + 1e-9, "{pieces:?}");
            }
        }
    }
}
