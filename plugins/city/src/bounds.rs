//! What movers meet: boxes that hold all that is drawn of a building or a hedge, and triangles.

use bevy::math::Vec3;

use crate::map::DisplacementMap;
use crate::relief::CityPatch;

/// A box with sides along the axes, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CityBox {
    /// Least corner.
    pub least: Vec3,
    /// Greatest corner.
    pub greatest: Vec3,
}

impl CityBox {
    /// The box that holds the displaced surface of a patch: its corners, and these moved by its greatest
    /// displacement. Rounded outwards by 2⁻²⁰ of the coordinates, eight times what the vertices' arithmetic rounds.
    #[must_use]
    pub fn of_patch(patch: &CityPatch) -> Self {
        let [_, _, out] = patch.frame();
        let away = out * patch.data.map[2];
        let (mut least, mut greatest) = (Vec3::MAX, Vec3::MIN);
        for corner in patch.corners {
            let corner = Vec3::new(corner[0], corner[1], corner[2]);
            for point in [corner, corner + away] {
                least = least.min(point);
                greatest = greatest.max(point);
            }
        }
        let most = least.abs().max(greatest.abs()).max_element();
        let margin = Vec3::splat(most * (1.0 / 1_048_576.0));
        Self {
            least: least - margin,
            greatest: greatest + margin,
        }
    }

    /// The box that holds all patches; `None` of none.
    #[must_use]
    pub fn of_patches(patches: &[CityPatch]) -> Option<Self> {
        let mut boxes = patches.iter().map(Self::of_patch);
        let first = boxes.next()?;
        Some(boxes.fold(first, |all, next| Self {
            least: all.least.min(next.least),
            greatest: all.greatest.max(next.greatest),
        }))
    }

    /// Whether a point lies in it.
    #[must_use]
    pub fn holds(&self, point: Vec3) -> bool {
        point.cmpge(self.least).all() && point.cmple(self.greatest).all()
    }
}

/// Displaced patches as triangles, each of `level` × `level` quads; those of equal level meet without a gap.
#[must_use]
pub fn triangles(
    patches: &[CityPatch],
    maps: &[DisplacementMap],
    band: f32,
    level: u32,
) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let n = level.clamp(1, 64);
    let (mut points, mut corners) = (Vec::new(), Vec::new());
    for patch in patches {
        let first = points.len() as u32;
        let map = &maps[patch.data.map[3] as usize];
        for j in 0..=n {
            for i in 0..=n {
                let (u, v) = (i as f32 / n as f32, j as f32 / n as f32);
                points.push(patch.evaluate(map, band, u, v).0);
            }
        }
        for j in 0..n {
            for i in 0..n {
                let at = first + j * (n + 1) + i;
                corners.push([at, at + 1, at + n + 2]);
                corners.push([at, at + n + 2, at + n + 1]);
            }
        }
    }
    (points, corners)
}
