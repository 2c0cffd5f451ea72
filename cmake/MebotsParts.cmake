# SPDX-License-Identifier: Apache-2.0
# Third-party software in the build: the source of the licence files and of the bills of materials.

# Regular expressions for Debian's packages, and their licences as SPDX expressions. Other packages have the licence
# NOASSERTION. The text of the licence is always included.
set(MEBOTS_PACKAGE_LICENSES
  "libstdc\\+\\+-.*-dev|GPL-3.0-or-later WITH GCC-exception-3.1"
  "g\\+\\+-mingw-w64-.*|GPL-3.0-or-later WITH GCC-exception-3.1"
  "gcc-riscv64-unknown-elf|GPL-3.0-or-later WITH GCC-exception-3.1"
  "picolibc-riscv64-unknown-elf|BSD-3-Clause"
  "musl-dev|MIT"
  "libfmt.*|MIT"
  "nlohmann-json3-dev|MIT"
  "libeigen3-dev|MPL-2.0"
  "libode-dev|BSD-3-Clause OR LGPL-2.1-or-later"
  "libccd.*|BSD-3-Clause"
  "libsundials-dev|BSD-3-Clause"
  "libcli11-dev|BSD-3-Clause"
  "libcpp-httplib.*|MIT"
  "libxbyak-dev|BSD-3-Clause"
  "pybind11-dev|BSD-3-Clause"
  "libssl.*|Apache-2.0"
  "libpng.*|libpng-2.0"
  "libtinygltf.*|MIT"
  "zlib1g.*|Zlib"
  "libdeflate.*|MIT"
  "libzip.*|BSD-3-Clause"
  "libpugixml.*|MIT"
  "libhdf5.*|BSD-3-Clause"
  "libseccomp.*|LGPL-2.1-only")

# mebots_part(<variable> linked|bundled|needed <file>)
# Returns a line for the list of parts (modeldesc/src/pack_fmu.hpp): the Debian package that contains <file>. If no
# package contains it, returns an empty text.
function(mebots_part variable relation file)
  set(${variable} "" PARENT_SCOPE)
  get_filename_component(real_file ${file} REALPATH)
  string(REGEX REPLACE "^/usr/" "/" old_file ${real_file})  # as Debian knows what was in /lib before it moved
  foreach(candidate ${file} ${real_file} ${old_file})
    execute_process(COMMAND dpkg-query --search ${candidate} OUTPUT_VARIABLE found ERROR_QUIET RESULT_VARIABLE failed)
    if(failed OR NOT found MATCHES "^([^:, ]+)")
      continue()
    endif()
    set(package ${CMAKE_MATCH_1})
    execute_process(COMMAND dpkg-query --show "--showformat=\${Version} \${Architecture}\n" ${package}
      OUTPUT_VARIABLE about ERROR_QUIET)
    if(NOT about MATCHES "^([^ ]+) ([^\n]+)")
      continue()
    endif()
    set(version ${CMAKE_MATCH_1})
    set(architecture ${CMAKE_MATCH_2})
    set(license)
    foreach(row IN LISTS MEBOTS_PACKAGE_LICENSES)
      string(REGEX MATCH "^(.*)[|](.*)$" row "${row}")
      set(expression ${CMAKE_MATCH_2})
      if(package MATCHES "^${CMAKE_MATCH_1}$")
        set(license ${expression})
      endif()
    endforeach()
    set(text /usr/share/doc/${package}/copyright)
    if(NOT EXISTS ${text})
      set(text)
    endif()
    string(REPLACE ":" "%3A" version_in_url ${version})
    string(REPLACE "+" "%2B" version_in_url ${version_in_url})
    string(REPLACE "~" "%7E" version_in_url ${version_in_url})
    string(REPLACE "+" "%2B" package_in_url ${package})
    set(${variable} "${relation}|${package}|${version}|${license}|pkg:deb/debian/${package_in_url}@${version_in_url}?arch=${architecture}|${text}"
      PARENT_SCOPE)
    return()
  endforeach()
endfunction()

# mebots_write_parts(<file> <line>...)
# Writes the file only if its content has changed, because archives depend on it.
function(mebots_write_parts file)
  set(lines ${ARGN})
  list(REMOVE_DUPLICATES lines)
  list(REMOVE_ITEM lines "")
  list(SORT lines)
  list(JOIN lines "\n" text)
  if(text)
    string(APPEND text "\n")
  endif()
  file(CONFIGURE OUTPUT ${file} CONTENT "${text}" @ONLY)
endfunction()

# mebots_license_of(<file> <variable>)
# Returns the SPDX expression of a licence's text; empty if the text is not known.
function(mebots_license_of file variable)
  set(${variable} "" PARENT_SCOPE)
  file(READ ${file} text LIMIT 2000)
  if(text MATCHES "Apache License[ \n]+Version 2.0")
    set(${variable} Apache-2.0 PARENT_SCOPE)
  endif()
endfunction()
