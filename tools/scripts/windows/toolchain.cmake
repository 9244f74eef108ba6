# GPL-2.0-or-later. Cross compiler for 64-bit Windows, and the libraries that tools/scripts/windows/build made for it.
#
# Q3_WINDOWS_PREFIX: folder that they are installed in.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR AMD64)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc-posix)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)
set(CMAKE_RC_COMPILER x86_64-w64-mingw32-windres)
set(CMAKE_AR x86_64-w64-mingw32-gcc-ar-posix)
set(CMAKE_RANLIB x86_64-w64-mingw32-gcc-ranlib-posix)

list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES Q3_WINDOWS_PREFIX)
set(CMAKE_FIND_ROOT_PATH ${Q3_WINDOWS_PREFIX} /usr/x86_64-w64-mingw32)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_FIND_LIBRARY_SUFFIXES .a)

# -static: one file that needs no DLL. The stack of Windows threads is aligned to 16 bytes only, which g++ ignores when it
# spills 32-byte vectors (GCC bug 54412), so the assembler is told to use unaligned moves. -fno-ipa-ra: see
# CMakeLists.txt.
set(CMAKE_EXE_LINKER_FLAGS_INIT "-static -L${Q3_WINDOWS_PREFIX}/lib")
set(CMAKE_C_FLAGS_INIT "-Wa,-muse-unaligned-vector-move -fno-ipa-ra")
set(CMAKE_CXX_FLAGS_INIT "-Wa,-muse-unaligned-vector-move -fno-ipa-ra")
