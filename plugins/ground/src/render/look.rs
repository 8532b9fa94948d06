//! The material of a ground as its shader reads it.

use bevy::math::{DVec2, UVec4, Vec4};
use bevy::render::render_resource::ShaderType;
use dolomite_terrain::GpuTerrainUniform;

use super::TerrainRelief;
use crate::material::{
    Band, CanopyLayer, GroundCanopy, GroundLayer, GroundMaterial, GroundShading, Measure, Sea,
    Surface,
};
use crate::range::within;

/// See `GroundBand` in `shaders/src/ground/types.wgsl`.
#[derive(ShaderType, Clone, Copy, Debug, Default, PartialEq)]
#[expect(missing_docs, reason = "each field is documented once, in types.wgsl")]
pub struct LookBand {
    pub measure: Vec4,
    pub edge: Vec4,
    pub noise: Vec4,
}

/// See `GroundLayer` in `shaders/src/ground/types.wgsl`.
#[derive(ShaderType, Clone, Copy, Debug, Default, PartialEq)]
#[expect(missing_docs, reason = "each field is documented once, in types.wgsl")]
pub struct LookLayer {
    pub colour: Vec4,
    pub texture: u32,
    pub tile: u32,
    pub cliff: u32,
    pub pad: u32,
}

/// See `CanopyLayer` in `shaders/src/ground/types.wgsl`.
#[derive(ShaderType, Clone, Copy, Debug, Default, PartialEq)]
#[expect(missing_docs, reason = "each field is documented once, in types.wgsl")]
pub struct LookCanopy {
    pub height: Vec4,
    pub slope: Vec4,
    pub entries: [Vec4; CanopyLayer::ENTRIES],
}

/// How the ground looks; see `shaders/src/ground/types.wgsl` for units and meanings.
#[derive(ShaderType, Clone, Copy, Debug, PartialEq)]
#[expect(missing_docs, reason = "each field is documented once, in types.wgsl")]
pub struct GroundLook {
    pub sea_level: f32,
    pub relief_texel: f32,
    pub relief_scale: f32,
    pub count: u32,
    pub tiles: Vec4,
    pub water: Vec4,
    pub deep: Vec4,
    pub order: [UVec4; GroundMaterial::MOST_LAYERS],
    pub layers: [LookLayer; GroundMaterial::MOST_LAYERS],
    pub bands: [LookBand; GroundMaterial::MOST_BANDS],
    pub canopy: [LookCanopy; GroundCanopy::MOST_LAYERS],
}

impl Default for GroundLook {
    fn default() -> Self {
        Self {
            sea_level: GpuTerrainUniform::NO_SEA,
            relief_texel: 0.0,
            relief_scale: 0.0,
            count: 0,
            tiles: Vec4::ONE,
            water: Vec4::ZERO,
            deep: Vec4::ZERO,
            order: [UVec4::ZERO; GroundMaterial::MOST_LAYERS],
            layers: [LookLayer::default(); GroundMaterial::MOST_LAYERS],
            bands: [LookBand::default(); GroundMaterial::MOST_BANDS],
            canopy: [LookCanopy::default(); GroundCanopy::MOST_LAYERS],
        }
    }
}

/// Ratio of the far to the near texture scale, as `FAR_TILES` in `site.wgsl`.
const FAR_TILES: f64 = 11.3;

/// As `NO_TEXTURE` in `types.wgsl`.
const NO_TEXTURE: u32 = u32::MAX;

/// A part of a material that is not drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LookLimit {
    /// More layers than are drawn.
    #[error(
        "the ground has {0} layers; the first {most} are drawn",
        most = GroundMaterial::MOST_LAYERS
    )]
    Layers(usize),
    /// More bands than count.
    #[error(
        "the layers of the ground have {0} bands; the first {most} count",
        most = GroundMaterial::MOST_BANDS
    )]
    Bands(usize),
    /// More sizes of tiles than there are.
    #[error(
        "the layers of the ground have {0} sizes of tiles; the first {most} count, others become the nearest of these",
        most = GroundMaterial::MOST_TILES
    )]
    Tiles(usize),
}

impl GroundLook {
    /// The look of a material, beside the sea whose level is given and the relief map; with what of it is
    /// beyond the limits.
    #[must_use]
    pub fn new(
        material: &GroundMaterial,
        sea: Option<(f32, Sea)>,
        relief: Option<&TerrainRelief>,
    ) -> (Self, Vec<LookLimit>) {
        let mut look = Self {
            relief_texel: relief.map_or(0.0, |relief| relief.texel),
            relief_scale: relief.map_or(0.0, |relief| 1.0 / (relief.texel * relief.side as f32)),
            ..Self::default()
        };
        if let Some((level, sea)) = sea {
            let Sea {
                extinction: [r, g, b],
                deep,
                steepness,
            } = sea.clamped();
            look.sea_level = level;
            look.water = Vec4::new(r, g, b, steepness);
            look.deep = Vec4::new(deep[0], deep[1], deep[2], 0.0);
        }
        let limits = look.lay(material);
        (look, limits)
    }

    /// The same, shaded in a way.
    #[must_use]
    pub fn shaded(mut self, shading: GroundShading) -> Self {
        self.deep.w = shading.narrowing();
        self
    }

    /// The same, below what grows.
    #[must_use]
    pub fn below(mut self, canopy: Option<&GroundCanopy>) -> Self {
        let layers = canopy.map_or(&[][..], |canopy| &canopy.layers);
        // A layer that is none ends the list in the shader.
        let layers = layers.iter().filter(|layer| layer.fade[1] > 0.0);
        for (slot, layer) in self.canopy.iter_mut().zip(layers) {
            let with = |[a, b, c]: [f32; 3], d: f32| Vec4::new(a, b, c, d);
            *slot = LookCanopy {
                height: with(layer.height, layer.fade[0]),
                slope: with(layer.slope, layer.fade[1]),
                entries: layer.entries.map(Vec4::from),
            };
        }
        self
    }

    /// What a view with this anchor (x, z) is told, with the least corner of the terrain's extent: texture coordinates
    /// of the anchor, as fractions of a tile, since far from the origin f32 would not hold them.
    #[must_use]
    pub fn numbers(&self, anchor: DVec2, extent_min: DVec2) -> [Vec4; 4] {
        let offset = |tile: f64| (anchor / tile - (anchor / tile).floor()).as_vec2();
        let offsets = |tile: f32| {
            let tile = f64::from(tile.max(0.01));
            let (near, far) = (offset(tile), offset(tile * FAR_TILES));
            Vec4::new(near.x, near.y, far.x, far.y)
        };
        let [a, b, c, _] = self.tiles.to_array().map(offsets);
        let relief = (anchor - extent_min) * f64::from(self.relief_scale);
        [a, b, c, relief.as_vec2().extend(0.0).extend(0.0)]
    }

    /// Takes over the layers.
    fn lay(&mut self, material: &GroundMaterial) -> Vec<LookLimit> {
        let mut limits = Vec::new();
        let layers = material.layers.as_slice();
        if layers.len() > GroundMaterial::MOST_LAYERS {
            limits.push(LookLimit::Layers(layers.len()));
        }
        let layers = &layers[..layers.len().min(GroundMaterial::MOST_LAYERS)];
        let tiles = tile_sizes(layers);
        if tiles.len() > GroundMaterial::MOST_TILES {
            limits.push(LookLimit::Tiles(tiles.len()));
        }
        for (side, tile) in tiles.iter().take(GroundMaterial::MOST_TILES).enumerate() {
            self.tiles[side] = *tile;
        }
        let bands: usize = layers.iter().map(|layer| layer.bands.len()).sum();
        if bands > GroundMaterial::MOST_BANDS {
            limits.push(LookLimit::Bands(bands));
        }
        // Layers are blended in the order of their textures, whatever lies above what.
        let mut places: Vec<usize> = (0..layers.len()).collect();
        places.sort_by_key(|&index| match layers[index].surface {
            Surface::Texture(texture) => texture,
            Surface::Flat { .. } => NO_TEXTURE,
        });
        let mut next = 0;
        for (index, layer) in layers.iter().enumerate() {
            let place = places.iter().position(|&at| at == index).unwrap_or(index);
            let first = next;
            // The last one takes what is left.
            if index + 1 < layers.len() {
                for band in &layer.bands {
                    if let Some(slot) = self.bands.get_mut(next) {
                        *slot = look_band(band);
                        next += 1;
                    }
                }
            }
            self.order[index] = UVec4::new(place as u32, first as u32, next as u32, 0);
            self.layers[place] = look_layer(layer, &tiles);
        }
        self.count = layers.len() as u32;
        limits
    }
}

/// The different sides of tiles, in the order of the layers.
fn tile_sizes(layers: &[GroundLayer]) -> Vec<f32> {
    let mut sizes = Vec::new();
    for side in layers.iter().map(tile) {
        if !sizes.contains(&side) {
            sizes.push(side);
        }
    }
    sizes
}

fn tile(layer: &GroundLayer) -> f32 {
    within(layer.tile, 0.01, 10_000.0, 3.0)
}

fn look_layer(layer: &GroundLayer, tiles: &[f32]) -> LookLayer {
    let side = tile(layer);
    let known = tiles.iter().take(GroundMaterial::MOST_TILES).enumerate();
    // By ratio: 2 m are as far from 1 m as from 4 m.
    let away = |other: f32| (other.max(side) / other.min(side)).to_bits();
    let nearest = known.min_by_key(|(_, other)| away(**other));
    let (texture, colour) = match layer.surface {
        Surface::Texture(texture) => (texture, Vec4::ZERO),
        Surface::Flat { colour, roughness } => {
            let [r, g, b] = colour.map(|channel| within(channel, 0.0, 1.0, 0.5));
            let roughness = within(roughness, 0.089, 1.0, 0.9);
            (NO_TEXTURE, Vec4::new(r, g, b, roughness))
        }
    };
    LookLayer {
        colour,
        texture,
        tile: nearest.map_or(0, |(index, _)| index as u32),
        cliff: u32::from(layer.cliff),
        pad: 0,
    }
}

fn look_band(band: &Band) -> LookBand {
    // Heights that a terrain may have.
    let finite = |value: f32| within(value, -1e6, 1e6, 0.0);
    let (from, to) = (finite(band.from), finite(band.to));
    // A step of no width is not defined: a millimetre, and more where f32 has no millimetres.
    let low = from.min(to);
    let high = from.max(to).max(low + (low.abs() * 1e-6).max(1e-3));
    let measure = match band.of {
        Measure::Height => [1.0, 0.0, 0.0],
        Measure::AboveSea => [0.0, 1.0, 0.0],
        Measure::Slope => [0.0, 0.0, 1.0],
    };
    let (base, step) = if from <= to { (0.0, 1.0) } else { (1.0, -1.0) };
    LookBand {
        measure: Vec4::new(measure[0], measure[1], measure[2], finite(band.steep)),
        edge: Vec4::new(low, high, base, step),
        noise: Vec4::new(finite(band.wide), finite(band.fine), 0.0, 0.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::MaterialBands;

    #[test]
    fn the_usual_layers_lie_in_the_order_of_their_textures() {
        let material = GroundMaterial::from(MaterialBands::default());
        let (look, limits) = GroundLook::new(&material, None, None);
        assert!(limits.is_empty(), "{limits:?}");
        assert_eq!(look.count, 5);
        // Snow, rock, sand, grass, scree, each at its texture's place.
        let order = [3, 2, 0, 1, 4];
        for (entry, place) in look.order.iter().zip(order) {
            assert_eq!(entry.x, place);
            assert_eq!(look.layers[place as usize].texture, place);
        }
        // Snow has two bands, grass two, the last none.
        assert_eq!(look.order[0].to_array(), [3, 0, 2, 0]);
        assert_eq!(look.order[4].to_array(), [4, 6, 6, 0]);
        assert_eq!(look.bands[0].edge.to_array(), [1090.0, 1410.0, 0.0, 1.0]);
        assert_eq!(look.layers[2].cliff, 1);
        assert_eq!(look.sea_level, GpuTerrainUniform::NO_SEA);
    }

    #[test]
    fn what_is_beyond_the_limits_is_named() {
        let mut layer = GroundLayer::new("", Surface::Texture(0));
        layer.bands = vec![Band::new(Measure::Slope, 0.0, 1.0); 3];
        let layers = (0..40).map(|index| GroundLayer {
            tile: index as f32,
            ..layer.clone()
        });
        let material = GroundMaterial {
            layers: layers.collect(),
        };
        let (look, limits) = GroundLook::new(&material, None, None);
        let sizes = 32;
        let expected = [
            LookLimit::Layers(40),
            LookLimit::Tiles(sizes),
            LookLimit::Bands(96),
        ];
        assert_eq!(limits, expected);
        assert_eq!(look.count, 32);
        assert!(
            look.order
                .iter()
                .all(|entry| entry.z <= 64 && entry.y <= entry.z)
        );
        // 0.01 (of 0), 1 and 2 m are there; 31 m take 2 m.
        assert_eq!(look.tiles.to_array(), [0.01, 1.0, 2.0, 1.0]);
        assert_eq!(look.layers[31].tile, 2);
    }

    #[test]
    fn hostile_bands_have_a_width() {
        for (from, to) in [
            (0.0, 0.0),
            (f32::NAN, f32::INFINITY),
            (5.0, f32::NEG_INFINITY),
        ] {
            let band = look_band(&Band::new(Measure::Height, from, to));
            assert!(
                band.edge.is_finite() && band.edge.x < band.edge.y,
                "{band:?}"
            );
        }
    }
}
