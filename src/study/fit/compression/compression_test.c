/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/compression/compression_test.h"

#include "case/curves.h"

#include <math.h>
#include <stdio.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

static const double STRAIN_ZERO = 2e-3; /* strains from minus this on are zero with scatter */
static const double STRESS_ZERO = 0.01; /* stresses likewise, as a part of the largest */
static const double JITTER = 5e-4;      /* strain by which scatter may turn it back */
static const double SMALL_STRAIN = 0.1; /* a test must reach it */
static const double SLACK = 0.005;      /* part of the largest stress that scatter may make */
static const double FALL = 0.1;         /* part of the stress that may be lost while loading */
static const double ABOVE = 0.05;       /* part by which unloading may lie above loading */

/* Bounds of the toe correction. */
static const double TOE_RANGE = 0.15;  /* strain up to which the steepest part is looked for */
static const double TOE_WIDTH = 0.01;  /* strain of that part, with TOE_POINTS points at least */
static const double TOE_LARGEST = 0.1; /* strain that it may take away */
static const double EQUAL = 1e-6;      /* relative difference of slopes that counts as none */
enum { TOE_POINTS = 5 };

void sf_compression_test_free(sf_compression_test *test) {
    free(test->path);
    free(test->strain);
    free(test->stress);
    free(test->line);
    memset(test, 0, sizeof *test);
}

/* ---- reading ---- */

/* The names and scales of the two quantities in the file, for messages in its own terms. */
typedef struct table_terms {
    const char *name[2];
    double scale[2]; /* from the file's units to strain and Pa */
} table_terms;

static sf_table_layout machine_layout(void) {
    static const sf_table_name names[] = {{"displacement_m", 0, 1, "m"},
                                          {"displacement_mm", 0, 1e-3, "mm"},
                                          {"force_N", 1, 1, "N"},
                                          {"force_kN", 1, 1e3, "kN"}};
    return (sf_table_layout){
        .what = "test",
        .column = {"displacement", "force"},
        .wanted = {"\"displacement_mm\"", "\"force_N\""},
        .names = names,
        .name_count = sizeof names / sizeof *names,
        .words =
            {"displacement|extension|crosshead|position|travel|stroke|deformation|deflection|compression|*weg|"
             "*verformung|*stauchung|desplazamiento|déplacement|spostamento",
             "force|load|f|*kraft|fuerza|carga|forza|carico"},
        .kind = {SF_LENGTH, SF_FORCE},
    };
}

/* Displacement and force become strain and stress. */
static sf_status take_terms(const sf_compression_source *source, bool machine, const sf_table *table,
                            table_terms *t, sf_error *err) {
    *t = (table_terms){{"strain", "stress"}, {table->scale[0], table->scale[1]}};
    if (!machine)
        return SF_OK;
    if (!(source->area > 0) || !(source->thickness > 0))
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "%s holds displacement and force: give the specimen, for example specimen = { side = \"50 "
            "mm\"; thickness = \"50 mm\"; } (or diameter, or area)",
            source->path);
    *t = (table_terms){{"displacement", "force"},
                       {table->scale[0] / source->thickness, table->scale[1] / source->area}};
    return SF_OK;
}

/* Checks of a single row. */
static sf_status check_row(const sf_compression_test *t, int i, const table_terms *terms, sf_error *err) {
    double strain = t->strain[i], written = strain / terms->scale[0];
    const char *name = terms->name[0];
    if (strain >= 1 && terms->scale[0] == 1)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s:%d: strain %g is not below 1; if it is in percent, name the column strain_percent",
                       t->path, t->line[i], written);
    if (strain >= 1)
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: %s %g means a strain of %g %%, which is not below 100 %%",
                       t->path, t->line[i], name, written, 100 * strain);
    if (strain < -STRAIN_ZERO)
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "%s:%d: %s %g is negative; compression must be positive (invert = \"...\" in the file that "
            "names the test changes the sign)",
            t->path, t->line[i], name, written);
    return SF_OK;
}

/* The table's arrays become the test's. */
static sf_status take_table(const sf_compression_source *source, const table_terms *terms, sf_table *table,
                            sf_compression_test *t, sf_error *err) {
    t->count = (int)table->count;
    t->strain = table->value[0];
    t->stress = table->value[1];
    t->line = table->line;
    table->value[0] = table->value[1] = NULL;
    table->line = NULL;
    double factor[2] = {terms->scale[0] / table->scale[0], terms->scale[1] / table->scale[1]};
    factor[0] *= source->invert & SF_INVERT_STRAIN ? -1 : 1;
    factor[1] *= source->invert & SF_INVERT_STRESS ? -1 : 1;
    for (int i = 0; i < t->count; i++) {
        t->strain[i] *= factor[0];
        t->stress[i] *= factor[1];
        if (check_row(t, i, terms, err) != SF_OK)
            return err->status;
        t->largest_strain = fmax(t->largest_strain, t->strain[i]);
        t->largest_stress = fmax(t->largest_stress, t->stress[i]);
    }
    return SF_OK;
}

/* ---- toe ---- */

/* Straight line through the points first to last of a branch: slope, and strain at zero stress. */
static double line_through(const sf_compression_test *t, int first, int last, double *zero) {
    double n = last - first + 1, strain = 0, stress = 0, product = 0, square = 0;
    for (int i = first; i <= last; i++) {
        strain += t->strain[i] / n;
        stress += t->stress[i] / n;
    }
    for (int i = first; i <= last; i++) {
        product += (t->strain[i] - strain) * (t->stress[i] - stress);
        square += (t->strain[i] - strain) * (t->strain[i] - strain);
    }
    double slope = square > 0 ? product / square : 0;
    *zero = slope > 0 ? strain - stress / slope : 0;
    return slope;
}

/* The window of loading, below TOE_RANGE, in which the stress rises most steeply. False without a window. */
static bool steepest(const sf_compression_test *t, int *first, int *last, double *zero, bool *at_end) {
    double best = 0;
    for (int i = 0, k = 0; i < t->loading && t->strain[i] <= TOE_RANGE; i++) {
        double crossing;
        while (k < t->loading - 1 && (t->strain[k] < t->strain[i] + TOE_WIDTH || k < i + TOE_POINTS - 1))
            k++;
        if (k < i + TOE_POINTS - 1 || t->strain[k] > TOE_RANGE)
            break;
        double slope = line_through(t, i, k, &crossing);
        *at_end = slope > (1 + EQUAL) * best;
        if (*at_end) {
            best = slope;
            *first = i;
            *last = k;
            *zero = crossing;
        }
    }
    return best > 0;
}

/* Removes points of the toe and shifts the strain. */
static void shift_zero(sf_compression_test *t, int first, double zero) {
    int to = 0, loading = 0;
    for (int i = first; i < t->count; i++) {
        if (t->strain[i] < zero)
            continue;
        t->strain[to] = t->strain[i] - zero;
        t->stress[to] = t->stress[i];
        t->line[to++] = t->line[i];
        loading += i < t->loading;
    }
    t->count = to;
    t->loading = loading;
    t->toe = zero;
    t->largest_strain -= zero;
}

static sf_status correct_toe(sf_compression_test *t, sf_error *err) {
    int first = 0, last = 0;
    double zero = 0;
    bool at_end = false;
    if (!steepest(t, &first, &last, &zero, &at_end) || at_end)
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "%s: the toe cannot be corrected: loading has no steepest straight part below a strain of "
            "%g %% (leave toe_correction out)",
            t->path, 100 * TOE_RANGE);
    if (zero > TOE_LARGEST)
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "%s: the toe correction would be a strain of %.3g %%, more than %g %%: cut the approach off "
            "the file",
            t->path, 100 * zero, 100 * TOE_LARGEST);
    if (zero > 0)
        shift_zero(t, first, zero);
    return SF_OK;
}

/* ---- checks of the whole ---- */

/* A fall of more than JITTER below what was reached, before the largest strain: the strain turns twice. */
static sf_status check_rise(const sf_compression_test *t, const table_terms *terms, sf_error *err) {
    double highest = t->count > 0 ? t->strain[0] : 0;
    for (int i = 1; i < t->loading; i++) {
        highest = fmax(highest, t->strain[i]);
        if (t->strain[i] >= highest - JITTER)
            continue;
        int again = i + 1; /* there is one, as the largest strain follows */
        while (again < t->loading - 1 && t->strain[again] <= t->strain[again - 1])
            again++;
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "%s:%d: %s %g rises again after it began to fall at line %d; a file holds one loading and "
            "then one unloading",
            t->path, t->line[again], terms->name[0], t->strain[again] / terms->scale[0], t->line[i]);
    }
    return SF_OK;
}

static sf_status check_fall(const sf_compression_test *t, const table_terms *terms, sf_error *err) {
    double lowest = INFINITY;
    for (int i = t->loading; i < t->count; i++) {
        lowest = fmin(lowest, t->strain[i]);
        if (t->strain[i] > lowest + JITTER)
            return SF_FAIL(
                err, SF_ERR_INPUT,
                "%s:%d: %s %g rises again after it began to fall at line %d; a file holds one loading and "
                "then one unloading",
                t->path, t->line[i], terms->name[0], t->strain[i] / terms->scale[0], t->line[t->loading]);
    }
    return SF_OK;
}

/* Puts the points of a branch in the order of `sign` times their strain; how many moved. */
static int sort_branch(sf_compression_test *t, int first, int end, double sign) {
    int moved = 0;
    for (int i = first + 1; i < end; i++) {
        double strain = t->strain[i], stress = t->stress[i];
        int line = t->line[i], to = i;
        for (; to > first && sign * t->strain[to - 1] > sign * strain; to--) {
            t->strain[to] = t->strain[to - 1];
            t->stress[to] = t->stress[to - 1];
            t->line[to] = t->line[to - 1];
        }
        t->strain[to] = strain;
        t->stress[to] = stress;
        t->line[to] = line;
        moved += to < i;
    }
    return moved;
}

/* Loading lasts until the largest strain. Jitter of the displacement is sorted out. */
static sf_status split_branches(sf_compression_test *t, const table_terms *terms, sf_error *err) {
    for (int i = 0; i < t->count; i++)
        if (t->strain[i] >= t->largest_strain)
            t->loading = i + 1;
    SF_TRY(check_rise(t, terms, err));
    SF_TRY(check_fall(t, terms, err));
    t->sorted = sort_branch(t, 0, t->loading, 1) + sort_branch(t, t->loading, t->count, -1);
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

static sf_status check_sign(const sf_compression_test *t, const table_terms *terms, sf_error *err) {
    double size = 0;
    for (int i = 0; i < t->count; i++)
        size = fmax(size, fabs(t->stress[i]));
    if (!(size > 0))
        return SF_FAIL(err, SF_ERR_INPUT, "%s: the stress is zero everywhere", t->path);
    for (int i = 0; i < t->count; i++)
        if (t->stress[i] < -STRESS_ZERO * size)
            return SF_FAIL(
                err, SF_ERR_INPUT,
                "%s:%d: %s %g is negative, beyond the scatter about zero; compression must be positive (invert = \"...\" in the file that names the test changes the sign)",
                t->path, t->line[i], terms->name[1], t->stress[i] / terms->scale[1]);
    return SF_OK;
}

static sf_status check_loading(const sf_compression_test *t, const table_terms *terms, sf_error *err) {
    double highest = 0;
    int where = 0;
    for (int i = 0; i < t->loading; i++) {
        if (t->stress[i] < (1 - FALL) * highest - SLACK * t->largest_stress)
            return SF_FAIL(err, SF_ERR_INPUT,
                           "%s:%d: %s %g has fallen by more than a tenth from %g at line %d while "
                           "loading; the foam law rises",
                           t->path, t->line[i], terms->name[1], t->stress[i] / terms->scale[1],
                           highest / terms->scale[1], t->line[where]);
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

static sf_status check_unloading(const sf_compression_test *t, const table_terms *terms, sf_error *err) {
    for (int i = t->loading; i < t->count; i++) {
        double loading = loading_stress(t, t->strain[i]);
        if (t->stress[i] > (1 + ABOVE) * loading + SLACK * t->largest_stress)
            return SF_FAIL(
                err, SF_ERR_INPUT,
                "%s:%d: %s %g of unloading lies above the loading stress (%g in its unit) at the same strain %g",
                t->path, t->line[i], terms->name[1], t->stress[i] / terms->scale[1],
                loading / terms->scale[1], t->strain[i]);
    }
    return SF_OK;
}

static sf_status check_test(const sf_compression_source *source, sf_compression_test *t,
                            const table_terms *terms, sf_error *err) {
    SF_TRY(split_branches(t, terms, err));
    if (source->toe)
        SF_TRY(correct_toe(t, err));
    SF_TRY(check_size(t, err));
    SF_TRY(check_sign(t, terms, err));
    SF_TRY(check_loading(t, terms, err));
    return check_unloading(t, terms, err);
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

/* ---- the whole ---- */

static void describe(const sf_compression_source *source, bool machine, const sf_table *table,
                     sf_compression_test *t) {
    static const char *const inverted[] = {"", ", strain inverted", ", stress inverted", ", both inverted"};
    char specimen[96] = "", toe[64] = "", sorted[64] = "";
    if (t->sorted > 0)
        snprintf(sorted, sizeof sorted, ", jitter of %d points sorted", t->sorted);
    if (machine)
        snprintf(specimen, sizeof specimen, ", over %.5g mm2 and %.5g mm", 1e6 * source->area,
                 1e3 * source->thickness);
    if (source->toe)
        snprintf(toe, sizeof toe, ", toe of %.3g %% taken away", 100 * t->toe);
    snprintf(t->interpretation, sizeof t->interpretation,
             "%.383s%s, %d points of loading and %d of unloading%s%s%s, %.4g 1/s", table->interpretation,
             specimen, t->loading, t->count - t->loading, inverted[source->invert], sorted, toe, t->rate);
}

sf_status sf_compression_test_read(const sf_compression_source *source, sf_compression_test *test,
                                   sf_error *err) {
    *test = (sf_compression_test){.path = strdup(source->path), .rate = source->rate};
    const sf_table_layout layouts[2] = {sf_case_curve_layout("test", NULL), machine_layout()};
    sf_table table = {0};
    table_terms terms;
    int which;
    if (!test->path)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the path %s", source->path);
    if (sf_table_read_any(source->path, layouts, 2, &which, &table, err) == SF_OK &&
        take_terms(source, which == 1, &table, &terms, err) == SF_OK &&
        take_table(source, &terms, &table, test, err) == SF_OK &&
        check_test(source, test, &terms, err) == SF_OK) {
        describe(source, which == 1, &table, test);
        condense(test);
    }
    sf_table_free(&table);
    if (err->status != SF_OK)
        sf_compression_test_free(test);
    return err->status;
}
