#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds MEbots for 64-bit ARM with Debian's cross compiler, flies a mission with it under qemu-user and compares what came out with
# the flight of a build for this machine. The chip is interpreted there: its translation to host code is for x86-64.
# Needs crossbuild-essential-arm64, qemu-user-static and mmdebstrap, and scripts/setup.sh once before.
#
#   scripts/arm64.sh [BUILD_FOLDER [ARGUMENT...]]    the build for this machine (build/release); arguments of `mebots run`
set -euo pipefail
cd "$(dirname "$0")/.."
host=${1:-build/release}
shift || true
if (($# == 0)); then set -- configs/gate_easy.json; fi
for program in aarch64-linux-gnu-g++ qemu-aarch64-static mmdebstrap; do
  command -v "$program" >/dev/null || {
    echo "arm64.sh: $program is missing: apt-get install crossbuild-essential-arm64 qemu-user-static mmdebstrap" >&2
    exit 2
  }
done
[[ -x $host/bin/mebots ]] || { echo "arm64.sh: no $host/bin/mebots to compare with: build it (cmake --preset release)" >&2; exit 2; }

# The libraries of scripts/setup.sh for that processor, but for those of tests and of the translation.
sysroot=$PWD/build/arm64-sysroot
packages=$(sed -n '/^packages=(/,/^)/p' scripts/setup.sh | sed 's/#.*//' | grep -oE '\b[a-z0-9.+-]+-dev\b' |
  grep -vE '^(libxbyak|libgtest|libgmock|libbenchmark|libclang-rt-[0-9]+|python3|pybind11)-dev$' | paste -sd,)
if [[ $(cat "$sysroot/.packages" 2>/dev/null) != "$packages" ]]; then
  rm -rf "$sysroot"
  mmdebstrap --quiet --variant=extract --architectures=arm64 "--include=libc6-dev,libstdc++-12-dev,$packages" bookworm "$sysroot" \
    "${DEBIAN_MIRROR:-http://deb.debian.org/debian}"
  echo "$packages" >"$sysroot/.packages"
fi

cmake --preset release -B build/arm64 "-DCMAKE_TOOLCHAIN_FILE=$PWD/cmake/arm64.cmake" "-DCMAKE_SYSROOT=$sysroot" \
  -DMEBOTS_SOC_TRANSLATE=OFF -DMEBOTS_EXAMPLES=OFF -DMEBOTS_PYTHON=OFF -DMEBOTS_PAGES=OFF
cmake --build build/arm64

place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
"$host/bin/mebots" run "$@" --quiet --out "$place/host"
qemu-aarch64-static -L "$sysroot" build/arm64/bin/mebots run "$@" --quiet --out "$place/arm64"
echo "${*}: flown on this machine and under qemu-aarch64:"
python3 tests/interop/other_processor.py "$place/host" "$place/arm64"
