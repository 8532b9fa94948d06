//! Names in the document, and the extensions that it says it uses.

use gltf_json::Root;

/// `None` for no name.
pub(crate) fn name(name: &str) -> Option<String> {
    (!name.is_empty()).then(|| name.to_owned())
}

/// Names an extension as used, once.
pub(crate) fn uses(root: &mut Root, extension: &str) {
    if !root.extensions_used.iter().any(|known| known == extension) {
        root.extensions_used.push(extension.into());
    }
}
