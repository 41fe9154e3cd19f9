# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
# Configures single components where packages of others cannot be found, alone and as a part of another project.
include(${CMAKE_CURRENT_LIST_DIR}/documented_projects.cmake)

function(configure folder)
  execute_process(
    COMMAND ${CMAKE_COMMAND} -G Ninja -S ${folder} -B ${SCRATCH_DIR}/build -DCMAKE_CXX_COMPILER=${CXX} ${ARGN}
    RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  set(status ${status} PARENT_SCOPE)
  set(output "${output}" PARENT_SCOPE)
endfunction()

# What only programs and tests use, and what the components above geometry use.
set(above)
foreach(package IN ITEMS CLI11 GTest Python3 VTK X11 benchmark glfw3 pybind11 spdlog assimp OpenCV PNG SQLite3 ZLIB nlohmann_json)
  list(APPEND above -DCMAKE_DISABLE_FIND_PACKAGE_${package}=ON)
endforeach()

file(REMOVE_RECURSE ${SCRATCH_DIR})
configure(${SOURCE_DIR} -DPALPATE_COMPONENTS=geometry ${above})
if(NOT status EQUAL 0)
  message(FATAL_ERROR "geometry alone does not configure:\n${output}")
endif()
if(NOT output MATCHES "these libraries: core, geometry\n" OR NOT output MATCHES "Assimp was not found: no glTF")
  message(FATAL_ERROR "geometry alone does not say what it builds and leaves out:\n${output}")
endif()
file(GLOB parts RELATIVE ${SCRATCH_DIR}/build ${SCRATCH_DIR}/build/*/cmake_install.cmake)
if(NOT "${parts}" STREQUAL "core/cmake_install.cmake;geometry/cmake_install.cmake")
  message(FATAL_ERROR "geometry alone builds more than itself and core: ${parts}")
endif()

configure(${SOURCE_DIR} -DPALPATE_COMPONENTS=haptics ${above})
if(status EQUAL 0)
  message(FATAL_ERROR "haptics configures without its packages: nothing is tested here")
endif()

configure(${SOURCE_DIR} -DPALPATE_COMPONENTS=geometri)
if(status EQUAL 0 OR NOT output MATCHES "no component 'geometri'")
  message(FATAL_ERROR "an unknown component is not refused:\n${output}")
endif()

write_documented_project(${SCRATCH_DIR}/project docs/linking.md 1)
file(CREATE_LINK ${SOURCE_DIR} ${SCRATCH_DIR}/project/palpate SYMBOLIC)
file(REMOVE_RECURSE ${SCRATCH_DIR}/build)
configure(${SCRATCH_DIR}/project ${above})
if(NOT status EQUAL 0)
  message(FATAL_ERROR "geometry does not configure as a part of another project:\n${output}")
endif()
if(NOT output MATCHES "CMAKE_BUILD_TYPE is not set")
  message(FATAL_ERROR "a project without a build type is not told that nothing is optimised:\n${output}")
endif()
if(EXISTS ${SCRATCH_DIR}/build/DartConfiguration.tcl)
  message(FATAL_ERROR "the other project gets CTest and its targets")
endif()
file(REMOVE_RECURSE ${SCRATCH_DIR})
