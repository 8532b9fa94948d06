//! What a layer's painter fills in: a square of texels at twice the output
//! size, and the brush that scattered things (blades, stones) are drawn with.

use crate::colour::Rgb;
use crate::plane::{Plane, rows};

/// Metres that one tile covers at the scale the layers are drawn for.
pub const TILE_METRES: f32 = 3.0;

/// One texel of a surface as painted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Texel {
    /// Height in any unit; it is brought to 0..=1 when the surface is finished.
    pub height: f32,
    /// Linear diffuse reflectance; its mean is set when the surface is finished.
    pub albedo: Rgb,
    /// Perceptual roughness, 0..=1.
    pub roughness: f32,
}

/// What the finishing step must know of a layer.
#[derive(Clone, Copy, Debug)]
pub struct Look {
    /// Mean linear albedo of the finished tile.
    pub mean_albedo: Rgb,
    /// Metres between height 0 and height 1, at [`TILE_METRES`]; sets the
    /// slope of the normals and the depth of the occlusion.
    pub relief: f32,
    /// Standard deviation of the low-pass that is taken out of the height,
    /// tiles. What is wider than some 10 of these is flattened.
    pub flatten_height: f32,
    /// How much the texel's position in the relief darkens what lies deep
    /// between things (0..=1), over the occlusion that a renderer applies.
    pub occlusion: f32,
}

/// A painted surface: `size` x `size` texels, row by row, periodic.
#[derive(Clone, Debug)]
pub struct Surface {
    size: usize,
    texels: Vec<Texel>,
}

impl Surface {
    /// Paints every texel from the position of its centre (u, v), tiles.
    #[must_use]
    pub fn paint(size: usize, texel: impl Fn(f32, f32) -> Texel + Sync) -> Self {
        let step = 1.0 / size as f32;
        let texels = rows(size, |y| {
            (0..size)
                .map(|x| texel((x as f32 + 0.5) * step, (y as f32 + 0.5) * step))
                .collect()
        });
        Self { size, texels }
    }

    /// Texels along a side.
    #[must_use]
    pub const fn size(&self) -> usize {
        self.size
    }

    /// Row by row, downwards.
    #[must_use]
    pub fn texels(&self) -> &[Texel] {
        &self.texels
    }

    /// Repaints every texel from its position and itself.
    pub fn repaint(&mut self, texel: impl Fn(f32, f32, Texel) -> Texel + Sync) {
        let (size, old) = (self.size, &self.texels);
        let step = 1.0 / size as f32;
        self.texels = rows(size, |y| {
            (0..size)
                .map(|x| {
                    let (u, v) = ((x as f32 + 0.5) * step, (y as f32 + 0.5) * step);
                    texel(u, v, old[y * size + x])
                })
                .collect()
        });
    }

    /// The texel that holds the point (u, v), tiles, wrapped round.
    #[must_use]
    pub fn at(&self, u: f32, v: f32) -> &Texel {
        &self.texels[self.index(u, v)]
    }

    /// Draws a texel over the one at (u, v) if it lies higher.
    pub fn stamp(&mut self, u: f32, v: f32, texel: Texel) {
        let index = self.index(u, v);
        if texel.height > self.texels[index].height {
            self.texels[index] = texel;
        }
    }

    /// Draws a disc-bounded thing: `shape` gets the offset of each texel's
    /// centre from `centre` (tiles) within `radius` and may give a texel,
    /// drawn if it lies higher than what is there.
    pub fn stamp_disc(
        &mut self,
        centre: [f32; 2],
        radius: f32,
        shape: impl Fn(f32, f32) -> Option<Texel>,
    ) {
        let n = self.size as f32;
        let (x0, x1) = ((centre[0] - radius) * n, (centre[0] + radius) * n);
        let (y0, y1) = ((centre[1] - radius) * n, (centre[1] + radius) * n);
        for y in y0.floor() as isize..=y1.ceil() as isize {
            for x in x0.floor() as isize..=x1.ceil() as isize {
                let (u, v) = ((x as f32 + 0.5) / n, (y as f32 + 0.5) / n);
                if let Some(texel) = shape(u - centre[0], v - centre[1]) {
                    self.stamp(u, v, texel);
                }
            }
        }
    }

    /// One number of every texel as a plane.
    #[must_use]
    pub fn plane(&self, value: impl Fn(&Texel) -> f32) -> Plane {
        Plane::from_index(self.size, |i| value(&self.texels[i]))
    }

    fn index(&self, u: f32, v: f32) -> usize {
        let n = self.size;
        let cell = |t: f32| (((t - t.floor()) * n as f32) as usize).min(n - 1);
        cell(v) * n + cell(u)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GROUND: Texel = Texel {
        height: 0.0,
        albedo: [0.1; 3],
        roughness: 0.9,
    };

    #[test]
    fn stamps_wrap_round_and_only_the_higher_shows() {
        let mut surface = Surface::paint(16, |_, _| GROUND);
        let high = Texel {
            height: 2.0,
            ..GROUND
        };
        let low = Texel {
            height: 1.0,
            ..GROUND
        };
        surface.stamp_disc([0.0, 0.0], 0.2, |_, _| Some(high));
        surface.stamp_disc([0.0, 0.0], 0.2, |_, _| Some(low));
        for (u, v) in [(0.05, 0.05), (0.95, 0.05), (0.05, 0.95), (0.95, 0.95)] {
            assert_eq!(surface.at(u, v).height, 2.0);
        }
        assert_eq!(surface.at(0.5, 0.5).height, 0.0);
        assert_eq!(surface.at(1.05, -0.05).height, 2.0);
    }

    #[test]
    fn texels_are_painted_at_their_centres() {
        let surface = Surface::paint(4, |u, v| Texel {
            height: u + 10.0 * v,
            ..GROUND
        });
        assert_eq!(surface.texels()[0].height, 0.125 + 1.25);
        assert_eq!(surface.texels()[7].height, 0.875 + 3.75);
    }
}
