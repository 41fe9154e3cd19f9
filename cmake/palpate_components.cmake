# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
# What is built, by the name of a component: palpate_has_NAME is ON for what PALPATE_COMPONENTS lists, and what that needs.
set(PALPATE_COMPONENTS "all" CACHE STRING
    "What to build, with all that it needs: core, geometry, documents, sensing, devices, probing, acquisition, haptics, c, tools, python, or all")

set(libraries core geometry documents sensing devices probing acquisition haptics c)
string(JOIN ", " known ${libraries} tools python)
set(core_needs "")
set(geometry_needs core)
set(documents_needs geometry core)
set(sensing_needs documents geometry core)
set(devices_needs geometry core)
set(probing_needs devices documents geometry core)
set(acquisition_needs sensing probing devices documents geometry core)
set(haptics_needs probing devices documents geometry core)
set(c_needs haptics probing devices documents geometry core)
set(tools_needs acquisition sensing haptics probing devices documents geometry core)   # the command palpate
set(python_needs sensing haptics probing devices documents geometry core)
set(all_needs ${libraries} tools python)                 # and windows, examples, studies and tests

foreach(name ${libraries} tools python all)
  set(palpate_has_${name} OFF)
endforeach()
foreach(name IN LISTS PALPATE_COMPONENTS)
  if(NOT DEFINED ${name}_needs)
    message(FATAL_ERROR "PALPATE_COMPONENTS: there is no component '${name}'; it must be one or several of ${known}, or all")
  endif()
  foreach(needed ${name} ${${name}_needs})
    set(palpate_has_${needed} ON)
  endforeach()
endforeach()
# The build of another project gets libraries only.
if(NOT PROJECT_IS_TOP_LEVEL)
  set(palpate_has_tools OFF)
  set(palpate_has_python OFF)
endif()
set(palpate_libraries "")
foreach(name IN LISTS libraries)
  if(palpate_has_${name})
    list(APPEND palpate_libraries ${name})
  endif()
endforeach()

# Packages of modules that are loaded when they are used: only a build of everything must have them. Without one, its functions
# throw Unavailable.
set(PALPATE_PACKAGES_OF_MODULES QUIET)
if(PROJECT_IS_TOP_LEVEL AND palpate_has_all)
  set(PALPATE_PACKAGES_OF_MODULES REQUIRED)
endif()

# palpate_tell_left_out(PACKAGE WHAT): a module that is not built, because its package was not found.
function(palpate_tell_left_out package what)
  set_property(GLOBAL APPEND PROPERTY palpate_left_out "${package} was not found: no ${what}")
endfunction()

function(palpate_print_choice)
  list(JOIN palpate_libraries ", " libraries)
  message(STATUS "Palpate builds these libraries: ${libraries}")
  get_property(left_out GLOBAL PROPERTY palpate_left_out)
  foreach(line IN LISTS left_out)
    message(STATUS "  ${line}")
  endforeach()
endfunction()

# What only compiling against a library needs belongs to the component of the library, but to one of its own in packages, so that
# users of the programs do not install it.
option(PALPATE_PACKAGES "Make Debian packages: `cpack` in the build folder, or ./dev package" OFF)
function(palpate_development_component result name)
  if(PALPATE_PACKAGES)
    set(name development)
  endif()
  set(${result} ${name} PARENT_SCOPE)
endfunction()
