//! `dolomite_lab tables`: makes `docs/measured/TOPIC.md` of each `docs/measured/data/TOPIC.json`.

use crate::measured::{Topic, TopicError};
use clap::Parser;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Makes the measured tables of their JSON files.
#[derive(Debug, Parser)]
#[command(name = "dolomite_lab tables")]
pub struct Arguments {
    /// Changes nothing; fails if a page is not what its file says
    #[arg(long)]
    pub check: bool,
    /// The folder of the pages; their files lie in `data` below it
    #[arg(long, default_value = "docs/measured")]
    pub folder: PathBuf,
}

/// Why tables were not made, or are not right.
#[derive(Debug, Error)]
pub enum TablesError {
    /// A file is no table, or cannot be read or written.
    #[error(transparent)]
    Topic(#[from] TopicError),
    /// Pages are not what their files say.
    #[error("not as their data say; run `dolomite_lab tables`: {}", .0.join(", "))]
    Stale(Vec<String>),
}

/// How each page begins that was made here.
const MARK: &str = "<!-- Written by `dolomite_lab tables`";

/// Makes or checks the pages; gives the names of those that were written.
///
/// # Errors
/// [`TablesError`].
pub fn run(arguments: &Arguments) -> Result<Vec<String>, TablesError> {
    let pages = pages(&arguments.folder)?;
    let mut changed = Vec::new();
    for (name, page) in &pages {
        let path = arguments.folder.join(name);
        if std::fs::read_to_string(&path).is_ok_and(|old| old == *page) {
            continue;
        }
        changed.push(name.clone());
        if !arguments.check {
            std::fs::write(&path, page).map_err(|source| TopicError::File { path, source })?;
        }
    }
    // Pages whose data are gone.
    for (name, path) in files(&arguments.folder, "md")? {
        let made_here = std::fs::read_to_string(&path).is_ok_and(|text| text.starts_with(MARK));
        if made_here && !pages.contains_key(&name) {
            changed.push(name);
            if !arguments.check {
                std::fs::remove_file(&path).map_err(|source| TopicError::File { path, source })?;
            }
        }
    }
    if arguments.check && !changed.is_empty() {
        return Err(TablesError::Stale(changed));
    }
    Ok(changed)
}

/// Name and text of every page.
fn pages(folder: &Path) -> Result<BTreeMap<String, String>, TopicError> {
    let mut pages = BTreeMap::new();
    for (name, path) in files(&folder.join("data"), "json")? {
        let topic = Topic::read(&path)?;
        let page = format!("{}.md", name.trim_end_matches(".json"));
        pages.insert(page, topic.to_markdown(&name));
    }
    Ok(pages)
}

/// Names and paths of the files with an ending; none in a folder that is not there.
fn files(folder: &Path, ending: &str) -> Result<BTreeMap<String, PathBuf>, TopicError> {
    let fault = |source| TopicError::File {
        path: folder.to_owned(),
        source,
    };
    let entries = match std::fs::read_dir(folder) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(BTreeMap::new()),
        entries => entries.map_err(fault)?,
    };
    let mut found = BTreeMap::new();
    for entry in entries {
        let path = entry.map_err(fault)?.path();
        if path.extension().is_some_and(|is| is == ending)
            && let Some(name) = path.file_name().and_then(|name| name.to_str())
        {
            found.insert(name.to_owned(), path);
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    const DATA: &str = r#"{"topic": "T", "device": "d", "date": "2026-01-31", "rows": []}"#;

    #[test]
    fn a_page_is_written_once_and_what_is_stale_is_found() {
        let folder = std::env::temp_dir().join(format!("dolomite_tables_{}", std::process::id()));
        std::fs::create_dir_all(folder.join("data")).unwrap();
        std::fs::write(folder.join("README.md"), "by hand").unwrap();
        std::fs::write(folder.join("data/t.json"), DATA).unwrap();
        let tables = |check| {
            run(&Arguments {
                check,
                folder: folder.clone(),
            })
        };
        assert!(tables(true).unwrap_err().to_string().contains("t.md"));
        assert_eq!(tables(false).unwrap(), ["t.md"]);
        assert!(tables(true).unwrap().is_empty() && tables(false).unwrap().is_empty());
        std::fs::write(folder.join("t.md"), "changed").unwrap();
        assert!(matches!(tables(true), Err(TablesError::Stale(pages)) if pages == ["t.md"]));
        tables(false).unwrap();
        // Without its data a page is stale, and goes.
        std::fs::remove_file(folder.join("data/t.json")).unwrap();
        assert!(tables(true).is_err());
        tables(false).unwrap();
        assert!(!folder.join("t.md").exists() && folder.join("README.md").exists());
        std::fs::remove_dir_all(folder).unwrap();
    }

    #[test]
    fn the_pages_of_this_checkout_are_what_their_data_say() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/measured");
        let arguments = Arguments {
            check: true,
            folder,
        };
        run(&arguments).unwrap_or_else(|error| panic!("{error}"));
    }
}
