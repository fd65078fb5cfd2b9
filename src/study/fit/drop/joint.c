/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/drop/joint.h"

#include "base/hash.h"
#include "base/units.h"
#include "study/column.h"
#include <math.h>
#include <string.h>

static const double LEAST_STRESS = 0.02; /* of the largest, in the scatter */
static const double STRAIN_STEP = 0.01;  /* of a test at the material point */

void sf_joint_data(const sf_joint *joint, double *measured, double *sd) {
    int row = 0;
    for (int t = 0; t < joint->test_count; t++) {
        const sf_joint_test *test = &joint->test[t];
        for (int k = 0; k < test->count; k++, row++) {
            measured[row] = test->stress[k] / test->scale;
            sd[row] = test->sd * hypot(measured[row], LEAST_STRESS);
        }
    }
    for (int c = 0; c < joint->cushion_count; c++)
        for (int k = 0; k < joint->cushion[c].count; k++, row++) {
            measured[row] = log(joint->cushion[c].peak_g[k]);
            sd[row] = joint->cushion[c].sd;
        }
}

/* Takes the point to a strain; the stress there. */
static double drive(const sf_material_law *law, double rate, double to, sf_uniaxial *point) {
    double from = point->strain, stress = 0;
    int steps = (int)ceil(fabs(to - from) / STRAIN_STEP);
    steps = steps > 0 ? steps : 1;
    for (int k = 1; k <= steps; k++)
        stress = law->law->uniaxial(law->numbers, fmax(fabs(to - from), 1e-6) / rate / steps,
                                    from + (to - from) * k / steps, point);
    return stress;
}

static sf_status compress(const sf_joint_test *test, const sf_material_law *law, double *y, sf_error *err) {
    sf_uniaxial point = {0};
    for (int k = 0; k < test->count; k++) {
        if (k == test->loading)
            drive(law, test->rate, test->turn, &point);
        y[k] = drive(law, test->rate, test->strain[k], &point) / test->scale;
        if (!isfinite(y[k]))
            return SF_FAIL(err, SF_ERR_NUMERIC, "the foam of the test %s collapsed at a strain of %g",
                           test->name, test->strain[k]);
    }
    return SF_OK;
}

/* Block of 1 m2 under a flat mass. */
static sf_status drop_flat(const sf_joint_cushion *cushion, double static_stress, const sf_material_law *law,
                           double *y, sf_error *err) {
    const sf_columns block = {.mass = static_stress / SF_STANDARD_GRAVITY,
                              .speed = sqrt(2 * SF_STANDARD_GRAVITY * cushion->height),
                              .thickness = cushion->thickness,
                              .count = 1,
                              .area = {1}};
    sf_columns_figures figures;
    if (sf_columns_respond(&block, law, &figures, NULL, err) == SF_OK)
        *y = log(figures.a_max_g);
    return err->status;
}

sf_status sf_joint_respond(const sf_joint *joint, const sf_material_law *law, double *y, sf_error *err) {
    for (int t = 0; t < joint->test_count; y += joint->test[t++].count)
        SF_TRY(compress(&joint->test[t], law, y, err));
    for (int c = 0; c < joint->cushion_count; c++)
        for (int k = 0; k < joint->cushion[c].count; k++)
            SF_TRY(drop_flat(&joint->cushion[c], joint->cushion[c].static_stress[k], law, y++, err));
    return SF_OK;
}

uint64_t sf_joint_hash(uint64_t hash, const sf_joint *joint) {
    for (int t = 0; t < joint->test_count; t++) {
        const sf_joint_test *test = &joint->test[t];
        const double numbers[] = {test->rate, test->turn, test->scale, test->count, test->loading};
        hash = sf_hash_identity(hash, numbers, sizeof numbers);
        hash = sf_hash_identity(hash, test->strain, (size_t)test->count * sizeof *test->strain);
    }
    for (int c = 0; c < joint->cushion_count; c++) {
        const sf_joint_cushion *cushion = &joint->cushion[c];
        const double numbers[] = {cushion->thickness, cushion->height, cushion->count};
        hash = sf_hash_identity(hash, numbers, sizeof numbers);
        hash = sf_hash_identity(hash, cushion->static_stress, (size_t)cushion->count * sizeof(double));
    }
    return hash;
}

double sf_joint_rms(const sf_joint_test *test, bool unloading, const double *y) {
    int first = unloading ? test->loading : 0, last = unloading ? test->count : test->loading;
    double sum = 0;
    for (int k = first; k < last; k++)
        sum += pow(y[k] - test->stress[k] / test->scale, 2);
    return last > first ? sqrt(sum / (last - first)) : NAN;
}
