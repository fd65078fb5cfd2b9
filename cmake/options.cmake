# SPDX-License-Identifier: GPL-3.0-or-later
# Language level, warnings, optimisation and sanitizers, carried by the interface target softfall_options.
option(SOFTFALL_TESTS "Build the tests" ON)
option(SOFTFALL_NATIVE "Compile for the processor of this machine alone" OFF)
option(SOFTFALL_THREADS_ALWAYS "Share small loops among threads too (base/lanes.h), for analyses" OFF)
option(SOFTFALL_WERROR "Treat warnings as errors" OFF)
set(SOFTFALL_SANITIZE "" CACHE STRING "Comma list for -fsanitize=, e.g. address,undefined")

option(SOFTFALL_COVERAGE "Count executed lines (gcc; tools/coverage.sh)" OFF)
option(SOFTFALL_FUZZ "Build the fuzzers of the readers (clang)" OFF)
set(SOFTFALL_FUZZ_SECONDS 20 CACHE STRING "Time of each fuzzer as a test, s")

if(NOT CMAKE_BUILD_TYPE)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()
set(CMAKE_C_STANDARD 17)
set(CMAKE_C_STANDARD_REQUIRED ON)
set(CMAKE_C_EXTENSIONS OFF)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
# The objects of the programs are those of the shared libraries, which show only what include/softfall declares.
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_C_VISIBILITY_PRESET hidden)
# assert() guards programmer errors and costs nothing in the kernels: keep it in every build.
set(CMAKE_C_FLAGS_RELEASE "-O3 -g")
set(CMAKE_C_FLAGS_RELWITHDEBINFO "-O2 -g")
set(CMAKE_C_FLAGS_COVERAGE "-O2 -g")

add_library(softfall_options INTERFACE)
target_compile_definitions(softfall_options INTERFACE _GNU_SOURCE)
target_compile_options(softfall_options INTERFACE
    -Wall -Wextra -Wshadow -Wconversion -Wmissing-prototypes -Wvla
    # Vectors pass between static inline functions only: how a call would pass them without AVX does not matter.
    -Wno-psabi
    # Constants of whole numbers are enums here, and stand in formulas of doubles (clang 19 warns by -Wextra).
    -Wno-enum-float-conversion
    # What GCC and Clang may fuse differs; nothing fused gives the same bits in every build.
    -ffp-contract=off
    # No errno and no traps from sqrt and friends: lets loops over lanes vectorise without changing any result.
    -fno-math-errno -fno-trapping-math -fopenmp-simd)
if(SOFTFALL_WERROR)
    target_compile_options(softfall_options INTERFACE -Werror)
endif()
# Kernels for several processors in one program (base/lanes.h); instrumented and plain builds do without.
if(SOFTFALL_NATIVE)
    target_compile_options(softfall_options INTERFACE -march=native)
elseif(CMAKE_C_COMPILER_ID STREQUAL GNU AND CMAKE_C_COMPILER_VERSION VERSION_GREATER_EQUAL 12
       AND CMAKE_SYSTEM_PROCESSOR STREQUAL x86_64 AND NOT SOFTFALL_SANITIZE
       AND NOT CMAKE_BUILD_TYPE MATCHES "^(Debug|Coverage)$")
    target_compile_definitions(softfall_options INTERFACE SF_DISPATCH)
else()
    message(STATUS "Kernels for this build's instruction set alone: SOFTFALL_NATIVE=ON makes them fast here")
endif()
if(SOFTFALL_THREADS_ALWAYS)
    target_compile_definitions(softfall_options INTERFACE SF_THREADS_ALWAYS)
endif()
if(SOFTFALL_SANITIZE)
    target_compile_options(softfall_options INTERFACE -fsanitize=${SOFTFALL_SANITIZE} -fno-omit-frame-pointer
                                                      -fno-sanitize-recover=all)
    target_link_options(softfall_options INTERFACE -fsanitize=${SOFTFALL_SANITIZE})
endif()
if(SOFTFALL_COVERAGE)
    # gcc counts before it optimises, so that -O2 does not move lines. The children that softfall forks count as well.
    add_library(softfall_coverage STATIC ${CMAKE_SOURCE_DIR}/cmake/coverage_exit.c)
    target_compile_options(softfall_options INTERFACE --coverage)
    target_link_options(softfall_options INTERFACE --coverage -Wl,--wrap=_exit)
    target_link_libraries(softfall_options INTERFACE softfall_coverage)
endif()
if(SOFTFALL_FUZZ)
    target_compile_options(softfall_options INTERFACE -fsanitize=fuzzer-no-link)
endif()
