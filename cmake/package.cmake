# SPDX-License-Identifier: GPL-3.0-or-later
# The Debian packages softfall and python3-softfall: `./setup.sh package`, or `cpack` in the build folder after `cmake --build`. Its shared libraries are
# found by dpkg-shlibdeps; the programs that softfall starts are those of packages.txt.
set(SOFTFALL_MAINTAINER "softfall maintainers <maintainers@softfall.invalid>" CACHE STRING "Maintainer of the package")

# The packages of a section of packages.txt as a Debian relation. "# or NAME" beside one is an alternative.
function(softfall_relation section out)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${CMAKE_SOURCE_DIR}/packages.txt)
    file(STRINGS ${CMAKE_SOURCE_DIR}/packages.txt lines)
    set(inside OFF)
    foreach(line ${lines})
        if(line MATCHES "^# section ([a-z]+):")
            string(COMPARE EQUAL ${CMAKE_MATCH_1} ${section} inside)
        elseif(inside AND line MATCHES "^([a-z0-9][a-z0-9.+-]*)")
            set(package ${CMAKE_MATCH_1})
            if(line MATCHES "# or ([a-z0-9][a-z0-9.+-]*)")
                string(APPEND package " | ${CMAKE_MATCH_1}")
            endif()
            list(APPEND found ${package})
        endif()
    endforeach()
    list(JOIN found ", " found)
    set(${out} ${found} PARENT_SCOPE)
endfunction()

# The release of Debian, as the libraries of each have other versions: 1~deb12 is older than 1~deb13, and both than 1.
file(STRINGS /etc/os-release os_release REGEX "^(ID|VERSION_ID)=")
string(REGEX REPLACE ".*VERSION_ID=\"?([0-9.]+).*" "\\1" debian_release "${os_release}")
set(debian_revision 1)
if(os_release MATCHES "ID=debian" AND debian_release MATCHES "^[0-9.]+$")
    set(debian_revision 1~deb${debian_release})
endif()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME softfall)
set(CPACK_PACKAGE_CONTACT ${SOFTFALL_MAINTAINER})
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "drop tests of rigid missiles on foam pads")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
    "softfall computes the severity of an impact (peak deceleration, HIC and other
injury figures) and the deformation, stress and energy in the foam, by a
meshless method that remains stable to compressions of 80 % and more. The
geometry is an editable gmsh file, the rest of a case a short text file, and
the results are CSV, JSON and ParaView files; python3-softfall adds a
report.

The package holds the programs, the library with its header, examples,
geometries and documents.")
set(CPACK_VERBATIM_VARIABLES ON)
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE ${debian_revision})
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS ${CMAKE_BINARY_DIR}/lib)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
softfall_relation(run CPACK_DEBIAN_PACKAGE_DEPENDS)
softfall_relation(show shown)
softfall_relation(cluster CPACK_DEBIAN_PACKAGE_SUGGESTS)
string(PREPEND CPACK_DEBIAN_PACKAGE_SUGGESTS "${shown}, ")
# What Debian wants beside the documents, and the trigger by which the libraries are found after installation.
set(debian_dir ${CMAKE_BINARY_DIR}/generated/debian)
file(WRITE ${debian_dir}/triggers "activate-noawait ldconfig\n")
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${debian_dir}/triggers)
execute_process(COMMAND git -C ${CMAKE_SOURCE_DIR} log -1 --format=%aD
                OUTPUT_VARIABLE debian_date OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
if(NOT debian_date)
    string(TIMESTAMP debian_date "%a, %d %b %Y %H:%M:%S +0000" UTC)
endif()
file(WRITE ${debian_dir}/doc/changelog.Debian
    "softfall (${PROJECT_VERSION}-${debian_revision}) unstable; urgency=medium\n\n"
    "  * Revision ${SOFTFALL_GIT_REVISION}; CHANGELOG.md lists the changes.\n\n"
    " -- ${SOFTFALL_MAINTAINER}  ${debian_date}\n")
execute_process(COMMAND gzip -9nf ${debian_dir}/doc/changelog.Debian)
set(CPACK_INSTALLED_DIRECTORIES ${debian_dir}/doc /usr/share/doc/softfall)
set(CPACK_INSTALL_CMAKE_PROJECTS "${CMAKE_BINARY_DIR};softfall;Unspecified;/")
include(CPack)

# python3-softfall, of the component python: the same settings but for these. Python compiles its modules when it is installed.
softfall_relation(python python_needs)
foreach(name postinst prerm)
    set(program py3compile)
    if(name STREQUAL prerm)
        set(program py3clean)
    endif()
    file(WRITE ${debian_dir}/python/${name} "#!/bin/sh\nset -e\n! command -v ${program} >/dev/null || ${program} -p python3-softfall\n")
    file(CHMOD ${debian_dir}/python/${name} FILE_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
endforeach()
file(COPY ${debian_dir}/doc/changelog.Debian.gz ${CMAKE_SOURCE_DIR}/packaging/copyright DESTINATION ${debian_dir}/python/doc)
file(WRITE ${CMAKE_BINARY_DIR}/CPackPython.cmake "include(${CMAKE_BINARY_DIR}/CPackConfig.cmake)
set(CPACK_PACKAGE_NAME python3-softfall)
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY \"drop tests of rigid missiles on foam pads (Python 3)\")
set(CPACK_DEBIAN_PACKAGE_DESCRIPTION
    \"This package runs the programs of softfall from Python: cases, drops with
figures, histories, frames and plots, sweeps, fits, HIC and CFC filters. It has
a drop as a function for optimisers, the command softfall with its workbench in
the browser, and softfall-serve, which serves drops over HTTP by the protocol
of UM-Bridge.\")
set(CPACK_DEBIAN_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE all)
set(CPACK_DEBIAN_PACKAGE_DEPENDS \"softfall (= ${PROJECT_VERSION}-${debian_revision}), ${python_needs}\")
set(CPACK_DEBIAN_PACKAGE_SUGGESTS \"python3-openpyxl\")
set(CPACK_DEBIAN_PACKAGE_REPLACES \"softfall (<< 1.2)\") # softfall-sweep and softfall-cfh were programs of that package
set(CPACK_DEBIAN_PACKAGE_BREAKS \"softfall (<< 1.2)\")
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS OFF)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA \"${debian_dir}/python/postinst;${debian_dir}/python/prerm\")
set(CPACK_INSTALLED_DIRECTORIES \"${debian_dir}/python/doc;/usr/share/doc/python3-softfall\")
set(CPACK_INSTALL_CMAKE_PROJECTS \"${CMAKE_BINARY_DIR};softfall;python;/\")
")
