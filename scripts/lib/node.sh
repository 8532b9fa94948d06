# shellcheck shell=bash
# What tests run by Node (sourced after system.sh): Tint, by Dawn for Node, and Khronos' glTF validator.
#
#   need_node_tests   installs Node where it may, and the packages that tests/node/package-lock.json pins; exits 1
#                     where that fails
#
# Without it the tests that need it skip, with a line, outside CI.

# The oldest Node that the packages run on.
readonly node_oldest=18

need_node_tests() {
  local folder lock
  folder=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../tests/node" && pwd)
  need_command node nodejs npm
  need_command npm nodejs npm
  local version
  version=$(node --version)
  [[ $(cut -d. -f1 <<<"${version#v}") -ge $node_oldest ]] ||
    die "Node $node_oldest or newer is needed; found: $version"
  # npm writes this file last.
  lock=$folder/node_modules/.package-lock.json
  [[ -e $lock && ! $folder/package-lock.json -nt $lock ]] && return 0
  say "installing the npm packages of tests/node (130 MB)"
  # Nothing that packages bring along is run.
  (cd "$folder" && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error >&2) ||
    die "npm ci failed in tests/node"
}

# The oldest Node that builds the page: Vite's own bound.
readonly node_oldest_web=20.19

# need_web: installs Chromium where it may, and the packages that web/package-lock.json pins; exits 1 where that fails.
# The tests take Chromium for its WebGPU, which it computes in software where it is told to.
need_web() {
  local folder lock version
  folder=$(cd "$(dirname "${BASH_SOURCE[0]}")/../../web" && pwd)
  need_node_tests
  version=$(node --version)
  [[ $(printf '%s\n%s\n' "$node_oldest_web" "${version#v}" | sort -V | head -n 1) == "$node_oldest_web" ]] ||
    die "Node $node_oldest_web or newer is needed for the page; found: $version"
  [[ -n ${CHROMIUM:-} ]] || need_command chromium chromium
  # npm writes this file last.
  lock=$folder/node_modules/.package-lock.json
  [[ -e $lock && ! $folder/package-lock.json -nt $lock ]] && return 0
  say "installing the npm packages of web (90 MB)"
  # Nothing that packages bring along is run.
  (cd "$folder" && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error >&2) ||
    die "npm ci failed in web"
}
