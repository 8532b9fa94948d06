//! Query, set, act: what a system asks of logic.

use crate::action::Action;
use crate::names::Key;
use crate::value::{Typed, Value, ValueError};
use crate::values::Values;
use bevy::ecs::prelude::*;
use bevy::ecs::system::SystemParam;

/// The logic of every entity, by name.
///
/// ```
/// use bevy::ecs::prelude::*;
/// use dolomite_logic::{Key, LogicAccess};
///
/// #[derive(Component)]
/// struct Guard;
///
/// fn alarm(guards: Query<Entity, With<Guard>>, mut logic: LogicAccess) {
///     for guard in &guards {
///         if logic.query::<f32>(guard, Key::ALERT).unwrap_or(0.0) > 0.5 {
///             logic.act(guard, guard, Key::WAKE, ());
///         }
///     }
/// }
/// ```
#[derive(SystemParam)]
pub struct LogicAccess<'w, 's> {
    values: Query<'w, 's, &'static mut Values>,
    actions: MessageWriter<'w, Action>,
}

impl LogicAccess<'_, '_> {
    /// A value of an entity; nothing if the entity is gone, or never had it, or has it as another type.
    #[inline]
    #[must_use]
    pub fn query<T: Typed>(&self, entity: Entity, name: Key) -> Option<T> {
        self.values.get(entity).ok()?.read(name)
    }

    /// Sets a value and gives the one before.
    ///
    /// # Errors
    /// [`ValueError`]; nothing is changed then.
    #[inline]
    pub fn set(
        &mut self,
        entity: Entity,
        name: Key,
        value: impl Into<Value>,
    ) -> Result<Option<Value>, ValueError> {
        match self.values.get_mut(entity) {
            Ok(mut values) => values.set(name, value.into()),
            Err(_) => Err(ValueError::NoValues),
        }
    }

    /// Asks an entity to do something.
    #[inline]
    pub fn act(&mut self, source: Entity, target: Entity, verb: Key, parameter: impl Into<Value>) {
        self.actions.write(Action {
            target,
            source,
            verb,
            parameter: parameter.into(),
        });
    }
}
