//! Pictures: embedded ones are taken out, others are looked for below the file's own folder.

use super::convert::{finite, matrix};
use crate::model::{Image, TextureUse};
use crate::options::Origin;
use crate::report::Report;
use glam::DVec2;
use std::collections::BTreeMap;
use std::path::{Component, Path, PathBuf};
use ufbx::{MaterialMap, Texture, TextureType, WrapMode};

/// The largest picture that is read from the folder, bytes.
const LARGEST: u64 = 64 << 20;

/// Pictures that were found so far.
pub(crate) struct Textures<'a> {
    origin: &'a Origin,
    /// What may still be read, bytes.
    left: u64,
    known: BTreeMap<u32, Option<usize>>,
    pub(crate) images: Vec<Image>,
}

impl<'a> Textures<'a> {
    pub(crate) fn new(origin: &'a Origin, memory: usize) -> Self {
        Self {
            origin,
            left: memory as u64,
            known: BTreeMap::new(),
            images: Vec::new(),
        }
    }

    /// The picture of a material's map and how it is laid on; `None` where there is none, or none
    /// that glTF can hold, which the report says then.
    pub(crate) fn of_map(
        &mut self,
        map: &MaterialMap,
        uv_sets: &[String],
        report: &mut Report,
    ) -> Option<TextureUse> {
        if !map.texture_enabled {
            return None;
        }
        let texture = picture(map.texture.as_deref()?, report)?;
        let image = self.image(texture, report)?;
        let uv_set = uv_sets.iter().position(|name| *name == *texture.uv_set);
        Some(TextureUse {
            image,
            uv_set: uv_set.unwrap_or(0) as u32,
            repeat: [texture.wrap_u, texture.wrap_v].map(|wrap| wrap == WrapMode::Repeat),
            transform: texture.has_uv_transform.then(|| placed(texture)).flatten(),
        })
    }

    fn image(&mut self, texture: &Texture, report: &mut Report) -> Option<usize> {
        let id = texture.element.typed_id;
        if let Some(&known) = self.known.get(&id) {
            return known;
        }
        let made = self.find(texture, report).map(|image| {
            let same = self
                .images
                .iter()
                .position(|other| other.bytes == image.bytes);
            same.unwrap_or_else(|| {
                self.images.push(image);
                self.images.len() - 1
            })
        });
        self.known.insert(id, made);
        made
    }

    fn find(&mut self, texture: &Texture, report: &mut Report) -> Option<Image> {
        let content: &[u8] = match &texture.video {
            Some(video) if texture.content.is_empty() => &video.content,
            _ => &texture.content,
        };
        let names = [
            &texture.relative_filename,
            &texture.filename,
            &texture.absolute_filename,
        ];
        let names: Vec<&str> = names
            .into_iter()
            .map(|n| &**n)
            .filter(|n| !n.is_empty())
            .collect();
        let name = names
            .first()
            .map_or(&*texture.element.name, |n| last_part(n))
            .to_owned();
        let bytes = match content.is_empty() {
            false => content.to_vec(),
            true => match self.read(&names) {
                Some(bytes) => bytes,
                None => {
                    let detail = "is not embedded and not below the file's folder";
                    report.lose("texture-file", &name, detail);
                    return None;
                }
            },
        };
        let Some(mime) = mime(&bytes) else {
            let detail = "is no whole PNG or JPEG; glTF holds no other pictures";
            report.lose("texture-format", &name, detail);
            return None;
        };
        Some(Image { name, mime, bytes })
    }

    fn read(&mut self, names: &[&str]) -> Option<Vec<u8>> {
        let given = names
            .iter()
            .find_map(|name| self.origin.files.get(last_part(name)));
        if given.is_some() {
            return given.cloned();
        }
        let folder = self.origin.folder.as_deref()?;
        let candidates = names.iter().flat_map(|name| candidates(name));
        let path = candidates
            .map(|below| folder.join(below))
            .find(|path| inside(folder, path))?;
        let length = std::fs::metadata(&path).ok()?.len();
        if length > LARGEST.min(self.left) {
            return None;
        }
        self.left -= length;
        std::fs::read(path).ok()
    }
}

/// What a layered or shader texture shows first; a picture is its own.
fn picture<'t>(texture: &'t Texture, report: &mut Report) -> Option<&'t Texture> {
    match texture.type_ {
        TextureType::File => Some(texture),
        _ => {
            let name = texture.element.name.to_string();
            let first = (&texture.file_textures).into_iter().next();
            let detail = match first {
                Some(_) => "is made of several pictures; the first is taken",
                None => "is computed and no picture",
            };
            report.lose("texture-layers", &name, detail);
            first
        }
    }
}

fn last_part(name: &str) -> &str {
    name.rsplit(['/', '\\']).next().unwrap_or(name)
}

/// Where a file that the FBX file calls `name` may lie, below the FBX file's folder: as it says where
/// that leads nowhere else, and by its last part alone.
fn candidates(name: &str) -> Vec<PathBuf> {
    let mut out = Vec::new();
    let path = PathBuf::from(name.replace('\\', "/"));
    let plain = |part: Component| matches!(part, Component::Normal(_) | Component::CurDir);
    if path.components().all(plain) && !name.contains(':') {
        out.push(path);
    }
    let last = last_part(name);
    if !last.is_empty() && last != ".." && !last.contains(':') {
        out.push(PathBuf::from(last));
        out.push(Path::new("textures").join(last));
    }
    out
}

/// Links may not lead out of the folder either.
fn inside(folder: &Path, path: &Path) -> bool {
    match (folder.canonicalize(), path.canonicalize()) {
        (Ok(folder), Ok(path)) => path.starts_with(folder) && path.is_file(),
        _ => false,
    }
}

/// The kind of a picture whose header is whole.
pub(crate) fn mime(bytes: &[u8]) -> Option<&'static str> {
    if bytes.starts_with(b"\x89PNG\r\n\x1a\n") {
        let header = bytes.get(8..33)?;
        let size = |at: usize| {
            u32::from_be_bytes([header[at], header[at + 1], header[at + 2], header[at + 3]])
        };
        let whole = size(0) == 13 && &header[4..8] == b"IHDR" && size(8) > 0 && size(12) > 0;
        return (whole && bytes.windows(4).any(|w| w == b"IDAT")).then_some("image/png");
    }
    (bytes.starts_with(&[0xff, 0xd8, 0xff]) && has_jpeg_frame(bytes)).then_some("image/jpeg")
}

/// Walks the segments up to the frame header (SOF0 to SOF15), which holds the size.
fn has_jpeg_frame(bytes: &[u8]) -> bool {
    let mut at = 2;
    while let Some(&[mark, kind, high, low]) = bytes.get(at..at + 4) {
        if mark != 0xff {
            return false;
        }
        let length = usize::from(u16::from_be_bytes([high, low]));
        if matches!(kind, 0xc0..=0xcf) && !matches!(kind, 0xc4 | 0xc8 | 0xcc) {
            let size = bytes.get(at + 5..at + 9);
            return size.is_some_and(|s| (s[0] | s[1]) != 0 && (s[2] | s[3]) != 0);
        }
        at += 2 + length.max(2);
    }
    false
}

/// Offset, rotation and scale of KHR_texture_transform. The file's V grows upwards and glTF's
/// downwards; what cannot be said by the three (a shear) is left out.
fn placed(texture: &Texture) -> Option<([f32; 2], f32, [f32; 2])> {
    let m = matrix(&texture.uv_to_texture);
    let at = |u: f64, v: f64| {
        // glTF's coordinates to the file's, through its transform, and back.
        let p = m.transform_point3(glam::DVec3::new(u, 1.0 - v, 0.0));
        DVec2::new(p.x, 1.0 - p.y)
    };
    let offset = at(0.0, 0.0);
    let (x, y) = (at(1.0, 0.0) - offset, at(0.0, 1.0) - offset);
    // Columns of the extension: scale x (cos, -sin), scale y (sin, cos).
    let (scale_x, scale_y) = (x.length(), y.length());
    let flip = if x.perp_dot(y) < 0.0 { -1.0 } else { 1.0 };
    let angle = -x.to_angle();
    let sound =
        offset.is_finite() && scale_x.is_finite() && scale_y.is_finite() && angle.is_finite();
    sound.then(|| {
        (
            [finite(offset.x), finite(offset.y)],
            finite(angle),
            [finite(scale_x), finite(scale_y * flip)],
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_lead_out_of_the_folder_are_not_followed() {
        let below = |name| {
            candidates(name)
                .into_iter()
                .map(|p| p.display().to_string())
                .collect::<Vec<_>>()
        };
        assert_eq!(below("a.png"), ["a.png", "a.png", "textures/a.png"]);
        assert_eq!(
            below("tex\\a.png"),
            ["tex/a.png", "a.png", "textures/a.png"]
        );
        assert_eq!(below("../../etc/passwd"), ["passwd", "textures/passwd"]);
        assert_eq!(below("C:\\art\\a.png"), ["a.png", "textures/a.png"]);
        assert_eq!(below("/etc/passwd"), ["passwd", "textures/passwd"]);
        assert!(below("..").is_empty());
    }

    #[cfg(unix)]
    #[test]
    fn links_that_lead_out_of_the_folder_are_not_followed() {
        let base = std::env::temp_dir().join(format!("dolomite_fbx_links_{}", std::process::id()));
        let folder = base.join("inside");
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(base.join("secret.png"), "x").unwrap();
        std::fs::write(folder.join("own.png"), "x").unwrap();
        std::os::unix::fs::symlink(base.join("secret.png"), folder.join("link.png")).unwrap();
        assert!(inside(&folder, &folder.join("own.png")));
        assert!(!inside(&folder, &folder.join("link.png")));
        std::fs::remove_dir_all(base).unwrap();
    }

    #[test]
    fn broken_pictures_are_told_apart() {
        assert_eq!(mime(b"\x89PNG\r\n\x1a\n"), None);
        assert_eq!(mime(b"BM"), None);
        assert_eq!(mime(b""), None);
        assert_eq!(mime(&[0xff, 0xd8, 0xff, 0xe0, 0, 2]), None);
        let jpeg = [
            0xff, 0xd8, 0xff, 0xe0, 0, 2, 0xff, 0xc0, 0, 11, 8, 0, 1, 0, 1, 0,
        ];
        assert_eq!(mime(&jpeg), Some("image/jpeg"));
    }
}
