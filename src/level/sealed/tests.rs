//! Files are whole or refused, and nothing is lost by a write.

use super::*;

const KIND: Kind = Kind {
    letters: b"TEST",
    name: "test",
    version: 3,
};

fn folder(name: &str) -> PathBuf {
    let name = format!("dolomite-sealed-{name}-{}", std::process::id());
    let folder = std::env::temp_dir().join(name);
    fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn the_checksum_is_the_one_of_the_standard() {
    assert_eq!(crc32(&[b"1234", b"56789"]), 0xcbf4_3926);
}

#[test]
fn cut_at_any_byte_and_changed_in_any_byte_it_is_refused() {
    let content: Vec<u8> = (0..700_u32).map(|i| (i * 31 % 251) as u8).collect();
    let whole = seal(KIND, &content);
    let path = Path::new("a.save");
    assert_eq!(open(KIND, &whole, path).unwrap(), content);
    for cut in 0..whole.len() {
        let error = open(KIND, &whole[..cut], path).unwrap_err();
        assert!(
            matches!(error, SealedError::Length { .. }),
            "{cut}: {error}"
        );
    }
    let mut longer = whole.clone();
    longer.push(0);
    assert!(open(KIND, &longer, path).is_err());
    for at in 0..whole.len() {
        for bit in 0..8 {
            let mut changed = whole.clone();
            changed[at] ^= 1 << bit;
            assert!(open(KIND, &changed, path).is_err(), "byte {at}, bit {bit}");
        }
    }
    let other = Kind { version: 4, ..KIND };
    let error = open(other, &whole, path).unwrap_err().to_string();
    assert!(
        error.contains("version 3") && error.contains("a.save"),
        "{error}"
    );
}

#[test]
fn whenever_the_machine_stops_the_last_whole_file_is_read() {
    let folder = folder("stop");
    let path = folder.join("game.save");
    write(KIND, &path, b"first").unwrap();
    let second = seal(KIND, b"second, and longer");
    for cut in 0..=second.len() {
        // It stopped while the next was written beside.
        fs::write(unfinished(&path), &second[..cut]).unwrap();
        let (content, error) = read_last(KIND, &path).unwrap();
        assert!(content == b"first" && error.is_none(), "{cut}");
    }
    // It stopped between the two names.
    fs::rename(&path, before(&path)).unwrap();
    let (content, error) = read_last(KIND, &path).unwrap();
    assert!(content == b"first" && error.is_some());
    // The disk lost the end of what had its name: the one before stands, and is not lost by the next write.
    for cut in 0..second.len() {
        fs::write(&path, &second[..cut]).unwrap();
        let (content, error) = read_last(KIND, &path).unwrap();
        assert_eq!(content, b"first", "{cut}");
        assert!(matches!(error, Some(SealedError::Length { .. })), "{cut}");
    }
    write(KIND, &path, b"third").unwrap();
    assert_eq!(read(KIND, &before(&path)).unwrap(), b"first");
    write(KIND, &path, b"fourth").unwrap();
    assert_eq!(read(KIND, &before(&path)).unwrap(), b"third");
    assert_eq!(read(KIND, &path).unwrap(), b"fourth");
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_file_of_another_version_is_set_aside_and_read_whole_by_that() {
    let folder = folder("version");
    let path = folder.join("game.save");
    let later = Kind { version: 9, ..KIND };
    write(later, &path, b"before").unwrap();
    write(later, &path, b"newest").unwrap();
    for content in [b"one", b"two", b"six"] {
        write(KIND, &path, content).unwrap();
    }
    assert_eq!(read(KIND, &path).unwrap(), b"six");
    assert_eq!(read(KIND, &before(&path)).unwrap(), b"two");
    let kept = |name: &str| read(later, &folder.join(name)).unwrap();
    assert_eq!(kept("game.save.version-9.0"), b"newest");
    assert_eq!(kept("game.save.before.version-9.0"), b"before");
    write(later, &path, b"again").unwrap();
    write(KIND, &path, b"ten").unwrap();
    assert_eq!(kept("game.save.version-9.0"), b"newest");
    assert_eq!(kept("game.save.version-9.1"), b"again");
    let old = read(KIND, &folder.join("game.save.version-3.0"));
    assert_eq!(old.unwrap(), b"six");
    fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn what_is_no_file_of_ours_is_set_aside_however_short() {
    let folder = folder("kind");
    let path = folder.join("notes.txt");
    for (n, text) in [
        "buy bread",
        "a letter of more than twenty-eight bytes, and then some",
    ]
    .into_iter()
    .enumerate()
    {
        fs::write(&path, text).unwrap();
        write(KIND, &path, b"game").unwrap();
        let kept = folder.join(format!("notes.txt.other.{n}"));
        assert_eq!(fs::read_to_string(kept).unwrap(), text);
        assert_eq!(read(KIND, &path).unwrap(), b"game");
    }
    // A folder stays where it is, and nothing is written.
    let path = folder.join("folder");
    fs::create_dir(&path).unwrap();
    assert!(write(KIND, &path, b"game").is_err() && path.is_dir());
    fs::remove_dir_all(&folder).unwrap();
}

#[cfg(unix)]
#[test]
fn what_cannot_be_read_is_set_aside() {
    let folder = folder("unread");
    let path = folder.join("game.save");
    // A name that leads to itself: nobody can say what is there.
    std::os::unix::fs::symlink(&path, &path).unwrap();
    assert!(matches!(read(KIND, &path), Err(SealedError::Read { .. })));
    write(KIND, &path, b"game").unwrap();
    assert_eq!(read(KIND, &path).unwrap(), b"game");
    assert!(fs::symlink_metadata(folder.join("game.save.unread.0")).is_ok());
    // Nor is what is too large to be ours written over. It has a length, and no bytes.
    File::create(&path).unwrap().set_len(MOST + 1).unwrap();
    write(KIND, &path, b"game").unwrap();
    let kept = fs::metadata(folder.join("game.save.other.0")).unwrap();
    assert_eq!(kept.len(), MOST + 1);
    fs::remove_dir_all(&folder).unwrap();
}
