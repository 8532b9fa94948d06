//! Where pictures that are not embedded lie. Nothing outside of the folders that were given is opened
//! or listed: every path is resolved, links and all, before it is looked into.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Component, Path, PathBuf};

/// Folders beside the file that exporters put pictures into, in any case; `NAME.fbm` is looked into
/// before them.
const FOLDERS: [&str; 2] = ["textures", "texture"];

/// Entries of folders that are listed for one FBX file at most.
const ENTRIES: usize = 100_000;
/// Folders below a given one that are looked into.
const DEPTH: usize = 16;
/// Parts at the end of a stated path that are tried below a folder.
const PARTS: usize = 8;

/// Looks for files by the paths that an FBX file states.
pub(crate) struct Finder {
    /// Resolved, the FBX file's own folder first if there is one.
    roots: Vec<PathBuf>,
    /// The first root is the FBX file's own folder.
    has_own: bool,
    /// Name of the FBX file without its ending.
    stem: String,
    listed: BTreeMap<PathBuf, BTreeMap<String, String>>,
    entries: usize,
    /// What lies anywhere below the folders that were given beside the file's own, by name in lower
    /// case, the uppermost first.
    below: Option<BTreeMap<String, Vec<PathBuf>>>,
}

/// A file that was found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Found {
    pub(crate) path: PathBuf,
    /// How many others may be meant as well.
    pub(crate) others: usize,
}

impl From<PathBuf> for Found {
    fn from(path: PathBuf) -> Self {
        Self { path, others: 0 }
    }
}

impl Finder {
    /// For the FBX file `name`, which lies in the folder `own`; `given` are folders to look into beside.
    pub(crate) fn new(name: &str, own: Option<&Path>, given: &[PathBuf]) -> Self {
        let own = own.and_then(|folder| folder.canonicalize().ok());
        let given = given.iter().filter_map(|folder| folder.canonicalize().ok());
        let last = last_part(name);
        Self {
            has_own: own.is_some(),
            roots: own.into_iter().chain(given).collect(),
            stem: last
                .rsplit_once('.')
                .map_or(last, |(stem, _)| stem)
                .to_owned(),
            listed: BTreeMap::new(),
            entries: 0,
            below: None,
        }
    }

    /// The first file that lies where one of `names` says, or where such files are put. It is inside of
    /// the folders, with all links followed.
    pub(crate) fn find(&mut self, names: &[&str]) -> Option<Found> {
        if let Some(found) = names.iter().find_map(|name| self.stated(name)) {
            return Some(found.into());
        }
        let own = usize::from(self.has_own);
        // What lies in a given folder by its name alone: one below may lie as the file says.
        let mut by_name = None;
        for name in names {
            let parts = parts(name);
            let after = parts.iter().rposition(|part| *part == "..");
            let tail = &parts[after.map_or(0, |at| at + 1)..];
            let tail = &tail[tail.len().saturating_sub(PARTS)..];
            for (number, root) in self.roots.clone().iter().enumerate() {
                let mut ends = (0..tail.len()).map(|from| &tail[from..]);
                let found = ends.find_map(|end| Some((self.walk(root, end)?, end.len())));
                match found {
                    Some((path, 1)) if number >= own => by_name = by_name.or(Some(path)),
                    Some((path, _)) => return Some(path.into()),
                    None => {}
                }
            }
        }
        if by_name.is_none() {
            let (path, number) = self.in_folders(names).unzip();
            if number.is_some_and(|number| number < own) {
                return path.map(Found::from);
            }
            by_name = path;
        }
        let lower: Vec<String> = names.iter().map(|name| name.to_lowercase()).collect();
        let stated: Vec<Vec<&str>> = lower.iter().map(|name| parts(name)).collect();
        // Nothing lies more like a name of one part than what was found by it.
        if by_name.is_some() && stated.iter().all(|parts| parts.len() < 2) {
            return by_name.map(Found::from);
        }
        let below = self.below();
        let of = |said: &Vec<&str>| below.get(*said.last()?);
        let files = stated.iter().find_map(of);
        let likeliest = files.and_then(|files| likeliest(files, &stated));
        match (by_name, likeliest) {
            (Some(path), Some((_, like))) if like < 2 => Some(path.into()),
            (_, Some((found, _))) => Some(found),
            (path, None) => path.map(Found::from),
        }
    }

    /// In folders that pictures are put into, and in which root these are.
    fn in_folders(&mut self, names: &[&str]) -> Option<(PathBuf, usize)> {
        let media = format!("{}.fbm", self.stem);
        let folders = [&*media].into_iter().chain(FOLDERS);
        let folders: Vec<&str> = folders.collect();
        for name in names {
            let last = last_part(name);
            for (number, root) in self.roots.clone().iter().enumerate() {
                let found = folders.iter().find_map(|f| self.walk(root, &[f, last]));
                if let Some(found) = found {
                    return Some((found, number));
                }
            }
        }
        None
    }

    /// Says where was looked.
    pub(crate) fn places(&self) -> String {
        let mut all: Vec<String> = Vec::new();
        if self.has_own {
            let stem = &self.stem;
            all.push(format!(
                "in the file's folder, in {stem}.fbm, Textures and Texture there"
            ));
        }
        let given = &self.roots[usize::from(self.has_own)..];
        all.extend(given.iter().map(|root| format!("below {}", root.display())));
        let cut = match self.entries >= ENTRIES {
            true => format!(", in {ENTRIES} entries at most"),
            false => String::new(),
        };
        match all.is_empty() {
            true => "no folder to look in was given".to_owned(),
            false => format!("looked for {}{cut}", all.join(" and ")),
        }
    }

    /// Exactly as stated: from the FBX file's folder, or absolute, if that is inside of a folder.
    fn stated(&mut self, name: &str) -> Option<PathBuf> {
        let own = self.roots.first().filter(|_| self.has_own);
        let plain = PathBuf::from(name.replace('\\', "/"));
        let whole = match plain.is_absolute() {
            true => plain,
            false if is_rooted(name) => return None,
            false => own?.join(plain),
        };
        let whole = without_dots(&whole)?;
        for root in self.roots.clone() {
            if let Ok(rest) = whole.strip_prefix(&root) {
                let rest: Option<Vec<&str>> = rest.iter().map(|part| part.to_str()).collect();
                if let Some(found) = self.walk(&root, &rest?) {
                    return Some(found);
                }
            }
        }
        None
    }

    /// Goes down from `root`, each step in whatever case it is written in.
    fn walk(&mut self, root: &Path, parts: &[&str]) -> Option<PathBuf> {
        let mut at = root.to_owned();
        for part in parts {
            let step = self.entry(&at, part)?;
            at = self.inside(&at.join(step))?;
        }
        (!parts.is_empty() && at.is_file()).then_some(at)
    }

    /// `path` with links followed, if it is inside of the folders.
    fn inside(&self, path: &Path) -> Option<PathBuf> {
        let real = path.canonicalize().ok()?;
        let within = self.roots.iter().any(|root| real.starts_with(root));
        within.then_some(real)
    }

    /// The name of an entry of `folder`, which is resolved and inside.
    fn entry(&mut self, folder: &Path, name: &str) -> Option<String> {
        if name.is_empty() || name == ".." || name.contains(['/', '\\', ':', '\0']) {
            return None;
        }
        if std::fs::symlink_metadata(folder.join(name)).is_ok() {
            return Some(name.to_owned());
        }
        self.list(folder).get(&name.to_lowercase()).cloned()
    }

    /// Names in a folder by what they are in lower case; each folder is listed once.
    fn list(&mut self, folder: &Path) -> &BTreeMap<String, String> {
        if !self.listed.contains_key(folder) {
            let left = ENTRIES.saturating_sub(self.entries);
            let entries = std::fs::read_dir(folder).into_iter().flatten();
            let entries = entries.take(left).flatten();
            let names = entries.filter_map(|entry| entry.file_name().into_string().ok());
            let mut names: Vec<String> = names.collect();
            self.entries += names.len();
            // Of several the first in order, wherever the system lists it.
            names.sort_unstable_by(|a, b| b.cmp(a));
            let names = names.into_iter().map(|name| (name.to_lowercase(), name));
            self.listed.insert(folder.to_owned(), names.collect());
        }
        self.listed.entry(folder.to_owned()).or_default()
    }

    fn below(&mut self) -> &BTreeMap<String, Vec<PathBuf>> {
        if self.below.is_none() {
            let mut found = BTreeMap::new();
            let given = self.roots[usize::from(self.has_own)..].to_vec();
            for root in given {
                let mut level = vec![root];
                for _ in 0..DEPTH {
                    level = level
                        .into_iter()
                        .flat_map(|folder| self.files(&folder, &mut found))
                        .collect();
                }
            }
            self.below = Some(found);
        }
        self.below.get_or_insert_default()
    }

    /// Puts the files of a folder into `found` and gives the folders below it; not those behind links, which
    /// may lead in circles.
    fn files(&mut self, folder: &Path, found: &mut BTreeMap<String, Vec<PathBuf>>) -> Vec<PathBuf> {
        let mut folders = Vec::new();
        for (lower, name) in self.list(folder).clone() {
            let path = folder.join(name);
            let Ok(about) = std::fs::symlink_metadata(&path) else {
                continue;
            };
            if about.is_dir() {
                folders.push(path);
                continue;
            }
            let file = match about.is_symlink() {
                // What is no link in a folder that is inside is inside.
                false => about.is_file().then_some(path),
                true => self.inside(&path).filter(|real| real.is_file()),
            };
            if let Some(file) = file {
                found.entry(lower).or_default().push(file);
            }
        }
        folders
    }
}

/// Of files of one name that whose path ends most like one of those that are stated, in lower case, and how
/// many parts of it do; the first of several.
fn likeliest(files: &[PathBuf], stated: &[Vec<&str>]) -> Option<(Found, usize)> {
    let like = |path: &PathBuf| {
        let own = path.iter().rev().map(|part| part.to_string_lossy());
        let own: Vec<String> = own.map(|part| part.to_lowercase()).collect();
        let of = |said: &Vec<&str>| {
            let pairs = own.iter().zip(said.iter().rev());
            pairs.take_while(|(own, said)| own == *said).count()
        };
        stated.iter().map(of).max().unwrap_or(0)
    };
    let likes: Vec<usize> = files.iter().map(like).collect();
    let most = likes.iter().copied().max()?;
    let mut likely = files.iter().zip(&likes).filter(|(_, like)| **like == most);
    let (first, _) = likely.next()?;
    // Two links may lead to one file, and one folder may be given twice.
    let others: BTreeSet<&PathBuf> = likely.map(|(path, _)| path).collect();
    let found = Found {
        path: first.clone(),
        others: others.len() - usize::from(others.contains(first)),
    };
    Some((found, most))
}

/// The part after the last separator of either kind.
pub(crate) fn last_part(name: &str) -> &str {
    name.rsplit(['/', '\\']).next().unwrap_or(name)
}

/// The parts of a path of any system, without drives.
fn parts(name: &str) -> Vec<&str> {
    let parts = name.split(['/', '\\']);
    parts
        .filter(|part| !part.is_empty() && *part != "." && !part.contains(':'))
        .collect()
}

/// Absolute on some system.
fn is_rooted(name: &str) -> bool {
    name.starts_with(['/', '\\']) || name.contains(':')
}

/// A path with its `..` taken out; `None` where they lead above the top.
fn without_dots(path: &Path) -> Option<PathBuf> {
    let mut out = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => out.pop().then_some(())?,
            Component::CurDir => {}
            other => out.push(other),
        }
    }
    Some(out)
}

#[cfg(test)]
mod tests;
