/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loading and unloading of the law in the points of a test: one cycle, without rests, from a strain
 * of zero on. */
#include "study/fit/compression/compression_test.h"

#include <math.h>
#include <stdlib.h>

const double SF_COMPRESSION_JITTER = 5e-4;

/* Bounds of the toe correction. */
static const double TOE_RANGE = 0.15;  /* strain up to which the steepest part is looked for */
static const double TOE_WIDTH = 0.01;  /* strain of that part, with TOE_POINTS points at least */
static const double TOE_LARGEST = 0.1; /* strain that it may take away */
static const double EQUAL = 1e-6;      /* relative difference of slopes that counts as none */
enum { TOE_POINTS = 5 };

/* ---- cycles ---- */

enum { MOST_CYCLES = 10000 };

void sf_compression_move(sf_compression_test *t, int from, int to, double zero) {
    t->strain[to] = t->strain[from] - zero;
    t->stress[to] = t->stress[from];
    t->line[to] = t->line[from];
}

void sf_compression_find_largest(sf_compression_test *t) {
    t->largest_strain = t->largest_stress = 0;
    for (int i = 0; i < t->count; i++) {
        t->largest_strain = fmax(t->largest_strain, t->strain[i]);
        t->largest_stress = fmax(t->largest_stress, t->stress[i]);
    }
}

/* The first point of cycle `k` from 1, the cycle ending before the next begins; the number of cycles is k - 1
 * if it is not there. A cycle ends where the strain has fallen and rises again, by a tenth of the largest
 * each.
 */
static int begin_of_cycle(const sf_compression_test *t, int k) {
    double turn = 0.1 * t->largest_strain, highest = t->count > 0 ? t->strain[0] : 0, lowest = 0;
    int cycle = 1, at = 0;
    bool falls = false;
    for (int i = 0; i < t->count; i++) {
        if (cycle == k)
            return at;
        highest = falls ? highest : fmax(highest, t->strain[i]);
        if (!falls && t->strain[i] < highest - turn) {
            falls = true;
            lowest = t->strain[i];
            at = i;
        }
        if (falls && t->strain[i] < lowest) {
            lowest = t->strain[i];
            at = i;
        }
        if (falls && t->strain[i] > lowest + turn) {
            falls = false;
            highest = t->strain[i];
            cycle++;
        }
    }
    return cycle >= k ? at : -1;
}

sf_status sf_compression_take_cycle(const char *chosen, sf_compression_test *t, sf_error *err) {
    int cycles = 1;
    while (cycles < MOST_CYCLES && begin_of_cycle(t, cycles + 1) >= 0)
        cycles++;
    long number = chosen ? strtol(chosen, NULL, 10) : 1;
    if (number < 1 || number > cycles)
        return SF_FAIL(err, SF_ERR_INPUT, "%s: cycle %s was asked for; the strain has %d", t->path,
                       chosen ? chosen : "1", cycles);
    if (cycles == 1)
        return SF_OK;
    int first = begin_of_cycle(t, (int)number), end = t->count;
    if (number < cycles)
        end = begin_of_cycle(t, (int)number + 1);
    t->count = end - first;
    for (int i = 0; i < t->count; i++)
        sf_compression_move(t, first + i, i, 0);
    sf_compression_find_largest(t);
    t->cycle = (int)number;
    t->cycles = cycles;
    return SF_OK;
}

/* ---- rests ---- */

static const double RELAXED = 0.02; /* part of the stress that a rest loses */
enum { REST_POINTS = 3 };

/* The last point of the rest that begins at `i`; `i` if none does. */
static int end_of_rest(const sf_compression_test *t, int i) {
    int last = i;
    while (last + 1 < t->count && fabs(t->strain[last + 1] - t->strain[i]) <= SF_COMPRESSION_JITTER)
        last++;
    bool rests = last - i >= REST_POINTS && t->stress[last] < (1 - RELAXED) * t->stress[i] &&
                 t->stress[i] > RELAXED * t->largest_stress;
    return rests ? last : i;
}

/* During loading the points until the stress is back belong to the rest. */
void sf_compression_leave_rests_out(sf_compression_test *t) {
    int kept = 0, top = 0;
    for (int i = 0; i < t->count; i++)
        top = t->strain[i] > t->strain[top] ? i : top;
    double highest = t->strain[top];
    for (int i = 0; i < t->count; i++) {
        sf_compression_move(t, i, kept++, 0);
        int last = end_of_rest(t, i);
        if (last == i)
            continue;
        bool turn = t->strain[last] >= highest - SF_COMPRESSION_JITTER;
        double before = t->stress[i];
        while (!turn && last + 1 < t->count && t->strain[last + 1] >= t->strain[i] - SF_COMPRESSION_JITTER &&
               t->stress[last + 1] < before)
            last++;
        t->dwell += last - i;
        i = last;
    }
    t->count = kept;
    sf_compression_find_largest(t);
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
        sf_compression_move(t, i, to++, zero);
        loading += i < t->loading;
    }
    t->count = to;
    t->loading = loading;
    t->toe = zero;
    t->largest_strain -= zero;
}

double sf_compression_preload(const sf_compression_test *t) {
    static const double RANGE = 0.01, LEAST = 1e-3, PART = 0.05;
    int last = 0;
    double zero = 0;
    while (last + 1 < t->loading && t->strain[last] < t->strain[0] + RANGE)
        last++;
    double slope = last + 1 >= TOE_POINTS ? line_through(t, 0, last, &zero) : 0;
    bool loaded = t->strain[0] <= SF_COMPRESSION_JITTER && t->stress[0] > PART * t->stress[last];
    zero = slope > 0 ? t->strain[0] - t->stress[0] / slope : 0;
    return loaded && zero < -LEAST ? -zero : 0;
}

sf_status sf_compression_correct_toe(sf_compression_test *t, sf_error *err) {
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
    double preload = sf_compression_preload(t);
    if (preload > 0)
        shift_zero(t, 0, -preload);
    else if (zero > 0)
        shift_zero(t, first, zero);
    return SF_OK;
}
