/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Up to which strain is the curve of each foam of the pad given? */
#ifndef SF_CFH_FOAMS_H
#define SF_CFH_FOAMS_H

#include "case/case.h"

typedef struct sf_cfh_foam {
    char name[SF_MATERIAL_NAME_SIZE]; /* of a layer; "": the pad has one material */
    double end;                       /* -, sf_law.data_end */
    const char *words;                /* sf_law.data_end_words; static */
} sf_cfh_foam;

typedef struct sf_cfh_foams {
    int count; /* at least 1; 1: one material, whatever its name */
    sf_cfh_foam foam[SF_CASE_MAX_LAYERS];
} sf_cfh_foams;

#endif
