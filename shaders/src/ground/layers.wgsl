#define_import_path dolomite::ground::layers

// Which layers lie at a place, by height, slope and the sea. Heights metres, slopes rise over run.

#import dolomite::ground::types::GroundBand
#import dolomite::ground::bindings::look

// Room for the layers of a material: whoever knows that there are few takes less of it.
#ifdef GROUND_FEW_LAYERS
const LAYERS: u32 = 8u;
#else
const LAYERS: u32 = 32u;
#endif

// Slope from which a band's steepness counts.
const STEEP: f32 = 0.35;

// What bands measure at a place.
struct Place {
    // Height, height above the sea, slope.
    measures: vec3<f32>,
    // Slope beyond STEEP.
    steep: f32,
    // The wide and the fine noise, -1/2 to 1/2.
    noise: vec2<f32>,
}

fn place_of(height: f32, sea_level: f32, slope: f32, noise: vec2<f32>) -> Place {
    return Place(vec3(height, height - sea_level, slope), max(slope - STEEP, 0.0), noise - 0.5);
}

// Share of a layer within a band.
fn band_share(band: GroundBand, place: Place) -> f32 {
    let at = dot(band.measure.xyz, place.measures) + band.noise.x * place.noise.x + band.noise.y * place.noise.y + band.measure.w * place.steep;
    return band.edge.z + band.edge.w * smoothstep(band.edge.x, band.edge.y, at);
}

// Of the layer `i` from above: its share of the ground, where `left` of it is left; and what it leaves. An upper
// layer hides what lies below it.
fn layer_share(i: u32, place: Place, left: f32) -> vec2<f32> {
    let entry = look.order[i];
    var share = 1.0;
    for (var k = entry.y; k < entry.z; k++) {
        share *= band_share(look.bands[k], place);
    }
    return vec2(left * share, left * (1.0 - share));
}
