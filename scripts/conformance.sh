#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Tests the chip's instruction set with suites from checkouts in FOLDER: riscv-tests, riscv-arch-test with Spike's
# results, Embench-IoT, and CoreMark with Spike's count of instructions. Prints a page (docs/conformance.md). The exit
# code is 1 if a difference has no known cause, and 2 if a suite or program is missing. Takes about two minutes on two
# cores.
#
#   scripts/setup.sh bench                      Spike, once
#   git clone --recursive https://github.com/riscv-software-src/riscv-tests FOLDER/riscv-tests
#   git clone https://github.com/riscv-non-isa/riscv-arch-test FOLDER/riscv-arch-test
#   git clone https://github.com/embench/embench-iot FOLDER/embench-iot
#   git clone https://github.com/eembc/coremark FOLDER/coremark
#   scripts/conformance.sh FOLDER [BUILD_FOLDER] [--out FILE] [--jobs N]    (build/release)
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
if [[ $# -lt 1 || $1 == --* ]]; then
  echo "usage: scripts/conformance.sh FOLDER [BUILD_FOLDER] [--out FILE] [--jobs N]" >&2
  exit 2
fi
folder=$1; shift
build=$root/build/release
if [[ $# -gt 0 && $1 != --* ]]; then build=$1; shift; fi
if [[ ! -x $build/bin/mebots-soc ]]; then
  echo "conformance.sh: there is no $build/bin/mebots-soc; build it, or name another build folder" >&2
  exit 2
fi
exec "$root/.venv/bin/python" "$root/tests/conformance/conformance.py" "$folder" "$build/bin/mebots-soc" "$@"
