#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs clang-tidy with the rules of .clang-tidy over the sources of a configured build folder, several
# sources of a folder at a time (so names of their anonymous namespaces must differ).
# The build folder is GCC's; clang-tidy does not know all of GCC's warnings.
# Usage: scripts/lint.sh [BUILD_DIR]
set -euo pipefail
cd "$(dirname "$0")/.."
build=${1:-build/ci}
batches=$build/lint
log=$build/lint.log
scripts/lint_batches.py "$build" "$batches"
run-clang-tidy-14 -p "$batches" -quiet -checks=-bugprone-suspicious-include \
  -header-filter="$PWD/(modeldesc|fmu_[a-z]+|master)/.*" -extra-arg=-Wno-unknown-warning-option -j "$(nproc)" > "$log" 2>&1 \
  || { grep -E 'error:|warning:' "$log" | sort -u >&2; echo "clang-tidy found problems: see $log" >&2; exit 1; }
echo "clang-tidy: nothing to say"
