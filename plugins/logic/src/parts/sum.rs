//! Sums of many small numbers.

/// Adds to a sum. `rest` is what rounding added in the step before, 0 at first, so that the sum of any number of steps is
/// off by little more than a rounding of its own (W. Kahan, Further Remarks on Reducing Truncation Errors, 1965). A sum
/// alone stands still where a step is less than half of its last digit: f32 by 1/64 s after three days.
pub(super) fn add(sum: &mut f32, rest: &mut f32, more: f32) {
    let step = more - *rest;
    let next = *sum + step;
    let over = (next - *sum) - step;
    // Nothing is left of what is not finite.
    *rest = if over.is_finite() { over } else { 0.0 };
    *sum = next;
}

#[cfg(test)]
mod tests {
    use super::add;

    #[test]
    fn a_million_steps_are_as_long_as_one() {
        let (mut sum, mut rest, mut alone) = (0.0, 0.0, 0.0_f32);
        for _ in 0..1_000_000 {
            add(&mut sum, &mut rest, 0.1_f32);
            alone += 0.1;
        }
        assert_eq!(sum, 100_000.0);
        assert!((alone - 100_000.0).abs() > 100.0, "{alone}");
        add(&mut sum, &mut rest, f32::INFINITY);
        assert_eq!((sum, rest), (f32::INFINITY, 0.0));
    }
}
