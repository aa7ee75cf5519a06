# A toolchain for 64-bit Windows: Debian's MinGW, the libraries that scripts/cross-windows makes in
# build/windows-sysroot, and programs run by Wine.
set(CMAKE_SYSTEM_NAME Windows)
set(CMAKE_SYSTEM_PROCESSOR x86_64)
set(CMAKE_C_COMPILER x86_64-w64-mingw32-gcc-posix)
set(CMAKE_CXX_COMPILER x86_64-w64-mingw32-g++-posix)
set(CMAKE_RC_COMPILER x86_64-w64-mingw32-windres)
set(CMAKE_FIND_ROOT_PATH ${CMAKE_CURRENT_LIST_DIR}/../build/windows-sysroot)
set(CMAKE_CROSSCOMPILING_EMULATOR wine)

# g++ takes the stack for aligned to 32 bytes where Windows aligns it to 16: vectors of 32 bytes on it are then moved
# by instructions that fault. The assembler writes those that do not.
# And it takes the formats of `printf` for those of Windows' own library, where C++ programs have the standard's.
set(CMAKE_CXX_FLAGS_INIT "-Wa,-muse-unaligned-vector-move -Wno-format -Wno-format-extra-args")
# Programs hold what they need of the compiler's own libraries.
set(CMAKE_EXE_LINKER_FLAGS_INIT -static)
set(CMAKE_SHARED_LINKER_FLAGS_INIT -static)

set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
