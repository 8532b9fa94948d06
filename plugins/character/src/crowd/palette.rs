//! Palettes: matrices of a skin's joints for every frame of some clips.

use crate::clip::Sampler;
use crate::load::Rig;
use crate::pose::Pose;
use bevy::math::Affine3A;
use thiserror::Error;

/// Matrices of a skin's joints, from the mesh's frame at rest to the model's, for every frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Palette {
    /// Joints of a frame.
    pub joints: u32,
    /// Frame after frame, joint after joint, three rows each: what the GPU holds.
    pub rows: Vec<[f32; 4]>,
    /// The baked clips, in the order that was asked for.
    pub clips: Vec<PaletteClip>,
}

/// A clip in a palette.
#[derive(Clone, Debug, PartialEq)]
pub struct PaletteClip {
    /// Its name.
    pub name: String,
    /// Its first frame.
    pub first: u32,
    /// Its frames; the last is the clip's end. At least two.
    pub frames: u32,
    /// Seconds.
    pub duration: f32,
}

/// Where in a palette a moment lies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PaletteFrame {
    /// The frame before.
    pub frame: u16,
    /// 256ths of the way to the next one.
    pub part: u8,
}

/// Why there is no palette.
#[derive(Clone, Debug, Error, PartialEq)]
pub enum PaletteError {
    /// No such skin or clip.
    #[error("a palette of {what} {index}, but the model has {count}")]
    Missing {
        /// Skin or clip.
        what: &'static str,
        /// What was asked for.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A rate that is none.
    #[error("a palette of {0} frames a second: a positive number is needed")]
    Rate(f32),
    /// More frames than a figure's 16 bits can name.
    #[error(
        "the palette would have {0} frames, more than 65536: bake fewer clips, or fewer frames a second"
    )]
    TooManyFrames(usize),
}

impl Palette {
    /// Bakes `clips` for `skin`, at least `rate` frames a second.
    ///
    /// # Errors
    /// [`PaletteError`].
    pub fn bake(rig: &Rig, skin: usize, clips: &[usize], rate: f32) -> Result<Self, PaletteError> {
        let missing = |what, index, count| PaletteError::Missing { what, index, count };
        let chosen = rig
            .skins
            .get(skin)
            .ok_or_else(|| missing("skin", skin, rig.skins.len()))?;
        if !(rate > 0.0 && rate.is_finite()) {
            return Err(PaletteError::Rate(rate));
        }
        let mut palette = Self {
            joints: chosen.joints.len() as u32,
            rows: Vec::new(),
            clips: Vec::new(),
        };
        let (mut sampler, mut pose, mut model) = (Sampler::new(), Pose::default(), Vec::new());
        let mut total = 0;
        for index in clips {
            let clip = rig
                .clips
                .get(*index)
                .ok_or_else(|| missing("clip", *index, rig.clips.len()))?;
            // A cast from f32 stops at the end of usize.
            let frames = ((clip.duration() * rate).ceil() as usize)
                .saturating_add(1)
                .max(2);
            if total + frames > 1 << 16 {
                return Err(PaletteError::TooManyFrames(total.saturating_add(frames)));
            }
            for frame in 0..frames {
                let time = clip.duration() * (frame as f32 / (frames - 1) as f32);
                sampler.sample(clip, time, &mut pose);
                rig.skeleton.local_to_model(&pose, &mut model);
                for (joint, bind) in chosen.joints.iter().zip(&chosen.inverse_binds) {
                    palette.rows.extend(rows(&(model[*joint] * *bind)));
                }
            }
            palette.clips.push(PaletteClip {
                name: clip.name().to_owned(),
                first: total as u32,
                frames: frames as u32,
                duration: clip.duration(),
            });
            total += frames;
        }
        Ok(palette)
    }

    /// Where `time` lies in its clip number `clip`: modulo its length if it `repeats`, else held at both
    /// ends. The first frame of the palette for a clip that is not there.
    #[must_use]
    pub fn frame(&self, clip: usize, time: f32, repeats: bool) -> PaletteFrame {
        let Some(clip) = self.clips.get(clip) else {
            return PaletteFrame::default();
        };
        let length = clip.duration;
        let time = match time {
            time if !time.is_finite() || length <= 0.0 => 0.0,
            time if repeats => time.rem_euclid(length),
            time => time.clamp(0.0, length),
        };
        let last = clip.frames - 1;
        let at = if length > 0.0 {
            time / length * last as f32
        } else {
            0.0
        };
        // In 256ths of a frame; the very end is 255/256 of the way to the last frame.
        let steps = ((at * 256.0).round() as u32).min(last * 256 - 1);
        PaletteFrame {
            frame: (clip.first + steps / 256) as u16,
            part: (steps % 256) as u8,
        }
    }

    /// Bytes on the GPU.
    #[must_use]
    pub fn bytes(&self) -> usize {
        size_of_val(&self.rows[..])
    }
}

fn rows(matrix: &Affine3A) -> [[f32; 4]; 3] {
    let [x, y, z] = [
        matrix.matrix3.x_axis,
        matrix.matrix3.y_axis,
        matrix.matrix3.z_axis,
    ];
    let t = matrix.translation;
    [
        [x.x, y.x, z.x, t.x],
        [x.y, y.y, z.y, t.y],
        [x.z, y.z, z.z, t.z],
    ]
}
