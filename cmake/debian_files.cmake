# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# Run by cpack, before and after it packs: does what debhelper would and cpack does not.
if(NOT CPACK_PACKAGE_FILES)
  # No path to libraries in programs, as they are where every program finds them; changelogs and manual pages compressed.
  file(GLOB programs LIST_DIRECTORIES FALSE ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/*/usr/bin/*)
  foreach(program ${programs})
    if(NOT IS_SYMLINK ${program})
      file(RPATH_REMOVE FILE ${program})
    endif()
  endforeach()
  file(GLOB_RECURSE texts ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/*/usr/share/doc/*/changelog*
       ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/*/usr/share/man/*)
  foreach(text ${texts})
    if(NOT text MATCHES "[.]gz$")
      execute_process(COMMAND gzip -9n ${text} COMMAND_ERROR_IS_FATAL ANY)
    endif()
  endforeach()
endif()
foreach(package ${CPACK_PACKAGE_FILES})
  # A trigger in place of scripts that call ldconfig, which cpack writes for every library.
  set(unpacked ${CPACK_TEMPORARY_INSTALL_DIRECTORY}/unpacked)
  file(REMOVE_RECURSE ${unpacked})
  execute_process(COMMAND dpkg-deb --raw-extract ${package} ${unpacked} COMMAND_ERROR_IS_FATAL ANY)
  if(EXISTS ${unpacked}/DEBIAN/shlibs)
    file(REMOVE ${unpacked}/DEBIAN/postinst ${unpacked}/DEBIAN/postrm)
    file(WRITE ${unpacked}/DEBIAN/triggers "activate-noawait ldconfig\n")
    execute_process(COMMAND dpkg-deb --root-owner-group --build ${unpacked} ${package}
                    OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
  endif()
endforeach()
