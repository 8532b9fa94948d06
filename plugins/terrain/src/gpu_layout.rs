//! The terrain as `shaders/src/terrain/bindings.wgsl` reads it.

use crate::edits::{EditRoom, EditTable, Edits};
use crate::ground::GroundPoint;
use crate::height_map::{Filter, HeightMap};
use crate::hill::Hill;
use crate::noise::{Octave, PreparedFractal, PreparedPermutation};
use crate::terrain::{MaskStep, Prepared, Terrain};
use bytemuck::{Pod, Zeroable};

/// What a [`GpuLayer`] is; the numbers are those of `shaders/src/terrain/layer.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum LayerKind {
    /// Fractal: FBM. 0 to 3 are in the order of [`Sum`](crate::Sum).
    Fbm = 0,
    /// Fractal: ridged.
    Ridged = 1,
    /// Fractal: billow.
    Billow = 2,
    /// Fractal: eroded.
    Eroded = 3,
    /// Permutation noise.
    Permutation = 4,
    /// Height map, bilinear.
    Bilinear = 5,
    /// Height map, bicubic.
    Bicubic = 6,
    /// Hill.
    Hill = 7,
    /// Edits, bilinear.
    EditsBilinear = 8,
    /// Edits, bicubic.
    EditsBicubic = 9,
}

/// One layer, laid out as the WGSL `Layer`: 20 words. Words that a kind does not use are 0.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct GpuLayer {
    /// A [`LayerKind`].
    pub kind: u32,
    /// Fractal, permutation: octaves. Map that is read by tiles: levels, else 0. Edits: entries of the table, as a power of two.
    pub octaves: u32,
    /// Fractal, permutation: index in the data of the octave table (12 words an octave); the permutation noise
    /// permutation (256 words) follows it. Map: index of the first sample, or of the first level's head
    /// ([`LEVEL_WORDS`](crate::LEVEL_WORDS) each). Edits: index of the table.
    pub data: u32,
    /// Fractal: octaves of the warp, 0 for none. Map: levels of windows. Edits: level of the root.
    pub warp_octaves: u32,
    /// Fractal: index of the warp's octave table for x; that for z follows it. Map: index of the first
    /// window of level 1; those of the next levels follow. Edits: index of the first sample of the first tile.
    pub warp_data: u32,
    /// Fractal: strength of erosion. Map: from its lowest to its highest height, metres.
    pub erosion: f32,
    /// Height where the mask is 0, metres.
    pub mask_low: f32,
    /// 1 / (high − low) of the mask, 0 for no mask.
    pub mask_scale: f32,
    /// Map: columns, rows. Edits: cells along x, z.
    pub size: [u32; 2],
    /// Map, edits: place of the first sample; hill: centre. Whole metres x, z.
    pub origin_cell: [i32; 2],
    /// The same: steps of 2⁻³² m.
    pub origin_frac: [u32; 2],
    /// Map, edits: mantissas of samples a metre along x, z.
    pub mantissa: [u32; 2],
    /// Map: shifts of the same.
    pub shift: [u32; 2],
    /// Map, edits: samples a metre. Hill: 1/radius, and height in metres.
    pub scale: [f32; 2],
}

/// The uniform beside the layers, laid out as the WGSL `TerrainUniform`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct GpuTerrainUniform {
    /// Layers in use.
    pub layer_count: u32,
    /// Height before the first layer, metres.
    pub base: f32,
    /// Height of the water, metres; [`GpuTerrainUniform::NO_SEA`] if there is none.
    pub sea_level: f32,
    /// 0.
    pub pad: u32,
}

impl GpuTerrainUniform {
    /// Stands for no water.
    pub const NO_SEA: f32 = -1e30;
}

/// Everything that `terrain_height` reads. Both lists hold at least one element, as a binding
/// must not be empty.
#[derive(Clone, Debug, PartialEq)]
pub struct GpuTerrain {
    /// Binding 0.
    pub layers: Vec<GpuLayer>,
    /// Binding 1: octave tables, permutations; samples and what lies between them as f32 bits.
    pub data: Vec<u32>,
    /// Binding 2.
    pub uniform: GpuTerrainUniform,
    /// Where in the data the table of edits begins, and what it holds, if there is a layer of them.
    pub edits: Option<(usize, EditTable)>,
}

impl Terrain {
    /// Bytes of the height maps and edits in [`GpuTerrain::data`], known before they are laid out.
    #[must_use]
    pub fn gpu_map_bytes(&self) -> u64 {
        let maps = self.prepared().filter_map(|(source, _)| match source {
            Prepared::Map(map) => Some(map.gpu_words()),
            _ => None,
        });
        let edits = self.edits().map(|edits| EditRoom::of(edits).words() as u64);
        4 * (maps.sum::<u64>() + edits.unwrap_or(0))
    }

    /// Word of [`GpuTerrain::data`] from which on the map stands that is read by tiles, if there is one:
    /// [`MapWrite::at`](crate::MapWrite::at) counts from there.
    #[must_use]
    pub fn streamed_at(&self) -> Option<u64> {
        let mut at = 0;
        for (source, _) in self.prepared() {
            at += match source {
                Prepared::Map(map) if map.stream().is_some() => return Some(at),
                Prepared::Map(map) => map.gpu_words(),
                Prepared::Fractal(source) => {
                    let warp = source.warp.as_ref();
                    let warp = warp.map_or(0, |warp| warp.x.len() + warp.z.len());
                    (OCTAVE_WORDS * (source.octaves.len() + warp)) as u64
                }
                Prepared::Permutation(source) => {
                    (OCTAVE_WORDS * source.octaves.len() + source.permutation.len()) as u64
                }
                // Edits come last.
                Prepared::Hill(_) | Prepared::Edits(_) => 0,
            };
        }
        None
    }

    /// Lays out the terrain for the GPU. Copies the samples of height maps.
    #[must_use]
    pub fn gpu(&self) -> GpuTerrain {
        let mut data = Vec::new();
        let mut table = None;
        let mut layers: Vec<GpuLayer> = self
            .prepared()
            .map(|(source, mask)| {
                let mask = MaskStep::new(mask);
                let layer = match source {
                    Prepared::Fractal(source) => fractal(source, &mut data),
                    Prepared::Permutation(source) => permutation(source, &mut data),
                    Prepared::Map(source) => map(source, &mut data),
                    Prepared::Hill(source) => hill(source),
                    Prepared::Edits(source) => {
                        let (layer, made) = edits(source, &mut data);
                        table = made;
                        layer
                    }
                };
                GpuLayer {
                    mask_low: mask.low,
                    mask_scale: mask.scale,
                    ..layer
                }
            })
            .collect();
        let uniform = GpuTerrainUniform {
            layer_count: layers.len() as u32,
            base: self.data().base,
            sea_level: self.sea_level().unwrap_or(GpuTerrainUniform::NO_SEA),
            pad: 0,
        };
        if layers.is_empty() {
            layers.push(GpuLayer::default());
        }
        if data.is_empty() {
            data.push(0);
        }
        GpuTerrain {
            layers,
            data,
            uniform,
            edits: table,
        }
    }
}

/// Words of an octave.
const OCTAVE_WORDS: usize = 12;

/// Appends an octave table; returns its index. An octave is 12 words: mantissa, shift, seed, offset
/// x (cell, fraction), offset z (cell, fraction), then as f32 bits amplitude, frequency, slope,
/// relative slope, and one spare. `load_octave` in `bindings.wgsl` reads them.
fn octave_table(octaves: &[Octave], data: &mut Vec<u32>) -> u32 {
    let at = data.len() as u32;
    for octave in octaves {
        let scale = octave.scale;
        let [x, z] = octave.offset;
        data.extend([
            octave.frequency.mantissa,
            octave.frequency.shift,
            octave.seed,
            (x >> 32) as u32,
            x as u32,
            (z >> 32) as u32,
            z as u32,
            scale.amplitude.to_bits(),
            scale.frequency.to_bits(),
            scale.slope.to_bits(),
            scale.relative.to_bits(),
            0,
        ]);
    }
    at
}

fn fractal(source: &PreparedFractal, data: &mut Vec<u32>) -> GpuLayer {
    let layer = GpuLayer {
        kind: source.sum.code(),
        octaves: source.octaves.len() as u32,
        data: octave_table(&source.octaves, data),
        erosion: source.erosion,
        ..GpuLayer::default()
    };
    let Some(warp) = &source.warp else {
        return layer;
    };
    let warp_data = octave_table(&warp.x, data);
    octave_table(&warp.z, data);
    GpuLayer {
        warp_octaves: warp.x.len() as u32,
        warp_data,
        ..layer
    }
}

fn permutation(source: &PreparedPermutation, data: &mut Vec<u32>) -> GpuLayer {
    let at = octave_table(&source.octaves, data);
    data.extend(source.permutation.iter().map(|&p| u32::from(p)));
    GpuLayer {
        kind: LayerKind::Permutation as u32,
        octaves: source.octaves.len() as u32,
        data: at,
        ..GpuLayer::default()
    }
}

fn map(source: &HeightMap, data: &mut Vec<u32>) -> GpuLayer {
    let at = data.len() as u32;
    let mut by_tiles = 0;
    let (mut windows, mut levels) = (0, 0);
    if let Some(stream) = source.stream() {
        stream.lay_out(data);
        by_tiles = stream.levels();
    } else {
        data.extend(source.samples().iter().map(|s| s.to_bits()));
        windows = data.len() as u32;
        let all = source.deviations().levels();
        levels = all.len() as u32;
        data.extend(
            all.iter()
                .flat_map(|level| level.windows.iter().map(|d| d.to_bits())),
        );
    }
    let lattice = source.lattice();
    let kind = match source.filter() {
        Filter::Bilinear => LayerKind::Bilinear,
        Filter::Bicubic => LayerKind::Bicubic,
    };
    GpuLayer {
        kind: kind as u32,
        octaves: by_tiles,
        data: at,
        warp_octaves: levels,
        warp_data: windows,
        size: [source.width(), source.height()],
        mantissa: lattice.frequency.map(|frequency| frequency.mantissa),
        shift: lattice.frequency.map(|frequency| frequency.shift),
        scale: source.inverse_spacing().to_array(),
        erosion: source.range(),
        ..origin(lattice.origin)
    }
}

fn hill(source: &Hill) -> GpuLayer {
    GpuLayer {
        kind: LayerKind::Hill as u32,
        scale: [source.inverse_radius(), source.height],
        ..origin(GroundPoint::new(source.centre))
    }
}

/// Room for a layer of edits, and what it holds.
fn edits(source: &Edits, data: &mut Vec<u32>) -> (GpuLayer, Option<(usize, EditTable)>) {
    let room = EditRoom::of(source);
    let at = data.len();
    data.resize(at + room.words(), 0);
    let mut table = EditTable::new(room, source);
    for write in table.update(source).unwrap_or_default() {
        data[at + write.at..][..write.words.len()].copy_from_slice(&write.words);
    }
    let lattice = source.lattice();
    let kind = match lattice.filter() {
        Filter::Bilinear => LayerKind::EditsBilinear,
        Filter::Bicubic => LayerKind::EditsBicubic,
    };
    let layer = GpuLayer {
        kind: kind as u32,
        octaves: room.entries_log2,
        data: at as u32,
        warp_octaves: lattice.level(),
        warp_data: (at + room.tiles_at()) as u32,
        size: lattice.samples().map(|samples| samples as u32),
        mantissa: lattice.frequency.map(|frequency| frequency.mantissa),
        shift: lattice.frequency.map(|frequency| frequency.shift),
        scale: lattice.scale().as_vec2().to_array(),
        ..origin(lattice.origin)
    };
    (layer, Some((at, table)))
}

fn origin(point: GroundPoint) -> GpuLayer {
    GpuLayer {
        origin_cell: point.cell.to_array(),
        origin_frac: point.frac.to_array(),
        ..GpuLayer::default()
    }
}
