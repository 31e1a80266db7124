# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by the other scripts: where things are, stages that log and show progress, packages and stamps.
# shellcheck shell=bash disable=SC2034

set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"
venv=$root/build/venv
python=$venv/bin/python
logs=$root/build/logs
constraints=scripts/constraints.txt # versions of packages of Python
mkdir -p "$logs"
# The distribution's compiler, CMake and Python come before any other on the caller's PATH.
export PATH="$venv/bin:/usr/bin:/bin:/usr/sbin:/sbin:$PATH"
export LC_ALL=C.UTF-8
unset PYTHONPATH PYTHONHOME
unset PYTHONDONTWRITEBYTECODE # compiling the add-on takes a quarter of a start of Blender, and tests start it often

fail() {
  printf 'error: %s\n' "$*" >&2
  exit 1
}

# Shows the last line of a log in place, once a second, while a stage runs in a terminal.
ticker() {
  while sleep 1; do
    printf '\r\033[K   %4d s  %.60s' "$SECONDS" "$(tail -n 1 "$1" | tr -d '\r\033')"
  done
}

# stage NAME COMMAND...: runs the command into build/logs/NAME.log; on failure shows the log's end.
stage() {
  local name=$1 log=$logs/${1// /-}.log pid='' rc=0
  shift
  SECONDS=0
  printf '== %s\n' "$name"
  : >"$log"
  if [ -t 1 ]; then
    ticker "$log" &
    pid=$!
  fi
  "$@" >"$log" 2>&1 </dev/null || rc=$?
  if [ -n "$pid" ]; then
    kill "$pid"
    wait "$pid" 2>/dev/null || true
    printf '\r\033[K'
  fi
  if [ "$rc" -ne 0 ]; then
    tail -n 40 "$log" >&2
    printf 'error: "%s" failed (exit status %d); the whole log: %s\n' "$name" "$rc" "${log#"$root"/}" >&2
    return "$rc"
  fi
  printf '   done in %d s\n' "$SECONDS"
}

# The values of /etc/os-release as one word, such as debian-12.
system_name() {
  # shellcheck source=/dev/null
  (. /etc/os-release 2>/dev/null && printf '%s-%s' "${ID:-unknown}" "${VERSION_ID:-}") || printf unknown
}

# One job for each core, fewer where memory is short: a file that includes CGAL takes about 1.5 GB.
build_jobs() {
  local cores gigabytes
  cores=$(nproc)
  gigabytes=$(awk '/MemAvailable/ {print int($2 / 1572864)}' /proc/meminfo)
  [ "$gigabytes" -ge 1 ] || gigabytes=1
  printf '%d' "$((cores < gigabytes ? cores : gigabytes))"
}

# Waits for another package manager that may be at work.
apt() { "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=300 "$@"; }
install_packages() { apt update && apt install -y --no-install-recommends "$@"; }

# Where this system's own packages come from.
debian_mirror() {
  # shellcheck disable=SC2016  # the variable is apt's
  apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' 'Label: Debian' | sort -u | head -n 1
}

# need_packages NAME...: installs those of the distribution's packages that are missing.
need_packages() {
  local missing=() sudo=()
  mapfile -t missing < <(comm -23 <(printf '%s\n' "$@" | sort) \
    <(dpkg-query -W -f '${db:Status-Status} ${Package}\n' | sed -n 's/^installed //p' | sort))
  [ "${#missing[@]}" -gt 0 ] || return 0
  echo "   missing packages: ${missing[*]}"
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || fail 'they can be installed by root or with sudo only'
    sudo=(sudo)
  fi
  stage 'system packages' install_packages "${missing[@]}"
}

# The compiler of the presets that instrument code: several times faster at it than GCC, and with a fuzzing engine.
clang=19
# configure_with_clang PRESET: unless that was done before.
configure_with_clang() {
  need_packages "clang-$clang" "libclang-rt-$clang-dev" "llvm-$clang"
  PATH+=:/usr/lib/llvm-$clang/bin # where sanitizers look for what finds names and lines
  ! grep -qs "^CMAKE_CXX_COMPILER:.*clang++-$clang$" "build/$1/CMakeCache.txt" || return 0
  stage "configure $1" cmake --fresh --preset "$1"
}

# What the bpy wheel needs; the last three are for the Workbench engine without a display.
bpy_packages=(libx11-6 libxrender1 libxfixes3 libxi6 libxkbcommon0 libsm6 libgl1 libegl1 libegl-mesa0 libgl1-mesa-dri)

# pip_install PYTHON ARGUMENT...: with every version as the constraints say, also those that others bring with them.
pip_install() {
  local python=$1
  shift
  "$python" -m pip install --no-input -c "$constraints" "$@"
}

# numpy_of PYTHON: the version of numpy that is pinned for 3.11 or 3.13.
numpy_of() {
  local compared='<'
  [ "$1" = 3.11 ] || compared='>='
  sed -n "s/^numpy==\([0-9.]*\); python_version $compared .*/\1/p" scripts/requirements.txt
}
# numpy_types PYTHON: where scripts/setup.sh leaves the sources of that numpy, which mypy reads types from.
numpy_types() { printf '%s/build/types/numpy-%s' "$root" "$(numpy_of "$1")"; }

# A stamp file holds the hash of all that went into what it stands beside.
hash_of() { printf '%s\n' "$@" | sha256sum | cut -d ' ' -f 1; }
up_to_date() { [ -f "$1" ] && [ "$(<"$1")" = "$2" ]; }
