#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Generates the pictures, trains the sight network, fine-tunes it with integers, and writes weights and golden vectors.
# Takes 14 to 20 minutes of processor time on one core. Uses one thread, so that the order of sums is fixed: a second
# run gave the shipped files byte for byte. Needs scripts/setup.sh training.
#
#   examples/paper/training/train_sight.sh [BUILD [WORK]]    default: build/release results/sight
set -euo pipefail
cd "$(dirname "$0")/../../.."
build=${1:-build/release}
work=${2:-results/sight}
dataset="$build/bin/mebots-dataset --task sight"
scenes=fmu_world/params/scenes
[ -x "$build/bin/mebots-dataset" ] || { echo "$build/bin/mebots-dataset is missing: build the project first" >&2; exit 2; }

mkdir -p "$work"
$dataset --out "$work/train" --seed 1 --scenes 2000 --pictures 20
$dataset --out "$work/val" --seed 2 --scenes 200 --pictures 10
$dataset --out "$work/test" --seed 3 --scenes 200 --pictures 10
$dataset --out "$work/easy" --seed 4 --scenes 1 --pictures 300 --scene $scenes/gate_easy.json
$dataset --out "$work/hard" --seed 5 --scenes 1 --pictures 300 --scene $scenes/gate_edge.json --field-of-view 0.87

# Uses Debian's Python, because the Python in .venv has no PyTorch.
python="/usr/bin/python3 -B"
here=examples/paper/training
$python $here/train_sight.py "$work" "$work"
$python $here/export.py "$work/integer.npz" "$work" fmu_soc/firmware/nn/sight.weights $here/sight_golden --of sight
cp "$work/metrics.json" $here/sight_metrics.json
cat "$work/metrics.json"
