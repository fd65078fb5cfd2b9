/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Drop height and speed at contact. In free fall v^2 = 2 g h with g = 9.80665 m s-2. On a rig whose guides
 * rub, v^2 = 2 g_eff h with a g_eff below that, fitted to measured pairs of height and speed. */
#ifndef SF_CFH_RIG_H
#define SF_CFH_RIG_H

#include "io/table_csv.h"

enum { SF_CFH_MAX_PAIRS = 64 };

typedef struct sf_cfh_rig {
    int pairs;                            /* 0: free fall */
    double gravity;                       /* m s-2, g_eff, or g */
    double standard_error;                /* m s-2 */
    double margin;                        /* -, half-width of the 95 % interval of ln(g_eff) */
    char understood[SF_TABLE_UNDERSTOOD]; /* how its file was read; empty: there is none */
} sf_cfh_rig;

/* Free fall. */
sf_cfh_rig sf_cfh_free_fall(void);

/* Least squares of speed^2 over 2 height through the origin. heights m, speeds m s-1. SF_ERR_INPUT: fewer
 * than two pairs, a number that is not positive, a speed above that of free fall (by more than 3 %). `name`
 * is where they come from, for the sentence. */
sf_status sf_cfh_rig_fit(const char *name, int pairs, const double *height, const double *speed,
                         sf_cfh_rig *rig, sf_error *err);

/* The same from a CSV file (io/table_csv.h) with a column height_m, h_m or h_m_m ("h_m" in m) and a column
 * speed_m_s or v_test_m_s, or a height and a speed with units. */
sf_status sf_cfh_rig_read(const char *path, sf_cfh_rig *rig, sf_error *err);

double sf_cfh_speed(double free_fall_height);
double sf_cfh_free_fall_height(double speed);

#endif
