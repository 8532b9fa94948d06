//! Textures: how they are laid on, and by which coordinates.

use crate::support::looks::{Looks, text, vector, whole};
use crate::support::made::{field, json, lost, made, material, nothing_lost};
use dolomite_fbx::Conversion;

#[test]
fn a_tiled_material_is_tiled_on_every_texture() {
    let made = field("a01_tiled_normal_map");
    nothing_lost(&made);
    let json = json(&made);
    let material = &json["materials"][0];
    let wanted = serde_json::json!({ "offset": [0.0, -3.0], "scale": [4.0, 4.0] });
    for texture in [
        &material["pbrMetallicRoughness"]["baseColorTexture"],
        &material["normalTexture"],
        &material["emissiveTexture"],
    ] {
        assert_eq!(texture["extensions"]["KHR_texture_transform"], wanted);
    }
    assert_eq!(json["extensionsUsed"][0], "KHR_texture_transform");
    assert_eq!(json["images"].as_array().map(Vec::len), Some(2));
}

/// The material of 3ds Max that has a picture for everything, each laid on in its own way.
#[test]
fn each_texture_is_laid_on_in_its_own_way() {
    let mut file = Looks::default();
    let ids = whole("3dsMax|ClassIDa", 0xd00f_1e00) + &whole("3dsMax|ClassIDb", 0xbe77_e500);
    let all = file.material("all", "unknown", &ids);
    file.quad("wall", &[("map", 1.0)], all);
    let slots = [
        "base_color_map",
        "roughness_map",
        "norm_map",
        "ao_map",
        "emit_color_map",
    ];
    for (number, slot) in (1..).zip(slots) {
        let shift = vector("Translation", [f64::from(number) / 8.0, 0.5, 0.0]);
        let turn = vector("Rotation", [0.0, 0.0, 90.0]);
        let slot = format!("3dsMax|main|{slot}");
        file.texture("red.png", &(shift + &turn), all, &slot);
    }
    let made = made(&file);
    nothing_lost(&made);
    let json = json(&made);
    let material = &json["materials"][0];
    let pbr = &material["pbrMetallicRoughness"];
    let textures = [
        &pbr["baseColorTexture"],
        &pbr["metallicRoughnessTexture"],
        &material["normalTexture"],
        &material["occlusionTexture"],
        &material["emissiveTexture"],
    ];
    for (number, texture) in (1..).zip(textures) {
        let said = &texture["extensions"]["KHR_texture_transform"];
        let at = |key: &str, i: usize| said[key][i].as_f64().unwrap_or(f64::NAN);
        assert_eq!(said["rotation"].as_f64(), Some(1.570_796_4));
        assert_eq!((at("scale", 0), at("scale", 1)), (1.0, 1.0));
        // The upper left of the quad, (0, 1) in the file, is turned to (-1, 0) and moved.
        let wanted = (f64::from(number) / 8.0 - 1.0, 0.5);
        assert!((at("offset", 0) - wanted.0).abs() < 1e-6, "{said}");
        assert!((at("offset", 1) - wanted.1).abs() < 1e-6, "{said}");
    }
}

#[test]
fn what_cannot_be_laid_on_in_the_plane_is_said() {
    let mut file = Looks::default();
    let m = file.material("m", "phong", "");
    file.quad("wall", &[("map", 1.0)], m);
    let turn = vector("Rotation", [30.0, 40.0, 0.0]) + &vector("Scaling", [2.0, 2.0, 1.0]);
    file.texture("red.png", &turn, m, "DiffuseColor");
    let made = made(&file);
    assert_eq!(lost(&made, "texture-transform"), ["red.png"]);
    let texture = material(&made, "m").base_texture.clone().unwrap();
    assert_eq!(texture.transform, Some(([0.0, -1.0], 0.0, [2.0, 2.0])));
}

#[test]
fn a_border_goes_on_along_one_axis_alone() {
    let mut file = Looks::default();
    let m = file.material("m", "phong", "");
    file.quad("wall", &[("map", 1.0)], m);
    file.texture("red.png", &whole("WrapModeV", 1), m, "DiffuseColor");
    let made = made(&file);
    nothing_lost(&made);
    let json = json(&made);
    let sampler = &json["samplers"][0];
    let wraps = ["wrapS", "wrapT"].map(|axis| sampler[axis].as_u64());
    // Repeat, and clamp to edge.
    assert_eq!(wraps, [Some(10_497), Some(33_071)]);
}

/// The largest U of the set that a mesh's base texture is looked up with.
fn largest_u(made: &Conversion, mesh: &str) -> f32 {
    let mut meshes = made.model.meshes.iter();
    let mesh = meshes.find(|m| m.name == mesh).expect("it is there");
    let part = &mesh.parts[0];
    let material = &made.model.materials[part.material.expect("it wears one")];
    let texture = material.base_texture.as_ref().expect("it has one");
    let uvs = &part.uvs[texture.uv_set as usize];
    uvs.iter().map(|uv| uv[0]).fold(f32::MIN, f32::max)
}

#[test]
fn uv_sets_are_found_by_name_in_each_mesh() {
    let made = field("a17b_uv_sets_other_order");
    nothing_lost(&made);
    for mesh in ["first", "second"] {
        assert_eq!(largest_u(&made, mesh), 1.0, "{mesh}");
    }
    for mesh in &made.model.meshes {
        assert_eq!(mesh.parts[0].uvs.len(), 2, "no set is lost");
    }
}

#[test]
fn two_textures_find_their_sets_in_every_mesh() {
    let mut file = Looks::default();
    let m = file.material("m", "phong", "");
    file.texture("red.png", &text("UVSet", "far"), m, "DiffuseColor");
    file.texture("blue.png", &text("UVSet", "near"), m, "NormalMap");
    file.quad("a", &[("x", 3.0), ("near", 2.0), ("far", 5.0)], m);
    file.quad("b", &[("far", 5.0), ("near", 2.0)], m);
    let made = made(&file);
    nothing_lost(&made);
    for mesh in ["a", "b"] {
        assert_eq!(largest_u(&made, mesh), 5.0, "{mesh}");
    }
    let material = material(&made, "m");
    let normals = material.normal_texture.as_ref().unwrap();
    // Bevy reads two sets.
    assert!(material.textures().all(|texture| texture.uv_set < 2));
    for mesh in &made.model.meshes {
        let uvs = &mesh.parts[0].uvs[normals.uv_set as usize];
        assert_eq!(uvs.iter().map(|uv| uv[0]).fold(f32::MIN, f32::max), 2.0);
        assert!(!mesh.parts[0].tangents.is_empty());
    }
    assert_eq!(made.model.meshes[0].parts[0].uvs.len(), 3);
}

#[test]
fn meshes_that_agree_keep_their_order() {
    let mut file = Looks::default();
    let m = file.material("m", "phong", "");
    file.texture("red.png", &text("UVSet", "light"), m, "DiffuseColor");
    file.quad("a", &[("map", 1.0), ("light", 0.5)], m);
    let made = made(&file);
    let uvs = &made.model.meshes[0].parts[0].uvs;
    let most = |set: usize| uvs[set].iter().map(|uv| uv[0]).fold(f32::MIN, f32::max);
    assert_eq!((most(0), most(1)), (1.0, 0.5));
    assert_eq!(largest_u(&made, "a"), 0.5);
}

#[test]
fn a_set_that_is_missing_is_said() {
    let mut file = Looks::default();
    let m = file.material("m", "phong", "");
    file.texture("red.png", &text("UVSet", "map"), m, "DiffuseColor");
    file.quad("has", &[("other", 2.0), ("map", 1.0)], m);
    file.quad("lacks", &[("x", 4.0), ("y", 3.0)], m);
    file.quad("bare", &[], m);
    let any = file.material("any", "phong", "");
    file.texture("red.png", &text("UVSet", "default"), any, "DiffuseColor");
    file.quad("first", &[("x", 7.0)], any);
    let made = made(&file);
    assert_eq!(lost(&made, "uv-set"), ["has", "lacks", "bare"][1..]);
    assert_eq!(largest_u(&made, "has"), 1.0);
    assert_eq!(largest_u(&made, "lacks"), 4.0);
    // glTF wants coordinates where there is a texture.
    assert_eq!(largest_u(&made, "bare"), 0.0);
    assert_eq!(largest_u(&made, "first"), 7.0);
}

/// A normal map that is turned on the surface is followed by its tangents.
#[test]
fn tangents_follow_the_picture() {
    let tangent = |turn: f64| {
        let mut file = Looks::default();
        let m = file.material("m", "phong", "");
        file.texture(
            "blue.png",
            &vector("Rotation", [0.0, 0.0, turn]),
            m,
            "NormalMap",
        );
        file.quad("a", &[("map", 1.0)], m);
        made(&file).model.meshes[0].parts[0].tangents[0]
    };
    let ([x, .., side], [turned, .., turned_side]) = (tangent(0.0), tangent(180.0));
    assert!(
        (x - 1.0).abs() < 1e-5 && (turned + 1.0).abs() < 1e-5,
        "{x} {turned}"
    );
    assert_eq!(side, turned_side);
}

#[test]
fn of_several_layers_the_first_is_kept() {
    let mut file = Looks::default();
    let m = file.material("m", "phong", "");
    file.quad("a", &[("map", 1.0)], m);
    let layers = file.layered(m, "DiffuseColor");
    for picture in ["red.png", "blue.png"] {
        let scaling = vector("Scaling", [2.0, 2.0, 1.0]);
        let layer = file.texture(picture, &scaling, m, "Nothing");
        file.connect(layer, layers);
    }
    let two = file.material("two", "phong", "");
    file.quad("b", &[("map", 1.0)], two);
    for picture in ["blue.png", "red.png"] {
        file.texture(picture, "", two, "DiffuseColor");
    }
    let made = made(&file);
    let picture = |name| {
        let texture = material(&made, name).base_texture.clone().unwrap();
        (
            made.model.images[texture.image].name.clone(),
            texture.transform,
        )
    };
    let tiled = Some(([0.0, -1.0], 0.0, [2.0, 2.0]));
    assert_eq!(picture("m"), ("red.png".to_owned(), tiled));
    assert_eq!(picture("two"), ("blue.png".to_owned(), None));
    let lines = lost(&made, "texture-layers");
    assert!(
        lines.len() == 3 && lines.contains(&"two") && lines.contains(&"m"),
        "{lines:?}"
    );
}
