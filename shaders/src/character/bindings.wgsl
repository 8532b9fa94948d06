#define_import_path dolomite::character::bindings

// What a crowd binds: beside a material's own data in Bevy, in group 0 elsewhere.

#import dolomite::character::types::{Crowd, Figure}

#ifdef CROWD_MATERIAL
@group(#{MATERIAL_BIND_GROUP}) @binding(100) var<storage, read> palette: array<vec4<f32>>;
@group(#{MATERIAL_BIND_GROUP}) @binding(101) var<storage, read> figures: array<Figure>;
@group(#{MATERIAL_BIND_GROUP}) @binding(102) var<uniform> crowd: Crowd;
#else
@group(0) @binding(0) var<storage, read> palette: array<vec4<f32>>;
@group(0) @binding(1) var<storage, read> figures: array<Figure>;
@group(0) @binding(2) var<uniform> crowd: Crowd;
#endif
