//! What files hide: carried where glTF can say it, else said in `lost`.

use crate::support::ascii;
use crate::support::scene::{converted, corners, field, geometry, json, link, lost, model, scene};
use dolomite_fbx::Conversion;
use glam::DVec3;
use serde_json::{Value, json};
use std::collections::BTreeSet;

/// A property of a node.
fn property(name: &str, kind: &str, flags: &str, value: u32) -> String {
    format!("\t\t\tP: \"{name}\", {kind}, \"{flags}\",{value}\n")
}

/// A node's own visibility.
fn visibility(value: u32) -> String {
    property("Visibility", "\"Visibility\", \"\"", "A", value)
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
    let off = visibility(0);
    let no_show = property("Show", "\"bool\", \"\"", "", 0);
    let alone = property(
        "Visibility Inheritance",
        "\"Visibility Inheritance\", \"\"",
        "",
        0,
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
    // All see it, not only readers without the extension.
    assert!(line(&made, "hidden", "half").ends_with("it is shown"));
    assert!(line(&made, "hidden", "off").contains("KHR_node_visibility"));
}

/// The sentence of a line.
fn line(made: &Conversion, what: &str, name: &str) -> String {
    let mut lines = made.report.lost.iter();
    let found = lines.find(|lost| lost.what == what && lost.name == name);
    found.expect("there is one").detail.clone()
}

#[test]
fn keyed_visibility_is_said() {
    let made = converted(&field("a08_visibility_curve.fbx"));
    assert_eq!(lost(&made, "keyed-visibility"), ["ghost"]);
    assert!(hidden(&json(&made)).is_empty());
    let detail = line(&made, "keyed-visibility", "ghost");
    assert!(detail.contains("shown for 1.000 s of 2.000 s"), "{detail}");
    // Keys that say what is so without them are no loss.
    let text = String::from_utf8(field("a08_visibility_curve.fbx")).unwrap();
    let still = text.replace("a: 1.0,0.0,1.0", "a: 1.0,1.0,1.0");
    assert_ne!(still, text);
    assert!(converted(still.as_bytes()).report.lost.is_empty());
}

/// A file with `keys` of the visibility of node 1001, which has a mesh, and which is `value` at rest.
fn ghost(value: &str, keys: &str) -> String {
    let text = String::from_utf8(field("a08_visibility_curve.fbx")).expect("a text");
    let rest = "P: \"Visibility\", \"Visibility\", \"\", \"A\",";
    let changed = text
        .replace(&format!("{rest}1.0"), &format!("{rest}{value}"))
        .replace("a: 1.0,0.0,1.0", &format!("a: {keys}"));
    assert_ne!(changed, text);
    changed
}

/// Puts node 11, which `properties` are of, above node 1001.
fn below(text: &str, name: &str, properties: &str) -> String {
    let group = model(11, name, "Null", properties);
    let made = text
        .replace("Objects:  {\n", &format!("Objects:  {{\n{group}"))
        .replace("\"OO\",1001,0", "\"OO\",1001,11")
        .replace(
            "Connections:  {\n",
            &format!("Connections:  {{\n{}", link(11, 0)),
        );
    assert_ne!(made, text);
    made
}

/// What exporters bake for what is never seen.
#[test]
fn keys_that_never_show_are_no_keys() {
    let made = converted(ghost("0.0", "0.0,0.0,0.0").as_bytes());
    assert_eq!(hidden(&json(&made)), ["ghost"]);
    assert_eq!(lost(&made, "hidden"), ["ghost"]);
    assert!(lost(&made, "keyed-visibility").is_empty());
}

#[test]
fn keys_of_a_group_show_what_is_below_it() {
    let text = below(&ghost("1.0", "0.0,1.0,0.0"), "group", &visibility(0));
    let text = text.replace("\"OP\",1005,1001", "\"OP\",1005,11");
    let made = converted(text.as_bytes());
    assert!(hidden(&json(&made)).is_empty());
    assert!(lost(&made, "hidden").is_empty());
    assert_eq!(lost(&made, "keyed-visibility"), ["group"]);
}

/// What a group hides for good no keys below it show.
#[test]
fn keys_below_a_hidden_group_change_nothing() {
    let text = below(&ghost("1.0", "0.0,1.0,0.0"), "group", &visibility(0));
    let made = converted(text.as_bytes());
    assert_eq!(hidden(&json(&made)), ["group"]);
    assert_eq!(lost(&made, "hidden"), ["ghost"]);
    assert!(lost(&made, "keyed-visibility").is_empty());
}

#[test]
fn keys_of_a_muted_layer_show_nothing() {
    let text = ghost("0.0", "0.0,1.0,0.0");
    let muted = text.replace(
        "\"AnimLayer::Base\", \"\" {\n",
        "\"AnimLayer::Base\", \"\" {\n\t\tProperties70:  {\n\t\t\tP: \"Mute\", \"bool\", \"\", \"\",1\n\t\t}\n",
    );
    assert_ne!(muted, text);
    let made = converted(muted.as_bytes());
    assert_eq!(hidden(&json(&made)), ["ghost"]);
    assert_eq!(lost(&made, "hidden"), ["ghost"]);
    assert!(lost(&made, "keyed-visibility").is_empty());
    let made = converted(text.as_bytes());
    assert!(hidden(&json(&made)).is_empty());
    assert_eq!(lost(&made, "keyed-visibility"), ["ghost"]);
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
    let off = format!("{node}\t\tProperties70:  {{\n{}\t\t}}\n", visibility(0));
    assert!(shown.contains(node));
    let made = converted(shown.replace(node, &off).as_bytes());
    // The file's node, which the file's axes turn, and the one that shows the mesh.
    assert_eq!(hidden(&json(&made)), ["strip", "strip"]);
    let skinned = made.model.nodes.iter().position(|n| n.skin.is_some());
    assert!(skinned.is_some_and(|node| made.model.hidden.contains(&node)));
    assert!(hidden(&json(&converted(shown.as_bytes()))).is_empty());
}

#[test]
fn skinned_meshes_that_keys_show_are_shown() {
    let node = "Model: 200, \"Model::strip\", \"Mesh\" {\n\t\tVersion: 232\n";
    let curve = ascii::curve(411, 0.0, 1.0, 1);
    let keys = format!(
        "\tAnimationCurveNode: 410, \"AnimCurveNode::V\", \"\" {{\n\t\tProperties70:  {{\n\t\t\tP: \"d|Visibility\", \"Number\", \"\", \"A\",0\n\t\t}}\n\t}}\n{curve}"
    );
    let links = "\tC: \"OO\",410,401\n\tC: \"OP\",410,200, \"Visibility\"\n\tC: \"OP\",411,410, \"d|Visibility\"\n";
    let off = format!("{node}\t\tProperties70:  {{\n{}\t\t}}\n", visibility(0));
    let text = ascii::strip(10.0)
        .replace(node, &off)
        .replace("Objects:  {\n", &format!("Objects:  {{\n{keys}"))
        .replace("Connections:  {\n", &format!("Connections:  {{\n{links}"));
    let made = converted(text.as_bytes());
    assert!(hidden(&json(&made)).is_empty());
    assert!(lost(&made, "hidden").is_empty());
    assert_eq!(lost(&made, "keyed-visibility"), ["strip"]);
}
