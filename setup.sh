#!/usr/bin/env bash
# Sets up everything that tridisk needs, then does one of two things:
#
#   ./setup.sh run [SCENE] [OPTIONS]   builds tridisk, runs a scene (the minimum-mass disk unless one is named) and draws its pictures
#   ./setup.sh test                    builds tridisk and passes all tests
#
# Needs Rust (cargo), a C compiler and, for the tests, Python 3. The HDF5 library is installed with the system's package manager where it
# is missing; Python packages go to .venv, which git ignores.
set -euo pipefail
cd "$(dirname "$0")"

say() { printf 'setup: %s\n' "$*" >&2; }
die() { say "$*"; exit 1; }

# Runs a command as root, if there is a way to.
as_root() {
  if [ "$(id -u)" = 0 ]; then "$@"
  elif command -v sudo >/dev/null; then sudo "$@"
  else return 1
  fi
}

# install COMMAND-OF-MANAGER PACKAGE for the first package manager that this machine has.
install() { # apt dnf pacman zypper brew
  if command -v apt-get >/dev/null; then
    as_root apt-get install -y -q "$1" >&2 || { as_root apt-get update -q >&2 && as_root apt-get install -y -q "$1" >&2; }
  elif command -v dnf >/dev/null; then as_root dnf install -y "$2" >&2
  elif command -v pacman >/dev/null; then as_root pacman -S --noconfirm "$3" >&2
  elif command -v zypper >/dev/null; then as_root zypper install -y "$4" >&2
  elif command -v brew >/dev/null; then brew install "$5" >&2
  else return 1
  fi
}

have_hdf5() {
  [ -n "${HDF5_DIR:-}" ] && return 0
  for name in hdf5 hdf5-serial; do
    if command -v pkg-config >/dev/null && pkg-config --exists "$name"; then return 0; fi
  done
  for header in /usr/include/hdf5.h /usr/include/hdf5/serial/hdf5.h /usr/local/include/hdf5.h; do
    [ -e "$header" ] && return 0
  done
  command -v brew >/dev/null && brew --prefix hdf5 >/dev/null 2>&1
}

need_build() {
  command -v cargo >/dev/null || die "Rust is missing: install it from https://rustup.rs, then call this again"
  command -v cc >/dev/null || command -v gcc >/dev/null ||
    install gcc gcc gcc gcc gcc || die "a C compiler is missing: install gcc or clang, then call this again"
  if ! have_hdf5; then
    say "installing the HDF5 library"
    install libhdf5-dev hdf5-devel hdf5 hdf5-devel hdf5 ||
      die "the HDF5 library is missing: install libhdf5-dev (Debian, Ubuntu), hdf5-devel (Fedora, openSUSE) or hdf5 (Arch, Homebrew), then call this again"
  fi
}

need_valgrind() {
  command -v valgrind >/dev/null && return 0
  say "installing valgrind, which counts instructions"
  install valgrind valgrind valgrind valgrind valgrind ||
    die "valgrind is missing: install the package of that name, then call this again"
}

need_python() {
  command -v python3 >/dev/null || die "Python 3 is missing: install it, then call this again"
  if [ ! -x .venv/bin/python ]; then
    say "making the Python environment .venv"
    python3 -m venv .venv 2>/dev/null || { install python3-venv python3 python python3 python && python3 -m venv --clear .venv; } ||
      die "python3 -m venv does not work: install python3-venv, then call this again"
  fi
  local wanted=tests/rebound/requirements.txt
  if ! cmp -s "$wanted" .venv/installed.txt; then
    say "installing rebound, h5py and the other Python packages of the tests"
    .venv/bin/python -m pip install -q --disable-pip-version-check -r "$wanted" || die "pip could not install $wanted"
    cp "$wanted" .venv/installed.txt
  fi
}

case "${1:-}" in
  run)
    shift
    need_build
    scene=scenarios/coupled/minimum-mass-disk.toml
    case "${1:-}" in *.toml) scene=$1; shift ;; esac
    cargo build --release --package tridisk
    tridisk=${CARGO_TARGET_DIR:-target}/release/tridisk
    "$tridisk" run "$scene" "$@"
    folder=runs/$(basename "$scene" .toml)
    case " $* " in *" --output "*) ;; *) "$tridisk" plot "$folder" ;; esac
    ;;
  test)
    need_build
    need_valgrind
    need_python
    cargo test --release --workspace --no-fail-fast
    .venv/bin/python -m pytest -q tests/rebound
    ;;
  *)
    sed -n '2,9s/^# \{0,1\}//p' "$0" >&2
    exit 2
    ;;
esac
