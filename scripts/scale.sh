#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs the tests Scale.* in full length. 1000 instances run at once. Without growth of memory, 10000 instances are
# created and freed, 500 archives are opened and closed, and 200 runs use separate processes. Uses the cheapest FMU and
# each FMU of MEbots. Usage: scripts/scale.sh [BUILD_FOLDER] (build/ci)
set -euo pipefail
cd "$(dirname "$0")/.."
build=${1:-build/ci}
# Turns off the allocator's cache per thread (tcache), whose memory the allocator counts as used.
export GLIBC_TUNABLES=glibc.malloc.tcache_count=0
run() {
  MEBOTS_CYCLES=10000 "$build/bin/master_test" --gtest_brief=1 --gtest_filter="$1" | grep -v '^Running main'
}
run 'Scale.*'
for fmu in "$build"/fmus/fmu_{battery,motors,soc,world}.fmu; do  # without fmu_gap8, which contains no program
  echo "$(basename "$fmu"):"
  MEBOTS_CYCLED_FMU=$(realpath "$fmu") run 'Scale.InstancesRelease*:Scale.ClosedArchives*'
done
