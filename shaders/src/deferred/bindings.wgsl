#define_import_path dolomite::deferred::bindings

#import dolomite::deferred::types::Light

// What the passes that light read besides Bevy's bindings of a view.

struct Lighting {
    // Of `listed`.
    lights: u32,
    // Of them, those whose tiles have lists; each pixel goes through the rest.
    in_tiles: u32,
    // Tiles of 16 × 16 pixels in a row, and rows.
    tiles: vec2<u32>,
    // Words for the lists of tiles.
    room: u32,
    // Greatest value that the target holds.
    brightest: f32,
    // Of `listed`, those without shadows: they come first.
    open: u32,
    pad: u32,
}

@group(2) @binding(0) var<uniform> lighting: Lighting;
// Every point and spot light of the world, in Bevy's order.
@group(2) @binding(1) var<storage, read> lights: array<Light>;
// Those that this view sees, in the same order.
@group(2) @binding(2) var<storage, read> listed: array<u32>;
// The lighting id of each pixel.
@group(2) @binding(3) var lighting_ids: texture_2d<u32>;
#ifdef TILED
// Of each tile, where its list begins and how long it is; then the lists.
@group(2) @binding(4) var<storage, read> tiles: array<u32>;
#endif
#ifdef VOLUMES
// Light of all points and spots.
@group(2) @binding(4) var gathered: texture_2d<f32>;
#endif
#ifdef AMBIENT_OCCLUSION
// The share of the light from everywhere that reaches each pixel of the view.
@group(2) @binding(5) var visible_share: texture_2d<f32>;
#endif
