//! UV sets: found by name in FBX, by number in glTF. One material serves many meshes, whose sets may
//! stand in any order, so the order is made to fit the material.

use super::uv_transform::transformed;
use crate::model::{Material, TextureUse};
use crate::report::Report;
use std::collections::BTreeSet;
use ufbx::Scene;

/// The most sets that Bevy reads.
const READ_BY_ALL: usize = 2;

/// The names of the UV sets that the textures of one material use, each once.
#[derive(Debug, Default)]
pub(crate) struct UvNames(Vec<String>);

impl UvNames {
    /// The number of `name` among them.
    pub(crate) fn number(&mut self, name: &str) -> u32 {
        let known = self.0.iter().position(|known| known == name);
        known.unwrap_or_else(|| {
            self.0.push(name.to_owned());
            self.0.len() - 1
        }) as u32
    }
}

/// Which of a mesh's UV sets are `TEXCOORD_0`, `TEXCOORD_1`, ... where it wears a material.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum UvOrder {
    /// As the mesh has them.
    OfMesh,
    /// Those of these names first, then the others.
    Named(Vec<String>),
}

impl UvOrder {
    /// The numbers of a mesh's sets, in the order that they are written in. A set that the mesh lacks
    /// is its first.
    fn of(&self, sets: &[&str]) -> Vec<usize> {
        let Self::Named(names) = self else {
            return (0..sets.len()).collect();
        };
        if sets.is_empty() {
            return Vec::new();
        }
        let mut order: Vec<usize> = names
            .iter()
            .map(|name| position(sets, name).unwrap_or(0))
            .collect();
        let rest: Vec<usize> = (0..sets.len()).filter(|set| !order.contains(set)).collect();
        order.extend(rest);
        order
    }

    /// Puts the `uvs` of a part with so many `corners` into the order that its `material` needs. Where
    /// the mesh has no set, one of a single point is made: glTF wants one where there is a texture.
    pub(crate) fn arrange(
        &self,
        uvs: Vec<Vec<[f32; 2]>>,
        sets: &[&str],
        material: &Material,
        corners: usize,
    ) -> Vec<Vec<[f32; 2]>> {
        if uvs.is_empty() {
            let needed = material.textures().map(|t| t.uv_set + 1).max();
            let point = vec![[0.0, 1.0]; corners];
            return vec![point; needed.unwrap_or(0) as usize];
        }
        let order = self.of(sets);
        if order.iter().copied().eq(0..uvs.len()) {
            return uvs;
        }
        let pick = |set: usize| uvs.get(set).cloned().unwrap_or_default();
        order.into_iter().map(pick).collect()
    }
}

/// Texture coordinates as the picture of `texture` is looked up with them.
pub(crate) fn looked_up(uvs: &[[f32; 2]], texture: &TextureUse) -> Vec<[f32; 2]> {
    match texture.transform {
        Some(by) => uvs.iter().map(|&uv| transformed(uv, by)).collect(),
        None => uvs.to_vec(),
    }
}

/// A mesh that wears a material.
#[derive(Debug)]
pub(crate) struct Wearer {
    name: String,
    sets: Vec<String>,
}

/// For each material, the meshes that have a triangle of it.
pub(crate) fn wearers(scene: &Scene) -> Vec<Vec<Wearer>> {
    let mut all: Vec<Vec<Wearer>> = (0..scene.materials.len()).map(|_| Vec::new()).collect();
    for mesh in &scene.meshes {
        let mut worn = BTreeSet::new();
        for node in &mesh.element.instances {
            let materials = match node.materials.is_empty() {
                true => &mesh.materials,
                false => &node.materials,
            };
            for (slot, material) in materials.into_iter().enumerate() {
                let parts = mesh.material_parts.get(slot);
                if parts.is_none_or(|part| part.num_triangles > 0) {
                    worn.insert(material.element.typed_id as usize);
                }
            }
        }
        let first = (&mesh.element.instances).into_iter().next();
        for material in worn {
            if let Some(wearers) = all.get_mut(material) {
                let own = mesh.element.name.to_string();
                wearers.push(Wearer {
                    name: match first {
                        Some(node) if own.is_empty() => node.element.name.to_string(),
                        _ => own,
                    },
                    sets: mesh
                        .uv_sets
                        .iter()
                        .map(|set| set.name.to_string())
                        .collect(),
                });
            }
        }
    }
    all
}

/// Numbers the UV sets of a material's textures, which so far are numbered as in `names`. Each mesh keeps
/// its own order where that serves all of them.
pub(crate) fn settle(
    material: &mut Material,
    names: UvNames,
    wearers: &[Wearer],
    report: &mut Report,
) -> UvOrder {
    let UvNames(names) = names;
    if names.is_empty() {
        return UvOrder::OfMesh;
    }
    let mut natural: Option<Vec<usize>> = None;
    let mut agree = true;
    for wearer in wearers {
        if wearer.sets.is_empty() {
            let detail = format!(
                "has no texture coordinates; the textures of material \"{}\" show one point of their pictures",
                material.name
            );
            report.lose("uv-set", &wearer.name, detail);
            continue;
        }
        let sets: Vec<&str> = wearer.sets.iter().map(String::as_str).collect();
        for name in names.iter().filter(|name| !is_first(name)) {
            if position(&sets, name).is_none() {
                let detail = format!(
                    "has no UV set \"{name}\", which material \"{}\" asks for; its first one is taken",
                    material.name
                );
                report.lose("uv-set", &wearer.name, detail);
            }
        }
        let places = names.iter().map(|name| position(&sets, name).unwrap_or(0));
        let places: Vec<usize> = places.collect();
        agree &= natural.get_or_insert_with(|| places.clone()) == &places;
    }
    let far = |places: &[usize]| places.iter().any(|&place| place >= READ_BY_ALL);
    match natural {
        Some(places) if agree && (!far(&places) || names.len() > READ_BY_ALL) => {
            for texture in material.textures_mut() {
                let place = places.get(texture.uv_set as usize);
                texture.uv_set = place.copied().unwrap_or(0) as u32;
            }
            UvOrder::OfMesh
        }
        _ => UvOrder::Named(names),
    }
}

/// Whether a texture that says this asks for a mesh's first set, whatever it is called.
fn is_first(name: &str) -> bool {
    name.is_empty() || name == "default"
}

/// Whether two textures ask for one set.
pub(super) fn is_same_set(a: &str, b: &str) -> bool {
    a == b || (is_first(a) && is_first(b))
}

fn position(sets: &[&str], name: &str) -> Option<usize> {
    match name.is_empty() {
        true => Some(0),
        false => sets.iter().position(|set| *set == name),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn named_sets_come_first_and_none_is_left_out() {
        let order = UvOrder::Named(vec!["map".into(), "light".into()]);
        assert_eq!(order.of(&["light", "x", "map"]), [2, 0, 1]);
        assert_eq!(order.of(&["map", "light"]), [0, 1]);
        // What is missing is the first.
        assert_eq!(order.of(&["x", "light"]), [0, 1]);
        assert_eq!(order.of(&["x"]), [0, 0]);
        assert!(order.of(&[]).is_empty());
        assert_eq!(UvOrder::OfMesh.of(&["light", "map"]), [0, 1]);
    }

    #[test]
    fn a_name_is_numbered_once() {
        let mut names = UvNames::default();
        assert_eq!(
            [names.number("a"), names.number("b"), names.number("a")],
            [0, 1, 0]
        );
    }
}
