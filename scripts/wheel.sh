#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes the Python package's wheel in build/wheels, installs it into a fresh environment and runs an ensemble there.
# Takes scikit-build-core, pybind11 and NumPy from PyPI. Usage: scripts/wheel.sh [BUILD_FOLDER]   (build/release, for the FMUs)
set -euo pipefail
cd "$(dirname "$0")/.."
build=${1:-build/release}
rm -rf build/wheels build/wheel-venv
/usr/bin/python3 -m venv build/wheel-venv
build/wheel-venv/bin/pip wheel --quiet --disable-pip-version-check --no-deps -w build/wheels .
build/wheel-venv/bin/pip install --quiet --disable-pip-version-check build/wheels/mebots-*.whl
build/wheel-venv/bin/python tests/examples/python_test.py "$build/fmus"
ls build/wheels
