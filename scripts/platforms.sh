#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the FMUs for 64-bit Windows and 64-bit ARM Linux on Debian 12, and merges their binaries into the archives of
# this machine's build. Runs them under wine and qemu-user, and compares all values with this machine's
# (docs/platforms.md). Not part of CI. An interrupted script continues where it stopped.
#
#   scripts/platforms.sh [--install] [BUILD_FOLDER]    the build for this machine (build/release), with its FMUs
#
# --install first installs the packages, which needs root. The merged archives are in build/platforms.
# $MEBOTS_PLATFORM_FMUS selects other FMUs than the default ones.
set -euo pipefail
cd "$(dirname "$0")/.."
packages=(g++-mingw-w64-x86-64-posix wine64 crossbuild-essential-arm64 qemu-user-static mmdebstrap dpkg-dev)
if [[ ${1:-} == --install ]]; then
  shift
  apt-get install -y -qq --no-install-recommends "${packages[@]}"
fi
host=$PWD/${1:-build/release}
wine=$(command -v wine64 || echo /usr/lib/wine/wine64)
for program in x86_64-w64-mingw32-g++-posix aarch64-linux-gnu-g++ qemu-aarch64-static mmdebstrap "$wine"; do
  command -v "$program" >/dev/null || { echo "platforms.sh: $program is missing: apt-get install ${packages[*]}" >&2; exit 2; }
done
fmus=${MEBOTS_PLATFORM_FMUS:-fmu_battery fmu_battery_fmi3 fmu_motors fmu_motors_fmi3 fmu_soc fmu_soc_fmi3 fmu_world fmu_world_fmi3}
for fmu in $fmus; do
  [[ -e $host/fmus/$fmu.fmu ]] || { echo "platforms.sh: no $host/fmus/$fmu.fmu to compare with: build it (cmake --preset release)" >&2; exit 2; }
done

# build NAME OPTION... builds the FMUs for a platform. Uses this machine's generators.
build() {
  local name=$1
  shift
  cmake --preset release -B "build/$name" "-DMEBOTS_HOST_TOOLS=$host/bin" -DMEBOTS_WORLD_DRONES= "$@" >/dev/null
  local targets=()
  for fmu in $fmus; do targets+=("${fmu}_archive"); done
  local TIMEFORMAT="platforms.sh: built for $name in %0R s; processor time %0U s + %0S s"
  time cmake --build "build/$name" --target "${targets[@]}"
}
scripts/win64_sysroot.sh
build win64 "-DCMAKE_TOOLCHAIN_FILE=$PWD/cmake/win64.cmake" "-DMEBOTS_MUSL_SOURCE=$(echo "$PWD"/build/win64-sources/musl_*.orig.tar.gz)"
scripts/arm64_sysroot.sh
build arm64-fmus "-DCMAKE_TOOLCHAIN_FILE=$PWD/cmake/arm64.cmake" "-DCMAKE_SYSROOT=$PWD/build/arm64-sysroot" \
  "-DMEBOTS_MUSL_SOURCE=$(echo "$PWD"/build/arm64-sources/musl_*.orig.tar.gz)"

python3 tests/platforms/dll_test.py build/win64/fmu_binaries

mkdir -p build/platforms
archives=()
for fmu in $fmus; do
  "$host/bin/mebots" fmu-platforms "$host/fmus/$fmu.fmu" "build/win64/fmus/$fmu.fmu" "build/arm64-fmus/fmus/$fmu.fmu" --out "build/platforms/$fmu.fmu"
  "$host/bin/mebots" check "build/platforms/$fmu.fmu" >"build/platforms/$fmu.check" || { cat "build/platforms/$fmu.check" >&2; exit 1; }
  archives+=("build/platforms/$fmu.fmu")
done
ls -l "${archives[@]}"

loader=tests/platforms/run_fmu.c
gcc -std=c11 -O1 "$loader" -o build/platforms/run_fmu -ldl
x86_64-w64-mingw32-gcc -std=c11 -O1 -static "$loader" -o build/platforms/run_fmu.exe
aarch64-linux-gnu-gcc -std=c11 -O1 "$loader" -o build/platforms/run_fmu_arm64 -ldl
export WINEDEBUG=-all WINEPREFIX=$PWD/build/platforms/wine
loaders=(--loader linux64=build/platforms/run_fmu --loader "win64=$wine build/platforms/run_fmu.exe"
  --loader "aarch64-linux=qemu-aarch64-static -L build/arm64-sysroot build/platforms/run_fmu_arm64")
python3 tests/platforms/compare.py "${loaders[@]}" "${archives[@]}"
python3 tests/platforms/resource_paths.py "$wine" build/platforms/run_fmu.exe "${archives[@]}"
if [[ " $fmus " == *" fmu_soc "* ]]; then
  python3 tests/platforms/fly.py "${loaders[@]}" configs/gate_easy.json build/platforms "${MEBOTS_PLATFORM_FLIGHT_S:-6}"
fi
