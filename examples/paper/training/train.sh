#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Generates the pictures, trains, fine-tunes with integers, and writes weights and golden vectors. Takes less than an
# hour on two idle cores. If PyTorch has a GPU, uses it. Needs scripts/setup.sh training.
#
#   examples/paper/training/train.sh [BUILD [WORK]]    default: build/release results/training
set -euo pipefail
cd "$(dirname "$0")/../../.."
build=${1:-build/release}
work=${2:-results/training}
dataset=$build/bin/mebots-dataset
scenes=fmu_world/params/scenes
[ -x "$dataset" ] || { echo "$dataset is missing: build the project first" >&2; exit 2; }

# Trains first with only the wide lens, then with lenses between that of Webots' Crazyflie and that of Stargate's
# recordings.
mkdir -p "$work/wide" "$work/mixed"
"$dataset" --out "$work/wide/train" --seed 1 --scenes 1300 --pictures 20 --field-of-view 1.51844
"$dataset" --out "$work/wide/val" --seed 2 --scenes 250 --pictures 8 --field-of-view 1.51844
"$dataset" --out "$work/mixed/train" --seed 1 --scenes 1065 --pictures 20
"$dataset" --out "$work/mixed/val" --seed 2 --scenes 250 --pictures 8
"$dataset" --out "$work/mixed/test" --seed 3 --scenes 250 --pictures 8
"$dataset" --out "$work/mixed/easy" --seed 4 --scenes 1 --pictures 500 --scene $scenes/gate_easy.json
"$dataset" --out "$work/mixed/hard" --seed 5 --scenes 1 --pictures 500 --scene $scenes/gate_hard.json

# Uses Debian's Python, because the Python in .venv has no PyTorch.
python="/usr/bin/python3 -B"
here=examples/paper/training
$python $here/train.py "$work/wide" "$work/first" --epochs 7 --integer-epochs 0
$python $here/train.py "$work/mixed" "$work/second" --start "$work/first/float.pt" --rate 2e-3 --epochs 8 --integer-epochs 2
$python $here/export.py "$work/second/integer.npz" "$work/mixed" fmu_soc/firmware/nn/navigator.weights $here/golden
cat "$work/second/metrics.json"
