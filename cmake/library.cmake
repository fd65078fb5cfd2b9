# SPDX-License-Identifier: GPL-3.0-or-later
# The libraries behind include/softfall, made of the rooms' objects:
#   libsoftfall        solve and evaluate: HDF5, GSL, UDUNITS, CHOLMOD; neither gmsh nor libconfig
#   libsoftfall-build  read a case and build its model: with libconfig; it starts softfall-mesh, which has gmsh
# They are shared, and show only the functions declared there: internal names cannot meet those of a user's program.
function(softfall_shared target name export)
    cmake_parse_arguments(arg "" "" "SOURCES;PRIVATE;PUBLIC" ${ARGN})
    add_library(${target} SHARED ${arg_SOURCES})
    set_target_properties(${target} PROPERTIES OUTPUT_NAME ${name} EXPORT_NAME ${export}
        INSTALL_RPATH "$ORIGIN" # libsoftfall-build finds libsoftfall
        VERSION ${PROJECT_VERSION} SOVERSION ${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}
        LIBRARY_OUTPUT_DIRECTORY ${CMAKE_BINARY_DIR}/lib)
    target_include_directories(${target} PUBLIC
        $<BUILD_INTERFACE:${CMAKE_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
    target_link_options(${target} PRIVATE -Wl,--version-script=${CMAKE_SOURCE_DIR}/cmake/softfall.map)
    set_target_properties(${target} PROPERTIES LINK_DEPENDS ${CMAKE_SOURCE_DIR}/cmake/softfall.map)
    target_link_libraries(${target} PRIVATE ${arg_PRIVATE} PUBLIC ${arg_PUBLIC})
endfunction()

softfall_shared(softfall_api softfall softfall
    SOURCES src/api/batch.c src/api/curve.c src/api/drop.c src/api/figures.c src/api/model.c src/api/record.c
        src/api/status.c src/api/units.c
    PRIVATE softfall_drop)
softfall_shared(softfall_api_build softfall-build build
    SOURCES src/api/case.c src/api/compression.c src/api/form.c src/api/material.c src/api/settings.c
        src/api/variant.c
    PRIVATE softfall_accuracy softfall_report softfall_study
    PUBLIC softfall_api)

file(RELATIVE_PATH SOFTFALL_PREFIX_OF_PC /p/${CMAKE_INSTALL_LIBDIR}/pkgconfig /p)
foreach(name softfall softfall-build)
    configure_file(${CMAKE_SOURCE_DIR}/cmake/${name}.pc.in ${CMAKE_BINARY_DIR}/generated/${name}.pc @ONLY)
    install(FILES ${CMAKE_BINARY_DIR}/generated/${name}.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endforeach()

include(CMakePackageConfigHelpers)
set(SOFTFALL_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/softfall)
file(WRITE ${CMAKE_BINARY_DIR}/generated/softfallConfig.cmake
    "include(\${CMAKE_CURRENT_LIST_DIR}/softfallTargets.cmake)\n")
write_basic_package_version_file(${CMAKE_BINARY_DIR}/generated/softfallConfigVersion.cmake
    COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_BINARY_DIR}/generated/softfallConfig.cmake
              ${CMAKE_BINARY_DIR}/generated/softfallConfigVersion.cmake
        DESTINATION ${SOFTFALL_CMAKE_DIR})
install(TARGETS softfall_api softfall_api_build EXPORT softfallTargets
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(EXPORT softfallTargets NAMESPACE softfall:: DESTINATION ${SOFTFALL_CMAKE_DIR})
install(DIRECTORY ${CMAKE_SOURCE_DIR}/include/softfall DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
