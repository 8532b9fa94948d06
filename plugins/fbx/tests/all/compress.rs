//! `EXT_meshopt_compression`: what is written comes back, keeps to the bound, and is smaller.

use crate::support::ascii::strip;
use crate::support::chain::chain;
use crate::support::{files_below, shared_fbx};
use dolomite_fbx::check::{Played, PlayedError, Truth, check_file, vertex_error};
use dolomite_fbx::{Compression, Conversion, Effort, Options, Origin, Report, convert};
use std::path::{Path, PathBuf};

fn options(compress: Compression) -> Options<'static> {
    Options {
        max_error: 1e-4,
        max_relative_error: f64::INFINITY,
        effort: Effort::Thorough,
        compress,
        ..Options::default()
    }
}

fn converted(bytes: &[u8], compress: Compression) -> Conversion {
    convert(bytes, &Origin::default(), &options(compress)).expect("a sound file")
}

/// What is held to the bound: keys on the file's own, and rounded vertices.
fn keyed(report: &Report) -> f64 {
    let clips = report.clips.iter().map(|clip| clip.keyed_error);
    clips.fold(0.0, f64::max) + report.rounding_error
}

fn hero() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/hero/hero.fbx")
}

/// The JSON chunk of a .glb.
fn json(glb: &[u8]) -> serde_json::Value {
    let length = u32::from_le_bytes(glb[12..16].try_into().expect("four bytes")) as usize;
    serde_json::from_slice(&glb[20..20 + length]).expect("JSON")
}

/// Between the file's keys, which are a second apart, and on them; all vertices.
#[test]
fn the_bound_holds_on_what_is_decoded() {
    for text in [chain([0, 1, 2]), chain([1, 1, 1]), strip(170.0)] {
        let made = converted(text.as_bytes(), Compression::Meshopt);
        let report = &made.report;
        assert!(keyed(report) <= report.bound, "{report:?}");
        let played = Played::read(&made.to_glb().unwrap()).unwrap();
        let truth = Truth::load(text.as_bytes(), &Origin::default()).unwrap();
        let (begin, seconds) = (made.model.clips[0].begin, made.model.clips[0].duration);
        for step in 0..=240 {
            let time = seconds * f64::from(step) / 240.0;
            let (shapes, _) = played.at(Some(0), time);
            let (bodies, _) = truth.at(Some(0), begin + time).unwrap();
            let error = vertex_error(&shapes, &bodies, &truth.space(), &made.sources());
            let allowed = report.bound + 1e-6 * report.size;
            assert!(
                error <= allowed,
                "at {time}: {error:e} m, {allowed:e} allowed"
            );
        }
    }
}

/// What the decoder gives back is what the error was measured on, to the last bit.
#[test]
fn what_is_written_comes_back_bit_for_bit() {
    let bytes = std::fs::read(hero()).unwrap();
    for bytes in [
        bytes,
        strip(90.0).into_bytes(),
        chain([0, 1, 2]).into_bytes(),
    ] {
        let quick = Options {
            effort: Effort::Quick,
            ..options(Compression::Meshopt)
        };
        let mut made = convert(&bytes, &Origin::default(), &quick).unwrap();
        let packed = Played::read(&made.to_glb().unwrap()).unwrap();
        // The same model written plainly.
        made.report.compression = Compression::None;
        let plain = Played::read(&made.to_glb().unwrap()).unwrap();
        assert_eq!(packed.clips(), plain.clips());
        for clip in 0..plain.clips().len() {
            for step in 0..=20 {
                let time = plain.clips()[clip].1 * f64::from(step) / 20.0;
                assert_eq!(packed.at(Some(clip), time), plain.at(Some(clip), time));
            }
        }
    }
}

#[test]
fn a_compressed_file_is_smaller_and_says_what_it_needs() {
    let bytes = std::fs::read(hero()).unwrap();
    let quick = |compress| {
        let options = Options {
            effort: Effort::Quick,
            ..options(compress)
        };
        convert(&bytes, &Origin::default(), &options).unwrap()
    };
    let (plain, packed) = (quick(Compression::None), quick(Compression::Meshopt));
    assert!(keyed(&packed.report) <= packed.report.bound);
    let (small, large) = (packed.to_glb().unwrap(), plain.to_glb().unwrap());
    let (few, many) = (packed.report.animation_bytes, plain.report.animation_bytes);
    println!(
        "{} of {} bytes, clips {few} of {many}",
        small.len(),
        large.len()
    );
    assert!(few * 10 < many * 8, "clips: {few} of {many} bytes");
    assert!(small.len() < large.len());
    assert_eq!(Played::read(&small).unwrap().animation_bytes(), few);
    assert!(Played::read(&large).unwrap().animation_bytes() <= many);
    let root = json(&small);
    for key in ["extensionsUsed", "extensionsRequired"] {
        let names = root[key].as_array().unwrap();
        assert!(
            names.iter().any(|name| name == "EXT_meshopt_compression"),
            "{key}"
        );
    }
    // The second buffer is that of readers without the extension: it has no bytes, and says so.
    let buffers = root["buffers"].as_array().unwrap();
    assert_eq!(buffers.len(), 2);
    assert!(buffers[1].get("uri").is_none());
    assert_eq!(
        buffers[1]["extensions"]["EXT_meshopt_compression"]["fallback"],
        true
    );
    // And the same bytes each time, for any number of threads.
    let one = Options {
        threads: 1,
        effort: Effort::Quick,
        ..options(Compression::Meshopt)
    };
    let again = convert(&bytes, &Origin::default(), &one).unwrap();
    assert_eq!(again.to_glb().unwrap(), small);
}

/// A fingerprint of what was written before there was anything to ask for.
#[test]
fn without_the_option_nothing_changes() {
    let made = convert(
        strip(90.0).as_bytes(),
        &Origin::default(),
        &Options::default(),
    )
    .unwrap();
    let root = json(&made.to_glb().unwrap());
    assert!(root.get("extensionsUsed").is_none() && root.get("extensionsRequired").is_none());
    assert_eq!(root["buffers"].as_array().unwrap().len(), 1);
    let views = root["bufferViews"].as_array().unwrap();
    assert!(views.iter().all(|view| view.get("extensions").is_none()));
    assert_eq!(made.report.rounding_error, 0.0);
}

#[test]
fn a_gltf_with_files_has_them_too() {
    let made = converted(strip(90.0).as_bytes(), Compression::Meshopt);
    let files = made.to_gltf("strip");
    let root: serde_json::Value = serde_json::from_slice(&files.json).unwrap();
    let buffers = root["buffers"].as_array().unwrap();
    assert_eq!(buffers[0]["uri"], "strip.bin");
    assert_eq!(buffers[0]["byteLength"], files.files[0].1.len());
    assert!(buffers.len() == 1 || buffers[1].get("uri").is_none());
}

/// Every byte of the compressed views turned over, and every number of the JSON that describes them.
#[test]
fn broken_compressed_data_is_refused_or_read() {
    let bytes = std::fs::read(hero()).unwrap();
    let quick = Options {
        effort: Effort::Quick,
        ..options(Compression::Meshopt)
    };
    let glb = convert(&bytes, &Origin::default(), &quick)
        .unwrap()
        .to_glb()
        .unwrap();
    assert!(Played::read(&glb).is_ok());
    let begin = 20 + u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    let mut refused = 0;
    for at in (begin + 8..glb.len()).step_by(997) {
        let mut broken = glb.clone();
        broken[at] ^= 0xff;
        refused += usize::from(Played::read(&broken).is_err());
    }
    // The first byte of each view is its version.
    let root = json(&glb);
    for view in root["bufferViews"].as_array().unwrap() {
        let how = &view["extensions"]["EXT_meshopt_compression"];
        let Some(length) = how["byteLength"].as_u64() else {
            continue;
        };
        let offset = how["byteOffset"].as_u64().unwrap();
        let mut broken = glb.clone();
        broken[begin + 8 + offset as usize] = 0;
        let refusal = Played::read(&broken).err();
        assert!(
            matches!(refusal, Some(PlayedError::Compressed { .. })),
            "{length}"
        );
        refused += 1;
    }
    assert!(refused > 10, "{refused}");
    let views = root["bufferViews"].as_array().unwrap();
    let name = "EXT_meshopt_compression";
    let first = views
        .iter()
        .position(|view| view["extensions"][name]["filter"] == "EXPONENTIAL");
    for (key, value) in [
        ("mode", "ATTRIBUTE".into()),
        ("filter", "EXPONENT".into()),
        ("byteStride", 13.into()),
        ("byteStride", 0.into()),
        ("count", 1.into()),
        ("count", u64::MAX.into()),
        ("byteOffset", u64::MAX.into()),
        ("byteLength", u64::MAX.into()),
        ("byteLength", 3.into()),
        ("buffer", 1.into()),
    ] {
        let mut changed = root.clone();
        let view = &mut changed["bufferViews"][first.expect("times are kept so")];
        let value: serde_json::Value = value;
        view["extensions"][name][key] = value.clone();
        let mut text = serde_json::to_vec(&changed).unwrap();
        text.resize(text.len().next_multiple_of(4), b' ');
        let mut broken = glb[..12].to_vec();
        broken.extend((text.len() as u32).to_le_bytes());
        broken.extend(b"JSON");
        broken.extend(&text);
        broken.extend(&glb[begin..]);
        let length = broken.len() as u32;
        broken[8..12].copy_from_slice(&length.to_le_bytes());
        let refusal = Played::read(&broken).err();
        let typed = matches!(refusal, Some(PlayedError::Compressed { .. }));
        assert!(typed, "{key} {value}: {refusal:?}");
    }
}

/// Every file that can be read keeps to its bound at its own frames, vertex by vertex, and to its plain size.
#[test]
fn shared_files_keep_to_the_bound() {
    let Some(folder) = shared_fbx() else { return };
    let (mut checked, mut few, mut many) = (0, 0, 0);
    for path in files_below(&folder) {
        let quick = |compress| Options {
            effort: Effort::Quick,
            ..options(compress)
        };
        let Ok(check) = check_file(&path, &[], 20, &quick(Compression::Meshopt)) else {
            continue;
        };
        let plain = check_file(&path, &[], 1, &quick(Compression::None)).unwrap();
        let (report, name) = (&check.conversion.report, path.display());
        assert!(
            keyed(report) <= report.bound || report.refitted > 0,
            "{name}: {report:?}"
        );
        let bytes = report.animation_bytes;
        assert!(
            bytes <= plain.conversion.report.animation_bytes,
            "{name}: {bytes}"
        );
        few += bytes;
        many += plain.conversion.report.animation_bytes;
        checked += 1;
    }
    println!("{checked} files, {few} of {many} bytes");
    assert!(
        checked > 20 && few * 10 < many * 7,
        "{checked}: {few} of {many}"
    );
}
