# SPDX-License-Identifier: Apache-2.0
# The files that `cmake --install` writes. No file contains the path of the installation, so the tree can be moved.
#
#   bin/                                  programs
#   include/mebots/                       public headers: to run systems; in fmu/ to write FMUs; in soc/ to write devices
#   lib/                                  libraries, and the package for find_package(mebots)
#   lib/python3.x/site-packages/mebots/   the Python package
#   share/man, bash-completion, fish, zsh manual pages and completion
#   share/mebots/                         LICENSE, bill of materials (sbom.spdx.json), fmus, the page of a run with its licences (web), configs with boards and scenarios, scenes, templates, scripts;
#                                         sources: the libraries of FMUs, for other platforms; fmu_soc: sources for a chip FMU with another board or firmware
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/mebots)
set(share ${CMAKE_INSTALL_DATADIR}/mebots)

# Exports programs separately from libraries, because building firmware needs no dependencies of the libraries.
set(programs mebots mebots-fmu-host mebots-modeldesc)
set(libraries mebots_master mebots_modeldesc mebots_shell mebots_data mebots_fmt mebots_interface mebots_math)
if(MEBOTS_CHIP)
  list(APPEND programs mebots-soc mebots-boardgen)
  list(APPEND libraries soc_platform soc_files)
  set_target_properties(soc_platform PROPERTIES OUTPUT_NAME mebots_soc_platform)
  set_target_properties(soc_files PROPERTIES OUTPUT_NAME mebots_soc_files)
endif()
install(TARGETS ${programs} EXPORT mebotsPrograms RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
if(TARGET mebots_windows_host)
  install(PROGRAMS ${PROJECT_BINARY_DIR}/bin/mebots-windows-host.exe DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()
install(TARGETS ${libraries} EXPORT mebotsLibraries
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  OBJECTS DESTINATION ${CMAKE_INSTALL_LIBDIR}/mebots)
foreach(export mebotsPrograms mebotsLibraries)
  install(EXPORT ${export} NAMESPACE mebots:: DESTINATION ${package_dir})
endforeach()

set(MEBOTS_INSTALL_FMUS "" CACHE PATH
  "Folder with FMUs for several platforms, such as build/platforms of scripts/platforms.sh: they are installed instead of this build's")
if(MEBOTS_INSTALL_FMUS)
  file(GLOB fmus_to_install ${MEBOTS_INSTALL_FMUS}/*.fmu)
  if(NOT fmus_to_install)
    message(FATAL_ERROR "MEBOTS_INSTALL_FMUS: ${MEBOTS_INSTALL_FMUS} contains no FMU; run scripts/platforms.sh first, or leave the variable out")
  endif()
endif()
set(world_fmus)
foreach(count IN LISTS MEBOTS_WORLD_DRONES)
  list(APPEND world_fmus fmu_world_${count} fmu_world_${count}_fmi3)
endforeach()

# Installs the headers for running systems and for writing FMUs, and the headers that they include. Each header is
# installed once, because the compiler would treat a second copy as another file and reject its repeated declarations.
install(DIRECTORY master/include/mebots DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
file(GLOB_RECURSE modeldesc_headers RELATIVE ${PROJECT_SOURCE_DIR}/modeldesc/include CONFIGURE_DEPENDS modeldesc/include/*.hpp)
set(private_headers ${modeldesc_headers})
list(FILTER modeldesc_headers INCLUDE REGEX "^mebots/((assert|error|error_code|fmi/variable_kinds)\\.hpp$|(data|fmu|state)/)")
list(REMOVE_ITEM private_headers ${modeldesc_headers})
foreach(header IN LISTS modeldesc_headers)
  cmake_path(GET header PARENT_PATH folder)
  install(FILES modeldesc/include/${header} DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${folder})
endforeach()

install(FILES LICENSE DESTINATION ${share})
get_target_property(math_part mebots_math MEBOTS_PART)
set(MEBOTS_INSTALLED_MATH_PART ${math_part})
if(math_part MATCHES "^(.*[|])([^|]+)$")
  install(FILES ${CMAKE_MATCH_2} DESTINATION ${share}/licenses/musl-dev)
  set(MEBOTS_INSTALLED_MATH_PART "${CMAKE_MATCH_1}\${MEBOTS_ROOT}/licenses/musl-dev/copyright")
endif()

# The bill of materials of the installation: the parts inside the programs and FMUs, and the packages that they need.
get_property(parts GLOBAL PROPERTY MEBOTS_PARTS)
list(APPEND parts ${math_part})
function(mebots_list_parts relation)
  foreach(file IN LISTS ARGN)
    mebots_part(part ${relation} ${file})
    list(APPEND parts ${part})
  endforeach()
  set(parts ${parts} PARENT_SCOPE)
endfunction()
set(linked /usr/include/nlohmann/json.hpp /usr/include/fmt/core.h /usr/include/eigen3/Eigen/Core /usr/include/CLI/CLI.hpp)
# mebots-fmu-host contains these libraries, because an FMU may contain other versions of them.
execute_process(COMMAND ${CMAKE_CXX_COMPILER} -print-file-name=libstdc++.a OUTPUT_VARIABLE cxx_library
  OUTPUT_STRIP_TRAILING_WHITESPACE)
find_library(MEBOTS_STATIC_CVODE libsundials_cvode.a REQUIRED)
mark_as_advanced(MEBOTS_STATIC_CVODE)
if(TARGET mebots_windows_host)  # contains the libraries of MinGW
  foreach(library libstdc++.a libwinpthread.a libmingw32.a)
    execute_process(COMMAND ${MEBOTS_MINGW} -print-file-name=${library} OUTPUT_VARIABLE mingw_library OUTPUT_STRIP_TRAILING_WHITESPACE)
    list(APPEND linked ${mingw_library})
  endforeach()
endif()
list(APPEND linked ${cxx_library} ${MEBOTS_STATIC_PUGIXML} ${MEBOTS_STATIC_SECCOMP} ${MEBOTS_STATIC_CVODE})
set(needed)
foreach(library fmt zip pugixml png deflate crypto hdf5_serial)
  find_library(MEBOTS_NEEDED_${library} ${library})
  mark_as_advanced(MEBOTS_NEEDED_${library})
  if(MEBOTS_NEEDED_${library})
    get_filename_component(real ${MEBOTS_NEEDED_${library}} REALPATH)
    list(APPEND needed ${real})
  endif()
endforeach()
if(MEBOTS_PAGES)
  list(APPEND linked /usr/include/httplib.h)
endif()
if(MEBOTS_PYTHON)
  list(APPEND linked /usr/include/pybind11/pybind11.h)
endif()
if(MEBOTS_CHIP)
  list(APPEND linked /usr/include/xbyak/xbyak.h)
endif()
mebots_list_parts(linked ${linked})
mebots_list_parts(needed ${needed})
set(part_list ${PROJECT_BINARY_DIR}/generated/parts.txt)
mebots_write_parts(${part_list} ${parts})
mebots_license_of(${PROJECT_SOURCE_DIR}/LICENSE license_id)
set(part_lists ${part_list})
if(MEBOTS_PAGES)
  list(APPEND part_lists ${PROJECT_BINARY_DIR}/web/parts.txt)  # written by the bundler
endif()
add_custom_command(
  OUTPUT ${PROJECT_BINARY_DIR}/sbom.spdx.json
  COMMAND mebots-modeldesc sbom ${PROJECT_BINARY_DIR}/sbom.spdx.json --name mebots --product-version ${PROJECT_VERSION}
          --license-id ${license_id} --parts ${part_lists}
  DEPENDS mebots-modeldesc ${part_lists}
  COMMENT "Bill of materials"
  VERBATIM)
add_custom_target(mebots_sbom ALL DEPENDS ${PROJECT_BINARY_DIR}/sbom.spdx.json)
if(MEBOTS_PAGES)
  add_dependencies(mebots_sbom mebots_pages)
endif()
install(FILES ${PROJECT_BINARY_DIR}/sbom.spdx.json DESTINATION ${share})
install(DIRECTORY configs DESTINATION ${share})
install(DIRECTORY fmu_world/params/scenes fmu_world/params/drones fmu_world/params/things DESTINATION ${share})
install(DIRECTORY master/new_folder/templates DESTINATION ${share})
install(PROGRAMS scripts/plot_mission.py scripts/plot_profile.py DESTINATION ${share}/scripts)
install(FILES scripts/figure_style.py DESTINATION ${share}/scripts)
if(MEBOTS_PAGES)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/web/ DESTINATION ${share}/web FILES_MATCHING REGEX "(page|report)\\.(html|js|css)$|LICENSES\\.txt$"
    PATTERN CMakeFiles EXCLUDE)
endif()
foreach(fmu fmu_battery fmu_battery_fmi3 fmu_motors fmu_motors_fmi3 fmu_radio fmu_radio_fmi3 fmu_world fmu_world_fmi3 fmu_soc fmu_soc_fmi3 fmu_gap8
        fmu_gap8_drone fmu_flight_controller fmu_ai_deck_uart fmu_flight_controller_uart ${world_fmus})
  if(NOT TARGET ${fmu})
    continue()
  endif()
  set(archive ${MEBOTS_FMU_DIR}/${fmu}.fmu)
  if(MEBOTS_INSTALL_FMUS AND EXISTS ${MEBOTS_INSTALL_FMUS}/${fmu}.fmu)
    install(CODE "
      include(\"${PROJECT_SOURCE_DIR}/cmake/MebotsSameFmu.cmake\")
      mebots_require_same_fmu(\"${MEBOTS_INSTALL_FMUS}/${fmu}.fmu\" \"${archive}\")")
    set(archive ${MEBOTS_INSTALL_FMUS}/${fmu}.fmu)
  endif()
  install(FILES ${archive} DESTINATION ${share}/fmus)
endforeach()

if(MEBOTS_CHIP)
  install(DIRECTORY fmu_soc/include/mebots/soc DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/mebots)
  install(DIRECTORY fmu_soc/firmware/runtime fmu_soc/firmware/drivers fmu_soc/firmware/gap8
    fmu_soc/firmware/kernels fmu_soc/firmware/app fmu_soc/firmware/flight DESTINATION ${share}/fmu_soc/firmware)
  foreach(board gap8_drone ai_deck_uart flight_controller_uart)
    install(FILES ${PROJECT_BINARY_DIR}/boards/${board}.json DESTINATION ${share}/configs/boards)
  endforeach()
  # Private headers for mebots_soc_fmu(), which compiles its model with the variables of each board.
  install(FILES fmu_soc/description.json fmu_soc/model.png DESTINATION ${share}/fmu_soc)
  install(DIRECTORY fmu_soc/boards DESTINATION ${share}/fmu_soc)
  install(FILES fmu_soc/src/fmu.cpp DESTINATION ${share}/fmu_soc/src)
  install(FILES fmu_soc/src/fmu/model.cpp fmu_soc/src/fmu/variable_fields.cpp DESTINATION ${share}/fmu_soc/src/fmu)
  # Installs the headers that fmu.cpp, model.cpp and variable_fields.cpp include. The list is determined during the
  # installation.
  install(CODE "
    set(root \"${PROJECT_SOURCE_DIR}/fmu_soc/src\")
    include(\"${PROJECT_SOURCE_DIR}/cmake/MebotsHeaders.cmake\")
    mebots_included_headers(headers \${root} fmu.cpp fmu/model.cpp fmu/variable_fields.cpp)
    foreach(header IN LISTS headers)
      cmake_path(GET header PARENT_PATH folder)
      file(INSTALL \${root}/\${header} DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${share}/fmu_soc/src/\${folder}\")
    endforeach()")
  foreach(header IN LISTS private_headers)
    cmake_path(GET header PARENT_PATH folder)
    install(FILES modeldesc/include/${header} DESTINATION ${share}/fmu_soc/src/${folder})
  endforeach()
  install(FILES ${PROJECT_BINARY_DIR}/generated/fmu_soc_board/board.hpp DESTINATION ${share}/fmu_soc/src/fmu_soc_board)
  foreach(table op_enum op_traits op_names format_enum format_rows)  # which installed headers include
    install(FILES ${PROJECT_BINARY_DIR}/generated/fmu_soc_isa/${table}.inc DESTINATION ${share}/fmu_soc/src/fmu_soc_isa)
  endforeach()
endif()

# The file is not at the top of the build folder, because find_package() would use it as that folder's package.
set(installed_package ${PROJECT_BINARY_DIR}/generated/package)
configure_package_config_file(cmake/mebotsConfig.cmake.in ${installed_package}/mebotsConfig.cmake
  INSTALL_DESTINATION ${package_dir} PATH_VARS share CMAKE_INSTALL_BINDIR NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${installed_package}/mebotsConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${installed_package}/mebotsConfig.cmake ${installed_package}/mebotsConfigVersion.cmake
  cmake/MebotsFmu.cmake cmake/MebotsParts.cmake cmake/MebotsSoc.cmake cmake/MebotsRust.cmake cmake/BoardWith.cmake cmake/MebotsTarget.cmake cmake/fmi2.map cmake/fmi3.map cmake/list_exports.cmake
  cmake/MebotsCross.cmake cmake/MebotsFmuSources.cmake cmake/MebotsMath.cmake cmake/MebotsMathNames.cmake cmake/MebotsMuslSource.cmake
  cmake/MebotsPlatforms.cmake
  DESTINATION ${package_dir})

# Installs the sources of the libraries of FMUs, for other platforms and for FMUs with sources.
install(FILES modeldesc/CMakeLists.txt DESTINATION ${share}/sources/modeldesc)
install(DIRECTORY modeldesc/data modeldesc/include modeldesc/math modeldesc/shell DESTINATION ${share}/sources/modeldesc)

# find_package(mebots COMPONENTS firmware) also finds a build folder if it is in CMAKE_PREFIX_PATH, or if its bin/ is in PATH.
set(build_package ${PROJECT_BINARY_DIR}/lib/cmake/mebots)
export(TARGETS ${programs} NAMESPACE mebots:: FILE ${build_package}/mebotsPrograms.cmake)
configure_file(cmake/mebotsBuildConfig.cmake.in ${build_package}/mebotsConfig.cmake @ONLY)
file(COPY_FILE ${installed_package}/mebotsConfigVersion.cmake ${build_package}/mebotsConfigVersion.cmake)

include(MebotsManual)
include(MebotsPackage)

# Links these files next to bin/, where programs of the build search for them.
foreach(data configs master/new_folder/templates)
  get_filename_component(name ${data} NAME)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${data} ${PROJECT_BINARY_DIR}/${name} SYMBOLIC)
endforeach()
