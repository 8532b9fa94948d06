//! What cannot be edited, and files that cannot be read.

use bevy::math::DVec2;
use std::path::PathBuf;
use thiserror::Error;

/// An edit that was not made: the ground is as it was.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum EditError {
    /// A place that is not finite.
    #[error("the place of an edit is {0}: two finite numbers of metres are needed")]
    Place(DVec2),
    /// A radius that is none.
    #[error("the radius of an edit is {0} m: a finite number above 0 is needed")]
    Radius(f64),
    /// A strength that is none.
    #[error("the strength of an edit is {found}: {wanted} is needed")]
    Strength {
        /// What it was.
        found: f64,
        /// What it may be.
        wanted: &'static str,
    },
    /// A falloff beyond 0 to 1.
    #[error("the falloff of an edit is {0}: a share of the radius from 0 to 1 is needed")]
    Falloff(f64),
    /// A height that is none.
    #[error(
        "the height to flatten to is {0} m: a finite number of at most 1e6 either way is needed"
    )]
    Height(f64),
    /// A brush that holds too many samples.
    #[error(
        "a brush of {radius} m holds {samples:.0} samples, {most} at most can be edited at once: take a smaller radius"
    )]
    TooManySamples {
        /// Of the brush, metres.
        radius: f64,
        /// About how many.
        samples: f64,
        /// The limit.
        most: u64,
    },
    /// Too much edited altogether.
    #[error(
        "{tiles} tiles would be edited, {most} at most can be: undo some, or edit a smaller part of the ground"
    )]
    TooManyTiles {
        /// How many there would be.
        tiles: u64,
        /// The limit.
        most: u64,
    },
    /// Ground that is too large, or whose samples are too close, for a lattice of edits.
    #[error("ground of {size} m with samples {spacing} m apart is too large to be edited")]
    Lattice {
        /// Of the extent, metres.
        size: DVec2,
        /// Of samples, metres.
        spacing: DVec2,
    },
}

/// A file of edits that was not read or written: the ground is as it was.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum EditFileError {
    /// The system refuses it.
    #[error("{}: {what}", file.display())]
    Io {
        /// Which file.
        file: PathBuf,
        /// What the system says.
        what: String,
    },
    /// Another kind of file.
    #[error("{}: not a file of edits (it does not begin with DOLEDITS)", file.display())]
    Foreign {
        /// Which file.
        file: PathBuf,
    },
    /// Of a later version.
    #[error("{}: version {version} of files of edits, this program reads {known}: update it", file.display())]
    Newer {
        /// Which file.
        file: PathBuf,
        /// Its version.
        version: u32,
        /// The newest that is read.
        known: u32,
    },
    /// It ends too early.
    #[error("{}: it ends at byte {at}, in the middle of {what}: take a copy that is whole", file.display())]
    Truncated {
        /// Which file.
        file: PathBuf,
        /// Its length, bytes.
        at: usize,
        /// What is cut.
        what: &'static str,
    },
    /// What it says cannot be.
    #[error("{}: byte {at}: {what}: take a copy that is whole", file.display())]
    Damaged {
        /// Which file.
        file: PathBuf,
        /// Where, bytes.
        at: usize,
        /// What is wrong.
        what: &'static str,
    },
    /// Made over other ground.
    #[error("{}: it was made over ground with other samples: load it with the scene that it was saved for", file.display())]
    OtherGround {
        /// Which file.
        file: PathBuf,
    },
}
