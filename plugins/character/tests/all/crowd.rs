//! Palettes: what is baked is what is sampled, and what is refused.

use crate::support;

use bevy::math::Vec3;
use dolomite_character::crowd::{CrowdFigure, Palette, PaletteError, skin};
use dolomite_character::{Pose, Sampler};
use support::{Random, person};

#[test]
fn a_palette_is_the_clip_between_its_frames_too() {
    let rig = person::rig_with_mesh();
    let mut random = Random::new(31);
    let clips: Vec<usize> = (0..rig.clips.len()).collect();
    let mesh = &rig.meshes[0];
    let (mut sampler, mut pose, mut model) = (Sampler::new(), Pose::default(), Vec::new());
    let errors = [30.0, 120.0, 480.0].map(|rate| {
        let palette = Palette::bake(&rig, 0, &clips, rate).unwrap();
        assert_eq!(palette.bytes(), palette.rows.len() * 16);
        let mut worst = 0.0_f32;
        for _ in 0..400 {
            let clip = random.below(clips.len());
            let time = random.range(0.0, 3.0 * rig.clips[clip].duration());
            let frame = palette.frame(clip, time, true);
            // The moment that 256ths of a frame say.
            let of = &palette.clips[clip];
            let at = f32::from(frame.frame) - of.first as f32 + f32::from(frame.part) / 256.0;
            let moment = at / (of.frames - 1) as f32 * of.duration;
            let near = (moment - rig.clips[clip].looped(time)).abs();
            assert!(
                near <= of.duration / (of.frames - 1) as f32 / 255.0 + 1e-5,
                "{near}"
            );
            sampler.sample(&rig.clips[clip], moment, &mut pose);
            rig.skeleton.local_to_model(&pose, &mut model);
            let figure = CrowdFigure::new(Vec3::ZERO, 0.0, frame, 0);
            for vertex in 0..mesh.positions.len() {
                let position = Vec3::from(mesh.positions[vertex]);
                let rows =
                    skin::vertex_rows(&palette, &figure, mesh.joints[vertex], mesh.weights[vertex]);
                let mut truth = Vec3::ZERO;
                for (joint, weight) in mesh.joints[vertex].iter().zip(mesh.weights[vertex]) {
                    let joint = usize::from(*joint);
                    let bind = rig.skins[0].inverse_binds[joint];
                    truth += weight * (model[joint] * bind).transform_point3(position);
                }
                worst = worst.max(skin::skinned_position(&rows, position).distance(truth));
            }
        }
        worst
    });
    eprintln!("palette against clip: {errors:?} m at 30, 120, 480 frames a second");
    // A foot that lands or leaves changes its speed by up to 5 m/s from key to key; a frame that falls
    // beside such a key misses it by a quarter of 5 m/s · 1/30 s. So four times the frames, a quarter of
    // the error; the clip's own keys, 60 a second, are straight between.
    assert!(
        errors[0] < 0.042 && errors[1] < 0.042 / 4.0 && errors[2] < 0.042 / 16.0,
        "{errors:?}"
    );
}

#[test]
fn moments_outside_of_clips() {
    let rig = person::rig_with_mesh();
    let palette = Palette::bake(&rig, 0, &[1, 5], 30.0).unwrap();
    let last = &palette.clips[1];
    for time in [f32::NAN, f32::INFINITY, -1.0, 1e30] {
        for clip in [0, 1, 9] {
            for repeats in [false, true] {
                let frame = palette.frame(clip, time, repeats);
                // The next frame is there too.
                assert!(u32::from(frame.frame) + 1 < last.first + last.frames);
            }
        }
    }
    let end = palette.frame(1, 99.0, false);
    assert_eq!(
        (u32::from(end.frame), end.part),
        (last.first + last.frames - 2, 255)
    );
}

#[test]
fn what_cannot_be_baked_is_refused() {
    let rig = person::rig_with_mesh();
    assert!(matches!(
        Palette::bake(&rig, 1, &[0], 30.0),
        Err(PaletteError::Missing { what: "skin", .. })
    ));
    assert!(matches!(
        Palette::bake(&rig, 0, &[99], 30.0),
        Err(PaletteError::Missing { what: "clip", .. })
    ));
    for rate in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert!(matches!(
            Palette::bake(&rig, 0, &[0], rate),
            Err(PaletteError::Rate(_))
        ));
    }
    let refusal = Palette::bake(&rig, 0, &[0], 1e6).unwrap_err();
    assert!(matches!(refusal, PaletteError::TooManyFrames(frames) if frames > 65_536));
}
