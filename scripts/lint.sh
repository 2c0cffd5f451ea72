#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs clang-tidy with the rules of .clang-tidy over the sources of a folder that a preset with unity builds configured:
# most of clang-tidy's time goes into library headers, so sources that share them are looked at in one go.
# The build folder is GCC's; clang-tidy does not know all of GCC's warnings.
# Usage: scripts/lint.sh [BUILD_DIR]
set -euo pipefail
cd "$(dirname "$0")/.."
build=${1:-build/ci}
log=$build/lint.log
ours="/$(basename "$build")/(modeldesc|fmu_[a-z]+|master)/.*/Unity/"
count=$(grep -cE "\"file\": .*$ours" "$build/compile_commands.json") \
  || { echo "$build has no unity sources: configure it with cmake --preset ci" >&2; exit 1; }
run-clang-tidy-14 -p "$build" -quiet -header-filter="$PWD/(modeldesc|fmu_[a-z]+|master)/.*" \
  -extra-arg=-Wno-unknown-warning-option -j "$(nproc)" "$ours" > "$log" 2>&1 \
  || { grep -E 'error:|warning:' "$log" | sort -u >&2; echo "clang-tidy found problems: see $log" >&2; exit 1; }
echo "clang-tidy: nothing to say about $count files of sources"
