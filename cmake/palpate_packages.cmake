# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
# Debian packages by CPack: the libraries, what compiling against them needs, the programs, and the module of Python.
set(api_version ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(libraries_package libpalpate${api_version})
set(development_package libpalpate-dev)
set(programs_package palpate)
set(python_package python3-palpate)

set(libraries_text "This package has the shared libraries that programs use.")
set(development_text "This package has what a program in C++ or C needs to compile. The sensing
library also needs libopencv-dev.")
set(programs_text "This package has the command palpate, the windows palpate-view and
palpate-project, and the data of 'palpate demo'.")
set(python_text "This package has the module palpate for NumPy.")

set(libraries_section libs)
set(development_section libdevel)
set(programs_section science)
set(python_section python)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "Palpate contributors" CACHE STRING "Maintainer of the packages: NAME <ADDRESS>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_ENABLE_COMPONENT_DEPENDS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
# Where the libraries are that the other packages need; those packages name the package of the libraries by themselves.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "")
foreach(library IN LISTS palpate_libraries)
  list(APPEND CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${PROJECT_BINARY_DIR}/${library})
endforeach()

set(CPACK_COMPONENTS_ALL ${palpate_libraries} development apps python)
foreach(library IN LISTS palpate_libraries)
  string(TOUPPER ${library} component)
  set(CPACK_COMPONENT_${component}_GROUP libraries)
endforeach()
set(CPACK_COMPONENT_DEVELOPMENT_GROUP development)
set(CPACK_COMPONENT_APPS_GROUP programs)
set(CPACK_COMPONENT_PYTHON_GROUP python)

set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_SHLIBDEPS OFF)
set(libraries_depends "")
set(own "${libraries_package} (= ${PROJECT_VERSION})")
set(development_depends "${own}, libeigen3-dev (>= 3.4)")
set(programs_depends "${own}")
find_package(Python3 REQUIRED COMPONENTS Interpreter)
math(EXPR next_python "${Python3_VERSION_MINOR} + 1")
set(python_depends "${own}, python3-numpy, python3 (>= 3.${Python3_VERSION_MINOR}), python3 (<< 3.${next_python})")
set(CPACK_DEBIAN_DEVELOPMENT_PACKAGE_RECOMMENDS libopencv-dev)
# What draws pictures where there is no display.
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_RECOMMENDS "xvfb, libgl1-mesa-dri, fonts-dejavu-core")
file(WRITE ${PROJECT_BINARY_DIR}/packages/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_LIBRARIES_PACKAGE_CONTROL_EXTRA ${PROJECT_BINARY_DIR}/packages/triggers)

set(about "Palpate measures real deformable objects with cameras and arms, and makes
models of them that one can see, press and feel.")
# What Debian asks of each package: its licence and its changes.
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(CONFIGURE OUTPUT ${PROJECT_BINARY_DIR}/packages/changelog CONTENT "palpate (@PROJECT_VERSION@) unstable; urgency=medium

  * CHANGELOG.md in the sources lists the changes.

 -- @CPACK_PACKAGE_CONTACT@  @date@
")
execute_process(COMMAND gzip -9nf ${PROJECT_BINARY_DIR}/packages/changelog COMMAND_ERROR_IS_FATAL ANY)
string(REPLACE "\n" "\n " indented_licence "${licence_of_build}")
configure_file(${CMAKE_CURRENT_LIST_DIR}/copyright.in ${PROJECT_BINARY_DIR}/packages/copyright @ONLY)
# The modules, which the libraries load by their path, are nothing to link.
file(WRITE ${PROJECT_BINARY_DIR}/packages/lintian
     "sharedobject-in-library-directory-missing-soname\nlibrary-not-linked-against-libc\n")
set(libraries_component core)
set(development_component development)
set(programs_component apps)
set(python_component python)
foreach(group libraries development programs python)
  string(TOUPPER ${group} upper)
  set(CPACK_COMPONENT_GROUP_${upper}_DISPLAY_NAME ${${group}_package})
  set(CPACK_DEBIAN_${upper}_PACKAGE_NAME ${${group}_package})
  set(CPACK_DEBIAN_${upper}_PACKAGE_DEPENDS "${${group}_depends}")
  set(CPACK_DEBIAN_${upper}_PACKAGE_SECTION ${${group}_section})
  set(CPACK_COMPONENT_${upper}_DESCRIPTION "${about}
${${group}_text}")
  install(FILES ${PROJECT_BINARY_DIR}/packages/changelog.gz ${PROJECT_BINARY_DIR}/packages/copyright
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${${group}_package} COMPONENT ${${group}_component})
  install(FILES ${PROJECT_BINARY_DIR}/packages/lintian DESTINATION ${CMAKE_INSTALL_DATADIR}/lintian/overrides
          RENAME ${${group}_package} COMPONENT ${${group}_component})
endforeach()
include(CPack)
