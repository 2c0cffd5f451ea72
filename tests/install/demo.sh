# SPDX-License-Identifier: Apache-2.0
# The shipped mission, from anywhere, with its results where asked for.
set -euo pipefail
mebots demo --out flight --expect passed
[[ -s flight/results.csv && -s flight/summary.json ]]
# A copied config flies too, and FMUs of one's own in front of the shipped ones.
cp "$MEBOTS/share/mebots/configs/battery_motors.json" copy.json
mebots run copy.json --quiet --out copy
# A config that extends another finds it, and the chip with GAP8's own devices.
mebots run "$MEBOTS/share/mebots/configs/gate_hard_gap8.json" --stop-time 3 --quiet --out gap8
