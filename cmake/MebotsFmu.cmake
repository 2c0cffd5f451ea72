# SPDX-License-Identifier: Apache-2.0

# mebots_add_fmu(<name>
#   MODEL_SOURCES <file>...       plain C++ model, free of FMI: becomes the library <name>_model
#   [MODEL_LIBRARIES <target>...] what the model links
#   [MODEL_DEFINITIONS <NAME=value>...] macros that its sources are compiled with
#   [BUNDLE <file>...]            shared libraries that travel beside the FMU's own
#   [LINKED_IN <file>...]         files of the libraries that are linked in: their licences and their rows in the bill of
#                                 materials (documentation/sbom.spdx.json) go into the archive
#   [BOARD <file>]                board description whose variables join description.json
#   [RESOURCES <dir>...]          folders whose contents go to resources/
#   [RESOURCE_FILES <file>...]    single files that go to resources/; built ones too
#   [SOURCE_DIR <dir>]            where everything is looked for, instead of the calling folder
#   [IDENTIFIER <name>]           the "name" of description.json, when the archive has another one
# )
# Looks in the calling folder for description.json, src/fmu.cpp, LICENSE, model.png and reference/; reference/ is that of
# the FMU whose archive has the name of description.json.
# Builds ${MEBOTS_FMU_DIR}/<name>.fmu; fmus/ in the build folder when that is not set.
# The same inside this tree and after find_package(mebots).
function(mebots_add_fmu name)
  cmake_parse_arguments(ARG "" "BOARD;SOURCE_DIR;IDENTIFIER"
    "MODEL_SOURCES;MODEL_LIBRARIES;MODEL_DEFINITIONS;BUNDLE;LINKED_IN;RESOURCES;RESOURCE_FILES" ${ARGN})
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

  set(board_option)
  if(ARG_BOARD)
    get_filename_component(ARG_BOARD ${ARG_BOARD} ABSOLUTE)
    set(board_option --board ${ARG_BOARD})
  endif()
  add_custom_command(
    OUTPUT ${out_dir}/modelDescription.xml ${out_dir}/index.html ${out_dir}/variables.hpp
           ${out_dir}/binding.hpp ${out_dir}/variable_table.cpp
    COMMAND mebots::mebots-modeldesc generate ${source_dir}/description.json ${board_option} --out ${out_dir}
    DEPENDS mebots::mebots-modeldesc ${source_dir}/description.json ${ARG_BOARD}
    COMMENT "Describing ${name}"
    VERBATIM)
  add_custom_target(${name}_description DEPENDS ${out_dir}/modelDescription.xml ${out_dir}/variables.hpp)

  add_library(${name}_model STATIC ${ARG_MODEL_SOURCES})
  set_target_properties(${name}_model PROPERTIES POSITION_INDEPENDENT_CODE ON)
  mebots_target(${name}_model)
  add_dependencies(${name}_model ${name}_description)
  target_include_directories(${name}_model PUBLIC ${generated_dir} ${source_dir}/src)
  target_compile_definitions(${name}_model PRIVATE ${ARG_MODEL_DEFINITIONS})
  target_link_libraries(${name}_model PUBLIC mebots::interface mebots::data ${ARG_MODEL_LIBRARIES} PRIVATE fmt::fmt-header-only nlohmann_json::nlohmann_json)

  add_library(${name} MODULE ${source_dir}/src/fmu.cpp ${out_dir}/variable_table.cpp)
  mebots_target(${name})
  set_target_properties(${name} PROPERTIES PREFIX "" OUTPUT_NAME ${identifier} BUILD_RPATH "\$ORIGIN" BUILD_RPATH_USE_ORIGIN ON
    SKIP_BUILD_RPATH OFF LIBRARY_OUTPUT_DIRECTORY ${binary_dir})
  target_link_libraries(${name} PRIVATE mebots::shell ${name}_model fmt::fmt-header-only)
  set(version_script ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/fmi2.map)
  target_link_options(${name} PRIVATE -Wl,--version-script=${version_script} -Wl,--disable-new-dtags)
  set_target_properties(${name} PROPERTIES LINK_DEPENDS ${version_script})
  if(NOT MEBOTS_SANITIZE)
    # Leaves out unused code, such as the C++ library's functions that change the process: a library that imports none
    # of them can run several missions of a study in one process.
    target_link_options(${name} PRIVATE -static-libstdc++ -static-libgcc -Wl,-z,defs -Wl,--gc-sections)
  endif()

  set(archive ${MEBOTS_FMU_DIR}/${name}.fmu)
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
  add_custom_command(
    OUTPUT ${archive}
    COMMAND mebots::mebots-modeldesc pack ${archive} --description ${out_dir}/modelDescription.xml --documentation ${out_dir}/index.html
            --binary $<TARGET_FILE:${name}> ${pack_options}
    DEPENDS mebots::mebots-modeldesc ${name} ${out_dir}/modelDescription.xml ${out_dir}/index.html ${part_list} ${resource_dependencies} ${optional_files}
    COMMENT "Packing ${name}.fmu"
    VERBATIM)
  add_custom_target(${name}_archive ALL DEPENDS ${archive})
endfunction()
