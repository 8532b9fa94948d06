//! Layers and their curves.

use super::{Ids, p};
use crate::file::{Record, Value};
use crate::scene::{Beyond, Clamp, Curve, Layer, Target, Way};

impl Ids {
    pub(super) fn layer(&mut self, stack: i64, number: usize, layer: &Layer) {
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

    pub(super) fn track(
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
