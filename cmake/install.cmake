# SPDX-License-Identifier: GPL-3.0-or-later
# What `cmake --install` puts where, beside the libraries (library.cmake). Programs find all of it from their own place:
#   bin, libexec/softfall   the programs; softfall-mesh, which others start
#   share/softfall          geo and examples, which name each other by relative paths, and what is in share/
get_property(programs GLOBAL PROPERTY SOFTFALL_PROGRAMS)
get_property(internal GLOBAL PROPERTY SOFTFALL_INTERNAL)
install(TARGETS ${programs} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
install(TARGETS ${internal} RUNTIME DESTINATION ${CMAKE_INSTALL_LIBEXECDIR}/softfall)

# The build tree has the same places, so that programs find these files in it too.
file(GLOB_RECURSE shared RELATIVE ${CMAKE_SOURCE_DIR}/share CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/share/*)
foreach(name ${shared})
    configure_file(${CMAKE_SOURCE_DIR}/share/${name} ${CMAKE_BINARY_DIR}/share/softfall/${name} COPYONLY)
endforeach()
foreach(name geo examples)
    file(CREATE_LINK ${CMAKE_SOURCE_DIR}/${name} ${CMAKE_BINARY_DIR}/share/softfall/${name} SYMBOLIC)
    install(DIRECTORY ${CMAKE_SOURCE_DIR}/${name} DESTINATION ${CMAKE_INSTALL_DATADIR}/softfall)
endforeach()
install(DIRECTORY ${CMAKE_SOURCE_DIR}/share/ DESTINATION ${CMAKE_INSTALL_DATADIR}/softfall USE_SOURCE_PERMISSIONS)

# Everything but tests, studies and benchmark: what setup.sh builds.
add_custom_target(programs DEPENDS ${programs} ${internal} softfall_api softfall_api_build)
