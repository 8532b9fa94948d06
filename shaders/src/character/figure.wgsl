#define_import_path dolomite::character::figure

// Where a figure stands. CPU reference: `dolomite_character::crowd::figure`.

#import dolomite::character::types::Figure

// The sine of `step` 1024ths of a right angle, from 0 to 1024. Not `sin`, whose error WGSL leaves at 2^-11.
// The polynomial's relative error is 1e-7.
fn quarter_sine(step: u32) -> f32 {
    let x = f32(step) * 0.0015339808;
    let square = x * x;
    var sum = 2.6051018e-6;
    sum = sum * square + -0.00019809014;
    sum = sum * square + 0.00833305;
    sum = sum * square + -0.16666658;
    sum = sum * square + 1.0;
    return x * sum;
}

// Sine and cosine of a turn in 4096ths.
fn turn_of(figure: Figure) -> vec2<f32> {
    let step = figure.place & 1023u;
    let s = quarter_sine(step);
    let c = quarter_sine(1024u - step);
    switch (figure.place >> 10u) & 3u {
        case 0u: { return vec2(s, c); }
        case 1u: { return vec2(c, -s); }
        case 2u: { return vec2(-s, -c); }
        default: { return vec2(-c, s); }
    }
}

// A direction of the model in the world.
fn turned(figure: Figure, direction: vec3<f32>) -> vec3<f32> {
    let turn = turn_of(figure);
    return vec3(
        direction.x * turn.y + direction.z * turn.x,
        direction.y,
        direction.z * turn.y - direction.x * turn.x,
    );
}

// A place of the model, metres from the crowd's anchor.
fn placed(figure: Figure, position: vec3<f32>) -> vec3<f32> {
    let height = f32(bitcast<i32>(figure.place) >> 12u) * 0.0009765625;
    return turned(figure, position) + vec3(figure.x, height, figure.z);
}
