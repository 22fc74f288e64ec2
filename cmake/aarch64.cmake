# Cross-compiling for arm64 by Debian's compiler against an arm64 tree of Debian (LOOKOUT_ARM64_TREE). ./dev test-arm64 makes the tree and uses this.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)
set(CMAKE_C_COMPILER aarch64-linux-gnu-gcc)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
# The checks of compilers read this file anew.
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES LOOKOUT_ARM64_TREE)
set(CMAKE_SYSROOT ${LOOKOUT_ARM64_TREE})
# Code generators (protoc, lcm-gen) run here; libraries, headers and packages are the tree's.
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
# A note about compilers before GCC 10, at each pair of floats.
set(CMAKE_CXX_FLAGS_INIT -Wno-psabi)
