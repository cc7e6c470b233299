# Fails when a folder used by a check reads files without core/base/file_reads, which reports the
# files that the check depends on. Run from the source root.
cmake_minimum_required(VERSION 3.25)

# gcode/text/source and core/geom/mesh_file determine why a file cannot be read before they read it;
# windows of lines are for programs that are only translated. core/base/platform only has the means
# to open files. app/base/file_stamp is for outputs and watched files, setup_document reads the file
# that it writes, and the prompt reads a file named there. core/cad/reader is a program that reads
# what core/cad has read before.
set(allowed
  core/base/file_reads.cpp core/base/platform_posix.cpp core/base/platform_windows.cpp
  core/cad/reader/main.cpp gcode/language/program_folder.cpp gcode/text/source.cpp core/geom/mesh_file.cpp
  app/base/sha256.cpp app/base/file_stamp.cpp app/setup/setup_document.cpp
  app/debug/prompt/location.cpp)
set(readers "ifstream|fopen|[^A-Za-z]::open\\(|parse_file|directory_iterator|is_regular_file|is_directory"
  "|filesystem::exists|fs::exists|file_size|read_symlink")
string(REPLACE ";" "" readers "${readers}")

set(violations "")
foreach(folder core gcode hwsim app/base app/setup app/check app/coproc app/debug)
  file(GLOB_RECURSE files RELATIVE ${CMAKE_SOURCE_DIR} ${folder}/*.h ${folder}/*.cpp)
  foreach(file IN LISTS files)
    if(file IN_LIST allowed)
      continue()
    endif()
    file(STRINGS ${file} lines REGEX "${readers}")
    foreach(line IN LISTS lines)
      if(NOT line MATCHES "^ *//")
        string(APPEND violations "  ${file}: ${line}\n")
      endif()
    endforeach()
  endforeach()
endforeach()
if(violations)
  message(FATAL_ERROR "use core/base/file_reads for the files that a check reads:\n${violations}")
endif()
