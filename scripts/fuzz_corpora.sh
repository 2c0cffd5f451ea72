#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Manages the stored inputs of a fuzz target. They are in the archive tests/fuzz/corpus/NAME.tar.xz, and ctest replays
# them.
#   scripts/fuzz_corpora.sh list NAME              lists its content
#   scripts/fuzz_corpora.sh unpack NAME FOLDER
#   scripts/fuzz_corpora.sh add NAME FILE...       adds inputs, by their file names
# Equal inputs give equal archives: order, times and owners are fixed.
set -euo pipefail
usage="usage: scripts/fuzz_corpora.sh list|unpack|add NAME [FOLDER|FILE...]"
command=${1:?$usage} name=${2:?$usage}
shift 2
archive=$(dirname "$0")/../tests/fuzz/corpus/$name.tar.xz
pack() { tar --create --sort=name --mtime=@0 --owner=0 --group=0 --numeric-owner --mode=u=rwX,go=rX --directory "$1" . | xz -9e >"$archive"; }

case "$command" in
  list) tar --list --file "$archive" ;;
  unpack)
    mkdir -p "${1:?$usage}"
    tar --extract --file "$archive" --directory "$1"
    ;;
  add)
    (($#)) || { echo "$usage" >&2; exit 2; }
    folder=$(mktemp -d)
    trap 'rm -rf "$folder"' EXIT
    if [[ -f $archive ]]; then tar --extract --file "$archive" --directory "$folder"; fi
    cp -- "$@" "$folder"
    pack "$folder"
    ;;
  *) echo "$usage" >&2; exit 2 ;;
esac
