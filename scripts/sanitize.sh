#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds with sanitizers and runs all tests under them, whole missions included.
# Usage: scripts/sanitize.sh [PRESET...]    (asan-ubsan: address and undefined behaviour; then tsan: threads)
set -euo pipefail
cd "$(dirname "$0")/.."

presets=("$@")
if ((!${#presets[@]})); then presets=(asan-ubsan tsan); fi
scripts/setup.sh
for preset in "${presets[@]}"; do
  cmake --preset "$preset"
  cmake --build --preset "$preset"
  ctest --preset "$preset" -j "$(nproc)"
done
