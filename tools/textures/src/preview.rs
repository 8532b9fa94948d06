//! Pictures to judge the textures by: every layer in low sun, from straight
//! above and from the eye of a walker.

use std::path::Path;

use image::ExtendedColorType;

use crate::atlas::write_png;
use crate::colour::{Rgb, decode_byte, encode_byte};
use crate::error::TextureError;
use crate::surface::TILE_METRES;
use crate::tile::Tile;

/// Height of each row of the preview, pixels.
const HEIGHT: usize = 512;
/// Widths of the three pictures of a layer: one tile, 3x3 tiles, the walker.
const WIDTHS: [usize; 3] = [512, 400, 656];
/// Towards the sun: right, up the image (-v) and 38 degrees over the ground.
const SUN: [f32; 3] = [0.60, -0.50, 0.62];
/// Illuminance of the sun at normal incidence and of the sky, relative.
const LIGHT: [Rgb; 2] = [[2.35, 2.15, 1.85], [0.42, 0.50, 0.62]];
/// Height of the walker's eye, metres.
const EYE: f32 = 1.7;

/// A lit layer and its means over 2x2, 4x4 and so on to one texel.
struct Pyramid {
    levels: Vec<(usize, Vec<Rgb>)>,
}

impl Pyramid {
    fn lit(tile: &Tile) -> Self {
        let mut levels = vec![(tile.size, light(tile))];
        while let Some((size, texels)) = levels.last().filter(|level| level.0 > 1) {
            let (n, half) = (*size, *size / 2);
            let smaller = (0..half * half)
                .map(|i| {
                    let at = 2 * (i / half) * n + 2 * (i % half);
                    [0, 1, 2].map(|c| {
                        0.25 * (texels[at][c]
                            + texels[at + 1][c]
                            + texels[at + n][c]
                            + texels[at + n + 1][c])
                    })
                })
                .collect();
            levels.push((half, smaller));
        }
        Self { levels }
    }

    /// The mean light over about `width` tiles at (u, v): nearest level,
    /// bilinear within it.
    fn sample(&self, u: f32, v: f32, width: f32) -> Rgb {
        let mut level = 0;
        while level + 1 < self.levels.len() && width * self.levels[level].0 as f32 > 1.5 {
            level += 1;
        }
        let (size, texels) = &self.levels[level];
        let n = *size as f32;
        let (x, y) = (u * n - 0.5, v * n - 0.5);
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let at = |dx: f32, dy: f32| {
            let wrapped = |t: f32| (t.rem_euclid(n) as usize).min(size - 1);
            texels[wrapped(y.floor() + dy) * size + wrapped(x.floor() + dx)]
        };
        let (a, b, c, d) = (at(0.0, 0.0), at(1.0, 0.0), at(0.0, 1.0), at(1.0, 1.0));
        [0, 1, 2].map(|k| {
            let top = a[k] + (b[k] - a[k]) * fx;
            let bottom = c[k] + (d[k] - c[k]) * fx;
            top + (bottom - top) * fy
        })
    }
}

/// Diffuse light that leaves every texel.
fn light(tile: &Tile) -> Vec<Rgb> {
    let length = (SUN[0] * SUN[0] + SUN[1] * SUN[1] + SUN[2] * SUN[2]).sqrt();
    let maps = tile.albedo_height.iter().zip(&tile.normal_roughness);
    maps.map(|(albedo, normal)| {
        let [x, y] = [normal[0], normal[1]].map(|b| f32::from(b) / 127.5 - 1.0);
        let z = (1.0 - x * x - y * y).max(0.0).sqrt();
        let facing = ((x * SUN[0] + y * SUN[1] + z * SUN[2]) / length).max(0.0);
        let open = f32::from(normal[3]) / 255.0;
        [0, 1, 2].map(|c| decode_byte(albedo[c]) * (LIGHT[0][c] * facing + LIGHT[1][c] * open))
    })
    .collect()
}

/// Display value of a light: the exposure of a camera that meters the layer
/// half way to mid grey, then sRGB.
fn display(light: Rgb, pyramid: &Pyramid) -> [u8; 3] {
    let mean = pyramid.sample(0.0, 0.0, 1.0)[1];
    light.map(|x| {
        let x = x * 0.50 / (0.25 + 0.45 * mean);
        encode_byte(x * (1.0 + 0.12 * x) / (1.0 + 0.40 * x))
    })
}

/// The ground from the walker's eye, looking 12 degrees down: the plane
/// sampled 3x3 a pixel, each at the level of its narrower side.
fn walker(pyramid: &Pyramid, x: usize, y: usize) -> [u8; 3] {
    const GRID: usize = 3;
    let (width, height) = (WIDTHS[2] as f32, HEIGHT as f32);
    let mut sum = [0.0; 3];
    for sample in 0..GRID * GRID {
        let sub = |k: usize| (k as f32 + 0.5) / GRID as f32;
        let px = (x as f32 + sub(sample % GRID) - 0.5 * width) / height;
        let py = (y as f32 + sub(sample / GRID) - 0.5 * height) / height;
        // A field of view of 53 degrees upright: 1 unit of image at 1 unit.
        let down = py + 0.21;
        let forward = 1.0 - 0.21 * py;
        let colour = if down <= 0.002 {
            [0.55, 0.70, 0.95]
        } else {
            let distance = EYE * forward / down;
            let side = EYE * px / down;
            let pixel = EYE / (down * height * GRID as f32);
            // A turn keeps the tile's axes off the picture's.
            let (u, v) = (
                (0.87 * side + 0.49 * distance) / TILE_METRES,
                (0.49 * side - 0.87 * distance) / TILE_METRES,
            );
            let long = (pixel * distance / EYE).min(3.0 * pixel);
            pyramid.sample(u, v, pixel.max(long) / TILE_METRES)
        };
        for (total, c) in sum.iter_mut().zip(colour) {
            *total += c / (GRID * GRID) as f32;
        }
    }
    display(sum, pyramid)
}

/// Writes the preview: a row per tile with the tile, 3x3 tiles and the walker's
/// view.
///
/// # Errors
///
/// When the file cannot be written.
pub fn write(path: &Path, tiles: &[Tile]) -> Result<(), TextureError> {
    let width: usize = WIDTHS.iter().sum();
    let mut bytes = Vec::with_capacity(width * HEIGHT * tiles.len() * 3);
    for tile in tiles {
        let pyramid = Pyramid::lit(tile);
        let rows = crate::plane::rows(HEIGHT, |y| {
            let mut row = Vec::with_capacity(width);
            for (picture, tiles) in [(0, 1.0), (1, 3.0)] {
                let step = tiles / HEIGHT as f32;
                for x in 0..WIDTHS[picture] {
                    let (u, v) = ((x as f32 + 0.5) * step, (y as f32 + 0.5) * step);
                    row.push(display(pyramid.sample(u, v, step), &pyramid));
                }
            }
            row.extend((0..WIDTHS[2]).map(|x| walker(&pyramid, x, y)));
            row
        });
        bytes.extend_from_slice(rows.as_flattened());
    }
    write_png(
        path,
        &bytes,
        [width, HEIGHT * tiles.len()],
        ExtendedColorType::Rgb8,
    )
}
