#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the Debian package in build/deb and tests it in a clean Debian 12 (scripts/try_package.sh). Run
# scripts/setup.sh once before. Needs root and debootstrap. With MEBOTS_INSTALL_FMUS=build/platforms, the package
# contains the FMUs for several platforms (scripts/platforms.sh). MEBOTS_MAINTAINER='NAME <ADDRESS>' sets the package's
# maintainer.
set -euo pipefail
cd "$(dirname "$0")/.."

cmake --preset release -B build/deb -DCMAKE_INSTALL_PREFIX=/usr -DMEBOTS_SITE_PACKAGES=lib/python3/dist-packages -DMEBOTS_EXAMPLES=OFF \
  ${MEBOTS_MAINTAINER:+"-DMEBOTS_MAINTAINER=$MEBOTS_MAINTAINER"} \
  ${MEBOTS_INSTALL_FMUS:+"-DMEBOTS_INSTALL_FMUS=$(realpath "$MEBOTS_INSTALL_FMUS")"}
cmake --build build/deb
rm -f build/deb/*.deb
(cd build/deb && cpack)
scripts/try_package.sh build/deb/mebots_*.deb
