//! Small ASCII FBX files of our own.

/// Ticks of FBX's clock in a second.
const TICKS: i64 = 46_186_158_000;

/// A strip of two squares, 20 x 10 units each, in the XY plane, Z up, in centimetres. Its lower edge
/// follows the node `base`, its upper edge the node `tip` 20 units above, its middle both. The clip
/// `bend` turns `tip` about X by `degrees` from 1 s to 2 s, straight. The blend channel `bulge` has
/// shapes at 50 % (the middle moved by 1 unit along Z) and at 100 % (by 4 units).
pub fn strip(degrees: f64) -> String {
    let one = "1,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1";
    let up = |y: f64| format!("1,0,0,0, 0,1,0,0, 0,0,1,0, 0,{y},0,1");
    let mut text = header();
    text += "Objects:  {\n\tGeometry: 100, \"Geometry::strip\", \"Mesh\" {\n";
    text +=
        "\t\tVertices: *18 {\n\t\t\ta: 0,0,0, 20,0,0, 0,10,0, 20,10,0, 0,20,0, 20,20,0\n\t\t}\n";
    text += "\t\tPolygonVertexIndex: *8 {\n\t\t\ta: 0,1,3,-3, 2,3,5,-5\n\t\t}\n\t\tGeometryVersion: 124\n\t}\n";
    for (id, name, lift) in [(110, "half", 1), (111, "whole", 4)] {
        text += &format!(
            "\tGeometry: {id}, \"Geometry::{name}\", \"Shape\" {{\n\t\tVersion: 100\n\t\tIndexes: *2 {{\n\t\t\ta: 2,3\n\t\t}}\n\t\tVertices: *6 {{\n\t\t\ta: 0,0,{lift}, 0,0,{lift}\n\t\t}}\n\t}}\n"
        );
    }
    text += "\tModel: 200, \"Model::strip\", \"Mesh\" {\n\t\tVersion: 232\n\t}\n";
    text += "\tModel: 201, \"Model::base\", \"LimbNode\" {\n\t\tVersion: 232\n\t}\n";
    text += "\tModel: 202, \"Model::tip\", \"LimbNode\" {\n\t\tVersion: 232\n\t\tProperties70:  {\n\t\t\tP: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",0,20,0\n\t\t}\n\t}\n";
    text += "\tDeformer: 300, \"Deformer::skin\", \"Skin\" {\n\t\tVersion: 101\n\t}\n";
    let cluster = |id: i64, name: &str, indices: &str, weights: &str, bind: &str, link: &str| {
        let count = indices.split(',').count();
        format!(
            "\tDeformer: {id}, \"SubDeformer::{name}\", \"Cluster\" {{\n\t\tVersion: 100\n\t\tIndexes: *{count} {{\n\t\t\ta: {indices}\n\t\t}}\n\t\tWeights: *{count} {{\n\t\t\ta: {weights}\n\t\t}}\n\t\tTransform: *16 {{\n\t\t\ta: {bind}\n\t\t}}\n\t\tTransformLink: *16 {{\n\t\t\ta: {link}\n\t\t}}\n\t}}\n"
        )
    };
    text += &cluster(301, "base", "0,1,2,3", "1,1,0.5,0.5", one, one);
    text += &cluster(302, "tip", "2,3,4,5", "0.5,0.5,1,1", &up(-20.0), &up(20.0));
    text += "\tDeformer: 310, \"Deformer::shapes\", \"BlendShape\" {\n\t\tVersion: 100\n\t}\n";
    text += "\tDeformer: 311, \"SubDeformer::bulge\", \"BlendShapeChannel\" {\n\t\tVersion: 100\n\t\tDeformPercent: 0\n\t\tFullWeights: *2 {\n\t\t\ta: 50,100\n\t\t}\n\t}\n";
    text += "\tAnimationStack: 400, \"AnimStack::bend\", \"\" {\n\t\tProperties70:  {\n";
    for (name, seconds) in [("LocalStart", 1), ("LocalStop", 2)] {
        text += &(format!(
            "\t\t\tP: \"{name}\", \"KTime\", \"Time\", \"\",{}",
            seconds * TICKS
        ) + "\n");
    }
    text += "\t\t}\n\t}\n\tAnimationLayer: 401, \"AnimLayer::layer\", \"\" {\n\t}\n";
    text += "\tAnimationCurveNode: 402, \"AnimCurveNode::R\", \"\" {\n\t\tProperties70:  {\n\t\t\tP: \"d|X\", \"Number\", \"\", \"A\",0\n\t\t\tP: \"d|Y\", \"Number\", \"\", \"A\",0\n\t\t\tP: \"d|Z\", \"Number\", \"\", \"A\",0\n\t\t}\n\t}\n";
    text += "\tAnimationCurveNode: 404, \"AnimCurveNode::DeformPercent\", \"\" {\n\t\tProperties70:  {\n\t\t\tP: \"d|DeformPercent\", \"Number\", \"\", \"A\",0\n\t\t}\n\t}\n";
    text += &curve(403, 0.0, degrees, 1);
    text += &curve(405, 0.0, 100.0, 1);
    text += "}\nConnections:  {\n";
    for (from, to) in [
        (200, 0),
        (201, 0),
        (202, 201),
        (100, 200),
        (300, 100),
        (301, 300),
        (302, 300),
        (201, 301),
        (202, 302),
        (310, 100),
        (311, 310),
        (110, 311),
        (111, 311),
        (401, 400),
        (402, 401),
        (404, 401),
    ] {
        text += &(format!("\tC: \"OO\",{from},{to}") + "\n");
    }
    for (from, to, property) in [
        (402, 202, "Lcl Rotation"),
        (403, 402, "d|X"),
        (404, 311, "DeformPercent"),
        (405, 404, "d|DeformPercent"),
    ] {
        text += &(format!("\tC: \"OP\",{from},{to}, \"{property}\"") + "\n");
    }
    text + "}\n"
}

/// Version, axes (Z up), unit (centimetres), 24 frames a second.
pub fn header() -> String {
    let mut text = String::from(
        "; FBX 7.4.0 project file\nFBXHeaderExtension:  {\n\tFBXHeaderVersion: 1003\n\tFBXVersion: 7400\n\tCreator: \"tests\"\n}\n",
    );
    text += "GlobalSettings:  {\n\tVersion: 1000\n\tProperties70:  {\n";
    for (name, value) in [
        ("UpAxis", 2),
        ("UpAxisSign", 1),
        ("FrontAxis", 1),
        ("FrontAxisSign", -1),
        ("CoordAxis", 0),
        ("CoordAxisSign", 1),
    ] {
        text += &(format!("\t\tP: \"{name}\", \"int\", \"Integer\", \"\",{value}") + "\n");
    }
    text += "\t\tP: \"UnitScaleFactor\", \"double\", \"Number\", \"\",1\n\t\tP: \"TimeMode\", \"enum\", \"\", \"\",11\n\t}\n}\n";
    text
}

/// A straight curve of one second.
pub fn curve(id: i64, from: f64, to: f64, second: i64) -> String {
    let (begin, end) = (second * TICKS, (second + 1) * TICKS);
    format!(
        "\tAnimationCurve: {id}, \"AnimCurve::\", \"\" {{\n\t\tDefault: 0\n\t\tKeyVer: 4009\n\t\t\
         KeyTime: *2 {{\n\t\t\ta: {begin},{end}\n\t\t}}\n\t\tKeyValueFloat: *2 {{\n\t\t\ta: {from},{to}\n\t\t}}\n\t\t\
         KeyAttrFlags: *1 {{\n\t\t\ta: 4\n\t\t}}\n\t\tKeyAttrDataFloat: *4 {{\n\t\t\ta: 0,0,0,0\n\t\t}}\n\t\t\
         KeyAttrRefCount: *1 {{\n\t\t\ta: 2\n\t\t}}\n\t}}\n"
    )
}
