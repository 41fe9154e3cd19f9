# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
# cmake -D PRINTS=<regular expression> -P check_example.cmake -- program arguments...
# The program has to succeed and print what matches; PASS_REGULAR_EXPRESSION would let it fail.
set(command "")
math(EXPR end "${CMAKE_ARGC} - 1")
set(after_dashes OFF)
foreach(i RANGE ${end})
  if(after_dashes)
    list(APPEND command "${CMAKE_ARGV${i}}")
  elseif(CMAKE_ARGV${i} STREQUAL "--")
    set(after_dashes ON)
  endif()
endforeach()
execute_process(COMMAND ${command} RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE errors)
message("${output}${errors}")
if(NOT status EQUAL 0)
  message(FATAL_ERROR "ends with status ${status}, not 0")
endif()
if(NOT output MATCHES "${PRINTS}")
  message(FATAL_ERROR "prints nothing that matches \"${PRINTS}\"")
endif()
