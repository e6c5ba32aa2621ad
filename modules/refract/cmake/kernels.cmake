# This file is part of OpenCV project.
# It is subject to the license terms in the LICENSE file found in the top-level directory
# of this distribution and at http://opencv.org/license.html.

# How the kernels are compiled (src/dispatch), for every build that compiles the module's sources.
#
# Each level gets the instructions that its name says; a compiler that does not know the flags compiles an empty level, and so does
# OpenCV's own build where neither CPU_DISPATCH nor CPU_BASELINE has it.
# Products and sums may be contracted into one rounding: the formulas do not rely on the rounding of a product.
#
# REFRACT_UNIVERSAL_INTRINSICS: on OpenCV's universal intrinsics everywhere, not only where the compiler has no vector types of its
# own (src/simd/lanes.hpp). Slower, for tests.
include(CheckCXXCompilerFlag)
option(REFRACT_UNIVERSAL_INTRINSICS "Compile the kernels on OpenCV's universal intrinsics where the compiler has vectors, too" OFF)
function(refract_kernel_options source_dir)
  if(MSVC)
    refract_msvc_levels()
  else()
    refract_gnu_levels()
  endif()
  if(DEFINED CPU_DISPATCH_FINAL)
    set(wanted ${CPU_BASELINE_FINAL} ${CPU_DISPATCH_FINAL})
    if(NOT "AVX2" IN_LIST wanted)
      unset(avx2)
    endif()
    if(NOT "AVX512_SKX" IN_LIST wanted)
      unset(avx512)
    endif()
  endif()
  if(REFRACT_UNIVERSAL_INTRINSICS)
    list(APPEND common -DREFRACT_UNIVERSAL_INTRINSICS)
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")    # 12 takes _mm512_sqrt_pd, its own, for careless
      list(APPEND common -Wno-uninitialized -Wno-maybe-uninitialized)
    endif()
  endif()
  foreach(level baseline avx2 avx512)
    set_source_files_properties(${source_dir}/dispatch/kernels_${level}.cpp PROPERTIES
      COMPILE_OPTIONS "${common};${${level}}" SKIP_PRECOMPILE_HEADERS ON)
  endforeach()
endfunction()

macro(refract_msvc_levels)
  check_cxx_compiler_flag("/arch:AVX2" REFRACT_HAS_AVX2)
  check_cxx_compiler_flag("/arch:AVX512" REFRACT_HAS_AVX512)
  if(REFRACT_HAS_AVX2)
    set(avx2 /arch:AVX2)
  endif()
  if(REFRACT_HAS_AVX512)
    set(avx512 /arch:AVX512)
  endif()
endmacro()

macro(refract_gnu_levels)
  set(common -O3 -ffp-contract=fast -fno-math-errno)
  # g++ 12 otherwise returns from kernels whose last call touches no vector register without vzeroupper, and all that the caller
  # computes next is slowed down by the upper halves left in use.
  check_cxx_compiler_flag("-fno-ipa-ra" REFRACT_HAS_NO_IPA_RA)
  if(REFRACT_HAS_NO_IPA_RA)
    list(APPEND common -fno-ipa-ra)
  endif()
  if(MINGW)
    # Windows aligns the stack to 16 bytes, which g++ takes for enough for wider registers, too (its bug 54412).
    check_cxx_compiler_flag("-Wa,-muse-unaligned-vector-move" REFRACT_HAS_UNALIGNED_MOVES)
    if(REFRACT_HAS_UNALIGNED_MOVES)
      list(APPEND common "-Wa,-muse-unaligned-vector-move")
    endif()
  endif()
  if(CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64|amd64")
    check_cxx_compiler_flag("-mavx2 -mfma" REFRACT_HAS_AVX2)
    check_cxx_compiler_flag("-mavx512f -mavx512cd -mavx512vl -mavx512bw -mavx512dq" REFRACT_HAS_AVX512)
    if(REFRACT_HAS_AVX2)
      set(avx2 -mavx2 -mfma)
    endif()
    if(REFRACT_HAS_AVX512)
      set(avx512 -mavx512f -mavx512cd -mavx512vl -mavx512bw -mavx512dq -mfma -mprefer-vector-width=512)
    endif()
  endif()
endmacro()
