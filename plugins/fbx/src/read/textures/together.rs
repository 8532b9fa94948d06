//! Two pictures that glTF wants in one.

use super::super::packing::{Refusal, metal_rough, with_opacity};
use super::Textures;
use crate::model::{Image, TextureUse};

/// Pictures that are put together, by their numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Parts {
    /// Metalness, roughness, and whether that is glossiness.
    MetalRough(Option<usize>, Option<usize>, bool),
    /// Colour and opacity.
    Opacity(Option<usize>, usize),
}

impl Textures<'_> {
    /// One picture of metalness and roughness, of which may be said that it is glossiness.
    ///
    /// # Errors
    /// A sentence why not.
    pub(crate) fn metal_rough(
        &mut self,
        metal: Option<&TextureUse>,
        rough: Option<(&TextureUse, bool)>,
    ) -> Result<TextureUse, &'static str> {
        let like = alike(metal, rough.map(|(rough, _)| rough)).ok_or(
            "metalness and roughness are laid on in two ways; glTF wants them in one picture",
        )?;
        let number = |texture: &TextureUse| texture.image;
        let rough_number = rough.map(|(texture, _)| texture.image);
        let is_gloss = rough.is_some_and(|(_, is_gloss)| is_gloss);
        let parts = Parts::MetalRough(metal.map(number), rough_number, is_gloss);
        let image = self.together(parts)?;
        Ok(TextureUse { image, ..like })
    }

    /// The colour's picture, or white, with the opacity of another.
    ///
    /// # Errors
    /// A sentence why not.
    pub(crate) fn with_opacity(
        &mut self,
        colour: Option<&TextureUse>,
        opacity: &TextureUse,
    ) -> Result<TextureUse, &'static str> {
        let like = alike(colour, Some(opacity))
            .ok_or("colour and opacity are laid on in two ways; glTF wants them in one picture")?;
        let parts = Parts::Opacity(colour.map(|texture| texture.image), opacity.image);
        let image = self.together(parts)?;
        Ok(TextureUse { image, ..like })
    }

    fn together(&mut self, parts: Parts) -> Result<usize, &'static str> {
        if let Some(known) = self.packed.get(&parts) {
            return *known;
        }
        let image = |number: usize| self.images.get(number).map(|image| &*image.bytes);
        let of = |number: Option<usize>| number.and_then(image);
        let (first, second) = match parts {
            Parts::MetalRough(metal, rough, _) => (metal, rough),
            Parts::Opacity(colour, opacity) => (colour, Some(opacity)),
        };
        let bytes = of(first).map_or(0, <[u8]>::len) + of(second).map_or(0, <[u8]>::len);
        let memory = self.memory(bytes);
        let made = match parts {
            Parts::MetalRough(_, _, is_gloss) => {
                metal_rough(of(first), of(second).map(|bytes| (bytes, is_gloss)), memory)
            }
            Parts::Opacity(..) => with_opacity(of(first), of(second).unwrap_or_default(), memory),
        };
        let names = [first, second].into_iter().flatten();
        let names = names.filter_map(|number| self.images.get(number));
        let names: Vec<&str> = names.map(|image| image.name.as_str()).collect();
        let name = names.join(" + ");
        let made = match made {
            Ok(bytes) => {
                self.left = self.left.saturating_sub(bytes.len() as u64);
                let mime = "image/png";
                self.images.push(Image { name, mime, bytes });
                Ok(self.images.len() - 1)
            }
            Err(Refusal::TooLarge) => Err(
                "two pictures that glTF wants in one are too large to be put together; raise the limit on memory",
            ),
            Err(Refusal::Broken) => {
                Err("two pictures that glTF wants in one cannot be decoded; save them again")
            }
        };
        self.packed.insert(parts, made);
        made
    }
}

/// How both are laid on, if that is in one way; as the one is that there is.
fn alike(a: Option<&TextureUse>, b: Option<&TextureUse>) -> Option<TextureUse> {
    let first = a.or(b)?;
    let way = |t: &TextureUse| (t.uv_set, t.repeat, t.transform);
    let same = [a, b].into_iter().flatten().all(|t| way(t) == way(first));
    same.then(|| first.clone())
}
