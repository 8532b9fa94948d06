//! A value by reflection as widgets.
//!
//! What is shown is read only; a widget that was moved gives the way to the part that it shows, and its new value.

use std::any::TypeId;

use bevy::ecs::entity::Entity;
use bevy::math::{Vec2, Vec3, Vec4};
use bevy::prelude::{Color, ReflectDefault};
use bevy::reflect::enums::{DynamicEnum, DynamicVariant, Enum, EnumInfo, VariantInfo};
use bevy::reflect::structs::DynamicStruct;
use bevy::reflect::tuple::DynamicTuple;
use bevy::reflect::{PartialReflect, ReflectRef, TypeInfo, TypeRegistry};
use bevy_egui::egui;

use crate::settings::described::{Description, Field, described_path, number};

/// Most items of a list that are shown.
const ITEMS: usize = 32;

/// What widgets need to know.
pub(super) struct Known<'a> {
    pub registry: &'a TypeRegistry,
    pub description: Option<&'a Description>,
    pub enabled: bool,
}

/// A part that was changed: the way to it, and its new value.
pub(super) type Moved = (String, Box<dyn PartialReflect>);

/// Shows a value that stands at `path`, under `name`.
pub(super) fn show(
    ui: &mut egui::Ui,
    known: &Known,
    name: &str,
    path: &str,
    value: &dyn PartialReflect,
) -> Option<Moved> {
    let field = known
        .description
        .and_then(|description| description.of_value(&described_path(path)));
    if let Some(leaf) = leaf(value) {
        return ui
            .horizontal(|ui| {
                label(ui, name, field);
                ui.add_enabled_ui(known.enabled, |ui| leaf_ui(ui, leaf, field, value))
                    .inner
            })
            .inner
            .map(|value| (path.to_owned(), value));
    }
    match value.reflect_ref() {
        ReflectRef::Enum(value) => variant(ui, known, name, path, value, field),
        ReflectRef::Struct(fields) => {
            let parts: Vec<_> = (0..fields.field_len())
                .filter_map(|k| {
                    let part = fields.name_at(k)?;
                    Some((
                        part.to_owned(),
                        format!("{path}.{part}"),
                        fields.field_at(k)?,
                    ))
                })
                .collect();
            group(ui, known, name, path, field, &parts)
        }
        ReflectRef::TupleStruct(fields) => {
            let parts: Vec<_> = (0..fields.field_len())
                .filter_map(|k| Some((k.to_string(), format!("{path}.{k}"), fields.field(k)?)))
                .collect();
            match parts.as_slice() {
                // A name around one value adds nothing.
                [(_, path, value)] => show(ui, known, name, path, *value),
                _ => group(ui, known, name, path, field, &parts),
            }
        }
        ReflectRef::Tuple(fields) => {
            let parts: Vec<_> = (0..fields.field_len())
                .filter_map(|k| Some((k.to_string(), format!("{path}.{k}"), fields.field(k)?)))
                .collect();
            group(ui, known, name, path, field, &parts)
        }
        ReflectRef::List(items) => list(ui, known, name, path, items.iter(), items.len()),
        ReflectRef::Array(items) => list(ui, known, name, path, items.iter(), items.len()),
        _ => {
            ui.horizontal(|ui| {
                label(ui, name, field);
                let mut text = format!("{value:?}");
                if let Some((at, _)) = text.char_indices().nth(80) {
                    text.truncate(at);
                    text += " ...";
                }
                ui.weak(text);
            });
            None
        }
    }
}

/// A value that one widget shows.
enum Leaf {
    Number,
    Switch(bool),
    Text(String),
    Colour(Color),
    Entity(Entity),
}

fn leaf(value: &dyn PartialReflect) -> Option<Leaf> {
    if number(value).is_some() {
        return Some(Leaf::Number);
    }
    let is = |leaf: &dyn PartialReflect| -> Option<Leaf> {
        leaf.try_downcast_ref::<bool>()
            .map(|on| Leaf::Switch(*on))
            .or_else(|| {
                let text = leaf.try_downcast_ref::<String>();
                text.map(|text| Leaf::Text(text.clone()))
            })
            .or_else(|| {
                let colour = leaf.try_downcast_ref::<Color>();
                colour.map(|colour| Leaf::Colour(*colour))
            })
            .or_else(|| {
                let entity = leaf.try_downcast_ref::<Entity>();
                entity.map(|entity| Leaf::Entity(*entity))
            })
    };
    is(value)
}

fn leaf_ui(
    ui: &mut egui::Ui,
    leaf: Leaf,
    field: Option<&Field>,
    value: &dyn PartialReflect,
) -> Option<Box<dyn PartialReflect>> {
    match leaf {
        Leaf::Number => number_ui(ui, field, value),
        Leaf::Switch(mut on) => ui
            .checkbox(&mut on, "")
            .changed()
            .then(|| Box::new(on) as Box<dyn PartialReflect>),
        Leaf::Text(mut text) => ui
            .add(egui::TextEdit::singleline(&mut text).desired_width(180.0))
            .changed()
            .then(|| Box::new(text) as Box<dyn PartialReflect>),
        Leaf::Colour(colour) => {
            let linear = colour.to_linear();
            let mut parts = [linear.red, linear.green, linear.blue, linear.alpha];
            ui.color_edit_button_rgba_unmultiplied(&mut parts)
                .changed()
                .then(|| {
                    let [red, green, blue, alpha] = parts;
                    let colour = Color::linear_rgba(red, green, blue, alpha);
                    Box::new(colour) as Box<dyn PartialReflect>
                })
        }
        Leaf::Entity(entity) => {
            ui.monospace(entity.to_string());
            None
        }
    }
}

/// A slider where the range is known and has two ends, else a number to drag.
fn number_ui(
    ui: &mut egui::Ui,
    field: Option<&Field>,
    value: &dyn PartialReflect,
) -> Option<Box<dyn PartialReflect>> {
    let unit = field.map_or("", |field| field.unit);
    let suffix = if unit.is_empty() {
        String::new()
    } else {
        format!(" {unit}")
    };
    macro_rules! widget {
        ($($of:ty),*) => {
            $(if let Some(&number) = value.try_downcast_ref::<$of>() {
                let mut new = number;
                let range = field.and_then(|field| field.range.clone());
                let range = range.map(|range| (*range.start() as $of)..=(*range.end() as $of));
                let ends = range.clone().filter(|range| {
                    let [low, high] = [*range.start() as f64, *range.end() as f64];
                    low.is_finite() && high.is_finite() && high < 1e9
                });
                let response = match (ends, range) {
                    (Some(ends), _) => ui.add(
                        egui::Slider::new(&mut new, ends)
                            .logarithmic(field.is_some_and(|field| field.logarithmic))
                            .clamping(egui::SliderClamping::Edits)
                            .suffix(suffix),
                    ),
                    (None, range) => {
                        let drag = egui::DragValue::new(&mut new)
                            .speed(((number as f64).abs() * 0.01).max(0.01))
                            .suffix(suffix);
                        ui.add(match range {
                            Some(range) => drag.range(range).clamp_existing_to_range(false),
                            None => drag,
                        })
                    }
                };
                return (response.changed() && new != number)
                    .then(|| Box::new(new) as Box<dyn PartialReflect>);
            })*
        };
    }
    widget!(f32, f64, u8, u16, u32, u64, usize, i8, i16, i32, i64, isize);
    None
}

fn label(ui: &mut egui::Ui, name: &str, field: Option<&Field>) {
    let label = ui.label(name);
    if let Some(field) = field.filter(|field| !field.about.is_empty()) {
        label.on_hover_text(field.about.as_ref());
    }
}

/// Parts below a heading; a few numbers stand beside it.
fn group(
    ui: &mut egui::Ui,
    known: &Known,
    name: &str,
    path: &str,
    field: Option<&Field>,
    parts: &[(String, String, &dyn PartialReflect)],
) -> Option<Moved> {
    if parts.is_empty() {
        ui.label(name);
        return None;
    }
    if parts.len() <= 4 && parts.iter().all(|(.., value)| number(*value).is_some()) {
        let row = ui.horizontal_wrapped(|ui| {
            label(ui, name, field);
            let mut moved = None;
            for (part, path, value) in parts {
                ui.weak(part);
                let field = known
                    .description
                    .and_then(|description| description.of_value(&described_path(path)));
                let new = ui
                    .add_enabled_ui(known.enabled, |ui| number_ui(ui, field, *value))
                    .inner;
                moved = moved.or(new.map(|value| (path.clone(), value)));
            }
            moved
        });
        return row.inner;
    }
    let mut moved = None;
    let mut body = |ui: &mut egui::Ui| {
        for (part, path, value) in parts {
            let new = show(ui, known, part, path, *value);
            moved = moved.take().or(new);
        }
    };
    if name.is_empty() {
        body(ui);
    } else {
        egui::CollapsingHeader::new(name)
            .id_salt(path)
            .default_open(parts.len() <= 8)
            .show(ui, |ui| body(ui));
    }
    moved
}

fn list<'a>(
    ui: &mut egui::Ui,
    known: &Known,
    name: &str,
    path: &str,
    items: impl Iterator<Item = &'a dyn PartialReflect>,
    length: usize,
) -> Option<Moved> {
    let mut moved = None;
    egui::CollapsingHeader::new(format!("{name} ({length})"))
        .id_salt(path)
        .show(ui, |ui| {
            for (k, item) in items.take(ITEMS).enumerate() {
                let new = show(ui, known, &k.to_string(), &format!("{path}[{k}]"), item);
                moved = moved.take().or(new);
            }
            if length > ITEMS {
                ui.weak(format!("and {} more", length - ITEMS));
            }
        });
    moved
}

fn variant(
    ui: &mut egui::Ui,
    known: &Known,
    name: &str,
    path: &str,
    value: &dyn Enum,
    field: Option<&Field>,
) -> Option<Moved> {
    let now = value.variant_name();
    let mut moved = None;
    ui.horizontal(|ui| {
        label(ui, name, field);
        let Some(TypeInfo::Enum(info)) = value.get_represented_type_info() else {
            ui.label(now);
            return;
        };
        ui.add_enabled_ui(known.enabled, |ui| {
            egui::ComboBox::from_id_salt(path)
                .selected_text(now)
                .show_ui(ui, |ui| {
                    for other in choices(known.registry, info) {
                        let name = other.variant_name().to_owned();
                        let chosen = ui.selectable_label(name == now, &name).clicked();
                        if chosen && name != now {
                            moved = Some((path.to_owned(), Box::new(other) as _));
                        }
                    }
                });
        });
    });
    ui.indent(path, |ui| {
        for k in 0..value.field_len() {
            let Some(part) = value.field_at(k) else {
                continue;
            };
            let (name, path) = match value.name_at(k) {
                Some(name) => (name.to_owned(), format!("{path}.{name}")),
                None => (String::new(), format!("{path}.{k}")),
            };
            let new = show(ui, known, &name, &path, part);
            moved = moved.take().or(new);
        }
    });
    moved
}

/// The variants that can be made, with values by default.
fn choices(registry: &TypeRegistry, info: &EnumInfo) -> Vec<DynamicEnum> {
    let by_default = |id: TypeId| by_default(registry, id);
    info.iter()
        .filter_map(|variant| {
            let content = match variant {
                VariantInfo::Unit(_) => DynamicVariant::Unit,
                VariantInfo::Tuple(info) => {
                    let mut tuple = DynamicTuple::default();
                    for field in info.iter() {
                        tuple.insert_boxed(by_default(field.type_id())?);
                    }
                    DynamicVariant::Tuple(tuple)
                }
                VariantInfo::Struct(info) => {
                    let mut fields = DynamicStruct::default();
                    for field in info.iter() {
                        fields.insert_boxed(field.name(), by_default(field.type_id())?);
                    }
                    DynamicVariant::Struct(fields)
                }
            };
            Some(DynamicEnum::new(variant.name(), content))
        })
        .collect()
}

fn by_default(registry: &TypeRegistry, id: TypeId) -> Option<Box<dyn PartialReflect>> {
    macro_rules! plain {
        ($($of:ty),*) => {
            $(if id == TypeId::of::<$of>() {
                return Some(Box::<$of>::default());
            })*
        };
    }
    // What every app has, whether its registry knows a default for it or not.
    plain!(
        bool, f32, f64, u8, u16, u32, u64, usize, i8, i16, i32, i64, isize, String, Vec2, Vec3,
        Vec4
    );
    if let Some(default) = registry.get_type_data::<ReflectDefault>(id) {
        return Some(default.default().into_partial_reflect());
    }
    match registry.get_type_info(id)? {
        TypeInfo::Enum(info) => {
            let first = choices(registry, info).into_iter().next()?;
            Some(Box::new(first))
        }
        TypeInfo::Tuple(info) => {
            let mut tuple = DynamicTuple::default();
            for field in info.iter() {
                tuple.insert_boxed(by_default(registry, field.type_id())?);
            }
            Some(Box::new(tuple))
        }
        _ => None,
    }
}
