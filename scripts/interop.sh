#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs MEbots' FMUs and other FMUs in mebots, FMPy, OMSimulator and libcosim, alone and connected. Prints a Markdown
# table of differences from mebots' results (docs/interop.md). Searches for OMSimulator in $OMSIMULATOR and on PATH.
# Usage: scripts/interop.sh [BUILD_FOLDER] [--tool NAME] [--system NAME] (build/release)
set -euo pipefail
cd "$(dirname "$0")/.."
build=build/release
if [[ $# -gt 0 && $1 != --* ]]; then build=$1; shift; fi
cmake --build "$build" --target mebots fmu_battery_archive fmu_motors_archive fmu_world_archive fmu_soc_archive \
  motor_thermal_archive passthrough_archive probe_archive coupling_archive > /dev/null
.venv/bin/python tests/interop/compare.py "$build" "$@"
