//! Letters and colours of what is said over a level, and the mark of all of it.

use bevy::prelude::*;

/// Everything that is shown while a level is played.
#[derive(Component)]
pub struct Hud;

/// A text of a size in a colour.
pub fn text(words: &str, size: f32, color: Color) -> (Text, TextFont, TextColor) {
    (
        Text::new(words),
        TextFont {
            font_size: FontSize::Px(size),
            ..default()
        },
        TextColor(color),
    )
}

/// The colour of letters.
pub const LETTERS: Color = Color::srgb(0.93, 0.95, 0.97);

/// The colour of what is less important.
pub const PALE: Color = Color::srgb(0.66, 0.70, 0.75);

/// The colour of fire, and of what is chosen.
pub const FIRE: Color = Color::srgb(1.0, 0.72, 0.30);

/// The colour of danger.
pub const DANGER: Color = Color::srgb(1.0, 0.36, 0.28);

/// What letters stand on.
pub const GLASS: Color = Color::srgba(0.03, 0.05, 0.08, 0.62);
