//! `need_system` and `need_cargo` of `scripts/lib/system.sh`, on systems of all kinds.
//!
//! Found on a fresh Debian: where `dpkg-query` does not know one name it exits with 1, and the list of what is
//! missing was empty, so that nothing was installed and nothing said. Every test of `need_system` and `need_cargo`
//! here fails on that script.

use crate::support::{Apt, Said, System};
use std::collections::BTreeSet;

/// What `./scripts/test` needs of Debian beside the compilers.
const TEST: [&str; 4] = [
    "libc6-dev",
    "libudev-dev",
    "libvulkan1",
    "mesa-vulkan-drivers",
];

/// What `./scripts/play` needs beside those, but for the driver, which may be another.
const WINDOW: [&str; 7] = [
    "libx11-6",
    "libx11-xcb1",
    "libxcb1",
    "libxcursor1",
    "libxi6",
    "libxkbcommon0",
    "libxkbcommon-x11-0",
];

fn set<'a>(names: &[&'a str]) -> BTreeSet<&'a str> {
    names.iter().copied().collect()
}

/// Everything was found, installed or not, and the script goes on.
fn went_on(said: &Said) {
    assert_eq!(said.code, 0, "{said:#?}");
    assert!(said.text.ends_with("went on\n"), "{said:#?}");
}

/// The script has ended, with an exit code that says so.
fn stopped(said: &Said) {
    assert_eq!(said.code, 1, "{said:#?}");
    assert!(!said.text.contains("went on"), "{said:#?}");
}

#[test]
fn none_known_all_are_installed() {
    let system = System::new();
    system.debian(&[], Apt::Works);
    let said = system.need("test");
    went_on(&said);
    assert_eq!(said.words("missing "), set(&TEST));
    let asked = said.calls.lines().find(|call| call.starts_with("install"));
    for name in TEST {
        assert!(asked.unwrap().contains(name), "{said:#?}");
    }
}

#[test]
fn one_known_the_others_are_installed() {
    for known in TEST {
        let system = System::new();
        system.debian(&[known], Apt::Works);
        let said = system.need("test");
        went_on(&said);
        let mut others = set(&TEST);
        others.remove(known);
        assert_eq!(said.words("missing "), others, "{known}");
    }
}

#[test]
fn one_unknown_is_installed() {
    for unknown in TEST {
        let system = System::new();
        let known: Vec<_> = TEST.into_iter().filter(|name| *name != unknown).collect();
        system.debian(&known, Apt::Works);
        let said = system.need("test");
        went_on(&said);
        assert_eq!(said.words("missing "), set(&[unknown]));
    }
}

#[test]
fn all_known_nothing_is_installed_and_that_is_said() {
    let system = System::new();
    system.debian(&TEST, Apt::Fails);
    let said = system.need("test");
    went_on(&said);
    assert_eq!(said.calls, "");
    said.line("all 8 that `test` needs are there");
}

#[test]
fn playing_needs_the_window_s_libraries_too() {
    let system = System::new();
    system.debian(&["libxi6"], Apt::Works);
    // A driver may be there on the machine that runs this.
    let said = system.run("has_vulkan_driver() { return 1; }; need_system play; echo went on");
    went_on(&said);
    let mut wanted = &set(&TEST) | &set(&WINDOW);
    wanted.remove("libxi6");
    assert_eq!(said.words("missing "), wanted);
}

#[test]
fn a_compiler_s_packages_are_named_where_the_commands_are_not_there() {
    let system = System::new();
    for command in ["cc", "c++", "pkg-config"] {
        system.without(command);
    }
    system.debian(&["libudev-dev"], Apt::Fails);
    let said = system.need("build");
    stopped(&said);
    let wanted = ["gcc", "g++", "libc6-dev", "pkg-config"];
    assert_eq!(said.words("missing "), set(&wanted));
}

#[test]
fn a_failing_apt_get_ends_with_the_line_to_type() {
    let system = System::new();
    system.debian(&["libudev-dev"], Apt::Fails);
    let said = system.need("test");
    stopped(&said);
    let line =
        "  sudo apt-get update && sudo apt-get install -y libc6-dev libvulkan1 mesa-vulkan-drivers";
    assert_eq!(said.line("sudo apt-get"), line);
}

#[test]
fn what_apt_get_claims_is_looked_at() {
    let system = System::new();
    system.debian(&["libudev-dev"], Apt::Lies);
    let said = system.need("test");
    stopped(&said);
    assert_eq!(
        said.words("still missing: "),
        set(&["libc6-dev", "libvulkan1", "mesa-vulkan-drivers"])
    );
}

#[test]
fn package_lists_are_fetched_where_an_install_finds_nothing() {
    let system = System::new();
    system.debian(&[], Apt::NeedsUpdate);
    let said = system.need("build");
    went_on(&said);
    let last: Vec<_> = said.calls.lines().rev().take(2).collect();
    assert_eq!(last[1], "update", "{said:#?}");
    assert!(last[0].starts_with("install"), "{said:#?}");
}

#[test]
fn without_root_and_sudo_the_line_to_type_is_printed() {
    let system = System::new();
    system.debian(&["libc6-dev"], Apt::Works);
    system.command("id", "echo 1000");
    let said = system.need("build");
    stopped(&said);
    assert_eq!(said.calls, "");
    let line = "  sudo apt-get update && sudo apt-get install -y libudev-dev";
    assert_eq!(said.line("sudo apt-get"), line);
    said.line("not root");
}

#[test]
fn sudo_is_used_where_it_asks_for_no_password() {
    let system = System::new();
    system.debian(&["libc6-dev"], Apt::Works);
    system.command("id", "echo 1000");
    system.command("sudo", "while [[ $1 == -* ]]; do shift; done; \"$@\"");
    let said = system.need("build");
    went_on(&said);
    assert!(said.calls.starts_with("install"), "{said:#?}");
}

#[test]
fn a_broken_package_database_is_an_error() {
    let system = System::new();
    system.debian(&[], Apt::Works);
    system.command(
        "dpkg-query",
        "echo 'dpkg-query: error: database is broken' >&2; exit 2",
    );
    let said = system.need("build");
    stopped(&said);
    said.line("database is broken");
}

/// Another family of systems, on which pkg-config knows nothing and the loader only `libvulkan.so.1`.
fn bare(manager: &str) -> System {
    let system = System::new();
    system.command(manager, "echo no test may call this; exit 99");
    system.command("pkg-config", "exit 1");
    system.command(
        "ldconfig",
        "echo '	libvulkan.so.1 (libc6,x86-64) => /usr/lib/libvulkan.so.1'",
    );
    system
}

/// The line that is printed for `play` where there is a driver.
fn line_of(manager: &str) -> String {
    let said =
        bare(manager).run("has_vulkan_driver() { return 0; }; need_system play; echo went on");
    stopped(&said);
    said.line(&format!("sudo {manager}")).trim().to_owned()
}

#[test]
fn fedora_gets_the_line_for_dnf() {
    assert_eq!(
        line_of("dnf"),
        "sudo dnf install -y systemd-devel libX11 libX11-xcb libxcb libXcursor libXi \
         libxkbcommon libxkbcommon-x11"
    );
}

#[test]
fn arch_gets_the_line_for_pacman() {
    assert_eq!(
        line_of("pacman"),
        "sudo pacman -Syu --needed systemd libx11 libxcb libxcursor libxi libxkbcommon \
         libxkbcommon-x11"
    );
}

#[test]
fn opensuse_gets_the_line_for_zypper() {
    assert_eq!(
        line_of("zypper"),
        "sudo zypper install -y libudev-devel libX11-6 libX11-xcb1 libxcb1 libXcursor1 libXi6 \
         libxkbcommon0 libxkbcommon-x11-0"
    );
}

#[test]
fn a_bare_fedora_is_told_of_compilers_and_driver() {
    let system = bare("dnf");
    for command in ["cc", "c++", "pkg-config"] {
        system.without(command);
    }
    let said = system.run("has_vulkan_driver() { return 1; }; need_system test; echo went on");
    stopped(&said);
    assert_eq!(
        said.line("sudo dnf").trim(),
        "sudo dnf install -y gcc gcc-c++ pkgconf-pkg-config systemd-devel mesa-vulkan-drivers"
    );
}

#[test]
fn a_compiler_that_links_nothing_is_noticed() {
    let system = bare("dnf");
    system.command("cc", "exit 1");
    system.command("pkg-config", "exit 0");
    let said = system.need("build");
    stopped(&said);
    assert_eq!(said.words("missing "), set(&["glibc-devel"]));
}

#[test]
fn another_system_that_has_everything_goes_on_and_says_so() {
    let system = bare("pacman");
    system.command("pkg-config", "exit 0");
    let said = system.run("has_vulkan_driver() { return 0; }; need_system test; echo went on");
    went_on(&said);
    said.line("all 7 that `test` needs are there");
}

#[test]
fn an_unknown_system_is_told_what_debian_calls_it() {
    let said = bare("emerge").need("build");
    stopped(&said);
    said.line("packages of Debian hold: libudev-dev");
}

#[test]
fn the_look_can_be_switched_off() {
    let said = bare("dnf").run("DOLOMITE_NO_SYSTEM_CHECK=1; need_system play; echo went on");
    went_on(&said);
    said.line("not looked for (DOLOMITE_NO_SYSTEM_CHECK is set)");
}

#[test]
fn without_rust_the_line_to_type_is_printed() {
    let system = System::new();
    system.debian(&TEST, Apt::Works);
    let said = system.run("need_cargo; echo went on");
    stopped(&said);
    said.line("Dolomite needs Rust (cargo 1.95.0 or newer); found: no cargo");
    assert_eq!(
        said.line("install -y curl").trim(),
        "sudo apt-get update && sudo apt-get install -y curl ca-certificates"
    );
    said.line("https://sh.rustup.rs");
}

#[test]
fn an_old_rust_is_told_from_a_new_one() {
    let system = System::new();
    for (version, code) in [("1.94.1", 1), ("1.95.0", 0), ("1.100.0", 0)] {
        system.command("cargo", &format!("echo 'cargo {version} (0 2026-01-01)'"));
        let said = system.run("need_cargo; echo went on");
        assert_eq!(said.code, code, "{version}: {said:#?}");
        said.line(if code == 0 {
            "compiler: cargo"
        } else {
            "found: cargo 1.94.1"
        });
    }
}

#[test]
fn a_tool_of_the_checks_is_installed_or_named() {
    let script = "need_command sleep coreutils; echo went on";
    let system = System::new();
    system.debian(&[], Apt::Fails);
    let said = system.run(script);
    stopped(&said);
    let line = "  sudo apt-get update && sudo apt-get install -y coreutils";
    assert_eq!(said.line("sudo apt-get"), line);
    // What apt-get claims is looked at here too.
    system.debian(&[], Apt::Works);
    stopped(&system.run(script));
    system.command("sleep", "exit 0");
    went_on(&system.run(script));
    let said = bare("pacman").run(script);
    stopped(&said);
    assert_eq!(
        said.line("sudo pacman").trim(),
        "sudo pacman -Syu --needed coreutils"
    );
}

/// What `./scripts/play ARGUMENTS` says and does where a variable names a display, or none does. ALSA is not there.
fn play(arguments: &str, display: &str) -> Said {
    play_with("exit 1", arguments, display)
}

/// The same with what `pkg-config` does.
fn play_with(pkg_config: &str, arguments: &str, display: &str) -> Said {
    let system = System::new();
    system.command("pkg-config", pkg_config);
    system.command(
        "cargo",
        "case $1 in --version) echo cargo 1.95.0 ;; *) echo \"$*\" >>\"$SYSTEM/calls\" ;; esac",
    );
    let play = concat!(env!("CARGO_MANIFEST_DIR"), "/../../scripts/play");
    system.run(&format!(
        "export DOLOMITE_NO_SYSTEM_CHECK=1 {display}; bash {play} {arguments}"
    ))
}

#[test]
fn without_a_display_the_game_is_built_and_that_is_said() {
    let said = play("--scene mountain", "");
    assert_eq!(said.code, 1, "{said:#?}");
    said.line("there is no display here");
    assert_eq!(said.calls, "build --release\n");
}

#[test]
fn with_a_display_or_without_a_window_the_game_is_started() {
    for (arguments, display) in [
        ("--scene mountain", "DISPLAY=:0"),
        ("--scene mountain", "DISPLAY=:0 WAYLAND_DISPLAY=wayland-0"),
        ("shot --out a.png", ""),
        ("-- --help", ""),
    ] {
        let said = play(arguments, display);
        assert_eq!(said.code, 0, "{said:#?}");
        let handed = arguments.trim_start_matches("-- ");
        let calls = format!("build --release\nrun --release --quiet -- {handed}\n");
        assert_eq!(said.calls, calls);
        assert!(!said.text.contains("no display"), "{said:#?}");
    }
}

#[test]
fn where_alsa_is_there_the_game_has_sound() {
    let said = play_with("[[ $* == *alsa* ]]", "--scene mountain", "DISPLAY=:0");
    let calls = "build --release --features device\n\
                 run --release --quiet --features device -- --scene mountain\n";
    assert_eq!(said.calls, calls);
    assert!(!said.text.contains("no sound"), "{said:#?}");
    let said = play_with("exit 0", "", "WAYLAND_DISPLAY=wayland-0");
    assert!(
        said.calls
            .starts_with("build --release --features wayland,device\n")
    );
    // A picture has none, and is built as before.
    let said = play_with("exit 0", "shot --out a.png", "DISPLAY=:0");
    assert!(said.calls.starts_with("build --release\n"), "{said:#?}");
    // Without ALSA that is one line, and the game is built all the same.
    let said = play("--scene mountain", "DISPLAY=:0");
    assert_eq!(said.text.matches("no sound").count(), 1, "{said:#?}");
}

#[test]
fn sound_is_installed_where_it_may_be_and_else_the_line_is_printed() {
    let system = System::new();
    system.debian(&[&TEST[..], &WINDOW[..]].concat(), Apt::Works);
    let said = system.run("need_system sound; want_sound && echo went on");
    went_on(&said);
    assert_eq!(said.words("missing "), set(&["libasound2-dev"]));
    assert_eq!(said.calls.lines().count(), 1, "{said:#?}");
    let system = System::new();
    system.debian(&[&TEST[..], &WINDOW[..]].concat(), Apt::Fails);
    let said = system.run("want_sound || echo went on");
    went_on(&said);
    said.line("note: no sound: ALSA is missing here");
    assert!(
        said.line("sudo apt-get")
            .ends_with("install -y libasound2-dev")
    );
    for (manager, package) in [
        ("dnf", "alsa-lib-devel"),
        ("pacman", "alsa-lib"),
        ("zypper", "alsa-devel"),
    ] {
        let said = bare(manager).run("want_sound || echo went on");
        went_on(&said);
        assert!(said.text.contains(package), "{said:#?}");
    }
}

#[test]
fn wayland_alone_has_a_feature_of_its_own() {
    let said = play("--scene mountain", "WAYLAND_DISPLAY=wayland-0");
    assert_eq!(said.code, 0, "{said:#?}");
    let calls = "build --release --features wayland\n\
                 run --release --quiet --features wayland -- --scene mountain\n";
    assert_eq!(said.calls, calls);
    // And it links a library that X11 does not.
    let system = System::new();
    system.debian(&[&TEST[..], &WINDOW[..]].concat(), Apt::Works);
    let said = system.need("wayland");
    went_on(&said);
    assert_eq!(
        said.words("missing "),
        set(&["libwayland-dev", "libwayland-client0"])
    );
}
