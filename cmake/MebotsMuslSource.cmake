# SPDX-License-Identifier: Apache-2.0
# The sources of musl's mathematical functions, for platforms without Debian's archive and for FMUs with sources.

set(MEBOTS_MUSL_VERSION 1.2.3)
set(MEBOTS_MUSL_URL "http://deb.debian.org/debian/pool/main/m/musl/musl_${MEBOTS_MUSL_VERSION}.orig.tar.gz")
set(MEBOTS_MUSL_SHA256 7d5b0b6062521e4627e099e4c9dc8248d32a30285e959b7eecaa780cf8cfd4a4)
set(MEBOTS_MUSL_SOURCE "" CACHE FILEPATH "The archive of musl ${MEBOTS_MUSL_VERSION}'s sources; if empty, Debian's is fetched")
include(${CMAKE_CURRENT_LIST_DIR}/MebotsMathNames.cmake)
set(MEBOTS_MUSL_PREFIX ${CMAKE_CURRENT_LIST_DIR}/../modeldesc/math/musl_prefix.h)
if(MEBOTS_ROOT AND EXISTS ${MEBOTS_ROOT}/sources/modeldesc)
  set(MEBOTS_MUSL_PREFIX ${MEBOTS_ROOT}/sources/modeldesc/math/musl_prefix.h)
endif()

# mebots_musl_source(<folder variable> <files variable>)
# Returns a folder with the functions, their headers and COPYRIGHT, and the names of the files to compile. Refuses an
# archive with another hash.
function(mebots_musl_source folder_variable files_variable)
  set(place ${PROJECT_BINARY_DIR}/musl)
  set(folder ${place}/math)
  set(members ${MEBOTS_MATH_FUNCTIONS} ${MEBOTS_MATH_HELPERS})
  list(TRANSFORM members APPEND .c)
  set(${folder_variable} ${folder} PARENT_SCOPE)
  set(${files_variable} ${members} PARENT_SCOPE)
  set(stamp ${place}/.made_of_${MEBOTS_MUSL_SHA256})
  if(EXISTS ${stamp} AND NOT ${MEBOTS_MUSL_PREFIX} IS_NEWER_THAN ${stamp})
    return()
  endif()

  set(archive ${MEBOTS_MUSL_SOURCE})
  if(NOT archive)
    set(archive ${place}/musl.tar.gz)
    file(DOWNLOAD ${MEBOTS_MUSL_URL} ${archive} STATUS status TIMEOUT 120)
    list(GET status 0 failed)
    if(failed)
      list(GET status 1 reason)
      message(FATAL_ERROR "${MEBOTS_MUSL_URL}, musl's sources, cannot be fetched: ${reason}. Fetch the file elsewhere and say "
        "-DMEBOTS_MUSL_SOURCE=<the file>")
    endif()
  elseif(NOT EXISTS ${archive})
    message(FATAL_ERROR "MEBOTS_MUSL_SOURCE: there is no file ${archive}; fetch ${MEBOTS_MUSL_URL}")
  endif()
  file(SHA256 ${archive} hash)
  if(NOT hash STREQUAL MEBOTS_MUSL_SHA256)
    message(FATAL_ERROR "${archive}: this is not the archive of musl ${MEBOTS_MUSL_VERSION}: its SHA-256 is ${hash}, expected "
      "${MEBOTS_MUSL_SHA256}; fetch ${MEBOTS_MUSL_URL}")
  endif()

  file(ARCHIVE_EXTRACT INPUT ${archive} DESTINATION ${place}/unpacked)
  set(musl ${place}/unpacked/musl-${MEBOTS_MUSL_VERSION})
  file(GLOB tables ${musl}/src/math/*_data.h)
  list(TRANSFORM members PREPEND ${musl}/src/math/)
  foreach(file IN LISTS members tables ITEMS ${musl}/src/internal/libm.h ${musl}/arch/generic/fp_arch.h)
    file(READ ${file} text)
    get_filename_component(name ${file} NAME)
    string(REGEX REPLACE "#include <(endian|features)\\.h>\n" "" text "${text}")  # musl_prefix.h defines what they use
    if(name MATCHES "\\.c$")
      string(PREPEND text "#include \"musl_prefix.h\"\n")
    endif()
    file(WRITE ${folder}/${name} "${text}")
  endforeach()
  file(COPY ${MEBOTS_MUSL_PREFIX} ${musl}/COPYRIGHT DESTINATION ${folder})
  file(REMOVE_RECURSE ${place}/unpacked)
  file(TOUCH ${stamp})
endfunction()

# mebots_musl_part(<variable>)
# Returns the line for musl's functions in the list of parts (modeldesc/src/pack_fmu.hpp).
function(mebots_musl_part variable)
  set(${variable} "linked|musl|${MEBOTS_MUSL_VERSION}|MIT|pkg:generic/musl@${MEBOTS_MUSL_VERSION}|${PROJECT_BINARY_DIR}/musl/math/COPYRIGHT"
    PARENT_SCOPE)
endfunction()
