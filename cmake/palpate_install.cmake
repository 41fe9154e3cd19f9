# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
# find_package(palpate COMPONENTS ...) for other projects.
include(CMakePackageConfigHelpers)
configure_package_config_file(
  ${CMAKE_CURRENT_LIST_DIR}/palpateConfig.cmake.in ${PROJECT_BINARY_DIR}/palpateConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/palpate)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/palpateConfigVersion.cmake
                                 COMPATIBILITY SameMinorVersion)
# Part of the lowest component: whoever installs anything installs core.
palpate_development_component(development core)
install(FILES ${PROJECT_BINARY_DIR}/palpateConfig.cmake ${PROJECT_BINARY_DIR}/palpateConfigVersion.cmake
        DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/palpate COMPONENT ${development})
# For projects that use pkg-config. What the public headers of each component need:
set(needs_core "")
set(needs_geometry "palpate_core = ${PROJECT_VERSION}, eigen3 >= 3.4")
set(needs_sensing "palpate_geometry = ${PROJECT_VERSION}, opencv4 >= 4.6")
set(needs_devices "palpate_geometry = ${PROJECT_VERSION}")
set(needs_probing "palpate_devices = ${PROJECT_VERSION}")
set(needs_acquisition "palpate_sensing = ${PROJECT_VERSION}, palpate_probing = ${PROJECT_VERSION}")
set(needs_haptics "palpate_probing = ${PROJECT_VERSION}")
set(needs_c "")
# Relative, so that `cmake --install --prefix` and moved folders work.
file(RELATIVE_PATH to_prefix /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
set(definitions "")
if(palpate_has_geometry)
  get_target_property(definitions palpate_geometry INTERFACE_COMPILE_DEFINITIONS)
  list(TRANSFORM definitions PREPEND -D)
  list(JOIN definitions " " definitions)
endif()
foreach(name IN LISTS palpate_libraries)
  set(requires ${needs_${name}})
  configure_file(${CMAKE_CURRENT_LIST_DIR}/palpate.pc.in ${PROJECT_BINARY_DIR}/palpate_${name}.pc @ONLY)
  palpate_development_component(development ${name})
  install(FILES ${PROJECT_BINARY_DIR}/palpate_${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig
          COMPONENT ${development})
endforeach()
# What the licences of this build ask for.
if(PALPATE_CGAL)
  set(licence_of_build "This build of libpalpate_geometry contains CGAL's hole filling and removal of self-intersections, which are
under the GNU General Public License, version 3 or later, or a commercial licence of GeometryFactory. Whoever distributes
a program with this build has to do so under one of them. A build with -DPALPATE_CGAL=OFF does not contain it.")
else()
  set(licence_of_build "This build contains no code under the GNU General Public License.")
endif()
configure_file(${CMAKE_CURRENT_LIST_DIR}/NOTICE.in ${PROJECT_BINARY_DIR}/NOTICE @ONLY)
install(FILES ${PROJECT_SOURCE_DIR}/LICENSE ${PROJECT_BINARY_DIR}/NOTICE DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/palpate COMPONENT core)
# For programs that read a model without the library.
install(FILES ${PROJECT_SOURCE_DIR}/docs/field.schema.json ${PROJECT_SOURCE_DIR}/docs/read_model.py
        DESTINATION ${CMAKE_INSTALL_DATADIR}/palpate COMPONENT haptics)
