#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs the dependencies, builds MEbots with warnings as errors, checks format and English, and runs all tests.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh
scripts/format.sh --check
scripts/prose_lint.py
cmake --preset ci
cmake --build --preset ci
ctest --preset ci -j "$(nproc)"
