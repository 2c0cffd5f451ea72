# SPDX-License-Identifier: Apache-2.0

# mebots_target(<target>)
# Sets the compiler options of our own code: warnings, hidden symbols, equal floating-point results on all machines,
# assertions, sanitizers, and hardening in releases. Also keeps paths of this machine out of the output.
function(mebots_target target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_link_libraries(${target} PRIVATE mebots::math)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -ffp-contract=off
    $<$<CXX_COMPILER_ID:GNU>:-Wno-restrict>)  # GCC 12 warns falsely at string + string, GCC bug 105651
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "^(aarch64|arm64)$")  # Eigen would fuse products and sums by name
    target_compile_options(${target} PRIVATE -U__ARM_FEATURE_FMA)
  endif()
  target_compile_options(${target} PRIVATE -ffile-prefix-map=${PROJECT_SOURCE_DIR}=. -ffile-prefix-map=${PROJECT_BINARY_DIR}=.)
  if(NOT MEBOTS_SANITIZE AND NOT MEBOTS_FUZZ AND NOT WIN32)
    target_compile_options(${target} PRIVATE $<$<CONFIG:Release>:-fstack-protector-strong>)
    target_compile_definitions(${target} PRIVATE $<$<CONFIG:Release>:_FORTIFY_SOURCE=2>)
    target_link_options(${target} PRIVATE $<$<CONFIG:Release>:LINKER:-z,relro,-z,now>)
  endif()
  if(CMAKE_UNITY_BUILD)  # to GCC a source is then a header, in which a member from an anonymous namespace is suspicious
    target_compile_options(${target} PRIVATE $<$<COMPILE_LANG_AND_ID:CXX,GNU>:-Wno-subobject-linkage>)
  endif()
  set_target_properties(${target} PROPERTIES CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON)
  if(MEBOTS_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  if(MEBOTS_ASSERTIONS)
    target_compile_definitions(${target} PRIVATE MEBOTS_ASSERTIONS _GLIBCXX_ASSERTIONS)
  endif()
  if(MEBOTS_SANITIZE)
    target_compile_options(${target} PRIVATE -fsanitize=${MEBOTS_SANITIZE} -fno-sanitize-recover=all -fno-omit-frame-pointer)
    target_link_options(${target} PRIVATE -fsanitize=${MEBOTS_SANITIZE})
  endif()
  if(MEBOTS_FUZZ)
    target_compile_options(${target} PRIVATE -fsanitize=fuzzer-no-link,address,undefined -fno-sanitize-recover=all)
    target_link_options(${target} PRIVATE -fsanitize=address,undefined)
  endif()
endfunction()

# mebots_test(<name> SOURCES <file>... [LIBRARIES <target>...])
# Adds a GoogleTest executable. Every TEST becomes a separate ctest with the label of its area (tests/CMakeLists.txt).
function(mebots_test name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  add_executable(${name} ${ARG_SOURCES})
  mebots_target(${name})
  target_link_libraries(${name} PRIVATE ${ARG_LIBRARIES} mebots_test_support GTest::gmock GTest::gtest_main)
  target_compile_definitions(${name} PRIVATE MEBOTS_SOURCE_DIR="${PROJECT_SOURCE_DIR}"
                             MEBOTS_BINARY_DIR="${PROJECT_BINARY_DIR}")
  # Compiles tests at -O1, which is faster. The libraries under test keep their optimisation.
  target_compile_options(${name} PRIVATE $<$<CONFIG:Release>:-O1>)
  set(longest_s 300)
  if(MEBOTS_SANITIZE)
    set(longest_s 1800)  # a whole mission is up to ten times as slow, and beside other work more
  endif()
  gtest_discover_tests(${name} PROPERTIES TIMEOUT ${longest_s} LABELS "${MEBOTS_TEST_LABEL}")
endfunction()
