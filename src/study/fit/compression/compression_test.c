/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/compression/compression_test.h"

#include "base/text.h"
#include "case/curves.h"

static const double STRAIN_ZERO = 2e-3; /* strains from minus this on are zero with scatter */
static const double STRESS_ZERO = 0.01; /* stresses likewise, as a part of the largest */
static const double SMALL_STRAIN = 0.1; /* a test must reach it */
static const double SLACK = 0.005;      /* part of the largest stress that scatter may make */
static const double FALL = 0.1;         /* part of the stress that may be lost while loading */
static const double ABOVE = 0.05;       /* part by which unloading may lie above loading */
static const double TENSION = 0.05;     /* part of the largest stress that unloading may end below zero */

void sf_compression_test_free(sf_compression_test *test) {
    SF_CLEAR(test, test->path, test->strain, test->stress, test->line);
}

/* ---- cycle, rests and toe ---- */

static const double JITTER = 5e-4; /* strain by which scatter may turn it back */

/* Bounds of the toe correction. */
static const double TOE_RANGE = 0.15;  /* strain up to which the steepest part is looked for */
static const double TOE_WIDTH = 0.01;  /* strain of that part, with TOE_POINTS points at least */
static const double TOE_LARGEST = 0.1; /* strain that it may take away */
static const double EQUAL = 1e-6;      /* relative difference of slopes that counts as none */
enum { TOE_POINTS = 5 };

enum { MOST_CYCLES = 10000 };

/* Point `from` becomes point `to`, with the strain counted from `zero`. */
static void move_point(sf_compression_test *t, int from, int to, double zero) {
    t->strain[to] = t->strain[from] - zero;
    t->stress[to] = t->stress[from];
    t->line[to] = t->line[from];
}

static void find_largest(sf_compression_test *t) {
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
        if (t->strain[i] < (falls ? lowest : highest - turn)) {
            falls = true;
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

/* Keeps one cycle of the strain: that of the number, or the first of several. */
static sf_status take_cycle(const char *chosen, sf_compression_test *t, sf_error *err) {
    int cycles = 1;
    while (cycles < MOST_CYCLES && begin_of_cycle(t, cycles + 1) >= 0)
        cycles++;
    long number = chosen ? strtol(chosen, NULL, 10) : 1;
    if (number < 1 || number > cycles)
        return SF_REFUSE(err, "%s: cycle %s was asked for; the strain has %d", t->path, chosen ? chosen : "1",
                         cycles);
    if (cycles == 1)
        return SF_OK;
    int first = begin_of_cycle(t, (int)number);
    t->count = (number < cycles ? begin_of_cycle(t, (int)number + 1) : t->count) - first;
    for (int i = 0; i < t->count; i++)
        move_point(t, first + i, i, 0);
    find_largest(t);
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
    while (last + 1 < t->count && fabs(t->strain[last + 1] - t->strain[i]) <= JITTER)
        last++;
    bool rests = last - i >= REST_POINTS && t->stress[last] < (1 - RELAXED) * t->stress[i] &&
                 t->stress[i] > RELAXED * t->largest_stress;
    return rests ? last : i;
}

/* Leaves out the rests: at least three points within the jitter of the strain while the stress falls by 2 %.
 * During loading the points until the stress is back belong to the rest. */
static void leave_rests_out(sf_compression_test *t) {
    int kept = 0;
    double highest = t->largest_strain;
    for (int i = 0; i < t->count; i++) {
        move_point(t, i, kept++, 0);
        int last = end_of_rest(t, i);
        if (last == i)
            continue;
        bool turn = t->strain[last] >= highest - JITTER;
        double before = t->stress[i];
        while (!turn && last + 1 < t->count && t->strain[last + 1] >= t->strain[i] - JITTER &&
               t->stress[last + 1] < before)
            last++;
        t->dwell += last - i;
        i = last;
    }
    t->count = kept;
    find_largest(t);
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
        move_point(t, i, to++, zero);
        loading += i < t->loading;
    }
    t->count = to;
    t->loading = loading;
    t->toe = zero;
    t->largest_strain -= zero;
}

/* The strain that a stress at zero strain stands for, by the slope of the first percent; 0: below 0.1 %. */
static double preload_of(const sf_compression_test *t) {
    static const double RANGE = 0.01, LEAST = 1e-3, PART = 0.05;
    int last = 0;
    double zero = 0;
    while (last + 1 < t->loading && t->strain[last] < t->strain[0] + RANGE)
        last++;
    double slope = last + 1 >= TOE_POINTS ? line_through(t, 0, last, &zero) : 0;
    bool loaded = t->strain[0] <= JITTER && t->stress[0] > PART * t->stress[last];
    zero = slope > 0 ? t->strain[0] - t->stress[0] / slope : 0;
    return loaded && zero < -LEAST ? -zero : 0;
}

/* The strain counts from where the toe (steepest straight part) or a preload puts its zero. */
static sf_status correct_toe(sf_compression_test *t, sf_error *err) {
    int first = 0, last = 0;
    double zero = 0;
    bool at_end = false;
    if (!steepest(t, &first, &last, &zero, &at_end) || at_end)
        return SF_REFUSE(err,
                         "%s: the toe cannot be corrected: loading has no steepest straight part below a "
                         "strain of %g %% (leave toe_correction out)",
                         t->path, 100 * TOE_RANGE);
    if (zero > TOE_LARGEST)
        return SF_REFUSE(err,
                         "%s: the toe correction would be a strain of %.3g %%, more than %g %%: cut the "
                         "approach off the file",
                         t->path, 100 * zero, 100 * TOE_LARGEST);
    double preload = preload_of(t);
    if (preload > 0)
        shift_zero(t, 0, -preload);
    else if (zero > 0)
        shift_zero(t, first, zero);
    return SF_OK;
}

/* ---- reading ---- */

/* The names and scales of the two quantities in the file, for messages in its own terms. */
typedef struct table_terms {
    const char *name[2];
    double scale[2]; /* from the file's units to strain and Pa */
} table_terms;

/* Displacement becomes strain by the thickness, force becomes stress by the area. */
static sf_status take_terms(const sf_compression_source *source, const sf_table_layout *layout,
                            const sf_table *table, table_terms *t, sf_error *err) {
    bool way = layout->column[0] == &sf_column_displacement, force = layout->column[1] == &sf_column_force;
    if ((force && !(source->area > 0)) || (way && !(source->thickness > 0)))
        return SF_REFUSE(err,
                         "%s holds %s and %s: give the specimen, for example specimen = { side "
                         "= \"50 mm\"; thickness = \"50 mm\"; } (or diameter, or area)",
                         source->path, layout->column[0]->name, layout->column[1]->name);
    *t = (table_terms){
        {layout->column[0]->name, layout->column[1]->name},
        {table->scale[0] / (way ? source->thickness : 1), table->scale[1] / (force ? source->area : 1)}};
    return SF_OK;
}

/* Checks of a single row. */
static sf_status check_row(const sf_compression_test *t, int i, const table_terms *terms, sf_error *err) {
    double strain = t->strain[i], written = strain / terms->scale[0];
    if (strain >= 1 && terms->scale[0] == 1)
        return SF_REFUSE(
            err, "%s:%d: strain %g is not below 1; if it is in percent, name the column strain_percent",
            t->path, t->line[i], written);
    if (strain >= 1)
        return SF_REFUSE(err,
                         "%s:%d: %s %g means a strain of %g %%, which is not below 100 %% (contact_force = "
                         "\"2 N\" sets the zero of a crosshead's position)",
                         t->path, t->line[i], terms->name[0], written, 100 * strain);
    if (strain < -STRAIN_ZERO)
        return SF_REFUSE(err,
                         "%s:%d: %s %g is negative; compression is positive (invert = \"...\" in the "
                         "file that names the test changes the sign)",
                         t->path, t->line[i], terms->name[0], written);
    return SF_OK;
}

/* Displacement counts from where the force first rises to the contact force and stays above it up to its
 * largest value; what the crosshead did before is left out. */
static sf_status begin_at_contact(const sf_compression_source *source, sf_compression_test *t,
                                  sf_error *err) {
    double contact = source->contact_force / source->area;
    int top = 0, first = 0;
    for (int i = 0; i < t->count; i++)
        top = t->stress[i] > t->stress[top] ? i : top;
    for (first = top; first > 0 && t->stress[first - 1] >= contact;)
        first--;
    if (!(source->area > 0) || first == 0 || t->stress[top] < contact)
        return SF_REFUSE(err,
                         "%s: the force does not rise to %g N (contact_force) from below in this file: the "
                         "displacement has no zero there",
                         t->path, source->contact_force);
    double part = (contact - t->stress[first - 1]) / (t->stress[first] - t->stress[first - 1]);
    double zero = t->strain[first - 1] + part * (t->strain[first] - t->strain[first - 1]);
    int kept = 0;
    for (int i = first; i < t->count; i++) {
        if (i > top && t->strain[i] < zero) /* the crosshead leaves the specimen */
            continue;
        move_point(t, i, kept++, zero);
    }
    t->count = kept;
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
    }
    if (source->contact_force > 0)
        SF_TRY(begin_at_contact(source, t, err));
    find_largest(t);
    return SF_OK;
}

/* ---- checks of the whole ---- */

/* The strain turns twice: at point `again`, after it began to fall at `first`. */
static sf_status refuse_turn(const sf_compression_test *t, const table_terms *terms, int again, int first,
                             sf_error *err) {
    return SF_REFUSE(err,
                     "%s:%d: %s %g rises again after it began to fall at line %d; a file holds one loading "
                     "and then one unloading",
                     t->path, t->line[again], terms->name[0], t->strain[again] / terms->scale[0],
                     t->line[first]);
}

/* Refuses a fall of more than JITTER below what was reached before the largest strain, and
 * such a rise after it. */
static sf_status check_turns(const sf_compression_test *t, const table_terms *terms, sf_error *err) {
    double highest = t->count > 0 ? t->strain[0] : 0, lowest = INFINITY;
    for (int i = 1; i < t->loading; i++) {
        highest = fmax(highest, t->strain[i]);
        if (t->strain[i] >= highest - JITTER)
            continue;
        int again = i + 1; /* there is one, as the largest strain follows */
        while (again < t->loading - 1 && t->strain[again] <= t->strain[again - 1])
            again++;
        return refuse_turn(t, terms, again, i, err);
    }
    for (int i = t->loading; i < t->count; i++) {
        lowest = fmin(lowest, t->strain[i]);
        if (t->strain[i] > lowest + JITTER)
            return refuse_turn(t, terms, i, t->loading, err);
    }
    return SF_OK;
}

/* Puts the points of a branch in the order of `sign` times their strain; how many moved. */
static int sort_branch(sf_compression_test *t, int first, int end, double sign) {
    int moved = 0;
    for (int i = first + 1; i < end; i++) {
        double strain = t->strain[i], stress = t->stress[i];
        int line = t->line[i], to = i;
        for (; to > first && sign * t->strain[to - 1] > sign * strain; to--)
            move_point(t, to - 1, to, 0);
        t->strain[to] = strain;
        t->stress[to] = stress;
        t->line[to] = line;
        moved += to < i;
    }
    return moved;
}

/* Loading lasts until the largest strain, and the largest stress where that stands twice. Jitter of the
 * displacement is sorted out. */
static sf_status split_branches(sf_compression_test *t, const table_terms *terms, sf_error *err) {
    for (int i = 0; i < t->count; i++)
        if (t->strain[i] >= t->largest_strain && (!t->loading || t->stress[i] > t->stress[t->loading - 1]))
            t->loading = i + 1;
    SF_TRY(check_turns(t, terms, err));
    t->sorted = sort_branch(t, 0, t->loading, 1) + sort_branch(t, t->loading, t->count, -1);
    return SF_OK;
}

static sf_status check_size(const sf_compression_test *t, sf_error *err) {
    int unloading = t->count - t->loading;
    if (t->loading < SF_COMPRESSION_LOADING_POINTS)
        return SF_REFUSE(err, "%s: %d points of loading" SF_AT_LEAST("%d"), t->path, t->loading,
                         SF_COMPRESSION_LOADING_POINTS);
    if (unloading > 0 && unloading < SF_COMPRESSION_UNLOADING_POINTS)
        return SF_REFUSE(err,
                         "%s:%d: strain falls from this line on, but unloading has %d points; it needs at "
                         "least %d, or none",
                         t->path, t->line[t->loading], unloading, SF_COMPRESSION_UNLOADING_POINTS);
    if (t->largest_strain < SMALL_STRAIN)
        return SF_REFUSE(err,
                         "%s: the largest strain is %g %%; a test must reach %g %% (is the column in percent "
                         "and named strain, or the other way round?)",
                         t->path, 100 * t->largest_strain, 100 * SMALL_STRAIN);
    return SF_OK;
}

static sf_status check_sign(sf_compression_test *t, const table_terms *terms, sf_error *err) {
    double size = 0;
    for (int i = 0; i < t->count; i++)
        size = fmax(size, fabs(t->stress[i]));
    if (!(size > 0))
        return SF_REFUSE(err, "%s: the stress is zero everywhere", t->path);
    for (int i = t->count - 1; i >= t->loading && t->stress[i] < 0 && t->stress[i] > -TENSION * size; i--) {
        t->tension += t->stress[i] < -STRESS_ZERO * size;
        t->stress[i] = fmax(t->stress[i], -STRESS_ZERO * size);
    }
    for (int i = 0; i < t->count; i++)
        if (t->stress[i] < -STRESS_ZERO * size)
            return SF_REFUSE(err,
                             "%s:%d: %s %g is negative, beyond the scatter about zero; compression is "
                             "positive (invert = \"...\" in the file that names the test changes the sign)",
                             t->path, t->line[i], terms->name[1], t->stress[i] / terms->scale[1]);
    return SF_OK;
}

static sf_status check_loading(const sf_compression_test *t, const table_terms *terms, sf_error *err) {
    double highest = 0;
    int where = 0;
    for (int i = 0; i < t->loading; i++) {
        if (t->stress[i] < (1 - FALL) * highest - SLACK * t->largest_stress)
            return SF_REFUSE(err,
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

double sf_compression_at(int count, const double *x, const double *y, double place) {
    double sign = x[count - 1] < x[0] ? -1 : 1;
    int high = count - 1, low = 0;
    while (high - low > 1) {
        int middle = (low + high) / 2;
        *(sign * x[middle] < sign * place ? &low : &high) = middle;
    }
    double width = x[high] - x[low], part = width != 0 ? (place - x[low]) / width : 0;
    return y[low] + fmin(1, fmax(0, part)) * (y[high] - y[low]);
}

double sf_compression_loading_stress(const sf_compression_test *t, double strain) {
    return sf_compression_at(t->loading, t->strain, t->stress, strain);
}

static sf_status check_unloading(const sf_compression_test *t, const table_terms *terms, sf_error *err) {
    for (int i = t->loading; i < t->count; i++) {
        double loading = sf_compression_loading_stress(t, t->strain[i]);
        if (t->stress[i] > (1 + ABOVE) * loading + SLACK * t->largest_stress)
            return SF_REFUSE(err,
                             "%s:%d: %s %g of unloading lies above the loading stress (%g in its unit) at "
                             "the same strain %g",
                             t->path, t->line[i], terms->name[1], t->stress[i] / terms->scale[1],
                             loading / terms->scale[1], t->strain[i]);
    }
    return SF_OK;
}

static sf_status check_test(const sf_compression_source *source, sf_compression_test *t,
                            const table_terms *terms, sf_error *err) {
    double lowest = 0;
    for (int i = 0; i < t->count; i++)
        lowest = fmin(lowest, t->strain[i]);
    for (int i = 0; i < t->count && -lowest > t->largest_strain; i++) /* tension, not a later cycle */
        SF_TRY(check_row(t, i, terms, err));
    SF_TRY(take_cycle(source->cycle, t, err));
    for (int i = 0; i < t->count; i++)
        SF_TRY(check_row(t, i, terms, err));
    leave_rests_out(t);
    SF_TRY(split_branches(t, terms, err));
    if (source->toe)
        SF_TRY(correct_toe(t, err));
    else
        t->preload = preload_of(t);
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

#define ADD(...) sf_text_add(t->interpretation, sizeof t->interpretation, __VA_ARGS__)
static void describe(const sf_compression_source *source, const table_terms *terms, const sf_table *table,
                     sf_compression_test *t) {
    static const char *const inverted[] = {"", ", strain inverted", ", stress inverted", ", both inverted"};
    ADD("%s", table->interpretation);
    if (strcmp(terms->name[1], "force") == 0)
        ADD(", over %.5g mm2", 1e6 * source->area);
    if (strcmp(terms->name[0], "displacement") == 0)
        ADD("%s %.5g mm", strcmp(terms->name[1], "force") == 0 ? " and" : ", over", 1e3 * source->thickness);
    ADD(", %d points of loading and %d of unloading%s", t->loading, t->count - t->loading,
        inverted[source->invert]);
    if (t->cycles > 1)
        ADD(", cycle %d of %d", t->cycle, t->cycles);
    if (source->contact_force > 0)
        ADD(", zero at a force of %.4g N", source->contact_force);
    if (t->dwell > 0)
        ADD(", without %d points of a rest under strain, during which the stress relaxed", t->dwell);
    if (t->tension > 0)
        ADD(", %d points in tension at the end set to zero", t->tension);
    if (t->preload > 0)
        ADD(", begins under a load that stands for a strain of %.3g %% (preload or zero of the load cell: "
            "toe_correction takes it away)",
            100 * t->preload);
    if (t->sorted > 0)
        ADD(", jitter of %d points sorted", t->sorted);
    if (source->toe)
        ADD(t->toe < 0 ? ", %.3g %% added that a preload had hidden" : ", toe of %.3g %% taken away",
            100 * fabs(t->toe));
    ADD(", %.4g 1/s", t->rate);
}
#undef ADD

sf_status sf_compression_test_read(const sf_compression_source *source, sf_compression_test *test,
                                   sf_error *err) {
    *test = (sf_compression_test){.path = strdup(source->path), .rate = source->rate};
    const sf_table_layout layouts[] = {sf_case_curve_layout("test", NULL),
                                       {.what = "test",
                                        .kind = "compression",
                                        .column = {&sf_column_displacement, &sf_column_force},
                                        .means = "force over displacement in compression"},
                                       {.what = "test",
                                        .kind = "compression",
                                        .column = {&sf_column_strain, &sf_column_force},
                                        .means = "force over nominal strain in compression"},
                                       {.what = "test",
                                        .kind = "compression",
                                        .column = {&sf_column_displacement, &sf_column_stress},
                                        .means = "nominal stress over displacement in compression"}};
    SF_OWNED_BY(sf_table_free) sf_table table = {0};
    table_terms terms = {0};
    int which;
    if (!test->path)
        return SF_NO_MEMORY(err, "the path %s", source->path);
    if (sf_table_read_any(source->path, layouts, sizeof layouts / sizeof *layouts, &which, &table, err) ==
            SF_OK &&
        take_terms(source, &layouts[which], &table, &terms, err) == SF_OK &&
        take_table(source, &terms, &table, test, err) == SF_OK &&
        check_test(source, test, &terms, err) == SF_OK) {
        describe(source, &terms, &table, test);
        condense(test);
    }
    if (err->status != SF_OK)
        sf_compression_test_free(test);
    return err->status;
}
