# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
# Read by CTest, whose environment the tests inherit: their temporary files lie in memory where there is room for them.
# The commands wait until what they write is on the disk, which no test can see but in the time that it takes.
set(memory /dev/shm)
set(room_needed 2000)  # MB, far more than all tests write at a time
if(NOT DEFINED ENV{TMPDIR} AND IS_DIRECTORY ${memory})
  execute_process(COMMAND df --output=avail --block-size=1M ${memory} OUTPUT_VARIABLE room ERROR_QUIET)
  if(room MATCHES "[0-9]+" AND CMAKE_MATCH_0 GREATER room_needed)
    set(ENV{TMPDIR} ${memory})
  endif()
endif()
