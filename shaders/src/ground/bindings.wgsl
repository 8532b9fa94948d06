#define_import_path dolomite::ground::bindings

// What the ground's material reads.

#import dolomite::ground::types::GroundLook

@group(1) @binding(3) var albedo_height: texture_2d_array<f32>;
@group(1) @binding(4) var normal_roughness: texture_2d_array<f32>;
@group(1) @binding(5) var textures: sampler;
@group(1) @binding(6) var relief: texture_2d<f32>;
@group(1) @binding(7) var relief_sampler: sampler;
@group(1) @binding(8) var<uniform> look: GroundLook;
