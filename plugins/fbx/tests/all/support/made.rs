//! Files with looks, converted, and what to ask of them.

use super::looks::Looks;
use dolomite_fbx::model::Material;
use dolomite_fbx::{Conversion, Options, Origin, convert};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// The field's cases that are kept here.
pub fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/field")
}

/// One of the field's cases, from its own folder.
pub fn field(name: &str) -> Conversion {
    let path = data().join(name).with_extension("fbx");
    let bytes = std::fs::read(&path).expect("a file of the repository");
    let origin = Origin {
        name: path.display().to_string(),
        folder: Some(data()),
        ..Origin::default()
    };
    convert(&bytes, &origin, &Options::default()).expect("it is sound")
}

/// With the pictures `red.png`, `blue.png` and `glass.png`, which has alpha, at hand.
pub fn made(file: &Looks) -> Conversion {
    let read = |name: &str| std::fs::read(data().join(name)).expect("a file of the repository");
    let origin = Origin {
        files: [
            ("red.png".to_owned(), read("red.png")),
            ("blue.png".to_owned(), read("blue.png")),
            ("glass.png".to_owned(), glass()),
        ]
        .into(),
        ..Origin::default()
    };
    convert(file.text().as_bytes(), &origin, &Options::default()).expect("it is sound")
}

/// A PNG with alpha.
pub fn glass() -> Vec<u8> {
    let picture = image::RgbaImage::from_pixel(2, 2, image::Rgba([200, 220, 255, 90]));
    let mut out = std::io::Cursor::new(Vec::new());
    picture
        .write_to(&mut out, image::ImageFormat::Png)
        .expect("it is written");
    out.into_inner()
}

/// The document.
pub fn json(made: &Conversion) -> Value {
    serde_json::from_slice(&made.to_gltf("x").json).expect("it is JSON")
}

/// By its name.
pub fn material<'m>(made: &'m Conversion, name: &str) -> &'m Material {
    let mut all = made.model.materials.iter();
    all.find(|material| material.name == name)
        .expect("it is there")
}

/// Names of what is lost of one kind.
pub fn lost<'m>(made: &'m Conversion, what: &str) -> Vec<&'m str> {
    let lines = made.report.lost.iter().filter(|lost| lost.what == what);
    lines.map(|lost| lost.name.as_str()).collect()
}

/// # Panics
/// If a line says that something is lost.
pub fn nothing_lost(made: &Conversion) {
    assert!(made.report.lost.is_empty(), "{:?}", made.report.lost);
}
