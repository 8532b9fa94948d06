//! Cameras in every unit, with every way of saying a field of view.

use crate::support::scene::{converted, field, json, link, lost, model, scene};
use dolomite_fbx::model::{Camera, Projection};

/// One camera of the given properties in a file whose unit is `unit` centimetres.
fn camera(unit: f64, properties: &[(&str, f64)]) -> (Camera, Vec<String>) {
    let lines: String = properties
        .iter()
        .map(|(name, value)| format!("\t\t\tP: \"{name}\", \"Number\", \"\", \"A\",{value:?}\n"))
        .collect();
    let objects = model(1, "eye", "Camera", "")
        + &format!(
            "\tNodeAttribute: 2, \"NodeAttribute::eye\", \"Camera\" {{\n\t\tProperties70:  {{\n{lines}\t\t}}\n\t}}\n"
        );
    let made = converted(scene(unit, &objects, &(link(1, 0) + &link(2, 1))).as_bytes());
    let document = json(&made);
    assert_eq!(document["cameras"].as_array().map(Vec::len), Some(1));
    let names = lost(&made, "camera-planes");
    (made.model.cameras[0].clone(), names)
}

/// The angle whose half has the tangent 1/2.
const HALF: f64 = 0.927_295_218_001_612_2;

fn near(a: f32, b: f64) {
    assert!((f64::from(a) - b).abs() <= 1e-5 * b.abs(), "{a} for {b}");
}

#[test]
fn planes_are_metres_in_every_unit() {
    // Millimetres, centimetres, inches, feet, metres.
    for unit in [0.1, 1.0, 2.54, 30.48, 100.0] {
        for kind in [0.0, 1.0] {
            let (camera, lost) = camera(
                unit,
                &[
                    ("CameraProjectionType", kind),
                    ("NearPlane", 10.0),
                    ("FarPlane", 4000.0),
                    ("OrthoZoom", 2.0),
                    ("FieldOfView", 60.0),
                ],
            );
            near(camera.near, 0.1 * unit);
            near(camera.far, 40.0 * unit);
            assert!(lost.is_empty());
            // FBX's orthographic zoom counts 30 units.
            if let Projection::Orthographic(x, y) = camera.projection {
                near(x, 0.3 * unit);
                near(y, 0.3 * unit);
            } else {
                assert_eq!(kind, 0.0);
            }
        }
    }
}

#[test]
fn the_field_case_has_its_planes() {
    let made = converted(&field("a13b_camera_cm.fbx"));
    for camera in &made.model.cameras {
        near(camera.near, 0.1);
        near(camera.far, 40.0);
    }
    let Projection::Perspective(field, aspect) = made.model.cameras[0].projection else {
        panic!("the first has a perspective");
    };
    near(field, 60_f64.to_radians());
    near(aspect, 4.0 / 3.0);
}

#[test]
fn every_way_of_saying_a_field_of_view() {
    let field = |properties: &[(&str, f64)]| {
        let mut all = vec![
            ("AspectRatioMode", 2.0),
            ("AspectWidth", 200.0),
            ("AspectHeight", 100.0),
        ];
        all.extend_from_slice(properties);
        match camera(1.0, &all).0.projection {
            Projection::Perspective(field, aspect) => (field, aspect),
            Projection::Orthographic(..) => panic!("it has a perspective"),
        }
    };
    // Vertical; horizontal, whose half tangent is twice the vertical one; both; by lens and film.
    let (y, aspect) = field(&[("ApertureMode", 2.0), ("FieldOfView", 40.0)]);
    near(y, 40_f64.to_radians());
    near(aspect, 2.0);
    let (y, aspect) = field(&[("ApertureMode", 1.0), ("FieldOfView", 90.0)]);
    near(y, HALF);
    near(aspect, 2.0);
    let both = [
        ("ApertureMode", 0.0),
        ("FieldOfViewX", 90.0),
        ("FieldOfViewY", 60.0),
    ];
    let (y, aspect) = field(&both);
    near(y, 60_f64.to_radians());
    near(aspect, 3_f64.sqrt());
    let film = [
        ("ApertureMode", 3.0),
        ("FilmWidth", 2.0),
        ("FilmHeight", 1.0),
        ("FocalLength", 25.4),
    ];
    let (y, aspect) = field(&film);
    near(y, HALF);
    near(aspect, 2.0);
}

/// Width over height and the vertical angle of a camera, with 200 by 100 pixels where it says no other.
fn frame(properties: &[(&str, f64)]) -> (f32, f32) {
    let mut all = Vec::new();
    for (name, value) in [
        ("AspectRatioMode", 2.0),
        ("AspectWidth", 200.0),
        ("AspectHeight", 100.0),
    ] {
        if !properties.iter().any(|(own, _)| *own == name) {
            all.push((name, value));
        }
    }
    all.extend_from_slice(properties);
    match camera(1.0, &all).0.projection {
        Projection::Perspective(field, aspect) => (aspect, field),
        Projection::Orthographic(x, y) => (x, y),
    }
}

/// A lens that squeezes makes what it takes in wider, not higher.
#[test]
fn squeezed_film_is_wider() {
    for fit in [0.0, 1.0, 2.0, 3.0, 4.0] {
        // The lens of 1 inch sees 1 inch of height, as wide as four.
        let (aspect, y) = frame(&[
            ("ApertureMode", 3.0),
            ("FilmWidth", 2.0),
            ("FilmHeight", 1.0),
            ("FilmSqueezeRatio", 2.0),
            ("FocalLength", 25.4),
            ("AspectWidth", 400.0),
            ("GateFit", fit),
        ]);
        near(aspect, 4.0);
        near(y, HALF);
    }
    // A picture half as wide: by the film's width it is twice as high.
    let (aspect, y) = frame(&[
        ("ApertureMode", 3.0),
        ("FilmWidth", 2.0),
        ("FilmHeight", 1.0),
        ("FilmSqueezeRatio", 2.0),
        ("FocalLength", 50.8),
        ("GateFit", 2.0),
    ]);
    near(aspect, 2.0);
    near(y, HALF);
}

#[test]
fn pixels_that_are_no_squares_make_the_picture_wider() {
    let wide = ("PixelAspectRatio", 2.0);
    let square = ("AspectWidth", 100.0);
    let (aspect, y) = frame(&[("ApertureMode", 2.0), ("FieldOfView", 40.0), wide, square]);
    near(aspect, 2.0);
    near(y, 40_f64.to_radians());
    let (aspect, y) = frame(&[("ApertureMode", 1.0), ("FieldOfView", 90.0), wide, square]);
    near(aspect, 2.0);
    near(y, HALF);
    // A ratio that is no count of pixels is the picture's.
    let (aspect, _) = frame(&[("AspectRatioMode", 1.0), wide]);
    near(aspect, 2.0);
    // Without a perspective, by the width: 30 units of zoom.
    let (x, y) = frame(&[
        ("CameraProjectionType", 1.0),
        ("GateFit", 2.0),
        wide,
        square,
    ]);
    near(x, 0.15);
    near(y, 0.075);
}

#[test]
fn what_turns_a_camera_besides_its_node_is_said() {
    let attribute = |properties: &str| {
        format!(
            "\tNodeAttribute: 2, \"NodeAttribute::eye\", \"Camera\" {{\n\t\tProperties70:  {{\n{properties}\t\t}}\n\t}}\n"
        )
    };
    let made = |properties: &str, more: &str| {
        let objects =
            model(1, "eye", "Camera", "") + &attribute(properties) + &model(3, "goal", "Null", "");
        let links = link(1, 0) + &link(2, 1) + &link(3, 0) + more;
        converted(scene(1.0, &objects, &links).as_bytes())
    };
    let rolled = made("\t\t\tP: \"Roll\", \"Roll\", \"\", \"A\",12.5\n", "");
    assert_eq!(lost(&rolled, "camera-roll"), ["eye"]);
    let aimed = made("", "\tC: \"OP\",3,1, \"LookAtProperty\"\n");
    assert_eq!(lost(&aimed, "look-at"), ["eye"]);
    assert!(made("", "").report.lost.is_empty());
}

#[test]
fn broken_planes_become_ones_that_gltf_allows() {
    for kind in [0.0, 1.0] {
        for (low, high, broken) in [
            (100.0, 10.0, true),
            (50.0, 50.0, true),
            (-10.0, 100.0, true),
            (0.0, 100.0, false),
            (10.0, 1e35, false),
        ] {
            let (camera, lost) = camera(
                1.0,
                &[
                    ("CameraProjectionType", kind),
                    ("NearPlane", low),
                    ("FarPlane", high),
                ],
            );
            assert!(camera.near > 0.0 && camera.far > camera.near, "{camera:?}");
            assert!(kind == 0.0 || camera.far.is_finite(), "{camera:?}");
            assert_eq!(lost.len(), usize::from(broken), "{low} {high} {camera:?}");
        }
    }
    // A perspective without an end says none.
    let (camera, _) = camera(1.0, &[("NearPlane", 10.0), ("FarPlane", 1e35)]);
    assert_eq!(camera.far, f32::INFINITY);
}

#[test]
fn what_is_not_said_is_what_fbx_takes() {
    let (camera, lost) = camera(1.0, &[]);
    near(camera.near, 0.1);
    near(camera.far, 40.0);
    assert!(lost.is_empty());
}
