# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Run by OpenCV's build after it has made the module's targets (OPENCV_CMAKE_HOOKS_DIR): warnings are errors in ours alone.
foreach(target opencv_refract opencv_test_refract opencv_perf_refract)
  if(TARGET ${target})
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endforeach()
