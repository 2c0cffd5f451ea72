#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
#
# Compares the SoC's instruction set with independent references for many random instructions: the standard part with
# QEMU, Xpulp v2 with a second description of its instructions (tests/soc/lockstep, tests/soc/xpulp). Prints the counts.
#
#   scripts/lockstep.sh [INSTRUCTIONS] [BUILD_FOLDER]     (default 10 million, build/ci)
set -euo pipefail
cd "$(dirname "$0")/.."
instructions=${1:-10000000}
build=${2:-build/ci}
cmake --build "$build" --target soc_lockstep_test soc_xpulp_test
export MEBOTS_LOCKSTEP_INSTRUCTIONS=$instructions
"$build/bin/soc_lockstep_test"
"$build/bin/soc_xpulp_test" --gtest_filter='Xpulp.Random*:Xpulp.Encodings*'
