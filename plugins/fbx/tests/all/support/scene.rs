//! ASCII FBX files of given objects and connections, and the JSON of what comes of them.

use dolomite_fbx::{Conversion, Options, Origin, convert};
use glam::DVec3;
use serde_json::Value;

/// Y up, `unit` centimetres.
pub fn scene(unit: f64, objects: &str, connections: &str) -> String {
    let mut text = String::from(
        "; FBX 7.4.0 project file\nFBXHeaderExtension:  {\n\tFBXHeaderVersion: 1003\n\tFBXVersion: 7400\n\tCreator: \"tests\"\n}\nGlobalSettings:  {\n\tVersion: 1000\n\tProperties70:  {\n",
    );
    for (name, value) in [
        ("UpAxis", 1),
        ("UpAxisSign", 1),
        ("FrontAxis", 2),
        ("FrontAxisSign", 1),
        ("CoordAxis", 0),
        ("CoordAxisSign", 1),
    ] {
        text += &format!("\t\tP: \"{name}\", \"int\", \"Integer\", \"\",{value}\n");
    }
    text += &format!(
        "\t\tP: \"UnitScaleFactor\", \"double\", \"Number\", \"\",{unit}\n\t}}\n}}\nObjects:  {{\n{objects}}}\nConnections:  {{\n{connections}}}\n"
    );
    text
}

/// A list of numbers as an array node of that name.
pub fn array<T: std::fmt::Display>(name: &str, values: &[T]) -> String {
    let list: Vec<String> = values.iter().map(T::to_string).collect();
    format!(
        "\t\t{name}: *{} {{\n\t\t\ta: {}\n\t\t}}\n",
        values.len(),
        list.join(",")
    )
}

/// Converts by default options.
pub fn converted(file: &[u8]) -> Conversion {
    convert(file, &Origin::default(), &Options::default()).expect("a file of our own is sound")
}

/// The document of a result.
pub fn json(made: &Conversion) -> Value {
    serde_json::from_slice(&made.to_gltf("x").json).expect("it is JSON")
}

/// A file of `tests/data/field`.
pub fn field(name: &str) -> Vec<u8> {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/field")
        .join(name);
    std::fs::read(path).expect("a committed file")
}

/// Lines of `lost` of a kind, by name.
pub fn lost(made: &Conversion, what: &str) -> Vec<String> {
    let of_kind = made.report.lost.iter().filter(|lost| lost.what == what);
    of_kind.map(|lost| lost.name.clone()).collect()
}

/// Corners of a box from `low` to `high`, as `a08_visibility_curve.fbx` orders them.
pub fn corners(low: DVec3, high: DVec3) -> Vec<f64> {
    let of = |i: usize| {
        let pick = |bit: usize, axis: usize| if i & bit == 0 { low[axis] } else { high[axis] };
        [pick(1, 0), pick(2, 1), pick(4, 2)]
    };
    (0..8).flat_map(of).collect()
}

/// Six faces of such a box: -Z, +Z, -Y, +Y, -X, +X.
pub const FACES: [i64; 24] = [
    0, 2, 3, -2, 4, 5, 7, -7, 0, 1, 5, -5, 2, 6, 7, -4, 0, 4, 6, -3, 1, 3, 7, -6,
];

/// A geometry of the name `box`: corners, the six faces, and what else it is to hold.
pub fn geometry(id: u32, corners: &[f64], more: &str) -> String {
    format!(
        "\tGeometry: {id}, \"Geometry::box\", \"Mesh\" {{\n{}{}\t\tGeometryVersion: 124\n{more}\t}}\n",
        array("Vertices", corners),
        array("PolygonVertexIndex", &FACES)
    )
}

/// A node; `properties` are lines of its Properties70.
pub fn model(id: u32, name: &str, kind: &str, properties: &str) -> String {
    format!(
        "\tModel: {id}, \"Model::{name}\", \"{kind}\" {{\n\t\tVersion: 232\n\t\tProperties70:  {{\n{properties}\t\t}}\n\t}}\n"
    )
}

/// A connection of objects.
pub fn link(from: u32, to: u32) -> String {
    format!("\tC: \"OO\",{from},{to}\n")
}
