//! Materials, cameras, lights and what glTF cannot carry: right, or one line in `lost`.

use crate::hold::Failure;
use crate::play::Glb;
use crate::scene::{Camera, Light, Material, Picture, Scene, Shows, Target};
use dolomite_fbx::Report;
use gltf::camera::Projection;
use serde_json::Value;

fn failure<T>(kind: &'static str, detail: impl Into<String>) -> Result<T, Failure> {
    let detail = detail.into();
    Err(Failure { kind, detail })
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-5 * (1.0 + a.abs().max(b.abs()))
}

/// Holds all of them.
///
/// # Errors
/// The first that does not hold.
pub fn hold(scene: &Scene, report: &Report, glb: &Glb) -> Result<(), Failure> {
    let json = &glb.json;
    for (number, material) in scene.materials.iter().enumerate() {
        let worn = scene.nodes.iter().any(|node| match node.shows {
            Shows::Mesh(mesh) => scene.meshes[mesh].material == Some(number),
            _ => false,
        });
        if worn {
            hold_material(number, material, report, json)?;
        }
    }
    for node in &scene.nodes {
        match &node.shows {
            Shows::Camera(camera) => {
                hold_camera(&node.name, camera, scene.unit * 0.01, report, glb)?
            }
            Shows::Light(light) => hold_light(&node.name, light, report, json)?,
            _ => {}
        }
        let said = |word: &str| json.to_string().contains(word) || lost(report, &node.name);
        if node.hidden && matches!(node.shows, Shows::Mesh(_)) && !said("KHR_node_visibility") {
            return failure(
                "hidden",
                format!("{} is hidden, and nothing says so", node.name),
            );
        }
        if node.user.is_some() && !said("mass") {
            return failure(
                "user",
                format!("the property of {} is gone without a word", node.name),
            );
        }
    }
    keyed(scene, report, json)
}

/// A line says something of what is called so.
fn lost(report: &Report, name: &str) -> bool {
    report
        .lost
        .iter()
        .any(|lost| lost.name.contains(name) || lost.detail.contains(name))
}

/// Whether a node above is hidden, and no key that is heard shows it.
fn hidden_above(scene: &Scene, node: usize) -> bool {
    let layers = scene.stacks.iter().flat_map(|stack| stack.heard());
    let tracks: Vec<_> = layers.flat_map(|layer| &layer.tracks).collect();
    let shown = |node: usize| {
        let mut own = tracks
            .iter()
            .filter(|track| matches!(track.target, Target::Visibility(at) if at == node))
            .flat_map(|track| track.curves.iter().flatten());
        own.any(|curve| curve.keys.iter().any(|key| key.value > 0.0))
    };
    let mut above = std::iter::successors(scene.nodes[node].parent, |&at| scene.nodes[at].parent);
    above.any(|at| scene.nodes[at].hidden && !shown(at))
}

/// What is keyed and no transform: carried, or said to be lost.
fn keyed(scene: &Scene, report: &Report, json: &Value) -> Result<(), Failure> {
    let targets = scene
        .stacks
        .iter()
        .flat_map(|stack| stack.heard())
        .flat_map(|layer| &layer.tracks);
    for track in targets.filter(|track| {
        track
            .curves
            .iter()
            .flatten()
            .any(|curve| curve.keys.len() > 1)
    }) {
        let name = match track.target {
            Target::Visibility(node) | Target::Intensity(node) | Target::FieldOfView(node) => {
                scene.nodes[node].name.clone()
            }
            Target::Diffuse(material) => format!("m{material}"),
            _ => continue,
        };
        let still = |curve: &crate::scene::Curve| {
            curve
                .keys
                .iter()
                .all(|key| key.value == curve.keys[0].value)
        };
        if track.curves.iter().flatten().all(still) {
            continue;
        }
        // Whoever is hidden with a node above, whatever keys say, shows nothing that could be lost.
        if matches!(track.target, Target::Visibility(node) if hidden_above(scene, node)) {
            continue;
        }
        let carried = json.to_string().contains("KHR_animation_pointer")
            || matches!(track.target, Target::Visibility(node) if scaled(json, &scene.nodes[node].name));
        if !carried && !lost(report, &name) {
            return failure(
                "keyed",
                format!(
                    "keys of {:?} ({name}) are gone without a word",
                    track.target
                ),
            );
        }
    }
    Ok(())
}

/// Something scales a node: that is how visibility can be keyed.
fn scaled(json: &Value, name: &str) -> bool {
    let names = |node: &Value| {
        node["name"]
            .as_str()
            .is_some_and(|own| own.starts_with(name))
    };
    let clips = json["animations"].as_array().into_iter().flatten();
    let mut targets = clips
        .flat_map(|clip| clip["channels"].as_array().into_iter().flatten())
        .map(|c| &c["target"]);
    targets.any(|target| {
        let node = target["node"]
            .as_u64()
            .map(|node| &json["nodes"][node as usize]);
        target["path"] == "scale" && node.is_some_and(names)
    })
}

fn hold_material(
    number: usize,
    material: &Material,
    report: &Report,
    json: &Value,
) -> Result<(), Failure> {
    let name = format!("m{number}");
    let made = json["materials"]
        .as_array()
        .into_iter()
        .flatten()
        .find(|made| made["name"] == name.as_str());
    let Some(made) = made else {
        return failure("material", format!("there is no material {name}"));
    };
    let pbr = &made["pbrMetallicRoughness"];
    let list = |value: &Value, without: &[f64]| -> Vec<f64> {
        let numbers = value
            .as_array()
            .map(|all| all.iter().filter_map(Value::as_f64).collect());
        numbers.unwrap_or_else(|| without.to_vec())
    };
    let base = list(&pbr["baseColorFactor"], &[1.0; 4]);
    // 1 - factor times the mean of the colour, the factor alone where there is none.
    let mean = material
        .transparent
        .map_or(1.0, |colour| colour.iter().sum::<f64>() / 3.0);
    let alpha = 1.0 - material.transparency.unwrap_or(0.0) * mean;
    if !near(base[3], alpha) {
        return failure(
            "alpha",
            format!("{name}: an alpha of {}, {alpha} is right", base[3]),
        );
    }
    let mode = made["alphaMode"].as_str().unwrap_or("OPAQUE");
    if (mode == "OPAQUE") != (alpha >= 1.0) {
        return failure("alpha", format!("{name}: {mode} at an alpha of {alpha}"));
    }
    let picture = |slot: &str| {
        material
            .pictures
            .iter()
            .find(|picture| picture.slot == slot)
    };
    if picture("DiffuseColor").is_none() && !(0..3).all(|i| near(base[i], material.diffuse[i])) {
        return failure(
            "colour",
            format!("{name}: {base:?}, {:?} is right", material.diffuse),
        );
    }
    let strength = made["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"]
        .as_f64()
        .unwrap_or(1.0);
    let emissive: Vec<f64> = list(&made["emissiveFactor"], &[0.0; 3])
        .iter()
        .map(|c| c * strength)
        .collect();
    let wanted = match picture("EmissiveColor") {
        Some(_) => [material.emissive_factor; 3],
        None => material.emissive.map(|c| c * material.emissive_factor),
    };
    if !(0..3).all(|i| near(emissive[i], wanted[i])) && !lost(report, &name) {
        return failure(
            "emission",
            format!("{name}: {emissive:?}, {wanted:?} is right"),
        );
    }
    let places = [
        ("DiffuseColor", &pbr["baseColorTexture"]),
        ("NormalMap", &made["normalTexture"]),
        ("EmissiveColor", &made["emissiveTexture"]),
    ];
    for (slot, made) in places {
        let dark = slot == "EmissiveColor" && material.emissive_factor == 0.0;
        if let Some(picture) = picture(slot).filter(|_| !dark) {
            hold_picture(&name, picture, made, report)?;
        }
    }
    Ok(())
}

/// Scaling repeats the picture, rotation turns what is scaled, and then it is moved; the file's V grows upwards and glTF's
/// downwards.
fn hold_picture(
    name: &str,
    picture: &Picture,
    made: &Value,
    report: &Report,
) -> Result<(), Failure> {
    if made.is_null() {
        return match lost(report, name) {
            true => Ok(()),
            false => failure(
                "picture",
                format!("{name}: the picture on {} is gone", picture.slot),
            ),
        };
    }
    let transform = &made["extensions"]["KHR_texture_transform"];
    let pair = |value: &Value, without: f64| [0, 1].map(|i| value[i].as_f64().unwrap_or(without));
    let (scale, offset) = (
        pair(&transform["scale"], 1.0),
        pair(&transform["offset"], 0.0),
    );
    let turn = transform["rotation"].as_f64().unwrap_or(0.0);
    // By where corners go, for a half turn can also be said by two minus signs.
    for corner in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]] {
        let (x, y) = (corner[0] * scale[0], corner[1] * scale[1]);
        let at = [
            turn.cos() * x + turn.sin() * y + offset[0],
            turn.cos() * y - turn.sin() * x + offset[1],
        ];
        let (u, v) = (
            picture.scaling[0] * corner[0],
            picture.scaling[1] * (1.0 - corner[1]),
        );
        let (sine, cosine) = picture.rotation.to_radians().sin_cos();
        let wanted = [
            cosine * u - sine * v + picture.translation[0],
            1.0 - (sine * u + cosine * v + picture.translation[1]),
        ];
        let right = near(at[0], wanted[0]) && near(at[1], wanted[1]);
        if !right && !lost(report, name) {
            return failure(
                "picture",
                format!(
                    "{name}, {}: {corner:?} goes to {at:?}, {wanted:?} is right",
                    picture.slot
                ),
            );
        }
    }
    Ok(())
}

fn hold_camera(
    name: &str,
    camera: &Camera,
    metres: f64,
    report: &Report,
    glb: &Glb,
) -> Result<(), Failure> {
    let node = glb.document.nodes().find(|node| node.name() == Some(name));
    let Some(made) = node.and_then(|node| node.camera()) else {
        return match lost(report, name) {
            true => Ok(()),
            false => failure("camera", format!("{name} is gone")),
        };
    };
    let (planes, size) = match made.projection() {
        Projection::Perspective(p) => (
            [Some(p.znear()), p.zfar()],
            f64::from(p.yfov()).to_degrees(),
        ),
        Projection::Orthographic(o) => ([Some(o.znear()), Some(o.zfar())], f64::from(o.ymag())),
    };
    let perspective = matches!(made.projection(), Projection::Perspective(_));
    if perspective != camera.perspective {
        return failure("camera", format!("{name}: another projection"));
    }
    if camera.perspective && !near(size, camera.angle) {
        return failure(
            "camera",
            format!("{name}: an angle of {size}, {} is right", camera.angle),
        );
    }
    for (made, wanted) in planes.into_iter().zip([camera.near, camera.far]) {
        let (made, wanted) = (f64::from(made.unwrap_or(0.0)), wanted * metres);
        if (made - wanted).abs() > 1e-5 * wanted {
            return failure(
                "camera",
                format!("{name}: a plane at {made} m, {wanted} m is right"),
            );
        }
    }
    Ok(())
}

fn hold_light(name: &str, light: &Light, report: &Report, json: &Value) -> Result<(), Failure> {
    let lights = &json["extensions"]["KHR_lights_punctual"]["lights"];
    let node = json["nodes"]
        .as_array()
        .into_iter()
        .flatten()
        .find(|node| node["name"] == name);
    let number = node.and_then(|node| node["extensions"]["KHR_lights_punctual"]["light"].as_u64());
    let Some(made) = number.map(|number| &lights[number as usize]) else {
        return match lost(report, name) {
            true => Ok(()),
            false => failure("light", format!("{name} is gone")),
        };
    };
    let colour: Vec<f64> = match made["color"].as_array() {
        Some(all) => all.iter().filter_map(Value::as_f64).collect(),
        None => vec![1.0; 3],
    };
    if colour.len() != 3 || !(0..3).all(|i| near(colour[i], light.colour[i])) {
        return failure(
            "light",
            format!("{name}: {colour:?}, {:?} is right", light.colour),
        );
    }
    let intensity = made["intensity"].as_f64().unwrap_or(1.0);
    if !near(intensity, light.intensity / 100.0) {
        return failure(
            "light",
            format!("{name}: {intensity}, {} is right", light.intensity / 100.0),
        );
    }
    Ok(())
}
