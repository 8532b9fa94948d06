//! Meshes, morph targets and skins.

use super::{Ids, matrix, p};
use crate::file::{Record, Value};
use crate::scene::{Channel, Mesh, Scene, Shows};
use crate::truth::bind;

impl Ids {
    pub(super) fn geometries(&mut self, scene: &Scene) {
        for (number, mesh) in scene.meshes.iter().enumerate() {
            let name = format!("g{number}");
            let id = self.object("Geometry", ("Geometry", &name), "Mesh", vec![], faces(mesh));
            for (node, shown) in scene.nodes.iter().enumerate() {
                if shown.shows == Shows::Mesh(number) {
                    self.connect(id, self.nodes[node]);
                    if let Some(material) = mesh.material {
                        self.connect(self.materials[material], self.nodes[node]);
                    }
                }
            }
            self.skin(scene, number, id);
            let mut channels = Vec::new();
            if !mesh.channels.is_empty() {
                let version = Record::new("Version", vec![100.into()]);
                let deformer = self.object(
                    "Deformer",
                    ("Deformer", &name),
                    "BlendShape",
                    vec![],
                    vec![version],
                );
                self.connect(deformer, id);
                for (index, channel) in mesh.channels.iter().enumerate() {
                    let name = format!("{name}c{index}");
                    channels.push(self.channel(&name, channel, deformer));
                }
            }
            self.channels.push(channels);
        }
    }

    pub(super) fn channel(&mut self, name: &str, channel: &Channel, deformer: i64) -> i64 {
        let full = channel.shapes.iter().map(|shape| shape.0).collect();
        let below = vec![
            Record::new("Version", vec![100.into()]),
            Record::new("DeformPercent", vec![channel.percent.into()]),
            Record::new("FullWeights", vec![Value::Doubles(full)]),
        ];
        let percent = vec![p(
            "DeformPercent",
            "Number",
            "",
            "A",
            vec![channel.percent.into()],
        )];
        let id = self.object(
            "Deformer",
            ("SubDeformer", name),
            "BlendShapeChannel",
            percent,
            below,
        );
        self.connect(id, deformer);
        for (index, (_, moved)) in channel.shapes.iter().enumerate() {
            let below = vec![
                Record::new("Version", vec![100.into()]),
                Record::new(
                    "Indexes",
                    vec![Value::Ints(moved.iter().map(|m| m.0 as i32).collect())],
                ),
                Record::new(
                    "Vertices",
                    vec![Value::Doubles(moved.iter().flat_map(|m| m.1).collect())],
                ),
            ];
            let name = format!("{name}s{index}");
            let shape = self.object("Geometry", ("Geometry", &name), "Shape", vec![], below);
            self.connect(shape, id);
        }
        id
    }

    pub(super) fn skin(&mut self, scene: &Scene, number: usize, geometry: i64) {
        let mesh = &scene.meshes[number];
        if mesh.skin.is_empty() {
            return;
        }
        let version = || Record::new("Version", vec![100.into()]);
        let name = format!("g{number}");
        let skin = self.object(
            "Deformer",
            ("Deformer", &name),
            "Skin",
            vec![],
            vec![version()],
        );
        self.connect(skin, geometry);
        for (index, cluster) in mesh.skin.iter().enumerate() {
            let (transform, link) = bind(scene, number, cluster.node);
            let below = vec![
                version(),
                Record::new(
                    "Indexes",
                    vec![Value::Ints(
                        cluster.weights.iter().map(|w| w.0 as i32).collect(),
                    )],
                ),
                Record::new(
                    "Weights",
                    vec![Value::Doubles(
                        cluster.weights.iter().map(|w| w.1).collect(),
                    )],
                ),
                matrix("Transform", &transform),
                matrix("TransformLink", &link),
            ];
            let name = format!("{name}j{index}");
            let id = self.object("Deformer", ("SubDeformer", &name), "Cluster", vec![], below);
            self.connect(id, skin);
            self.connect(self.nodes[cluster.node], id);
        }
    }
}

fn faces(mesh: &Mesh) -> Vec<Record> {
    let mut corners = Vec::new();
    for face in &mesh.faces {
        for (i, &corner) in face.iter().enumerate() {
            let corner = corner as i32;
            // The last corner of a face is told by its bits being turned around.
            corners.push(if i + 1 == face.len() { !corner } else { corner });
        }
    }
    let mut out = vec![
        Record::new(
            "Vertices",
            vec![Value::Doubles(
                mesh.points.iter().flatten().copied().collect(),
            )],
        ),
        Record::new("PolygonVertexIndex", vec![Value::Ints(corners.clone())]),
        Record::new("GeometryVersion", vec![124.into()]),
    ];
    if mesh.material.is_none() {
        return out;
    }
    let uvs = corners.iter().flat_map(|&corner| {
        let point = mesh.points[if corner < 0 { !corner } else { corner } as usize];
        [point[0], point[1]]
    });
    let mapped = |name: &str, title: &str, mapping: &str, reference: &str, data: Record| {
        Record::new(name, vec![0.into()])
            .with(Record::new("Version", vec![101.into()]))
            .with(Record::new("Name", vec![title.into()]))
            .with(Record::new("MappingInformationType", vec![mapping.into()]))
            .with(Record::new(
                "ReferenceInformationType",
                vec![reference.into()],
            ))
            .with(data)
    };
    let uv = Record::new("UV", vec![Value::Doubles(uvs.collect())]);
    let materials = Record::new("Materials", vec![Value::Ints(vec![0])]);
    out.push(mapped(
        "LayerElementUV",
        "map",
        "ByPolygonVertex",
        "Direct",
        uv,
    ));
    out.push(mapped(
        "LayerElementMaterial",
        "",
        "AllSame",
        "IndexToDirect",
        materials,
    ));
    let element = |kind: &str| {
        Record::new("LayerElement", vec![])
            .with(Record::new("Type", vec![kind.into()]))
            .with(Record::new("TypedIndex", vec![0.into()]))
    };
    out.push(
        Record::new("Layer", vec![0.into()])
            .with(Record::new("Version", vec![100.into()]))
            .with(element("LayerElementUV"))
            .with(element("LayerElementMaterial")),
    );
    out
}
