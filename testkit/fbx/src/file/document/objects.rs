//! Models, what they show, and materials.

use super::{Ids, p, vector};
use crate::file::Record;
use crate::scene::{Camera, Light, Material, Node, Scene, Shows};

impl Ids {
    pub(super) fn models(&mut self, scene: &Scene) {
        for node in &scene.nodes {
            let kind = match node.shows {
                Shows::Nothing => "Null",
                Shows::Bone => "LimbNode",
                Shows::Mesh(_) => "Mesh",
                Shows::Camera(_) => "Camera",
                Shows::Light(_) => "Light",
            };
            let version = Record::new("Version", vec![232.into()]);
            let id = self.object(
                "Model",
                ("Model", &node.name),
                kind,
                properties(node),
                vec![version],
            );
            self.nodes.push(id);
            let above = node.parent.map_or(0, |parent| self.nodes[parent]);
            self.connect(id, above);
            let attribute = match &node.shows {
                Shows::Nothing | Shows::Mesh(_) => None,
                Shows::Bone => Some(vec![]),
                Shows::Camera(camera) => Some(of_camera(camera)),
                Shows::Light(light) => Some(of_light(light)),
            };
            let attribute = attribute.map(|properties| {
                let own = self.object(
                    "NodeAttribute",
                    ("NodeAttribute", &node.name),
                    kind,
                    properties,
                    vec![],
                );
                self.connect(own, id);
                own
            });
            self.attributes.push(attribute);
        }
    }

    pub(super) fn material(&mut self, number: usize, material: &Material) {
        let mut properties = vec![
            vector("DiffuseColor", "Color", "A", material.diffuse),
            vector("EmissiveColor", "Color", "A", material.emissive),
            p(
                "EmissiveFactor",
                "Number",
                "",
                "A",
                vec![material.emissive_factor.into()],
            ),
        ];
        if let Some(colour) = material.transparent {
            properties.push(vector("TransparentColor", "Color", "A", colour));
        }
        if let Some(factor) = material.transparency {
            properties.push(p(
                "TransparencyFactor",
                "Number",
                "",
                "A",
                vec![factor.into()],
            ));
        }
        let below = vec![
            Record::new("Version", vec![102.into()]),
            Record::new("ShadingModel", vec!["phong".into()]),
            Record::new("MultiLayer", vec![0.into()]),
        ];
        let name = format!("m{number}");
        let id = self.object("Material", ("Material", &name), "", properties, below);
        self.materials.push(id);
        for picture in &material.pictures {
            let scaling = [picture.scaling[0], picture.scaling[1], 1.0];
            let name = format!("{name}.{}", picture.slot);
            let below = vec![
                Record::new("Type", vec!["TextureVideoClip".into()]),
                Record::new("Version", vec![202.into()]),
                Record::new("FileName", vec!["dot.png".into()]),
                Record::new("RelativeFilename", vec!["dot.png".into()]),
            ];
            let mut placed = vec![vector("Scaling", "Vector3D", "A", scaling)];
            if picture.rotation != 0.0 {
                let turn = [0.0, 0.0, picture.rotation];
                placed.push(vector("Rotation", "Vector3D", "A", turn));
            }
            if picture.translation != [0.0; 2] {
                let by = [picture.translation[0], picture.translation[1], 0.0];
                placed.push(vector("Translation", "Vector3D", "A", by));
            }
            let texture = self.object("Texture", ("Texture", &name), "", placed, below);
            self.connect_to(texture, id, picture.slot);
        }
    }
}

fn properties(node: &Node) -> Vec<Record> {
    let mut out = vec![
        vector("Lcl Translation", "Lcl Translation", "A", node.translation),
        vector("Lcl Rotation", "Lcl Rotation", "A", node.rotation),
        vector("Lcl Scaling", "Lcl Scaling", "A", node.scaling),
        p(
            "RotationActive",
            "bool",
            "",
            "",
            vec![i32::from(node.active).into()],
        ),
        p("InheritType", "enum", "", "", vec![node.inherit.into()]),
    ];
    if node.order != 0 {
        out.push(p("RotationOrder", "enum", "", "", vec![node.order.into()]));
    }
    let vectors = [
        ("PreRotation", node.pre),
        ("PostRotation", node.post),
        ("RotationOffset", node.rotation_offset),
        ("RotationPivot", node.rotation_pivot),
        ("ScalingOffset", node.scaling_offset),
        ("ScalingPivot", node.scaling_pivot),
    ];
    for (name, v) in vectors.into_iter().filter(|(_, v)| *v != [0.0; 3]) {
        out.push(vector(name, "Vector3D", "", v));
    }
    if let Some([translation, rotation, scaling]) = node.geometric {
        out.push(vector("GeometricTranslation", "Vector3D", "", translation));
        out.push(vector("GeometricRotation", "Vector3D", "", rotation));
        out.push(vector("GeometricScaling", "Vector3D", "", scaling));
    }
    if node.hidden {
        out.push(p("Visibility", "Visibility", "", "A", vec![0.0.into()]));
    }
    if let Some(user) = node.user {
        out.push(p("mass", "double", "Number", "AU", vec![user.into()]));
    }
    out
}

fn of_camera(camera: &Camera) -> Vec<Record> {
    vec![
        p(
            "CameraProjectionType",
            "enum",
            "",
            "",
            vec![i32::from(!camera.perspective).into()],
        ),
        p("OrthoZoom", "Number", "", "A", vec![1.0.into()]),
        p("AspectRatioMode", "enum", "", "", vec![2.into()]),
        p(
            "AspectWidth",
            "Number",
            "",
            "A",
            vec![camera.aspect[0].into()],
        ),
        p(
            "AspectHeight",
            "Number",
            "",
            "A",
            vec![camera.aspect[1].into()],
        ),
        p("ApertureMode", "enum", "", "", vec![2.into()]),
        p("FieldOfView", "Number", "", "A", vec![camera.angle.into()]),
        p("NearPlane", "Number", "", "A", vec![camera.near.into()]),
        p("FarPlane", "Number", "", "A", vec![camera.far.into()]),
    ]
}

fn of_light(light: &Light) -> Vec<Record> {
    vec![
        p("LightType", "enum", "", "", vec![light.kind.into()]),
        vector("Color", "Color", "A", light.colour),
        p("Intensity", "Number", "", "A", vec![light.intensity.into()]),
        p("DecayType", "enum", "", "", vec![2.into()]),
        p("OuterAngle", "Number", "", "A", vec![40.0.into()]),
        p("InnerAngle", "Number", "", "A", vec![20.0.into()]),
    ]
}
