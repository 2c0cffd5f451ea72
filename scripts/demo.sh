#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs the dependencies, builds MEbots and runs the easy gate mission. Its page and pictures are in
# results/gate_easy.
set -euo pipefail
cd "$(dirname "$0")/.."

scripts/setup.sh
cmake --preset release
cmake --build --preset release
build/release/bin/mebots run configs/gate_easy.json --out results/gate_easy
build/release/bin/mebots report results/gate_easy
.venv/bin/python scripts/plot_mission.py results/gate_easy
