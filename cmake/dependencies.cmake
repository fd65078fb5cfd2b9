# SPDX-License-Identifier: GPL-3.0-or-later
# Every library under one naming scheme, sf::<library>. Debian's package of each stands in packages.txt.
find_package(PkgConfig REQUIRED)
# Debian keeps LLVM's libraries in a folder per version.
file(GLOB SOFTFALL_LLVM_LIBRARIES /usr/lib/llvm-*/lib)
if(SOFTFALL_SANITIZE MATCHES "thread")
    find_library(OpenMP_omp_LIBRARY omp PATHS ${SOFTFALL_LLVM_LIBRARIES} REQUIRED)
endif()
find_package(OpenMP REQUIRED COMPONENTS C)

function(softfall_pkg target module)
    pkg_check_modules(${target} REQUIRED IMPORTED_TARGET ${module})
    add_library(sf::${target} ALIAS PkgConfig::${target})
endfunction()

# A library without a .pc file: header and library by name, treated as system headers.
function(softfall_find target header library suffixes)
    find_path(${target}_INCLUDE ${header} PATH_SUFFIXES ${suffixes} REQUIRED)
    find_library(${target}_LIBRARY ${library} REQUIRED)
    add_library(sf_${target} INTERFACE)
    target_include_directories(sf_${target} SYSTEM INTERFACE ${${target}_INCLUDE})
    target_link_libraries(sf_${target} INTERFACE ${${target}_LIBRARY})
    add_library(sf::${target} ALIAS sf_${target})
endfunction()

softfall_pkg(hdf5 hdf5)
softfall_pkg(gsl gsl)
softfall_pkg(libconfig libconfig)
softfall_pkg(seccomp libseccomp)
softfall_find(udunits udunits2.h udunits2 "udunits2")
softfall_find(gmsh gmshc.h gmsh "gmsh")
softfall_find(cholmod cholmod.h cholmod "suitesparse")

add_library(sf_math INTERFACE)
target_link_libraries(sf_math INTERFACE m)
add_library(sf::math ALIAS sf_math)
add_library(sf_openmp INTERFACE)
target_link_libraries(sf_openmp INTERFACE OpenMP::OpenMP_C)
add_library(sf::openmp ALIAS sf_openmp)

# What was tried. gnuplot and ParaView are programs that softfall-post calls or writes for: they may be absent.
include(cmake/tried.cmake)
softfall_header_version(gmsh_VERSION ${gmsh_INCLUDE}/gmshc.h
    GMSH_API_VERSION_MAJOR GMSH_API_VERSION_MINOR GMSH_API_VERSION_PATCH)
softfall_header_version(suitesparse_VERSION ${cholmod_INCLUDE}/SuiteSparse_config.h
    SUITESPARSE_MAIN_VERSION SUITESPARSE_SUB_VERSION)
softfall_program_version(gnuplot_VERSION gnuplot)
softfall_program_version(paraview_VERSION pvpython)
softfall_tried(gmsh "${gmsh_VERSION}" 4.8.0 4.13.1) # 4.8.4 says 4.8.0
softfall_tried(libseccomp "${seccomp_VERSION}" 2.5.4 2.6.0)
softfall_tried(HDF5 "${hdf5_VERSION}" 1.10.8 1.14.5)
softfall_tried(GSL "${gsl_VERSION}" 2.7.1 2.8)
softfall_tried(libconfig "${libconfig_VERSION}" 1.5 1.7.3)
softfall_tried(SuiteSparse "${suitesparse_VERSION}" 5.12 7.10)
softfall_tried(gnuplot "${gnuplot_VERSION}" 5.4 6.0)
softfall_tried(ParaView "${paraview_VERSION}" 5.11.0 5.13.2)
