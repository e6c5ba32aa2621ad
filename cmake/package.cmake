# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# `cpack -G DEB` in a build directory: one Debian package with library, headers and tools, for the Debian and the OpenCV
# that it was built on.
set(CPACK_PACKAGE_NAME opencv-refract)
set(CPACK_PACKAGE_VENDOR "the refract developers")
set(CPACK_PACKAGE_CONTACT "the refract developers <opencv-refract@localhost>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "Cameras that look through a flat window: library and tools")
set(CPACK_PACKAGE_DESCRIPTION "cv::refract calibrates, corrects, matches and triangulates with cameras behind a flat glass
window. The tools refract_* do so from image files.")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)

set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_BINARY_DIR})
set(CPACK_DEBIAN_PACKAGE_DEPENDS gnuplot-nox)           # draws the report's figures
set(CPACK_DEBIAN_PACKAGE_SUGGESTS libopencv-dev)        # for programs of one's own
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DATAROOTDIR}/doc/${CPACK_PACKAGE_NAME} RENAME copyright)
include(CPack)
