# SPDX-License-Identifier: GPL-3.0-or-later
# Sourced by package.sh and release.sh after common.sh: the assets, and the zip that Blender installs from disk.
# shellcheck shell=bash disable=SC2154

# Blender's own tool for extensions, of the bpy in build/venv.
blender_ext() {
  "$python" "$venv"/lib/python3*/site-packages/bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py "$@"
}

# build_assets FILE SETTINGS: the node groups and ready scatters; SETTINGS is a folder for Blender's own.
# Blender reads files of newer versions badly or not at all: the oldest one here writes. A Python that has imported bpy
# hands its children OCIO, the colors of a newer Blender.
build_assets() {
  local command=("$python" scripts/assets.py)
  [ "$(system_name)" != debian-13 ] ||
    command=(blender --background --factory-startup --python-exit-code 1 --python scripts/assets.py)
  BLENDER_USER_RESOURCES=$2 env -u OCIO timeout --kill-after=10 300 "${command[@]}" -- "$1"
}

# build_extension FOLDER ZIP PLATFORM VERSION ASSETS WHEEL...: FOLDER becomes what is in the zip.
build_extension() {
  local folder=$1 zip=$2 built=$1.zip
  shift 2
  "$python" scripts/package.py extension "$folder" "$@" &&
    blender_ext build --source-dir="$folder" --output-filepath="$built" &&
    "$python" scripts/package.py settle "$built" "$zip" &&
    rm "$built" &&
    blender_ext validate "$zip"
}
