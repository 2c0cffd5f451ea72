#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs every FMU below a folder through `mebots check`, `mebots run`, `mebots run --isolate`, and FMPy. Fetch the FMUs
# first. Prints a Markdown table of outcomes and of the largest differences at equal times (docs/interop.md). The exit
# code is 1 if a difference has no known cause.
# Usage: scripts/corpus.sh FOLDER [BUILD_FOLDER] [--json FILE] [--jobs N] [--match TEXT]    (build/release)
set -euo pipefail
cd "$(dirname "$0")/.."
if [[ $# -lt 1 || $1 == --* ]]; then
  echo "usage: scripts/corpus.sh FOLDER [BUILD_FOLDER] [--json FILE] [--jobs N] [--match TEXT]" >&2
  exit 2
fi
folder=$1; shift
build=build/release
if [[ $# -gt 0 && $1 != --* ]]; then build=$1; shift; fi
if [[ ! -x $build/bin/mebots ]]; then
  echo "corpus.sh: there is no $build/bin/mebots; build it, or name another build folder" >&2
  exit 2
fi
exec .venv/bin/python tests/interop/corpus.py "$folder" "$build/bin/mebots" "$@"
