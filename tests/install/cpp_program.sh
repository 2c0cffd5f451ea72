# SPDX-License-Identifier: Apache-2.0
# Tests a user's program that uses find_package(mebots). The program finds the FMUs of the mebots in PATH.
set -euo pipefail
cmake -S "$NEEDED/drive_from_cpp" -B drive -G Ninja -DCMAKE_BUILD_TYPE=Debug \
  -DCMAKE_CXX_COMPILER_LAUNCHER="$(command -v ccache || true)" >configure.log
cmake --build drive >build.log || { cat build.log; exit 1; }
sed 's#"stop_time": 60#"stop_time": 2.5#' "$MEBOTS/share/mebots/configs/gate_easy.json" >mission.json
status=0
./drive/drive_from_cpp mission.json >drive.log || status=$?
cat drive.log
# The run ends during the flight, before the gate, so the program returns 1. 0.5 W during half a second are 0.25 J.
[[ $status == 1 ]]
grep -q "outcome: timeout after 2.500 s" drive.log
grep -q "the lamp took 0.2[45][0-9] J" drive.log
