//! Cases from the field: small files of `data/field/fbx` in the shared data, each with what is right, as its README says.
//! Each of these checks finds the fault that the file was made for.

use crate::play::Glb;
use dolomite_fbx::check::Truth;
use dolomite_fbx::{Conversion, Options, Origin, Report, convert};
use glam::{DQuat, DVec3};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// A case.
pub struct Case {
    /// Name of the file without its ending.
    pub file: &'static str,
    /// What is right, in words.
    pub right: &'static str,
    hold: fn(&Made) -> Result<(), String>,
}

/// A converted case.
struct Made {
    conversion: Conversion,
    glb: Glb,
    bytes: Vec<u8>,
}

/// All cases.
pub const CASES: [Case; 15] = [
    Case {
        file: "a26c_dance_30_joints_60_s",
        right: "b1 turns by 60 degrees and back as Hermite's cubic says, for a minute",
        hold: dance,
    },
    Case {
        file: "a25d_prop_30_rps_10_s",
        right: "thirty turns a second",
        hold: prop,
    },
    Case {
        file: "a01_tiled_normal_map",
        right: "a scale of [4, 4] and an offset of [0, -3] on base colour, normal and emission",
        hold: tiled,
    },
    Case {
        file: "a02_opacity_ways",
        right: "an alpha of 0.4, 1, 1, 0.5 and 0.3, blended below 1",
        hold: opacity,
    },
    Case {
        file: "a13b_camera_cm",
        right: "planes at 0.1 and 40 m",
        hold: cameras,
    },
    Case {
        file: "a12c_house_utm",
        right: "vertices as far from each other as in the file",
        hold: house,
    },
    Case {
        file: "a11_emissive_above_one",
        right: "an emission of (5, 2, 0) and (2, 1, 0.5), or a line each",
        hold: emission,
    },
    Case {
        file: "a08_visibility_curve",
        right: "keys of visibility carried, or a line",
        hold: |made| said(made, &["ghost"], "KHR_node_visibility"),
    },
    Case {
        file: "a09_keyed_light_camera_material",
        right: "keys of light, camera and material carried, or a line each",
        hold: |made| said(made, &["sun", "cam", "neon"], "KHR_animation_pointer"),
    },
    Case {
        file: "a10_user_properties",
        right: "properties of users in extras, or a line",
        hold: |made| said(made, &["crate"], "hitpoints"),
    },
    Case {
        file: "a04d_pose_clip",
        right: "two seconds of one pose last two seconds",
        hold: pose,
    },
    Case {
        file: "a07_sjis_names",
        right: "two clips of two names that can be read, or that are told apart and said",
        hold: names,
    },
    Case {
        file: "a17b_uv_sets_other_order",
        right: "both meshes show their set `map`, whose largest U is 1",
        hold: uv_sets,
    },
    Case {
        file: "a21_top_apart",
        // Its groups are 1, 1, 1, 2, 1, 1: the other five faces share one.
        right: "12 corners: four of the top, straight up, and eight that the five others share",
        hold: hard_edges,
    },
    Case {
        file: "a22b_muted",
        right: "a muted layer does not turn the cube",
        hold: muted,
    },
];

/// The folder of the cases; `None` where the shared data lacks it.
pub fn folder() -> Option<PathBuf> {
    let shared = std::env::var_os("DOLOMITE_SHARED").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared"),
        PathBuf::from,
    );
    Some(shared.join("data/field/fbx")).filter(|folder| folder.is_dir())
}

impl Case {
    /// Converts the case's file, as it lies in `folder`, and holds what came of it.
    ///
    /// # Errors
    /// What is not right.
    pub fn hold(&self, folder: &Path) -> Result<(), String> {
        let path = folder.join(format!("{}.fbx", self.file));
        let bytes = std::fs::read(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        let origin = Origin {
            name: path.display().to_string(),
            folder: Some(folder.to_owned()),
            ..Origin::default()
        };
        let conversion =
            convert(&bytes, &origin, &Options::default()).map_err(|error| error.to_string())?;
        let glb = Glb::read(&conversion.to_glb().map_err(|error| error.to_string())?)?;
        (self.hold)(&Made {
            conversion,
            glb,
            bytes,
        })
    }
}

impl Made {
    fn report(&self) -> &Report {
        &self.conversion.report
    }

    fn lost(&self, name: &str) -> bool {
        let of = |lost: &dolomite_fbx::Lost| lost.name.contains(name) || lost.detail.contains(name);
        self.report().lost.iter().any(of)
    }

    fn list(&self, what: &str) -> impl Iterator<Item = &Value> {
        self.glb.json[what].as_array().into_iter().flatten()
    }

    /// How a node stands to what it hangs on, at a time of the first clip.
    fn turn(&self, name: &str, time: f64) -> Result<DQuat, String> {
        let of_name = |node: &crate::play::Joint| node.name == name;
        let number = self
            .glb
            .nodes
            .iter()
            .position(of_name)
            .ok_or(format!("no node {name}"))?;
        if self.glb.clips().is_empty() {
            return Err("no clip".into());
        }
        let posed = self.glb.at(Some(0), time);
        let world = |node: usize| posed.worlds[node].to_scale_rotation_translation().1;
        let above = self.glb.nodes[number].parent.map_or(DQuat::IDENTITY, world);
        Ok(above.inverse() * world(number))
    }

    /// The largest angle between a node's turn and the one about Z that `right` says, degrees, over `seconds`.
    fn off(&self, name: &str, seconds: f64, right: impl Fn(f64) -> f64) -> Result<f64, String> {
        let mut most = 0.0_f64;
        // A number of steps that no rate of keys or turns divides.
        for step in 0..=997 {
            let time = seconds * f64::from(step) / 997.0;
            let wanted = DQuat::from_rotation_z((right(time) % 360.0).to_radians());
            most = most.max(self.turn(name, time)?.angle_between(wanted).to_degrees());
        }
        Ok(most)
    }
}

fn wrong<T>(what: impl Into<String>) -> Result<T, String> {
    Err(what.into())
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-4 * (1.0 + b.abs())
}

fn dance(made: &Made) -> Result<(), String> {
    let right = |time: f64| {
        let (leg, u) = ((time / 2.0).floor() as i64, (time / 2.0).fract());
        let there = u * u * (3.0 - 2.0 * u);
        60.0 * if leg % 2 == 0 { there } else { 1.0 - there }
    };
    let off = made.off("b1", 60.0, right)?;
    // Half a metre of joints hangs on it, and a bound of at most a tenth of a millimetre.
    match off < 0.02 {
        true => Ok(()),
        false => wrong(format!(
            "off by {off} degrees, {:e} m stated",
            made.report().error()
        )),
    }
}

fn prop(made: &Made) -> Result<(), String> {
    let off = made.off("prop", 10.0, |time| 360.0 * 30.0 * time)?;
    match off < 0.05 {
        true => Ok(()),
        false => wrong(format!(
            "off by {off} degrees, {:e} m stated",
            made.report().error()
        )),
    }
}

fn tiled(made: &Made) -> Result<(), String> {
    let material = &made.glb.json["materials"][0];
    let maps = [
        (
            "base colour",
            &material["pbrMetallicRoughness"]["baseColorTexture"],
        ),
        ("normal", &material["normalTexture"]),
        ("emission", &material["emissiveTexture"]),
    ];
    for (name, map) in maps {
        let transform = &map["extensions"]["KHR_texture_transform"];
        let is = |what: &str, right: [f64; 2]| {
            (0..2).all(|i| {
                transform[what][i]
                    .as_f64()
                    .is_some_and(|x| near(x, right[i]))
            })
        };
        if !is("scale", [4.0, 4.0]) || !is("offset", [0.0, -3.0]) {
            return wrong(format!("{name}: {transform}"));
        }
        if transform.get("texCoord").is_some_and(Value::is_null) {
            return wrong(format!("{name}: a texCoord of null"));
        }
    }
    Ok(())
}

fn opacity(made: &Made) -> Result<(), String> {
    let rights = [
        ("factor_alone_06", 0.4),
        ("maya_opaque", 1.0),
        ("max_opaque", 1.0),
        ("maya_half", 0.5),
        ("opacity_prop_03", 0.3),
    ];
    for (name, right) in rights {
        let Some(material) = made
            .list("materials")
            .find(|material| material["name"] == name)
        else {
            return wrong(format!("no material {name}"));
        };
        let alpha = material["pbrMetallicRoughness"]["baseColorFactor"][3]
            .as_f64()
            .unwrap_or(1.0);
        let opaque = material["alphaMode"]
            .as_str()
            .is_none_or(|mode| mode == "OPAQUE");
        if !near(alpha, right) || opaque != (right == 1.0) {
            return wrong(format!("{name}: {alpha}, {}", material["alphaMode"]));
        }
    }
    Ok(())
}

fn cameras(made: &Made) -> Result<(), String> {
    for camera in made.list("cameras") {
        let planes = if camera["type"] == "orthographic" {
            &camera["orthographic"]
        } else {
            &camera["perspective"]
        };
        let is = |what: &str, right: f64| planes[what].as_f64().is_some_and(|x| near(x, right));
        if !is("znear", 0.1) || !is("zfar", 40.0) {
            return wrong(planes.to_string());
        }
    }
    match made.list("cameras").count() {
        2 => Ok(()),
        count => wrong(format!("{count} cameras")),
    }
}

fn house(made: &Made) -> Result<(), String> {
    let truth = Truth::load(&made.bytes, &Origin::default()).map_err(|error| error.to_string())?;
    let (bodies, _) = truth.at(None, 0.0).map_err(|error| error.to_string())?;
    let space = truth.space();
    let posed = made.glb.at(None, 0.0);
    let shown = made
        .glb
        .nodes
        .iter()
        .position(|node| node.mesh.is_some())
        .ok_or("no mesh")?;
    let points = made.glb.points(shown, &posed);
    let sources = made.conversion.sources();
    let Some((_, vertices)) = made.glb.nodes[shown]
        .mesh
        .and_then(|mesh| sources.get(&mesh))
    else {
        return wrong("no vertices");
    };
    let wanted = |vertex: u32| {
        bodies[0]
            .points
            .get(vertex as usize)
            .map_or(DVec3::INFINITY, |p| space.to_gltf(*p))
    };
    let mut most = 0.0_f64;
    for (point, &vertex) in points.iter().zip(vertices) {
        let shift = (*point - points[0]) - (wanted(vertex) - wanted(vertices[0]));
        most = most.max(shift.length());
    }
    match most < 1e-3 {
        true => Ok(()),
        false => wrong(format!(
            "off by {most} m, {:e} m stated",
            made.report().error()
        )),
    }
}

fn emission(made: &Made) -> Result<(), String> {
    for (name, right) in [("lava", [5.0, 2.0, 0.0]), ("lamp", [2.0, 1.0, 0.5])] {
        let Some(material) = made
            .list("materials")
            .find(|material| material["name"] == name)
        else {
            return wrong(format!("no material {name}"));
        };
        let strength =
            material["extensions"]["KHR_materials_emissive_strength"]["emissiveStrength"]
                .as_f64()
                .unwrap_or(1.0);
        let part = |i: usize| material["emissiveFactor"][i].as_f64().unwrap_or(0.0) * strength;
        if !(0..3).all(|i| near(part(i), right[i])) && !made.lost(name) {
            return wrong(format!("{name}: {:?}", [part(0), part(1), part(2)]));
        }
    }
    Ok(())
}

/// Each of `names` has a line, or the file holds `carrier`.
fn said(made: &Made, names: &[&str], carrier: &str) -> Result<(), String> {
    let text = made.glb.json.to_string();
    let scaled = made.list("animations").any(|clip| {
        let mut channels = clip["channels"].as_array().into_iter().flatten();
        carrier == "KHR_node_visibility"
            && channels.any(|channel| channel["target"]["path"] == "scale")
    });
    match names
        .iter()
        .find(|name| !text.contains(carrier) && !scaled && !made.lost(name))
    {
        None => Ok(()),
        Some(name) => wrong(format!("no {carrier}, and no line of {name}")),
    }
}

fn pose(made: &Made) -> Result<(), String> {
    match made.glb.clips().first() {
        Some((_, seconds)) if near(*seconds, 2.0) => Ok(()),
        other => wrong(format!("{other:?}")),
    }
}

fn names(made: &Made) -> Result<(), String> {
    let names: Vec<String> = made.glb.clips().into_iter().map(|clip| clip.0).collect();
    let readable = names.iter().all(|name| !name.contains('\u{fffd}'));
    match names.len() == 2 && names[0] != names[1] && (readable || !made.report().lost.is_empty()) {
        true => Ok(()),
        false => wrong(format!("{names:?}")),
    }
}

fn uv_sets(made: &Made) -> Result<(), String> {
    let mut shown = 0;
    for mesh in made.list("meshes") {
        for part in mesh["primitives"].as_array().into_iter().flatten() {
            let material = part["material"].as_u64().ok_or("no material")? as usize;
            let map =
                &made.glb.json["materials"][material]["pbrMetallicRoughness"]["baseColorTexture"];
            let set = map["texCoord"].as_u64().unwrap_or(0) as usize;
            let primitive = made
                .glb
                .document
                .meshes()
                .nth(shown)
                .and_then(|mesh| mesh.primitives().next());
            let accessor = primitive
                .and_then(|p| p.get(&gltf::Semantic::TexCoords(set as u32)))
                .ok_or("no such set")?;
            let most = made
                .conversion
                .model
                .meshes
                .get(shown)
                .and_then(|mesh| mesh.parts.first());
            let most = most
                .and_then(|part| part.uvs.get(set))
                .map(|uvs| uvs.iter().map(|uv| uv[0]).fold(0.0, f32::max));
            if accessor.count() == 0 || !most.is_some_and(|u| near(f64::from(u), 1.0)) {
                return wrong(format!("{}: the largest U is {most:?}", mesh["name"]));
            }
        }
        shown += 1;
    }
    match shown {
        2 => Ok(()),
        count => wrong(format!("{count} meshes")),
    }
}

fn hard_edges(made: &Made) -> Result<(), String> {
    let parts = || {
        made.conversion
            .model
            .meshes
            .iter()
            .flat_map(|mesh| &mesh.parts)
    };
    let count: usize = parts().map(|part| part.positions.len()).sum();
    let along = |normal: &[f32; 3]| normal.iter().any(|x| near(f64::from(x.abs()), 1.0));
    let normals = parts().flat_map(|part| &part.normals);
    match count == 12 && normals.filter(|normal| along(normal)).count() == 4 {
        true => Ok(()),
        false => wrong(format!("{count} corners")),
    }
}

fn muted(made: &Made) -> Result<(), String> {
    let off = made
        .turn("cube", 1.0)?
        .angle_between(DQuat::IDENTITY)
        .to_degrees();
    match off < 0.01 {
        true => Ok(()),
        false => wrong(format!("turned by {off} degrees")),
    }
}
