# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# `cpack -G DEB` in a build directory: the Debian packages of the library, of what is needed to build on it, and of the tools,
# for the Debian and the OpenCV that they were built on. packaging/debian holds their changelog and copyright.
if(NOT CMAKE_LIBRARY_ARCHITECTURE)      # where Debian keeps libraries; elsewhere there are no such packages
  return()
endif()
set(debian ${CMAKE_SOURCE_DIR}/packaging/debian)
set(REFRACT_PACKAGE_CONTACT "refract developers <refract@example.org>" CACHE STRING "Who answers for the packages")

file(STRINGS ${debian}/changelog changes LIMIT_COUNT 1)
string(REGEX REPLACE ".*\\(.*-(.*)\\).*" "\\1" release "${changes}")
if(NOT changes MATCHES "\\(${PROJECT_VERSION}-")
  message(FATAL_ERROR "${debian}/changelog begins with \"${changes}\": add an entry for ${PROJECT_VERSION}")
endif()

set(soversion ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR})
set(library libopencv-refract${soversion})
set(dev libopencv-refract-dev)
set(tools opencv-refract)
refract_install_library(lib/${CMAKE_LIBRARY_ARCHITECTURE} OpenCVRefractDebianTargets debian_library debian_dev EXCLUDE_FROM_ALL)

set(CPACK_PACKAGE_NAME opencv-refract)
set(CPACK_PACKAGE_VENDOR "the refract developers")
set(CPACK_PACKAGE_CONTACT "${REFRACT_PACKAGE_CONTACT}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_COMPONENTS_ALL debian_library debian_dev)
if(REFRACT_BUILD_TOOLS)
  list(APPEND CPACK_COMPONENTS_ALL tools)
endif()
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)        # no groups: a package for each component
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_PRE_BUILD_SCRIPTS ${CMAKE_SOURCE_DIR}/cmake/debian_files.cmake)
set(CPACK_POST_BUILD_SCRIPTS ${CMAKE_SOURCE_DIR}/cmake/debian_files.cmake)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE ${release})
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_BINARY_DIR})
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(about "cv::refract calibrates the window in front of a camera and puts it into the
camera model: points are projected, corrected, matched and triangulated
with the calls of OpenCV's calib3d, in air, water or both.")
set(CPACK_DEBIAN_DEBIAN_LIBRARY_PACKAGE_NAME ${library})
set(CPACK_DEBIAN_DEBIAN_LIBRARY_PACKAGE_SECTION libs)
set(CPACK_COMPONENT_DEBIAN_LIBRARY_DESCRIPTION "cameras that look through a flat window - library
${about}
.
This package has the library that programs run with.")
# Until 0.2.0-1 one package had everything.
set(CPACK_DEBIAN_DEBIAN_LIBRARY_PACKAGE_BREAKS "opencv-refract (<< 0.2.0-1)")
set(CPACK_DEBIAN_DEBIAN_LIBRARY_PACKAGE_REPLACES "opencv-refract (<< 0.2.0-1)")

set(CPACK_DEBIAN_DEBIAN_DEV_PACKAGE_NAME ${dev})
set(CPACK_DEBIAN_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEBIAN_DEV_PACKAGE_DEPENDS "${library} (= ${PROJECT_VERSION}-${release}), libopencv-dev")
set(CPACK_DEBIAN_DEBIAN_DEV_PACKAGE_BREAKS "opencv-refract (<< 0.2.0-1)")
set(CPACK_DEBIAN_DEBIAN_DEV_PACKAGE_REPLACES "opencv-refract (<< 0.2.0-1)")
set(CPACK_COMPONENT_DEBIAN_DEV_DESCRIPTION "cameras that look through a flat window - development files
${about}
.
This package has the header and the files for CMake and pkg-config.")

set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME ${tools})
set(CPACK_DEBIAN_TOOLS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_TOOLS_PACKAGE_DEPENDS gnuplot-nox)     # it draws the report's figures
set(CPACK_COMPONENT_TOOLS_DESCRIPTION "cameras that look through a flat window - command line tools
${about}
.
This package has the tools refract_*, which do so from images: from a
calibration with a report to measured points and dense depth.")

foreach(component debian_library debian_dev tools)
  string(TOUPPER ${component} COMPONENT)
  set(package ${CPACK_DEBIAN_${COMPONENT}_PACKAGE_NAME})
  install(FILES ${debian}/copyright DESTINATION share/doc/${package} COMPONENT ${component} EXCLUDE_FROM_ALL)
  install(FILES ${debian}/changelog DESTINATION share/doc/${package} COMPONENT ${component} EXCLUDE_FROM_ALL
          RENAME changelog.Debian)
endforeach()
include(CPack)
