# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
# Writes to OUTPUT a CTest test FOLDER.Suite for each test suite of the GoogleTest program PROGRAM. A suite is one
# process: loading the libraries takes longer than most tests. One that runs none of its tests fails.
execute_process(COMMAND ${PROGRAM} --gtest_list_tests OUTPUT_VARIABLE listed COMMAND_ERROR_IS_FATAL ANY)
string(REGEX MATCHALL "(^|\n)[A-Za-z0-9_/]+\\." suites "${listed}")
set(tests "")
foreach(suite IN LISTS suites)
  string(REGEX REPLACE "[\n.]" "" suite "${suite}")
  string(APPEND tests "add_test([[${FOLDER}.${suite}]] [[${PROGRAM}]] [[--gtest_filter=${suite}.*]])\n"
    "set_tests_properties([[${FOLDER}.${suite}]] PROPERTIES FAIL_REGULAR_EXPRESSION [[Running 0 tests]])\n")
endforeach()
file(WRITE ${OUTPUT} "${tests}")
