# Fails when a test outside tests/bench and tests/speed reads a clock, because durations depend on how
# busy the machine is. Count operations instead, or move the timing check to tests/speed. Run from the
# source root.
cmake_minimum_required(VERSION 3.25)

# These need a clock but do not compare a duration with a limit that a slow machine could exceed: they
# stop waiting after one minute or more (cluster is run manually), or they set the time stamp of a
# file.
set(allowed
  tests/app/store_writing_test.cpp tests/app/watched_files_test.cpp tests/support/signalled.h
  tests/support/terminal.h tests/viewer/await_frames.cpp tests/viewer/device_worker_test.cpp
  tests/viewer/drop_files.cpp tests/viewer/session_worker_test.cpp)

set(clocks "steady_clock|system_clock|high_resolution_clock|clock_gettime|gettimeofday|std::clock\\(|ru_utime"
  "|cpu_seconds|Stopwatch|Date\\.now|new Date\\(|performance\\.|process\\.hrtime|console\\.time"
  "|perf_counter|process_time|time\\.time\\(|time\\.monotonic|EPOCHREALTIME|date \\+%s")
string(REPLACE ";" "" clocks "${clocks}")

set(violations "")
file(GLOB_RECURSE files RELATIVE ${CMAKE_SOURCE_DIR}
  tests/*.h tests/*.cpp tests/*.mjs tests/*.sh tests/*.py)
foreach(file IN LISTS files)
  if(file MATCHES "^tests/(bench|speed|planted|real|cluster)/" OR file IN_LIST allowed
     OR file STREQUAL "tests/support/usage.h")
    continue()
  endif()
  file(STRINGS ${file} lines REGEX "${clocks}")
  foreach(line IN LISTS lines)
    string(APPEND violations "  ${file}: ${line}\n")
  endforeach()
endforeach()
if(violations)
  message(FATAL_ERROR "tests that read a clock:\n${violations}")
endif()
