# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Cross-compiles for the Debian of another processor, against the root that test/emulated.sh makes. RISC-V's is clang, as the
# g++ of Debian 12 does not know its vectors.
set(CMAKE_TRY_COMPILE_PLATFORM_VARIABLES REFRACT_ARCH REFRACT_ROOT)
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR ${REFRACT_ARCH})
set(CMAKE_LIBRARY_ARCHITECTURE ${REFRACT_ARCH}-linux-gnu)
if(REFRACT_ARCH STREQUAL "riscv64")
  set(CMAKE_CXX_COMPILER clang++-14)
  set(CMAKE_CXX_COMPILER_TARGET ${CMAKE_LIBRARY_ARCHITECTURE})
  # Newer compilers know without being told that a register has 128 bits at least.
  set(CMAKE_CXX_FLAGS_INIT "-march=rv64gcv -mllvm -riscv-v-vector-bits-min=128")
else()
  set(CMAKE_C_COMPILER ${CMAKE_LIBRARY_ARCHITECTURE}-gcc)
  set(CMAKE_CXX_COMPILER ${CMAKE_LIBRARY_ARCHITECTURE}-g++)
endif()
set(CMAKE_SYSROOT ${REFRACT_ROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
string(REPLACE "powerpc64le" "ppc64le" emulator qemu-${REFRACT_ARCH})
set(CMAKE_CROSSCOMPILING_EMULATOR ${emulator} -L ${REFRACT_ROOT})
# The tools are run through scripts of their name.
set(CMAKE_EXECUTABLE_SUFFIX_CXX .${REFRACT_ARCH})
