//! Meshes far from their origin: what f32 cannot hold there goes into a node.

use crate::support::scene::{array, converted, corners, field, geometry, link, model, scene};
use dolomite_fbx::Conversion;
use dolomite_fbx::Origin;
use dolomite_fbx::check::{Played, Truth, vertex_error};
use glam::DVec3;

/// The largest distance of a vertex at rest from where ufbx has it in the file's own axes.
fn measured(file: &[u8], made: &Conversion) -> f64 {
    let glb = made.to_glb().expect("a small file");
    let played = Played::read(&glb).expect("a sound .glb");
    let truth = Truth::load(file, &Origin::default()).expect("a sound file");
    let (shapes, _) = played.at(None, 0.0);
    let (bodies, _) = truth.at(None, 0.0).expect("it can be evaluated");
    assert!(!shapes.is_empty());
    vertex_error(&shapes, &bodies, &truth.space(), &made.sources())
}

/// Where a map has a house: metres.
const UTM: DVec3 = DVec3::new(447_312.25, 301.4, 5_411_988.53);

#[test]
fn the_field_case_keeps_ten_centimetres() {
    let file = field("a12c_house_utm.fbx");
    let made = converted(&file);
    assert!(measured(&file, &made) < 1e-6);
    assert!(made.report.error() < 1e-6);
    // Within the mesh as well: no two different corners of the file fall together.
    let positions = &made.model.meshes[0].parts[0].positions;
    let [a, b] = [0, 1].map(|i| glam::Vec3::from(positions[i]).as_dvec3());
    assert!((a.distance(b) - 0.1).abs() < 1e-6, "{a} {b}");
    assert!(made.model.meshes[0].offset.length() > 5e6);
}

#[test]
fn what_hangs_below_such_a_node_stays() {
    let objects = geometry(1, &corners(UTM, UTM + 0.1), "")
        + &model(
            2,
            "house",
            "Mesh",
            "\t\t\tP: \"Lcl Rotation\", \"Lcl Rotation\", \"\", \"A\",0,30,0\n",
        )
        + &model(
            3,
            "lamp",
            "Null",
            "\t\t\tP: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",1,2,3\n",
        )
        + &model(
            4,
            "again",
            "Mesh",
            "\t\t\tP: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",5,0,0\n",
        );
    let links = link(2, 0) + &link(1, 2) + &link(3, 2) + &link(4, 0) + &link(1, 4);
    let file = scene(100.0, &objects, &links);
    let made = converted(file.as_bytes());
    let off = measured(file.as_bytes(), &made);
    // Turned by 30 degrees in f32, five million metres out.
    assert!(off <= made.report.position_error + 1e-9, "{off:e}");
    assert!(made.report.error() >= made.report.position_error);
    let lamp = made.model.nodes.iter().find(|n| n.name == "lamp").unwrap();
    assert!((lamp.rest.translation - DVec3::new(1.0, 2.0, 3.0)).length() < 1e-12);
    // One mesh, shown twice.
    assert_eq!(made.model.meshes.len(), 1);
    let helpers = made.model.nodes.iter().filter(|n| n.mesh == Some(0));
    let names: Vec<&str> = helpers.map(|n| n.name.as_str()).collect();
    assert_eq!(names, ["house.geometry", "again.geometry"]);
}

/// A box that follows a joint beside it, both far out.
#[test]
fn skins_take_it_into_their_bind_matrices() {
    let one = [
        1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0,
    ];
    let mut at = one;
    (at[12], at[13], at[14]) = (447_312.0, 301.0, 5_411_988.0);
    let place =
        "\t\t\tP: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",447312,301,5411988\n";
    let objects = geometry(1, &corners(UTM, UTM + 0.1), "")
        + &model(2, "house", "Mesh", "")
        + &model(3, "joint", "LimbNode", place)
        + "\tDeformer: 4, \"Deformer::skin\", \"Skin\" {\n\t\tVersion: 101\n\t}\n\tDeformer: 5, \"SubDeformer::joint\", \"Cluster\" {\n\t\tVersion: 100\n"
        + &array("Indexes", &[0, 1, 2, 3, 4, 5, 6, 7])
        + &array("Weights", &[1; 8])
        + &array("Transform", &inverse(&at))
        + &array("TransformLink", &at)
        + "\t}\n";
    let links = [(2, 0), (1, 2), (3, 0), (4, 1), (5, 4), (3, 5)];
    let links: String = links.iter().map(|&(from, to)| link(from, to)).collect();
    let file = scene(100.0, &objects, &links);
    let made = converted(file.as_bytes());
    assert_eq!(made.model.skins.len(), 1);
    assert!(measured(file.as_bytes(), &made) < 1e-6);
    assert!(made.report.error() < 1e-6, "{:e}", made.report.error());
}

/// Of a translation.
fn inverse(m: &[f64; 16]) -> [f64; 16] {
    let mut out = *m;
    (12..15).for_each(|i| out[i] = -m[i]);
    out
}

#[test]
fn what_f32_holds_stays_where_it_is() {
    // A box about its origin, one as large as it is far out, and a small one a little beside it.
    for (low, high) in [
        (DVec3::splat(-1.0), DVec3::ONE),
        (DVec3::splat(-6e6), DVec3::splat(5e6)),
        (DVec3::splat(10.0), DVec3::splat(10.5)),
    ] {
        let objects = geometry(1, &corners(low, high), "") + &model(2, "box", "Mesh", "");
        let file = scene(100.0, &objects, &(link(2, 0) + &link(1, 2)));
        let made = converted(file.as_bytes());
        assert_eq!(made.model.meshes[0].offset, DVec3::ZERO);
        assert_eq!(made.model.nodes.len(), 1);
        let off = measured(file.as_bytes(), &made);
        assert!(off <= made.report.position_error + 1e-12 * high.length());
    }
}

/// A node far out is a translation in f32, which glTF has no other: said, not hidden.
#[test]
fn a_node_far_out_is_off_by_what_is_stated() {
    let place = "\t\t\tP: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",447312.28,301.4,5411988.7\n";
    let objects =
        geometry(1, &corners(DVec3::ZERO, DVec3::ONE), "") + &model(2, "box", "Mesh", place);
    let file = scene(100.0, &objects, &(link(2, 0) + &link(1, 2)));
    let made = converted(file.as_bytes());
    let off = measured(file.as_bytes(), &made);
    assert!(off > 0.01, "{off:e}");
    assert!((made.report.position_error - off).abs() < 1e-9);
    assert!(made.report.error() >= off);
    let said = made
        .report
        .lost
        .iter()
        .find(|lost| lost.what == "far-place");
    assert!(said.is_some_and(|lost| lost.metres.is_some_and(|m| (m - off).abs() < 1e-9)));
}

/// A mesh at its place on the map under a node that takes it back: both cancel, in f32 too.
#[test]
fn a_node_that_takes_it_back_cancels_it() {
    let back = "\t\t\tP: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",-447312.28,-301.4,-5411988.7\n";
    let objects = geometry(1, &corners(UTM, UTM + 0.1), "") + &model(2, "house", "Mesh", back);
    let file = scene(100.0, &objects, &(link(2, 0) + &link(1, 2)));
    let made = converted(file.as_bytes());
    assert_eq!(made.model.nodes.len(), 1);
    assert!(measured(file.as_bytes(), &made) < 1e-6);
    assert!(made.report.error() < 1e-6);
}

/// The same for a geometric transform, which is the mesh's alone.
#[test]
fn a_geometric_transform_that_takes_it_back_cancels_it() {
    let back = "\t\t\tP: \"GeometricTranslation\", \"Vector3D\", \"Vector\", \"\",-447312.28,-301.4,-5411988.7\n";
    let objects = geometry(1, &corners(UTM, UTM + 0.1), "")
        + &model(2, "house", "Mesh", back)
        + &model(3, "lamp", "Null", "");
    let file = scene(100.0, &objects, &(link(2, 0) + &link(1, 2) + &link(3, 2)));
    let made = converted(file.as_bytes());
    assert!(measured(file.as_bytes(), &made) < 1e-6);
    assert!(made.report.error() < 1e-6);
}

/// A camera and a light beside a house that is exact: where they are is rounded as well.
#[test]
fn cameras_and_lights_far_out_are_off_by_what_is_stated() {
    for kind in ["Camera", "Light"] {
        let place = "\t\t\tP: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\",453210.123,0,5212345.678\n";
        let objects = geometry(1, &corners(UTM, UTM + 0.1), "")
            + &model(2, "house", "Mesh", "")
            + &model(3, "eye", kind, place)
            + &format!("\tNodeAttribute: 4, \"NodeAttribute::eye\", \"{kind}\" {{\n\t}}\n");
        let links = link(2, 0) + &link(1, 2) + &link(3, 0) + &link(4, 3);
        let file = scene(100.0, &objects, &links);
        let made = converted(file.as_bytes());
        let rounded = DVec3::new(453_210.123, 0.0, 5_212_345.678);
        let off = (rounded.as_vec3().as_dvec3() - rounded).length();
        assert!(off > 0.05, "{off}");
        assert!((made.report.position_error - off).abs() < 1e-6, "{kind}");
        let mut lines = made.report.lost.iter();
        assert!(lines.any(|lost| lost.what == "far-place"), "{kind}");
    }
}
