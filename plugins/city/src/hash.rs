//! Random numbers by place: the hash of integers, the same for any order and any number of threads.
//!
//! PCG as a hash function (M. Jarzynski, M. Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020); in WGSL
//! `dolomite::terrain::hash`. Arithmetic modulo 2³², exact on every processor.

/// PCG hash of one word; a bijection.
#[inline]
#[must_use]
pub const fn pcg(word: u32) -> u32 {
    let state = word.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let mixed = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (mixed >> 22) ^ mixed
}

/// Hash of a cell of the street grid.
#[inline]
#[must_use]
pub const fn cell_hash(seed: u32, [x, z]: [i32; 2]) -> u32 {
    pcg(pcg(pcg(seed).wrapping_add(z.cast_unsigned())).wrapping_add(x.cast_unsigned()))
}

/// One of the numbers that belong to a hash: different `salt`s give independent ones.
#[inline]
#[must_use]
pub const fn salted(hash: u32, salt: u32) -> u32 {
    pcg(hash ^ pcg(salt))
}

/// In [0, 1): the highest 24 bits, each multiple of 2⁻²⁴ as probable as any other.
#[inline]
#[must_use]
pub const fn unit(hash: u32) -> f32 {
    (hash >> 8) as f32 * (1.0 / 16_777_216.0)
}

/// FNV-1a (64 bits) over bytes, going on from `state`; begin with [`FNV`].
#[must_use]
pub fn fnv(state: u64, bytes: &[u8]) -> u64 {
    bytes.iter().fold(state, |state, byte| {
        (state ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    })
}

/// Where FNV-1a begins.
pub const FNV: u64 = 0xcbf2_9ce4_8422_2325;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbours_and_seeds_differ() {
        let mut seen = std::collections::HashSet::new();
        for seed in 0..4 {
            for x in -32..32 {
                for z in -32..32 {
                    seen.insert(cell_hash(seed, [x, z]));
                }
            }
        }
        // 16 384 of 2³² values: 0.03 collisions are expected.
        assert!(seen.len() > 16_380, "{}", seen.len());
    }

    #[test]
    fn units_are_even() {
        let mean: f64 = (0..65_536).map(|k| f64::from(unit(pcg(k)))).sum::<f64>() / 65_536.0;
        // Four standard deviations of the mean of 2¹⁶ even numbers: 4 · 0.289 / 256.
        assert!((mean - 0.5).abs() < 0.0046, "{mean}");
        assert_eq!((unit(0), unit(u32::MAX)), (0.0, 1.0 - 1.0 / 16_777_216.0));
    }
}
