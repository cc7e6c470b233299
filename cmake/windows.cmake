# Toolchain for Windows x86-64: Debian's g++-mingw-w64-x86-64-posix.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc-posix)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)
set(CMAKE_RC_COMPILER x86_64-w64-mingw32-windres)

# GCC aligns the stack to 16 bytes on Windows, but moves vectors of 32 as if aligned (GCC bug 54412).
set(CMAKE_C_FLAGS_INIT "-Wa,-muse-unaligned-vector-move")
# Every template has a section of its own, and there may be more than the usual 32768. M_PI is there, as on
# Linux, for all sources, because a precompiled header holds only for the same definitions.
set(CMAKE_CXX_FLAGS_INIT "-Wa,-muse-unaligned-vector-move,-mbig-obj -D_USE_MATH_DEFINES")
# Without DLLs: the libraries of the compiler and of its threads become part of the program. Its stack is as large as on
# Linux: parsers recurse.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-static -Wl,--stack,8388608")

# Nothing of the build machine except its programs.
set(CMAKE_FIND_ROOT_PATH /usr/x86_64-w64-mingw32)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)

# Runs tests, and programs that the build itself runs. Does not print, nor ask to fetch Mono and Gecko.
find_program(FEELER_WINE wine)
mark_as_advanced(FEELER_WINE)
if(FEELER_WINE)
  set(CMAKE_CROSSCOMPILING_EMULATOR env WINEPREFIX=${CMAKE_BINARY_DIR}/wine WINEDEBUG=-all WINEDLLOVERRIDES=mscoree,mshtml= ${FEELER_WINE})
endif()
