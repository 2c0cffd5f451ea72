#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs MEbots into a temporary folder and does with it what a newcomer does: an FMU from a description, built,
# tested, checked and run; and a program that drives a mission. Usage: newcomer.sh SOURCE_FOLDER BUILD_FOLDER
set -euo pipefail
source_dir=$1
build_dir=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"

cmake --install "$build_dir" --prefix "$work/mebots" >install.log
export PATH="$work/mebots/bin:$PATH"
common=(-DCMAKE_PREFIX_PATH="$work/mebots" -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_COMPILER_LAUNCHER="$(command -v ccache || true)")

# Two descriptions: scalars alone, and all types with groups.
for description in examples/motor_thermal/fmu tests/modeldesc/lag; do
  name=$(basename "$(dirname "$source_dir/$description/x")")
  [[ $name == fmu ]] && name=motor_thermal
  mebots new-fmu "$source_dir/$description/description.json" --out "$work/$name"
  cmake -S "$work/$name" -B "$work/$name/build" -G Ninja "${common[@]}" >configure.log
  cmake --build "$work/$name/build" -j2 >build.log || { cat build.log; exit 1; }
  ctest --test-dir "$work/$name/build" --output-on-failure
  mebots check "$work/$name/build/fmus/$name.fmu"
  printf '{"step": 0.01, "stop_time": 1, "connections": [], "instances": {"own": {"fmu": "%s"}}}' \
    "$work/$name/build/fmus/$name.fmu" >config.json
  mebots run config.json --quiet --out "$work/results_$name"
  [[ $(wc -l <"$work/results_$name/results.csv") == 102 ]] || { echo "FAILED: not every step was recorded"; exit 1; }
  # Nothing is ever overwritten.
  if mebots new-fmu "$source_dir/$description/description.json" --out "$work/$name" 2>refused.log; then
    echo "FAILED: a folder was overwritten"; exit 1
  fi
  grep -q "nothing is ever overwritten" refused.log
done

cmake -S "$source_dir/examples/drive_from_cpp" -B drive -G Ninja "${common[@]}" >configure.log
cmake --build drive >build.log || { cat build.log; exit 1; }
sed "s#\"stop_time\": 60#\"stop_time\": 2.5#" "$source_dir/configs/gate_easy.json" >mission.json
status=0
./drive/drive_from_cpp mission.json >drive.log || status=$?
cat drive.log
# Cut short in flight: no gate yet, so the program says 1; half a second of 0.5 W is 0.25 J.
[[ $status == 1 ]]
grep -q "outcome: timeout after 2.500 s" drive.log
grep -q "the lamp took 0.2[45][0-9] J" drive.log
echo "ok: a newcomer's FMUs and program build, pass and run"
