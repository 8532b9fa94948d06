#define_import_path dolomite::vegetation::density

// How many stand at a place. CPU reference: plugins/vegetation/src/density.rs and band.rs.

#import dolomite::vegetation::place::{Clump, salted, unit}
#import dolomite::vegetation::types::Layer

// 0 up to `least` and beyond `most`, 1 between, with edges of this steepness inside.
fn ramp(x: f32, least: f32, most: f32, steepness: f32) -> f32 {
    return clamp(min((x - least) * steepness, (most - x) * steepness), 0.0, 1.0);
}

// The density by the clump alone.
fn clump_share(layer: Layer, hash: u32) -> f32 {
    let number = unit(salted(hash, 2u));
    if number >= layer.clump_from && number < layer.clump_to {
        return 1.0 - layer.uneven * unit(salted(hash, 3u));
    }
    return 0.0;
}
