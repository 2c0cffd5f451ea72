#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds MEbots for 64-bit ARM with Debian's cross compiler, and runs a mission with it under qemu-user. The results
# must have the same bits as the results of a build for this machine (docs/concepts/determinism.md#64-bit-arm). On ARM,
# the chip is interpreted, because its translation to host code exists only for x86-64. Needs
# crossbuild-essential-arm64, qemu-user-static and mmdebstrap. Run scripts/setup.sh once before.
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

scripts/arm64_sysroot.sh
sysroot=$PWD/build/arm64-sysroot
cmake --preset release -B build/arm64 "-DCMAKE_TOOLCHAIN_FILE=$PWD/cmake/arm64.cmake" "-DCMAKE_SYSROOT=$sysroot" \
  "-DMEBOTS_MUSL_SOURCE=$(echo "$PWD"/build/arm64-sources/musl_*.orig.tar.gz)" \
  -DMEBOTS_SOC_TRANSLATE=OFF -DMEBOTS_EXAMPLES=OFF -DMEBOTS_PYTHON=OFF -DMEBOTS_PAGES=OFF
cmake --build build/arm64

# Checks that the binaries contain no fused multiply-add. It gives other bits than a multiplication and an addition,
# which x86-64 uses.
mapfile -t binaries < <(find build/arm64/fmu_binaries -name "*.so")
((${#binaries[@]} > 0)) || { echo "arm64.sh: build/arm64/fmu_binaries has no *.so to check for fused products and sums" >&2; exit 1; }
for binary in "${binaries[@]}" "$sysroot/usr/lib/aarch64-linux-gnu/libccd.so.2.0"; do
  fused=$(aarch64-linux-gnu-objdump --disassemble --demangle --no-show-raw-insn "$binary" |
    awk '/^[0-9a-f]+ </ { name = $0 } $2 ~ /^(fn?m(add|sub)|fml[as])$/ { print name }' | sort -u)
  [[ -z $fused ]] || { printf 'arm64.sh: %s has fused products and sums, in\n%s\n' "$binary" "$fused" >&2; exit 1; }
done

place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
"$host/bin/mebots" run "$@" --quiet --out "$place/host"
qemu-aarch64-static -L "$sysroot" build/arm64/bin/mebots run "$@" --quiet --out "$place/arm64"
echo "${*}: flown on this machine and under qemu-aarch64:"
python3 tests/interop/other_processor.py "$place/host" "$place/arm64"
