#define_import_path dolomite::ground::site

// A place of the ground as its layers see it, and what they make of it.

#import dolomite::ground::layers::Place
#import dolomite::ground::types::GroundView
#import dolomite::ground::bindings::look

// The next scale of the textures, in tiles of the last: not a whole number, so that the two never align.
const FAR_TILES: f32 = 11.3;

// How much slower copies change at the next scale.
const FAR_COPIES: f32 = 0.37;

// What stands out at a farther scale stands FAR_TILES times as high as it is: its slopes are the near ones, on
// tufts and stones as large as bushes and boulders. Flattened, they are the unevenness of the ground.
const FAR_RELIEF: f32 = 0.4;

// How high a layer without a texture stands in height blending, of 0 to 1.
const FLAT_HEIGHT: f32 = 0.5;
struct Site {
    // What bands measure.
    place: Place,
    // In stage space, its height that of the world.
    position: vec3<f32>,
    // What a pixel spans.
    dx: vec3<f32>,
    dy: vec3<f32>,
    // Which copies of the textures lie here at the nearer scale: the whole numbers on both sides.
    index: f32,
    // The nearer of the two scales that are seen: 0, 1.
    scale: f32,
    // Share of the farther one.
    farness: f32,
    // Depth of the zone in which layers mix by height: the larger a pixel, the more of their heights it averages.
    mixed_height: f32,
    // How much of steep ground is seen from above.
    upright: f32,
    // Whether steep ground faces along z more than along x.
    side_z: bool,
    view: GroundView,
}

struct Blend {
    albedo: vec3<f32>,
    roughness: f32,
    occlusion: f32,
    // Offset of the normal in world space.
    bump: vec3<f32>,
    // Share of what is seen that has a texture: one colour is meant as it is.
    textured: f32,
}

// Sides of a tile at the first scale and its texture coordinates at the anchor.
fn tile_offset(view: GroundView, tile: u32) -> vec4<f32> {
    return select(select(view.offset_c, view.offset_b, tile == 1u), view.offset_a, tile == 0u);
}

// Texture coordinates of a place at both scales that are seen, and the side of a tile of the nearer one, metres.
struct ScaleUv {
    near: vec2<f32>,
    far: vec2<f32>,
    tile: f32,
}

// `at` relative to the anchor on the ground, or on a side of it, whose coordinates have no anchor.
fn scale_uv(site: Site, tile: u32, at: vec2<f32>, flat: bool) -> ScaleUv {
    let first = look.tiles[tile];
    let second = first * FAR_TILES;
    let third = second * FAR_TILES;
    let wide = site.scale > 0.0;
    var near = vec2(0.0);
    var far = vec2(0.0);
    if flat {
        let offset = tile_offset(site.view, tile);
        let last = fract(site.view.anchor / third);
        near = select(offset.xy, offset.zw, wide);
        far = select(offset.zw, last, wide);
    }
    return ScaleUv(near + at / select(first, second, wide), far + at / select(second, third, wide), select(first, second, wide));
}
