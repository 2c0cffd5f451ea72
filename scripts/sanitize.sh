#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds with sanitizers and runs all tests that support them, including whole missions. Prints a table of tests by
# area, and lists the omitted tests with the reasons. The exit code is 1 if a test fails. Usage: scripts/sanitize.sh
# [PRESET...] [-- CTEST_OPTION...]
#   PRESET        asan-ubsan (address and undefined behaviour), tsan (threads); default: both, one after the other
#   CTEST_OPTION  to run a part of the tests: -R Battery
set -euo pipefail
cd "$(dirname "$0")/.."

presets=()
while (($#)) && [[ $1 != -- ]]; do presets+=("$1"); shift; done
if (($#)); then shift; fi
if ((!${#presets[@]})); then presets=(asan-ubsan tsan); fi
scripts/setup.sh
result=0
for preset in "${presets[@]}"; do
  cmake --preset "$preset"
  cmake --build --preset "$preset"
  ctest --preset "$preset" -j "$(nproc)" --output-junit "$PWD/build/$preset/tests.xml" "$@" || result=1
  python3 scripts/test_table.py "build/$preset" "build/$preset/tests.xml"
done
cat <<'END'

Left out with sanitizers, since what they would test is not ours or is the sanitizer's own:
  tests/interop, examples, casestudy   other tools and Python load FMUs and libraries, which need the sanitizer loaded first
  tests/install                        what is installed is a release build
  master/python                        the same: Python would have to be started with the sanitizer
  Page.McapFileAgreesWithTheResults, Page.FilmShowsTheFlight
                                       need the Python package, which is not built then
  Isolation.TheTableOfFmusThatMisbehaveIsTrue, Check.HasNothingToSayAbout_*
                                       crashes, memory and descriptors of the process are the sanitizer's
Tests of crashes, heap and mappings inside other suites skip themselves: they are in the column `skipped`.
END
exit $result
