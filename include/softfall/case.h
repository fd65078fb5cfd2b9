/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Cases, and models made of them (libsoftfall-build). */
#pragma once
#include "softfall/material.h"
#include "softfall/model.h"

typedef struct softfall_case softfall_case;

/* Reads and checks a case file. `overrides`: `count` texts "group.key=value" as softfall-pre's --set takes
 * them, borrowed for the call. */
SOFTFALL_API softfall_status softfall_case_read(const char *path, const char *const *overrides, int count,
                                                const softfall_sink *sink, softfall_case **out,
                                                softfall_error *error);
/* The same of drop number `drop`, from 1, of the case's series alone, with what the series changes of the
 * missile in it. */
SOFTFALL_API softfall_status softfall_case_read_drop(const char *path, int drop, const char *const *overrides,
                                                     int count, const softfall_sink *sink,
                                                     softfall_case **out, softfall_error *error);
SOFTFALL_API void softfall_case_free(softfall_case *c);
/* The values of the case: a line for each key with its name, value as --set takes it, value in SI units, and
 * "given" or "default", between blanks; owned by the case. */
SOFTFALL_API const char *softfall_case_parameters(const softfall_case *c);
/* Sets a hash of all that the case says: its values, the points of its curves and of its motion, its geometry
 * files. The places of files do not count. What a geometry includes or merges is not part of it: ask
 * softfall_case_has_geometry_of. */
SOFTFALL_API softfall_status softfall_case_hash(const softfall_case *c, uint64_t *hash,
                                                softfall_error *error);
/* Returns 1 if every file that the geometries of the model behind `results` (a results.h5) read, included
 * ones too, has its content still beside the geometries of this case; 0 if not, or if it cannot be told. */
SOFTFALL_API int softfall_case_has_geometry_of(const softfall_case *c, const char *results);

/* A drop of the case's series. */
typedef struct softfall_case_drop {
    int drops;       /* of the series, 1: a single drop */
    int counted;     /* 1: the series is judged by this drop */
    int own;         /* 1: its missile is not that of the first drop: softfall_case_read_drop has it */
    double interval; /* s, from the drop before */
} softfall_case_drop;
/* Drop number `drop`, from 1 to `drops`. */
SOFTFALL_API softfall_case_drop softfall_case_drop_get(const softfall_case *c, int drop);
/* Returns the strain (-) at which the data of a foam end: of layer `layer`, from 0 on, 0 for a pad of one
 * material. NaN: there is no such layer. */
SOFTFALL_API double softfall_case_data_end(const softfall_case *c, int layer);
/* SOFTFALL_INPUT: the case has no place in a study, for a parameter that a geometry does not have, or a
 * series of drops on a foam without memory. It runs no gmsh. */
SOFTFALL_API softfall_status softfall_case_check(const softfall_case *c, softfall_error *error);
/* Returns 1 if every file of the list softfall_model_geometry_files, of a model of this case, is as it was.
 */
SOFTFALL_API int softfall_case_has_files(const softfall_case *c, const char *files);
/* Keeps the database of units loaded, which every reading of a case loads anew otherwise (5 ms): for a
 * process that reads very many. To be called once, while no other thread reads anything. */
SOFTFALL_API softfall_status softfall_units_hold(softfall_error *error);

/* Sets how softfall_model_build builds: `share`, a folder, or NULL: takes meshes, smoothing domains and
 * what drops of the section told from there where a case of the same geometry has left them, and leaves them
 * there, also for other processes. The environment variable SOFTFALL_SHARE stands before `share`, and is
 * the folder of a case for which this is not called.
 * `section` 1: runs the drops of its section, or of a plate like it, that tell the errors by its mesh, as
 * softfall-pre does.
 */
SOFTFALL_API softfall_status softfall_case_set_build(softfall_case *c, const char *share, int section,
                                                     softfall_error *error);
/* Meshes the geometry of the case and builds the model. A case can be built once; afterwards it can only be
 * freed. */
SOFTFALL_API softfall_status softfall_model_build(softfall_case *c, const softfall_sink *sink,
                                                  softfall_model **out, softfall_error *error);

/* The foam of a case that has not been built, with the values that its overrides set: for
 * softfall_model_vary. SOFTFALL_INPUT: the pad has layers. Its list of values is that of the whole case. */
SOFTFALL_API softfall_status softfall_case_material(const softfall_case *c, softfall_material **out,
                                                    softfall_error *error);
