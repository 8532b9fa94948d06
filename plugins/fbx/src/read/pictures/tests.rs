//! Pictures that are turned into PNG, and those that are not.

use super::*;

/// Two by two pixels of a true-colour TGA: a row from the lower left, then one above.
fn tga(bits: u8, alpha_bits: u8, pixels: &[u8]) -> Vec<u8> {
    let mut out = vec![
        0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 2, 0, 2, 0, bits, alpha_bits,
    ];
    out.extend(pixels);
    out
}

fn decoded(picture: Result<Picture, String>) -> image::DynamicImage {
    match picture {
        Ok(Picture::Turned(png)) => {
            assert_eq!(mime(&png), Some("image/png"));
            image::load_from_memory(&png).expect("a PNG is read")
        }
        other => panic!("not turned: {other:?}"),
    }
}

#[test]
fn a_tga_is_turned_with_its_rows_and_colours() {
    // Blue, green, red.
    let pixels = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12];
    let made = decoded(picture("a.TGA", &tga(24, 0, &pixels), 1 << 20));
    assert_eq!(made.color(), image::ColorType::Rgb8);
    let made = made.to_rgb8();
    assert_eq!(made.get_pixel(0, 1).0, [3, 2, 1]);
    assert_eq!(made.get_pixel(1, 0).0, [12, 11, 10]);
    // By its footer, whatever it is called.
    let mut named = tga(24, 0, &pixels);
    named.extend([0; 8]);
    named.extend(b"TRUEVISION-XFILE.\0");
    decoded(picture("a", &named, 1 << 20));
    // From the lower right, and of 16 bits.
    let mirrored = decoded(picture("a.tga", &tga(24, 0x10, &pixels), 1 << 20));
    assert_eq!(mirrored.to_rgb8().get_pixel(0, 1).0, [6, 5, 4]);
    let words = [0x1f, 0, 0xe0, 3, 0, 0x7c, 0xff, 0x7f];
    let short = decoded(picture("a.tga", &tga(16, 0, &words), 1 << 20));
    assert_eq!(short.color(), image::ColorType::Rgb8);
    assert_eq!(short.to_rgb8().get_pixel(0, 1).0, [0, 0, 255]);
}

#[test]
fn alpha_is_kept_where_it_is_one() {
    let pixels: Vec<u8> = (0..4).flat_map(|i| [i, i, i, 60 * i]).collect();
    let with = decoded(picture("a.tga", &tga(32, 8, &pixels), 1 << 20));
    assert_eq!(with.to_rgba8().get_pixel(1, 1).0, [1, 1, 1, 60]);
    assert!(with.color().has_alpha());
    // The descriptor says that there is none, or nobody has set it.
    let unused = decoded(picture("a.tga", &tga(32, 0, &pixels), 1 << 20));
    assert!(!unused.color().has_alpha());
    let zero: Vec<u8> = (0..4).flat_map(|i| [i, i, i, 0]).collect();
    let even = decoded(picture("a.tga", &tga(32, 8, &zero), 1 << 20));
    assert!(!even.color().has_alpha());
    assert_eq!(even.to_rgb8().get_pixel(1, 1).0, [1, 1, 1]);
}

#[test]
fn a_bmp_is_turned() {
    let mut bmp = Vec::new();
    let made = image::RgbImage::from_fn(3, 2, |x, y| image::Rgb([x as u8, y as u8, 7]));
    image_of_old::codecs::bmp::BmpEncoder::new(&mut bmp)
        .encode(&made, 3, 2, ColorType::Rgb8)
        .expect("it is written");
    assert_eq!(decoded(picture("a", &bmp, 1 << 20)).to_rgb8(), made);
}

#[test]
fn bombs_and_broken_ones_are_refused() {
    // 65535 by 65535 pixels, run-length encoded, in 18 bytes.
    let mut bomb = tga(32, 8, &[]);
    bomb[2] = 10;
    bomb[12..16].fill(0xff);
    let said = picture("a.tga", &bomb, 1 << 26).unwrap_err();
    assert!(said.contains("raise the limit on memory"), "{said}");
    for name in ["a.tga", "a.bmp"] {
        for bytes in [&b"BM"[..], &[0; 30], &tga(24, 0, &[1]), &[]] {
            picture(name, bytes, 1 << 20).unwrap_err();
        }
    }
    // Noise, so that the PNG is no smaller than its pixels: what it may take holds for it too.
    let mut state = 1_u32;
    let noise: Vec<u8> = (0..3 << 16)
        .map(|_| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 24) as u8
        })
        .collect();
    let mut large = tga(24, 0, &noise);
    large[12..16].copy_from_slice(&[0, 1, 0, 1]);
    let bytes = large.len() as u64;
    assert!(picture("a.tga", &large, 2 * bytes).is_err());
    assert!(picture("a.tga", &large, 4 * bytes).is_ok());
}

#[test]
fn other_kinds_are_named_with_a_way_out() {
    let cases: [(&[u8], &str); 5] = [
        (b"8BPS\0\x01", "PSD"),
        (b"II*\0\x08", "TIFF"),
        (b"DDS |", "DDS"),
        (b"\x76\x2f\x31\x01\x02", "EXR"),
        (b"what is this", "unknown"),
    ];
    for (bytes, kind) in cases {
        let said = picture("a.xyz", bytes, 1 << 20).unwrap_err();
        assert!(
            said.contains(kind) && said.contains("save it as PNG"),
            "{said}"
        );
    }
    assert_eq!(saved_again("tex/a.psd")[..2], ["tex/a.png", "tex/a.jpg"]);
    assert!(saved_again("a.PNG").is_empty() && saved_again("").is_empty());
    assert_eq!(saved_again("a")[0], "a.png");
}

#[test]
fn broken_pictures_are_told_apart() {
    assert_eq!(mime(b"\x89PNG\r\n\x1a\n"), None);
    assert_eq!(mime(b"BM"), None);
    assert_eq!(mime(b""), None);
    assert_eq!(mime(&[0xff, 0xd8, 0xff, 0xe0, 0, 2]), None);
    let jpeg = [
        0xff, 0xd8, 0xff, 0xe0, 0, 2, 0xff, 0xc0, 0, 11, 8, 0, 1, 0, 1, 0,
    ];
    assert_eq!(mime(&jpeg), Some("image/jpeg"));
    let said = picture("a.png", b"\x89PNG\r\n\x1a\n", 1 << 20).unwrap_err();
    assert!(said.contains("broken PNG"), "{said}");
}
