//! WGSL's own functions, one after the other, against their definitions in f64: which of them differ between
//! implementations, and by how much. The bounds are those of WGSL (W3C, section 15.7.4, "Floating point accuracy").

use std::fmt::Write as _;

use bytemuck::cast_slice;
use dolomite_testkit::random::Random;

use super::CapsuleError;
use super::builder::Builder;
use super::format::{BindingKind, Capsule, Command, Field, FieldType, From, Step};

/// A function of up to three numbers.
struct Function {
    name: &'static str,
    /// In WGSL, of the f32 `x`, `y` and `z`.
    wgsl: &'static str,
    exact: fn(f64, f64, f64) -> f64,
    /// Exponents of two that |x| lies between, and whether it may be negative.
    range: ([f32; 2], bool),
    /// WGSL's bound, units in the last place.
    ulp: f64,
    /// Size that the bound is of at least.
    scale: f32,
}

const fn function(
    name: &'static str,
    wgsl: &'static str,
    exact: fn(f64, f64, f64) -> f64,
    range: ([f32; 2], bool),
    ulp: f64,
    scale: f32,
) -> Function {
    Function {
        name,
        wgsl,
        exact,
        range,
        ulp,
        scale,
    }
}

/// Inputs of each.
const INPUTS: usize = 4096;

/// Numbers from 2^-8 to 2^8.
const ANY: ([f32; 2], bool) = ([-8.0, 8.0], true);
/// The same, none of them negative.
const POSITIVE: ([f32; 2], bool) = ([-8.0, 8.0], false);
/// From 2^-8 to 1, and to pi.
const UNIT: ([f32; 2], bool) = ([-8.0, 0.0], true);
const ANGLE: ([f32; 2], bool) = ([-8.0, 1.65], true);

#[rustfmt::skip]
#[expect(clippy::disallowed_methods, reason = "the definitions are in f64, and libm's last bit does not show in f32")]
const FUNCTIONS: &[Function] = &[
    // Rounded correctly, every one of them.
    function("x + y", "x + y", |x, y, _| x + y, ANY, 0.5, 0.0),
    function("x * y", "x * y", |x, y, _| x * y, ANY, 0.5, 0.0),
    function("floor", "floor(x)", |x, _, _| x.floor(), ANY, 0.0, 0.0),
    function("round", "round(x)", |x, _, _| x.round_ties_even(), ANY, 0.0, 0.0),
    function("fract", "fract(x)", |x, _, _| x - x.floor(), ANY, 0.5, 1.0),
    function("min of three", "min(x, min(y, z))", |x, y, z| x.min(y).min(z), ANY, 0.0, 0.0),
    function("x / y", "x / y", |x, y, _| x / y, ANY, 2.5, 0.0),
    function("1 / x", "1.0 / x", |x, _, _| 1.0 / x, ANY, 2.5, 0.0),
    function("inverseSqrt", "inverseSqrt(x)", |x, _, _| 1.0 / x.sqrt(), POSITIVE, 2.0, 0.0),
    // 1 / inverseSqrt(x): 2 and 2.5 units.
    function("sqrt", "sqrt(x)", |x, _, _| x.sqrt(), POSITIVE, 4.5, 0.0),
    // x * y + z, with one rounding or two; where the terms cancel, units of the terms.
    function("fma", "fma(x, y, z)", |x, y, z| x * y + z, UNIT, 1.0, 1.0),
    function("x * y + z", "x * y + z", |x, y, z| x * y + z, UNIT, 1.0, 1.0),
    function("dot of three", "dot(vec3(x, y, z), vec3(y, z, x))", |x, y, z| x * y + y * z + z * x, UNIT, 3.0, 1.0),
    function("length", "length(vec3(x, y, z))", |x, y, z| (x * x + y * y + z * z).sqrt(), ANY, 7.0, 0.0),
    function("normalize", "normalize(vec3(x, y, z)).x", |x, y, z| x / (x * x + y * y + z * z).sqrt(), ANY, 9.5, 0.0),
    function("distance", "distance(vec3(x, y, z), vec3(y, z, x))", |x, y, z| ((x - y).powi(2) + (y - z).powi(2) + (z - x).powi(2)).sqrt(), UNIT, 9.0, 1.0),
    function("mix", "mix(x, y, abs(z))", |x, y, z| x * (1.0 - z.abs()) + y * z.abs(), UNIT, 3.0, 1.0),
    function("smoothstep", "smoothstep(-1.0, 1.0, x)", |x, _, _| { let t = (x + 1.0) / 2.0; t * t * (3.0 - 2.0 * t) }, UNIT, 8.0, 1.0),
    // 3 + 2 |x| units, |x| at most 1.
    function("exp", "exp(x)", |x, _, _| x.exp(), UNIT, 5.0, 0.0),
    function("exp2", "exp2(x)", |x, _, _| x.exp2(), UNIT, 5.0, 0.0),
    // 2^-21 between 1/2 and 2, 3 units elsewhere.
    function("log2", "log2(x)", |x, _, _| x.log2(), POSITIVE, 4.0, 1.0),
    // exp2(y * log2(x)).
    function("pow", "pow(abs(x), y)", |x, y, _| x.abs().powf(y), UNIT, 64.0, 0.0),
    // 2^-11.
    function("sin", "sin(x)", |x, _, _| x.sin(), ANGLE, 4096.0, 1.0),
    function("cos", "cos(x)", |x, _, _| x.cos(), ANGLE, 4096.0, 1.0),
    function("atan2", "atan2(x, y)", |x, y, _| x.atan2(y), ANY, 4096.0, 0.0),
];

/// Each function of 4096 inputs.
///
/// # Errors
/// If the shader is wrong.
///
/// # Panics
/// Never: the WGSL is valid.
pub fn capsule(name: &str, about: &str) -> Result<Capsule, CapsuleError> {
    let mut builder = Builder::new(name, about);
    let inputs = inputs();
    let count = FUNCTIONS.len();
    let mut wgsl = String::from(
        "@group(0) @binding(0) var<storage, read> given: array<vec4<f32>>;\n\
         @group(0) @binding(1) var<storage, read_write> found: array<f32>;\n\
         @compute @workgroup_size(64)\n\
         fn functions(@builtin(global_invocation_id) id: vec3<u32>) {\n",
    );
    for (number, function) in FUNCTIONS.iter().enumerate() {
        let at = format!("id.x * {count}u + {number}u");
        writeln!(
            wgsl,
            "    {{\n        let it = given[{at}];\n        let x = it.x;\n        let y = it.y;\n        \
             let z = it.z;\n        found[{at}] = {};\n    }}",
            function.wgsl
        )
        .expect("a string takes all");
    }
    wgsl.push_str("}\n");
    let module = naga::front::wgsl::parse_str(&wgsl).expect("valid WGSL");
    let module = builder.module("functions", &[], &module)?;
    let layout = builder.layout(&[BindingKind::ReadOnlyStorage, BindingKind::Storage]);
    let pipeline = builder.pipeline(module, "functions", &[layout]);
    let given = builder.buffer("given", cast_slice(&inputs));
    let size = (INPUTS * count * 4) as u64;
    let found = builder.filled("found", size, 0xAB);
    let group = builder.group(layout, &[given, found]);
    let steps = vec![Step {
        pipeline,
        groups: vec![group],
        dispatch: Some([(INPUTS / 64) as u32, 1, 1]),
        indirect: None,
    }];
    builder.command(Command::Pass { steps });
    let expected: Vec<f32> = inputs
        .iter()
        .enumerate()
        .map(|(place, given)| {
            let [x, y, z, _] = given.map(f64::from);
            (FUNCTIONS[place % count].exact)(x, y, z) as f32
        })
        .collect();
    let fields = FUNCTIONS
        .iter()
        .enumerate()
        .map(|(number, function)| Field {
            name: function.name.to_owned(),
            at: 4 * number as u64,
            count: 1,
            ty: FieldType::F32 {
                // What is expected is itself half a unit off.
                ulp: if function.ulp > 0.5 {
                    function.ulp + 0.5
                } else {
                    0.0
                },
                scale: function.scale,
            },
        });
    builder.check(
        "functions",
        (found, 0, 4 * count as u64),
        fields.collect(),
        cast_slice(&expected),
        From::F64,
    );
    Ok(builder.finish())
}

/// x, y and z of each input of each function, in the order of the output.
fn inputs() -> Vec<[f32; 4]> {
    let mut random = Random::new(1);
    let mut inputs = Vec::with_capacity(INPUTS * FUNCTIONS.len());
    for _ in 0..INPUTS {
        for function in FUNCTIONS {
            let ([low, high], signed) = function.range;
            let mut number = || {
                // Evenly in the exponent: as many small numbers as large ones.
                let size = bevy::math::ops::exp2(random.range(low, high));
                let negative = signed && random.below(2) == 1;
                if negative { -size } else { size }
            };
            inputs.push([number(), number(), number(), 0.0]);
        }
    }
    inputs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_function_has_its_bound_and_is_expected_to_be_finite() {
        let capsule = capsule("functions", "").unwrap();
        let Some(Command::Check {
            expected, fields, ..
        }) = capsule.header.commands.last()
        else {
            panic!("it ends with a check");
        };
        assert_eq!(fields.len(), FUNCTIONS.len());
        let numbers: Vec<f32> = bytemuck::pod_collect_to_vec(capsule.span(*expected));
        assert_eq!(numbers.len(), INPUTS * FUNCTIONS.len());
        assert!(numbers.iter().all(|number| number.is_finite()));
    }
}
