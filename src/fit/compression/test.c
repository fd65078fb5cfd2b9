/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/compression/test.h"

#include "case/curve.h"

#include <math.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const double STRAIN_ZERO = 2e-3; /* strains from minus this on are zero with scatter */
static const double STRESS_ZERO = 0.01; /* stresses likewise, as a part of the largest */
static const double SMALL_STRAIN = 0.1; /* a test must reach it */
static const double SLACK = 0.005;      /* part of the largest stress that scatter may make */
static const double FALL = 0.1;         /* part of the stress that may be lost while loading */
static const double ABOVE = 0.05;       /* part by which unloading may lie above loading */

void sf_compression_test_free(sf_compression_test *test) {
    free(test->path);
    free(test->strain);
    free(test->stress);
    free(test->line);
    memset(test, 0, sizeof *test);
}

/* ---- reading ---- */

/* Checks of a single row; messages quote the cells as written. */
static sf_status check_row(const sf_table_point *p, sf_error *err) {
    bool fraction = p->value[0] == strtod(p->text[0], NULL);
    if (p->value[0] >= 1 && fraction)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s:%d: strain %s is not below 1; if it is in percent, name the column strain_percent",
                       p->path, p->line, p->text[0]);
    if (p->value[0] >= 1)
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: strain %s %% is not below 100 %%", p->path, p->line,
                       p->text[0]);
    if (p->value[0] < -STRAIN_ZERO)
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: strain %s is negative; compression must be positive",
                       p->path, p->line, p->text[0]);
    return SF_OK;
}

/* The table's arrays become the test's. */
static void take_table(sf_table *table, sf_compression_test *t) {
    t->count = (int)table->count;
    t->strain = table->value[0];
    t->stress = table->value[1];
    t->line = table->line;
    table->value[0] = table->value[1] = NULL;
    table->line = NULL;
    for (int i = 0; i < t->count; i++) {
        t->largest_strain = fmax(t->largest_strain, t->strain[i]);
        t->largest_stress = fmax(t->largest_stress, t->stress[i]);
    }
}

/* ---- checks of the whole ---- */

/* Loading lasts until the strain first falls. */
static sf_status split_branches(sf_compression_test *t, double scale, sf_error *err) {
    t->loading = t->count > 0;
    while (t->loading < t->count && t->strain[t->loading] >= t->strain[t->loading - 1])
        t->loading++;
    for (int i = t->loading + 1; i < t->count; i++)
        if (t->strain[i] > t->strain[i - 1])
            return SF_FAIL(err, SF_ERR_INPUT,
                           "%s:%d: strain %g rises again after it began to fall at line %d; a file holds one "
                           "loading and then one unloading",
                           t->path, t->line[i], t->strain[i] / scale, t->line[t->loading]);
    return SF_OK;
}

static sf_status check_size(const sf_compression_test *t, sf_error *err) {
    int unloading = t->count - t->loading;
    if (t->loading < SF_COMPRESSION_LOADING_POINTS)
        return SF_FAIL(err, SF_ERR_INPUT, "%s: %d points of loading; a test needs at least %d", t->path,
                       t->loading, SF_COMPRESSION_LOADING_POINTS);
    if (unloading > 0 && unloading < SF_COMPRESSION_UNLOADING_POINTS)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s:%d: strain falls from this line on, but unloading has %d points; it needs at "
                       "least %d, or none",
                       t->path, t->line[t->loading], unloading, SF_COMPRESSION_UNLOADING_POINTS);
    if (t->largest_strain < SMALL_STRAIN)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s: the largest strain is %g %%; a test must reach %g %% (is the column in percent "
                       "and named strain, or the other way round?)",
                       t->path, 100 * t->largest_strain, 100 * SMALL_STRAIN);
    return SF_OK;
}

static sf_status check_sign(const sf_compression_test *t, double scale, sf_error *err) {
    double size = 0;
    for (int i = 0; i < t->count; i++)
        size = fmax(size, fabs(t->stress[i]));
    if (!(size > 0))
        return SF_FAIL(err, SF_ERR_INPUT, "%s: the stress is zero everywhere", t->path);
    for (int i = 0; i < t->count; i++)
        if (t->stress[i] < -STRESS_ZERO * size)
            return SF_FAIL(
                err, SF_ERR_INPUT,
                "%s:%d: stress %g is negative, beyond the scatter about zero; compression must be positive",
                t->path, t->line[i], t->stress[i] / scale);
    return SF_OK;
}

static sf_status check_loading(const sf_compression_test *t, double scale, sf_error *err) {
    double highest = 0;
    int where = 0;
    for (int i = 0; i < t->loading; i++) {
        if (t->stress[i] < (1 - FALL) * highest - SLACK * t->largest_stress)
            return SF_FAIL(err, SF_ERR_INPUT,
                           "%s:%d: stress %g has fallen by more than a tenth from %g at line %d while "
                           "loading; the foam law rises",
                           t->path, t->line[i], t->stress[i] / scale, highest / scale, t->line[where]);
        if (t->stress[i] > highest) {
            highest = t->stress[i];
            where = i;
        }
    }
    return SF_OK;
}

/* Stress of loading at a strain, by interpolation. */
static double loading_stress(const sf_compression_test *t, double strain) {
    int high = t->loading - 1, low = 0;
    if (strain <= t->strain[0])
        return t->stress[0];
    while (high - low > 1) {
        int middle = (low + high) / 2;
        *(t->strain[middle] < strain ? &low : &high) = middle;
    }
    double width = t->strain[high] - t->strain[low];
    double part = width > 0 ? fmin(1, (strain - t->strain[low]) / width) : 1;
    return t->stress[low] + part * (t->stress[high] - t->stress[low]);
}

static sf_status check_unloading(const sf_compression_test *t, double scale, sf_error *err) {
    for (int i = t->loading; i < t->count; i++) {
        double loading = loading_stress(t, t->strain[i]);
        if (t->stress[i] > (1 + ABOVE) * loading + SLACK * t->largest_stress)
            return SF_FAIL(
                err, SF_ERR_INPUT,
                "%s:%d: unloading stress %g lies above the loading stress %g at the same strain %g", t->path,
                t->line[i], t->stress[i] / scale, loading / scale, t->strain[i]);
    }
    return SF_OK;
}

static sf_status check_test(sf_compression_test *t, const double scale[2], sf_error *err) {
    if (split_branches(t, scale[0], err) != SF_OK || check_size(t, err) != SF_OK ||
        check_sign(t, scale[1], err) != SF_OK || check_loading(t, scale[1], err) != SF_OK)
        return err->status;
    return check_unloading(t, scale[1], err);
}

/* Means of `group` neighbours from `first` up to `end`, written from `to` on; returns the place after them.
 */
static int average(sf_compression_test *t, int first, int end, int group, int to) {
    for (int i = first; i < end; i += group, to++) {
        int n = end - i < group ? end - i : group;
        double strain = 0, stress = 0;
        for (int k = i; k < i + n; k++) {
            strain += t->strain[k] / n;
            stress += t->stress[k] / n;
        }
        t->strain[to] = strain;
        t->stress[to] = stress;
        t->line[to] = t->line[i];
    }
    return to;
}

static void condense(sf_compression_test *t) {
    enum { MOST = SF_COMPRESSION_BRANCH_POINTS };
    int turn = t->loading - 1, unloading = t->count - t->loading;
    int loading = average(t, 0, turn, (t->loading + MOST - 1) / MOST, 0);
    loading = average(t, turn, t->loading, 1, loading);
    t->count = unloading ? average(t, t->loading, t->count, (unloading + MOST - 1) / MOST, loading) : loading;
    t->loading = loading;
}

sf_status sf_compression_test_read(const char *path, double rate, sf_compression_test *test, sf_error *err) {
    *test = (sf_compression_test){.path = strdup(path), .rate = rate};
    const sf_table_layout layout = sf_case_curve_layout("test", check_row);
    sf_table table = {0};
    if (!test->path)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the path %s", path);
    if (sf_table_read(path, &layout, &table, err) == SF_OK) {
        take_table(&table, test);
        if (check_test(test, table.scale, err) == SF_OK)
            condense(test);
    }
    sf_table_free(&table);
    if (err->status != SF_OK)
        sf_compression_test_free(test);
    return err->status;
}
