# shellcheck shell=bash
# Shared by scripts/play, scripts/test, scripts/soak and .ci/run (sourced, not run): looks for the compiler
# and the system libraries, installs what is missing where it may, and else prints the exact line to type.
#
#   need_system LIST   LIST is `build`, `test`, `play`, `wayland` (a window without X11 or XWayland) or `sound`
#                      (ALSA, on top of one of the others); returns when all is there, exits 1 if not
#   want_sound         the same of `sound` for who plays: installs it where it may, and returns 1 with one line where
#                      the game has to be built without
#   need_command NAME PACKAGE...   installs the packages where the command is not there; exits 1 where it may not
#   need_cargo         sets CARGO (an array: the command) to a cargo that is new enough, or exits 1
#   say_adapter        one line when only software Vulkan is to be expected
#   say_build WHAT PROFILE   one line about what will be built, and how long that takes
#
# Nothing here runs in a process substitution or behind `|| true` whose failure would look like "nothing is
# missing": each look-up writes a variable, and its exit code is judged where it was called.
# All of it takes well under a second when nothing is missing.

# The oldest compiler that builds Bevy 0.19; `rust-version` in Cargo.toml says the same.
readonly rust_oldest=1.95.0
readonly rustup_line="curl --proto '=https' --tlsv1.2 -sSf https://sh.rustup.rs | sh -s -- -y --profile default"

say() { printf '%s\n' "$*" >&2; }
die() { say "error: $*"; exit 1; }

# What is needed, for what, how it is found where there is no dpkg, and its package in each family of
# systems. `-` stands for "comes with every such system".
#
#   cmd:NAME    a command (asked on Debian too: whoever has a compiler of their own needs no second one)
#   file:PATH   a file (asked on Debian too)
#   link        a program of three lines links; a compiler may be there without the C library's headers
#   pc:NAME     pkg-config knows it
#   so:NAME     the dynamic loader knows it
#   driver      a Vulkan device's driver
#
# Found by reading what the build scripts ask pkg-config for: libudev-sys (gamepads, by gilrs) and, with the
# feature `wayland`, wayland-sys. nv-flip-sys, the image comparison of the tests, is C++. The window (winit)
# opens the libraries of X11 and the keyboard's layout while it runs. With the feature `device` alsa-sys links ALSA,
# which PulseAudio and PipeWire serve too; without it the game is silent. cargo itself needs the certificates.
#
# The names were checked against: Debian 12 by installing them (.ci/empty-root does so again); Fedora and
# Arch by Bevy's own list of Linux dependencies and by install lines in public build scripts; openSUSE by the
# package lists of Tumbleweed 2023 (`libudev-devel` is what `systemd-devel` provides there, and is a package
# of that name in Leap).
readonly needs='
build  file:/etc/ssl/certs/ca-certificates.crt ca-certificates - - -
build  cmd:cc               gcc                  gcc                  gcc                gcc
build  cmd:c++              g++                  gcc-c++              gcc                gcc-c++
build  link                 libc6-dev            glibc-devel          glibc              glibc-devel
build  cmd:pkg-config       pkg-config           pkgconf-pkg-config   pkgconf            pkgconf-pkg-config
build  pc:libudev           libudev-dev          systemd-devel        systemd            libudev-devel
vulkan so:libvulkan.so.1    libvulkan1           vulkan-loader        vulkan-icd-loader  libvulkan1
vulkan driver               mesa-vulkan-drivers  mesa-vulkan-drivers  vulkan-swrast      libvulkan_lvp
window so:libX11.so.6       libx11-6             libX11               libx11             libX11-6
window so:libX11-xcb.so.1   libx11-xcb1          libX11-xcb           libx11             libX11-xcb1
window so:libxcb.so.1       libxcb1              libxcb               libxcb             libxcb1
window so:libXcursor.so.1   libxcursor1          libXcursor           libxcursor         libXcursor1
window so:libXi.so.6        libxi6               libXi                libxi              libXi6
window so:libxkbcommon.so.0 libxkbcommon0        libxkbcommon         libxkbcommon       libxkbcommon0
window so:libxkbcommon-x11.so.0 libxkbcommon-x11-0 libxkbcommon-x11   libxkbcommon-x11   libxkbcommon-x11-0
wayland pc:wayland-client   libwayland-dev       wayland-devel        wayland            wayland-devel
wayland so:libwayland-client.so.0 libwayland-client0 libwayland-client wayland           libwayland-client0
sound  pc:alsa              libasound2-dev       alsa-lib-devel       alsa-lib           alsa-devel
'

# as_root COMMAND...: as root, or by sudo where it asks for no password; 1 where neither may be had.
as_root() {
  if [[ $(id -u) -eq 0 ]]; then
    "$@"
  elif command -v sudo >/dev/null && sudo -n true 2>/dev/null; then
    sudo -n -- "$@"
  else
    return 1
  fi
}

# package_manager: sets MANAGER to apt, dnf, pacman, zypper or unknown.
package_manager() {
  MANAGER=unknown
  if command -v dpkg-query >/dev/null && command -v apt-get >/dev/null; then
    MANAGER=apt
    return
  fi
  local name
  for name in dnf pacman zypper; do
    if command -v "$name" >/dev/null; then
      MANAGER=$name
      return
    fi
  done
}

# install_line NAME...: what a person types to install these.
install_line() {
  case $MANAGER in
    apt) say "  sudo apt-get update && sudo apt-get install -y $*" ;;
    dnf) say "  sudo dnf install -y $*" ;;
    # Arch upgrades as a whole or not at all; a lone install may bring libraries that nothing else fits.
    pacman) say "  sudo pacman -Syu --needed $*" ;;
    zypper) say "  sudo zypper install -y $*" ;;
    *) say "  (by your system's own means) what these packages of Debian hold: $*" ;;
  esac
}

# install_packages NAME...: by apt-get; 1 where we may not install, or where it failed.
install_packages() {
  as_root true || { say "not root, and no sudo without a password: nothing can be installed from here"; return 1; }
  local -a apt=(env DEBIAN_FRONTEND=noninteractive apt-get)
  # The package lists of a fresh system are empty, those of an old one name files that are gone.
  if compgen -G '/var/lib/apt/lists/*_Packages*' >/dev/null; then
    say "installing by apt-get: $*"
    as_root "${apt[@]}" install -y --no-install-recommends "$@" </dev/null >&2 && return 0
    say "that did not work; once more with new package lists"
  fi
  say "fetching the package lists (apt-get update)"
  as_root "${apt[@]}" update </dev/null >&2 || { say "apt-get update failed, see above"; return 1; }
  say "installing by apt-get: $*"
  as_root "${apt[@]}" install -y --no-install-recommends "$@" </dev/null >&2 ||
    { say "apt-get install failed, see above"; return 1; }
}

# need_command NAME PACKAGE...: a tool of the checks; its packages have these names everywhere.
need_command() {
  local name=$1
  shift
  command -v "$name" >/dev/null && return 0
  package_manager
  say "$name is missing"
  [[ $MANAGER == apt ]] && install_packages "$@" && command -v "$name" >/dev/null && return 0
  say "Please type:"
  install_line "$@"
  exit 1
}

# ask_dpkg NAME...: sets INSTALLED to those of the packages that are installed, one query for all.
ask_dpkg() {
  local answer status=0 line
  # shellcheck disable=SC2016 # dpkg-query's own fields
  answer=$(LC_ALL=C dpkg-query -W -f '${db:Status-Abbrev}${Package}\n' "$@" 2>&1) || status=$?
  # 1 says only that it does not know every name; the others are printed all the same.
  [[ $status -le 1 ]] || die "dpkg-query failed (exit code $status): $answer"
  INSTALLED=' '
  while IFS= read -r line; do
    [[ $line =~ ^ii\ *([^ ]+)$ ]] && INSTALLED+="${BASH_REMATCH[1]} "
  done <<<"$answer"
  return 0
}

# A machine whose own driver is not from the system's packages has a Vulkan device without them.
has_vulkan_driver() {
  compgen -G '/usr/share/vulkan/icd.d/*.json' >/dev/null ||
    compgen -G '/etc/vulkan/icd.d/*.json' >/dev/null ||
    compgen -G '/usr/local/share/vulkan/icd.d/*.json' >/dev/null ||
    [[ -n ${VK_DRIVER_FILES:-}${VK_ICD_FILENAMES:-} ]]
}

# has CHECK: whether this machine has what a row of the table asks for, without a package database.
has() {
  case $1 in
    cmd:*) command -v "${1#*:}" >/dev/null ;;
    file:*) [[ -e ${1#*:} || -n ${SSL_CERT_FILE:-}${SSL_CERT_DIR:-} ]] ;;
    link)
      # Without a compiler there is nothing to ask; its own row says so.
      ! command -v cc >/dev/null || cc -x c - -o /dev/null <<<'int main(void) { return 0; }' 2>/dev/null
      ;;
    # Without pkg-config one cannot ask, and to name a package too many does no harm.
    pc:*) command -v pkg-config >/dev/null && pkg-config --exists "${1#*:}" ;;
    so:*) [[ $LIBRARIES == *"${1#*:}"* ]] ;;
    driver) has_vulkan_driver ;;
    *) die "has: no check named $1" ;;
  esac
}

# find_missing LIST: sets MISSING to the packages that LIST (build, test, play, wayland, sound) needs and that are not here,
# and ROWS to how many rows of the table were looked at.
find_missing() {
  local list=$1 kind check apt dnf pacman zypper package
  local -a checks=() packages=() debian=()
  while read -r kind check apt dnf pacman zypper; do
    [[ -n $kind && $list:$kind != build:vulkan ]] || continue
    case $list:$kind in
      sound:sound) ;;
      sound:*) continue ;;
      *:build | *:vulkan | play:window | wayland:window | wayland:wayland) ;;
      *) continue ;;
    esac
    case $MANAGER in
      dnf) package=$dnf ;;
      pacman) package=$pacman ;;
      zypper) package=$zypper ;;
      *) package=$apt ;;
    esac
    [[ $package == - ]] && continue
    # The tests' pictures are Mesa's, so they want its driver whatever else is there.
    [[ $list:$check:$MANAGER == test:driver:apt ]] && check=package
    checks+=("$check")
    packages+=("$package")
    debian+=("$apt")
  done <<<"$needs"
  ROWS=${#checks[@]}
  [[ $ROWS -gt 0 ]] || die "find_missing: no rows for the list $list"

  INSTALLED=''
  LIBRARIES=''
  if [[ $MANAGER == apt ]]; then
    ask_dpkg "${debian[@]}"
  else
    local ldconfig=''
    for ldconfig in ldconfig /sbin/ldconfig; do
      if command -v "$ldconfig" >/dev/null && LIBRARIES=$("$ldconfig" -p 2>/dev/null) && [[ -n $LIBRARIES ]]; then
        break
      fi
      LIBRARIES=''
    done
    [[ -n $LIBRARIES ]] || say "note: no ldconfig, so these libraries cannot be looked for and are taken to be there"
  fi

  MISSING=()
  local row
  for row in "${!checks[@]}"; do
    check=${checks[row]} package=${packages[row]}
    if [[ $MANAGER == apt && ! $check =~ ^(cmd:|file:) ]]; then
      [[ $INSTALLED == *" $package "* ]] && continue
      [[ $check == driver ]] && has driver && continue
    elif [[ $MANAGER != apt && $check == so:* && -z $LIBRARIES ]]; then
      say "      ${check#so:}"
      continue
    else
      has "$check" && continue
    fi
    # One package may serve two rows.
    [[ " ${MISSING[*]-} " == *" $package "* ]] || MISSING+=("$package")
  done
}

need_system() {
  case $1 in
    build | test | play | wayland | sound) ;;
    *) die "need_system: no list named $1" ;;
  esac
  if [[ -n ${DOLOMITE_NO_SYSTEM_CHECK:-} ]]; then
    say "system libraries: not looked for (DOLOMITE_NO_SYSTEM_CHECK is set)"
    return 0
  fi
  if [[ $(uname -s) != Linux ]]; then
    say "system libraries: not looked for ($(uname -s), not Linux)"
    return 0
  fi
  package_manager
  find_missing "$1"
  if [[ ${#MISSING[@]} -eq 0 ]]; then
    say "system libraries: all $ROWS that \`$1\` needs are there"
    return 0
  fi
  say "system libraries: missing ${MISSING[*]}"
  if [[ $MANAGER == apt ]]; then
    say "They will be installed now; from nothing that is some 130 MB to fetch and one to three minutes."
    local -a wanted=("${MISSING[@]}")
    if install_packages "${wanted[@]}"; then
      # apt-get's word is not enough: what was missing has to be there.
      find_missing "$1"
      if [[ ${#MISSING[@]} -eq 0 ]]; then
        say "system libraries: installed, all $ROWS that \`$1\` needs are there"
        return 0
      fi
      say "apt-get reported success, but these are still missing: ${MISSING[*]}"
    fi
  fi
  say "Please type:"
  install_line "${MISSING[@]}"
  say "and then run this script again. (Where you know better: DOLOMITE_NO_SYSTEM_CHECK=1 skips this look.)"
  exit 1
}

want_sound() {
  [[ $(uname -s) == Linux ]] || return 0
  local line="note: no sound: ALSA is missing here, so the game is built without its feature device"
  if [[ -n ${DOLOMITE_NO_SYSTEM_CHECK:-} ]]; then
    # Whoever knows better has it, or does not want it.
    command -v pkg-config >/dev/null && pkg-config --exists alsa && return 0
    say "$line"
    return 1
  fi
  package_manager
  find_missing sound
  [[ ${#MISSING[@]} -eq 0 ]] && return 0
  if [[ $MANAGER == apt ]] && as_root true && install_packages "${MISSING[@]}"; then
    find_missing sound
    [[ ${#MISSING[@]} -eq 0 ]] && return 0
  fi
  say "$line; to have it, type:"
  install_line "${MISSING[@]}"
  return 1
}

# new_enough COMMAND...: whether that cargo runs and is at least $rust_oldest.
new_enough() {
  local version
  version=$("$@" --version 2>/dev/null | sed -n 's/^cargo \([0-9.]*\).*/\1/p') || return 1
  [[ -n $version ]] && printf '%s\n' "$rust_oldest" "$version" | sort -V -C
}

# find_cargo: sets CARGO where one that is new enough is found without installing anything.
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

# found_cargo: one line about the compiler that will be used.
found_cargo() {
  find_cargo || return 1
  say "compiler: $("${CARGO[@]}" --version)"
}

need_cargo() {
  found_cargo && return 0
  local found
  found=$(cargo --version 2>/dev/null) || found="no cargo"
  say "compiler: Dolomite needs Rust (cargo $rust_oldest or newer); found: $found"
  # Debian 13 and Ubuntu 24.04 have rustup as a package. Not where a cargo is installed: apt would
  # take that one away.
  if ! command -v rustup >/dev/null && ! command -v cargo >/dev/null && command -v apt-cache >/dev/null; then
    if [[ -n $(apt-cache madison rustup 2>/dev/null) ]]; then
      install_packages rustup || say "rustup could not be installed as a package"
    else
      say "this system has no package rustup, so Rust is not installed from here"
    fi
  fi
  if command -v rustup >/dev/null; then
    say "installing the stable Rust toolchain by rustup"
    rustup toolchain install stable --profile default >&2 || say "rustup failed, see above"
    found_cargo && return 0
  fi
  say "Please type:"
  if command -v rustup >/dev/null; then
    say "  rustup toolchain install stable --profile default"
  else
    package_manager
    command -v curl >/dev/null || install_line curl ca-certificates
    say "  $rustup_line"
  fi
  say "and then run this script again."
  exit 1
}

# say_adapter: the game runs on software Vulkan, but a newcomer should know why it is slow.
say_adapter() {
  compgen -G '/dev/dri/renderD*' >/dev/null && return 0
  compgen -G '/dev/nvidia[0-9]*' >/dev/null && return 0
  [[ -e /dev/dxg ]] && return 0
  say "note: no GPU is seen on this machine, so Vulkan runs in software (slow, but all of it works)"
}

# say_build WHAT PROFILE: what comes next, and how long it takes. PROFILE names the folder below target/.
say_build() {
  local folder=${CARGO_TARGET_DIR:-target}/$2 minutes
  if compgen -G "$folder/.fingerprint/bevy_render-*" >/dev/null; then
    say "building $1 in $folder: Bevy is built there already, so only what has changed is compiled"
    return 0
  fi
  # Measured on two cores (docs/measured): 22, and 13.
  case $2 in
    release) minutes=22 ;;
    *) minutes=15 ;;
  esac
  say "building $1 in $folder for the first time, with Bevy and all it needs: some 400 crates and some $minutes"
  say "minutes on two cores, less with more (this machine has $(nproc)). cargo shows how far it is; later builds"
  say "compile only what has changed."
}

# display: sets DISPLAY_KIND to what a window can be opened on: x11, wayland, none; `other` where it is not Linux.
# shellcheck disable=SC2034 # DISPLAY_KIND is read by who sources this file
display() {
  if [[ $(uname -s) != Linux ]]; then
    DISPLAY_KIND=other
  elif [[ -n ${DISPLAY:-} ]]; then
    DISPLAY_KIND=x11
  elif [[ -n ${WAYLAND_DISPLAY:-}${WAYLAND_SOCKET:-} ]]; then
    DISPLAY_KIND=wayland
  else
    DISPLAY_KIND=none
  fi
}
