# SPDX-License-Identifier: Apache-2.0
# Runs the shipped mission from any folder, and stores its results in a given place.
set -euo pipefail
mebots demo --out flight --expect passed
[[ -s flight/results.csv && -s flight/summary.json ]]
# Runs a copied config. FMUs of a user take precedence over the shipped FMUs.
cp "$MEBOTS/share/mebots/configs/battery_motors.json" copy.json
mebots run copy.json --quiet --out copy
# Runs a config that extends another config. Its chip has GAP8's own devices.
mebots run "$MEBOTS/share/mebots/configs/gate_hard_gap8.json" --stop-time 3 --quiet --out gap8
