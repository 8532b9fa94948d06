//! Pictures that are not embedded: where they are found, and what becomes of them.

use crate::support::looks::Looks;
use dolomite_fbx::{Conversion, Limits, Options, Origin, convert};
use std::path::{Path, PathBuf};

/// A folder of its own, which is taken away afterwards.
struct Place(PathBuf);

impl Place {
    fn new(name: &str) -> Self {
        let name = format!("dolomite_fbx_pictures_{name}_{}", std::process::id());
        let place = Self(std::env::temp_dir().join(name));
        std::fs::create_dir_all(place.0.join("own")).expect("it is made");
        place
    }

    fn put(&self, path: &str, bytes: &[u8]) {
        let path = self.0.join(path);
        std::fs::create_dir_all(path.parent().expect("a folder")).expect("it is made");
        std::fs::write(path, bytes).expect("it is written");
    }

    /// A file `own/hero.fbx` with a picture of this name.
    fn convert(&self, picture: &str, textures: &[&str], options: &Options) -> Conversion {
        let mut file = Looks::default();
        let skin = file.material("skin", "phong", "");
        file.quad("hero", &[("map", 1.0)], skin);
        file.texture(picture, "", skin, "DiffuseColor");
        let origin = Origin {
            name: "own/hero.fbx".to_owned(),
            folder: Some(self.0.join("own")),
            textures: textures.iter().map(|folder| self.0.join(folder)).collect(),
            ..Origin::default()
        };
        convert(file.text().as_bytes(), &origin, options).expect("it is sound")
    }

    fn made(&self, picture: &str, textures: &[&str]) -> Conversion {
        self.convert(picture, textures, &Options::default())
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        std::fs::remove_dir_all(&self.0).expect("it is taken away");
    }
}

fn red() -> Vec<u8> {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/field");
    std::fs::read(data.join("red.png")).expect("a file of the repository")
}

/// One pixel: blue, green, red.
const TGA: [u8; 21] = [
    0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 1, 0, 24, 0, 10, 20, 30,
];

/// What is lost, in one text.
fn lost(made: &Conversion) -> String {
    let lines = made.report.lost.iter();
    let lines = lines.map(|lost| format!("{} {}: {}", lost.what, lost.name, lost.detail));
    lines.collect::<Vec<_>>().join("\n")
}

#[test]
fn a_tga_in_the_media_folder_becomes_a_png() {
    let place = Place::new("media");
    place.put("own/Hero.FBM/Skin.TGA", &TGA);
    let made = place.made("C:\\Users\\me\\hero.fbm\\skin.tga", &[]);
    assert_eq!(lost(&made), "");
    let image = &made.model.images[0];
    assert_eq!((image.mime, image.name.as_str()), ("image/png", "skin.tga"));
    let picture = image::load_from_memory(&image.bytes).expect("a PNG");
    assert_eq!(picture.to_rgb8().get_pixel(0, 0).0, [30, 20, 10]);
}

#[test]
fn pictures_come_from_folders_that_are_given() {
    let place = Place::new("given");
    place.put("art/skins/skin.png", &red());
    assert!(lost(&place.made("skin.png", &[])).starts_with("texture-file skin.png"));
    let made = place.made("..\\art\\Skins\\Skin.png", &["art"]);
    assert_eq!(lost(&made), "");
    assert_eq!(made.model.images[0].bytes, red());
}

#[test]
fn pictures_of_one_name_are_told_apart_or_said() {
    let place = Place::new("same");
    let read = |name: &str| {
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/field");
        std::fs::read(data.join(name)).expect("a file of the repository")
    };
    place.put("art/p/body/skin.png", &read("blue.png"));
    place.put("art/p/head/skin.png", &red());
    let made = place.made("C:\\work\\head\\skin.png", &["art"]);
    assert_eq!(lost(&made), "");
    assert_eq!(made.model.images[0].bytes, red());
    let said = lost(&place.made("C:\\work\\skin.png", &["art"]));
    assert!(
        said.starts_with("texture-name skin.png: 1 more") && said.contains("body"),
        "{said}"
    );
}

#[test]
fn a_picture_that_is_nowhere_is_said_with_the_places() {
    let place = Place::new("nowhere");
    std::fs::create_dir_all(place.0.join("art")).unwrap();
    let said = lost(&place.made("maps/skin.png", &["art"]));
    for part in ["skin.png", "hero.fbm", "Textures", "art"] {
        assert!(said.contains(part), "{said}");
    }
}

#[test]
fn nothing_outside_is_opened() {
    let place = Place::new("outside");
    place.put("secret/skin.png", &red());
    place.put("own/x", b"x");
    let absolute = place.0.join("secret/skin.png").display().to_string();
    for name in ["../secret/skin.png", "..\\secret\\skin.png", &absolute] {
        assert!(place.made(name, &[]).model.images.is_empty(), "{name}");
    }
    #[cfg(unix)]
    {
        use std::os::unix::fs::symlink;
        symlink(place.0.join("secret"), place.0.join("own/textures")).unwrap();
        symlink(
            place.0.join("secret/skin.png"),
            place.0.join("own/skin.png"),
        )
        .unwrap();
        for name in ["skin.png", "SKIN.png", "textures/skin.png"] {
            assert!(place.made(name, &["own"]).model.images.is_empty(), "{name}");
        }
        // The same link is followed where the folder behind it is given.
        assert_eq!(place.made("skin.png", &["secret"]).model.images.len(), 1);
    }
}

#[test]
fn other_kinds_are_named_and_the_way_out_works() {
    let place = Place::new("kinds");
    place.put("own/skin.psd", b"8BPS\0\x01\0\0\0\0");
    let said = lost(&place.made("skin.psd", &[]));
    assert!(
        said.contains("texture-format skin.psd") && said.contains("PSD"),
        "{said}"
    );
    assert!(
        said.contains("save it as PNG under the same name"),
        "{said}"
    );
    place.put("own/skin.png", &red());
    let made = place.made("skin.psd", &[]);
    assert_eq!(lost(&made), "");
    assert_eq!(made.model.images[0].bytes, red());
}

/// What is embedded may be broken and lie beside the file whole.
#[test]
fn a_broken_embedded_picture_is_looked_for() {
    let place = Place::new("embedded");
    let mut file = Looks::default();
    let skin = file.material("skin", "phong", "");
    file.quad("hero", &[("map", 1.0)], skin);
    let texture = file.texture("skin.png", "", skin, "DiffuseColor");
    // "broken", in base 64.
    file.video("skin.png", "YnJva2Vu", texture);
    let made = |place: &Place| {
        let origin = Origin {
            folder: Some(place.0.join("own")),
            ..Origin::default()
        };
        convert(file.text().as_bytes(), &origin, &Options::default()).unwrap()
    };
    let said = lost(&made(&place));
    assert!(
        said.starts_with("texture-format skin.png: is no picture"),
        "{said}"
    );
    place.put("own/skin.png", &red());
    let whole = made(&place);
    assert_eq!(
        (lost(&whole).as_str(), &whole.model.images[0].bytes),
        ("", &red())
    );
}

#[test]
fn bombs_cost_a_line_and_no_memory() {
    let place = Place::new("bombs");
    // Run-length encoded, of 60000 by 60000 pixels.
    let mut bomb = TGA;
    bomb[2] = 10;
    bomb[12..16].copy_from_slice(&[0x60, 0xea, 0x60, 0xea]);
    place.put("own/skin.tga", &bomb);
    let said = lost(&place.made("skin.tga", &[]));
    assert!(said.contains("raise the limit on memory"), "{said}");
    // A limit that somebody set holds for pictures too.
    let limits = |memory| Options {
        limits: Some(Limits {
            memory,
            work: 1 << 24,
        }),
        ..Options::default()
    };
    let mut large = red();
    large.resize(3 << 20, 0);
    place.put("own/large.png", &large);
    let small = place.convert("large.png", &[], &limits(2 << 20));
    assert!(
        lost(&small).contains("texture-size large.png"),
        "{}",
        lost(&small)
    );
    let enough = place.convert("large.png", &[], &limits(4 << 20));
    assert_eq!(lost(&enough), "");
}

#[test]
fn a_picture_of_two_textures_is_kept_once() {
    let place = Place::new("once");
    place.put("own/skin.png", &red());
    let mut file = Looks::default();
    let skin = file.material("skin", "phong", "");
    file.quad("hero", &[("map", 1.0)], skin);
    file.texture("skin.png", "", skin, "DiffuseColor");
    file.texture("SKIN.png", "", skin, "EmissiveColor");
    let origin = Origin {
        folder: Some(place.0.join("own")),
        ..Origin::default()
    };
    let made = convert(file.text().as_bytes(), &origin, &Options::default()).unwrap();
    assert_eq!(made.model.images.len(), 1);
}
