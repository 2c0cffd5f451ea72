#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Tests faults in calls that write files of a run, a page or a study. In each test, one call fails, or this call and all
# later calls fail. The faults are a full disk, a failing disk, an interrupted call and a short write. Prints a table of
# the outcomes. The exit code is 1 if an outcome contradicts docs/exploration.md.
#
# Usage: scripts/inject_faults.sh [BUILD_FOLDER]   build/ci by default; 8 minutes on a busy machine
set -euo pipefail
cd "$(dirname "$0")/.."
build=$(realpath "${1:-build/ci}")
python=$PWD/.venv/bin/python
status=0
"$python" tests/master/io_fault_test.py "$build/bin/mebots" "$build/test_fmus/probe.fmu" --all || status=1
env MEBOTS_FAULTS=all MEBOTS_BUILD="$build" MEBOTS_SOURCE="$PWD" MEBOTS_PYTHON="$python" PYTHONPATH="$build/python" \
  "$python" tests/exploration/io_fault_test.py EachCall || status=1
exit $status
