# SPDX-License-Identifier: GPL-3.0-or-later
# build_info.h: what the provenance records of this build. The git revision is taken when CMake configures.
execute_process(COMMAND git -C ${CMAKE_SOURCE_DIR} describe --always --dirty --abbrev=12
                OUTPUT_VARIABLE SOFTFALL_GIT_REVISION OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT SOFTFALL_GIT_REVISION)
    set(SOFTFALL_GIT_REVISION "unknown")
endif()
set(SOFTFALL_COMPILER "${CMAKE_C_COMPILER_ID} ${CMAKE_C_COMPILER_VERSION}")
string(TOUPPER "${CMAKE_BUILD_TYPE}" build_type_upper)
get_target_property(option_flags softfall_options INTERFACE_COMPILE_OPTIONS)
list(JOIN option_flags " " option_flags)
set(SOFTFALL_FLAGS "${CMAKE_C_FLAGS} ${CMAKE_C_FLAGS_${build_type_upper}} ${option_flags}")
string(STRIP "${SOFTFALL_FLAGS}" SOFTFALL_FLAGS)
configure_file(${CMAKE_SOURCE_DIR}/cmake/build_info.h.in ${CMAKE_BINARY_DIR}/generated/build_info.h @ONLY)
# A commit makes CMake configure again, so that the recorded revision stays true.
if(EXISTS ${CMAKE_SOURCE_DIR}/.git/logs/HEAD)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/.git/logs/HEAD)
endif()

# report_style.h: the style sheet of the reports, which each page holds.
file(READ ${CMAKE_SOURCE_DIR}/share/report.css SOFTFALL_REPORT_STYLE)
string(REPLACE "\n" "" SOFTFALL_REPORT_STYLE "${SOFTFALL_REPORT_STYLE}")
file(CONFIGURE OUTPUT ${CMAKE_BINARY_DIR}/generated/report_style.h
     CONTENT "#define SF_REPORT_STYLE \"@SOFTFALL_REPORT_STYLE@\"\n" @ONLY)
set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/share/report.css)
