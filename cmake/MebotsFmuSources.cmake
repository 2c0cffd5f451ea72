# SPDX-License-Identifier: Apache-2.0
# The folder sources/ of an FMU contains all files that a C++20 compiler needs to build its library. The folder itself
# is the only include folder.
include(${CMAKE_CURRENT_LIST_DIR}/MebotsMuslSource.cmake)
set(MEBOTS_MODELDESC ${CMAKE_CURRENT_LIST_DIR}/../modeldesc)
if(MEBOTS_ROOT AND EXISTS ${MEBOTS_ROOT}/sources/modeldesc)
  set(MEBOTS_MODELDESC ${MEBOTS_ROOT}/sources/modeldesc)
endif()

# _mebots_stage_sources(<identifier> <generated folder> <versions of FMI> <model source>...)
# Fills <generated folder>/sources<version> with the files that no build changes. Writes a list of the files to compile
# to sources<version>.txt.
function(_mebots_stage_sources identifier out_dir versions)
  mebots_musl_source(musl musl_files)
  file(GLOB data_files RELATIVE ${MEBOTS_MODELDESC}/data ${MEBOTS_MODELDESC}/data/*.cpp)
  list(FILTER data_files EXCLUDE REGEX "^(packed|page_file|png_file)[.]cpp$")  # they need other libraries, and no model of an own FMU uses them
  foreach(version IN LISTS versions)
    set(folder ${out_dir}/sources${version})
    file(REMOVE_RECURSE ${folder} ${folder}.stamp)
    file(GLOB shell RELATIVE ${MEBOTS_MODELDESC}/shell ${MEBOTS_MODELDESC}/shell/*.cpp)
    list(FILTER shell EXCLUDE REGEX "^fmi[^${version}]|^(path|unload)")
    file(GLOB shell_files ${MEBOTS_MODELDESC}/shell/*.hpp ${MEBOTS_MODELDESC}/shell/path_*.cpp ${MEBOTS_MODELDESC}/shell/unload*.cpp)
    foreach(file IN LISTS shell)
      list(APPEND shell_files ${MEBOTS_MODELDESC}/shell/${file})
    endforeach()
    file(COPY ${shell_files} DESTINATION ${folder}/mebots_shell)
    file(WRITE ${folder}/mebots_shell/system.cpp [[
#ifdef _WIN32
#include "path_windows.cpp"
#include "unload_windows.cpp"
#else
#include "path_posix.cpp"
#include "unload.cpp"
#endif
]])
    list(APPEND shell system.cpp)
    set(data ${data_files})
    list(TRANSFORM data PREPEND ${MEBOTS_MODELDESC}/data/)
    file(COPY ${data} ${MEBOTS_MODELDESC}/data/content.hpp DESTINATION ${folder}/mebots_data)
    file(COPY ${MEBOTS_MODELDESC}/include/mebots /usr/include/fmt /usr/include/nlohmann ${musl} DESTINATION ${folder})

    set(compiled ${ARGN} src/fmu.cpp ${identifier}/variable_table.cpp)
    set(math ${musl_files})
    list(TRANSFORM shell PREPEND mebots_shell/ OUTPUT_VARIABLE shell)
    list(TRANSFORM data_files PREPEND mebots_data/ OUTPUT_VARIABLE data)
    list(TRANSFORM math PREPEND math/)
    list(APPEND compiled ${shell} ${data} ${math})
    list(JOIN compiled "\n" text)
    file(CONFIGURE OUTPUT ${out_dir}/sources${version}.txt CONTENT "${text}\n" @ONLY)
  endforeach()
endfunction()

# _mebots_add_sources(<variable> <fmu> <version> <its folder> <generated folder> <description folder> <model source>...)
# Adds the rule that copies the project's own files and the generated files into the folder. Returns the rule's output
# file.
function(_mebots_add_sources variable name version source_dir out_dir description_dir)
  set(folder ${out_dir}/sources${version})
  set(stamp ${folder}.stamp)
  get_filename_component(generated ${out_dir} NAME)
  file(GLOB_RECURSE own RELATIVE ${source_dir} CONFIGURE_DEPENDS ${source_dir}/src/*.hpp ${source_dir}/src/*.h)
  set(commands)
  set(needed)
  foreach(file IN LISTS own ARGN ITEMS src/fmu.cpp)
    list(APPEND commands COMMAND ${CMAKE_COMMAND} -E copy ${source_dir}/${file} ${folder}/${file})
    list(APPEND needed ${source_dir}/${file})
    get_filename_component(place ${folder}/${file} DIRECTORY)
    file(MAKE_DIRECTORY ${place})
  endforeach()
  foreach(file variables.hpp binding.hpp variable_table.cpp)
    list(APPEND commands COMMAND ${CMAKE_COMMAND} -E copy ${out_dir}/${file} ${folder}/${generated}/${file})
    list(APPEND needed ${out_dir}/${file})
  endforeach()
  file(MAKE_DIRECTORY ${folder}/${generated})
  if(version EQUAL 3)
    list(APPEND commands COMMAND ${CMAKE_COMMAND} -E copy ${description_dir}/buildDescription.xml ${folder}/buildDescription.xml)
    list(APPEND needed ${description_dir}/buildDescription.xml)
  endif()
  add_custom_command(OUTPUT ${stamp} ${commands} COMMAND ${CMAKE_COMMAND} -E touch ${stamp} DEPENDS ${needed}
    COMMENT "Sources of ${name} for FMI ${version}.0" VERBATIM)
  set(${variable} ${stamp} PARENT_SCOPE)
endfunction()
