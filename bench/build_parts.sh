#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Measures the cost of configuring and building each part: wall and processor seconds without a compiler cache, in a
# temporary folder. The first row is the core alone. Each other row is the core with one part. Usage:
# bench/build_parts.sh [PART...], where PART is core, chip, world, python, pages, tests or all
set -euo pipefail
cd "$(dirname "$0")/.."
export CCACHE_DISABLE=1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

declare -A options=(
  [core]="" [chip]="CHIP" [world]="WORLD" [python]="PYTHON" [pages]="PAGES" [tests]="TESTS" [all]="CHIP WORLD PYTHON PAGES TESTS"
)
parts=("$@")
((${#parts[@]})) || parts=(core chip world python pages tests all)

measured() {  # prints wall and processor seconds of a command; writes its output to $folder/log
  local TIMEFORMAT='%R %U %S'
  { time "$@" > "$folder/log" 2>&1; } 2>&1 | awk '{ printf "%7.1f s %7.1f s", $1, $2 + $3 }' \
    || { tail -20 "$folder/log" >&2; exit 1; }
}

printf '%-8s %-19s %-19s\n' part 'configure (cpu)' 'build (cpu)'
for part in "${parts[@]}"; do
  [[ -v options[$part] ]] || { echo "build_parts.sh: no part \"$part\"; known: core chip world python pages tests all" >&2; exit 2; }
  arguments=()
  for option in CHIP WORLD PYTHON PAGES TESTS; do
    if [[ " ${options[$part]} " == *" $option "* ]]; then arguments+=("-DMEBOTS_$option=ON"); else arguments+=("-DMEBOTS_$option=OFF"); fi
  done
  build=$folder/$part
  printf '%-8s ' "$part"
  measured cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_UNITY_BUILD=ON -DCMAKE_UNITY_BUILD_BATCH_SIZE=12 "${arguments[@]}"
  printf ' '
  measured cmake --build "$build" -j "$(nproc)"
  printf '\n'
  rm -rf "$build"
done
