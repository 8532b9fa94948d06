#define_import_path dolomite::vegetation::shape

// What a blade is like at rest, of the hashes in its record. CPU reference: plugins/vegetation/src/blade.rs.

#import dolomite::terrain::hash::pcg
#import dolomite::vegetation::draw_types::Look

// A blade at rest.
struct Shape {
    long: f32,
    width: f32,
    lean: vec2<f32>,
    droop: f32,
    across: vec2<f32>,
    // How far the tip moves in a wind of 1 m/s, as a share of the length.
    give: f32,
}

// A random number of a hash, 0 up to 1.
fn own(hash: u32, salt: u32) -> f32 {
    return f32(pcg(hash * 747796405u + salt) >> 8u) * 5.9604644775390625e-8;
}

// Blades of a clump are as long and turned alike, as far as the clump is uneven. `normal` is that of the ground.
fn shape_of(look: Look, hash: u32, clump: u32, normal: vec3<f32>) -> Shape {
    let uneven = look.sway.y;
    let size = mix(own(hash, 4u), own(clump, 4u), 0.5 * uneven);
    let long = mix(look.size.x, look.size.y, size);
    let spread = 1.0 - 0.6 * uneven;
    let angle = 6.2831853 * (own(clump, 5u) + (own(hash, 5u) - 0.5) * spread);
    let ahead = vec2(cos(angle), sin(angle));
    let lean = look.root.w * sqrt(own(hash, 6u));
    return Shape(
        long,
        look.size.z * (0.75 + 0.5 * own(hash, 7u)),
        // Up the slope's normal a little.
        ahead * lean + 0.35 * normal.xz,
        look.tip.w * (0.6 + 0.4 * own(hash, 8u)),
        vec2(-ahead.y, ahead.x),
        // Tall ones give way more.
        look.sway.x * (0.6 + 0.4 * long / max(look.size.y, 1e-3)),
    );
}
