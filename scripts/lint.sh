#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs clang-tidy with the rules of .clang-tidy over all C++ sources, tests and benchmarks included, of a folder that was configured and
# built by a preset with unity builds. Most of clang-tidy's time is spent in library headers, so sources that share them are checked
# together. clang-tidy comes from PyPI: Debian's also checks library headers, which takes four times as long. The build folder is GCC's;
# clang-tidy does not support all of GCC's warnings. Usage: scripts/lint.sh [BUILD_DIR]
set -euo pipefail
cd "$(dirname "$0")/.."
build=${1:-build/ci}
log=$build/lint.log
count=$(grep -cE '"file": .*/Unity/.*_cxx.cxx' "$build/compile_commands.json") \
  || { echo "$build has no unity sources: configure it with cmake --preset ci" >&2; exit 1; }

lint() {  # arguments: pattern of the folders; further options
  local folders=$1
  shift
  .venv/bin/python .venv/bin/run-clang-tidy.py -clang-tidy-binary .venv/bin/clang-tidy -p "$build" -quiet \
    -extra-arg=-Wno-unknown-warning-option -extra-arg=-Wno-deprecated-declarations -j "$(nproc)" "$@" \
    "/$(basename "$build")/$folders/.*/Unity/.*cxx$" >> "$log" 2>&1
}

# Tests start other programs, check that code throws, repeat their random numbers, count in whole pixels and ticks, and need not be fast.
in_tests=-bugprone-command-processor,-bugprone-empty-catch,-bugprone-implicit-widening-of-multiplication-result
in_tests+=,-bugprone-derived-method-shadowing-base-method,-bugprone-reserved-identifier,-bugprone-integer-division
in_tests+=,-bugprone-unchecked-string-to-number-conversion,-bugprone-random-generator-seed,-bugprone-float-loop-counter
in_tests+=,-clang-analyzer-security.FloatLoopCounter,-performance-*,-readability-redundant-declaration

: > "$log"
failed=0
lint '(modeldesc|fmu_[a-z]+|master)' || failed=1
lint '(tests|bench|examples)' -checks="$in_tests" || failed=1
if ((failed)); then
  grep -E 'error:|warning:' "$log" | sort -u >&2
  echo "clang-tidy found problems: see $log" >&2
  exit 1
fi
echo "clang-tidy: nothing to say about $count groups of sources"
