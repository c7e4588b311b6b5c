# shellcheck shell=bash
# Shared by the shell scripts: lists of packages, their installation, and building the project. It
# is sourced, never run, and changes the caller's directory to that of the project.

set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

# Lists of Debian packages. A|B is the first of these packages that the release of Debian has. A
# package with a ? is optional: it is left out where the release does not have it.

# What the program needs.
packages=(g++ cmake make pkg-config libcli11-dev nlohmann-json3-dev libfmt-dev libhwy-dev
  libnanoflann-dev zlib1g-dev 'gemmi-dev|libgemmi-dev?' 'tao-pegtl-dev?')

# What the tests and the Python package need in addition.
# shellcheck disable=SC2034  # used by the scripts that source this file
test_packages=(catch2 python3)
# shellcheck disable=SC2034
python_packages=(pybind11-dev python3-dev python3-numpy python3-pytest python3-venv)

# Build on all cores, unless the caller has set another number.
CMAKE_BUILD_PARALLEL_LEVEL=${CMAKE_BUILD_PARALLEL_LEVEL:-$(nproc)}
CTEST_PARALLEL_LEVEL=${CTEST_PARALLEL_LEVEL:-$(nproc)}
export CMAKE_BUILD_PARALLEL_LEVEL CTEST_PARALLEL_LEVEL

fail() {
  printf '%s: %s\n' "${0##*/}" "$*" >&2
  exit 1
}

is_installed() {
  [[ $(dpkg-query --show --showformat '${db:Status-Status}' "$1" 2>/dev/null) == installed ]]
}

is_available() {
  [[ $(LC_ALL=C apt-cache policy "$1" 2>/dev/null) =~ 'Candidate: '[^\(] ]]
}

# first_package TEST A|B|...: prints the first of these packages that passes the test.
first_package() {
  local names name
  IFS='|' read -ra names <<<"${2%\?}"
  for name in "${names[@]}"; do
    if "$1" "$name"; then
      echo "$name"
      return
    fi
  done
  return 1
}

# choose_packages PACKAGE...: sets `required` and `optional` to the names of the packages in this
# release, and `absent` to the optional packages that it does not have.
choose_packages() {
  local package name
  required=() optional=() absent=()
  for package in "$@"; do
    name=$(first_package is_available "$package") || name=''
    case $package in
      *\?) if [[ $name ]]; then optional+=("$name"); else absent+=("${package%\?}"); fi ;;
      *) required+=("${name:-${package%%|*}}") ;;
    esac
  done
}

# install_packages PACKAGE...: installs missing packages, as root if there are any.
install_packages() {
  local package missing=() required optional absent as_root=() install
  if ! command -v apt-get >/dev/null; then
    echo "No apt-get here; going on in the hope that these are installed: $*" >&2
    return
  fi
  for package in "$@"; do
    if ! first_package is_installed "$package" >/dev/null; then missing+=("$package"); fi
  done
  if ((${#missing[@]} == 0)); then return; fi

  choose_packages "${missing[@]}"
  if ((${#required[@]} + ${#optional[@]} > 0 || EUID == 0)); then
    if ((EUID != 0)); then
      if ! command -v sudo >/dev/null; then
        fail "missing packages, and neither root nor sudo to install them. Run as root:
  apt-get install ${required[*]} ${optional[*]}"
      fi
      as_root=(sudo)
      # Without a terminal no password can be typed, so fail at once.
      if [[ ! -t 0 ]]; then as_root+=(-n); fi
    fi
    as_root+=(env DEBIAN_FRONTEND=noninteractive apt-get -o DPkg::Lock::Timeout=300)
    "${as_root[@]}" -qq update </dev/null || echo "apt-get update failed; trying what it knows" >&2
    choose_packages "${missing[@]}"
    install=("${as_root[@]}" -qq -y --no-install-recommends install)
    if ((${#required[@]} + ${#optional[@]} > 0)); then
      echo "Installing ${required[*]} ${optional[*]}"
    fi
    if ! "${install[@]}" "${required[@]}" "${optional[@]}" </dev/null; then
      # One optional package, whose dependencies may be missing, must not prevent the others.
      if ((${#optional[@]} == 0)) || ! "${install[@]}" "${required[@]}" </dev/null; then
        fail "could not install ${required[*]}"
      fi
      for package in "${optional[@]}"; do
        "${install[@]}" "$package" </dev/null || absent+=("$package")
      done
    fi
  fi
  if ((${#absent[@]} > 0)); then
    echo "Going on without optional packages that cannot be installed here: ${absent[*]}" >&2
  fi
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

# Builds what `cmake --install` needs, as a release build in build/: the program and the library,
# which is an archive of the same objects.
build_release() {
  install_packages "${packages[@]}"
  configure build -DCMAKE_BUILD_TYPE=Release -DESES_BUILD_TESTS=OFF
  build build eses-blocks eses
}
