#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the libraries that the FMUs link, for 64-bit Windows, from Debian's sources, in build/win64-sysroot (for
# scripts/platforms.sh). Also fetches musl's sources, which cmake/MebotsMath.cmake compiles. Needs
# g++-mingw-w64-x86-64-posix and dpkg-dev, and the headers that scripts/setup.sh installs. An interrupted script
# continues where it stopped.
set -euo pipefail
cd "$(dirname "$0")/.."
source scripts/debian_sources.sh
sysroot=$PWD/build/win64-sysroot
place=$PWD/build/win64-sources
target=x86_64-w64-mingw32
toolchain=$PWD/cmake/win64.cmake

plain="-O2 -ffp-contract=off"
begin_sysroot "$sysroot" "$place" "$(cat scripts/win64_sysroot.sh scripts/debian_sources.sh cmake/win64.cmake | sha256sum)"

# Copies headers of header-only libraries, which are the same on all platforms.
copy_headers() {
  mkdir -p "$sysroot"/{include,lib/cmake,share/cmake}
  cp -r /usr/include/{fmt,nlohmann,eigen3,xbyak} "$sysroot/include/"
  cp -r /usr/share/cmake/nlohmann_json "$sysroot/share/cmake/"
  cp -r /usr/share/eigen3 "$sysroot/share/"
  cp /usr/include/tiny_gltf.h "$sysroot/include/"
  mkdir -p "$sysroot/fmt/lib/cmake"  # as deep as Debian's folder, because the package finds its headers relative to it
  cp -r /usr/lib/x86_64-linux-gnu/cmake/fmt "$sysroot/fmt/lib/cmake/"
  rm -f "$sysroot"/fmt/lib/cmake/fmt/fmt-targets-*.cmake  # removes the targets of its libraries; the FMUs use only the headers
}

build_libccd() {
  cmake -S "$place"/libccd-*/ -B "$place/libccd" -G Ninja -DCMAKE_BUILD_TYPE=None "-DCMAKE_TOOLCHAIN_FILE=$toolchain" \
    "-DCMAKE_C_FLAGS=$plain -DCCD_STATIC_DEFINE" -DCCD_DOUBLE=ON -DBUILD_SHARED_LIBS=OFF "-DCMAKE_INSTALL_PREFIX=$sysroot"
  cmake --build "$place/libccd" --target install
}

build_sundials() {
  cmake -S "$place"/sundials-*/ -B "$place/sundials" -G Ninja -DCMAKE_BUILD_TYPE=None "-DCMAKE_TOOLCHAIN_FILE=$toolchain" \
    "-DCMAKE_C_FLAGS=$plain" -DBUILD_SHARED_LIBS=OFF -DBUILD_ARKODE=ON -DBUILD_CVODE=OFF -DBUILD_CVODES=OFF -DBUILD_IDA=OFF \
    -DBUILD_IDAS=OFF -DBUILD_KINSOL=OFF -DEXAMPLES_ENABLE_C=OFF -DEXAMPLES_INSTALL=OFF "-DCMAKE_INSTALL_PREFIX=$sysroot"
  cmake --build "$place/sundials" --target install
}

build_zlib() (
  cd "$place"/zlib-*/
  $target-gcc-posix $plain -c adler32.c compress.c crc32.c deflate.c inf*.c trees.c uncompr.c zutil.c
  $target-ar rcs "$sysroot/lib/libz.a" ./*.o
  cp zlib.h zconf.h "$sysroot/include/"
)

build_libpng() (
  cd "$place"/libpng1.6-*/
  ./configure --host=$target CC=$target-gcc-posix "CFLAGS=$plain" "CPPFLAGS=-I$sysroot/include" "LDFLAGS=-L$sysroot/lib" \
    "--prefix=$sysroot" --disable-shared
  make -j"$(nproc)" libpng16.la
  make install-libLTLIBRARIES install-pkgincludeHEADERS install-nodist_pkgincludeHEADERS
  cp "$sysroot"/include/libpng16/*.h "$sysroot/include/"
)

build_ode() (
  cd "$place"/ode-*/
  grep -rl '<Windows.h>' ode include | xargs -r sed -i 's/<Windows.h>/<windows.h>/'
  CCD_CFLAGS="-I$sysroot/include -DCCD_STATIC_DEFINE" CCD_LIBS="-L$sysroot/lib -lccd" ./configure --host=$target \
    CC=$target-gcc-posix CXX=$target-g++-posix "CFLAGS=$plain" "CXXFLAGS=$plain" "--prefix=$sysroot" --enable-double-precision \
    --with-libccd=system --enable-libccd --disable-shared --disable-demos
  make -j"$(nproc)" install
)

step sources debian_sources "$place" musl ode libccd libpng1.6 sundials zlib
step headers copy_headers
step libccd build_libccd
step sundials build_sundials
step zlib build_zlib
step libpng build_libpng
step ode build_ode
