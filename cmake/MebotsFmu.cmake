# SPDX-License-Identifier: Apache-2.0

# mebots_add_fmu(<name>
#   MODEL_SOURCES <file>...       plain C++ model, free of FMI: becomes the library <name>_model
#   [MODEL_LIBRARIES <target>...] libraries that the model links
#   [MODEL_DEFINITIONS <NAME=value>...] macros for compiling its sources
#   [BUNDLE <file>...]            shared libraries that are packed next to the FMU's own
#   [LINKED_IN <file>...]         files of the libraries that are linked in: their licences and their rows in the bill of
#                                 materials (documentation/sbom.spdx.json) go into the archive
#   [BOARD <file>]                board description whose variables join description.json
#   [RESOURCES <dir>...]          folders whose contents are packed into resources/
#   [RESOURCE_FILES <file>...]    single files that are packed into resources/, also built ones
#   [SOURCE_DIR <dir>]            where all files are searched, instead of the calling folder
#   [IDENTIFIER <name>]           the "name" of description.json, when the archive has another one
#   [COUNT <n>]                   copies of what description.json repeats, such as drones; default: 1
#   [MODEL <target>]              the model's library of another mebots_add_fmu(), instead of MODEL_SOURCES
#   [FMI <version>...]            2, 3 or both; default: "fmi" of description.json, else 2
# )
# Uses description.json, src/fmu.cpp, LICENSE, model.png and reference/ of the calling folder. Only the FMU whose
# archive has the name in description.json contains reference/. Builds ${MEBOTS_FMU_DIR}/<name>.fmu; by default,
# MEBOTS_FMU_DIR is fmus/ in the build folder. With both versions of FMI, this archive is of FMI 2.0, and
# <name>_fmi3.fmu is of FMI 3.0. The targets are <name>_archive and <name>_fmi3_archive. Can be used in this tree and
# after find_package(mebots). MEBOTS_PLATFORMS adds binaries for other platforms, MEBOTS_FMU_SOURCES adds the sources
# (MebotsPlatforms.cmake).
include(${CMAKE_CURRENT_LIST_DIR}/MebotsPlatforms.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/MebotsFmuSources.cmake)

function(mebots_add_fmu name)
  cmake_parse_arguments(ARG "" "BOARD;SOURCE_DIR;IDENTIFIER;COUNT;MODEL"
    "FMI;MODEL_SOURCES;MODEL_LIBRARIES;MODEL_DEFINITIONS;BUNDLE;LINKED_IN;RESOURCES;RESOURCE_FILES" ${ARGN})
  set(source_dir ${CMAKE_CURRENT_SOURCE_DIR})
  if(ARG_SOURCE_DIR)
    get_filename_component(source_dir ${ARG_SOURCE_DIR} ABSOLUTE)
  endif()
  set(generated_dir ${PROJECT_BINARY_DIR}/generated)
  set(binary_dir ${PROJECT_BINARY_DIR}/fmu_binaries)
  set(identifier ${name})
  if(ARG_IDENTIFIER AND NOT ARG_IDENTIFIER STREQUAL name)
    set(identifier ${ARG_IDENTIFIER})
    set(generated_dir ${generated_dir}/${name})
    set(binary_dir ${binary_dir}/${name})
  endif()
  set(out_dir ${generated_dir}/${identifier})
  if(NOT MEBOTS_FMU_DIR)
    set(MEBOTS_FMU_DIR ${PROJECT_BINARY_DIR}/fmus)
  endif()

  _mebots_fmi_versions(versions ${source_dir}/description.json ${ARG_FMI})
  set(generate_options)
  foreach(version IN LISTS versions)
    list(APPEND generate_options --fmi ${version})
  endforeach()
  if(EXISTS ${source_dir}/model.png)
    list(APPEND generate_options --icon)
  endif()
  set(fmi3_dir ${out_dir})
  if(versions STREQUAL "2;3")
    set(fmi3_dir ${out_dir}/fmi3)
  endif()
  set(outputs ${out_dir}/variables.hpp ${out_dir}/binding.hpp ${out_dir}/variable_table.cpp ${out_dir}/modelDescription.xml
      ${out_dir}/index.html)
  if(3 IN_LIST versions)
    list(APPEND outputs ${fmi3_dir}/modelDescription.xml ${fmi3_dir}/index.html ${fmi3_dir}/terminalsAndIcons.xml)
    list(REMOVE_DUPLICATES outputs)
  endif()

  if(MEBOTS_FMU_SOURCES)
    if(ARG_BOARD OR ARG_MODEL OR ARG_MODEL_LIBRARIES OR ARG_MODEL_DEFINITIONS OR ARG_BUNDLE)
      message(FATAL_ERROR "MEBOTS_FMU_SOURCES: the sources of ${name} are not complete, because it uses BOARD, MODEL, MODEL_LIBRARIES, "
        "MODEL_DEFINITIONS or BUNDLE; only an FMU made of MODEL_SOURCES alone can carry its sources")
    endif()
    _mebots_stage_sources(${identifier} ${out_dir} "${versions}" ${ARG_MODEL_SOURCES})
    foreach(version IN LISTS versions)
      list(APPEND generate_options --fmi${version}-sources ${out_dir}/sources${version}.txt)
    endforeach()
    if(3 IN_LIST versions)
      list(APPEND outputs ${fmi3_dir}/buildDescription.xml)
    endif()
  endif()

  set(board_option)
  if(ARG_BOARD)
    get_filename_component(ARG_BOARD ${ARG_BOARD} ABSOLUTE)
    set(board_option --board ${ARG_BOARD})
  endif()
  if(ARG_COUNT)
    list(APPEND generate_options --count ${ARG_COUNT})
  endif()
  add_custom_command(
    OUTPUT ${outputs}
    COMMAND mebots::mebots-modeldesc generate ${source_dir}/description.json ${board_option} ${generate_options} --out ${out_dir}
    DEPENDS mebots::mebots-modeldesc ${source_dir}/description.json ${ARG_BOARD}
    COMMENT "Describing ${name}"
    VERBATIM)
  add_custom_target(${name}_description DEPENDS ${out_dir}/modelDescription.xml ${out_dir}/variables.hpp)

  set(model ${ARG_MODEL})
  if(NOT model)
    set(model ${name}_model)
    add_library(${model} STATIC ${ARG_MODEL_SOURCES})
    set_target_properties(${model} PROPERTIES POSITION_INDEPENDENT_CODE ON)
    mebots_target(${model})
    add_dependencies(${model} ${name}_description)
    target_include_directories(${model} PUBLIC ${generated_dir} ${source_dir}/src)
    target_compile_definitions(${model} PRIVATE ${ARG_MODEL_DEFINITIONS})
    target_link_libraries(${model} PUBLIC mebots::interface mebots::data ${ARG_MODEL_LIBRARIES} PRIVATE mebots::fmt nlohmann_json::nlohmann_json)
  endif()

  add_library(${name}_binding OBJECT ${source_dir}/src/fmu.cpp ${out_dir}/variable_table.cpp)
  set_target_properties(${name}_binding PROPERTIES POSITION_INDEPENDENT_CODE ON)
  mebots_target(${name}_binding)
  add_dependencies(${name}_binding ${name}_description)
  target_include_directories(${name}_binding BEFORE PRIVATE ${generated_dir})  # before those of another FMU's model
  target_link_libraries(${name}_binding PRIVATE ${model} mebots::fmt)

  set(pack_options)
  foreach(license ${source_dir}/LICENSE ${source_dir}/../LICENSE ${PROJECT_SOURCE_DIR}/LICENSE)
    if(EXISTS ${license})
      list(APPEND pack_options --license ${license})
      mebots_license_of(${license} license_id)
      if(license_id)
        list(APPEND pack_options --license-id ${license_id})
      endif()
      break()
    endif()
  endforeach()
  foreach(file IN LISTS ARG_BUNDLE)
    list(APPEND pack_options --library ${file})
  endforeach()
  execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=libstdc++.a OUTPUT_VARIABLE cxx_library
    OUTPUT_STRIP_TRAILING_WHITESPACE)
  get_target_property(parts mebots::math MEBOTS_PART)
  foreach(file IN LISTS ARG_BUNDLE)
    mebots_part(part bundled ${file})
    list(APPEND parts ${part})
  endforeach()
  foreach(file IN LISTS ARG_LINKED_IN ITEMS ${cxx_library} /usr/include/fmt/core.h /usr/include/nlohmann/json.hpp)
    mebots_part(part linked ${file})
    list(APPEND parts ${part})
  endforeach()
  set(part_list ${out_dir}/parts.txt)
  mebots_write_parts(${part_list} ${parts})
  set_property(GLOBAL APPEND PROPERTY MEBOTS_PARTS ${parts})
  list(APPEND pack_options --parts ${part_list})
  set(resource_dependencies)
  foreach(folder IN LISTS ARG_RESOURCES)
    get_filename_component(folder ${folder} ABSOLUTE)
    list(APPEND pack_options --resources ${folder})
    file(GLOB_RECURSE files CONFIGURE_DEPENDS ${folder}/*)
    list(APPEND resource_dependencies ${files})
  endforeach()
  foreach(file IN LISTS ARG_RESOURCE_FILES)
    get_filename_component(file ${file} ABSOLUTE)
    list(APPEND pack_options --resource-file ${file})
    list(APPEND resource_dependencies ${file})
  endforeach()
  set(optional_files)
  if(EXISTS ${source_dir}/model.png)
    list(APPEND pack_options --icon ${source_dir}/model.png)
    list(APPEND optional_files ${source_dir}/model.png)
  endif()
  if(identifier STREQUAL name AND IS_DIRECTORY ${source_dir}/reference)
    list(APPEND pack_options --reference ${source_dir}/reference)
    file(GLOB files CONFIGURE_DEPENDS ${source_dir}/reference/*)
    list(APPEND optional_files ${files})
  endif()
  foreach(version IN LISTS versions)
    set(target ${name})
    set(description_dir ${out_dir})
    set(library_dir ${binary_dir})
    set(version_options)
    if(version EQUAL 3)
      set(description_dir ${fmi3_dir})
      set(version_options --terminals ${fmi3_dir}/terminalsAndIcons.xml)
      if(2 IN_LIST versions)
        set(target ${name}_fmi3)
        set(library_dir ${binary_dir}/fmi3)
      endif()
    endif()
    _mebots_fmu_library(${target} ${name} ${model} ${identifier} ${version} ${library_dir})
    set(source_stamp)
    if(MEBOTS_FMU_SOURCES)
      _mebots_add_sources(source_stamp ${name} ${version} ${source_dir} ${out_dir} ${description_dir} ${ARG_MODEL_SOURCES})
      list(APPEND version_options --sources ${out_dir}/sources${version})
    endif()
    set(archive ${MEBOTS_FMU_DIR}/${target}.fmu)
    if(MEBOTS_PLATFORMS)
      set(archive ${PROJECT_BINARY_DIR}/platforms/own/${target}.fmu)
    endif()
    add_custom_command(
      OUTPUT ${archive}
      COMMAND mebots::mebots-modeldesc pack ${archive} --description ${description_dir}/modelDescription.xml
              --documentation ${description_dir}/index.html --binary $<TARGET_FILE:${target}> ${pack_options} ${version_options}
      DEPENDS mebots::mebots-modeldesc ${target} ${description_dir}/modelDescription.xml ${description_dir}/index.html ${part_list}
              ${resource_dependencies} ${optional_files} ${source_stamp}
      COMMENT "Packing ${target}.fmu"
      VERBATIM)
    if(MEBOTS_PLATFORMS)
      _mebots_merge_archives(${target} ${archive} ${MEBOTS_FMU_DIR}/${target}.fmu)
    else()
      add_custom_target(${target}_archive ALL DEPENDS ${archive})
    endif()
    if(MEBOTS_PLATFORM)
      if(NOT TARGET mebots_archives)
        add_custom_target(mebots_archives)
      endif()
      add_dependencies(mebots_archives ${target}_archive)
    endif()
  endforeach()
endfunction()

# Returns the versions of FMI to build: the arguments, else the versions in the description, else 2.
function(_mebots_fmi_versions result description)
  set(versions ${ARGN})
  if(NOT versions)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${description})
    file(READ ${description} text)
    string(JSON versions ERROR_VARIABLE missing GET "${text}" fmi)
    if(missing)
      set(versions 2)
    else()
      string(REGEX MATCHALL "[0-9]+" versions "${versions}")
    endif()
  endif()
  list(REMOVE_DUPLICATES versions)
  list(SORT versions)
  foreach(version IN LISTS versions)
    if(NOT version MATCHES "^[23]$")
      message(FATAL_ERROR "${description}: there is no FMI ${version}; use 2, 3 or both")
    endif()
  endforeach()
  set(${result} "${versions}" PARENT_SCOPE)
endfunction()

# Adds the shared library of the FMU `name` for one version of FMI. It exports only the functions of this version.
function(_mebots_fmu_library target name model identifier version folder)
  add_library(${target} MODULE $<TARGET_OBJECTS:${name}_binding>)
  mebots_target(${target})
  set_target_properties(${target} PROPERTIES PREFIX "" OUTPUT_NAME ${identifier} LINKER_LANGUAGE CXX LIBRARY_OUTPUT_DIRECTORY ${folder})
  target_link_libraries(${target} PRIVATE mebots::shell ${model} mebots::fmt)
  if(WIN32)
    _mebots_export_from_dll(${target} ${version})
    target_link_options(${target} PRIVATE -static -s)  # the C++ library and the threads that it uses are inside; no symbols
    return()
  endif()
  set_target_properties(${target} PROPERTIES BUILD_RPATH "\$ORIGIN" BUILD_RPATH_USE_ORIGIN ON SKIP_BUILD_RPATH OFF)
  set(version_script ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/fmi${version}.map)
  target_link_options(${target} PRIVATE -Wl,--version-script=${version_script} -Wl,--disable-new-dtags)
  set_target_properties(${target} PROPERTIES LINK_DEPENDS ${version_script})
  if(NOT MEBOTS_SANITIZE)
    # Omits unused code, such as functions of the C++ library that change the process. A library that imports none of
    # them can run several missions of a study in one process.
    target_link_options(${target} PRIVATE -static-libstdc++ -static-libgcc -Wl,-z,defs -Wl,--gc-sections)
  endif()
endfunction()

# Linkers for Windows do not support version scripts. They read a list of the exported names.
function(_mebots_export_from_dll target version)
  set(list ${CMAKE_CURRENT_BINARY_DIR}/${target}.def)
  set(script ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/list_exports.cmake)
  add_custom_command(
    OUTPUT ${list}
    COMMAND ${CMAKE_COMMAND} -DNM=${CMAKE_NM} -DPREFIX=fmi${version} "-DOBJECTS=$<TARGET_OBJECTS:mebots_shell>" -DOUT=${list} -P ${script}
    DEPENDS $<TARGET_OBJECTS:mebots_shell> ${script}
    COMMENT "Exports of ${target}"
    VERBATIM)
  target_sources(${target} PRIVATE ${list})
endfunction()
