# shellcheck shell=bash
# What the scripts share: the packages, how they are installed, how the project is built.
# Sourced, never run; leaves the caller in the project's directory.

set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

# What CMakeLists.txt and tests/CMakeLists.txt look for, by Debian's names.
packages=(g++ cmake make pkg-config libcli11-dev nlohmann-json3-dev libnanoflann-dev libfmt-dev
  libhwy-dev zlib1g-dev catch2 gemmi-dev tao-pegtl-dev)

# What python/CMakeLists.txt and the tests of the Python package look for.
# shellcheck disable=SC2034  # used by the scripts that source this file
python_packages=(pybind11-dev python3-dev python3-numpy python3-pytest python3-venv)

# Every core, unless the caller has said otherwise.
CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}
CTEST_PARALLEL_LEVEL=${CTEST_PARALLEL_LEVEL:-$(nproc)}
export CMAKE_BUILD_PARALLEL_LEVEL CTEST_PARALLEL_LEVEL

fail() {
  printf '%s: %s\n' "${0##*/}" "$*" >&2
  exit 1
}

# install_packages PACKAGE...: those that are missing, and only then as root.
install_packages() {
  local package missing=() as_root=()
  if ! command -v apt-get >/dev/null; then
    echo "No apt-get here; going on in the hope that these are installed: $*" >&2
    return
  fi
  for package in "$@"; do
    # A package that was removed but not purged is known to dpkg, too: look at the status.
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
    # Without a terminal nobody can type a password: fail rather than wait.
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

# build DIRECTORY [TARGET...]: everything, or the targets named.
build() {
  local directory=$1
  shift
  cmake --build "$directory" ${1:+--target "$@"}
}

# The release build in build/: the program alone.
build_release() {
  install_packages "${packages[@]}"
  configure build -DCMAKE_BUILD_TYPE=Release
  build build eses-blocks
}
