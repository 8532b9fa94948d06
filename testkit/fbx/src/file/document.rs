//! A scene as records.

use super::{Record, Value, ascii, binary};
use crate::scene::{
    Beyond, Camera, Channel, Clamp, Container, Curve, Layer, Light, Material, Mesh, Node, Scene,
    Shows, Target, Way,
};
use crate::truth::bind;
use glam::DMat4;

/// Numbers of objects, and what is connected to what.
#[derive(Debug, Default)]
pub struct Ids {
    last: i64,
    objects: Vec<Record>,
    connections: Vec<Record>,
    nodes: Vec<i64>,
    attributes: Vec<Option<i64>>,
    channels: Vec<Vec<i64>>,
    materials: Vec<i64>,
}

/// The bytes of the file that says what `scene` says.
pub fn document(scene: &Scene) -> Vec<u8> {
    let records = records(scene);
    match scene.container {
        Container::Ascii => ascii::write(&records, scene.version),
        Container::Binary => binary::write(&records, scene.version, false),
        Container::Deflated => binary::write(&records, scene.version, true),
    }
}

fn records(scene: &Scene) -> Vec<Record> {
    let head = Record::new("FBXHeaderExtension", vec![])
        .with(Record::new("FBXHeaderVersion", vec![1003.into()]))
        .with(Record::new(
            "FBXVersion",
            vec![scene.version.cast_signed().into()],
        ))
        .with(Record::new("Creator", vec!["dolomite_fbx_search".into()]));
    let mut settings = Vec::new();
    let names = [
        ("CoordAxis", "CoordAxisSign"),
        ("UpAxis", "UpAxisSign"),
        ("FrontAxis", "FrontAxisSign"),
    ];
    for (axis, (name, sign)) in scene.axes.iter().zip(names) {
        settings.push(p(
            name,
            "int",
            "Integer",
            "",
            vec![(axis.axis as i32).into()],
        ));
        settings.push(p(sign, "int", "Integer", "", vec![axis.sign.into()]));
    }
    settings.push(p(
        "UnitScaleFactor",
        "double",
        "Number",
        "",
        vec![scene.unit.into()],
    ));
    settings.push(p(
        "OriginalUnitScaleFactor",
        "double",
        "Number",
        "",
        vec![scene.unit.into()],
    ));
    settings.push(p("TimeMode", "enum", "", "", vec![scene.time_mode.into()]));
    let settings = Record::new("GlobalSettings", vec![])
        .with(Record::new("Version", vec![1000.into()]))
        .with(Record::new("Properties70", vec![]).holding(settings));
    let mut ids = Ids {
        last: 1000,
        ..Ids::default()
    };
    ids.models(scene);
    for (number, material) in scene.materials.iter().enumerate() {
        ids.material(number, material);
    }
    ids.geometries(scene);
    for stack in &scene.stacks {
        let id = ids.object(
            "AnimationStack",
            ("AnimStack", &stack.name),
            "",
            vec![
                p("LocalStart", "KTime", "Time", "", vec![stack.start.into()]),
                p("LocalStop", "KTime", "Time", "", vec![stack.stop.into()]),
                p(
                    "ReferenceStart",
                    "KTime",
                    "Time",
                    "",
                    vec![stack.start.into()],
                ),
                p(
                    "ReferenceStop",
                    "KTime",
                    "Time",
                    "",
                    vec![stack.stop.into()],
                ),
            ],
            vec![],
        );
        for (number, layer) in stack.layers.iter().enumerate() {
            ids.layer(id, number, layer);
        }
    }
    vec![
        head,
        settings,
        Record::new("Objects", vec![]).holding(ids.objects),
        Record::new("Connections", vec![]).holding(ids.connections),
    ]
}

/// A property.
fn p(name: &str, kind: &str, label: &str, flags: &str, values: Vec<Value>) -> Record {
    let mut all: Vec<Value> = vec![name.into(), kind.into(), label.into(), flags.into()];
    all.extend(values);
    Record::new("P", all)
}

fn vector(name: &str, kind: &str, flags: &str, v: [f64; 3]) -> Record {
    p(
        name,
        kind,
        "",
        flags,
        v.into_iter().map(Value::Double).collect(),
    )
}

fn matrix(name: &str, m: &DMat4) -> Record {
    Record::new(name, vec![Value::Doubles(m.to_cols_array().to_vec())])
}

impl Ids {
    fn object(
        &mut self,
        record: &str,
        name: (&str, &str),
        kind: &str,
        properties: Vec<Record>,
        below: Vec<Record>,
    ) -> i64 {
        self.last += 1;
        let text = format!("{}\0\u{1}{}", name.1, name.0);
        let mut made = Record::new(
            record,
            vec![self.last.into(), Value::Text(text), kind.into()],
        );
        made.below = below;
        if !properties.is_empty() {
            made.below
                .push(Record::new("Properties70", vec![]).holding(properties));
        }
        self.objects.push(made);
        self.last
    }

    fn connect(&mut self, from: i64, to: i64) {
        self.connections
            .push(Record::new("C", vec!["OO".into(), from.into(), to.into()]));
    }

    fn connect_to(&mut self, from: i64, to: i64, property: &str) {
        self.connections.push(Record::new(
            "C",
            vec!["OP".into(), from.into(), to.into(), property.into()],
        ));
    }

    fn models(&mut self, scene: &Scene) {
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

    fn material(&mut self, number: usize, material: &Material) {
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

    fn geometries(&mut self, scene: &Scene) {
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

    fn channel(&mut self, name: &str, channel: &Channel, deformer: i64) -> i64 {
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

    fn skin(&mut self, scene: &Scene, number: usize, geometry: i64) {
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

    fn layer(&mut self, stack: i64, number: usize, layer: &Layer) {
        let mut properties = Vec::new();
        if number > 0
            || layer.mute
            || layer.solo
            || layer.weight != 100.0
            || layer.weight_curve.is_some()
        {
            let flags = if layer.weight_curve.is_some() {
                "A+"
            } else {
                "A"
            };
            properties.push(p("Weight", "Number", "", flags, vec![layer.weight.into()]));
            properties.push(p(
                "Mute",
                "bool",
                "",
                "",
                vec![i32::from(layer.mute).into()],
            ));
            properties.push(p(
                "Solo",
                "bool",
                "",
                "",
                vec![i32::from(layer.solo).into()],
            ));
            properties.push(p("Lock", "bool", "", "", vec![0.into()]));
        }
        if let Some(blend) = layer.blend {
            properties.push(p("BlendMode", "enum", "", "", vec![blend.into()]));
        }
        if number > 0 || layer.by_channel || layer.add_scale {
            let modes = [
                ("RotationAccumulationMode", layer.by_channel),
                ("ScaleAccumulationMode", layer.add_scale),
            ];
            for (name, on) in modes {
                properties.push(p(name, "enum", "", "", vec![i32::from(on).into()]));
            }
        }
        let name = format!("layer{number}");
        let id = self.object(
            "AnimationLayer",
            ("AnimLayer", &name),
            "",
            properties,
            vec![],
        );
        self.connect(id, stack);
        if let Some(curve) = &layer.weight_curve {
            self.track(
                id,
                id,
                "Weight",
                &["d|Weight"],
                [layer.weight; 3],
                &[Some(curve.clone())],
            );
        }
        for track in &layer.tracks {
            let (to, property) = match track.target {
                Target::Translation(node) => (self.nodes[node], "Lcl Translation"),
                Target::Rotation(node) => (self.nodes[node], "Lcl Rotation"),
                Target::Scaling(node) => (self.nodes[node], "Lcl Scaling"),
                Target::Percent(mesh, channel) => (self.channels[mesh][channel], "DeformPercent"),
                Target::Visibility(node) => (self.nodes[node], "Visibility"),
                Target::Intensity(node) => (self.attributes[node].unwrap_or(0), "Intensity"),
                Target::FieldOfView(node) => (self.attributes[node].unwrap_or(0), "FieldOfView"),
                Target::Diffuse(material) => (self.materials[material], "DiffuseColor"),
            };
            let one = format!("d|{property}");
            let names: &[&str] = match track.target.width() {
                3 => &["d|X", "d|Y", "d|Z"],
                _ => &[&one],
            };
            self.track(id, to, property, names, track.without, &track.curves);
        }
    }

    fn track(
        &mut self,
        layer: i64,
        to: i64,
        property: &str,
        names: &[&str],
        without: [f64; 3],
        curves: &[Option<Curve>],
    ) {
        let defaults = names.iter().zip(without);
        let defaults = defaults
            .map(|(name, x)| p(name, "Number", "", "A", vec![x.into()]))
            .collect();
        let short = property.rsplit(' ').next().unwrap_or(property);
        let node = self.object(
            "AnimationCurveNode",
            ("AnimCurveNode", short),
            "",
            defaults,
            vec![],
        );
        self.connect(node, layer);
        self.connect_to(node, to, property);
        for (name, curve) in names.iter().zip(curves) {
            if let Some(curve) = curve {
                let id = self.object("AnimationCurve", ("AnimCurve", ""), "", vec![], keys(curve));
                self.connect_to(id, node, name);
            }
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

/// Keys; flags and data that repeat are said once, with their count.
fn keys(curve: &Curve) -> Vec<Record> {
    let mut flags: Vec<i32> = Vec::new();
    let mut data: Vec<[u32; 4]> = Vec::new();
    let mut counts: Vec<i32> = Vec::new();
    for key in &curve.keys {
        let (mut flag, [a, b, c]) = match key.way {
            Way::Constant => (0x2, [0.0; 3]),
            Way::ConstantNext => (0x102, [0.0; 3]),
            Way::Linear => (0x4, [0.0; 3]),
            Way::User {
                right,
                next_left,
                broken,
            } => (if broken { 0xc08 } else { 0x408 }, [right, next_left, 0.0]),
            Way::Auto {
                clamp,
                time_independent,
            } => {
                let clamp = match clamp {
                    Clamp::Free => 0,
                    Clamp::Flat => 0x1000,
                    Clamp::Progressive => 0x4000,
                };
                (
                    0x108 | clamp | if time_independent { 0x2000 } else { 0 },
                    [0.0; 3],
                )
            }
            Way::Tcb(tcb) => (0x208, tcb),
        };
        let mut bits = [a.to_bits(), b.to_bits(), c.to_bits(), 0];
        if let Some([right, next_left]) = key.weights {
            flag |= 0x0300_0000;
            bits[2] = u32::from(right) | u32::from(next_left) << 16;
        }
        if key.velocity {
            flag |= 0x3000_0000;
            bits[3] = 0x07d0_07d0;
        }
        match (flags.last(), data.last(), counts.last_mut()) {
            (Some(&last), Some(known), Some(count)) if last == flag && *known == bits => {
                *count += 1
            }
            _ => {
                flags.push(flag);
                data.push(bits);
                counts.push(1);
            }
        }
    }
    let mut out = vec![
        Record::new("Default", vec![0.0.into()]),
        Record::new("KeyVer", vec![4009.into()]),
        Record::new(
            "KeyTime",
            vec![Value::Longs(
                curve.keys.iter().map(|key| key.time).collect(),
            )],
        ),
        Record::new(
            "KeyValueFloat",
            vec![Value::Floats(
                curve.keys.iter().map(|key| key.value).collect(),
            )],
        ),
        Record::new("KeyAttrFlags", vec![Value::Ints(flags)]),
        Record::new(
            "KeyAttrDataFloat",
            vec![Value::Bits(data.into_iter().flatten().collect())],
        ),
        Record::new("KeyAttrRefCount", vec![Value::Ints(counts)]),
    ];
    let sides = ["Pre-Extrapolation", "Post-Extrapolation"];
    for (name, beyond) in sides.into_iter().zip(curve.beyond) {
        let (letter, count) = match beyond {
            Beyond::Stays => continue,
            Beyond::Line => (b'K', -1),
            Beyond::Again(count) => (b'R', count),
            Beyond::Back(count) => (b'M', count),
            Beyond::Climbs(count) => (b'A', count),
        };
        out.push(
            Record::new(name, vec![])
                .with(Record::new("Type", vec![Value::Letter(letter)]))
                .with(Record::new("Repetition", vec![count.into()])),
        );
    }
    out
}
