#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Runs the easy mission with each of several builds, with and without AVX, FMA and BMI. If qemu-x86_64 is installed,
# also runs the first build on an emulated processor that has none of them. Prints a Markdown table of hashes. The exit
# code is 1 if results differ.
# Usage: scripts/same_results.sh BUILD_FOLDER... [--config FILE] [--stop-time S]    (configs/gate_easy.json to its end)
set -euo pipefail
cd "$(dirname "$0")/.."
builds=() config=configs/gate_easy.json more=()
while (($#)); do
  case $1 in
    --config) config=$2; shift ;;
    --stop-time) more=(--stop-time "$2"); shift ;;
    *) builds+=("$1") ;;
  esac
  shift
done
((${#builds[@]})) || { echo "usage: scripts/same_results.sh BUILD_FOLDER... [--config FILE] [--stop-time S]" >&2; exit 2; }
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
hashes=()

# fly BUILD PROCESSOR COMMAND... runs the mission with a build. COMMAND starts the mission on a processor. PROCESSOR
# describes this processor.
fly() {
  local build=$1 processor=$2 of cache=$1/CMakeCache.txt
  shift 2
  of() { sed -n "s/^$1:[A-Z]*=//p" "$cache"; }
  rm -rf "$place/out"
  local began hash
  began=$(date +%s)
  "$@" "$build/bin/mebots" run "$config" --quiet --out "$place/out" "${more[@]}" 2> "$place/errors" ||
    { echo "same_results.sh: $build, $processor:" >&2; cat "$place/errors" >&2; exit 1; }
  hash=$(sha256sum < "$place/out/results.csv" | cut -c1-16)
  hashes+=("$hash")
  local compiler kind
  compiler=$("$(of CMAKE_CXX_COMPILER)" --version | head -1)
  kind=$(of CMAKE_BUILD_TYPE)
  if [[ $(of MEBOTS_ASSERTIONS) == ON ]]; then kind+=", assertions"; fi
  if [[ -n $(of MEBOTS_SANITIZE) ]]; then kind+=", sanitizers $(of MEBOTS_SANITIZE)"; fi
  echo "| $compiler | $kind | $processor | $hash | $(($(date +%s) - began)) s |"
}

echo "| compiler | build | processor | results.csv | took |"
echo "|---|---|---|---|---|"
for build in "${builds[@]}"; do
  fly "$build" "this one" env
  fly "$build" "without AVX, FMA, BMI" env GLIBC_TUNABLES=glibc.cpu.hwcaps=-AVX,-AVX2,-AVX512F,-FMA,-FMA4,-BMI1,-BMI2
done
if command -v qemu-x86_64 > /dev/null; then fly "${builds[0]}" "qemu64, emulated" qemu-x86_64 -cpu qemu64; fi
[[ $(printf '%s\n' "${hashes[@]}" | sort -u | wc -l) == 1 ]] || { echo "same_results.sh: the results differ" >&2; exit 1; }
