//! Properties that take their values from others.

use ufbx::{Connection, Element, PropFlags};

/// How many properties may hang on each other in a row, as in ufbx.
const HANGING: usize = 1000;

/// The property that another one takes its value from, if it does.
pub(crate) fn source_of<'a>(element: &'a Element, name: &str) -> Option<(&'a Element, &'a str)> {
    let prop = ufbx::find_prop(&element.props, name)?;
    if !prop.flags.has_any(PropFlags::CONNECTED) {
        return None;
    }
    let above = |element: &'a Element, name: &str| -> Option<(&'a Element, &'a str)> {
        let is_its = |c: &&'a Connection| !c.src_prop.is_empty() && c.dst_prop.as_ref() == name;
        let connection = (&element.connections_dst).into_iter().find(is_its)?;
        Some((connection.src.as_ref(), &connection.src_prop))
    };
    let mut at = above(element, name)?;
    for _ in 0..HANGING {
        match above(at.0, at.1) {
            Some(next) => at = next,
            None => return Some(at),
        }
    }
    // They hang on each other in a circle.
    None
}
