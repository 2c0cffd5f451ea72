# SPDX-License-Identifier: Apache-2.0
# What `cmake --install` lays down: programs, libraries with their headers, and the package for find_package(mebots).
include(CMakePackageConfigHelpers)
include(GNUInstallDirs)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/mebots)
install(TARGETS mebots mebots-fmu-host mebots-modeldesc mebots_master mebots_modeldesc mebots_shell mebots_data mebots_interface
  EXPORT mebotsTargets
  RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR}
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
  OBJECTS DESTINATION ${CMAKE_INSTALL_LIBDIR}/mebots)
install(EXPORT mebotsTargets NAMESPACE mebots:: DESTINATION ${package_dir})
install(DIRECTORY modeldesc/include/ master/include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(FILES LICENSE configs/mebots-config.schema.json DESTINATION ${CMAKE_INSTALL_DATADIR}/mebots)
install(DIRECTORY ${MEBOTS_FMU_DIR}/ DESTINATION ${CMAKE_INSTALL_DATADIR}/mebots/fmus
  FILES_MATCHING PATTERN "fmu_*.fmu")

configure_package_config_file(cmake/mebotsConfig.cmake.in ${PROJECT_BINARY_DIR}/mebotsConfig.cmake
  INSTALL_DESTINATION ${package_dir} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/mebotsConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/mebotsConfig.cmake ${PROJECT_BINARY_DIR}/mebotsConfigVersion.cmake
  cmake/MebotsFmu.cmake cmake/MebotsTarget.cmake cmake/fmi2.map
  DESTINATION ${package_dir})
