/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of laws, and the batch of points that all laws update.
 *
 * To add a law: one file NAME.c here with the struct of its card, the list of its parameters, its history
 * variables, its functions and the entry `const sf_law sf_NAME` (material/card.h); and its name in the list
 * of laws.c. Case, model.h5, checks, written material files, docs (`softfall-pre --keys`), state, checkpoints
 * and solver follow the entry; tests/test_law.c walks the table: uniaxial stress against the batch, stress
 * against the energy. These files make the library softfall_material, which needs base alone. */
#pragma once
#include "material/card.h"

enum { SF_LAW_HISTORY = 24 }; /* rows of history at most */

/* Arrays are [component][lane]; matrices row-major (9) or symmetric (xx, yy, zz, xy, yz, xz). */
typedef struct sf_law_batch {
    /* in */
    double f[9][SF_LANES];     /* deformation gradient at the end of the step */
    double f_old[9][SF_LANES]; /* at its start */
    double length[SF_LANES];   /* m, of damping */
    /* in and out */
    /* SI, by law->history; rows beyond its variables are not used */
    double history[SF_LAW_HISTORY][SF_LANES];
    /* out */
    double p[9][SF_LANES];       /* Pa, first Piola-Kirchhoff stress */
    double stretch[3][SF_LANES]; /* -, principal stretches, unsorted */
    double jacobian[SF_LANES];   /* - */
    double energy[SF_LANES];     /* J m-3, W of the loading curve */
    double factor[SF_LANES];     /* -, hysteresis factor */
    double stiffness[SF_LANES];  /* Pa, that the stabilisation follows: the largest slope in the principal
                                    directions, at least that at rest on either side, since directions across
                                    the  load are at rest, on either side by rounding */
    double direction_tangent[3][SF_LANES];   /* Pa, bounds on the tangent dP/dF by principal direction
                                              */
    double direction_viscosity[3][SF_LANES]; /* Pa s, the same on dP/d(rate of F) */
    double tangent[SF_LANES];                /* Pa, the largest of them: bound on the tangent */
    double viscosity[SF_LANES];              /* Pa s */
    double directional[6][SF_LANES];         /* Pa, A with dF : dP <= trace(dF A dF^T), of a + 2 eta / dt, if
                                                `directions` */
    double work[SF_LANES];                   /* J m-3, viscous work of the step */
    double stored[SF_LANES], lost[SF_LANES]; /* J m-3, recoverable energy; energy lost to hysteresis */
    /* in */
    bool directions; /* fill `directional`? Only the power iteration needs it */
} sf_law_batch;

/* A point under uniaxial compression; begins as zeros. */
typedef struct sf_uniaxial {
    double strain;                  /* -, engineering, compression positive */
    double history[SF_LAW_HISTORY]; /* as in the batch; of tensors the axial component only, in their first
                                       row */
} sf_uniaxial;

/* The law of that number, from 0 (the default of a case); NULL beyond the last. */
const sf_law *sf_law_get(int number);
/* NULL if there is none of that name. */
const sf_law *sf_law_find(const char *name);

/* A material with the data to update points. */
typedef struct sf_material_law {
    const sf_law *law;
    void *numbers;           /* owned */
    double length;           /* m, fixed length of damping; 0: each node's spacing */
    int rows;                /* kept rows of history */
    int row[SF_LAW_HISTORY]; /* row of the batch that each is; ascending */
    int row_end;             /* rows of the batch that the law uses: 0 .. row_end - 1 */
} sf_material_law;

/* Builds the law of a checked material. `law` is owned by the caller; on failure it is zeroed. */
sf_status sf_material_law_build(const sf_material *material, sf_material_law *law, sf_error *err);
void sf_material_law_free(sf_material_law *law);

/* True if the material has a reloading path of its own (material/memory.h): without one it loads along its
 * unloading path, up to the largest energy so far. */
bool sf_material_has_memory(const sf_material *material);

/* Rows of SF_LANES doubles that one batch of the material keeps between steps. */
int sf_material_history_rows(const sf_material *material);

/* Rows of history between the state's [rows][SF_LANES] and the batch; rows that are not kept are 0. */
void sf_material_load_history(const sf_material_law *law, const double *from, sf_law_batch *batch);
void sf_material_store_history(const sf_material_law *law, const sf_law_batch *batch, double *to);

/* A material point in uniaxial compression: what a written card gives in the test that it was fitted to. */

/* Sets F [9] of every lane to a stretch along z. */
void sf_material_point_stretch(double f[9][SF_LANES], double stretch);

/* Takes the point through `strain` [count] (from rest, in order) at the nominal rate (s-1), in steps of at
 * most `step` strain; `stress` [count] receives the compressive nominal stress (Pa). */
void sf_material_point_drive(const sf_material_law *law, double rate, double step, int count,
                             const double *strain, double *stress);

/* A path of a material point: `strain` over `time` (s) [count], straight between its points, from rest at the
 * first. Times ascend, strains are below 1. */
typedef struct sf_point_path {
    int64_t count;
    const double *time, *strain;
    bool is_free; /* the sides bulge freely, as sf_law.lateral has it; false: they are held */
} sf_point_path;

/* Takes the point along the path; `stress` [count] receives the compressive nominal stress (Pa), without the
 * terms that depend on a length. SF_ERR_NUMERIC: the law has none somewhere. */
sf_status sf_material_point_follow(const sf_material_law *law, const sf_point_path *path, double *stress,
                                   sf_error *err);

/* Unloads a point, and leaves it at rest for `pause` (s). */
void sf_material_point_rest(const sf_material_law *law, double pause, sf_uniaxial *point);
