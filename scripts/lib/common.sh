# shellcheck shell=bash
# Shared by the shell scripts: lists of packages, their installation, and building the project. It
# is sourced, never run, and changes the caller's directory to that of the project.

set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

# The Debian packages that CMakeLists.txt and tests/CMakeLists.txt need.
packages=(g++ cmake make pkg-config libcli11-dev nlohmann-json3-dev libfmt-dev libhwy-dev
  zlib1g-dev libnanoflann-dev catch2 gemmi-dev tao-pegtl-dev)

# The Debian packages that python/CMakeLists.txt and the tests of the Python package need.
# shellcheck disable=SC2034  # used by the scripts that source this file
python_packages=(pybind11-dev python3-dev python3-numpy python3-pytest python3-venv)

# Build on all cores, unless the caller has set another number.
CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}
CTEST_PARALLEL_LEVEL=${CTEST_PARALLEL_LEVEL:-$(nproc)}
export CMAKE_BUILD_PARALLEL_LEVEL CTEST_PARALLEL_LEVEL

fail() {
  printf '%s: %s\n' "${0##*/}" "$*" >&2
  exit 1
}

# install_packages PACKAGE...: installs missing packages, as root if there are any.
install_packages() {
  local package missing=() as_root=()
  if ! command -v apt-get >/dev/null; then
    echo "No apt-get here; going on in the hope that these are installed: $*" >&2
    return
  fi
  for package in "$@"; do
    # dpkg also lists packages that were removed but not purged, so their status is checked.
    if ! dpkg -s "$package" 2>/dev/null | grep -q '^Status: .* installed$'; then
      missing+=("$package")
    fi
  done
  if ((${#missing[@]} == 0)); then return; fi

  if ((EUID != 0)); then
    if ! command -v sudo >/dev/null; then
      fail "missing packages, and neither root nor sudo to install them. Run as root:
  apt-get install ${missing[*]}"
    fi
    as_root=(sudo)
    # Without a terminal no password can be typed, so fail at once.
    if [[ ! -t 0 ]]; then as_root+=(-n); fi
  fi
  as_root+=(env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300)

  echo "Installing ${missing[*]}"
  "${as_root[@]}" -qq update </dev/null || echo "apt-get update failed; trying what it knows" >&2
  "${as_root[@]}" -qq -y --no-install-recommends install "${missing[@]}" </dev/null ||
    fail "could not install ${missing[*]}"
}

# configure DIRECTORY [CMAKE ARGUMENT...]
configure() {
  cmake -S . -B "$1" "${@:2}"
}

# build DIRECTORY [TARGET...]: builds everything, or the named targets.
build() {
  local directory=$1
  shift
  cmake --build "$directory" ${1:+--target "$@"}
}

# Builds the program alone, as a release build in build/.
build_release() {
  install_packages "${packages[@]}"
  configure build -DCMAKE_BUILD_TYPE=Release
  build build eses-blocks
}
