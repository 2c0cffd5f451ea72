#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Fuzzes one reader of files with libFuzzer, address and undefined-behaviour sanitizers (clang 14), on one core.
# Usage: scripts/fuzz.sh NAME [EXECUTIONS]      NAME: a mebots_fuzz() of tests/fuzz/CMakeLists.txt (elf, board, ...)
# Starts from tests/fuzz/corpus/NAME, collects in build/fuzz/corpus/NAME, prints statistics. An input that does harm
# is left in build/fuzz/found/NAME: mend the code, then keep the input in tests/fuzz/corpus/NAME, where ctest replays it.
set -euo pipefail
cd "$(dirname "$0")/.."
name=${1:?usage: scripts/fuzz.sh NAME [EXECUTIONS]}
executions=${2:-1000000}
build=build/fuzz

cmake -S . -B "$build" -G Ninja -DMEBOTS_FUZZ=ON -DCMAKE_BUILD_TYPE=RelWithDebInfo -DCMAKE_CXX_COMPILER=clang++-14 > /dev/null
ninja -C "$build" "fuzz_$name" > "$build/$name.log" || { tail -30 "$build/$name.log" >&2; exit 1; }
mkdir -p "$build/corpus/$name" "$build/found/$name"
dictionary=()
if [[ -f tests/fuzz/$name.dict ]]; then dictionary=(-dict="tests/fuzz/$name.dict"); fi
export ASAN_OPTIONS=detect_leaks=1:quarantine_size_mb=16
"$build/bin/fuzz_$name" -runs="$executions" -max_len=16384 -timeout=20 -rss_limit_mb=2048 -print_final_stats=1 -verbosity=1 \
  "${dictionary[@]}" -artifact_prefix="$build/found/$name/" "$build/corpus/$name" "tests/fuzz/corpus/$name"
