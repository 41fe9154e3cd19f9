# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
# write_documented_project(folder page number): a project of a program and the page's block ```cmake of that number, from 0 on.
function(write_documented_project folder page number)
  file(READ ${CMAKE_CURRENT_FUNCTION_LIST_DIR}/../../${page} text)
  string(REGEX MATCHALL "\n```cmake\n[^`]*```" blocks "${text}")
  list(GET blocks ${number} block)
  string(REGEX REPLACE "\n```cmake\n([^`]*)```" "\\1" block "${block}")
  if(NOT block MATCHES "target_link_libraries\\(([a-z_]+) ")
    message(FATAL_ERROR "block ${number} of ${page} links nothing:\n${block}")
  endif()
  file(WRITE ${folder}/main.cpp "int main() {}\n")
  string(CONCAT text "cmake_minimum_required(VERSION 3.25)\nproject(documented LANGUAGES CXX)\n"
                     "add_executable(${CMAKE_MATCH_1} main.cpp)\n${block}")
  file(WRITE ${folder}/CMakeLists.txt "${text}")
endfunction()
