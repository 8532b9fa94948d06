//! A checksum of 64 bits against damage, not against intent: FNV-1a (G. Fowler, L. C. Noll, K.-P. Vo) over words of eight bytes,
//! with a rotation so that high bits come down.

const PRIME: u64 = 0x0000_0100_0000_01b3;
const BEGIN: u64 = 0xcbf2_9ce4_8422_2325;

/// A sum that goes on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sum(u64);

impl Default for Sum {
    fn default() -> Self {
        Self(BEGIN)
    }
}

impl Sum {
    pub fn add(mut self, bytes: &[u8]) -> Self {
        let (words, rest) = bytes.as_chunks::<8>();
        for word in words {
            self.0 = (self.0 ^ u64::from_le_bytes(*word))
                .wrapping_mul(PRIME)
                .rotate_left(29);
        }
        for byte in rest {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(PRIME);
        }
        // So that zeros at the end count.
        self.0 = (self.0 ^ bytes.len() as u64).wrapping_mul(PRIME);
        self
    }

    pub fn done(self) -> u64 {
        let mixed = (self.0 ^ (self.0 >> 32)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        mixed ^ (mixed >> 29)
    }
}

pub(super) fn sum(bytes: &[u8]) -> u64 {
    Sum::default().add(bytes).done()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_changed_bit_is_seen() {
        let bytes: Vec<u8> = (0..77_u8).map(|k| k.wrapping_mul(37)).collect();
        let whole = sum(&bytes);
        for at in 0..bytes.len() {
            for bit in 0..8 {
                let mut changed = bytes.clone();
                changed[at] ^= 1 << bit;
                assert_ne!(sum(&changed), whole, "byte {at}, bit {bit}");
            }
            assert_ne!(sum(&bytes[..at]), whole);
        }
        assert_ne!(sum(&[0; 8]), sum(&[0; 16]));
    }
}
