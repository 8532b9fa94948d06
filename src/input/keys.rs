//! What every key does: the one table behind `--help`, the F1 panel and the README.

/// A key, or a group of keys, and what it does; for keyboard and mouse, then for the gamepad.
pub struct Key {
    /// Keyboard or mouse.
    pub keys: &'static str,
    /// Gamepad; empty where it has none.
    pub pad: &'static str,
    /// What it does.
    pub does: &'static str,
}

/// All keys of the game, in the order they are shown.
pub const KEYS: &[Key] = &[
    key(
        "W A S D",
        "left stick",
        "walk; fly, when the camera is free",
    ),
    key(
        "Space, left Shift",
        "right, left shoulder",
        "jump; fly up, down, when the camera is free",
    ),
    key(
        "C",
        "left stick down",
        "camera follows the figure, or is free",
    ),
    key("Ctrl", "right trigger", "run; fly faster"),
    key("mouse", "right stick", "look around"),
    key("wheel", "left trigger + right stick", "zoom"),
    key("right mouse", "", "free the cursor, take it again"),
    key("arrows", "directional pad", "walk the figure"),
    key("J", "east button", "jump"),
    key("H", "right stick down", "wave a hand"),
    key(
        "E",
        "south button",
        "in a level: light what is to be lit, press a button",
    ),
    key("left mouse, X", "west button", "in a level: shoot"),
    key(
        "Esc, Enter",
        "start, south button",
        "in a level: its menu; takes what is chosen",
    ),
    key("T", "", "torch on, off"),
    key("R", "", "lighting by Bevy or by Dolomite"),
    key("V", "", "what grows on, off"),
    key("L", "west button", "lines on, off"),
    key("F", "north button", "fill on, off"),
    key(
        "Tab",
        "south button",
        "detail follows the camera or the figure",
    ),
    key(
        "N",
        "",
        "next rule of detail: patches, error; classic, edge, error",
    ),
    key("M", "", "classic scene: next of GPU, CPU, static on each"),
    key("B", "", "what collision knows: shapes, contacts, tiles"),
    key("- =", "", "draw fewer, more pixels; the panel stays sharp"),
    key("F1", "start", "these keys on, off"),
    key("F10", "", "inspector: settings, entities, diagnostics"),
    key("`", "", "console; Tab completes, help lists the commands"),
    key("Esc", "select", "leave"),
];

const fn key(keys: &'static str, pad: &'static str, does: &'static str) -> Key {
    Key { keys, pad, does }
}

/// The table as text, a line a key, columns aligned for a monospaced font.
pub fn table() -> String {
    let keys = width(|key| key.keys);
    let pad = width(|key| key.pad);
    let mut text = format!("{:keys$}  {:pad$}  \n", "keyboard, mouse", "gamepad");
    for key in KEYS {
        text += &format!("{:keys$}  {:pad$}  {}\n", key.keys, key.pad, key.does);
    }
    text
}

fn width(column: fn(&Key) -> &str) -> usize {
    KEYS.iter().map(|key| column(key).len()).max().unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_aligned_and_whole() {
        let table = table();
        assert_eq!(table.lines().count(), KEYS.len() + 1);
        let column = table.find("gamepad").unwrap();
        for (line, key) in table.lines().skip(1).zip(KEYS) {
            assert!(line.is_ascii(), "the built-in font holds ASCII: {line}");
            assert_eq!(&line[column..column + key.pad.len()], key.pad);
            assert!(line.ends_with(key.does));
        }
    }
}
