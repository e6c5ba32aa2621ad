# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Where the library, its header and the files that find them go.
include(CMakePackageConfigHelpers)

# refract_install_library(LIBDIR SET RUNTIME DEV [EXCLUDE_FROM_ALL]): into LIBDIR of a prefix, as components RUNTIME (what
# programs run with) and DEV (what they are built with); SET names the exported targets, one for each LIBDIR.
function(refract_install_library libdir set runtime dev)
  install(TARGETS opencv_refract EXPORT ${set}
          LIBRARY DESTINATION ${libdir} COMPONENT ${runtime} NAMELINK_COMPONENT ${dev} ${ARGN}
          ARCHIVE DESTINATION ${libdir} COMPONENT ${dev} ${ARGN}
          RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT ${runtime} ${ARGN})
  install(FILES ${CMAKE_SOURCE_DIR}/modules/refract/include/opencv2/refract.hpp
          DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/opencv2 COMPONENT ${dev} ${ARGN})

  set(made ${CMAKE_BINARY_DIR}/install/${libdir})
  install(EXPORT ${set} FILE OpenCVRefractTargets.cmake
          DESTINATION ${libdir}/cmake/OpenCVRefract COMPONENT ${dev} ${ARGN})
  configure_package_config_file(${CMAKE_SOURCE_DIR}/cmake/OpenCVRefractConfig.cmake.in ${made}/OpenCVRefractConfig.cmake
    INSTALL_DESTINATION ${libdir}/cmake/OpenCVRefract)
  write_basic_package_version_file(${made}/OpenCVRefractConfigVersion.cmake COMPATIBILITY SameMinorVersion)
  install(FILES ${made}/OpenCVRefractConfig.cmake ${made}/OpenCVRefractConfigVersion.cmake
          DESTINATION ${libdir}/cmake/OpenCVRefract COMPONENT ${dev} ${ARGN})

  file(RELATIVE_PATH REFRACT_PREFIX_FROM_PC /prefix/${libdir}/pkgconfig /prefix)       # relocatable
  set(REFRACT_LIBDIR ${libdir})
  configure_file(${CMAKE_SOURCE_DIR}/cmake/opencv_refract.pc.in ${made}/opencv_refract.pc @ONLY)
  install(FILES ${made}/opencv_refract.pc DESTINATION ${libdir}/pkgconfig COMPONENT ${dev} ${ARGN})
endfunction()
