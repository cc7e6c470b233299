# Fails when a folder that a check goes through reads files by other means than core/base/file_reads,
# which tells the check what it hangs on. Run from the root of the sources.
cmake_minimum_required(VERSION 3.25)

# gcode/source and core/geom/mesh_file say why a file is refused before they read it; line_windows is
# for programs that are only translated.
set(allowed
  core/base/file_reads.cpp gcode/program_folder.cpp gcode/line_windows.cpp gcode/source.cpp
  core/geom/mesh_file.cpp app/session/digest.cpp)
set(readers "ifstream|fopen|[^A-Za-z]::open\\(|parse_file|directory_iterator|is_regular_file|is_directory"
  "|filesystem::exists|fs::exists|file_size|read_symlink")
string(REPLACE ";" "" readers "${readers}")

set(violations "")
foreach(folder core gcode hwsim app/setup app/tools app/session)
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
  message(FATAL_ERROR "read by core/base/file_reads what a check reads:\n${violations}")
endif()
