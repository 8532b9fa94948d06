//! ASCII FBX files of nodes in metres, Y up, that curves of several layers move.

/// Ticks of FBX's clock in a second.
pub const TICKS: f64 = 46_186_158_000.0;

/// Straight to the next key.
pub const LINEAR: i32 = 4;
/// Cubic, with slopes of the user's.
pub const CUBIC: i32 = 8 | 0x400;
/// The key's value until the next.
pub const STEP: i32 = 2;
/// The next key's value from this one on.
pub const STEP_NEXT: i32 = 2 | 0x100;

/// A key: seconds, value, slope after it and slope into the next, per second.
#[derive(Clone, Copy)]
pub struct Key {
    pub time: f64,
    pub value: f64,
    pub how: i32,
    pub slopes: [f64; 2],
}

/// A curve.
#[derive(Clone, Default)]
pub struct Curve {
    pub keys: Vec<Key>,
    /// Letters of how it goes on before and after, and how often.
    pub beyond: [Option<(char, i32)>; 2],
}

impl Curve {
    /// Straight lines through times and values.
    pub fn lines(points: &[(f64, f64)]) -> Self {
        Self::of(points, LINEAR)
    }

    /// Through times and values, all keys of one kind, without slopes.
    pub fn of(points: &[(f64, f64)], how: i32) -> Self {
        let key = |&(time, value): &(f64, f64)| Key {
            time,
            value,
            how,
            slopes: [0.0; 2],
        };
        Self {
            keys: points.iter().map(key).collect(),
            ..Self::default()
        }
    }
}

/// What a layer moves: node, property, axis.
pub type Moved = (usize, &'static str, usize, Curve);

/// A layer.
#[derive(Clone, Default)]
pub struct Layer {
    /// `P` lines: name and number.
    pub settings: Vec<(&'static str, f64)>,
    pub curves: Vec<Moved>,
    /// Curve of its weight, and the layer that it lies in.
    pub weight: Option<(Curve, usize)>,
}

/// A node: its parent and properties, which are three numbers each or a whole one.
#[derive(Clone, Default)]
pub struct Node {
    pub parent: Option<usize>,
    pub vectors: Vec<(&'static str, [f64; 3])>,
    pub whole: Vec<(&'static str, i64)>,
}

/// The corners of the triangle on every node.
pub const CORNERS: [[f64; 3]; 3] = [[1.0, 0.0, 0.25], [0.0, 1.0, 0.5], [0.125, 0.5, 1.0]];

/// The file: `span` is the take's, seconds; 30 frames a second.
pub fn file(nodes: &[Node], layers: &[Layer], span: (f64, f64)) -> String {
    let ticks = |seconds: f64| (seconds * TICKS).round() as i64;
    let mut text = String::from(
        "; FBX 7.4.0 project file\nFBXHeaderExtension:  {\n\tFBXHeaderVersion: 1003\n\tFBXVersion: 7400\n\tCreator: \"tests\"\n}\n\
         GlobalSettings:  {\n\tVersion: 1000\n\tProperties70:  {\n\
         \t\tP: \"UpAxis\", \"int\", \"Integer\", \"\",1\n\t\tP: \"UpAxisSign\", \"int\", \"Integer\", \"\",1\n\
         \t\tP: \"FrontAxis\", \"int\", \"Integer\", \"\",2\n\t\tP: \"FrontAxisSign\", \"int\", \"Integer\", \"\",1\n\
         \t\tP: \"CoordAxis\", \"int\", \"Integer\", \"\",0\n\t\tP: \"CoordAxisSign\", \"int\", \"Integer\", \"\",1\n\
         \t\tP: \"UnitScaleFactor\", \"double\", \"Number\", \"\",100\n\t\tP: \"TimeMode\", \"enum\", \"\", \"\",6\n\t}\n}\nObjects:  {\n",
    );
    let corners: Vec<String> = CORNERS.iter().flatten().map(f64::to_string).collect();
    text += &format!(
        "\tGeometry: 100, \"Geometry::t\", \"Mesh\" {{\n\t\tVertices: *9 {{\n\t\t\ta: {}\n\t\t}}\n\t\tPolygonVertexIndex: *3 {{\n\t\t\ta: 0,1,-3\n\t\t}}\n\t\tGeometryVersion: 124\n\t}}\n",
        corners.join(",")
    );
    let mut links = String::new();
    for (number, node) in nodes.iter().enumerate() {
        let id = 1000 + number;
        text += &format!(
            "\tModel: {id}, \"Model::n{number}\", \"Mesh\" {{\n\t\tVersion: 232\n\t\tProperties70:  {{\n"
        );
        for (name, [x, y, z]) in &node.vectors {
            text += &format!("\t\t\tP: \"{name}\", \"Vector3D\", \"Vector\", \"A\",{x},{y},{z}\n");
        }
        for (name, value) in &node.whole {
            text += &format!("\t\t\tP: \"{name}\", \"enum\", \"\", \"\",{value}\n");
        }
        text += "\t\t}\n\t}\n";
        let parent = node.parent.map_or(0, |parent| 1000 + parent);
        links += &format!("\tC: \"OO\",{id},{parent}\n\tC: \"OO\",100,{id}\n");
    }
    text += "\tAnimationStack: 400, \"AnimStack::take\", \"\" {\n\t\tProperties70:  {\n";
    for (name, seconds) in [("LocalStart", span.0), ("LocalStop", span.1)] {
        text += &format!(
            "\t\t\tP: \"{name}\", \"KTime\", \"Time\", \"\",{}\n",
            ticks(seconds)
        );
    }
    text += "\t\t}\n\t}\n";
    let mut next = 10_000;
    let mut id = || {
        next += 1;
        next
    };
    for (number, layer) in layers.iter().enumerate() {
        let own = 500 + number;
        text += &format!(
            "\tAnimationLayer: {own}, \"AnimLayer::l{number}\", \"\" {{\n\t\tProperties70:  {{\n"
        );
        for (name, value) in &layer.settings {
            text += &format!("\t\t\tP: \"{name}\", \"Number\", \"\", \"A\",{value}\n");
        }
        text += "\t\t}\n\t}\n";
        links += &format!("\tC: \"OO\",{own},400\n");
        let mut values: Vec<(usize, &str, i32)> = Vec::new();
        for (node, property, axis, curve) in &layer.curves {
            let known = values.iter().find(|v| (v.0, v.1) == (*node, *property));
            let value = match known {
                Some(&(.., value)) => value,
                None => {
                    let value = id();
                    values.push((*node, property, value));
                    let rest = if *property == "Lcl Scaling" { 1 } else { 0 };
                    text += &format!(
                        "\tAnimationCurveNode: {value}, \"AnimCurveNode::x\", \"\" {{\n\t\tProperties70:  {{\n\t\t\tP: \"d|X\", \"Number\", \"\", \"A\",{rest}\n\t\t\tP: \"d|Y\", \"Number\", \"\", \"A\",{rest}\n\t\t\tP: \"d|Z\", \"Number\", \"\", \"A\",{rest}\n\t\t}}\n\t}}\n"
                    );
                    links += &format!(
                        "\tC: \"OO\",{value},{own}\n\tC: \"OP\",{value},{}, \"{property}\"\n",
                        1000 + node
                    );
                    value
                }
            };
            let one = id();
            text += &written(one, curve);
            links += &format!(
                "\tC: \"OP\",{one},{value}, \"d|{}\"\n",
                ["X", "Y", "Z"][*axis]
            );
        }
        if let Some((curve, lies_in)) = &layer.weight {
            let (value, one) = (id(), id());
            text += &format!(
                "\tAnimationCurveNode: {value}, \"AnimCurveNode::Weight\", \"\" {{\n\t\tProperties70:  {{\n\t\t\tP: \"d|Weight\", \"Number\", \"\", \"A\",100\n\t\t}}\n\t}}\n"
            );
            text += &written(one, curve);
            links += &format!(
                "\tC: \"OO\",{value},{}\n\tC: \"OP\",{value},{own}, \"Weight\"\n\tC: \"OP\",{one},{value}, \"d|Weight\"\n",
                500 + lies_in
            );
        }
    }
    text + "}\nConnections:  {\n" + &links + "}\n"
}

fn written(id: i32, curve: &Curve) -> String {
    let list = |numbers: Vec<String>| {
        format!(
            "*{} {{\n\t\t\ta: {}\n\t\t}}",
            numbers.len(),
            numbers.join(",")
        )
    };
    let keys = &curve.keys;
    let times = keys
        .iter()
        .map(|k| ((k.time * TICKS).round() as i64).to_string());
    let values = keys.iter().map(|k| k.value.to_string());
    let flags = keys.iter().map(|k| k.how.to_string());
    let bits = |x: f64| (x as f32).to_bits().cast_signed().to_string();
    let data = keys
        .iter()
        .flat_map(|k| [bits(k.slopes[0]), bits(k.slopes[1]), "0".into(), "0".into()]);
    let mut text = format!(
        "\tAnimationCurve: {id}, \"AnimCurve::\", \"\" {{\n\t\tDefault: 0\n\t\tKeyVer: 4009\n\t\tKeyTime: {}\n\t\tKeyValueFloat: {}\n\t\tKeyAttrFlags: {}\n\t\tKeyAttrDataFloat: {}\n\t\tKeyAttrRefCount: {}\n",
        list(times.collect()),
        list(values.collect()),
        list(flags.collect()),
        list(data.collect()),
        list(keys.iter().map(|_| "1".into()).collect()),
    );
    for (name, beyond) in ["Pre-Extrapolation", "Post-Extrapolation"]
        .iter()
        .zip(curve.beyond)
    {
        if let Some((letter, count)) = beyond {
            text += &format!(
                "\t\t{name}:  {{\n\t\t\tType: {letter}\n\t\t\tRepetition: {count}\n\t\t}}\n"
            );
        }
    }
    text + "\t}\n"
}
