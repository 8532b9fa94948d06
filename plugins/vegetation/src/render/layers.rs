//! What passes and draws are told of each kind that is drawn of records.

use bevy::math::ops;
use bytemuck::Zeroable;
use dolomite_geometry::render::ViewFrame;

use super::extract::ExtractedVegetation;
use super::layout::{LayerParams, LookParams, MOST_LAYERS, MOST_RINGS, Ring};
use super::lists::{BLADES, CHAINS, FLOWERS};
use super::rings::set_rings;
use crate::density::Growth;
use crate::kind::{Blade, Chain, Flower, Kind, Look, Shape};
use crate::law::Law;
use crate::reference::{crowding_of, depth_of};

/// Height of a blade in pixels below which it has 7 vertices, and 3.
const BLADE_PIXELS: [f32; 2] = [48.0, 14.0];

/// Radius of a blossom in pixels below which it is a hexagon.
const BLOSSOM_PIXELS: f32 = 4.0;

/// Length of a segment of a chain in pixels below which each second node is drawn, and each fourth: with an angle of 0.2
/// between segments a node that is left out is a tenth of that off the line.
const SEGMENT_PIXELS: [f32; 2] = [10.0, 4.0];

/// Mean width of a blossom as a multiple of its radius: of a disc π/2, of which petals cover some two thirds.
const BLOSSOM_WIDTH: f32 = 1.05;

/// Those of a list that are drawn of records.
pub fn layers(kinds: &[Kind]) -> impl Iterator<Item = &Kind> {
    let drawn = kinds
        .iter()
        .filter(|kind| !matches!(kind.shape, Shape::Mesh(_)));
    drawn.take(MOST_LAYERS)
}

/// What a shape asks of the passes.
struct Asked {
    list: usize,
    /// What a pixel is compared with, metres.
    width: f32,
    /// Height of the tallest, metres.
    tallest: f32,
    /// As [`LayerParams::lods`].
    lods: [f32; 2],
}

fn asked(kind: &Kind) -> Option<Asked> {
    let asked = match &kind.shape {
        Shape::Blade(blade) => Asked {
            list: BLADES,
            width: blade.width,
            tallest: blade.length.1,
            lods: BLADE_PIXELS,
        },
        Shape::Flower(flower) => {
            let tallest = flower.stem.length.1 + flower.radius;
            Asked {
                list: FLOWERS,
                width: BLOSSOM_WIDTH * flower.radius,
                tallest,
                lods: [BLOSSOM_PIXELS * tallest / flower.radius, 0.0],
            }
        }
        Shape::Chain(chain) => {
            let tallest = chain.segment * chain.segments as f32;
            Asked {
                list: CHAINS,
                width: chain.width,
                tallest,
                lods: SEGMENT_PIXELS.map(|pixels| pixels * tallest / chain.segment),
            }
        }
        Shape::Mesh(_) => return None,
    };
    Some(asked)
}

/// What the passes are told of a kind.
pub fn layer(kind: &Kind, grown: &ExtractedVegetation, frame: &ViewFrame) -> Option<LayerParams> {
    let asked = asked(kind)?;
    let mut growth = Growth::new(kind, grown.seed);
    growth.full *= grown.density.clamp(0.0, 1.0);
    let reach = kind.reach * grown.reach.clamp(0.0, 4.0);
    let mut layer = LayerParams {
        growth,
        tallest: asked.tallest,
        above: (frame.anchor.y - f64::from(grown.sea)) as f32,
        ring_count: 0,
        list: asked.list as u32,
        reach: Law::new(asked.width, frame.pixels_per_radian, reach),
        lods: asked.lods,
        more: [0; 2],
        rings: [Ring::zeroed(); MOST_RINGS],
    };
    let anchor = [frame.anchor.x as i64, frame.anchor.z as i64];
    let eye = frame.position - frame.anchor;
    set_rings(&mut layer, anchor, [eye.x, eye.z]);
    Some(layer)
}

fn with([r, g, b]: [f32; 3], w: f32) -> [f32; 4] {
    [r, g, b, w]
}

fn colours(look: &Look, lean: f32, droop: f32) -> LookParams {
    LookParams {
        root: with(look.root, ops::sin(lean)),
        tip: with(look.tip, droop),
        dry: with(look.dry, look.dry_share),
        sway: [look.sway, 0.0, 0.0, 0.0],
        ..LookParams::default()
    }
}

fn blade_look(blade: &Blade) -> LookParams {
    LookParams {
        size: [
            blade.length.0,
            blade.length.1,
            blade.width,
            blade.look.translucency,
        ],
        ..colours(&blade.look, blade.lean, blade.droop)
    }
}

fn flower_look(flower: &Flower) -> LookParams {
    LookParams {
        head: with(flower.colour, flower.radius),
        middle: with(flower.middle, flower.petals as f32),
        ..blade_look(&flower.stem)
    }
}

fn chain_look(chain: &Chain) -> LookParams {
    LookParams {
        size: [
            chain.rise.0,
            chain.rise.1,
            chain.width,
            chain.look.translucency,
        ],
        head: [chain.segment, chain.segments as f32, chain.twist, 0.0],
        ..colours(&chain.look, 0.0, 0.0)
    }
}

/// What the draws are told of a kind, whose law and growth are those of its layer.
pub fn look(kind: &Kind, layer: &LayerParams) -> LookParams {
    let mut look = match &kind.shape {
        Shape::Blade(blade) => blade_look(blade),
        Shape::Flower(flower) => flower_look(flower),
        Shape::Chain(chain) => chain_look(chain),
        Shape::Mesh(_) => LookParams::default(),
    };
    look.reach = layer.reach;
    if let Shape::Blade(blade) = &kind.shape {
        look.sway[2] = crowding_of(blade, &layer.growth);
        look.sway[3] = depth_of(blade, &layer.growth);
    }
    look.sway[1] = kind.clumps.as_ref().map_or(0.0, |clumps| clumps.uneven);
    look
}
