# SPDX-License-Identifier: GPL-3.0-or-later
# The Python package softfall and its programs. The build tree has the places of an installed one, in which both find
# the programs: bin, lib/python3/dist-packages/softfall.
set(SOFTFALL_PYTHON_DIR lib/python3/dist-packages/softfall)
file(GLOB_RECURSE python_modules RELATIVE ${CMAKE_SOURCE_DIR}/python/softfall CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/python/softfall/*.py)
foreach(module ${python_modules} py.typed)
    configure_file(${CMAKE_SOURCE_DIR}/python/softfall/${module} ${CMAKE_BINARY_DIR}/${SOFTFALL_PYTHON_DIR}/${module} COPYONLY)
    get_filename_component(folder ${module} DIRECTORY)
    install(FILES ${CMAKE_SOURCE_DIR}/python/softfall/${module} DESTINATION ${SOFTFALL_PYTHON_DIR}/${folder} COMPONENT python)
endforeach()
# The command softfall, and those of its tasks that are programs of their own, too.
set(SOFTFALL_WORD_PROGRAMS softfall-cfh softfall-protocol softfall-rows softfall-serve softfall-sweep)
set(SOFTFALL_PYTHON_PROGRAMS softfall ${SOFTFALL_WORD_PROGRAMS})
foreach(program ${SOFTFALL_PYTHON_PROGRAMS})
    set(source ${program}.in)
    if(program IN_LIST SOFTFALL_WORD_PROGRAMS)
        set(source softfall-word.in)
        string(REPLACE softfall- "" SOFTFALL_WORD ${program})
    endif()
    configure_file(${CMAKE_SOURCE_DIR}/python/${source} ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/${program}
        FILE_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE @ONLY)
    install(PROGRAMS ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/${program} DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT python)
endforeach()
