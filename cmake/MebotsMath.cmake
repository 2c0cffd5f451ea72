# SPDX-License-Identifier: Apache-2.0
# Adds the target mebots_math: the mathematical functions of musl's C library. They are copied from Debian's static
# archive, or compiled from Debian's sources for other platforms. glibc selects variants of sin(), exp(), pow() and
# others by the processor (with or without FMA), and their last bits differ. musl has one variant for any x86-64.
# Functions that are exact in both libraries (sqrt, floor, fmod, remainder and others) are those of glibc.

include(${CMAKE_CURRENT_LIST_DIR}/MebotsMathNames.cmake)

if(CMAKE_CROSSCOMPILING)  # Debian has no archive for Windows; in that for ARM, products and sums are fused
  enable_language(C)
  include(${CMAKE_CURRENT_LIST_DIR}/MebotsMuslSource.cmake)
  mebots_musl_source(folder objects)
  list(TRANSFORM objects PREPEND ${folder}/)
else()
  find_file(MUSL_ARCHIVE libc.a PATHS /usr/lib/${CMAKE_SYSTEM_PROCESSOR}-linux-musl NO_DEFAULT_PATH)
  if(NOT MUSL_ARCHIVE)
    message(FATAL_ERROR "musl's static library is missing, from which MEbots takes its mathematical functions: install musl-dev "
      "(scripts/setup.sh does), or say -DMUSL_ARCHIVE=<.../libc.a>")
  endif()

  set(folder ${PROJECT_BINARY_DIR}/musl)
  set(members ${MEBOTS_MATH_FUNCTIONS} ${MEBOTS_MATH_HELPERS})
  list(TRANSFORM members APPEND .lo)
  # Replaces only those object files that have changed. Otherwise, everything would be linked again after each
  # configuration.
  file(MAKE_DIRECTORY ${folder}/extracted)
  execute_process(COMMAND ${CMAKE_AR} x ${MUSL_ARCHIVE} ${members} WORKING_DIRECTORY ${folder}/extracted COMMAND_ERROR_IS_FATAL ANY)
  foreach(member IN LISTS members)
    file(COPY_FILE ${folder}/extracted/${member} ${folder}/${member} ONLY_IF_DIFFERENT)
  endforeach()
  file(REMOVE_RECURSE ${folder}/extracted)
  set(objects ${members})
  list(TRANSFORM objects PREPEND ${folder}/)
  set_source_files_properties(${objects} PROPERTIES EXTERNAL_OBJECT ON)
endif()

# Makes the compiler call these functions. If it evaluated a call or replaced a function, the bits could differ from the
# library's.
set(options ${MEBOTS_MATH_FUNCTIONS})
list(TRANSFORM options PREPEND -fno-builtin-)

# Programs do not export these functions, so that foreign FMUs use their own.
add_library(mebots_math STATIC ${objects})
set_target_properties(mebots_math PROPERTIES LINKER_LANGUAGE CXX EXPORT_NAME math UNITY_BUILD OFF)  # each file of musl has static names
target_compile_options(mebots_math INTERFACE ${options})
target_link_options(mebots_math INTERFACE LINKER:--exclude-libs,libmebots_math.a)
add_library(mebots::math ALIAS mebots_math)

# Adds the library to the list of parts, so that archives with the library contain its licence.
if(CMAKE_CROSSCOMPILING)
  mebots_musl_part(math_part)
  target_compile_options(mebots_math PRIVATE -O2 -ffp-contract=off ${options})
else()
  mebots_part(math_part linked ${MUSL_ARCHIVE})
endif()
set_target_properties(mebots_math PROPERTIES MEBOTS_PART "${math_part}")
