//! A system made of a folder: the only one on `PATH`, with links to the real tools that a script needs and
//! scripts of our own in place of those that would look at, or change, the machine.

use std::collections::BTreeSet;
use std::fs;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicU32, Ordering};

/// What a script may take from the real machine: nothing of these knows a package.
const TOOLS: [&str; 12] = [
    "bash", "env", "sed", "sort", "tr", "cat", "head", "dirname", "mktemp", "grep", "rm", "nproc",
];

/// Answers like Debian's: prints those names that stand in the file `known`; 1 when it does not know one.
const DPKG_QUERY: &str = r#"
code=0
for name in "${@:4}"; do
  if grep -qx -- "$name" "$SYSTEM/known"; then echo "ii $name"
  else echo "dpkg-query: no packages found matching $name" >&2; code=1; fi
done
exit $code"#;

/// What `apt-get` does; each call is written to `calls`.
#[derive(Clone, Copy)]
pub enum Apt {
    /// Installs what it is asked for.
    Works,
    /// Finds no package before `apt-get update` has been run.
    NeedsUpdate,
    /// Never installs anything.
    Fails,
    /// Says that it installed everything, and did not.
    Lies,
}

/// What a run of a script said and how it ended.
#[derive(Debug)]
pub struct Said {
    /// Exit code; -1 where a signal ended it.
    pub code: i32,
    /// Standard output and standard error.
    pub text: String,
    /// What `apt-get` was asked, one call a line.
    pub calls: String,
}

impl Said {
    /// The line that holds `part`.
    pub fn line(&self, part: &str) -> &str {
        self.text
            .lines()
            .find(|line| line.contains(part))
            .unwrap_or_else(|| panic!("no line with {part:?} in {self:#?}"))
    }

    /// The words of the line that holds `part`, from the first word after it.
    pub fn words(&self, part: &str) -> BTreeSet<&str> {
        let line = self.line(part);
        let from = line.find(part).unwrap_or(0) + part.len();
        line[from..].split_whitespace().collect()
    }
}

/// See the top of the file. Its folder goes when it does.
pub struct System(PathBuf);

impl Drop for System {
    fn drop(&mut self) {
        // A folder left in the system's place for such costs nobody anything.
        let _ = fs::remove_dir_all(&self.0);
    }
}

impl System {
    /// Root on a Linux that has a compiler, pkg-config and certificates, and no package manager at all.
    pub fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let name = format!(
            "dolomite-scripts-{}-{}",
            std::process::id(),
            COUNT.fetch_add(1, Ordering::Relaxed)
        );
        let folder = std::env::temp_dir().join(name);
        fs::create_dir_all(folder.join("bin")).expect("a temporary folder can be made");
        fs::write(folder.join("known"), "").expect("the system's folder can be written");
        fs::write(folder.join("calls"), "").expect("the system's folder can be written");
        let system = Self(folder);
        for tool in TOOLS {
            system.tool(tool);
        }
        for compiler in ["cc", "c++", "pkg-config"] {
            system.command(compiler, "exit 0");
        }
        system.command("id", "echo 0");
        system.command("uname", "echo Linux");
        system
    }

    /// A command of that name; `body` is Bash, in which `$SYSTEM` is this system's folder.
    pub fn command(&self, name: &str, body: &str) {
        let at = self.0.join("bin").join(name);
        fs::write(&at, format!("#!/usr/bin/env bash\n{body}\n"))
            .expect("the system's folder can be written");
        fs::set_permissions(&at, fs::Permissions::from_mode(0o755))
            .expect("the system's folder can be written");
    }

    /// A link to a real tool beside those that each system has.
    pub fn tool(&self, name: &str) {
        let path = std::env::var_os("PATH").expect("tests run with a PATH");
        let real = std::env::split_paths(&path)
            .map(|at| at.join(name))
            .find(|at| at.is_file())
            .unwrap_or_else(|| panic!("{name} is not on PATH"));
        symlink(real, self.0.join("bin").join(name)).expect("the system's folder can be written");
    }

    /// Takes a command away.
    pub fn without(&self, name: &str) {
        fs::remove_file(self.0.join("bin").join(name)).expect("a command that is there can go");
    }

    /// Makes it a Debian that knows these packages.
    pub fn debian(&self, known: &[&str], apt: Apt) {
        fs::write(self.0.join("known"), known.join("\n") + "\n")
            .expect("the system's folder can be written");
        self.command("dpkg-query", DPKG_QUERY);
        let install = match apt {
            Apt::Works => "",
            Apt::NeedsUpdate => {
                "[[ -e $SYSTEM/updated ]] || { echo 'E: no such package' >&2; exit 100; }"
            }
            Apt::Fails => "echo 'E: no such package' >&2; exit 100",
            Apt::Lies => "exit 0",
        };
        self.command(
            "apt-get",
            &format!(
                "echo \"$*\" >>\"$SYSTEM/calls\"\n\
                 case $1 in\n\
                 update) : >\"$SYSTEM/updated\" ;;\n\
                 install) {install}\n\
                   for name in \"$@\"; do echo \"$name\" >>\"$SYSTEM/known\"; done ;;\n\
                 esac"
            ),
        );
    }

    /// Runs `need_system LIST` as the scripts do, errors and all.
    pub fn need(&self, list: &str) -> Said {
        self.run(&format!("need_system {list}; echo went on"))
    }

    /// Runs some Bash after `scripts/lib/system.sh`; another file can be named by `DOLOMITE_SYSTEM_SH` (that is
    /// how these tests were seen to fail on the script they were written against).
    pub fn run(&self, script: &str) -> Said {
        let library = std::env::var_os("DOLOMITE_SYSTEM_SH").map_or_else(
            || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scripts/lib/system.sh"),
            PathBuf::from,
        );
        assert!(library.is_file(), "{} is no file", library.display());
        let output = Command::new(self.0.join("bin/bash"))
            .args(["-c", &format!("set -euo pipefail; exec 2>&1; source \"$1\"; {script}"), "-"])
            .arg(library)
            .env_clear()
            .env("PATH", self.0.join("bin"))
            .env("HOME", &self.0)
            .env("SYSTEM", &self.0)
            // So that the certificates of the real machine do not count.
            .env("SSL_CERT_FILE", "/none")
            .output()
            .expect("bash can be started");
        Said {
            code: output.status.code().unwrap_or(-1),
            text: String::from_utf8(output.stdout).expect("scripts print UTF-8"),
            calls: fs::read_to_string(self.0.join("calls"))
                .expect("the system's folder can be read"),
        }
    }
}
