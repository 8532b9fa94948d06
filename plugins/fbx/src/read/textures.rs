//! Pictures of materials: embedded ones are taken out, others are looked for.

mod together;

use super::finder::{Finder, last_part};
use super::pictures::{Picture, has_alpha, picture, saved_again};
use super::uv_sets::{UvNames, is_same_set};
use super::uv_transform::placed;
use crate::model::{Image, Material, TextureUse};
use crate::options::{Budget, Origin};
use crate::report::Report;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use together::Parts;
use ufbx::{MaterialMap, Texture, TextureType, WrapMode};

/// The largest file that is read as a picture, bytes: a TGA of 8192 by 8192 pixels with alpha.
const LARGEST: u64 = 257 << 20;
/// Pictures of one FBX file together, bytes, where nobody set a limit on memory.
const TOGETHER: u64 = 1 << 30;
/// What a picture may take to be turned into PNG over the size of its file, beside what the FBX file may
/// take, where nobody set a limit on memory: as much as that may over its own.
const TIMES: u64 = 16;

/// Pictures that were found so far.
pub(crate) struct Textures<'a> {
    origin: &'a Origin,
    budget: &'a Budget,
    /// Nobody set a limit on memory: files that are read count as what the limit grows with.
    grows: bool,
    /// What may still be read or made, bytes.
    left: u64,
    finder: Finder,
    known: BTreeMap<u32, Option<usize>>,
    /// Pictures that were put together, by those that they are of.
    packed: BTreeMap<Parts, Result<usize, &'static str>>,
    /// Lines that were said.
    told: BTreeSet<(&'static str, String)>,
    images: Vec<Image>,
    /// The last file that was read, where others may be meant as well, and how many.
    unsure: Option<(PathBuf, usize)>,
}

/// Why there is no picture.
enum Missing {
    /// It is nowhere.
    Absent,
    /// It is there: a word for programs, and a sentence.
    Unfit(&'static str, String),
}

impl<'a> Textures<'a> {
    /// `grows` where nobody set limits.
    pub(crate) fn new(origin: &'a Origin, budget: &'a Budget, grows: bool) -> Self {
        let memory = budget.limits.memory as u64;
        Self {
            origin,
            budget,
            grows,
            left: if grows { TOGETHER.max(memory) } else { memory },
            finder: Finder::new(&origin.name, origin.folder.as_deref(), &origin.textures),
            known: BTreeMap::new(),
            packed: BTreeMap::new(),
            told: BTreeSet::new(),
            images: Vec::new(),
            unsure: None,
        }
    }

    /// The picture of a material's map and how it is laid on; `None` where there is none, or none
    /// that glTF can hold, which the report says then. Its UV set is the number in `names`.
    pub(crate) fn of_map(
        &mut self,
        map: &MaterialMap,
        names: &mut UvNames,
        report: &mut Report,
    ) -> Option<TextureUse> {
        if !map.texture_enabled {
            return None;
        }
        let texture = self.file(map.texture.as_deref()?, report)?;
        let image = self.image(texture, report)?;
        let (transform, sheared) = placed(&texture.element.props);
        if sheared {
            let detail = "is turned in space; glTF lays pictures on in the plane, and only that part is kept";
            self.lose("texture-transform", name_of(texture), detail, report);
        }
        Some(TextureUse {
            image,
            uv_set: names.number(&texture.uv_set),
            repeat: [texture.wrap_u, texture.wrap_v].map(|wrap| wrap == WrapMode::Repeat),
            transform,
        })
    }

    /// Whether a picture that was found has an alpha channel.
    pub(crate) fn has_alpha(&self, texture: &TextureUse) -> bool {
        let image = self.images.get(texture.image);
        image.is_some_and(|image| has_alpha(&image.bytes))
    }

    /// What may be taken to turn pictures of so many bytes into another.
    fn memory(&self, bytes: usize) -> u64 {
        let memory = match self.grows {
            true => self.budget.limits.memory as u64 + TIMES * bytes as u64,
            false => self.left,
        };
        memory.min(self.left)
    }

    /// The pictures that `materials` use; they are numbered anew.
    pub(crate) fn used(self, materials: &mut [Material]) -> Vec<Image> {
        let mut numbers: Vec<Option<usize>> = vec![None; self.images.len()];
        let of = |material: &Material| -> Vec<usize> {
            material.textures().map(|texture| texture.image).collect()
        };
        for image in materials.iter().flat_map(of) {
            if let Some(number) = numbers.get_mut(image) {
                *number = Some(0);
            }
        }
        for (next, number) in numbers.iter_mut().flatten().enumerate() {
            *number = next;
        }
        for texture in materials.iter_mut().flat_map(Material::textures_mut) {
            let number = numbers.get(texture.image).copied().flatten();
            texture.image = number.unwrap_or_default();
        }
        let all = self.images.into_iter().zip(numbers);
        all.filter_map(|(image, number)| number.map(|_| image))
            .collect()
    }

    /// One line for each thing, however often it is used.
    fn lose(
        &mut self,
        what: &'static str,
        name: String,
        detail: impl Into<String>,
        report: &mut Report,
    ) {
        if self.told.insert((what, name.clone())) {
            report.lose(what, &name, detail);
        }
    }

    /// What a layered or computed texture shows first; a picture is its own.
    fn file<'t>(&mut self, texture: &'t Texture, report: &mut Report) -> Option<&'t Texture> {
        if texture.type_ == TextureType::File {
            return Some(texture);
        }
        let first = (&texture.file_textures).into_iter().next();
        let detail = match (texture.file_textures.len(), texture.type_) {
            (0, _) => "is computed and no picture; nothing is shown for it".to_owned(),
            // One layer alone is what it shows.
            (1, TextureType::Layered) => return first,
            (1, _) => "is computed from a picture, which is taken as it is".to_owned(),
            (many, _) => format!("is made of {many} pictures; the first is taken"),
        };
        let name = texture.element.name.to_string();
        self.lose("texture-layers", name, detail, report);
        first
    }

    fn image(&mut self, texture: &Texture, report: &mut Report) -> Option<usize> {
        let id = texture.element.typed_id;
        if let Some(&known) = self.known.get(&id) {
            return known;
        }
        self.unsure = None;
        let read = self.read(texture);
        if let (Ok(_), Some((path, others))) = (&read, self.unsure.take()) {
            let detail = format!(
                "{others} more of this name lie below the folders that are given, in folders that the file does not name; that of {} is taken",
                path.display()
            );
            self.lose("texture-name", name_of(texture), detail, report);
        }
        let made = match read {
            Ok(image) => {
                let same = |other: &Image| other.bytes == image.bytes;
                let same = self.images.iter().position(same);
                Some(same.unwrap_or_else(|| {
                    self.images.push(image);
                    self.images.len() - 1
                }))
            }
            Err(missing) => {
                let (what, detail) = match missing {
                    Missing::Unfit(what, detail) => (what, detail),
                    Missing::Absent => {
                        let places = self.finder.places();
                        (
                            "texture-file",
                            format!("is not embedded and not found: {places}"),
                        )
                    }
                };
                self.lose(what, name_of(texture), detail, report);
                None
            }
        };
        self.known.insert(id, made);
        made
    }

    fn read(&mut self, texture: &Texture) -> Result<Image, Missing> {
        let content: &[u8] = match &texture.video {
            Some(video) if texture.content.is_empty() => &video.content,
            _ => &texture.content,
        };
        let names = paths_of(texture);
        let mut why = Missing::Absent;
        if !content.is_empty() {
            let bytes = self.take(content);
            match bytes.and_then(|bytes| self.fit(&name_of(texture), bytes)) {
                Ok(image) => return Ok(image),
                Err(missing) => why = missing,
            }
        }
        // What is embedded may be broken, and lie beside the file whole.
        match self.load(&names) {
            Ok(Some(bytes)) => match self.fit(&name_of(texture), bytes) {
                Ok(image) => return Ok(image),
                Err(missing) => why = missing,
            },
            Ok(None) => {}
            Err(missing) => why = missing,
        }
        // Saved again as a kind that glTF holds.
        let again = names.iter().flat_map(|name| saved_again(name));
        for name in again.collect::<Vec<_>>() {
            if let Ok(Some(bytes)) = self.load(&[&name])
                && let Ok(image) = self.fit(last_part(&name), bytes)
            {
                return Ok(image);
            }
        }
        Err(why)
    }

    /// As glTF holds it.
    fn fit(&mut self, name: &str, bytes: Vec<u8>) -> Result<Image, Missing> {
        let memory = self.memory(bytes.len());
        let made = picture(name, &bytes, memory);
        let made = made.map_err(|why| Missing::Unfit("texture-format", why))?;
        let (mime, bytes) = match made {
            Picture::Kept(mime) => (mime, bytes),
            Picture::Turned(png) => {
                self.left = self.left.saturating_sub(png.len() as u64);
                ("image/png", png)
            }
        };
        let name = name.to_owned();
        Ok(Image { name, mime, bytes })
    }

    /// A copy of what is embedded, which costs.
    fn take(&mut self, bytes: &[u8]) -> Result<Vec<u8>, Missing> {
        self.pay(bytes.len() as u64)?;
        Ok(bytes.to_vec())
    }

    fn pay(&mut self, bytes: u64) -> Result<(), Missing> {
        let most = LARGEST.min(self.left);
        if bytes > most {
            let detail = format!(
                "has {bytes} bytes, of {most} that pictures may still take; save it smaller, or raise the limit on memory"
            );
            return Err(Missing::Unfit("texture-size", detail));
        }
        self.left -= bytes;
        Ok(())
    }

    /// The first of `names` that is given or found.
    fn load(&mut self, names: &[&str]) -> Result<Option<Vec<u8>>, Missing> {
        self.unsure = None;
        let given = names.iter().find_map(|name| given(self.origin, name));
        if let Some(bytes) = given {
            return self.take(bytes).map(Some);
        }
        let Some(found) = self.finder.find(names) else {
            return Ok(None);
        };
        let path = found.path;
        self.unsure = (found.others > 0).then(|| (path.clone(), found.others));
        let length = size(&path)?;
        self.pay(length)?;
        std::fs::read(&path)
            .map(Some)
            .map_err(|error| unread(&path, &error))
    }
}

fn size(path: &Path) -> Result<u64, Missing> {
    let about = std::fs::metadata(path).map_err(|error| unread(path, &error))?;
    Ok(about.len())
}

fn unread(path: &Path, error: &std::io::Error) -> Missing {
    let detail = format!("{} cannot be read: {error}", path.display());
    Missing::Unfit("texture-file", detail)
}

/// A file that was given beside the FBX file, by the last part of its name, in any case.
fn given<'o>(origin: &'o Origin, name: &str) -> Option<&'o [u8]> {
    let last = last_part(name);
    let exact = origin.files.get(last);
    let any_case = || {
        let lower = last.to_lowercase();
        let mut files = origin.files.iter();
        files.find_map(|(name, bytes)| (name.to_lowercase() == lower).then_some(bytes))
    };
    exact.or_else(any_case).map(Vec::as_slice)
}

/// Whether both textures show a picture at the same places of a surface.
pub(crate) fn is_laid_alike(a: &Texture, b: &Texture) -> bool {
    let way = |texture: &Texture| {
        let repeats = [texture.wrap_u, texture.wrap_v].map(|wrap| wrap == WrapMode::Repeat);
        (repeats, placed(&texture.element.props))
    };
    is_same_set(&a.uv_set, &b.uv_set) && way(a) == way(b)
}

/// Where the file says that the picture is, the likeliest first.
fn paths_of(texture: &Texture) -> Vec<&str> {
    let own = [
        &texture.relative_filename,
        &texture.filename,
        &texture.absolute_filename,
    ];
    let video = texture.video.as_deref();
    let video = video.map(|v| [&v.relative_filename, &v.filename, &v.absolute_filename]);
    let all = own.into_iter().chain(video.into_iter().flatten());
    let mut paths: Vec<&str> = Vec::new();
    for path in all.map(|path| &**path) {
        if !path.is_empty() && !paths.contains(&path) {
            paths.push(path);
        }
    }
    paths
}

/// The last part of the picture's path, else the name of the texture.
fn name_of(texture: &Texture) -> String {
    let first = paths_of(texture).into_iter().next();
    first.map_or(&*texture.element.name, last_part).to_owned()
}
