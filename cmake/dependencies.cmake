# SPDX-License-Identifier: GPL-3.0-or-later
# Every library under one naming scheme, sf::<library>. Debian's package of each stands in packages.txt.
find_package(PkgConfig REQUIRED)
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
softfall_find(udunits udunits2.h udunits2 "udunits2")
softfall_find(gmsh gmshc.h gmsh "gmsh")
softfall_find(cholmod cholmod.h cholmod "suitesparse")

add_library(sf_math INTERFACE)
target_link_libraries(sf_math INTERFACE m)
add_library(sf::math ALIAS sf_math)
add_library(sf_openmp INTERFACE)
target_link_libraries(sf_openmp INTERFACE OpenMP::OpenMP_C)
add_library(sf::openmp ALIAS sf_openmp)
