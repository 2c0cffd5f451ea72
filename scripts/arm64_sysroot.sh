#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs Debian's libraries for 64-bit ARM in build/arm64-sysroot, for scripts/arm64.sh. Rebuilds ODE, libccd and
# libpng from Debian's sources. Debian's own builds fuse a product and a sum into one operation with one rounding, so
# their last bits differ from x86-64. ARKODE is not rebuilt: it is C99, for which compilers do not fuse. Also fetches
# musl's sources, which cmake/MebotsMath.cmake compiles.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/debian_sources.sh
sysroot=$PWD/build/arm64-sysroot
mirror=${DEBIAN_MIRROR:-http://deb.debian.org/debian}
target=aarch64-linux-gnu
libraries=$sysroot/usr/lib/$target

# Lists the libraries of scripts/setup.sh, except those for tests and translation.
packages=$(sed -n '/^packages=(/,/^)/p' scripts/setup.sh | sed 's/#.*//' | grep -oE '\b[a-z0-9.+-]+-dev\b' |
  grep -vE '^(libxbyak|libgtest|libgmock|libbenchmark|libclang-rt-[0-9]+|python3|pybind11)-dev$' | paste -sd,)
place=$PWD/build/arm64-sources
plain="-O2 -fPIC -ffp-contract=off"
begin_sysroot "$sysroot" "$place" "$packages $(cat scripts/arm64_sysroot.sh scripts/debian_sources.sh cmake/arm64.cmake | sha256sum)"

# Unpacks into an empty folder, as mmdebstrap requires. The sysroot is not empty, because it contains marks of finished
# steps.
unpack_packages() {
  rm -rf "$place/root"
  mmdebstrap --quiet --variant=extract --architectures=arm64 "--include=libc6-dev,libstdc++-12-dev,$packages" bookworm "$place/root" "$mirror"
  cp -a "$place/root/." "$sysroot/"
  rm -rf "$place/root"
}

build_libccd() {
  cmake -S "$place"/libccd-*/ -B "$place/libccd" -G Ninja -DCMAKE_BUILD_TYPE=None "-DCMAKE_TOOLCHAIN_FILE=$PWD/cmake/arm64.cmake" \
    "-DCMAKE_SYSROOT=$sysroot" "-DCMAKE_C_FLAGS=$plain" -DCCD_DOUBLE=ON
  cmake --build "$place/libccd"
  cp "$place/libccd/src/libccd.so.2.0" "$libraries/"
}

build_libpng() (
  cd "$place"/libpng1.6-*/
  ./configure "--host=$target" "CC=$target-gcc --sysroot=$sysroot" "CFLAGS=$plain" --disable-shared
  make -j"$(nproc)" libpng16.la
  cp .libs/libpng16.a "$libraries/"
)

build_ode() (
  cd "$place"/ode-*/
  PKG_CONFIG_SYSROOT_DIR=$sysroot PKG_CONFIG_LIBDIR=$libraries/pkgconfig ./configure "--host=$target" \
    "CC=$target-gcc --sysroot=$sysroot" "CXX=$target-g++ --sysroot=$sysroot" "CFLAGS=$plain" "CXXFLAGS=$plain" \
    --enable-double-precision --with-libccd=system --enable-libccd --disable-shared --disable-demos
  make -j"$(nproc)"
  cp ode/src/.libs/libode.a "$libraries/"
)

step packages unpack_packages
step sources debian_sources "$place" musl ode libccd libpng1.6
step libccd build_libccd
step libpng build_libpng
step ode build_ode
