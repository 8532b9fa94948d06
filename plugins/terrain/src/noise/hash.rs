//! Integer hashing: PCG as a hash function, exact on every processor.
//!
//! Source: M. Jarzynski, M. Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020 (their
//! `pcg`: one step of a 32-bit linear congruential generator, then the RXS-M-XS permutation of
//! M. O'Neill, "PCG", 2014). Two multiplications, all arithmetic modulo 2³².

/// Multiplier of the linear congruential step (Jarzynski & Olano 2020).
pub(crate) const PCG_MULTIPLIER: u32 = 747_796_405;
/// Increment of the linear congruential step (Jarzynski & Olano 2020).
pub(crate) const PCG_INCREMENT: u32 = 2_891_336_453;
/// Multiplier of the output permutation (Jarzynski & Olano 2020).
pub(crate) const PCG_OUTPUT: u32 = 277_803_737;

/// PCG hash of one word. Bijective; no fixed structure visible in any bit.
#[inline]
#[must_use]
pub const fn pcg(word: u32) -> u32 {
    let state = word
        .wrapping_mul(PCG_MULTIPLIER)
        .wrapping_add(PCG_INCREMENT);
    let mixed = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(PCG_OUTPUT);
    (mixed >> 22) ^ mixed
}

/// Hash of a lattice row: z and the octave's seed. The row is hashed once where many columns of
/// it are wanted.
#[inline]
#[must_use]
pub const fn row_hash(z: u32, seed: u32) -> u32 {
    pcg(z.wrapping_add(seed))
}

/// Hash of a lattice point: its column x and its row's hash.
#[inline]
#[must_use]
pub const fn point_hash(x: u32, row: u32) -> u32 {
    pcg(x.wrapping_add(row))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn known_values() {
        // By hand from the definition: state(0) = 2891336453 = 0xAC564B05.
        let state = 0xAC56_4B05_u32;
        let mixed = ((state >> 14) ^ state).wrapping_mul(277_803_737);
        assert_eq!(pcg(0), (mixed >> 22) ^ mixed);
        assert_eq!(pcg(0), 129_708_002);
    }

    #[test]
    fn bits_of_lattice_hashes_are_fair() {
        // 2^16 points: each bit is set 32768 ± 4 × 128 times (a binomial's sigma is 128).
        let mut set = [0_i32; 32];
        for z in 0..256 {
            let row = row_hash(z, 99);
            for x in 0..256 {
                let hash = point_hash(x, row);
                for (bit, count) in set.iter_mut().enumerate() {
                    *count += ((hash >> bit) & 1) as i32;
                }
            }
        }
        for (bit, count) in set.iter().enumerate() {
            assert!((count - 32_768).abs() < 640, "bit {bit}: {count}");
        }
    }
}
