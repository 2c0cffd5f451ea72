# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` lays down. Nothing in it knows where it is: the tree can be moved.
#
#   bin/                                  programs
#   include/mebots/                       public headers: who runs systems, fmu/ who writes FMUs, soc/ who writes devices
#   lib/                                  libraries, and the package for find_package(mebots)
#   lib/python3.x/site-packages/mebots/   the Python package
#   share/mebots/                         fmus, the page of a run with its licences (web), configs with boards and scenarios, scenes, templates, scripts;
#                                         fmu_soc: what a chip FMU with another board or firmware is built of
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/mebots)
set(share ${CMAKE_INSTALL_DATADIR}/mebots)

# Programs apart from libraries: who builds firmware needs none of the libraries' dependencies.
set(programs mebots mebots-fmu-host mebots-modeldesc)
set(libraries mebots_master mebots_modeldesc mebots_shell mebots_data mebots_interface mebots_math)
if(MEBOTS_CHIP)
  list(APPEND programs mebots-soc mebots-boardgen)
  list(APPEND libraries soc_platform soc_files)
  set_target_properties(soc_platform PROPERTIES OUTPUT_NAME mebots_soc_platform)
  set_target_properties(soc_files PROPERTIES OUTPUT_NAME mebots_soc_files)
endif()
install(TARGETS ${programs} EXPORT mebotsPrograms RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS ${libraries} EXPORT mebotsLibraries
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  OBJECTS DESTINATION ${CMAKE_INSTALL_LIBDIR}/mebots)
foreach(export mebotsPrograms mebotsLibraries)
  install(EXPORT ${export} NAMESPACE mebots:: DESTINATION ${package_dir})
endforeach()

# The headers of who runs systems, of who writes FMUs, and what these include.
install(DIRECTORY master/include/mebots DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES modeldesc/include/mebots/assert.hpp modeldesc/include/mebots/error.hpp modeldesc/include/mebots/error_code.hpp
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/mebots)
install(FILES modeldesc/include/mebots/fmi2/variable_kinds.hpp DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/mebots/fmi2)
install(DIRECTORY modeldesc/include/mebots/data modeldesc/include/mebots/fmu modeldesc/include/mebots/state
  DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/mebots)

install(FILES LICENSE DESTINATION ${share})
get_target_property(math_license mebots_math MEBOTS_LICENSE)
if(math_license)
  install(FILES ${math_license} DESTINATION ${share}/licenses/musl-dev)
endif()
install(DIRECTORY configs DESTINATION ${share})
install(DIRECTORY fmu_world/params/scenes DESTINATION ${share})
install(DIRECTORY master/new_folder/templates DESTINATION ${share})
install(PROGRAMS scripts/plot_mission.py scripts/plot_profile.py DESTINATION ${share}/scripts)
install(FILES scripts/figure_style.py DESTINATION ${share}/scripts)
if(MEBOTS_PAGES)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/web/ DESTINATION ${share}/web FILES_MATCHING REGEX "page\\.(html|js|css)$|LICENSES\\.txt$"
    PATTERN CMakeFiles EXCLUDE)
endif()
foreach(fmu fmu_battery fmu_motors fmu_world fmu_soc)
  if(TARGET ${fmu})
    install(FILES ${MEBOTS_FMU_DIR}/${fmu}.fmu DESTINATION ${share}/fmus)
  endif()
endforeach()

if(MEBOTS_CHIP)
  install(DIRECTORY fmu_soc/include/mebots/soc DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/mebots)
  install(DIRECTORY fmu_soc/firmware/runtime fmu_soc/firmware/drivers DESTINATION ${share}/fmu_soc/firmware)
  # For mebots_soc_fmu(): its model is compiled with the variables of each board. No public headers.
  install(FILES fmu_soc/description.json fmu_soc/model.png DESTINATION ${share}/fmu_soc)
  install(FILES fmu_soc/src/model.cpp fmu_soc/src/variable_fields.cpp fmu_soc/src/fmu.cpp DESTINATION ${share}/fmu_soc/src)
  install(DIRECTORY fmu_soc/src/ modeldesc/include/ DESTINATION ${share}/fmu_soc/src FILES_MATCHING PATTERN "*.hpp" PATTERN "*.inc")
  install(FILES ${PROJECT_BINARY_DIR}/generated/fmu_soc_board/board.hpp DESTINATION ${share}/fmu_soc/src/fmu_soc_board)
endif()

configure_package_config_file(cmake/mebotsConfig.cmake.in ${PROJECT_BINARY_DIR}/mebotsConfig.cmake
  INSTALL_DESTINATION ${package_dir} PATH_VARS share NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/mebotsConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/mebotsConfig.cmake ${PROJECT_BINARY_DIR}/mebotsConfigVersion.cmake
  cmake/MebotsFmu.cmake cmake/MebotsSoc.cmake cmake/MebotsTarget.cmake cmake/fmi2.map
  DESTINATION ${package_dir})

# Programs of the build find the same beside bin/.
foreach(data configs master/new_folder/templates)
  get_filename_component(name ${data} NAME)
  file(CREATE_LINK ${PROJECT_SOURCE_DIR}/${data} ${PROJECT_BINARY_DIR}/${name} SYMBOLIC)
endforeach()
