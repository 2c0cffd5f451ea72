#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# 10000 instances that come and go, and 500 archives that are opened and closed, without growth: the tests Scale.* in full length.
# Usage: scripts/scale.sh [BUILD_FOLDER]    (build/ci)
set -euo pipefail
cd "$(dirname "$0")/.."
MEBOTS_CYCLES=10000 "${1:-build/ci}/bin/master_test" --gtest_filter='Scale.*'
