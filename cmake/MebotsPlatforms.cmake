# SPDX-License-Identifier: Apache-2.0
# Builds FMUs with binaries for several platforms. MEBOTS_PLATFORMS lists the platforms, such as
# "linux64;win64;aarch64-linux". For each platform other than this machine's, the project is configured again with
# Debian's cross compiler. mebots_add_fmu() merges the archives.
include(ExternalProject)

set(MEBOTS_PLATFORMS "" CACHE STRING "Platforms of the FMUs: linux64, win64, aarch64-linux; if empty, this machine's alone")
option(MEBOTS_FMU_SOURCES "Pack the FMUs' sources into the archives, so that the importing tool can compile them" OFF)

# Returns a platform's system, processor and target triplet, the suffix of its compilers' names, and their Debian
# package.
function(_mebots_platform name system processor triplet ending package)
  if(name STREQUAL "linux64")
    set(row Linux x86_64 x86_64-linux-gnu "" g++-x86-64-linux-gnu)
  elseif(name STREQUAL "win64")
    set(row Windows x86_64 x86_64-w64-mingw32 -posix g++-mingw-w64-x86-64-posix)
  elseif(name STREQUAL "aarch64-linux")
    set(row Linux aarch64 aarch64-linux-gnu "" g++-aarch64-linux-gnu)
  else()
    message(FATAL_ERROR "MEBOTS_PLATFORMS: '${name}' is not a platform for which FMUs can be built; use linux64, win64 or aarch64-linux")
  endif()
  foreach(variable system processor triplet ending package)
    list(POP_FRONT row value)
    set(${${variable}} "${value}" PARENT_SCOPE)
  endforeach()
endfunction()

# Returns this machine's platform. If the table lacks it, returns an empty text.
function(_mebots_own_platform variable)
  set(${variable} "" PARENT_SCOPE)
  if(CMAKE_SYSTEM_NAME STREQUAL "Linux" AND CMAKE_SYSTEM_PROCESSOR STREQUAL "x86_64")
    set(${variable} linux64 PARENT_SCOPE)
  elseif(CMAKE_SYSTEM_NAME STREQUAL "Linux" AND CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
    set(${variable} aarch64-linux PARENT_SCOPE)
  endif()
endfunction()

# Writes the toolchain file of a platform. If the compiler is missing, stops with an error that names its package.
function(_mebots_write_toolchain name file)
  _mebots_platform(${name} system processor triplet ending package)
  find_program(_mebots_compiler ${triplet}-g++${ending} NO_CACHE)
  if(NOT _mebots_compiler)
    message(FATAL_ERROR "MEBOTS_PLATFORMS has ${name}, but its compiler ${triplet}-g++${ending} is missing: apt-get install ${package}")
  endif()
  file(CONFIGURE OUTPUT ${file} @ONLY CONTENT [[
set(CMAKE_SYSTEM_NAME @system@)
set(CMAKE_SYSTEM_PROCESSOR @processor@)
set(CMAKE_C_COMPILER @triplet@-gcc@ending@)
set(CMAKE_CXX_COMPILER @triplet@-g++@ending@)
set(CMAKE_FIND_ROOT_PATH /usr/@triplet@)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
]])
endfunction()

# _mebots_other_builds(<variable> <fmu target>)
# Adds a build of the project for each platform in MEBOTS_PLATFORMS other than this machine's. Sets <variable> to the paths
# of the archives of <fmu target> in these builds.
function(_mebots_other_builds variable fmu)
  if(NOT mebots_DIR)
    message(FATAL_ERROR "MEBOTS_PLATFORMS works in a project of your own that uses an installed MEbots by find_package(mebots); "
      "for MEbots' own FMUs see scripts/platforms.sh")
  endif()
  _mebots_own_platform(own)
  set(archives)
  foreach(name IN LISTS MEBOTS_PLATFORMS)
    if(name STREQUAL own)
      continue()
    endif()
    set(build ${PROJECT_BINARY_DIR}/platforms/${name})
    if(NOT TARGET mebots_${name})
      set(toolchain ${PROJECT_BINARY_DIR}/platforms/${name}.cmake)
      _mebots_write_toolchain(${name} ${toolchain})
      ExternalProject_Add(mebots_${name}
        SOURCE_DIR ${PROJECT_SOURCE_DIR}
        BINARY_DIR ${build}
        PREFIX ${PROJECT_BINARY_DIR}/platforms/steps/${name}
        CMAKE_ARGS -DCMAKE_TOOLCHAIN_FILE=${toolchain} -DMEBOTS_PLATFORM=${name} -Dmebots_DIR=${mebots_DIR}
                   -DCMAKE_BUILD_TYPE=${CMAKE_BUILD_TYPE} -DCMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER}
                   -DMEBOTS_FMU_SOURCES=${MEBOTS_FMU_SOURCES} -DMEBOTS_MUSL_SOURCE=${MEBOTS_MUSL_SOURCE}
        BUILD_COMMAND ${CMAKE_COMMAND} --build ${build} --target mebots_archives
        BUILD_ALWAYS TRUE
        INSTALL_COMMAND "")
    endif()
    list(APPEND archives ${build}/fmus/${fmu}.fmu)
  endforeach()
  set(${variable} ${archives} PARENT_SCOPE)
endfunction()

# _mebots_merge_archives(<fmu target> <this machine's archive> <archive>)
# Adds the target <fmu target>_archive, which merges the builds of MEBOTS_PLATFORMS.
function(_mebots_merge_archives fmu own_archive archive)
  _mebots_other_builds(archives ${fmu})
  set(builds)
  foreach(name IN LISTS MEBOTS_PLATFORMS)
    if(TARGET mebots_${name})
      list(APPEND builds mebots_${name})
    endif()
  endforeach()
  _mebots_own_platform(own)
  if(own IN_LIST MEBOTS_PLATFORMS)
    list(PREPEND archives ${own_archive})
  endif()
  list(LENGTH archives count)
  if(count EQUAL 1)
    set(command ${CMAKE_COMMAND} -E copy ${archives} ${archive})
  else()
    set(command mebots::mebots fmu-platforms ${archives} --out ${archive})
  endif()
  # Always runs, because only the other builds can determine whether their archives are new.
  add_custom_target(${fmu}_archive ALL
    COMMAND ${CMAKE_COMMAND} -E make_directory ${MEBOTS_FMU_DIR}
    COMMAND ${command}
    DEPENDS ${own_archive}
    COMMENT "Merging the platforms of ${fmu}.fmu"
    VERBATIM)
  if(builds)
    add_dependencies(${fmu}_archive ${builds})
  endif()
endfunction()
