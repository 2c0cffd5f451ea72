# SPDX-License-Identifier: Apache-2.0
# Included if a project is built for another platform (MEBOTS_PLATFORM, cmake/MebotsPlatforms.cmake). Compiles the
# libraries of FMUs from the installed sources, because the installed libraries are for this machine. MEBOTS_HOST_TOOLS
# is the folder with programs for this machine.

# These libraries contain only headers, which are the same on all platforms. They are linked into a separate folder,
# because /usr/include also contains headers for this machine.
foreach(library "fmt::fmt-header-only;fmt;libfmt-dev" "nlohmann_json::nlohmann_json;nlohmann;nlohmann-json3-dev")
  list(GET library 0 target)
  list(GET library 1 folder)
  list(GET library 2 package)
  if(NOT IS_DIRECTORY /usr/include/${folder})
    message(FATAL_ERROR "the headers in /usr/include/${folder} are missing: apt-get install ${package}")
  endif()
  file(MAKE_DIRECTORY ${PROJECT_BINARY_DIR}/headers)
  file(CREATE_LINK /usr/include/${folder} ${PROJECT_BINARY_DIR}/headers/${folder} SYMBOLIC)
  add_library(${target} INTERFACE IMPORTED GLOBAL)
  set_target_properties(${target} PROPERTIES INTERFACE_INCLUDE_DIRECTORIES ${PROJECT_BINARY_DIR}/headers)
endforeach()

include(${CMAKE_CURRENT_LIST_DIR}/MebotsMath.cmake)
add_subdirectory(${MEBOTS_ROOT}/sources/modeldesc ${PROJECT_BINARY_DIR}/mebots EXCLUDE_FROM_ALL)
foreach(library fmt data shell)
  target_compile_options(mebots_${library} PRIVATE -ffile-prefix-map=${MEBOTS_ROOT}/sources=mebots)
endforeach()
