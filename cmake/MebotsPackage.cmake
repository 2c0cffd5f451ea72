# SPDX-License-Identifier: Apache-2.0
# Builds a Debian package of the installation: run `cpack` in the build folder. scripts/package.sh builds the package
# and tests it in a clean system. dpkg-shlibdeps finds the libraries that the programs need. Building firmware or FMUs
# with the package also needs the compilers. The default address ends in .invalid, which is never a real domain (RFC
# 2606). scripts/release.sh requires the publisher's address.
set(MEBOTS_MAINTAINER "nobody yet <unset@mebots.invalid>" CACHE STRING "The maintainer that the Debian package names, as NAME <ADDRESS>")
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME mebots)
set(CPACK_PACKAGE_VENDOR MEbots)
set(CPACK_PACKAGE_CONTACT "${MEBOTS_MAINTAINER}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_RECOMMENDS "python3, python3-numpy, bubblewrap")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS "g++, cmake, ninja-build, gcc-riscv64-unknown-elf, picolibc-riscv64-unknown-elf")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION "Runs systems of FMI 2.0 co-simulation FMUs from a config, with four of its own:
a RISC-V chip that runs the real firmware, a battery, motors, and a world with
a drone, gates and a camera.")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${PROJECT_SOURCE_DIR}/cmake/debian/prerm)
include(CPack)
