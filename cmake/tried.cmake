# SPDX-License-Identifier: GPL-3.0-or-later
# The versions that softfall was built and tested with: Debian 12 has the oldest, Debian 13 the newest. Any other gets a
# warning, not a refusal.
function(softfall_tried name version oldest newest)
    if(NOT version)
        message(STATUS "${name} not found, or its version is unknown; tried were ${oldest} to ${newest}")
        return()
    endif()
    # A patch release of the newest is as good as tried.
    string(REGEX MATCH "^[0-9]+\\.[0-9]+" newest_minor ${newest})
    string(REGEX MATCH "^[0-9]+\\.[0-9]+" minor ${version})
    if(version VERSION_LESS oldest OR minor VERSION_GREATER newest_minor)
        message(WARNING "${name} ${version} was not tried: softfall was tested with ${oldest} to ${newest}")
    endif()
endfunction()

# The first number with dots in what a program prints about its version; empty if there is no such program.
function(softfall_program_version out program)
    set(${out} "" PARENT_SCOPE)
    find_program(${out}_PROGRAM ${program})
    if(${out}_PROGRAM)
        execute_process(COMMAND ${${out}_PROGRAM} --version OUTPUT_VARIABLE text ERROR_VARIABLE text)
        string(REGEX MATCH "[0-9]+\\.[0-9]+(\\.[0-9]+)?" version "${text}")
        set(${out} "${version}" PARENT_SCOPE)
    endif()
endfunction()

# A version that a header defines as numbers: the macros are named by the remaining arguments.
function(softfall_header_version out header)
    file(STRINGS ${header} lines REGEX "^#[ \t]*define")
    set(version "")
    foreach(macro ${ARGN})
        string(REGEX MATCH "define[ \t]+${macro}[ \t]+([0-9]+)" found "${lines}")
        list(APPEND version ${CMAKE_MATCH_1})
    endforeach()
    list(JOIN version "." version)
    set(${out} "${version}" PARENT_SCOPE)
endfunction()
