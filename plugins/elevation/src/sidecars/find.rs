//! Which files stand beside a map, by their names: in its own folder, in any letter case.

use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};

/// Files that there are.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Found {
    /// `NAME.EXT.aux.xml`, GDAL's own.
    pub pam: Option<PathBuf>,
    /// `NAME.EXT.msk`, where there is data.
    pub mask: Option<PathBuf>,
    /// `NAME.prj`, the coordinate system.
    pub prj: Option<PathBuf>,
    /// A world file, the place.
    pub world: Option<PathBuf>,
}

/// A file that is looked for: what its name begins with, to the letter, and how it may end, in any case.
struct Wanted<'a> {
    begin: &'a OsStr,
    /// Small letters; the first that is there counts.
    endings: Vec<String>,
    /// The best so far: which ending, whether its case is another, its name.
    best: Option<(usize, bool, OsString)>,
}

impl Wanted<'_> {
    fn look_at(&mut self, name: &OsStr, path: &Path) {
        let bytes = name.as_encoded_bytes();
        let Some(ending) = bytes.strip_prefix(self.begin.as_encoded_bytes()) else {
            return;
        };
        let is = |wanted: &String| ending.eq_ignore_ascii_case(wanted.as_bytes());
        let Some(place) = self.endings.iter().position(is) else {
            return;
        };
        let other_case = ending != self.endings[place].as_bytes();
        let one = (place, other_case, name.to_owned());
        // A folder of that name is nothing, and neither is a pipe.
        if self.best.as_ref().is_none_or(|best| one < *best) && path.with_file_name(name).is_file()
        {
            self.best = Some(one);
        }
    }
}

/// Endings of a world file: the first and the last letter of the map's own and a `w`, all of it and a `w`, `.wld`.
fn world_endings(own: &str) -> Vec<String> {
    let own = own.to_ascii_lowercase();
    let mut endings = Vec::new();
    let letters: Vec<char> = own.chars().collect();
    if let [first, _, .., last] = letters[..] {
        endings.push(format!(".{first}{last}w"));
        endings.push(format!(".{own}w"));
    }
    // Another map is no world file: what `.rxa` and `.ra` would make.
    endings.retain(|ending| ending != ".raw");
    endings.push(".wld".to_owned());
    endings
}

/// Looks through the map's folder.
pub(super) fn find(path: &Path) -> Found {
    let (Some(name), Some(stem)) = (path.file_name(), path.file_stem()) else {
        return Found::default();
    };
    let own = path.extension().unwrap_or_default().to_string_lossy();
    let mut wanted = [
        (name, vec![".aux.xml".to_owned()]),
        (name, vec![".msk".to_owned()]),
        (stem, vec![".prj".to_owned()]),
        (stem, world_endings(&own)),
    ]
    .map(|(begin, endings)| Wanted {
        begin,
        endings,
        best: None,
    });
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    match std::fs::read_dir(folder.unwrap_or(Path::new("."))) {
        Ok(entries) => {
            for entry in entries.flatten() {
                let other = entry.file_name();
                wanted
                    .iter_mut()
                    .for_each(|wanted| wanted.look_at(&other, path));
            }
        }
        // A folder that may be gone through and not be listed: by the names that most have.
        Err(_) => {
            for wanted in &mut wanted {
                for ending in wanted.endings.clone() {
                    for ending in [ending.to_ascii_uppercase(), ending] {
                        let mut other = wanted.begin.to_owned();
                        other.push(ending);
                        wanted.look_at(&other, path);
                    }
                }
            }
        }
    }
    let [pam, mask, prj, world] = wanted.map(|wanted| {
        let (.., name) = wanted.best?;
        Some(path.with_file_name(name))
    });
    Found {
        pam,
        mask,
        prj,
        world,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings_of_world_files() {
        for (own, wanted) in [
            ("tif", &[".tfw", ".tifw", ".wld"][..]),
            ("TIFF", &[".tfw", ".tiffw", ".wld"]),
            ("png", &[".pgw", ".pngw", ".wld"]),
            ("jpg", &[".jgw", ".jpgw", ".wld"]),
            ("r16", &[".r6w", ".r16w", ".wld"]),
            ("raw", &[".rww", ".raww", ".wld"]),
            // What is a map itself is none.
            ("rea", &[".reaw", ".wld"]),
            ("ra", &[".wld"]),
            ("a", &[".wld"]),
            ("", &[".wld"]),
        ] {
            assert_eq!(world_endings(own), wanted, "{own}");
        }
    }

    #[test]
    fn names_count_in_any_case_and_files_alone() {
        let folder = format!("dolomite-find-{}", std::process::id());
        let folder = std::env::temp_dir().join(folder);
        std::fs::create_dir_all(folder.join("a.tif.msk")).expect("a folder");
        let map = folder.join("a.tif");
        assert_eq!(find(&map), Found::default(), "a folder is no mask");
        for name in [
            "b.tfw",
            "aa.tfw",
            "a.tif.aux.xml.bak",
            "xa.tif.aux.xml",
            "a.tf",
        ] {
            std::fs::write(folder.join(name), "").expect("room");
        }
        assert_eq!(find(&map), Found::default(), "of other maps");
        let world = |name: &str| {
            std::fs::write(folder.join(name), "").expect("room");
            find(&map).world
        };
        // The first ending goes before the case, its own case before another.
        for name in ["a.WLD", "a.wld", "a.TifW", "a.TFW", "a.tfw"] {
            let found = world(name).expect("just made");
            // Where names differ in no case it is the file of the first name.
            let same = found.file_name().expect("a name").to_string_lossy();
            assert!(same.eq_ignore_ascii_case(name), "{same} {name}");
        }
        for name in ["a.Prj", "a.tif.AUX.xml"] {
            std::fs::write(folder.join(name), "").expect("room");
        }
        let found = find(&map);
        assert_eq!(found.prj, Some(folder.join("a.Prj")));
        assert_eq!(found.pam, Some(folder.join("a.tif.AUX.xml")));
        std::fs::remove_dir_all(&folder).expect("it is ours");
    }
}
