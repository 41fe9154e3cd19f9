# SPDX-FileCopyrightText: Palpate contributors
# SPDX-License-Identifier: Apache-2.0
# Read by CTest, whose environment the tests inherit.

# Temporary files lie in memory where there is room for them. The commands wait until what they write is on the disk, which no
# test can see but in the time that it takes.
set(memory /dev/shm)
set(room_needed 2000)  # MB, far more than all tests write at a time
if(NOT DEFINED ENV{TMPDIR} AND IS_DIRECTORY ${memory})
  execute_process(COMMAND df --output=avail --block-size=1M ${memory} OUTPUT_VARIABLE room ERROR_QUIET)
  if(room MATCHES "[0-9]+" AND CMAKE_MATCH_0 GREATER room_needed)
    set(ENV{TMPDIR} ${memory})
  endif()
endif()

# Test programs and Python keep memory that was freed, as the programs do (apps/palpate/shared/program.cpp): up to a third of the
# time of a test went into pages that were given back and cleared again. Variables of glibc, in bytes.
set(variables MALLOC_TRIM_THRESHOLD_ MALLOC_TOP_PAD_ MALLOC_MMAP_THRESHOLD_)
set(sizes 1073741824 67108864 33554432)
foreach(variable size IN ZIP_LISTS variables sizes)
  if(NOT DEFINED ENV{${variable}})
    set(ENV{${variable}} ${size})
  endif()
endforeach()

# Larger pages for what they allocate, where the system lends them: a tenth of the faults.
if(NOT DEFINED ENV{GLIBC_TUNABLES})
  set(ENV{GLIBC_TUNABLES} glibc.malloc.hugetlb=1)
endif()
