#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Usage: make_runs.sh MEBOTS CONFIGS OUT MEBOTS_SOC PROGRAM.elf. Creates the runs for page_test.mjs and their pages.
set -euo pipefail
mebots=$1 configs=$2 out=$3 soc=$4 program=$5
mkdir -p "$out"
# The tests contain times of events in a flight. They are valid for these models, whose motors start immediately.
models=(motors.rotor_data=crazyflie_bench motors.bus.resistance=0 battery.cell.name=bitcraze_250 world.drone.name=crazyflie_bench
  soc.energy.name=gap8)
"$mebots" run "$configs/gate_easy.json" --stop-time 4 --quiet --statistics --set "${models[@]}" "soc.observe.profile=$out/flight/profile.json" \
  --out "$out/flight"
"$mebots" run "$configs/gate_easy.json" --stop-time 4 --quiet --set "${models[@]}" soc.mission.cruise_speed=0.5 --out "$out/fast"
"$mebots" run "$configs/gate_easy.json" --stop-time 2 --quiet --set "${models[@]}" --out "$out/short"
"$mebots" run "$configs/battery_motors.json" --quiet --statistics --out "$out/system"
"$mebots" run "$configs/battery_motors.json" --quiet --stop-time 40 --out "$out/long" # too many rows for a page
"$mebots" run "$configs/hover_16.json" --quiet --stop-time 2 --out "$out/swarm" --set "world.drone[3].start.offset.y=0.2" \
  "battery[7].cell.initial_state_of_charge=0.5"
here=$(dirname "$0")
"$mebots" run "$here/robots.json" --quiet --out "$out/robots"
"$mebots" run "$here/robots_not_recorded.json" --quiet --out "$out/robots_not_recorded"
"$mebots" report "$out/flight"
"$mebots" report "$out/long" --detail 20:21
"$mebots" report "$out/system"
"$mebots" report "$out/swarm"
"$mebots" report "$out/robots"
"$mebots" report "$out/robots_not_recorded"
"$mebots" report "$out/flight" "$out/fast" --out "$out/beside.html"
"$mebots" report "$out/short" "$out/flight" --out "$out/lengths.html"
"$soc" run "$program" --board ai_deck --page "$out/chip.html" --json "$out/chip.json" >"$out/chip.txt"
