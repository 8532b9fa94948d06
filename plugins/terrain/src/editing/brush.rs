//! One edit: which samples it changes, and by how much.

use super::error::EditError;
use crate::edits::{CELLS, EditLattice, Edits, LIMIT, SAMPLES, SIDE, STEP, Tile};
use crate::ground::GroundRect;
use crate::height_map::{Filter, HeightMap};
use crate::terrain::{Source, Terrain};
use bevy::math::DVec2;

/// Most samples that one edit changes.
pub const MAX_SAMPLES: u64 = 1 << 22;
/// Most tiles of a layer: 38 MiB on the GPU.
pub const MAX_TILES: u64 = 8192;

/// What an edit does with the ground under its brush.
#[derive(Clone, Debug)]
pub enum EditKind {
    /// Raises it by `strength` metres in the middle.
    Raise,
    /// Lowers it so.
    Lower,
    /// Brings it to a height, metres, by a share of `strength`; to that of the middle where none is given.
    Flatten {
        /// Where to.
        height: Option<f64>,
    },
    /// Brings it to the mean of the samples around, by a share of `strength`.
    Smooth,
    /// Adds the heights of a map times `strength`, stretched over the square about the brush, its middle in the middle.
    Stamp(HeightMap),
}

/// An edit: a round brush, put onto the ground once.
#[derive(Clone, Debug)]
pub struct Edit {
    /// What it does.
    pub kind: EditKind,
    /// Where its middle is, (x, z), metres.
    pub place: DVec2,
    /// How far it reaches, metres.
    pub radius: f64,
    /// Metres or a share, as the kind says.
    pub strength: f64,
    /// The outer share of the radius over which it fades to nothing, 0 to 1.
    pub falloff: f64,
}

/// An edit that was made.
#[derive(Clone, Debug)]
pub struct Edited {
    /// The terrain with it.
    pub terrain: Terrain,
    /// Samples that were looked at.
    pub samples: u64,
    /// Tiles that were made anew.
    pub tiles: u64,
}

impl Edit {
    fn check(&self) -> Result<(), EditError> {
        if !(self.place.is_finite() && self.place.abs().max_element() <= 1e8) {
            return Err(EditError::Place(self.place));
        }
        if !(self.radius.is_finite() && self.radius > 0.0) {
            return Err(EditError::Radius(self.radius));
        }
        let (wanted, most) = match &self.kind {
            EditKind::Raise | EditKind::Lower => ("0 to 4096 metres", LIMIT),
            EditKind::Flatten { .. } | EditKind::Smooth => ("a share from 0 to 1", 1.0),
            EditKind::Stamp(_) => ("a factor of at most 1e6 either way", 1e6),
        };
        let least = if matches!(self.kind, EditKind::Stamp(_)) {
            -1e6
        } else {
            0.0
        };
        if !(least..=most).contains(&self.strength) {
            return Err(EditError::Strength {
                found: self.strength,
                wanted,
            });
        }
        if !(0.0..=1.0).contains(&self.falloff) {
            return Err(EditError::Falloff(self.falloff));
        }
        if let EditKind::Flatten {
            height: Some(height),
        } = self.kind
            && !(height.is_finite() && height.abs() <= 1e6)
        {
            return Err(EditError::Height(height));
        }
        Ok(())
    }

    /// How much the brush counts at a distance from its middle: 1, and over the falloff a smooth step to 0.
    fn weight(&self, distance: f64) -> f64 {
        let out = distance / self.radius;
        if out >= 1.0 {
            return 0.0;
        }
        let t = ((1.0 - out) / self.falloff.max(1e-9)).min(1.0);
        t * t * (3.0 - 2.0 * t)
    }
}

/// Where the samples of edits of a terrain lie: on those of its finest height map, which are halved until they are a
/// metre and a half apart at most, or [`EditLattice::SPACING`] apart.
///
/// # Errors
/// [`EditError::Lattice`].
pub fn lattice_of(terrain: &Terrain) -> Result<EditLattice, EditError> {
    let layers = terrain.data().layers.iter();
    let maps = layers.filter_map(|layer| match &layer.source {
        Source::Map(map) => Some(map),
        _ => None,
    });
    let finest = maps.min_by(|a, b| {
        let [a, b] = [a, b].map(|map| map.spacing().min_element());
        a.total_cmp(&b)
    });
    let extent = terrain.extent();
    let (through, mut spacing, filter) = finest.map_or(
        (
            extent.min,
            DVec2::splat(EditLattice::SPACING),
            Filter::Bicubic,
        ),
        |map| (map.origin(), map.spacing(), map.filter()),
    );
    while spacing.max_element() > 1.5 * EditLattice::SPACING
        && spacing.min_element() > 2.0 * HeightMap::MIN_SPACING
    {
        spacing *= 0.5;
    }
    EditLattice::over(&extent, through, spacing, filter).ok_or(EditError::Lattice {
        size: extent.size(),
        spacing,
    })
}

/// The samples under a brush, both ends included.
struct Window {
    first: [i64; 2],
    last: [i64; 2],
}

impl Window {
    fn of(edit: &Edit, lattice: &EditLattice) -> Result<Self, EditError> {
        let reach = edit.radius / lattice.spacing();
        let across = 2.0 * reach + 1.0;
        let samples = across.x * across.y;
        if samples.is_nan() || samples > MAX_SAMPLES as f64 {
            return Err(EditError::TooManySamples {
                radius: edit.radius,
                samples,
                most: MAX_SAMPLES,
            });
        }
        let middle = lattice.coordinates(edit.place);
        let (low, high) = ((middle - reach).ceil(), (middle + reach).floor());
        let most = lattice.samples();
        // The outermost stay as they are, so that nothing jumps at the lattice's border.
        let first = [0, 1].map(|k| (low[k] as i64).max(2));
        let last = [0, 1].map(|k| (high[k] as i64).min(most[k] - 3));
        Ok(Self { first, last })
    }

    fn size(&self) -> [usize; 2] {
        [0, 1].map(|k| (self.last[k] - self.first[k] + 1).max(0) as usize)
    }

    fn samples(&self) -> impl Iterator<Item = [i64; 2]> + use<> {
        let (first, last) = (self.first, self.last);
        (first[1]..=last[1]).flat_map(move |z| (first[0]..=last[0]).map(move |x| [x, z]))
    }

    /// Tiles that hold a sample of it, those beside too.
    fn tiles(&self, lattice: &EditLattice) -> Vec<[u32; 2]> {
        let cells = i64::from(CELLS);
        let ends = [0, 1].map(|k| {
            let most = i64::from(lattice.tiles[k]) - 1;
            // Tile t holds 32 t − 1 to 32 t + 33.
            let first = (self.first[k] - cells - 1).div_euclid(cells).max(0);
            let last = (self.last[k] + 1).div_euclid(cells).min(most);
            (first, last)
        });
        let [(x0, x1), (z0, z1)] = ends;
        (z0..=z1)
            .flat_map(|z| (x0..=x1).map(move |x| [x as u32, z as u32]))
            .collect()
    }
}

fn rounded(metres: f64) -> i32 {
    (metres.clamp(-LIMIT, LIMIT) / STEP).round() as i32
}

/// What the samples of the window become, in steps.
fn changed(terrain: &Terrain, edits: &Edits, edit: &Edit, window: &Window) -> Vec<i32> {
    let lattice = edits.lattice();
    let base = terrain.with_edits(None);
    let total = |at: [i64; 2]| {
        let lifted = f64::from(edits.steps(at)) * STEP;
        base.sample_f64(lattice.place(at)).height + lifted
    };
    let weight = |at: [i64; 2]| edit.weight(lattice.place(at).distance(edit.place));
    let raised = |at: [i64; 2], by: f64| {
        let most = (LIMIT / STEP) as i32;
        (edits.steps(at) + rounded(by)).clamp(-most, most)
    };
    match &edit.kind {
        EditKind::Raise | EditKind::Lower => {
            let by = if matches!(edit.kind, EditKind::Raise) {
                edit.strength
            } else {
                -edit.strength
            };
            window
                .samples()
                .map(|at| raised(at, by * weight(at)))
                .collect()
        }
        EditKind::Flatten { height } => {
            let height = height.unwrap_or_else(|| terrain.sample_f64(edit.place).height);
            window
                .samples()
                .map(|at| match edit.strength * weight(at) {
                    share if share > 0.0 => raised(at, (height - total(at)) * share),
                    _ => edits.steps(at),
                })
                .collect()
        }
        EditKind::Smooth => {
            let around = Window {
                first: window.first.map(|k| k - 1),
                last: window.last.map(|k| k + 1),
            };
            let width = around.size()[0];
            let heights: Vec<f64> = around.samples().map(total).collect();
            let number = |[x, z]: [i64; 2]| {
                (z - around.first[1]) as usize * width + (x - around.first[0]) as usize
            };
            window
                .samples()
                .map(|at| {
                    let k = number(at);
                    let row = |k: usize| heights[k - 1] + 2.0 * heights[k] + heights[k + 1];
                    let mean = (row(k - width) + 2.0 * row(k) + row(k + width)) / 16.0;
                    raised(at, (mean - heights[k]) * edit.strength * weight(at))
                })
                .collect()
        }
        EditKind::Stamp(map) => {
            let rect = map.rect();
            let scale = rect.size() * 0.5 / edit.radius;
            window
                .samples()
                .map(|at| {
                    let on_map = rect.centre() + (lattice.place(at) - edit.place) * scale;
                    raised(
                        at,
                        map.sample_f64(on_map).height * edit.strength * weight(at),
                    )
                })
                .collect()
        }
    }
}

/// Puts a brush onto a terrain once. Work and memory follow the samples under it.
///
/// # Errors
/// [`EditError`], before memory is taken.
pub fn edit(terrain: &Terrain, lattice: &EditLattice, edit: &Edit) -> Result<Edited, EditError> {
    edit.check()?;
    let none = Edits::none(*lattice);
    let edits = match terrain.edits() {
        Some(known) if known.lattice() == lattice => known,
        _ => &none,
    };
    let window = Window::of(edit, lattice)?;
    let [width, height] = window.size();
    if width == 0 || height == 0 {
        return Ok(Edited {
            terrain: terrain.clone(),
            samples: 0,
            tiles: 0,
        });
    }
    let tiles = window.tiles(lattice);
    let [known, _] = edits.counts();
    let missing = tiles.iter().filter(|tile| edits.tile(**tile).is_none());
    let would_be = u64::from(known) + missing.count() as u64;
    if would_be > MAX_TILES {
        return Err(EditError::TooManyTiles {
            tiles: would_be,
            most: MAX_TILES,
        });
    }
    let values = changed(terrain, edits, edit, &window);
    let (mut now, mut made) = (edits.clone(), 0);
    for place in tiles {
        if let Some(tile) = tile_with(edits, place, &window, width, &values) {
            now = now.with_tile(place, tile);
            made += 1;
        }
    }
    let samples = (width * height) as u64;
    let terrain = if made == 0 {
        terrain.clone()
    } else {
        terrain.with_edits(Some(now))
    };
    Ok(Edited {
        terrain,
        samples,
        tiles: made,
    })
}

/// A tile with the samples of a window in it; `None` where that changes nothing.
fn tile_with(
    edits: &Edits,
    place: [u32; 2],
    window: &Window,
    width: usize,
    values: &[i32],
) -> Option<Option<Tile>> {
    let before = edits.tile(place);
    let mut steps: Box<[i32]> = before.map_or_else(
        || vec![0; SAMPLES].into_boxed_slice(),
        |tile| tile.steps().into(),
    );
    let first = place.map(|k| i64::from(k) * i64::from(CELLS) - 1);
    let mut differs = false;
    let end = [0, 1].map(|k| window.last[k].min(first[k] + SIDE as i64 - 1));
    for z in window.first[1].max(first[1])..=end[1] {
        for x in window.first[0].max(first[0])..=end[0] {
            let value =
                values[(z - window.first[1]) as usize * width + (x - window.first[0]) as usize];
            let own = &mut steps[(z - first[1]) as usize * SIDE + (x - first[0]) as usize];
            differs |= *own != value;
            *own = value;
        }
    }
    differs.then(|| Tile::new(steps))
}

/// The rectangle that an edit reaches, metres.
impl Edit {
    /// Where it can change the ground, with what interpolation reaches.
    #[must_use]
    pub fn rect(&self, lattice: &EditLattice) -> GroundRect {
        let reach = DVec2::splat(self.radius) + 2.0 * lattice.spacing();
        GroundRect::new(self.place - reach, self.place + reach)
    }
}
