//! What else a file says: names in code pages, properties of users, keyed properties. Each is carried or
//! has a line in `lost`.

use crate::support::ascii;
use crate::support::scene::{
    array, converted, corners, field, geometry, json, link, lost, model, scene,
};
use glam::DVec3;
use serde_json::json;
use std::collections::BTreeSet;

/// A property of the user.
fn user(name: &str, kind: &str, flags: &str, value: &str) -> String {
    format!("\t\t\tP: \"{name}\", {kind}, \"{flags}\",{value}\n")
}

#[test]
fn names_in_code_pages_stay_apart() {
    let made = converted(&field("a07_sjis_names.fbx"));
    let clips: Vec<&str> = made
        .model
        .clips
        .iter()
        .map(|clip| clip.name.as_str())
        .collect();
    assert_eq!(clips, ["\\x95\\xE0\\x82\\xAD", "\\x91\\x96\\x82\\xE9"]);
    assert_eq!(made.report.clips[1].name, clips[1]);
    let nodes: BTreeSet<&str> = made.model.nodes.iter().map(|n| n.name.as_str()).collect();
    assert_eq!(nodes.len(), made.model.nodes.len());
    assert!(nodes.contains("\\x8D\\xB6\\x98r"), "{nodes:?}");
    assert_eq!(lost(&made, "name-encoding"), ["4"]);
    assert!(json(&made).to_string().contains("x95"));
}

#[test]
fn names_of_all_kinds_of_objects_are_kept() {
    // The same in one byte each: 0xE9 is no UTF-8.
    let text = geometry(1, &corners(DVec3::ZERO, DVec3::ONE), "").replace("::box", "::g@")
        + &model(2, "n@", "Mesh", "")
        + "\tMaterial: 3, \"Material::m@\", \"\" {\n\t\tShadingModel: \"phong\"\n\t}\n"
        + &model(4, "l@", "Light", "")
        + "\tNodeAttribute: 5, \"NodeAttribute::a@\", \"Light\" {\n\t}\n"
        + &model(6, "\u{6b69}\\", "Null", "");
    let links = [(2, 0), (1, 2), (3, 2), (4, 0), (5, 4), (6, 2)];
    let links: String = links.iter().map(|&(from, to)| link(from, to)).collect();
    let bytes: Vec<u8> = scene(1.0, &text, &links)
        .bytes()
        .map(|b| if b == b'@' { 0xe9 } else { b })
        .collect();
    let made = converted(&bytes);
    let model = &made.model;
    assert_eq!(model.meshes[0].name, "g\\xE9");
    assert_eq!(model.materials[0].name, "m\\xE9");
    assert_eq!(model.lights[0].name, "a\\xE9");
    let names: Vec<&str> = model.nodes.iter().map(|n| n.name.as_str()).collect();
    // What is UTF-8 is as it was.
    for name in ["n\\xE9", "l\\xE9", "\u{6b69}\\"] {
        assert!(names.contains(&name), "{names:?}");
    }
}

#[test]
fn clips_of_one_name_are_told_apart() {
    let text = String::from_utf8(
        field("a07_sjis_names.fbx")
            .iter()
            .map(|&b| if b > 127 { b'w' } else { b })
            .collect(),
    );
    let made = converted(text.unwrap().as_bytes());
    let clips: Vec<&str> = made
        .model
        .clips
        .iter()
        .map(|clip| clip.name.as_str())
        .collect();
    assert_eq!(clips, ["wwww", "wwww.2"]);
    assert_eq!(lost(&made, "clip-name"), ["wwww"]);
}

#[test]
fn nodes_that_a_clip_moves_are_told_apart() {
    let text = String::from_utf8(field("a08_visibility_curve.fbx")).unwrap();
    // Two more of the same name, and one that has the next name already; only the first moves.
    let others = model(11, "ghost", "Null", "")
        + &model(12, "ghost.2", "Null", "")
        + &model(13, "ghost", "Null", "");
    let text = text
        .replace("Objects:  {\n", &format!("Objects:  {{\n{others}"))
        .replace(
            "Connections:  {\n",
            &format!(
                "Connections:  {{\n{}{}{}",
                link(11, 0),
                link(12, 0),
                link(13, 0)
            ),
        );
    let made = converted(text.as_bytes());
    let mut names: Vec<&str> = made.model.nodes.iter().map(|n| n.name.as_str()).collect();
    names.sort_unstable();
    assert_eq!(names, ["ghost", "ghost.2", "ghost.3", "ghost.4"]);
    assert_eq!(lost(&made, "node-name"), ["ghost"]);
    // Without a clip equal names are no harm.
    let still = text
        .replace("AnimationStack: 1003", "Unknown: 1003")
        .replace("1004,1003", "1004,0");
    let made = converted(still.as_bytes());
    assert!(made.model.clips.is_empty());
    assert!(lost(&made, "node-name").is_empty());
}

#[test]
fn properties_of_users_are_extras() {
    let made = converted(&field("a10_user_properties.fbx"));
    let document = json(&made);
    let wanted = json!({ "hitpoints": 25, "pickup": "coin", "mass": 2.5 });
    assert_eq!(document["nodes"][0]["extras"], wanted);
    assert_eq!(
        document["materials"][0]["extras"],
        json!({ "surface": "wood" })
    );
    assert!(made.report.lost.is_empty(), "{:?}", made.report.lost);
}

#[test]
fn every_kind_of_value_has_its_json() {
    let own = user("flag", "\"bool\", \"\"", "AU", "1")
        + &user("whole", "\"int\", \"Integer\"", "U", "-7")
        + &user("choice", "\"enum\", \"\"", "AU", "2,\"one~two~three\"")
        + &user("share", "\"double\", \"Number\"", "AU", "0.25")
        + &user("place", "\"Vector3D\", \"Vector\"", "AU", "1,2.5,-3")
        + &user("paint", "\"Color\", \"\"", "AU", "1,0.5,0")
        + &user("glass", "\"ColorAndAlpha\", \"\"", "AU", "1,0.5,0,0.25")
        + &user("word", "\"KString\", \"\"", "U", "\"a b\"")
        + &user("length", "\"double\", \"Number\"", "", "9");
    let lamp = user("watts", "\"int\", \"Integer\"", "U", "60");
    let attribute = |kind: &str, id: u32| {
        format!(
            "\tNodeAttribute: {id}, \"NodeAttribute::x\", \"{kind}\" {{\n\t\tProperties70:  {{\n{lamp}\t\t}}\n\t}}\n"
        )
    };
    let shape = format!("\t\tProperties70:  {{\n{lamp}\t\t}}\n");
    let objects = model(1, "a", "Null", &own)
        + &model(2, "b", "Light", "")
        + &attribute("Light", 3)
        + &model(4, "c", "Camera", "")
        + &attribute("Camera", 5)
        + &model(6, "d", "LimbNode", "")
        + &attribute("LimbNode", 7)
        + &model(8, "e", "Mesh", "")
        + &geometry(9, &corners(DVec3::ZERO, DVec3::ONE), &shape);
    let links = [
        (1, 0),
        (2, 0),
        (3, 2),
        (4, 0),
        (5, 4),
        (6, 0),
        (7, 6),
        (8, 0),
        (9, 8),
    ];
    let links: String = links.iter().map(|&(from, to)| link(from, to)).collect();
    let document = json(&converted(scene(1.0, &objects, &links).as_bytes()));
    let node = |name: &str| {
        let nodes = document["nodes"].as_array().unwrap();
        nodes.iter().find(|node| node["name"] == name).unwrap()["extras"].clone()
    };
    assert_eq!(
        node("a"),
        json!({
            "flag": true, "whole": -7, "choice": 2, "share": 0.25, "place": [1.0, 2.5, -3.0],
            "paint": [1.0, 0.5, 0.0], "glass": [1.0, 0.5, 0.0, 0.25], "word": "a b"
        })
    );
    let watts = json!({ "watts": 60 });
    let light = &document["extensions"]["KHR_lights_punctual"]["lights"][0]["extras"];
    assert_eq!(*light, watts);
    assert_eq!(document["cameras"][0]["extras"], watts);
    assert_eq!(node("d"), watts);
    assert_eq!(document["meshes"][0]["extras"], watts);
}

/// What comes to nothing in glTF leaves its properties to its node, and what hangs at no node is said.
#[test]
fn properties_of_what_is_not_converted_are_kept_or_said() {
    let watts = user("watts", "\"int\", \"Integer\"", "U", "60");
    let block = format!("\t\tProperties70:  {{\n{watts}\t\t}}\n");
    let area = format!(
        "\t\tProperties70:  {{\n{watts}\t\t\tP: \"LightType\", \"enum\", \"\", \"\",3\n\t\t}}\n"
    );
    let light = |id: u32, inner: &str| {
        format!("\tNodeAttribute: {id}, \"NodeAttribute::x\", \"Light\" {{\n{inner}\t}}\n")
    };
    let objects = model(1, "panel", "Light", "")
        + &light(2, &area)
        + &model(3, "cloud", "Mesh", "")
        + &format!(
            "\tGeometry: 4, \"Geometry::cloud\", \"Mesh\" {{\n{}{}\t\tGeometryVersion: 124\n{block}\t}}\n",
            array("Vertices", &corners(DVec3::ZERO, DVec3::ONE)),
            // A line.
            array("PolygonVertexIndex", &[0, -2])
        )
        + &light(5, &block);
    let links = link(1, 0) + &link(2, 1) + &link(3, 0) + &link(4, 3);
    let made = converted(scene(1.0, &objects, &links).as_bytes());
    let document = json(&made);
    for name in ["panel", "cloud"] {
        let mut nodes = document["nodes"].as_array().unwrap().iter();
        let node = nodes.find(|node| node["name"] == name).unwrap();
        assert_eq!(node["extras"], json!({ "watts": 60 }), "{name}");
    }
    // The light that hangs nowhere.
    assert_eq!(lost(&made, "user-property"), ["1"]);
}

#[test]
fn names_of_properties_in_code_pages_are_said() {
    let own = user("@@", "\"int\", \"Integer\"", "U", "1")
        + &user("@#", "\"int\", \"Integer\"", "U", "2")
        + &user("plain", "\"int\", \"Integer\"", "U", "3");
    let text = scene(1.0, &model(1, "a", "Null", &own), &link(1, 0));
    let bytes: Vec<u8> = text
        .bytes()
        .map(|byte| match byte {
            b'@' => 0x95,
            b'#' => 0xe0,
            other => other,
        })
        .collect();
    let made = converted(&bytes);
    let said = lost(&made, "name-encoding");
    assert_eq!(said.len(), 1);
    assert!(["1", "2"].contains(&&*said[0]), "{said:?}");
    assert_eq!(json(&made)["nodes"][0]["extras"]["plain"], json!(3));
}

#[test]
fn keyed_properties_of_users_are_said() {
    let text = String::from_utf8(field("a08_visibility_curve.fbx")).unwrap();
    let old = "P: \"Visibility\", \"Visibility\", \"\", \"A\",1.0";
    let own = user("charge", "\"double\", \"Number\"", "AU", "1.0");
    let text = text
        .replace(old, own.trim())
        .replace("1001, \"Visibility\"", "1001, \"charge\"");
    let made = converted(text.as_bytes());
    assert_eq!(lost(&made, "keyed-property"), ["ghost.charge"]);
    assert_eq!(json(&made)["nodes"][0]["extras"], json!({ "charge": 1.0 }));
}

#[test]
fn keyed_properties_between_equal_keys_are_said() {
    let text = String::from_utf8(field("a08_visibility_curve.fbx")).unwrap();
    let old = "P: \"Visibility\", \"Visibility\", \"\", \"A\",1.0";
    let own = user("charge", "\"double\", \"Number\"", "AU", "1.0");
    let text = text
        .replace(old, own.trim())
        .replace("1001, \"Visibility\"", "1001, \"charge\"")
        .replace("a: 1.0,0.0,1.0", "a: 1.0,1.0,1.0");
    assert!(converted(text.as_bytes()).report.lost.is_empty());
    // Cubic keys of the user's tangents: each leaves with a slope of 4 a second, or lies flat.
    let cubic = |slope: u32| {
        text.replacen("a: 2\n", "a: 1032\n", 1)
            .replace("a: 0,0,0,0", &format!("a: {slope},{slope},0,0"))
    };
    let bent = cubic(4.0_f32.to_bits());
    assert_ne!(bent, text);
    assert_eq!(
        lost(&converted(bent.as_bytes()), "keyed-property"),
        ["ghost.charge"]
    );
    assert!(converted(cubic(0).as_bytes()).report.lost.is_empty());
}

#[test]
fn only_layers_that_play_have_lines() {
    let text = String::from_utf8(field("a09_keyed_light_camera_material.fbx")).unwrap();
    let muted = |name: &str| {
        let layer = text.find("\tAnimationLayer: ").expect("it has a layer");
        let begin = layer + text[layer..].find('\n').expect("a line");
        format!(
            "{}\n\t\tProperties70:  {{\n\t\t\tP: \"{name}\", \"bool\", \"\", \"\",1\n\t\t}}{}",
            &text[..begin],
            &text[begin..]
        )
    };
    let lines = |text: &str| lost(&converted(text.as_bytes()), "keyed-property").len();
    assert_eq!(lines(&muted("Mute")), 0);
    assert_eq!(lines(&muted("Solo")), 4);
}

/// A layer that is muted and not by turns plays as it does at rest.
#[test]
fn keyed_layers_are_said() {
    let text = String::from_utf8(field("a08_visibility_curve.fbx")).unwrap();
    let keyed = |name: &str| {
        text.replace(
            "\"OP\",1005,1001, \"Visibility\"",
            &format!("\"OP\",1005,1004, \"{name}\""),
        )
    };
    let lines = |name: &str| lost(&converted(keyed(name).as_bytes()), "keyed-property");
    assert_ne!(keyed("Mute"), text);
    assert_eq!(lines("Mute"), ["Base.Mute"]);
    assert!(lines("Weight").is_empty());
}

#[test]
fn keyed_properties_are_said_one_by_one() {
    let made = converted(&field("a09_keyed_light_camera_material.fbx"));
    let said: BTreeSet<String> = lost(&made, "keyed-property").into_iter().collect();
    let wanted = [
        "sun.Intensity",
        "cam.FieldOfView",
        "neon.DiffuseColor",
        "t.Translation",
    ];
    assert_eq!(said, wanted.map(str::to_owned).into_iter().collect());
}

/// Blender keys a shape's weight at the mesh as well.
#[test]
fn weights_of_shapes_are_carried_whatever_else_they_are_keyed_at() {
    let file = ascii::strip(10.0);
    let end = "\tC: \"OP\",405,404";
    let at = |name: &str| {
        let link = format!("\tC: \"OP\",404,100, \"{name}\"\n{end}");
        converted(file.replace(end, &link).as_bytes())
    };
    assert!(file.contains(end));
    assert!(at("bulge").report.lost.is_empty());
    assert_eq!(lost(&at("other"), "keyed-property"), ["strip.other"]);
}

#[test]
fn what_has_no_place_is_counted() {
    let creases = format!(
        "\t\tEdges: *1 {{\n\t\t\ta: 0\n\t\t}}\n\t\tLayerElementEdgeCrease: 0 {{\n\t\t\tMappingInformationType: \"ByEdge\"\n\t\t\tReferenceInformationType: \"Direct\"\n{}\t\t}}\n",
        array("EdgeCrease", &[1.0])
    );
    let colours: String = (0..2)
        .map(|set| {
            format!(
                "\t\tLayerElementColor: {set} {{\n\t\t\tName: \"c{set}\"\n\t\t\tMappingInformationType: \"AllSame\"\n\t\t\tReferenceInformationType: \"Direct\"\n{}\t\t}}\n",
                array("Colors", &[2 * set, 0, 0, 1])
            )
        })
        .collect();
    let objects = geometry(1, &corners(DVec3::ZERO, DVec3::ONE), &(creases + &colours))
        + &model(2, "box", "Mesh", "")
        + "\tCollectionExclusive: 3, \"DisplayLayer::layer\", \"DisplayLayer\" {\n\t}\n"
        + "\tCollection: 4, \"SelectionSet::set\", \"SelectionSet\" {\n\t}\n"
        + "\tConstraint: 5, \"Constraint::aim\", \"Aim\" {\n\t}\n";
    let links = [(2, 0), (1, 2), (2, 3)];
    let links: String = links.iter().map(|&(from, to)| link(from, to)).collect();
    let made = converted(scene(1.0, &objects, &links).as_bytes());
    for what in ["crease", "colour-sets", "colour-range"] {
        assert_eq!(lost(&made, what), ["box"], "{what}");
    }
    for what in ["display-layer", "selection-set", "constraint"] {
        assert_eq!(lost(&made, what), ["1"], "{what}");
    }
}
