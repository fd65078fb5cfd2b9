/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Curves of a case from CSV files (io/table_csv.h): compression curves, and the motion of a driven missile.
 *
 * A compression curve has the columns `strain` or `strain_percent` and `stress_Pa`, `stress_kPa` or
 * `stress_MPa`, or a strain and a stress with units; then one point per line. Engineering strain and nominal
 * stress, positive in compression. */
#pragma once
#include "case/reader.h"
#include "io/table_csv.h"

enum { SF_CURVE_MIN_POINTS = 4 };
#define SF_CURVE_MIN_END 0.2 /* a shorter table does not cover the strains of an impact */

typedef struct sf_case_curve {
    int64_t count;
    double *strain;                               /* [count] -, strictly increasing from 0, below 1; owned */
    double *stress;                               /* [count] Pa, from 0, non-decreasing, finite; owned */
    char interpretation[SF_TABLE_INTERPRETATION]; /* how the file was read */
    bool extended; /* the file began above zero strain and (0, 0) was put before it */
} sf_case_curve;

/* Returns the layout of a curve file, also of tests with unloading; `what` names the file in sentences. */
sf_table_layout sf_case_curve_layout(const char *what, sf_table_check *check);

/* Reads and checks a curve; SF_ERR_INPUT names file, line and value. On failure `*curve` is zeroed. */
sf_status sf_case_curve_read(const char *path, sf_case_curve *curve, sf_error *err);
void sf_case_curve_free(sf_case_curve *curve);

/* The keys material.curve and material.curves. Internal to src/case. */

/* The readers of SF_KEY_CURVE and SF_KEY_CURVES. */
sf_status sf_case_read_curves(sf_case_reader *reader, const config_setting_t *setting, char *detail,
                              size_t size, sf_error *err);
/* The reader of SF_KEY_MOTION, the displacement over time of a missile that a machine drives. */
sf_status sf_case_read_motion(sf_case_reader *reader, const config_setting_t *setting, char *detail,
                              size_t size, sf_error *err);
