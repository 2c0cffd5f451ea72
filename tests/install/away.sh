#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs a script of this folder in an empty folder, with the installed programs in PATH. Empty folders in a separate
# mount namespace hide sources and build. If the machine does not permit a namespace, they stay visible. Usage: away.sh
# SOURCES BUILD WORK SCRIPT
set -euo pipefail
sources=$1 build=$2 work=$3 script=$4
place=$(mktemp -d "${TMPDIR:-/tmp}/mebots away XXXXXX")
trap 'rm -rf "$place"' EXIT
mkdir "$place/run"
cp -r "$work/needed" "$work/mebots" "$place"
export MEBOTS="$place/mebots" NEEDED="$place/needed" PATH="$place/mebots/bin:$PATH" SOURCES=$sources BUILD=$build
export PYTHON=$sources/.venv/bin/python CCACHE_DIR="${CCACHE_DIR:-$(ccache --get-config cache_dir 2>/dev/null || true)}"
[[ -x $PYTHON ]] || PYTHON=$(command -v python3)
cd "$place/run"

hide='
set -e
mkdir -p "$NEEDED/venv"
if [[ -d $SOURCES/.venv ]]; then
  mount --bind "$(realpath "$SOURCES/.venv")" "$NEEDED/venv"
  export PYTHON=$NEEDED/venv/bin/python
fi
mount -t tmpfs none "$BUILD"
mount -t tmpfs none "$SOURCES"
exec bash "$NEEDED/$1"
'
if unshare --user --map-root-user --mount true 2>/dev/null; then
  unshare --user --map-root-user --mount bash -c "$hide" hide "$script"
else
  echo "note: no mount namespace here; sources and build stay visible"
  bash "$NEEDED/$script"
fi
