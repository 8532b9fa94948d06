//! A scene as records.

mod objects;
mod shapes;
mod takes;

use super::{Record, Value, ascii, binary};
use crate::scene::{Container, Scene};
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
}
