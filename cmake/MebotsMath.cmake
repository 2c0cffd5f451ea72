# SPDX-License-Identifier: Apache-2.0
# Adds the target mebots_math: the mathematical functions of musl's C library, copied from Debian's static archive. glibc selects variants of sin(),
# exp(), pow() ... by the processor (with FMA or without), and their last bits differ. musl has one variant of each, for any x86-64. Functions that
# are exact in both (sqrt, floor, fmod, remainder ...) are still glibc's.

set(functions
  acos acosh asin asinh atan atan2 atanh cbrt cos cosh erf exp exp10 exp2 expm1 hypot lgamma log log10 log1p log2
  pow sin sincos sinh tan tanh tgamma)
set(functions_of_float ${functions})
list(TRANSFORM functions_of_float APPEND f)
list(APPEND functions ${functions_of_float})

# Internal functions that the mathematical functions call.
set(helpers
  __cos __cosdf __expo2 __expo2f __math_divzero __math_divzerof __math_invalid __math_invalidf __math_oflow __math_oflowf
  __math_uflow __math_uflowf __math_xflow __math_xflowf __rem_pio2 __rem_pio2_large __rem_pio2f __sin __sindf __tan __tandf
  exp2f_data exp_data lgamma_r lgammaf_r log2_data log2f_data log_data logf_data pow_data powf_data signgam)

find_file(MUSL_ARCHIVE libc.a PATHS /usr/lib/${CMAKE_SYSTEM_PROCESSOR}-linux-musl NO_DEFAULT_PATH)
if(NOT MUSL_ARCHIVE)
  message(FATAL_ERROR "musl's static library is missing, from which MEbots takes its mathematical functions: install musl-dev "
    "(scripts/setup.sh does), or say -DMUSL_ARCHIVE=<.../libc.a>")
endif()

set(folder ${PROJECT_BINARY_DIR}/musl)
set(members ${functions} ${helpers})
list(TRANSFORM members APPEND .lo)
# Members that have not changed keep their time, so that a new configuration does not link everything again.
file(MAKE_DIRECTORY ${folder}/extracted)
execute_process(COMMAND ${CMAKE_AR} x ${MUSL_ARCHIVE} ${members} WORKING_DIRECTORY ${folder}/extracted COMMAND_ERROR_IS_FATAL ANY)
foreach(member IN LISTS members)
  file(COPY_FILE ${folder}/extracted/${member} ${folder}/${member} ONLY_IF_DIFFERENT)
endforeach()
file(REMOVE_RECURSE ${folder}/extracted)
set(objects ${members})
list(TRANSFORM objects PREPEND ${folder}/)
set_source_files_properties(${objects} PROPERTIES EXTERNAL_OBJECT ON)

# If the compiler evaluated a call, or replaced it by another function, the bits could differ from the library's.
set(options ${functions})
list(TRANSFORM options PREPEND -fno-builtin-)

# Programs do not export these functions to the libraries that they load: foreign FMUs use their own functions.
add_library(mebots_math STATIC ${objects})
set_target_properties(mebots_math PROPERTIES LINKER_LANGUAGE CXX EXPORT_NAME math)
target_compile_options(mebots_math INTERFACE ${options})
target_link_options(mebots_math INTERFACE LINKER:--exclude-libs,libmebots_math.a)
add_library(mebots::math ALIAS mebots_math)

# The licence for the archives into which the library is linked.
mebots_part(math_part linked ${MUSL_ARCHIVE})
set_target_properties(mebots_math PROPERTIES MEBOTS_PART "${math_part}")
