# This file is part of OpenCV project.
# It is subject to the license terms in the LICENSE file found in the top-level directory
# of this distribution and at http://opencv.org/license.html.

# Which sources are compiled, for every build that compiles the module's: all of them with Ceres (2.1 is the first with manifolds)
# and the Eigen that it brings; without it all but the calibrators and the matrices in src/math/dense.hpp. In their place
# src/calibrate/without_ceres.cpp says what is missing.
set(REFRACT_WITH_CERES AUTO CACHE STRING "Calibrate, with Ceres: ON, OFF, or AUTO, where it is found")
set_property(CACHE REFRACT_WITH_CERES PROPERTY STRINGS AUTO ON OFF)

# Sets REFRACT_HAS_CERES, and REFRACT_CERES to the target to link, if any.
macro(refract_find_ceres)
  set(REFRACT_HAS_CERES OFF)
  set(REFRACT_CERES "")
  if(REFRACT_WITH_CERES STREQUAL "AUTO" OR REFRACT_WITH_CERES)
    find_package(Ceres 2.1 QUIET)
    if(TARGET Ceres::ceres AND NOT (COMMAND ocv_define_module AND NOT HAVE_EIGEN))
      set(REFRACT_HAS_CERES ON)
      set(REFRACT_CERES Ceres::ceres)
    elseif(NOT REFRACT_WITH_CERES STREQUAL "AUTO")
      message(FATAL_ERROR "REFRACT_WITH_CERES is ${REFRACT_WITH_CERES}, but Ceres 2.1 or newer, or its Eigen, is not found")
    endif()
  endif()
  if(NOT REFRACT_HAS_CERES AND NOT OPENCV_INITIAL_PASS)
    message(STATUS "refract: without Ceres, so calibrateGlass, stereoCalibrateGlass, calibrateGlassRig and "
                   "refractiveBundleAdjust throw")
  endif()
endmacro()

# Leaves out what needs Ceres where there is none: of the targets of the calling directory, sources, tests, speed tests.
function(refract_choose_sources module_dir)
  if(REFRACT_HAS_CERES)
    return()
  endif()
  file(GLOB calibrators CONFIGURE_DEPENDS ${module_dir}/src/math/dense*.cpp ${module_dir}/src/adjust/*.cpp
       ${module_dir}/src/start/*.cpp ${module_dir}/src/calibrate/*.cpp)
  set(without ${module_dir}/src/calibrate/without_ceres.cpp ${module_dir}/test/test_without_ceres.cpp)
  list(REMOVE_ITEM calibrators ${without} ${module_dir}/src/calibrate/calibrate_normal.cpp
       ${module_dir}/src/calibrate/calibration_error.cpp ${module_dir}/src/calibrate/options.cpp
       ${module_dir}/src/start/normal_from_pairs.cpp)
  set_source_files_properties(${calibrators} ${module_dir}/test/test_calibration.cpp
                              ${module_dir}/test/test_calibration_error.cpp ${module_dir}/perf/perf_calibration.cpp
                              PROPERTIES HEADER_FILE_ONLY ON)
  set_source_files_properties(${without} PROPERTIES COMPILE_DEFINITIONS REFRACT_WITHOUT_CERES)
endfunction()
