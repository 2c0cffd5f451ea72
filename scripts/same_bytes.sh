#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds FMUs from a copy of the sources in another folder without a compiler cache. Compares them byte for byte with
# the FMUs of a build folder, and prints the entries that differ. The exit code is 1 if an FMU differs. Usage:
# scripts/same_bytes.sh [BUILD_FOLDER] [FMU...] (build/release; all four)
set -euo pipefail
cd "$(dirname "$0")/.."
build=${1:-build/release}
shift $(($# < 1 ? $# : 1))
fmus=("$@")
if [[ ${#fmus[@]} -eq 0 ]]; then fmus=(fmu_motors fmu_battery fmu_world fmu_soc); fi
for fmu in "${fmus[@]}"; do
  [[ -f $build/fmus/$fmu.fmu ]] || { echo "same_bytes.sh: there is no $build/fmus/$fmu.fmu; build it" >&2; exit 2; }
done
place=$(mktemp -d "${TMPDIR:-/tmp}/mebots-same-bytes-XXXXXX")
trap 'rm -rf "$place"' EXIT
mkdir "$place/a copy"
git ls-files -z | xargs -0 cp --parents -t "$place/a copy"
# Copies the settings that affect code from the existing build.
settings=()
while IFS= read -r line; do settings+=("-D$line"); done < <(grep -E '^(CMAKE_BUILD_TYPE|CMAKE_CXX_COMPILER|CMAKE_UNITY_BUILD|CMAKE_UNITY_BUILD_BATCH_SIZE|MEBOTS_ASSERTIONS|MEBOTS_WARNINGS_AS_ERRORS):' "$build/CMakeCache.txt")
export CCACHE_DISABLE=1
cmake -S "$place/a copy" -B "$place/another build" -G Ninja "${settings[@]}" -DMEBOTS_TESTS=OFF -DMEBOTS_PYTHON=OFF -DMEBOTS_PAGES=OFF > "$place/configure.log" ||
  { cat "$place/configure.log" >&2; exit 2; }
ninja -C "$place/another build" "${fmus[@]/%/_archive}" > "$place/build.log" || { tail -30 "$place/build.log" >&2; exit 2; }
result=0
for fmu in "${fmus[@]}"; do
  here=$build/fmus/$fmu.fmu there="$place/another build/fmus/$fmu.fmu"
  if cmp -s "$here" "$there"; then
    echo "$fmu: the same $(stat -c %s "$here") bytes"
    continue
  fi
  result=1
  mkdir -p "$place/here/$fmu" "$place/there/$fmu"
  unzip -qo "$here" -d "$place/here/$fmu"
  unzip -qo "$there" -d "$place/there/$fmu"
  echo "$fmu: differs"
  (cd "$place" && diff -rq "here/$fmu" "there/$fmu") || true
done
exit $result
