//! What reflection does not tell of a setting: its range, its unit, what it is for.

use std::any::TypeId;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ops::RangeInclusive;

use bevy::app::App;
use bevy::ecs::resource::Resource;
use bevy::platform::collections::HashMap;
use bevy::reflect::{PartialReflect, ReflectRef};
use thiserror::Error;

/// What is known of a number.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Field {
    /// What it is for.
    pub about: Cow<'static, str>,
    /// Smallest and largest value.
    pub range: Option<RangeInclusive<f64>>,
    /// Its unit; empty where it has none.
    pub unit: &'static str,
    /// A slider gives every power of ten as much room.
    pub logarithmic: bool,
}

impl Field {
    /// A number of any value.
    #[must_use]
    pub fn new(about: impl Into<Cow<'static, str>>) -> Self {
        Self {
            about: about.into(),
            ..Self::default()
        }
    }

    /// It lies in this range, both ends included.
    #[must_use]
    pub const fn range(mut self, range: RangeInclusive<f64>) -> Self {
        self.range = Some(range);
        self
    }

    /// Its unit.
    #[must_use]
    pub const fn unit(mut self, unit: &'static str) -> Self {
        self.unit = unit;
        self
    }

    /// A slider gives every power of ten as much room.
    #[must_use]
    pub const fn logarithmic(mut self) -> Self {
        self.logarithmic = true;
        self
    }
}

/// What is known of a component or a resource.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Description {
    /// What it is for.
    pub about: Cow<'static, str>,
    /// It is an answer of a plugin: shown, and not changed.
    pub read_only: bool,
    fields: BTreeMap<Cow<'static, str>, Field>,
}

impl Description {
    /// Of something that can be set.
    #[must_use]
    pub fn new(about: impl Into<Cow<'static, str>>) -> Self {
        Self {
            about: about.into(),
            ..Self::default()
        }
    }

    /// Of something that a plugin answers.
    #[must_use]
    pub fn answer(about: impl Into<Cow<'static, str>>) -> Self {
        Self {
            read_only: true,
            ..Self::new(about)
        }
    }

    /// Says what is known of the field at `path`, such as `dust` or `metric.pixels`. Of a list or of an optional value
    /// all have the path of the list, or of the value.
    #[must_use]
    pub fn field(mut self, path: impl Into<Cow<'static, str>>, field: Field) -> Self {
        self.fields.insert(path.into(), field);
        self
    }

    /// What is known of the field at `path`.
    #[must_use]
    pub fn get(&self, path: &str) -> Option<&Field> {
        self.fields.get(path)
    }

    /// The same for a value that stands in an optional one, in a variant or in a tuple: what is known of that.
    #[must_use]
    pub fn of_value(&self, path: &str) -> Option<&Field> {
        self.get(path).or_else(|| {
            let (outer, place) = path.rsplit_once('.')?;
            place.parse::<u8>().ok()?;
            self.get(outer)
        })
    }

    /// Paths of all fields of which something is known.
    pub fn paths(&self) -> impl Iterator<Item = &str> {
        self.fields.keys().map(AsRef::as_ref)
    }
}

/// What is known of all types.
#[derive(Resource, Clone, Debug, Default)]
pub struct Descriptions(HashMap<TypeId, Description>);

impl Descriptions {
    /// What is known of a type.
    #[must_use]
    pub fn get(&self, kind: TypeId) -> Option<&Description> {
        self.0.get(&kind)
    }

    /// Says what is known of a type.
    pub fn insert<T: 'static>(&mut self, description: Description) {
        self.0.insert(TypeId::of::<T>(), description);
    }
}

/// Says what is known of a type: `app.describe::<Fog>(Description::new("Fog").field(..))`.
pub trait Describe {
    /// Says what is known of the type, with the inspector or without, before it is added or after.
    fn describe<T: 'static>(&mut self, description: Description) -> &mut Self;
}

impl Describe for App {
    fn describe<T: 'static>(&mut self, description: Description) -> &mut Self {
        self.init_resource::<Descriptions>();
        self.world_mut()
            .resource_mut::<Descriptions>()
            .insert::<T>(description);
        self
    }
}

/// A number that may not be set.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum RangeError {
    /// Infinite, or no number at all.
    #[error("{field} would be {value}, which is no finite number")]
    NotFinite {
        /// The field.
        field: String,
        /// The number.
        value: f64,
    },
    /// Beyond its range.
    #[error("{field} would be {value}, but must be {low} to {high}{unit}")]
    OutOfRange {
        /// The field.
        field: String,
        /// The number.
        value: f64,
        /// The smallest.
        low: f64,
        /// The largest.
        high: f64,
        /// A space and the unit, where there is one.
        unit: String,
    },
}

/// A number of whichever type.
#[must_use]
pub fn number(value: &dyn PartialReflect) -> Option<f64> {
    macro_rules! numbers {
        ($($of:ty: $convert:expr),* $(,)?) => {
            None$(.or_else(|| value.try_downcast_ref::<$of>().map($convert)))*
        };
    }
    numbers!(
        f32: |n| f64::from(*n),
        f64: |n| *n,
        u8: |n| f64::from(*n),
        u16: |n| f64::from(*n),
        u32: |n| f64::from(*n),
        u64: |n| *n as f64,
        usize: |n| *n as f64,
        i8: |n| f64::from(*n),
        i16: |n| f64::from(*n),
        i32: |n| f64::from(*n),
        i64: |n| *n as f64,
        isize: |n| *n as f64,
    )
}

/// The path of a description that a way into a component has: without its first point, without indices of lists.
#[must_use]
pub fn described_path(path: &str) -> String {
    let mut plain = String::new();
    let mut index = false;
    for c in path.chars() {
        match c {
            '[' => index = true,
            ']' => index = false,
            _ if index => {}
            c => plain.push(c),
        }
    }
    plain.strip_prefix('.').unwrap_or(&plain).to_owned()
}

/// Whether all numbers in `value`, which is to stand at `path`, may be set.
///
/// # Errors
/// [`RangeError`] for the first that may not.
pub fn check(
    description: Option<&Description>,
    path: &str,
    value: &dyn PartialReflect,
) -> Result<(), RangeError> {
    if let Some(number) = number(value) {
        return check_number(description, path, number);
    }
    let join = |name: &str| {
        if path.is_empty() {
            name.to_owned()
        } else {
            format!("{path}.{name}")
        }
    };
    match value.reflect_ref() {
        ReflectRef::Struct(value) => (0..value.field_len()).try_for_each(|k| {
            let name = value.name_at(k).unwrap_or_default();
            value
                .field_at(k)
                .map_or(Ok(()), |field| check(description, &join(name), field))
        }),
        ReflectRef::TupleStruct(value) => (0..value.field_len()).try_for_each(|k| {
            value.field(k).map_or(Ok(()), |field| {
                check(description, &join(&k.to_string()), field)
            })
        }),
        ReflectRef::Tuple(value) => (0..value.field_len()).try_for_each(|k| {
            value.field(k).map_or(Ok(()), |field| {
                check(description, &join(&k.to_string()), field)
            })
        }),
        ReflectRef::List(value) => value
            .iter()
            .try_for_each(|item| check(description, path, item)),
        ReflectRef::Array(value) => value
            .iter()
            .try_for_each(|item| check(description, path, item)),
        ReflectRef::Enum(value) => (0..value.field_len()).try_for_each(|k| {
            let Some(field) = value.field_at(k) else {
                return Ok(());
            };
            match value.name_at(k) {
                Some(name) => check(description, &join(name), field),
                // Of an optional value, or of a variant with a value, as of the value itself.
                None => check(description, path, field),
            }
        }),
        _ => Ok(()),
    }
}

fn check_number(
    description: Option<&Description>,
    path: &str,
    value: f64,
) -> Result<(), RangeError> {
    let known = description.and_then(|description| description.of_value(path));
    let field = if path.is_empty() { "it" } else { path }.to_owned();
    match known.and_then(|known| known.range.as_ref().map(|range| (range, known.unit))) {
        Some((range, unit)) if !contains(range, value) => Err(RangeError::OutOfRange {
            field,
            value,
            low: *range.start(),
            high: *range.end(),
            unit: if unit.is_empty() {
                String::new()
            } else {
                format!(" {unit}")
            },
        }),
        // Nothing is known of it that would allow this.
        None if !value.is_finite() => Err(RangeError::NotFinite { field, value }),
        _ => Ok(()),
    }
}

/// Whether it lies in the range, whose ends may have been rounded to f32 on their way.
fn contains(range: &RangeInclusive<f64>, value: f64) -> bool {
    let [low, high] = [range.start(), range.end()].map(|end| f64::from(*end as f32));
    range.contains(&value) || (low..=high).contains(&value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::reflect::Reflect;

    #[derive(Reflect)]
    struct Fog {
        dust: f32,
        near: Option<f64>,
        layers: Vec<u32>,
        kind: Kind,
    }

    #[derive(Reflect)]
    enum Kind {
        Thin { share: f32 },
        Thick(f32),
    }

    fn fog() -> Fog {
        Fog {
            dust: 0.7,
            near: Some(2.0),
            layers: vec![1, 2],
            kind: Kind::Thin { share: 0.5 },
        }
    }

    fn refused(fog: &Fog) -> Option<String> {
        let description = Description::new("Fog")
            .field("dust", Field::new("Dust").range(0.0..=0.7).unit("g/m3"))
            .field("near", Field::new("Near").range(1.0..=f64::INFINITY))
            .field("layers", Field::new("Layers").range(1.0..=9.0))
            .field("kind", Field::new("Kind").range(0.0..=1.0))
            .field("kind.share", Field::new("Share").range(0.0..=1.0));
        check(Some(&description), "", fog)
            .err()
            .map(|error| error.to_string())
    }

    #[test]
    fn numbers_are_held_to_their_ranges_wherever_they_stand() {
        // 0.7 is 0.699999988 as f32, and is the end of its range all the same.
        assert_eq!(refused(&fog()), None);
        let near = |near| refused(&Fog { near, ..fog() });
        assert_eq!(near(None), None);
        assert_eq!(near(Some(f64::INFINITY)), None);
        assert!(near(Some(0.5)).unwrap().contains("near would be 0.5"));
        assert!(near(Some(f64::NAN)).is_some());
        let dust = |dust| refused(&Fog { dust, ..fog() });
        assert_eq!(
            dust(0.8).unwrap(),
            "dust would be 0.800000011920929, but must be 0 to 0.7 g/m3"
        );
        assert!(dust(f32::NAN).is_some());
        let layers = |layers| refused(&Fog { layers, ..fog() });
        assert!(layers(vec![3, 10]).unwrap().starts_with("layers"));
        let kind = |kind| refused(&Fog { kind, ..fog() });
        assert!(kind(Kind::Thin { share: 2.0 }).is_some());
        assert!(kind(Kind::Thick(-1.0)).is_some());
        assert_eq!(kind(Kind::Thick(1.0)), None);
    }

    #[test]
    fn of_what_is_not_described_numbers_have_to_be_finite() {
        assert!(
            check(None, "x", &f32::NAN)
                .unwrap_err()
                .to_string()
                .contains("x would be NaN")
        );
        assert!(check(None, "x", &f64::INFINITY).is_err());
        assert_eq!(check(None, "x", &-7_i8), Ok(()));
    }

    #[test]
    fn ways_into_a_component_have_paths() {
        assert_eq!(described_path(".sea[2].0"), "sea.0");
        assert_eq!(described_path(""), "");
        assert_eq!(described_path("[3].x"), "x");
    }
}
