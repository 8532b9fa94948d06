//! Names in the document, and the extensions that it says it uses.

use crate::model::Properties;
use gltf_json::{Extras, Root};

/// `None` for no name.
pub(crate) fn name(name: &str) -> Option<String> {
    (!name.is_empty()).then(|| name.to_owned())
}

/// Extras of an object; none for none.
pub(crate) fn extras(own: Option<&Properties>) -> Extras {
    serde_json::value::to_raw_value(own?).ok()
}

/// Names an extension as used, once.
pub(crate) fn uses(root: &mut Root, extension: &str) {
    if !root.extensions_used.iter().any(|known| known == extension) {
        root.extensions_used.push(extension.into());
    }
}
