#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes each call that writes a file of a run, a page or a study fail, one call after the other. The faults are a full
# disk, a failing disk, an interrupted call and a short write. A fault affects one call, or that call and all later
# ones. Prints a table of the outcomes, and exits with 1 if a fault did not end as docs/exploration.md requires.
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
