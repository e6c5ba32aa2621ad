# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# What makes compiling and linking short, and changes nothing of what comes out.

# The default of CMake is -O3, which takes a tenth longer; what gains from it are the kernels, which ask for it themselves
# (modules/refract/cmake/kernels.cmake).
if(CMAKE_CXX_FLAGS_RELEASE STREQUAL "-O3 -DNDEBUG")
  set(CMAKE_CXX_FLAGS_RELEASE "-O2 -DNDEBUG")
endif()

# refract_precompile(TARGET HEADERS...): these, once for all sources of a target. The sources include what they use all the same:
# test/run.sh --slice plain compiles them without (CMAKE_DISABLE_PRECOMPILE_HEADERS=ON). Headers of the system only: with a header of
# this tree, whose path differs in each clone, a compiler cache would find nothing of another clone.
function(refract_precompile target)
  target_precompile_headers(${target} PRIVATE ${ARGN})
  # What ccache asks of compilers, so that it caches what is compiled with a precompiled header too.
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -fpch-preprocess)
  elseif(CMAKE_CXX_COMPILER_ID STREQUAL "Clang")
    target_compile_options(${target} PRIVATE "SHELL:-Xclang -fno-pch-timestamp")
  endif()
endfunction()

# A linker that takes a tenth of the time, where it is at hand.
function(refract_link_faster)
  find_program(REFRACT_MOLD mold)
  mark_as_advanced(REFRACT_MOLD)
  if(NOT REFRACT_MOLD OR CMAKE_CROSSCOMPILING)
    return()
  endif()
  include(CheckCXXSourceCompiles)
  set(CMAKE_REQUIRED_LINK_OPTIONS -fuse-ld=mold)
  check_cxx_source_compiles("int main() {}" REFRACT_LINKS_WITH_MOLD)
  if(REFRACT_LINKS_WITH_MOLD)
    add_link_options(-fuse-ld=mold)
  endif()
endfunction()
