/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parameters of a .geo file: gmsh's tree knows them by their Name, a case by their variable. gmsh tells
 * no one which belongs to which, so the text of the file (and of what it includes) is looked through:
 * DefineConstant and DefineNumber with a Name that is written out. */
#ifndef SF_GUI_GEO_NAMES_H
#define SF_GUI_GEO_NAMES_H

#include "case/case.h"
#include <stdbool.h>

enum { SF_GEO_NAME_SIZE = 256, SF_GEO_NAMES = 128 };

typedef struct sf_geo_name {
    char variable[SF_CASE_NAME_SIZE]; /* "thickness" */
    char name[SF_GEO_NAME_SIZE];      /* "Pad/2 Thickness [mm]" */
} sf_geo_name;

typedef struct sf_geo_names {
    int count;
    sf_geo_name name[SF_GEO_NAMES];
} sf_geo_names;

/* Of a file that is no text of gmsh's language there are none. Errors: the file cannot be read. */
sf_status sf_geo_names_read(const char *path, sf_geo_names *names, sf_error *err);
/* Those of a text alone, added. */
void sf_geo_names_scan(const char *text, sf_geo_names *names);

#endif
