#define_import_path dolomite::character::types

// A figure of a crowd: 16 bytes, all that is uploaded for it in a frame.
struct Figure {
    // Metres from the crowd's anchor.
    x: f32,
    z: f32,
    // Upper 20 bits: height above the anchor, signed, in 1/1024 m. Lower 12 bits: the turn about +y in
    // 4096ths, from the model's +z towards its +x.
    place: u32,
    // Upper 16 bits: frame of the palette. Then 8 bits: 256ths of the way to the next one. Then 8 bits of
    // the user's own, such as a tint.
    pose: u32,
}

// What all figures share.
struct Crowd {
    // World coordinates of the anchor, metres.
    anchor: vec3<f32>,
    // Joints of a frame of the palette.
    joints: u32,
}

// A matrix without its last row, (0, 0, 0, 1).
struct Rows {
    x: vec4<f32>,
    y: vec4<f32>,
    z: vec4<f32>,
}
