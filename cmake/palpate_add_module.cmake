# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0

# palpate_add_module(name MAP ... HEADERS ... CONVERTERS ... SOURCES ... PRECOMPILE ... PUBLIC ... PRIVATE ...)
# One folder, one shared library palpate::<name>, one installable component.
# CONVERTERS are headers for users of another library: installed, but they compile only where that library is linked.
# Shared, so that what a library uses inside never reaches the build of its users. MAP is the linker's version script that
# says what the library exports; by default what is in namespace palpate.
function(palpate_add_module name)
  cmake_parse_arguments(ARG "" "MAP" "HEADERS;CONVERTERS;SOURCES;PRECOMPILE;PUBLIC;PRIVATE" ${ARGN})
  list(TRANSFORM ARG_HEADERS PREPEND include/)
  list(TRANSFORM ARG_CONVERTERS PREPEND include/)
  list(TRANSFORM ARG_SOURCES PREPEND src/)
  add_library(palpate_${name} SHARED ${ARG_SOURCES})
  add_library(palpate::${name} ALIAS palpate_${name})
  target_sources(palpate_${name} PUBLIC FILE_SET HEADERS BASE_DIRS include FILES ${ARG_HEADERS}
                 PUBLIC FILE_SET converters TYPE HEADERS BASE_DIRS include FILES ${ARG_CONVERTERS})
  target_include_directories(palpate_${name} PRIVATE src)
  # Several sources at once, because most of the time goes to headers. The preset dev compiles each alone.
  if(NOT DEFINED CMAKE_UNITY_BUILD)
    set_target_properties(palpate_${name} PROPERTIES UNITY_BUILD ON)
  endif()
  target_compile_features(palpate_${name} PUBLIC cxx_std_20)
  # Results must not depend on which clone of a function the processor picks: no fused multiply-add.
  target_compile_options(palpate_${name} PRIVATE -ffp-contract=off)
  target_link_libraries(palpate_${name} PUBLIC ${ARG_PUBLIC}
                        PRIVATE ${ARG_PRIVATE} $<BUILD_INTERFACE:palpate_warnings>)
  palpate_precompile(palpate_${name} ${ARG_PRECOMPILE})
  set(map ${PROJECT_SOURCE_DIR}/cmake/palpate.map)
  if(ARG_MAP)
    set(map ${CMAKE_CURRENT_SOURCE_DIR}/${ARG_MAP})
  endif()
  target_link_options(palpate_${name} PRIVATE -Wl,--version-script=${map})
  set_target_properties(palpate_${name} PROPERTIES LINK_DEPENDS ${map})
  # Workers of oneTBB still run when a program such as Mono unloads the library. GCC's unique symbols keep it, but clang has none.
  target_link_options(palpate_${name} PRIVATE -Wl,-z,nodelete)
  # A library that is not named above fails here, not in Python, which resolves every symbol at once. What sanitizers
  # call is in the programs.
  if(NOT CMAKE_CXX_FLAGS MATCHES "-fsanitize=")
    target_link_options(palpate_${name} PRIVATE -Wl,-z,defs)
  endif()
  # Before 1.0 only versions with the same minor number are compatible.
  set_target_properties(palpate_${name} PROPERTIES
    EXPORT_NAME ${name} INSTALL_RPATH "$ORIGIN"
    VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
    VERIFY_INTERFACE_HEADER_SETS ON INTERFACE_HEADER_SETS_TO_VERIFY HEADERS)
  palpate_development_component(development ${name})
  install(TARGETS palpate_${name} EXPORT palpate_${name}
          LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${name} NAMELINK_COMPONENT ${development}
          FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT ${development}
          FILE_SET converters DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT ${development})
  install(EXPORT palpate_${name} NAMESPACE palpate:: FILE palpate_${name}.cmake
          DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/palpate COMPONENT ${development})
endfunction()

# palpate_add_loaded_module(name COMPONENT ... SOURCES ... LIBRARIES ...)
# A part of one of the libraries or programs that is loaded when it is used first: palpate/core/module.h. All lie beside the
# core library.
set(PALPATE_MODULE_ENDING -${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}${CMAKE_SHARED_MODULE_SUFFIX})
function(palpate_add_loaded_module name)
  cmake_parse_arguments(ARG "" "COMPONENT" "SOURCES;LIBRARIES" ${ARGN})
  add_library(palpate_${name}_module MODULE ${ARG_SOURCES})
  target_link_libraries(palpate_${name}_module PRIVATE palpate::core ${ARG_LIBRARIES} palpate_warnings)
  set_target_properties(palpate_${name}_module PROPERTIES
    OUTPUT_NAME palpate_${name} SUFFIX ${PALPATE_MODULE_ENDING} LIBRARY_OUTPUT_DIRECTORY ${PROJECT_BINARY_DIR}/core)
  install(TARGETS palpate_${name}_module LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT ${ARG_COMPONENT})
endfunction()

# palpate_add_library_module(library name SOURCES ... LIBRARIES ...)
# A module of palpate::<library>, which it cannot link: what it shares with it is in headers, or compiled once more.
function(palpate_add_library_module library name)
  cmake_parse_arguments(ARG "" "" "SOURCES;LIBRARIES" ${ARGN})
  list(TRANSFORM ARG_SOURCES PREPEND src/)
  palpate_add_loaded_module(${name} COMPONENT ${library} SOURCES ${ARG_SOURCES} LIBRARIES ${ARG_LIBRARIES})
  target_include_directories(palpate_${name}_module PRIVATE src include)
  target_compile_options(palpate_${name}_module PRIVATE -ffp-contract=off)
  add_dependencies(palpate_${library} palpate_${name}_module)
endfunction()
