# SPDX-License-Identifier: GPL-3.0-or-later
# The Python package softfall and the program softfall-serve. The build tree has the places of an installed one, in which both find
# the programs: bin, lib/python3/dist-packages/softfall.
set(SOFTFALL_PYTHON_DIR lib/python3/dist-packages/softfall)
file(GLOB python_modules RELATIVE ${CMAKE_SOURCE_DIR}/python/softfall CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/python/softfall/*.py)
foreach(module ${python_modules} py.typed)
    configure_file(${CMAKE_SOURCE_DIR}/python/softfall/${module} ${CMAKE_BINARY_DIR}/${SOFTFALL_PYTHON_DIR}/${module} COPYONLY)
    install(FILES ${CMAKE_SOURCE_DIR}/python/softfall/${module} DESTINATION ${SOFTFALL_PYTHON_DIR} COMPONENT python)
endforeach()
configure_file(${CMAKE_SOURCE_DIR}/python/softfall-serve.in ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/softfall-serve
    FILE_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE @ONLY)
install(PROGRAMS ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/softfall-serve DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT python)
