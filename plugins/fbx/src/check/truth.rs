//! The FBX file as ufbx deforms it.

use crate::curves::{Layers, Meaning, Reading, Value, order_of};
use crate::error::FbxError;
use crate::load::{load_plainly, load_unchanged};
use crate::options::{Budget, Limits, Options, Origin};
use crate::read::convert::{matrix, vec3};
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};
use ufbx::{CoordinateAxis, ElementType, EvaluateOpts, SceneRoot};

/// An FBX file in its own axes and unit.
pub struct Truth {
    scene: SceneRoot,
}

/// A mesh where an FBX node shows it.
pub struct Body {
    /// Number of the mesh.
    pub mesh: u32,
    /// Its vertices in the world, in the file's axes and unit.
    pub points: Vec<DVec3>,
}

/// The file's axes and unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Space {
    /// What of the file's coordinates becomes glTF's X, Y and Z.
    axes: [DVec3; 3],
    /// Metres that one unit of the file stands for.
    pub unit: f64,
}

impl Space {
    /// From the file's world to glTF's.
    pub fn to_gltf(&self, point: DVec3) -> DVec3 {
        DVec3::from_array(self.axes.map(|axis| axis.dot(point))) * self.unit
    }

    /// From glTF's world to the file's.
    pub fn from_gltf(&self, point: DVec3) -> DVec3 {
        let parts = self.axes.iter().zip(point.to_array());
        parts.map(|(axis, x)| *axis * x).sum::<DVec3>() / self.unit
    }
}

impl Truth {
    /// Reads a file.
    ///
    /// # Errors
    /// [`FbxError`], as for a conversion.
    pub fn load(bytes: &[u8], origin: &Origin) -> Result<Self, FbxError> {
        let budget = Budget::new(&origin.name, Limits::of_contents(bytes));
        let scene = load_unchanged(bytes, &budget, &Options::default())?;
        Ok(Self { scene })
    }

    /// ufbx's loading of a file and nothing else, to be timed.
    ///
    /// # Errors
    /// [`FbxError`], as for a conversion.
    pub fn load_alone(bytes: &[u8], origin: &Origin) -> Result<Self, FbxError> {
        let budget = Budget::new(&origin.name, Limits::of_contents(bytes));
        let scene = load_plainly(bytes, &budget, &Options::default())?;
        Ok(Self { scene })
    }

    /// Its axes and unit.
    pub fn space(&self) -> Space {
        let settings = &self.scene.settings;
        let axis = |axis: CoordinateAxis, without: DVec3| match axis {
            CoordinateAxis::PositiveX => DVec3::X,
            CoordinateAxis::NegativeX => DVec3::NEG_X,
            CoordinateAxis::PositiveY => DVec3::Y,
            CoordinateAxis::NegativeY => DVec3::NEG_Y,
            CoordinateAxis::PositiveZ => DVec3::Z,
            CoordinateAxis::NegativeZ => DVec3::NEG_Z,
            CoordinateAxis::Unknown => without,
        };
        Space {
            axes: [
                axis(settings.axes.right, DVec3::X),
                axis(settings.axes.up, DVec3::Y),
                axis(settings.axes.front, DVec3::Z),
            ],
            unit: settings.unit_meters,
        }
    }

    /// Frames a second, at least 1.
    pub fn frames_per_second(&self) -> f64 {
        let frames = self.scene.settings.frames_per_second;
        if frames.is_finite() {
            frames.clamp(1.0, 1000.0)
        } else {
            30.0
        }
    }

    /// Names and ranges (seconds on the file's clock) of the animation stacks.
    pub fn stacks(&self) -> Vec<(String, f64, f64)> {
        (&self.scene.anim_stacks)
            .into_iter()
            .map(|stack| {
                (
                    stack.element.name.to_string(),
                    stack.time_begin,
                    stack.time_end,
                )
            })
            .collect()
    }

    /// What the layers of a stack come to at `time`, where ufbx does not know: it plays muted ones too.
    fn layered<'a>(
        &'a self,
        stack: &'a ufbx::AnimStack,
        layers: &Layers<'a>,
        time: f64,
    ) -> Result<ufbx::AnimRoot, FbxError> {
        let mut overrides = Vec::new();
        let mut known = BTreeSet::new();
        let props = (&stack.layers)
            .into_iter()
            .flat_map(|layer| layer.anim_props.iter());
        for prop in props {
            let element: &'a ufbx::Element = prop.element.as_ref();
            let name: &str = &prop.prop_name;
            if !known.insert((element.element_id, name)) {
                continue;
            }
            let node = (element.type_ == ElementType::Node)
                .then(|| self.scene.nodes.get(element.typed_id as usize))
                .flatten();
            let (meaning, or) = match (name, node) {
                ("Lcl Rotation", Some(node)) => (Meaning::Angles(order_of(node)), DVec3::ZERO),
                ("Lcl Scaling", Some(_)) => (Meaning::Scale, DVec3::ONE),
                _ => (Meaning::Plain, DVec3::ZERO),
            };
            let value = Value::of(layers, element, name, or).at(time, meaning);
            overrides.push(ufbx::PropOverrideDesc {
                element_id: element.element_id,
                // Borrowed: the binding lets go of owned ones before they are read.
                prop_name: ufbx::StringOpt::Ref(name),
                value: ufbx::Vec4 {
                    x: value.x,
                    y: value.y,
                    z: value.z,
                    w: 0.0,
                },
                value_str: ufbx::StringOpt::Ref(""),
                value_int: value.x as i64,
            });
        }
        let options = ufbx::AnimOpts {
            prop_overrides: ufbx::ListOpt::Ref(&overrides),
            ..ufbx::AnimOpts::default()
        };
        ufbx::create_anim(&self.scene, options).map_err(|error| refused(&error))
    }

    /// Every mesh where every node shows it, at `time` of stack number `stack`; `None` is the
    /// file's rest. Also where each node is whose name no other node has.
    ///
    /// # Errors
    /// [`FbxError::Broken`] where ufbx cannot evaluate the file.
    pub fn at(
        &self,
        stack: Option<usize>,
        time: f64,
    ) -> Result<(Vec<Body>, BTreeMap<String, DVec3>), FbxError> {
        let posed;
        let options = EvaluateOpts {
            evaluate_skinning: true,
            ..EvaluateOpts::default()
        };
        let scene: &ufbx::Scene = match stack {
            Some(stack) => {
                let stack: &ufbx::AnimStack = &self.scene.anim_stacks[stack];
                let layers = Layers::of(&self.scene, stack, Reading::Usual);
                let own = match layers.is_plain {
                    true => None,
                    false => Some(self.layered(stack, &layers, time)?),
                };
                let anim: &ufbx::Anim = own.as_deref().unwrap_or(&stack.anim);
                posed = ufbx::evaluate_scene(&self.scene, anim, time, options)
                    .map_err(|error| refused(&error))?;
                &posed
            }
            None => &self.scene,
        };
        let mut bodies = Vec::new();
        let mut places: BTreeMap<String, Option<DVec3>> = BTreeMap::new();
        for node in &scene.nodes {
            let world = matrix(&node.node_to_world);
            places
                .entry(node.element.name.to_string())
                .and_modify(|place| *place = None)
                .or_insert(Some(world.w_axis.truncate()));
            let Some(mesh) = &node.mesh else { continue };
            let deformed = mesh.skinned_position.exists;
            let points = match deformed {
                true => &mesh.skinned_position.values,
                false => &mesh.vertices,
            };
            let to_world = matrix(&node.geometry_to_world);
            let is_local = !deformed || mesh.skinned_is_local;
            let place = |p: &ufbx::Vec3| match is_local {
                true => to_world.transform_point3(vec3(*p)),
                false => vec3(*p),
            };
            bodies.push(Body {
                mesh: mesh.element.typed_id,
                points: points.iter().map(place).collect(),
            });
        }
        let places = places
            .into_iter()
            .filter_map(|(name, place)| Some((name, place?)));
        Ok((bodies, places.collect()))
    }
}

fn refused(error: &ufbx::Error) -> FbxError {
    FbxError::Broken {
        file: String::new(),
        detail: error.description.to_string(),
    }
}
