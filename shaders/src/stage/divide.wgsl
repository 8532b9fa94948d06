#define_import_path dolomite::stage::divide

// Integer division by way of floating point: exact, and several times as fast as the built-in one
// where the hardware has no integer division.

// a / b for a < 2^31 and 0 < b < 2^15, of which the quotient is at most 2^25.
//
// f32(a) / f32(b) is within 2^-22 of the quotient, hence off by 8 at most; the rest of that, which
// both f32 hold to within a hundredth of b, gives it to within 1, and two comparisons the rest.
fn divide(a: u32, b: u32) -> u32 {
    let divisor = f32(b);
    var quotient = i32(f32(a) / divisor);
    var rest = i32(a) - quotient * i32(b);
    let step = i32(floor(f32(rest) / divisor));
    quotient += step;
    rest -= step * i32(b);
    quotient += select(0, 1, rest >= i32(b)) - select(0, 1, rest < 0);
    return u32(quotient);
}

// a / b for a < 2^22 and 0 < b: the quotient in f32 is off by 1 at most.
fn divide_small(a: u32, b: u32) -> u32 {
    let quotient = u32(f32(a) / f32(b));
    let rest = i32(a) - i32(quotient * b);
    return quotient + select(0u, 1u, rest >= i32(b)) - select(0u, 1u, rest < 0);
}
