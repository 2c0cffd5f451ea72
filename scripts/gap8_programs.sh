#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs published GAP8 programs without changes on board gap8, and prints a table of their progress. FOLDER contains
# these checkouts. Programs of missing checkouts are omitted:
#   git clone https://github.com/pulp-platform/pulp-dronet             PULP-Dronet's ELF, flash image (for the dumper, too) and weights
#   git clone https://github.com/pulp-platform/Himax_Dataset           pictures of its camera
#   git clone https://github.com/GreenWaves-Technologies/gap_sdk       flasher, fuser
# and hello, which gvsoc/gvsoc has as examples/pulp-open/hello at e4a7e8c. If GVSoC is installed (MEBOTS_GVSOC contains
# its path, or it is on PATH), the programs that both simulators support run on both. CoreMark is one of them:
#   git clone https://github.com/eembc/coremark
# Build first: cmake --build --preset release --target mebots-soc. Needs NumPy for the reference's integers, and
# riscv64-unknown-elf-gcc.
set -euo pipefail
if [[ $# -ne 1 || ! -d "$1" ]]; then
  echo "usage: scripts/gap8_programs.sh FOLDER   (see the comment at its top)" >&2
  exit 2
fi
folder=$(realpath "$1")
cd "$(dirname "$0")/.."
soc=${MEBOTS_SOC:-build/release/bin/mebots-soc}
python=${PYTHON:-.venv/bin/python}
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT

# The exit code is 1 if an available program does not reach its milestone.
failed=0
row() { printf '%-34s %-12s %s\n' "$1" "$2" "$3"; }
# milestone NAME ELF REQUIRED-OUTPUT [OPTIONS...] runs a program, and prints whether its output contains the required
# output.
milestone() {
  local name=$1 elf=$2 wanted=$3
  shift 3
  if [[ ! -f "$elf" ]]; then
    row "$name" "not there" "$elf"
    return
  fi
  "$soc" run "$elf" --board "configs/boards/${soc_board:-gap8}.json" --max-instructions 20000000 "$@" >"$out/log" 2>&1 || true
  if grep -qF -- "$wanted" "$out/log"; then
    row "$name" "reached" "$wanted"
  else
    failed=1
    row "$name" "NOT REACHED" "$wanted (last: $(grep -v ' J$' "$out/log" | tail -n 1 | cut -c 1-90))"
  fi
}

row program milestone "what it printed"
dronet=$folder/pulp-dronet/pulp-dronet-v1
image=$dronet/weights/WeightsPULPDroNet.raw
pictures=$folder/Himax_Dataset/test_2
if [[ -f "$image" && -d "$pictures" ]]; then
  mkdir "$out/pictures"
  cp "$pictures"/frame_2[2-9].pgm "$out/pictures"
  expected=$("$python" tests/conformance/gap8/dronet_reference.py "$dronet/weights/binary" "$out/pictures"/*.pgm |
    awk '{print $2, $3}')
  "$soc" run "$dronet/bin/PULPDroNet_GAPuino" --board configs/boards/gap8.json --flash "$image" \
    --pictures "$out/pictures" >"$out/log" 2>&1 || true
  got=$(awk '/^Result/ {print $2, $3}' "$out/log")
  count=$(grep -c '^Result' "$out/log" || true)
  if [[ -n "$got" && "$got" == "$expected" ]]; then
    row PULPDroNet_GAPuino reached "$count pictures, each with the integers of the reference"
  else
    failed=1
    row PULPDroNet_GAPuino "NOT REACHED" "$count results; differing from the reference: $(diff <(echo "$got") <(echo "$expected") | head -n 3 | tr '\n' ' ')"
  fi
else
  row PULPDroNet_GAPuino "not there" "$image, $pictures"
fi
bins=$folder/gap_sdk/utils/openocd_tools/gap_bins
# with_host COMMAND NAME [MORE...] runs the program NAME with a host at its JTAG, and prints whether it succeeded.
with_host() {
  local command=$1 name=$2
  shift 2
  if [[ ! -f "$bins/$name.elf" ]]; then
    row "$name" "not there" "$bins/$name.elf"
  elif "$python" scripts/gap8_jtag.py "$command" "$soc" "$bins/$name.elf" "$@" >"$out/log" 2>&1; then
    row "$name" reached "$(tail -n 1 "$out/log")"
  else
    failed=1
    row "$name" "NOT REACHED" "$(tail -n 1 "$out/log")"
  fi
}
with_host flash gap_flasher-gapuino8
with_host flash gap_flasher-gapoc_a
if [[ -f "$image" ]]; then with_host dump gap_dumper-gapuino8 "$image"; fi
for name in gap_fuser-gapuino8 gap_fuser-gapoc_a gap_fuser-gapoc_a_qpif; do with_host fuse "$name"; done
if [[ -f "$folder/hello" ]]; then
  soc_board=pulp_open milestone pulp-open/hello "$folder/hello" "Hello from FC"
else
  row pulp-open/hello "not there" "$folder/hello"
fi
milestone gap_flasher-gapuino9 "$bins/gap_flasher-gapuino9.elf" "this program is for GAP9"
milestone gap_flasher-vega "$bins/gap_flasher-vega.elf" "this program is for GAP9"

if command -v "${MEBOTS_GVSOC:-gvsoc}" >/dev/null; then
  printf '\nThe same ELFs on GVSoC, target pulp-open:\n\n'
  both=()
  if [[ -f "$folder/hello" ]]; then both+=(--hello "$folder/hello"); fi
  if [[ -d "$folder/coremark" ]]; then both+=(--coremark "$folder/coremark"); fi
  "$python" bench/gvsoc/side_by_side.py "$(dirname "$(dirname "$soc")")" "${both[@]}" || failed=1
else
  row GVSoC "not there" "name its program in MEBOTS_GVSOC to run what it can run, too"
fi
exit $failed
