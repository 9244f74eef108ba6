# GPL-2.0-or-later. Cross compiler for ARM64 Linux, and the libraries that tools/scripts/arm64/build unpacked for it.
#
# Q3_ARM64_SYSROOT: folder that they are in, as in the root folder of a Debian system.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)

list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES Q3_ARM64_SYSROOT)
set(CMAKE_SYSROOT ${Q3_ARM64_SYSROOT})
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
# With a sysroot, CMake would write empty RPATH entries, which mean the current folder.
set(CMAKE_SKIP_RPATH ON)

# For ctest, and to try the program on other machines: the emulator of user programs, if there is one.
find_program(Q3_QEMU NAMES qemu-aarch64-static qemu-aarch64)
if(Q3_QEMU)
  set(CMAKE_CROSSCOMPILING_EMULATOR ${Q3_QEMU} -L ${Q3_ARM64_SYSROOT})
endif()
