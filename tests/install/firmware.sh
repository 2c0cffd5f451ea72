# SPDX-License-Identifier: Apache-2.0
# A bare-metal program from a template: alone, and in the mission.
set -euo pipefail
mebots new-firmware napper --out "my napper"
cmake -S "my napper" -B build -G Ninja >configure.log
cmake --build build >build.log || { cat build.log; exit 1; }
cmake --build build --target run | tee run.log
[[ $(grep -c '^awake at' run.log) == 5 ]] || { echo "FAILED: five naps were expected"; exit 1; }
mebots demo --out flight --stop-time 0.1 --set soc.firmware="$PWD/build/firmware/napper.elf" | tee flight.log
[[ $(grep -c 'awake at' flight.log) == 5 ]] || { echo "FAILED: the mission did not run this firmware"; exit 1; }
if mebots new-firmware Napper 2>refused.log; then echo "FAILED: a name that is not a C identifier"; exit 1; fi
