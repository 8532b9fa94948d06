//! What a conversion says about itself: what was made, how exact it is, and what is lost.

use crate::options::Compression;
use serde::Serialize;

/// Something that the glTF file does not hold.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Lost {
    /// A fixed word for the kind of thing, for programs: `dual-quaternion`, `constraint`, ...
    pub what: &'static str,
    /// Its name in the file, or how many there are.
    pub name: String,
    /// How far vertices are from where they should be at most, metres, where that is what is lost.
    pub metres: Option<f64>,
    /// One sentence.
    pub detail: String,
}

/// One clip of the result.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ClipReport {
    /// Name of the animation stack.
    pub name: String,
    /// Seconds.
    pub seconds: f64,
    /// Keys of all channels.
    pub keys: usize,
    /// Keys that a bake of every moving channel at the clip's samples would hold.
    pub baked: usize,
    /// No point is farther from where the FBX file's own curves have it than this while the keys are played, metres, at any time of the
    /// clip, within frames too: six points 3 cm around each node, and all vertices. A bound, by how fast both motions change
    /// between neighbouring keys; the largest distance that was seen is a few hundredths less (within frames up to a third), and where
    /// meshes with morph targets are large no more than what sixteen vertices beside each other differ by. At a jump neither side
    /// counts for two steps of f32 (0.15 microseconds at least).
    pub error: f64,
    /// The same without what lies within frames of files that have a key in every frame, unless
    /// [`Options::within_frames`](crate::Options::within_frames) asks for that: this is held to the bound.
    pub keyed_error: f64,
    /// Times that were looked at for both.
    pub samples: usize,
    /// The share of the clip's time for which [`ClipReport::error`] may be far above what is so: the check's work, which is counted and
    /// grows with the file, came to its limit before errors were known to a few hundredths. 0 for nearly all files.
    pub unseen: f64,
}

/// What came of a conversion.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Report {
    /// Version of the FBX file, 7400 for 7.4.
    pub version: u32,
    /// Program that wrote it, as far as it says so.
    pub creator: String,
    /// Metres that one unit of the file stands for.
    pub unit: f64,
    /// Diagonal of the box around everything at rest, metres.
    pub size: f64,
    /// Nodes of the result, helper nodes among them.
    pub nodes: usize,
    /// Nodes that are joints of a skin.
    pub joints: usize,
    /// Vertices of the result.
    pub vertices: usize,
    /// Triangles of the result.
    pub triangles: usize,
    /// The bound that keys were held to, metres: the smaller of the two that were asked for.
    pub bound: f64,
    /// Clips, in the order of the file.
    pub clips: Vec<ClipReport>,
    /// Vertices that follow more joints in the file than in the result.
    pub refitted: usize,
    /// How far those are from the file's deformation at most, metres: at rest and at any time of the clips. A
    /// bound; where meshes with morph targets and clips are large together it may be far above what is so.
    pub weight_error: f64,
    /// The same for the largest weights, renormalised, over the poses that weights were fitted to, metres.
    pub largest_weights_error: f64,
    /// How far vertices, lights and cameras at rest are from the file's at most because f32 rounds their
    /// positions, their nodes and their bind matrices, metres.
    pub position_error: f64,
    /// How far vertices are moved by rounding them for [`Compression::Meshopt`] at most, metres; 0 without it, and where
    /// that saves nothing.
    pub rounding_error: f64,
    /// What glTF cannot carry, or what was not found.
    pub lost: Vec<Lost>,
    /// Bytes of keys and their times in the result, as they are written.
    pub animation_bytes: usize,
    /// How bytes are written.
    pub compression: Compression,
    /// [`Compression::Meshopt`] was asked for, and the file is written plainly, since it would be no smaller compressed.
    pub plain_is_smaller: bool,
}

impl Report {
    pub(crate) fn lose(&mut self, what: &'static str, name: &str, detail: impl Into<String>) {
        self.lost.push(Lost {
            what,
            name: name.to_owned(),
            metres: None,
            detail: detail.into(),
        });
    }

    /// The largest of the clips' errors, and what refitted weights and rounding add, metres.
    pub fn error(&self) -> f64 {
        let clips = self.clips.iter().map(|clip| clip.error);
        let adds = self.weight_error + self.position_error + self.rounding_error;
        clips.fold(0.0, f64::max) + adds
    }

    /// Keys in all clips.
    pub fn keys(&self) -> usize {
        self.clips.iter().map(|clip| clip.keys).sum()
    }

    /// Keys that a bake would have, in all clips.
    pub fn baked(&self) -> usize {
        self.clips.iter().map(|clip| clip.baked).sum()
    }
}
