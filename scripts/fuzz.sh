#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Fuzzes a reader of files with libFuzzer on one core, with sanitizers for addresses and undefined behaviour (clang 14).
# Usage: scripts/fuzz.sh NAME [EXECUTIONS] [OPTION...]
#   NAME        a mebots_fuzz() of tests/fuzz/CMakeLists.txt (elf, board, gdb, archive, config, ssp, ssp_folder, osp, scenario,
#               checkpoint, model_description, fmi3, description, state, cell, rotor, scene,
#               network)
#   OPTION      of libFuzzer, after those of this script: -max_len=16384, -max_total_time=3600 ...
# Starts from the stored inputs (scripts/fuzz_corpora.sh), and collects inputs in build/fuzz/corpus/NAME. Prints
# statistics, and appends them to build/fuzz/NAME.runs. Stores an input that shows an error in build/fuzz/found/NAME.
# Correct the code, then keep the input with scripts/fuzz_corpora.sh add NAME FILE, so that ctest replays it.
#
# The options result from a profile. libFuzzer's own bookkeeping takes most of the time, and grows with the features of
# inputs (therefore -entropic=0 and inputs of at most 2 KiB). The rest is the sanitizer's stack for each allocation
# (therefore malloc_context_size=1; repeat a finding with the default to see where its memory was allocated).
set -euo pipefail
cd "$(dirname "$0")/.."
name=${1:?usage: scripts/fuzz.sh NAME [EXECUTIONS] [OPTION...]}
executions=${2:-1000000}
shift $(($# < 2 ? $# : 2))
build=build/fuzz

cmake -S . -B "$build" -G Ninja -DMEBOTS_FUZZ=ON -DCMAKE_UNITY_BUILD=ON -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_COMPILER=clang++-14 > /dev/null
ninja -C "$build" "fuzz_$name" > "$build/$name.log" || { tail -30 "$build/$name.log" >&2; exit 1; }
mkdir -p "$build/corpus/$name" "$build/found/$name"
rm -rf "$build/kept/$name"
scripts/fuzz_corpora.sh unpack "$name" "$build/kept/$name"
dictionary=()
if [[ -f tests/fuzz/$name.dict ]]; then dictionary=(-dict="tests/fuzz/$name.dict"); fi
longest=2048
case $name in
  elf) longest=16384 ;;       # large enough for a program with sections
  checkpoint) longest=4096 ;; # large enough for the state of a run
  gdb) longest=512 ;;         # enough, because packets are short
esac
# Deletes longer inputs from the unpacked copy, because libFuzzer would truncate them. ctest replays them in full.
find "$build/kept/$name" -type f -size +"$longest"c -delete
# If /dev/shm exists, unpacks archives into memory.
if [[ -d /dev/shm ]]; then export TMPDIR=/dev/shm; fi
export ASAN_OPTIONS=detect_leaks=1:quarantine_size_mb=1:malloc_context_size=1
result=0
"$build/bin/fuzz_$name" -runs="$executions" -max_len=$longest -entropic=0 -timeout=20 -rss_limit_mb=2048 \
  -print_final_stats=1 "${dictionary[@]}" -artifact_prefix="$build/found/$name/" "$@" \
  "$build/corpus/$name" "$build/kept/$name" > "$build/$name.output" 2>&1 || result=$?
grep -E '^#[0-9]+.*(INITED|pulse|DONE)|^stat::|ERROR|SUMMARY|Test unit' "$build/$name.output" | tee -a "$build/$name.runs"
exit $result
