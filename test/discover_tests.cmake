# This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
# SPDX-License-Identifier: Apache-2.0

# refract_discover_tests(PROGRAM): every test case of a Catch2 program is a test of ctest of its own, and its tags are its labels:
# `ctest -N`, `ctest -R bundle`, `ctest -L pnp`, `ctest --print-labels`. The program is asked when ctest runs, and again when it
# has changed, so that what is compiled for another processor can be listed too.
#
# As a script (cmake -DPROGRAM=... -DLIST=... -P): writes the list that ctest includes.

if(NOT CMAKE_SCRIPT_MODE_FILE)
  set(REFRACT_DISCOVER_TESTS ${CMAKE_CURRENT_LIST_FILE})
  function(refract_discover_tests program)
    set(list ${CMAKE_CURRENT_BINARY_DIR}/${program}_list.cmake)
    set(include ${CMAKE_CURRENT_BINARY_DIR}/${program}_include.cmake)
    file(GENERATE OUTPUT ${include} CONTENT
"if(NOT EXISTS \"$<TARGET_FILE:${program}>\")
  add_test(\"${program} is not built\" \"$<TARGET_FILE:${program}>\")
else()
  if(\"$<TARGET_FILE:${program}>\" IS_NEWER_THAN \"${list}\" OR \"${REFRACT_DISCOVER_TESTS}\" IS_NEWER_THAN \"${list}\")
    execute_process(RESULT_VARIABLE code COMMAND \"${CMAKE_COMMAND}\" -DPROGRAM=$<TARGET_FILE:${program}> -DLIST=${list} -P
                    \"${REFRACT_DISCOVER_TESTS}\")
    if(code)
      message(FATAL_ERROR \"${program} does not list its tests\")
    endif()
  endif()
  include(\"${list}\")
endif()
")
    set_property(DIRECTORY APPEND PROPERTY TEST_INCLUDE_FILES ${include})
  endfunction()
  return()
endif()

cmake_minimum_required(VERSION 3.18)
execute_process(COMMAND ${PROGRAM} --list-tests OUTPUT_VARIABLE listed)
if(NOT listed MATCHES "\n([0-9]+) test cases?\n")
  message(FATAL_ERROR "${PROGRAM} --list-tests: ${listed}")
endif()
set(count ${CMAKE_MATCH_1})
get_filename_component(suite ${PROGRAM} NAME_WE)
# Names may have what separates items of lists here. Two blanks begin a name, six its tags.
string(REPLACE ";" "@semicolon@" listed "${listed}")
string(REPLACE "[" "@open@" listed "${listed}")
string(REPLACE "]" "@close@" listed "${listed}")
string(REPLACE "\n" ";" lines "${listed}")
set(script "")
set(written 0)
foreach(line ${lines})
  if(line MATCHES "^      @open@")
    string(REGEX REPLACE "@close@|@open@" ";" labels "${line}")
    list(TRANSFORM labels STRIP)
    list(FILTER labels EXCLUDE REGEX "^$")
    # What takes long begins first.
    set(cost "")
    if("slow" IN_LIST labels)
      set(cost " COST 100")
    endif()
    string(APPEND script "set_tests_properties([==[${name}]==] PROPERTIES SKIP_RETURN_CODE 77 "
           "LABELS \"${suite};${labels}\"${cost})\n")
  elseif(line MATCHES "^  [^ ]")
    string(SUBSTRING "${line}" 2 -1 name)
    foreach(pair "@semicolon@=;" "@open@=[" "@close@=]")
      string(REGEX MATCH "^(@[a-z]+@)=(.)" pair "${pair}")
      string(REPLACE "${CMAKE_MATCH_1}" "${CMAKE_MATCH_2}" name "${name}")
    endforeach()
    string(REGEX REPLACE "([],\\[\"\\\\])" "\\\\\\1" pattern "${name}")
    string(APPEND script "add_test([==[${name}]==] [==[${PROGRAM}]==] [==[${pattern}]==])\n")
    math(EXPR written "${written} + 1")
  endif()
endforeach()
if(NOT written EQUAL count)
  message(FATAL_ERROR "${PROGRAM} has ${count} tests, of which ${written} could be read")
endif()
file(WRITE ${LIST} "${script}")
