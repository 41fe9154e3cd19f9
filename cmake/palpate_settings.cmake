# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
# Compiler, linker and warnings, for the whole project.
option(PALPATE_WARNINGS_AS_ERRORS "Treat warnings in Palpate's own code as errors" OFF)

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
# Most of the time goes to headers and to templates that many sources instantiate: units of 8 sources, CMake's default, take
# 2.5 times as long.
if(NOT DEFINED CMAKE_UNITY_BUILD_BATCH_SIZE)
  set(CMAKE_UNITY_BUILD_BATCH_SIZE 35)
endif()

if(PROJECT_IS_TOP_LEVEL)
  if(NOT CMAKE_BUILD_TYPE)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "Build type" FORCE)
  endif()
  set(CMAKE_CXX_FLAGS_RELEASE "-O3 -DNDEBUG" CACHE STRING "Release flags" FORCE)
  find_program(CCACHE_PROGRAM ccache)
  if(CCACHE_PROGRAM AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
    # ccache caches what is compiled with a precompiled header only if it is told that it may.
    set(CMAKE_CXX_COMPILER_LAUNCHER
      ${CMAKE_COMMAND} -E env CCACHE_SLOPPINESS=pch_defines,time_macros ${CCACHE_PROGRAM})
    add_compile_options($<$<COMPILE_LANG_AND_ID:CXX,GNU>:-fpch-preprocess>)
    add_compile_options("$<$<COMPILE_LANG_AND_ID:CXX,Clang>:SHELL:-Xclang -fno-pch-timestamp>")
  endif()
  # The package files of PCL name many libraries that nothing here calls.
  add_link_options(-Wl,--as-needed)
  find_program(MOLD_PROGRAM mold)
  if(MOLD_PROGRAM)
    add_link_options(-fuse-ld=mold)
  endif()
  # GCC otherwise collects its garbage again and again, which takes a tenth of the time of sources that use Eigen.
  add_compile_options("$<$<COMPILE_LANG_AND_ID:CXX,GNU>:--param=ggc-min-heapsize=524288;--param=ggc-min-expand=200>")
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    add_compile_options($<$<CONFIG:Release>:-march=x86-64-v2>)
  endif()
elseif(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
  message(WARNING "Palpate is not optimised, because CMAKE_BUILD_TYPE is not set. Set it to Release or RelWithDebInfo.")
endif()

# Linked privately by every target of ours; never reaches a user's build.
add_library(palpate_warnings INTERFACE)
target_compile_options(palpate_warnings INTERFACE
  -Wall -Wextra -Wshadow -Wconversion
  # clang warns of explicit conversions, too, and of the operators that let GCC vectorise a loop. Some sources switch off
  # warnings that only GCC has.
  $<$<CXX_COMPILER_ID:GNU>:-Wdouble-promotion>
  "$<$<CXX_COMPILER_ID:Clang>:-Wno-sign-conversion;-Wno-bitwise-instead-of-logical;-Wno-bitwise-conditional-parentheses;-Wno-psabi;-Wno-unknown-warning-option>"
  $<$<BOOL:${PALPATE_WARNINGS_AS_ERRORS}>:-Werror>)

if(PROJECT_IS_TOP_LEVEL AND CMAKE_CXX_FLAGS MATCHES "fsanitize=[^ ]*address")
  add_library(palpate_keep_modules OBJECT ${PROJECT_SOURCE_DIR}/tests/house/keep_modules.cpp)
  target_link_libraries(palpate_warnings INTERFACE
    $<$<STREQUAL:$<TARGET_PROPERTY:TYPE>,EXECUTABLE>:$<TARGET_OBJECTS:palpate_keep_modules>>)
endif()

# palpate_tell_version(NAME VERSION): a library that `palpate --version` names.
function(palpate_tell_version name version)
  set_property(GLOBAL APPEND PROPERTY palpate_libraries_in_use "${name} ${version}")
endfunction()

# palpate_precompile(target HEADER ...): Eigen and the standard headers that nearly every source includes, and HEADER ...
# Sources still include what they use: the dev preset, and so clang-tidy, works without precompiled headers.
function(palpate_precompile target)
  target_precompile_headers(${target} PRIVATE
    <Eigen/Core> <Eigen/Geometry> <algorithm> <array> <cmath> <filesystem> <functional> <limits> <map> <memory>
    <optional> <string> <vector> ${ARGN})
endfunction()
