//! How the strip between two rows of vertices is stitched. The CPU reference of
//! `shaders/src/stage/ruler.wgsl`.
//!
//! Each half of a row of n segments holds the first ⌊n / 2⌋ vertices of one list: the 32 places of
//! the finest half-edge in the order in which growing levels open them, halving the longest gap from
//! the start (the ruler function; Direct3D 11 functional specification, "Tessellation Pattern").
//! Both rows of a strip are walked through these places together. A vertex that grows out of its
//! neighbour therefore changes no triangle but its own: nothing pops, and the strip depends on its
//! two numbers of segments alone.

/// A step along a strip: which row advances, and where both rows stand before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// Vertex of the outer row.
    pub outer: u32,
    /// Vertex of the inner row.
    pub inner: u32,
    /// Whether the outer row advances: triangle (outer, outer + 1, inner), else
    /// (outer, inner + 1, inner).
    pub advances_outer: bool,
}

/// The places of the half-edge, bit x for place x of 32, that a row of `half` segments a half has
/// beside its first.
///
/// Place 2ᵗ (2q + 1) opens as number 2⁴⁻ᵗ + q: 16, then 8 and 24, then 4, 12, 20, 28, and so on.
#[must_use]
pub const fn places(half: u32) -> u32 {
    if half < 2 {
        return 0;
    }
    let order = half.ilog2();
    let step = 32 >> order;
    // All multiples of the step, and of the odd multiples of its half as many as are open.
    let whole = multiples(step) & !1;
    let finer = if order == 5 {
        0
    } else {
        multiples(step / 2) & !multiples(step)
    };
    let open = (half - (1 << order)) * step;
    whole | (finer & below(open))
}

/// Bits 0, step, 2 step and so on; `step` a power of two up to 32.
const fn multiples(step: u32) -> u32 {
    match step {
        1 => 0xffff_ffff,
        2 => 0x5555_5555,
        4 => 0x1111_1111,
        8 => 0x0101_0101,
        16 => 0x0001_0001,
        _ => 1,
    }
}

/// The bits below bit `x` < 32.
const fn below(x: u32) -> u32 {
    (1 << x) - 1
}

/// Step `t` of the strip between `outer` segments and the middle `inner` − 2 of an inner row that
/// would have `inner` segments if it were as long; 0 ≤ t < outer + inner − 2.
#[must_use]
pub fn transition(outer: u32, inner: u32, t: u32) -> Step {
    let rows = [outer, inner - 2];
    let halves = [outer / 2, inner / 2];
    let half = halves[0] + halves[1] - 1;
    let total = rows[0] + rows[1];
    if t < half {
        let (a, b, advances_outer) = first_half(halves, t);
        Step {
            outer: a,
            inner: b,
            advances_outer,
        }
    } else if t >= total - half {
        let (a, b, advances_outer) = first_half(halves, total - 1 - t);
        let (outer, inner) = (rows[0] - a, rows[1] - b);
        if advances_outer {
            Step {
                outer: outer - 1,
                inner,
                advances_outer,
            }
        } else {
            Step {
                outer,
                inner: inner - 1,
                advances_outer,
            }
        }
    } else {
        // The middle segments of odd rows: the inner one first.
        let (a, b) = (halves[0], halves[1] - 1);
        let inner_first = inner % 2 == 1;
        let second = t > half;
        Step {
            outer: a,
            inner: b + u32::from(second),
            advances_outer: !inner_first || second,
        }
    }
}

/// Step `t` of the first half: both rows before it, and whether the outer one advances.
fn first_half(halves: [u32; 2], t: u32) -> (u32, u32, bool) {
    // The first segment of the outer row has no counterpart in the inner row.
    let lead = halves[0].min(1);
    if t < lead {
        return (0, 0, true);
    }
    let t = t - lead;
    let [outer, inner] = halves.map(places);
    let before = |x: u32| (outer & below(x)).count_ones() + (inner & below(x)).count_ones();
    // The last place that at most t steps come before.
    let mut x = 0;
    for bit in [16, 8, 4, 2, 1] {
        if before(x + bit) <= t {
            x += bit;
        }
    }
    let (a, b) = (
        (outer & below(x)).count_ones(),
        (inner & below(x)).count_ones(),
    );
    let has_inner = (inner >> x) & 1;
    if has_inner == 1 && t == a + b {
        (a + lead, b, false)
    } else {
        (a + lead, b + has_inner, true)
    }
}

/// Step `t` of the strip between two rows of one kind, of m ≥ 2 and m − 2 segments:
/// 0 ≤ t < 2 m − 2. Diagonals point to the middle of the row from both ends.
#[must_use]
pub const fn regular(m: u32, t: u32) -> Step {
    if t == 0 {
        return Step {
            outer: 0,
            inner: 0,
            advances_outer: true,
        };
    }
    if t == 2 * m - 3 {
        return Step {
            outer: m - 1,
            inner: m - 2,
            advances_outer: true,
        };
    }
    let cell = (t - 1) / 2;
    let second = (t - 1) % 2;
    let inner_first = cell < (m - 1) / 2;
    if inner_first {
        Step {
            outer: 1 + cell,
            inner: cell + second,
            advances_outer: second == 1,
        }
    } else {
        Step {
            outer: 1 + cell + second,
            inner: cell,
            advances_outer: second == 0,
        }
    }
}

/// Step `t` of a strip between rows of `outer` and `inner` segments of one length, from end to end:
/// both advance as evenly as they can (Bresenham 1965); 0 ≤ t < outer + inner.
#[must_use]
pub const fn half_strip(outer: u32, inner: u32, t: u32) -> Step {
    let total = outer + inner;
    let at = (t * outer + total / 2) / total;
    let next = ((t + 1) * outer + total / 2) / total;
    Step {
        outer: at,
        inner: t - at,
        advances_outer: next > at,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_open_in_the_order_of_the_ruler() {
        let mut known = 0;
        let mut opened = Vec::new();
        for half in 2..=32 {
            let now = places(half);
            let new = now & !known;
            assert_eq!(new.count_ones(), 1, "half {half}");
            assert_eq!(now & known, known, "half {half} keeps what was open");
            opened.push(new.trailing_zeros());
            known = now;
        }
        assert_eq!(&opened[..7], [16, 8, 24, 4, 12, 20, 28]);
        assert_eq!(opened[7..15].iter().map(|x| x % 4).max(), Some(2));
        assert_eq!(known, !1);
    }

    #[test]
    fn every_strip_is_a_walk_from_end_to_end() {
        for outer in 1..=64 {
            for inner in 2..=64 {
                let (mut a, mut b) = (0, 0);
                for t in 0..outer + inner - 2 {
                    let step = transition(outer, inner, t);
                    assert_eq!((step.outer, step.inner), (a, b), "{outer} {inner} {t}");
                    if step.advances_outer {
                        a += 1;
                    } else {
                        b += 1;
                    }
                }
                assert_eq!((a, b), (outer, inner - 2), "{outer} {inner}");
            }
        }
        for outer in 1..=64 {
            for inner in 0..=32 {
                let (mut a, mut b) = (0, 0);
                for t in 0..outer + inner {
                    let step = half_strip(outer, inner, t);
                    assert_eq!((step.outer, step.inner), (a, b), "{outer} {inner} {t}");
                    if step.advances_outer {
                        a += 1;
                    } else {
                        b += 1;
                    }
                }
                assert_eq!((a, b), (outer, inner), "{outer} {inner}");
            }
        }
        for m in 2..=64 {
            let (mut a, mut b) = (0, 0);
            for t in 0..2 * m - 2 {
                let step = regular(m, t);
                assert_eq!((step.outer, step.inner), (a, b), "{m} {t}");
                if step.advances_outer {
                    a += 1;
                } else {
                    b += 1;
                }
            }
            assert_eq!((a, b), (m, m - 2), "{m}");
        }
    }

    #[test]
    fn strips_are_mirror_images_of_themselves() {
        for outer in 1..=64_u32 {
            for inner in 2..=64_u32 {
                // Where both rows are odd the middle holds a quad, whose diagonal has a side.
                if outer % 2 == 1 && inner % 2 == 1 {
                    continue;
                }
                let total = outer + inner - 2;
                for t in 0..total {
                    let (one, other) = (
                        transition(outer, inner, t),
                        transition(outer, inner, total - 1 - t),
                    );
                    assert_eq!(one.advances_outer, other.advances_outer);
                }
            }
        }
    }
}
