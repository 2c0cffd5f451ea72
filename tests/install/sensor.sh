# SPDX-License-Identifier: Apache-2.0
# Tests a sensor from a template, alone and in flight. A board file or a device model in C++ describes its behaviour.
set -euo pipefail
try() {  # NAME OPTION...
  mebots new-sensor "$@"
  cmake -S "$1" -B "$1/build" -G Ninja -DCMAKE_BUILD_TYPE=Debug -DCMAKE_CXX_COMPILER_LAUNCHER="$(command -v ccache || true)" >configure.log
  cmake --build "$1/build" -j2 >build.log || { cat build.log; exit 1; }
  cmake --build "$1/build" --target run | tee run.log
  [[ $(grep -cE "^$1 [0-9]+\.[0-9]{3}$" run.log) == 20 ]] || { echo "FAILED: twenty values were expected"; exit 1; }
  cmake --build "$1/build" --target fly | tee fly.log
  python3 - "$1" <<'PYTHON'
import csv, json, pathlib, sys

name = sys.argv[1]
folder = pathlib.Path(name) / "results/mission"
mission = json.loads((pathlib.Path(name) / "mission.json").read_text())
sensed = next(c["from"] for c in mission["connections"] if c["to"] == f"chip.{name}.value")
summary = json.loads((folder / "summary.json").read_text())
assert summary["exit_code"] == 0, summary["exit_code"]
# Twenty measurements of 20 ms take 10 mA at 2.8 V. During the rest of the run, which is below 1 s, the current is 5 uA.
assert 0 < summary["sensor_energy"] - 20 * 2.8 * 10e-3 * 0.02 < 2.8 * 5e-6, summary["sensor_energy"]
with (folder / "results.csv").open(newline="") as file:
    rows = list(csv.reader(file))
names = [title.rsplit(" [", 1)[0] for title in rows[0]]
reported, truth = ([float(row[names.index(column)]) for row in rows[1:]] for column in (f"chip.{name}.reported", sensed))
resolution = 0.01 if (pathlib.Path(name) / f"{name}.cpp").exists() else 0.001
changes = [k for k in range(1, len(reported)) if reported[k] != reported[k - 1]]
# The drone climbs by 1 cm, which is one unit of the sensor with the resolution 0.01.
assert len(changes) >= (1 if resolution == 0.01 else 4), changes
for k in changes:
    assert any(abs(reported[k] - truth[i]) <= resolution / 2 + 1e-9 for i in range(max(0, k - 3), k)), (k, reported[k])
print(f"{name}: {len(changes)} values of {sensed}")
PYTHON
}
try height
try altimeter --senses world.drone.position.z --cpp
if mebots new-sensor other --senses world.range.dwon 2>refused.log; then echo "FAILED: there is no such output"; exit 1; fi
grep -q "world.range.dwon" refused.log && grep -q "'range.down'" refused.log
