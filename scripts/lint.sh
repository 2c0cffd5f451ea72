#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs clang-tidy with the rules of .clang-tidy over the sources of a configured build folder.
# The build folder is GCC's; clang-tidy does not know all of GCC's warnings.
# Usage: scripts/lint.sh [BUILD_DIR]
set -euo pipefail
cd "$(dirname "$0")/.."
build=${1:-build/ci}
run-clang-tidy-14 -p "$build" -quiet -extra-arg=-Wno-unknown-warning-option -j "$(nproc)" "$PWD/(modeldesc|fmu_[a-z]+|master)/.*\.cpp$" > "$build/lint.log" 2>&1 \
  || { grep -E 'error:|warning:' "$build/lint.log" | sort -u >&2; echo "clang-tidy found problems: see $build/lint.log" >&2; exit 1; }
echo "clang-tidy: nothing to say"
