# SPDX-License-Identifier: Apache-2.0
# Tests FMUs that `mebots new-fmu` creates from two descriptions: one with scalars only, one with all types and groups.
# The C++ namespace in the description is that of mebots, another one, or empty.
set -euo pipefail
launcher=$(command -v ccache || true)
try() {  # DESCRIPTION NAME NAMESPACE
  sed -E "s/\"namespace\": *\"[^\"]*\"/\"namespace\": \"$3\"/" "$NEEDED/descriptions/$1.json" >"$2.json"
  mebots new-fmu "$2.json" --out "$2"
  cmake -S "$2" -B "$2/build" -G Ninja -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_COMPILER_LAUNCHER="$launcher" >configure.log
  cmake --build "$2/build" -j2 >build.log || { cat build.log; exit 1; }
  ctest --test-dir "$2/build" --output-on-failure
  mebots check "$2/build/fmus/$1.fmu"
  mebots test "$2/test/$1.mebots-test.json"
  printf '{"step": 0.01, "stop_time": 1, "connections": [], "instances": {"own": {"fmu": "%s"}}}' "$1" >config.json
  MEBOTS_FMU_PATH=$2/build/fmus mebots run config.json --quiet --out "results_$2"
  [[ $(wc -l <"results_$2/results.csv") == 102 ]] || { echo "FAILED: not every step was recorded"; exit 1; }
  if mebots new-fmu "$2.json" --out "$2" 2>refused.log; then echo "FAILED: a folder was overwritten"; exit 1; fi
}
try motor_thermal ours mebots::motor_thermal
try lag theirs acme::control::lag
try lag nobodys ""
echo "ok: FMUs of three namespaces build, pass and run"
