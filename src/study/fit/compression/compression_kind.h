/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The models that `softfall-fit compression` fits: one entry for each. compression_command.c has the only
 * pipeline: configuration, fit, files, summary, warnings. */
#pragma once
#include "material/hyperfoam.h"
#include "report/row.h"
#include "study/fit/compression/compression_config.h"

/* The request of the command; borrowed. */
typedef struct sf_compression_job {
    struct sf_study *study; /* study/setup.h */
    const char *case_path;  /* --simulate: of a cube between platens (missile.motion,
                               geometry.parameters.side); NULL: none */
    const char *friction;   /* of the upper platen, in place of the case's; NULL: the case's */
} sf_compression_job;

typedef struct sf_compression_kind {
    const char *label; /* in a refusal of --simulate: "law = \"hyperfoam\""; NULL: --simulate works */
    const char *files; /* of the closing line */
    const char *const *outputs; /* every file that may be written, material.cfg last; NULL at the end */
    size_t size;                /* bytes of a fit */

    /* Fits; `config` is borrowed until `free`. SF_ERR_NUMERIC if no search converges. */
    sf_status (*run)(const sf_compression_config *config, void *fit, sf_error *err);
    void (*free)(void *fit); /* NULL: the fit owns nothing */
    /* The fitted material; its arrays stay those of the fit. */
    sf_material (*material)(const void *fit);
    /* Writes the summary or, with `comments`, the comments of material.cfg. */
    void (*describe)(FILE *out, const void *fit, bool comments);
    /* The contents of fit.csv, and the members of fit.json. */
    void (*points)(sf_csv *csv, const void *fit);
    void (*json)(sf_json *json, const void *fit, const char *path);
    /* Further files; NULL: none. `warning` (size bytes): why there is no picture, or "". */
    sf_status (*more)(const sf_compression_job *job, void *fit, char *warning, size_t size, sf_error *err);
    void (*warn)(const void *fit, const sf_sink *sink);
} sf_compression_kind;

/* A spline with rate terms and a densification law, written as tables; a form of few parameters (fit/form);
 * the hyperfoam. */
extern const sf_compression_kind sf_compression_tables, sf_compression_form_kind, sf_compression_hyperfoam;

/* Stress (Pa, compression positive), lateral strain and W (J m-3) of a hyperfoam in loading with free sides
 * at an axial strain; `lateral` is also the start of the search. */
double sf_hyperfoam_free_stress(const sf_hyperfoam *foam, double strain, double *lateral, double *energy);

/* Runs `softfall-fit compression FIT.cfg -o DIR` and returns the exit code; argv[0] is the name of the
 * program. */
int sf_fit_compression_main(int argc, char **argv);

/* The functions of a kind by their usual names. */
#define SF_COMPRESSION_PARTS                                                                                 \
    .outputs = outputs, .run = run, .material = material_of, .describe = describe, .points = put_points,     \
    .json = put_json, .warn = warn
