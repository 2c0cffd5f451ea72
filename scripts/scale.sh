#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# 1000 instances in one run; then, without growth: 10000 instances that come and go, 500 archives that are opened and
# closed, 200 runs in processes of their own; with the cheapest FMU and with each of ours. The tests Scale.* in full length.
# Usage: scripts/scale.sh [BUILD_FOLDER]    (build/ci)
set -euo pipefail
cd "$(dirname "$0")/.."
build=${1:-build/ci}
# What a thread frees it keeps at hand for itself (tcache), and the allocator counts that as in use: without, every byte counts.
export GLIBC_TUNABLES=glibc.malloc.tcache_count=0
run() {
  MEBOTS_CYCLES=10000 "$build/bin/master_test" --gtest_brief=1 --gtest_filter="$1" | grep -v '^Running main'
}
run 'Scale.*'
for fmu in "$build"/fmus/fmu_{battery,motors,soc,world}.fmu; do  # fmu_gap8 has no program inside
  echo "$(basename "$fmu"):"
  MEBOTS_CYCLED_FMU=$(realpath "$fmu") run 'Scale.InstancesThatComeAndGo*:Scale.ArchivesThat*'
done
