/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/cfh/rig.h"

#include "base/units.h"
#include "io/table_csv.h"
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_fit.h>
#include <math.h>
#include <string.h>

static const double MAX_SPEED_RATIO = 1.03; /* to free fall: beyond it a pair is wrong, not merely measured */

double sf_cfh_speed(double free_fall_height) {
    return sqrt(2 * SF_STANDARD_GRAVITY * free_fall_height);
}

double sf_cfh_free_fall_height(double speed) {
    return speed * speed / (2 * SF_STANDARD_GRAVITY);
}

sf_cfh_rig sf_cfh_free_fall(void) {
    return (sf_cfh_rig){.gravity = SF_STANDARD_GRAVITY};
}

sf_status sf_cfh_rig_fit(const char *name, int pairs, const double *height, const double *speed,
                         sf_cfh_rig *rig, sf_error *err) {
    double x[SF_CFH_MAX_PAIRS], y[SF_CFH_MAX_PAIRS], variance = 0, residual = 0;
    *rig = sf_cfh_free_fall();
    if (pairs < 2 || pairs > SF_CFH_MAX_PAIRS)
        return SF_FAIL(err, SF_ERR_INPUT, "%s has %d pairs of height and speed, 2 to %d are needed", name,
                       pairs, SF_CFH_MAX_PAIRS);
    for (int k = 0; k < pairs; k++) {
        if (!(height[k] > 0) || !(speed[k] > 0))
            return SF_FAIL(err, SF_ERR_INPUT, "%s: pair %d, %g m and %g m/s, is not positive", name, k + 1,
                           height[k], speed[k]);
        if (speed[k] > MAX_SPEED_RATIO * sf_cfh_speed(height[k]))
            return SF_FAIL(err, SF_ERR_INPUT,
                           "%s: pair %d, %g m/s from %g m, is faster than free fall (%.4g m/s)", name, k + 1,
                           speed[k], height[k], sf_cfh_speed(height[k]));
        x[k] = 2 * height[k];
        y[k] = speed[k] * speed[k];
    }
    gsl_fit_mul(x, 1, y, 1, (size_t)pairs, &rig->gravity, &variance, &residual);
    rig->pairs = pairs;
    rig->standard_error = sqrt(variance);
    rig->margin = gsl_cdf_tdist_Pinv(0.975, pairs - 1) * rig->standard_error / rig->gravity;
    return SF_OK;
}

static sf_status check_pair(const sf_table_point *p, sf_error *err) {
    if (p->index == SF_CFH_MAX_PAIRS)
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: more than %d pairs", p->path, p->line, SF_CFH_MAX_PAIRS);
    return SF_OK;
}

static const sf_table_name names[] = {{"height_m", 0, 1, "m"},
                                      {"h_m", 0, 1, "m"},
                                      {"h_m_m", 0, 1, "m"},
                                      {"speed_m_s", 1, 1, "m/s"},
                                      {"v_test_m_s", 1, 1, "m/s"}};

static const sf_table_layout layout = {
    .what = "rig",
    .column = {"height", "speed"},
    .wanted = {"height_m, h_m or h_m_m", "speed_m_s or v_test_m_s"},
    .names = names,
    .name_count = sizeof names / sizeof *names,
    .words = {"height|h|*höhe|*hoehe|hauteur|altura|altezza",
              "speed|velocity|v|*geschwindigkeit|vitesse|velocidad|velocità"},
    .kind = {SF_LENGTH, SF_SPEED},
    .ragged = true,
    .check = check_pair,
};

sf_status sf_cfh_rig_read(const char *path, sf_cfh_rig *rig, sf_error *err) {
    sf_table table;
    *rig = sf_cfh_free_fall();
    if (sf_table_read(path, &layout, &table, err) != SF_OK)
        return err->status;
    sf_cfh_rig_fit(path, (int)table.count, table.value[0], table.value[1], rig, err);
    memcpy(rig->understood, table.understood, sizeof rig->understood);
    sf_table_free(&table);
    return err->status;
}
