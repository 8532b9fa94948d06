#define_import_path dolomite::stage::divide

// Integer division by way of floating point: exact, and several times as fast as the built-in one
// where the hardware has no integer division. The reciprocal stands alone, so that it is taken once
// where many numbers are divided by one. Conversions are those of signed numbers, which are cheaper.

// a / b for a < 2^31 and 0 < b < 2^15, of which the quotient is at most 2^25.
//
// The product is within 2^-21 of the quotient (WGSL gives a reciprocal to 2.5 units in the last
// place), hence off by 17 at most; the rest of that, which f32 holds exactly, gives it to within 1,
// and two comparisons the rest.
fn divide(a: u32, b: u32) -> u32 {
    let reciprocal = 1.0 / f32(i32(b));
    var quotient = i32(f32(i32(a)) * reciprocal);
    var rest = i32(a) - quotient * i32(b);
    let step = i32(floor(f32(rest) * reciprocal));
    quotient += step;
    rest -= step * i32(b);
    quotient += select(0, 1, rest >= i32(b)) - select(0, 1, rest < 0);
    return u32(quotient);
}

// a / b for a < 2^20 and 0 < b: the product is off by 1 at most.
fn divide_small(a: u32, b: u32) -> u32 {
    let quotient = i32(f32(i32(a)) * (1.0 / f32(i32(b))));
    let rest = i32(a) - quotient * i32(b);
    return u32(quotient + select(0, 1, rest >= i32(b)) - select(0, 1, rest < 0));
}
