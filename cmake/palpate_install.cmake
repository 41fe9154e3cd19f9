# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
# find_package(palpate COMPONENTS ...) for other projects.
include(CMakePackageConfigHelpers)
configure_package_config_file(
  ${CMAKE_CURRENT_LIST_DIR}/palpateConfig.cmake.in ${PROJECT_BINARY_DIR}/palpateConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/palpate)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/palpateConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
# Part of the lowest component: whoever installs anything installs geometry.
install(FILES ${PROJECT_BINARY_DIR}/palpateConfig.cmake ${PROJECT_BINARY_DIR}/palpateConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/palpate COMPONENT geometry)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/palpate COMPONENT geometry)
# For programs that read a model without the library.
install(FILES ${PROJECT_SOURCE_DIR}/docs/field.schema.json ${PROJECT_SOURCE_DIR}/docs/read_model.py
        DESTINATION ${CMAKE_INSTALL_DATADIR}/palpate COMPONENT haptics)
