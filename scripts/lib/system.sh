# shellcheck shell=bash
# Shared by scripts/play, scripts/test and .ci/run (sourced, not run): looks for the compiler and the
# system libraries, installs what is missing where it may, and else prints the exact line to type.
#
#   need_system LIST   LIST is `build`, `test` or `play`; returns when all is there, exits 1 if not
#   need_cargo         sets CARGO (an array: the command) to a cargo that is new enough, or exits 1
#   say_adapter        one line when only software Vulkan is to be expected
#
# All of it takes well under a second when nothing is missing.

# The oldest compiler that builds Bevy 0.19; `rust-version` in Cargo.toml says the same.
readonly rust_oldest=1.95.0
readonly rustup_line="curl --proto '=https' --tlsv1.2 -sSf https://sh.rustup.rs | sh -s -- -y --profile default"

say() { printf '%s\n' "$*" >&2; }
die() { say "error: $*"; exit 1; }

# Compilers and headers. Found by reading what the build scripts ask pkg-config for:
#   libudev-dev     libudev-sys, for gamepads (gilrs)
#   libwayland-dev  wayland-sys links libwayland-client
#   g++             nv-flip-sys, the image comparison of the tests, is C++
# ALSA is not among them: the game has no sound yet.
readonly packages_build=(libudev-dev libwayland-dev)
# Any Vulkan device, and the loader. mesa-vulkan-drivers also holds the software device.
readonly packages_vulkan=(libvulkan1 mesa-vulkan-drivers)
# Opened at run time by the window (winit): X11, or Wayland, and the keyboard's layout.
readonly packages_window=(
  libx11-6 libx11-xcb1 libxcb1 libxcursor1 libxi6 libxkbcommon0 libxkbcommon-x11-0 libwayland-client0
)

# as_root COMMAND...: as root, or by sudo where it asks for no password; 1 where neither may be had.
as_root() {
  if [[ $EUID -eq 0 ]]; then
    "$@"
  elif command -v sudo >/dev/null && sudo -n true 2>/dev/null; then
    sudo -n -- "$@"
  else
    return 1
  fi
}

# install_packages NAME...: by apt-get; 1 where we may not install, or where it failed.
install_packages() {
  as_root true || return 1
  say "installing: $*"
  local -a apt=(env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends)
  # The package lists of a fresh system are empty, those of an old one name files that are gone.
  as_root "${apt[@]}" "$@" </dev/null >&2 && return 0
  as_root apt-get update </dev/null >&2 && as_root "${apt[@]}" "$@" </dev/null >&2
}

# missing_packages NAME...: prints those that are not installed; one query for all of them.
missing_packages() {
  local installed
  installed=" $(dpkg-query -W -f '${db:Status-Abbrev}${Package}\n' "$@" 2>/dev/null |
    sed -n 's/^ii *//p' | sort -u | tr '\n' ' ')"
  local name
  for name in "$@"; do
    [[ $installed == *" $name "* ]] || printf '%s\n' "$name"
  done
}

# A machine whose own driver is not from Debian's packages has a Vulkan device without them.
has_vulkan_driver() {
  compgen -G '/usr/share/vulkan/icd.d/*.json' >/dev/null ||
    compgen -G '/etc/vulkan/icd.d/*.json' >/dev/null ||
    compgen -G '/usr/local/share/vulkan/icd.d/*.json' >/dev/null ||
    [[ -n ${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-} ]]
}

need_system() {
  local -a wanted=("${packages_build[@]}") missing=()
  case $1 in
    build) ;;
    test) wanted+=("${packages_vulkan[@]}") ;;
    play)
      wanted+=("${packages_window[@]}" libvulkan1)
      has_vulkan_driver || wanted+=(mesa-vulkan-drivers)
      ;;
    *) die "need_system: no list named $1" ;;
  esac
  # Commands rather than packages: whoever has a compiler of their own needs no second one.
  command -v cc >/dev/null || missing+=(gcc)
  command -v c++ >/dev/null || missing+=(g++)
  command -v pkg-config >/dev/null || missing+=(pkg-config)
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    say "note: not Debian or Ubuntu, so the system libraries are not looked for. Needed are a C and a"
    say "      C++ compiler, pkg-config, and what these packages of Debian hold: ${wanted[*]}"
    return 0
  fi
  mapfile -t -O "${#missing[@]}" missing < <(missing_packages "${wanted[@]}")
  [[ ${#missing[@]} -eq 0 ]] && return 0
  if ! install_packages "${missing[@]}"; then
    say "These packages are missing and could not be installed from here. Please type:"
    say "  sudo apt-get update && sudo apt-get install -y ${missing[*]}"
    exit 1
  fi
}

# new_enough COMMAND...: whether that cargo runs and is at least $rust_oldest.
new_enough() {
  local version
  version=$("$@" --version 2>/dev/null | sed -n 's/^cargo \([0-9.]*\).*/\1/p') || return 1
  [[ -n $version ]] && printf '%s\n' "$rust_oldest" "$version" | sort -V -C
}

# find_cargo: sets CARGO where one that is new enough is found without installing anything.
# shellcheck disable=SC2034 # CARGO is read by who sources this file
find_cargo() {
  local home=${CARGO_HOME:-$HOME/.cargo}
  # rustup's folder is on PATH only in shells opened after it was installed.
  [[ -d $home/bin && :$PATH: != *":$home/bin:"* ]] && PATH="$PATH:$home/bin"
  local -a candidate
  for candidate in cargo "$home/bin/cargo"; do
    command -v "$candidate" >/dev/null || continue
    if new_enough "$candidate"; then
      CARGO=("$candidate")
      return 0
    fi
  done
  # rustup's default may be an old one while a newer one lies beside it.
  if command -v rustup >/dev/null && new_enough rustup run stable cargo; then
    CARGO=(rustup run stable cargo)
    return 0
  fi
  return 1
}

need_cargo() {
  find_cargo && return 0
  # Debian 13 and Ubuntu 24.04 have rustup as a package. Not where a cargo is installed: apt would
  # take that one away.
  if ! command -v rustup >/dev/null && ! command -v cargo >/dev/null &&
    command -v apt-cache >/dev/null && [[ -n $(apt-cache madison rustup 2>/dev/null) ]]; then
    install_packages rustup || true
  fi
  if command -v rustup >/dev/null; then
    say "installing the stable Rust toolchain by rustup"
    rustup toolchain install stable --profile default >&2 || true
    find_cargo && return 0
  fi
  local found
  found=$(cargo --version 2>/dev/null || echo "no cargo")
  say "Dolomite needs cargo $rust_oldest or newer; found: $found. Please type:"
  if command -v rustup >/dev/null; then
    say "  rustup toolchain install stable --profile default"
  else
    command -v curl >/dev/null || say "  sudo apt-get update && sudo apt-get install -y curl ca-certificates"
    say "  $rustup_line"
    say "and then run this script again."
  fi
  exit 1
}

# say_adapter: the game runs on software Vulkan, but a newcomer should know why it is slow.
say_adapter() {
  compgen -G '/dev/dri/renderD*' >/dev/null && return 0
  compgen -G '/dev/nvidia[0-9]*' >/dev/null && return 0
  [[ -e /dev/dxg ]] && return 0
  say "note: no GPU is seen on this machine, so Vulkan runs in software (slow, but all of it works)"
}
