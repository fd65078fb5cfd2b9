/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "pre/steps.h"

/* Builds the model from a case, a mesh and a missile surface: cloud, supports, smoothing domains, masses,
 * constraints, contact points, missile. */

/* Results of the build, for the table that softfall-pre prints. */
typedef struct sf_build_report {
    char mesh_hash[17];
    int64_t cells[10]; /* by SF_CELL_* */
    int64_t orphan_count;
    double mesh_volume;        /* m3 */
    sf_domain_figures domains; /* of all layers */
    double unheld[3];          /* m, a face that will pass through another one or the anvil; NaN: none */
    double first_step;         /* s, before any safety factor */
    double slowdown;           /* -, first step over the mean one of a compression (model/stability.h) */
    bool contact_held;         /* every contact point is held along z: nothing to drop on */
    sf_hold hold;
    sf_contact_zone zone;
    sf_error between; /* a part of the missile passes between the contact nodes */
    sf_invariants invariants;
    sf_interfaces interfaces; /* of the layers, as the materials of the model */
} sf_build_report;

/* Builds the model. The mesh is reordered and its cells move into the model; the case's curves, motion and
 * the surface's arrays move as well (the sources stay valid for their free functions). On failure `*model` is
 * empty. Warnings go to `sink`. */
sf_status sf_model_build(sf_case *c, sf_mesh *mesh, sf_surface *surface, sf_model *model,
                         sf_build_report *report, const sf_sink *sink, sf_error *err);

/* Makes the model of a case: the geometry through gmsh, then the build. */

enum { SF_LIBRARIES_SIZE = 96 };

/* `libraries` receives the versions of the libraries that took part. The curves and the motion of the case
 * move into the model (sf_model_build). Warnings go to `sink`. SF_ERR_INPUT, too, if every contact point is
 * held, or if the pad is not held (hold.h). On failure `*model` is empty. */
sf_status sf_model_make(sf_case *c, sf_model *model, sf_build_report *report,
                        char libraries[SF_LIBRARIES_SIZE], const sf_sink *sink, sf_error *err);

/* The report of softfall-pre: size and checks of the model, before a run. It is printed as a table, and
 * stands in model.h5 (/provenance/report) a line for each entry: key, name and value, separated by tabs. */

enum { SF_MODEL_REPORT_LINES = 32 + SF_INTERFACES_LISTED, SF_MODEL_REPORT_VALUE = 200 };

typedef struct sf_report_line {
    const char *key, *name; /* static */
    char value[SF_MODEL_REPORT_VALUE];
} sf_report_line;

typedef struct sf_model_report {
    int count;
    sf_report_line line[SF_MODEL_REPORT_LINES];
} sf_model_report;

void sf_model_report_make(const sf_model *model, const sf_build_report *report, sf_model_report *out);
void sf_model_report_print(FILE *out, const sf_model_report *report);

/* The text of /provenance/report; from malloc, owned by the caller; NULL without memory. */
char *sf_model_report_text(const sf_model_report *report, sf_error *err);
/* Finds the entry of that key in such a text; false: there is none. */
bool sf_model_report_find(const char *text, const char *key, char *name, size_t name_size, char *value,
                          size_t value_size);

/* Expected time of the run on two cores, s, to a factor of 2. */
double sf_report_seconds(const sf_model *model, const sf_build_report *report);
