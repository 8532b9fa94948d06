//! What else a file says: names in code pages, properties of users, visibility, keyed properties. Each
//! is carried or has a line in `lost`.

use crate::support::ascii;
use crate::support::scene::{
    array, converted, corners, field, geometry, json, link, lost, model, scene,
};
use glam::DVec3;
use serde_json::{Value, json};
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

/// Names of nodes that the document hides.
fn hidden(document: &serde_json::Value) -> Vec<String> {
    let nodes = document["nodes"].as_array().expect("a list of nodes");
    let off = nodes
        .iter()
        .filter(|node| node["extensions"]["KHR_node_visibility"]["visible"] == false);
    off.map(|node| node["name"].as_str().unwrap_or_default().to_owned())
        .collect()
}

#[test]
fn hidden_nodes_are_hidden_and_said() {
    let off = user("Visibility", "\"Visibility\", \"\"", "A", "0");
    let no_show = user("Show", "\"bool\", \"\"", "", "0");
    let alone = user(
        "Visibility Inheritance",
        "\"Visibility Inheritance\", \"\"",
        "",
        "0",
    );
    let objects = geometry(1, &corners(DVec3::ZERO, DVec3::ONE), "")
        + &model(2, "off", "Mesh", &off)
        + &model(3, "below", "Mesh", "")
        + &model(4, "shown", "Mesh", "")
        + &model(5, "half", "Mesh", &off)
        + &model(6, "alone", "Mesh", &alone)
        + &model(7, "no_show", "Mesh", &no_show)
        + &model(8, "layered", "Mesh", "")
        + "\tCollectionExclusive: 9, \"DisplayLayer::layer\", \"DisplayLayer\" {\n\t\tProperties70:  {\n\t\t\tP: \"Show\", \"bool\", \"\", \"\",0\n\t\t}\n\t}\n";
    let mut links = String::new();
    for (node, parent) in [(2, 0), (3, 2), (4, 0), (5, 0), (6, 5), (7, 0), (8, 0)] {
        links += &(link(node, parent) + &link(1, node));
    }
    links += &link(8, 9);
    let made = converted(scene(1.0, &objects, &links).as_bytes());
    let document = json(&made);
    // `half` has a child that does not go with it, and glTF's extension would hide that.
    assert_eq!(hidden(&document), ["off", "no_show", "layered"]);
    assert_eq!(document["extensionsUsed"], json!(["KHR_node_visibility"]));
    let said: BTreeSet<String> = lost(&made, "hidden").into_iter().collect();
    let wanted = ["off", "below", "half", "no_show", "layered"];
    assert_eq!(said, wanted.map(str::to_owned).into_iter().collect());
}

#[test]
fn keyed_visibility_is_said() {
    let made = converted(&field("a08_visibility_curve.fbx"));
    assert_eq!(lost(&made, "keyed-visibility"), ["ghost"]);
    assert!(hidden(&json(&made)).is_empty());
    let line = made
        .report
        .lost
        .iter()
        .find(|lost| lost.what == "keyed-visibility");
    let detail = &line.expect("there is one").detail;
    assert!(detail.contains("shown for 1.000 s of 2.000 s"), "{detail}");
    // Keys that say what is so without them are no loss.
    let text = String::from_utf8(field("a08_visibility_curve.fbx")).unwrap();
    let still = text.replace("a: 1.0,0.0,1.0", "a: 1.0,1.0,1.0");
    assert_ne!(still, text);
    assert!(converted(still.as_bytes()).report.lost.is_empty());
}

/// Why keys of visibility are not carried by KHR_animation_pointer: a reader that does not know it, Bevy's among them, refuses
/// the whole file. When this fails they can be.
#[test]
fn readers_refuse_files_with_pointers() {
    let mut document = json(&converted(&field("a08_visibility_curve.fbx")));
    let read = |document: &Value| gltf::Gltf::from_slice(document.to_string().as_bytes());
    assert!(read(&document).is_ok());
    document["extensionsUsed"] = json!(["KHR_animation_pointer", "KHR_node_visibility"]);
    document["animations"][0]["channels"][0]["target"] = json!({
        "path": "pointer",
        "extensions": { "KHR_animation_pointer": {
            "pointer": "/nodes/0/extensions/KHR_node_visibility/visible",
        } },
    });
    assert!(read(&document).is_err());
}

/// A mesh with a skin stands beside the tree, where nothing hides it but itself.
#[test]
fn skinned_meshes_are_hidden_too() {
    let shown = ascii::strip(10.0);
    let node = "Model: 200, \"Model::strip\", \"Mesh\" {\n\t\tVersion: 232\n";
    let off = format!(
        "{node}\t\tProperties70:  {{\n{}\t\t}}\n",
        user("Visibility", "\"Visibility\", \"\"", "A", "0")
    );
    assert!(shown.contains(node));
    let made = converted(shown.replace(node, &off).as_bytes());
    // The file's node, which the file's axes turn, and the one that shows the mesh.
    assert_eq!(hidden(&json(&made)), ["strip", "strip"]);
    let skinned = made.model.nodes.iter().position(|n| n.skin.is_some());
    assert!(skinned.is_some_and(|node| made.model.hidden.contains(&node)));
    assert!(hidden(&json(&converted(shown.as_bytes()))).is_empty());
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
                array("Colors", &[1, 0, 0, 1])
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
    for what in ["crease", "colour-sets"] {
        assert_eq!(lost(&made, what), ["box"], "{what}");
    }
    for what in ["display-layer", "selection-set", "constraint"] {
        assert_eq!(lost(&made, what), ["1"], "{what}");
    }
}
