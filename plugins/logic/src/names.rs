//! Names of values, actions and leaves, each known by a number.
//!
//! A name is looked up once, when a behaviour is loaded or a system is made; what runs every step compares numbers.
//! Numbers are handed out in the order in which names come, so an app that starts in the same way has the same ones.

use bevy::ecs::prelude::*;
use bevy::platform::collections::HashMap;

/// The number of a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Key(u32);

impl Key {
    /// Its place in the order in which names came.
    #[inline]
    #[must_use]
    pub const fn number(self) -> u32 {
        self.0
    }
}

macro_rules! built_in {
    ($($name:ident = $number:literal, $text:literal, $about:literal;)*) => {
        /// Names that every app knows; the ready-made parts use them.
        impl Key {
            $(#[doc = concat!("`", $text, "`: ", $about)]
            pub const $name: Self = Self($number);)*
        }

        /// In the order of their numbers.
        const BUILT_IN: &[(u32, &str)] = &[$(($number, $text)),*];
    };
}

built_in! {
    PRESS = 0, "press", "an action: a button is pressed.";
    PRESSED = 1, "pressed", "an output: a button was pressed.";
    OPEN = 2, "open", "an action: a door opens.";
    CLOSE = 3, "close", "an action: a door closes.";
    TOGGLE = 4, "toggle", "an action: what is open or on becomes closed or off, and the other way.";
    LOCK = 5, "lock", "an action: a door or button does not answer until it is unlocked.";
    UNLOCK = 6, "unlock", "an action: the end of a lock.";
    OPENED = 7, "opened", "an output: a door is wholly open.";
    CLOSED = 8, "closed", "an output: a door is wholly closed.";
    BLOCK = 9, "block", "an action: something is in the way of a door that closes.";
    CALL = 10, "call", "an action: a lift comes to a floor, its parameter.";
    ARRIVED = 11, "arrived", "an output: a lift stands at a floor, its parameter.";
    START = 12, "start", "an action: a timer runs.";
    STOP = 13, "stop", "an action: a timer rests.";
    RESET = 14, "reset", "an action: a timer, an objective or a weapon is as at first.";
    ELAPSED = 15, "elapsed", "an output: a timer ran out.";
    DAMAGE = 16, "damage", "an action: health is taken, its parameter.";
    HEAL = 17, "heal", "an action: health is given, its parameter.";
    HURT = 18, "hurt", "an output: health was taken.";
    DIED = 19, "died", "an output: no health is left; the parameter is who did it.";
    ENTERED = 20, "entered", "an output: somebody came into a zone; the parameter is who.";
    LEFT = 21, "left", "an output: somebody went out of a zone; the parameter is who.";
    TAKEN = 22, "taken", "an output: a pick-up was taken; the parameter is who has it.";
    FIRE = 23, "fire", "an action: a weapon shoots along its parameter, a direction, or at it, an entity.";
    FIRED = 24, "fired", "an output: a weapon shot.";
    EMPTY = 25, "empty", "an output: a weapon has no round left.";
    RELOAD = 26, "reload", "an action: a weapon gets its rounds.";
    PROGRESS = 27, "progress", "an action: an objective comes nearer, by its parameter or 1.";
    FAIL = 28, "fail", "an action: an objective cannot be reached any more.";
    DONE = 29, "done", "an output: an objective is reached.";
    FAILED = 30, "failed", "an output: an objective is lost.";
    WON = 31, "won", "an output: a mission is won.";
    LOST = 32, "lost", "an output: a mission is lost.";
    ON = 33, "on", "an action: a lamp is lit.";
    OFF = 34, "off", "an action: a lamp goes out.";
    DAWN = 35, "dawn", "an output: the day begins.";
    DUSK = 36, "dusk", "an output: the night begins.";
    WAKE = 37, "wake", "an action: who sleeps wakes up.";
    SLEEP = 38, "sleep", "an action: who is awake falls asleep.";
    TARGET = 39, "target", "a value: whom an agent is after.";
    PLACE = 40, "place", "a value: where an agent wants to be, or saw or heard something.";
    ALERT = 41, "alert", "a value: how sure an agent is that somebody is there, 0 to 1.";
    HEALTH = 42, "health", "a value: a part of full health, 0 to 1, written by `Health`.";
}

/// All names of an app.
#[derive(Resource, Clone, Debug)]
pub struct Names {
    texts: Vec<Box<str>>,
    numbers: HashMap<Box<str>, u32>,
}

impl Default for Names {
    /// The built-in names.
    fn default() -> Self {
        let mut names = Self {
            texts: Vec::new(),
            numbers: HashMap::default(),
        };
        for &(number, text) in BUILT_IN {
            let key = names.intern(text);
            debug_assert_eq!(key.0, number, "{text}");
        }
        names
    }
}

impl Names {
    /// The number of a name, which is new if nobody used it before.
    pub fn intern(&mut self, text: &str) -> Key {
        if let Some(&number) = self.numbers.get(text) {
            return Key(number);
        }
        let number = self.texts.len() as u32;
        self.texts.push(text.into());
        self.numbers.insert(text.into(), number);
        Key(number)
    }

    /// The number of a name that somebody used before.
    #[must_use]
    pub fn find(&self, text: &str) -> Option<Key> {
        self.numbers.get(text).map(|&number| Key(number))
    }

    /// The name of a number; empty of one that another app made.
    #[must_use]
    pub fn text(&self, key: Key) -> &str {
        self.texts.get(key.0 as usize).map_or("", |text| text)
    }

    /// The text of the name with this number, as [`Values::sorted`](crate::Values::sorted) gives it; empty where it has none.
    #[must_use]
    pub fn text_of(&self, number: u32) -> &str {
        self.text(Key(number))
    }

    /// How many there are.
    #[must_use]
    pub fn len(&self) -> usize {
        self.texts.len()
    }

    /// Never: there are built-in names.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.texts.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn built_in_names_have_their_numbers_and_are_told_apart() {
        let mut names = Names::default();
        for (at, &(number, text)) in BUILT_IN.iter().enumerate() {
            assert_eq!(at as u32, number, "{text}");
            assert_eq!(names.find(text), Some(Key(number)), "{text}");
            assert_eq!(names.text(Key(number)), text);
        }
        assert_eq!(names.len(), BUILT_IN.len());
        let new = names.intern("lantern");
        assert_eq!(names.intern("lantern"), new);
        assert_eq!(names.text(new), "lantern");
        assert_eq!(names.text(Key(999)), "");
        assert_eq!(names.find("Lantern"), None);
    }
}
