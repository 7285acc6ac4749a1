# A toolchain: builds for 64-bit ARM with Debian's cross compiler. The folder RAYMAP_SYSROOT has Debian's packages of that
# architecture (scripts/aarch64.sh), and QEMU runs what was built.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_SYSROOT ${RAYMAP_SYSROOT})
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES RAYMAP_SYSROOT)
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER) # Compilers of shaders run here.
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64-static -L ${RAYMAP_SYSROOT})
set(CMAKE_CXX_FLAGS_INIT -Wno-psabi) # Notes on what GCC 10 changed.
