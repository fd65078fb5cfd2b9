# SPDX-License-Identifier: GPL-3.0-or-later
# What `cmake --install` puts where, beside the libraries (library.cmake). Programs find all of it from their own place:
#   bin, libexec/softfall   the programs; softfall-mesh, which others start
#   share/softfall          geo and examples, which name each other by relative paths, and what is in share/
#   share/doc/softfall      documents
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
    install(DIRECTORY ${CMAKE_SOURCE_DIR}/${name} DESTINATION ${CMAKE_INSTALL_DATADIR}/softfall USE_SOURCE_PERMISSIONS)
endforeach()
install(DIRECTORY ${CMAKE_SOURCE_DIR}/share/ DESTINATION ${CMAKE_INSTALL_DATADIR}/softfall USE_SOURCE_PERMISSIONS)

# The documents, with the folders that they name beside them.
foreach(name README.md CHANGELOG.md CONTRIBUTING.md SECURITY.md CITATION.cff LICENSE)
    install(FILES ${CMAKE_SOURCE_DIR}/${name} DESTINATION ${CMAKE_INSTALL_DOCDIR})
endforeach()
install(DIRECTORY ${CMAKE_SOURCE_DIR}/docs DESTINATION ${CMAKE_INSTALL_DOCDIR})
install(FILES ${CMAKE_SOURCE_DIR}/packaging/copyright DESTINATION ${CMAKE_INSTALL_DOCDIR})
file(RELATIVE_PATH data_of_documents /p/${CMAKE_INSTALL_DOCDIR} /p/${CMAKE_INSTALL_DATADIR}/softfall)
foreach(name geo examples)
    file(MAKE_DIRECTORY ${CMAKE_BINARY_DIR}/generated/links)
    file(CREATE_LINK ${data_of_documents}/${name} ${CMAKE_BINARY_DIR}/generated/links/${name} SYMBOLIC)
    install(FILES ${CMAKE_BINARY_DIR}/generated/links/${name} DESTINATION ${CMAKE_INSTALL_DOCDIR})
endforeach()

# The desktop: a case file opens in softfall open.
install(FILES ${CMAKE_SOURCE_DIR}/packaging/softfall.xml DESTINATION ${CMAKE_INSTALL_DATADIR}/mime/packages)
install(FILES ${CMAKE_SOURCE_DIR}/packaging/softfall.svg
        DESTINATION ${CMAKE_INSTALL_DATADIR}/icons/hicolor/scalable/apps)
install(FILES ${CMAKE_SOURCE_DIR}/packaging/softfall.desktop DESTINATION ${CMAKE_INSTALL_DATADIR}/applications COMPONENT python)

# Manual pages and bash completions, made from the programs' --help. Those of Python go with the Python package; the pages of the words of softfall
# are also those of the programs of their names, such as softfall-protocol. A build for the C programs alone has no modules to run them with.
find_program(SOFTFALL_HELP2MAN help2man)
execute_process(COMMAND /usr/bin/python3 -c "import h5py, matplotlib, numpy, pandas" RESULT_VARIABLE modules_missing OUTPUT_QUIET ERROR_QUIET)
set(SOFTFALL_PYTHON_HELP ${SOFTFALL_PYTHON_PROGRAMS} CACHE INTERNAL "Python programs that --help runs here")
if(modules_missing)
    set(SOFTFALL_PYTHON_HELP "" CACHE INTERNAL "")
    message(STATUS "No completions of the Python programs: a module is missing (packages.txt, section python)")
endif()
set(from_help "")
set(words ${python_modules}) # those that have the texts of --help
list(FILTER words INCLUDE REGEX "(command|program)\\.py$")
list(TRANSFORM words PREPEND ${CMAKE_SOURCE_DIR}/python/softfall/)
foreach(program ${programs} ${SOFTFALL_PYTHON_HELP})
    set(file ${CMAKE_RUNTIME_OUTPUT_DIRECTORY}/${program})
    set(component COMPONENT Unspecified)
    set(pages ${CMAKE_BINARY_DIR}/manual/man1)
    set(texts "")
    if(program IN_LIST SOFTFALL_PYTHON_PROGRAMS)
        set(component COMPONENT python)
        set(pages ${CMAKE_BINARY_DIR}/manual/python/man1)
        set(texts ${words})
    endif()
    set(completion ${CMAKE_BINARY_DIR}/completions/${program})
    add_custom_command(OUTPUT ${completion}
        COMMAND ${CMAKE_COMMAND} -E make_directory ${CMAKE_BINARY_DIR}/completions
        COMMAND ${CMAKE_SOURCE_DIR}/tools/bash_completion.sh ${file} >${completion}
        DEPENDS ${file} ${texts} ${CMAKE_SOURCE_DIR}/tools/bash_completion.sh ${CMAKE_SOURCE_DIR}/tools/help_text.sh)
    list(APPEND from_help ${completion})
    if(SOFTFALL_HELP2MAN AND NOT program IN_LIST SOFTFALL_WORD_PROGRAMS)
        set(made ${CMAKE_BINARY_DIR}/manual/${program}.made)
        add_custom_command(OUTPUT ${made}
            COMMAND ${CMAKE_SOURCE_DIR}/tools/manual_page.sh ${file} ${pages} ${programs}
            COMMAND ${CMAKE_COMMAND} -E touch ${made}
            DEPENDS ${file} ${texts} ${CMAKE_SOURCE_DIR}/tools/manual_page.sh ${CMAKE_SOURCE_DIR}/tools/help_text.sh)
        list(APPEND from_help ${made})
    endif()
    install(FILES ${completion} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions ${component} OPTIONAL)
endforeach()
# A build folder may have pages of programs that are gone.
file(GLOB old_pages ${CMAKE_BINARY_DIR}/manual/man1/*)
foreach(page ${old_pages})
    get_filename_component(name ${page} NAME_WE)
    string(REGEX REPLACE "-(compression|drop)$" "" name ${name}) # pages of softfall-fit's words
    if(NOT name IN_LIST programs)
        file(REMOVE ${page})
    endif()
endforeach()
if(SOFTFALL_HELP2MAN)
    install(DIRECTORY ${CMAKE_BINARY_DIR}/manual/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} OPTIONAL)
    install(DIRECTORY ${CMAKE_BINARY_DIR}/manual/python/man1 DESTINATION ${CMAKE_INSTALL_MANDIR} COMPONENT python OPTIONAL)
else()
    message(STATUS "No manual pages: help2man is missing (packages.txt, section package)")
endif()

# Everything but tests, studies and benchmark: what setup.sh builds, and what installation needs.
set(always ALL)
if(SOFTFALL_SANITIZE OR SOFTFALL_COVERAGE)
    set(always "") # instrumented programs are not installed, and run for their tests only
endif()
add_custom_target(programs ${always} DEPENDS ${programs} ${internal} softfall_api softfall_api_build ${from_help})
