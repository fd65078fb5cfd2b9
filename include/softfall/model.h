/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models, in memory and in files (libsoftfall). */
#pragma once
#include "softfall/status.h"

typedef struct softfall_model softfall_model;

typedef struct softfall_model_info {
    int64_t node_count;
    int64_t symmetry_factor;   /* 1, 2 or 4: how many times the modelled part makes the whole */
    double thickness;          /* m, of the pad */
    double missile_mass;       /* kg, of the whole missile; 0 with a prescribed motion */
    double missile_speed;      /* m/s, at t = 0; 0 with a prescribed motion */
    double end_time;           /* s */
    int has_prescribed_motion; /* 1: the missile's motion is given, 0: it is free */
} softfall_model_info;

/* model.h5 of softfall-pre (docs/formats.md). An earlier file is replaced, whole or not at all. */
SOFTFALL_API softfall_status softfall_model_read(const char *path, softfall_model **out,
                                                 softfall_error *error);
SOFTFALL_API softfall_status softfall_model_write(const softfall_model *model, const char *path,
                                                  softfall_error *error);
SOFTFALL_API void softfall_model_free(softfall_model *model);

/* Returns what its geometries have read, with hashes: a list for softfall_case_has_files; owned by the model.
 */
SOFTFALL_API const char *softfall_model_geometry_files(const softfall_model *model);
SOFTFALL_API softfall_model_info softfall_model_describe(const softfall_model *model);
/* [node_count][3] m, reference positions of the nodes; owned by the model. */
SOFTFALL_API const double *softfall_model_positions(const softfall_model *model);
