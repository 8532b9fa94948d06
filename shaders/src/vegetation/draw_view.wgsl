#define_import_path dolomite::vegetation::draw_view

// What all draws bind.

#import dolomite::vegetation::draw_types::BladeView

@group(0) @binding(0) var<uniform> view: BladeView;
@group(0) @binding(1) var<storage, read> records: array<vec4<u32>>;
