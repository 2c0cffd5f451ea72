#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs a build, moves the installation, and copies the tests' files next to it. Usage: set_up.sh SOURCES BUILD WORK
set -euo pipefail
sources=$1 build=$2 work=$3
rm -rf "$work"
mkdir -p "$work/needed/descriptions"
cmake --install "$build" --prefix "$work/first" >"$work/install.log"
mv "$work/first" "$work/mebots"

cp "$sources"/tests/install/*.sh "$sources/tests/examples/python_test.py" "$work/needed"
cp -r "$sources/examples/drive_from_cpp" "$work/needed"
cp "$sources/examples/motor_thermal/fmu/description.json" "$work/needed/descriptions/motor_thermal.json"
cp "$sources/tests/fmus/lag/description.json" "$work/needed/descriptions/lag.json"
