//! Files that are cut off or changed: an error that names the file, or other samples; never a panic.

use crate::{folder, read};
use dolomite_elevation::{Elevation, NumberType, Options, Raw};

/// One of each way of storing, and how it is read.
const FILES: [&str; 21] = [
    "u16-gdal.png",
    "u8-pypng-interlaced.png",
    "n16-pypng-trns-interlaced.png",
    "u16-pypng-colour.png",
    "i16-gdal.asc",
    "i16-numpy.raw",
    "i16-gdal-strips.tif",
    "i16-gdal-big.tif",
    "i16-gdal-packbits.tif",
    "i16-gdal-lzw-p2-tiles.tif",
    "u32-gdal-deflate-p2-tiles.tif",
    "f32-gdal-lzw-p3-tiles.tif",
    "f64-gdal-deflate-p3-tiles.tif",
    "f32-gdal-bigtiff-big-tiles.tif",
    "f32-gdal-cog.tif",
    "u16-gdal-bands-band.tif",
    "u16-gdal-bands-pixel.tif",
    "u16-tifffile-white.tif",
    "i16-gdal-sparse-none.tif",
    "i16-gdal-scaled.tif",
    "h16-gdal-nodata.tif",
];

fn options(name: &str) -> Options {
    let raw = Raw {
        size: Some([41, 37]),
        number: Some(NumberType::I16),
        ..Raw::default()
    };
    Options {
        raw: name.ends_with(".raw").then_some(raw),
        band: (name.contains("-bands-") || name.contains("-colour")).then_some(1),
        ..Options::default()
    }
}

/// Reads the bytes; an error must name the file.
fn take(name: &str, bytes: &[u8]) -> bool {
    match Elevation::decode(name, bytes, &options(name)) {
        Ok(map) => {
            let samples = map.size[0] as usize * map.size[1] as usize;
            assert_eq!(map.samples.len(), samples, "{name}");
            true
        }
        Err(error) => {
            let text = error.to_string();
            assert!(text.contains(name), "{text}");
            false
        }
    }
}

#[test]
fn every_truncation_is_an_error() {
    for name in FILES {
        let bytes = std::fs::read(folder().join(name)).expect("it is there");
        assert!(take(name, &bytes), "{name}");
        for cut in 0..bytes.len() {
            let whole = take(name, &bytes[..cut]);
            // Of a grid of text the last number may be shorter, nothing tells; a TIFF with tags or pictures that are not of the samples.
            let spare = name.ends_with(".asc") && cut + 6 >= bytes.len();
            let spare =
                spare || name.ends_with(".tif") && whole && same_samples(name, &bytes[..cut]);
            assert!(!whole || spare, "{name} cut at {cut} of {}", bytes.len());
        }
    }
}

fn same_samples(name: &str, bytes: &[u8]) -> bool {
    let cut = Elevation::decode(name, bytes, &options(name)).expect("it was read before");
    let whole = read(name, &options(name)).expect("valid");
    crate::same(&cut.samples, &whole.samples)
}

#[test]
fn flipped_bytes_never_panic() {
    let mut read = [0, 0];
    for name in FILES {
        let bytes = std::fs::read(folder().join(name)).expect("it is there");
        for at in 0..bytes.len() {
            // Headers byte by byte, data here and there.
            if at > 300 && at + 400 < bytes.len() && at % 29 != 0 {
                continue;
            }
            for flip in [0xff, 0x01] {
                let mut changed = bytes.clone();
                changed[at] ^= flip;
                read[usize::from(take(name, &changed))] += 1;
            }
        }
    }
    println!("refused {}, read {}", read[0], read[1]);
    assert!(read[0] > 1000 && read[1] > 1000, "{read:?}");
}

/// Bytes that follow from nothing, behind each beginning that is known.
#[test]
fn noise_never_panics() {
    let heads: [&[u8]; 7] = [
        b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR",
        b"II\x2a\0\x08\0\0\0",
        b"MM\0\x2a\0\0\0\x08",
        b"II\x2b\0\x08\0\0\0\x10\0\0\0\0\0\0\0",
        b"ncols 4\nnrows 4\n",
        b"NROWS ",
        b"",
    ];
    let mut seed = 1_u64;
    for k in 0..20_000_usize {
        let mut bytes = heads[k % heads.len()].to_vec();
        for _ in 0..k % 257 {
            seed = seed
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            bytes.push((seed >> 33) as u8);
        }
        take("noise.tif", &bytes);
    }
}
