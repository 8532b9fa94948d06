//! Compressed or plain: whichever file is smaller is written.
//!
//! Meshes are rounded for the codec only where that saves more than it costs to say what was done. Keys that are chosen for
//! the codec may still be more bytes than those of a plain file: where the bound leaves no room to round, in clips of a few
//! keys, or where rounded vertices took a share of the bound. Where so little is saved that this may be, the clips are made
//! a second time, as a plain conversion makes them, and the two files are held beside each other.

use crate::clips::{Reduced, Samples, Shells};
use crate::conversion::Conversion;
use crate::mesh_rounding::{order_meshes, round_meshes, stretch};
use crate::model::{Mesh, Model, Trs};
use crate::options::{Budget, Compression};
use crate::write::document::{Document, Pictures, document};
use std::mem::take;

/// Meshes of more bytes than this, plain, are rounded without a look at what that saves.
const LARGE: usize = 1 << 20;

/// What rounding saves of such meshes is taken to be one byte of so many: less than it is, since their normals have a third
/// of their bits left and each triangle of theirs costs a byte or two in place of six or twelve.
const SAVED: usize = 32;

/// Meshes are kept as they were where they take no more than this share of the memory that a file may cost.
const KEPT: usize = 16;

/// Bytes of text that are said of compressed views at most, where clips have some ten views and nothing else has any.
const SAID: usize = 2048;

/// What became of meshes for the codec.
#[derive(Default)]
pub(crate) struct Rounded {
    /// How far vertices are moved at most, metres.
    pub(crate) error: f64,
    /// Bytes that are saved, at least.
    saved: usize,
    /// Meshes as they were, where they are others now and there was room to keep them.
    before: Option<Vec<Mesh>>,
}

impl Rounded {
    /// Puts meshes into the order and into the bits that the codec likes, where that makes them smaller.
    pub(crate) fn of(
        model: &mut Model,
        shells: &Shells,
        clips: &[Samples],
        bound: f64,
        budget: &Budget,
    ) -> Self {
        let plain: usize = model.meshes.iter().map(bytes).sum();
        if plain == 0 {
            return Self::default();
        }
        let stretch = stretched(model, shells, clips);
        let mut before = (plain <= budget.limits.memory / KEPT).then(|| model.meshes.clone());
        order_meshes(model);
        let error = round_meshes(model, &stretch, bound);
        let mut saved = plain / SAVED;
        if plain <= LARGE
            && let Some(kept) = before.take()
        {
            let (meshes, size) = written(take(&mut model.meshes), Compression::Meshopt);
            let (kept, plain) = written(kept, Compression::None);
            if size >= plain {
                model.meshes = kept;
                return Self::default();
            }
            model.meshes = meshes;
            saved = plain - size;
            before = Some(kept);
        }
        Self {
            error,
            saved,
            before,
        }
    }

    /// Whether a plain file may be smaller than one of `reduced`.
    pub(crate) fn is_in_doubt(&self, reduced: &[Reduced]) -> bool {
        let keys = || reduced.iter().map(|clip| clip.bytes);
        if reduced.is_empty() || self.error == 0.0 && keys().all(|keys| keys.same) {
            return false;
        }
        let plain: usize = keys().map(|keys| keys.plain).sum();
        let chosen: usize = keys().map(|keys| keys.chosen).sum();
        // Keys of a plain file have the bound for themselves. The quick search takes the first keys that use a third of theirs,
        // so that a slightly larger bound may need half of the keys.
        let fewer = if self.error > 0.0 { plain / 2 } else { 0 };
        self.saved + plain < chosen + fewer + SAID
    }

    /// The model with meshes as they were and without its pictures; `None` where there was no room to keep them.
    pub(crate) fn plain(&mut self, model: &mut Model) -> Option<Model> {
        if self.error > 0.0 && self.before.is_none() {
            return None;
        }
        let (meshes, images) = (take(&mut model.meshes), take(&mut model.images));
        let mut plain = model.clone();
        plain.meshes = self.before.take().unwrap_or_else(|| meshes.clone());
        (model.meshes, model.images) = (meshes, images);
        Some(plain)
    }
}

/// Bytes of a file of these meshes alone; gives them back.
fn written(meshes: Vec<Mesh>, compression: Compression) -> (Vec<Mesh>, usize) {
    let model = Model {
        meshes,
        ..Model::default()
    };
    let size = document(&model, &Pictures::Inside, compression).size();
    (model.meshes, size)
}

/// Bytes of a mesh, about.
fn bytes(mesh: &Mesh) -> usize {
    let of = |part: &crate::model::Part| {
        let vertex = 24
            + if part.tangents.is_empty() { 0 } else { 16 }
            + 8 * part.uvs.len()
            + 16 * part.colours.len()
            + 20 * part.joints.len()
            + 24 * part.offsets.len();
        part.positions.len() * vertex + part.indices.len() * 4
    };
    mesh.parts.iter().map(of).sum()
}

/// For each mesh, how much longer a way in it may become in the world.
fn stretched(model: &Model, shells: &Shells, clips: &[Samples]) -> Vec<f64> {
    let rest: Vec<Trs> = model.nodes.iter().map(|node| node.rest).collect();
    let mut worlds = [Vec::new()];
    shells.world(&rest, &mut worlds[0]);
    let mut all = stretch(model, worlds.iter());
    for clip in clips {
        for sample in 0..clip.grid.len() {
            let mut pose = rest.clone();
            for track in &clip.tracks {
                pose[track.node] = track.poses[sample];
            }
            shells.world(&pose, &mut worlds[0]);
            let own = stretch(model, worlds.iter());
            for (all, own) in all.iter_mut().zip(own) {
                *all = all.max(own);
            }
        }
    }
    all
}

/// The smaller of two conversions, and what its report says of how it is written. `plain` has no pictures of its own.
pub(crate) fn smaller(mut packed: Conversion, plain: Option<Conversion>) -> Conversion {
    let whole = |made: &Conversion| document(&made.model, &Pictures::Inside, Compression::Meshopt);
    let first = whole(&packed);
    let Some(mut plain) = plain else {
        return said(packed, &first);
    };
    plain.model.images = take(&mut packed.model.images);
    let second = whole(&plain);
    if second.size() <= first.size() {
        return said(plain, &second);
    }
    packed.model.images = take(&mut plain.model.images);
    said(packed, &first)
}

fn said(mut made: Conversion, document: &Document) -> Conversion {
    made.report.plain_is_smaller = !document.is_compressed();
    if made.report.plain_is_smaller {
        made.report.compression = Compression::None;
    }
    made.report.animation_bytes = document.animation_bytes();
    made
}
