#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Runs random programs on the SoC's cluster. Each program runs in all ways that must give the same bits
# (tests/soc/cluster_random_test). CI runs fewer programs. Stops at the first difference.
#
#   scripts/random_cluster.sh [PROGRAMS] [FIRST] [BUILD_FOLDER]     (default 1000 from 1, build/ci)
set -euo pipefail
cd "$(dirname "$0")/.."
build=${3:-build/ci}
cmake --build "$build" --target soc_cluster_random_test
export MEBOTS_CLUSTER_PROGRAMS=${1:-1000} MEBOTS_CLUSTER_FIRST=${2:-1}
"$build/bin/soc_cluster_random_test"
