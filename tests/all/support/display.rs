//! A display of its own for a test (Xvfb), what is on it, and a hand at its keyboard (xdotool).

use std::io::{BufRead, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use image::RgbImage;
use x11rb::protocol::xproto::{ClientMessageEvent, ConnectionExt, EventMask};
use x11rb::rust_connection::RustConnection;

/// A display that nobody sees; ends with this value.
pub struct Display {
    server: Child,
    name: String,
    folder: PathBuf,
}

impl Display {
    /// Opens one of `width` × `height` pixels. `None`, after a line that says so, without Xvfb or xdotool
    /// (Debian: `apt install xvfb xdotool`); in CI that fails.
    pub fn open(name: &str, width: u32, height: u32) -> Option<Self> {
        for program in ["Xvfb", "xdotool"] {
            let there = Command::new(program)
                .arg("-help")
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .status();
            if let Err(error) = there {
                let line = format!("{program} (packages xvfb, xdotool): {error}");
                assert!(std::env::var_os("CI").is_none(), "CI must not skip: {line}");
                eprintln!("skipped: {line}");
                return None;
            }
        }
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("display-{name}"));
        std::fs::create_dir_all(&folder).expect("the test's folder can be written");
        let mut server = Command::new("Xvfb")
            // It finds a free number and says which, once it listens.
            .args(["-displayfd", "1", "-nolisten", "tcp", "-noreset"])
            .args(["-screen", "0", &format!("{width}x{height}x24"), "-fbdir"])
            .arg(&folder)
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .expect("it was there just now");
        let mut number = String::new();
        let said = server.stdout.take().expect("piped");
        BufReader::new(said)
            .read_line(&mut number)
            .expect("Xvfb says its number");
        let number = number.trim();
        assert!(!number.is_empty(), "Xvfb did not start");
        Some(Self {
            server,
            name: format!(":{number}"),
            folder,
        })
    }

    /// `DISPLAY` of who draws on it.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// What is on it.
    pub fn picture(&self) -> RgbImage {
        let file = self.folder.join("Xvfb_screen0");
        let bytes = std::fs::read(&file).unwrap_or_else(|e| panic!("{}: {e}", file.display()));
        // The X window dump: a header of big-endian numbers (X11/XWDFile.h), colours of 12 bytes, pixels.
        let number = |index: usize| {
            let at = 4 * index;
            u32::from_be_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]])
        };
        let (header, width, height) = (number(0), number(4), number(5));
        let (bits, row, colours) = (number(11), number(12), number(19));
        assert_eq!((number(1), bits), (7, 32), "a dump of 32-bit pixels");
        let little = number(7) == 0;
        let start = (header + 12 * colours) as usize;
        RgbImage::from_fn(width, height, |x, y| {
            let at = start + (y * row + 4 * x) as usize;
            let pixel = &bytes[at..at + 4];
            image::Rgb(if little {
                [pixel[2], pixel[1], pixel[0]]
            } else {
                [pixel[1], pixel[2], pixel[3]]
            })
        })
    }

    /// Lets xdotool do something; what it said, or `None` where it failed.
    pub fn hand(&self, arguments: &[&str]) -> Option<String> {
        let done = Command::new("xdotool")
            .args(arguments)
            .env("DISPLAY", &self.name)
            .output()
            .expect("it was there just now");
        done.status
            .success()
            .then(|| String::from_utf8_lossy(&done.stdout).trim().to_owned())
    }

    /// Asks a window to close, as a window manager does whose button is pressed; the xdotool of Debian 12 cannot.
    pub fn close(&self, window: &str) {
        let window = window.parse().expect("xdotool names windows by number");
        let ask = || -> Result<(), Box<dyn std::error::Error>> {
            let (connection, _) = RustConnection::connect(Some(&self.name))?;
            let atom = |name| connection.intern_atom(false, name);
            let protocols = atom(b"WM_PROTOCOLS")?.reply()?.atom;
            let delete = atom(b"WM_DELETE_WINDOW")?.reply()?.atom;
            let message = [delete, x11rb::CURRENT_TIME, 0, 0, 0];
            let event = ClientMessageEvent::new(32, window, protocols, message);
            connection
                .send_event(false, window, EventMask::NO_EVENT, event)?
                .check()?;
            Ok(())
        };
        ask().unwrap_or_else(|error| panic!("window {window}: {error}"));
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        // It may have ended by itself.
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}
