//! The permutation of the permutation preset: 256 numbers shuffled by a seeded Mersenne Twister.

use rand_mt::Mt;

/// 0..=255 in an order that only depends on the seed: MT19937 (M. Matsumoto, T. Nishimura, 1998)
/// initialised by the array [seed], then the shuffle of R. Durstenfeld (1964) from the top: for
/// i = 255 down to 1 swap i with a number below i + 1. Such a number is the top bits of a word,
/// as many as i + 1 has, drawn again while too large; so it is fair. This is what Python's
/// `random.Random(seed).shuffle` does, and seed 1 gives the classic scene of the literature's
/// comparisons.
#[must_use]
pub(crate) fn permutation(seed: u32) -> [u8; 256] {
    let mut words = Mt::new_with_key([seed]);
    let mut below = |n: u32| loop {
        // n ≤ 256 has at most 9 bits.
        let number = words.next_u32() >> n.leading_zeros();
        if number < n {
            return number as usize;
        }
    };
    let mut table: [u8; 256] = core::array::from_fn(|i| i as u8);
    for i in (1..256_usize).rev() {
        table.swap(i, below(i as u32 + 1));
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_a_permutation_that_depends_on_the_seed() {
        let (a, b) = (permutation(1), permutation(2));
        for table in [a, b] {
            let mut seen = [false; 256];
            table.iter().for_each(|&p| seen[usize::from(p)] = true);
            assert!(seen.iter().all(|&s| s));
        }
        assert_ne!(a, b);
        assert_eq!(a, permutation(1));
    }

    #[test]
    fn seed_1_is_known() {
        // list(range(256)) after random.Random(1).shuffle, CPython 3.
        let table = permutation(1);
        assert_eq!(table[..8], [233, 254, 66, 183, 15, 211, 234, 222]);
        assert_eq!(table[250..], [16, 195, 205, 216, 145, 68]);
    }

    #[test]
    fn the_twister_is_mt19937() {
        // The 10000th output of std::mt19937 with its default seed, from the C++ standard
        // ([rand.predef]).
        let mut words = Mt::new(5489);
        let last = (0..10_000).map(|_| words.next_u32()).last();
        assert_eq!(last, Some(4_123_659_995));
    }
}
