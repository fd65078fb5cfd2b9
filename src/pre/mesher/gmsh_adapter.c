/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesher/gmsh_adapter.h"

#include <gmshc.h>
#include <stdio.h>

#define API_AT_LEAST(major, minor)                                                                           \
    (GMSH_API_VERSION_MAJOR > (major) ||                                                                     \
     (GMSH_API_VERSION_MAJOR == (major) && GMSH_API_VERSION_MINOR >= (minor)))

#if !API_AT_LEAST(4, 8)
#error "softfall needs gmsh 4.8 or newer"
#endif

int sf_gmsh_adapter_initialize(void) {
    char name[] = "softfall-pre";
    char *argv[] = {name, NULL};
    int ierr = 0;
#if API_AT_LEAST(4, 9)
    gmshInitialize(1, argv, 0, 0, &ierr);
#else
    gmshInitialize(1, argv, 0, &ierr);
#endif
    return ierr;
}

void sf_gmsh_adapter_version(char *out, size_t size) {
    char *version = NULL;
    int ierr = 0;
    gmshOptionGetString("General.Version", &version, &ierr);
    snprintf(out, size, "%s", ierr == 0 && version ? version : GMSH_API_VERSION);
    gmshFree(version);
}
