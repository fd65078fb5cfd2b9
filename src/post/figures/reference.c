/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/figures/reference.h"

#include <string.h>

#include "base/text.h"
#include "io/table_csv.h"

enum { FEWEST_POINTS = 3 };
static const double SAMPLES_PER_CLASS = 10; /* least sampling rate over the class (SAE J211) */
static const double ROUNDING = 1.05;        /* of written times: 0.105 ms counts as 0.1 ms */
static const double MS_UNDER_S = 100;       /* times too coarse: their unit is another one */
static const double UNEVEN = 1.5; /* largest over mean distance of samples that are told as uneven */

/* The columns of the file while it becomes a reference. */
typedef struct record {
    const sf_reference_options *options;
    int axes;                          /* 1: the acceleration itself */
    sf_series axis[SF_REFERENCE_AXES]; /* s and g; owned */
    double other; /* highest of the other impacts, over the peak, if none was asked for; else 0 */
    char interpretation[SF_TABLE_INTERPRETATION];
} record;

static void record_free(record *r) {
    for (int k = 0; k < SF_REFERENCE_AXES; k++)
        sf_series_free(&r->axis[k]);
}

/* ---- options ---- */

sf_status sf_reference_parse_range(const char *text, double *range, sf_error *err) {
    const char *unit = sf_decimal_read(text, range);
    if (!unit || strcmp(unit + strspn(unit, " "), "g") != 0) {
        SF_TRY(sf_units_read(text, SF_ACCELERATION, range, err));
        *range /= SF_STANDARD_GRAVITY;
    }
    return *range > 0 && isfinite(*range)
               ? SF_OK
               : SF_REFUSE(err, "\"%s\" is no range of a channel: write for example \"200 g\"", text);
}

sf_status sf_reference_parse_impact(const char *option, const char *text, int *impact, sf_error *err) {
    double value = 0;
    if (!sf_decimal_is(text, &value) || value != floor(value) || value < 1 || value > SF_RECORD_IMPACTS)
        return SF_REFUSE(err, "%s %s: expected the number of an impact, from 1 to %d", option, text,
                         SF_RECORD_IMPACTS);
    *impact = (int)value;
    return SF_OK;
}

/* ---- the file ---- */

static sf_status check_point(const sf_table_point *p, sf_error *err) {
    if (p->index > 0 && !(p->value[0] > p->before[0]))
        return SF_REFUSE(err,
                         "%s:%d: time %g ms does not follow %g ms of the row before (%s makes rounded "
                         "times even)",
                         p->path, p->line, p->value[0] * 1e3, p->before[0] * 1e3, p->remedy);
    return SF_OK;
}

static sf_status read_axis(record *r, const char *column, sf_error *err) {
    const sf_table_layout layout = {.what = "reference",
                                    .kind = "acceleration",
                                    .column = {&sf_column_time, &sf_column_acceleration},
                                    .chosen = column,
                                    .choice = r->options->column_option,
                                    .ragged = true,
                                    .check = check_point};
    SF_OWNED_BY(sf_table_free) sf_table table = {0};
    SF_TRY(sf_table_read(r->options->path, &layout, &table, err));
    if (r->axes == 0)
        memcpy(r->interpretation, table.interpretation, sizeof r->interpretation);
    r->axis[r->axes++] = (sf_series){.count = table.count, .time = table.value[0], .value = table.value[1]};
    table.value[0] = table.value[1] = NULL;
    return SF_OK;
}

/* Copies samples that were read already, which must be finite and ascend in time. */
static sf_status take_samples(record *r, const sf_reference_samples *s, sf_error *err) {
    for (int k = 0; k < s->axes; k++) {
        SF_TRY(sf_series_create(s->count, &r->axis[k], err));
        r->axes++;
        memcpy(r->axis[k].time, s->time, (size_t)s->count * sizeof(double));
        memcpy(r->axis[k].value, s->value[k], (size_t)s->count * sizeof(double));
        SF_TRY(sf_series_check(&r->axis[k], r->options->path, err));
    }
    snprintf(r->interpretation, sizeof r->interpretation, "%s", s->reading);
    return SF_OK;
}

static sf_status read_axes(record *r, sf_error *err) {
    const sf_reference_options *o = r->options;
    char list[256], *rest = list, *name;
    if (o->samples)
        return take_samples(r, o->samples, err);
    if (!o->columns)
        return read_axis(r, o->column, err);
    if (snprintf(list, sizeof list, "%s", o->columns) >= (int)sizeof list)
        return SF_REFUSE(err, "the list of columns \"%.40s...\" is too long", o->columns);
    while ((name = strsep(&rest, ","))) {
        if (r->axes == SF_REFERENCE_AXES || !name[strspn(name, " ")] || (r->axes == 0 && !rest))
            return SF_REFUSE(err,
                             "\"%s\" is not a list of two or three columns: write their headings, \"x,y,z\"",
                             o->columns);
        SF_TRY(read_axis(r, name + strspn(name, " "), err));
    }
    return SF_OK;
}

/* The acceleration itself, or the length of its axes. */
static sf_status make_resultant(const sf_series *axis, int axes, sf_series *out, sf_error *err) {
    SF_TRY(sf_series_create(axis->count, out, err));
    memcpy(out->time, axis->time, (size_t)axis->count * sizeof(double));
    for (int64_t i = 0; i < axis->count; i++) {
        double square = 0;
        for (int k = 0; k < axes; k++)
            square += axis[k].value[i] * axis[k].value[i];
        out->value[i] = axes == 1 ? axis->value[i] : sqrt(square);
    }
    return SF_OK;
}

/* ---- the part that is used ---- */

static void cut_series(sf_series *s, int64_t first, int64_t count) {
    s->count = count;
    memmove(s->time, s->time + first, (size_t)count * sizeof(double));
    memmove(s->value, s->value + first, (size_t)count * sizeof(double));
}

/* Keeps the samples from `from` to `to` (s). */
static sf_status cut_out(record *r, sf_reference *reference, double from, double to, sf_error *err) {
    const sf_series *raw = &reference->raw;
    int64_t first = 0, last = raw->count - 1;
    while (first < last && raw->time[first] < from)
        first++;
    while (last > first && raw->time[last] > to)
        last--;
    int64_t count = last - first + 1;
    if (count < FEWEST_POINTS)
        return SF_REFUSE(err, "%s: fewer than %d samples lie from %g to %g ms; it has %g to %g ms",
                         r->options->path, FEWEST_POINTS, 1e3 * from, 1e3 * to, 1e3 * raw->time[0],
                         1e3 * raw->time[raw->count - 1]);
    for (int k = 0; k < r->axes; k++)
        cut_series(&r->axis[k], first, count);
    cut_series(&reference->raw, first, count);
    return SF_OK;
}

/* The part or the impact that was asked for, and a list of the impacts if there are several. */
static sf_status choose_part(record *r, sf_reference *reference, sf_error *err) {
    const sf_reference_options *o = r->options;
    sf_record_impact impact[SF_RECORD_IMPACTS];
    char *list = reference->impacts;
    int count = 0;
    if (o->from < o->to)
        SF_TRY(cut_out(r, reference, o->from, o->to, err));
    SF_TRY(sf_record_find_impacts(&reference->raw, impact, &count, err));
    for (int k = 0; count > 1 && k < count; k++)
        sf_text_add(list, sizeof reference->impacts, "%s%d at %.4g ms (%.4g g)", k ? ", " : "", k + 1,
                    1e3 * impact[k].time, impact[k].peak);
    int chosen = o->impact;
    for (int k = 0; k < count && o->impact == 0; k++)
        chosen = chosen == 0 || impact[k].peak > impact[chosen - 1].peak ? k + 1 : chosen;
    for (int k = 0; k < count && o->impact == 0; k++)
        if (k + 1 != chosen)
            r->other = fmax(r->other, impact[k].peak / impact[chosen - 1].peak);
    if (count < 2 && o->impact <= count)
        return SF_OK;
    if (o->impact > count)
        return SF_REFUSE(err, "%s: impact %d was asked for; it has %d%s%s", o->path, o->impact, count,
                         count > 1 ? ": " : "", list);
    return cut_out(r, reference, impact[chosen - 1].begin, impact[chosen - 1].end, err);
}

/* Begins the clock with the record, where it counts from long before. */
static void set_clock(record *r, sf_reference *reference) {
    static const double LONG = 1000; /* s: with it nine digits no longer tell 10 us */
    double first = reference->raw.time[0];
    if (fabs(first) < LONG)
        return;
    reference->origin = first;
    for (int64_t i = 0; i < reference->raw.count; i++) {
        reference->raw.time[i] -= first;
        for (int k = 0; k < r->axes; k++)
            r->axis[k].time[i] -= first;
    }
}

/* Takes the zero line of each axis away, and forms the resultant anew. */
static sf_status take_zero_away(record *r, sf_reference *reference, sf_error *err) {
    SF_OWNED_BY(sf_series_free) sf_series pulse = reference->raw;
    reference->raw = (sf_series){0};
    for (int k = 0; k < r->axes; k++) {
        double offset = 0;
        SF_TRY(sf_record_offset(&pulse, &r->axis[k], &offset, err));
        if (isnan(offset))
            return SF_REFUSE(err,
                             "%s: too few samples before contact to take the zero line from: leave %s out",
                             r->options->path, r->options->zero_option);
        for (int64_t i = 0; i < pulse.count; i++)
            r->axis[k].value[i] -= offset;
        reference->offset = r->axes == 1 ? offset : hypot(reference->offset, offset);
    }
    return make_resultant(r->axis, r->axes, &reference->raw, err);
}

/* ---- filter ---- */

static double gap_before(const sf_series *s, int64_t i) {
    return s->time[i] - s->time[i - 1];
}

static double largest_gap(const sf_series *s) {
    double gap = 0;
    for (int64_t i = 1; i < s->count; i++)
        gap = fmax(gap, gap_before(s, i));
    return gap;
}

/* The first sample that is too far from the one before it for the class, if a tenth of all are; 0: none. */
static int64_t first_coarse(const sf_series *raw, double cfc) {
    static const double SHARE = 0.1; /* of the intervals: a gap alone is judged by post/figures/record.h */
    int64_t coarse = 0, first = 0;
    for (int64_t i = raw->count - 1; cfc > 0 && i > 0; i--)
        if (gap_before(raw, i) > ROUNDING / (SAMPLES_PER_CLASS * cfc)) {
            coarse++;
            first = i;
        }
    return (double)coarse > SHARE * (double)raw->count ? first : 0;
}

static sf_status check_sampling(const record *r, const sf_series *raw, sf_error *err) {
    static const char *const classes[] = {"1000", "600", "180", "60", "none"};
    const sf_reference_options *o = r->options;
    int64_t first = first_coarse(raw, o->cfc);
    double most = 1 / (SAMPLES_PER_CLASS * o->cfc);
    int k = 0;
    if (first == 0)
        return SF_OK;
    while (first_coarse(raw, atof(classes[k])) > 0)
        k++;
    const char *quote = strchr(o->filter_option, '"') ? "\"" : "";
    char lower[64] = "";
    if (atof(classes[k]) > 0)
        snprintf(lower, sizeof lower, "%.31s%s%s, or ", o->filter_option, classes[k], quote);
    return SF_REFUSE(
        err,
        "%s: sample %lld: samples %.4g ms apart are too coarse for CFC %g, which needs %.4g ms "
        "(%g kHz) or less: give %s%snone%s if the curve is filtered already%s",
        o->path, (long long)first + 1, gap_before(raw, first) * 1e3, o->cfc, most * 1e3,
        SAMPLES_PER_CLASS * o->cfc * 1e-3, lower, o->filter_option, quote,
        gap_before(raw, first) > MS_UNDER_S * most ? "; the times look like ms under a heading of s" : "");
}

static sf_status filter(double cfc, const sf_series *raw, sf_series *curve, sf_error *err) {
    return cfc > 0 ? sf_signal_filter(raw, cfc, curve, err)
                   : make_resultant(raw, 1, curve, err); /* as it is */
}

static sf_status filter_axes(const record *r, sf_reference *reference, sf_error *err) {
    sf_series curve[SF_REFERENCE_AXES] = {0};
    for (int k = 0; k < r->axes && err->status == SF_OK; k++)
        filter(r->options->cfc, &r->axis[k], &curve[k], err);
    if (err->status == SF_OK)
        make_resultant(curve, r->axes, &reference->curve, err);
    for (int k = 0; k < r->axes; k++)
        sf_series_free(&curve[k]);
    return err->status;
}

/* A braked missile's largest magnitude is positive. */
static sf_status check_sign(const sf_reference_options *o, const sf_series *curve, sf_error *err) {
    double high = 0, low = 0;
    for (int64_t i = 0; i < curve->count; i++) {
        high = fmax(high, curve->value[i]);
        low = fmin(low, curve->value[i]);
    }
    if (high >= -low)
        return SF_OK;
    if (o->invert)
        return SF_REFUSE(err,
                         "%s: inverted, the channel's largest magnitude is negative (%.4g g, against %.4g "
                         "g): the file has the right sign, leave %s out",
                         o->path, low, high, o->invert_option);
    return SF_REFUSE(err,
                     "%s: the channel looks inverted: its largest magnitude is negative (%.4g g, against "
                     "%.4g g), but a missile that is slowed down has a positive acceleration; if so, give %s",
                     o->path, low, high, o->invert_option);
}

/* ---- the whole ---- */

#define ADD(r, ...) sf_text_add((r)->interpretation, sizeof(r)->interpretation, __VA_ARGS__)

static void describe(const record *r, sf_reference *reference) {
    const sf_reference_options *o = r->options;
    const sf_series *s = &reference->raw;
    double span = s->time[s->count - 1] - s->time[0], mean = span / (double)(s->count - 1);
    ADD(reference, "%s, %lld samples ", r->interpretation, (long long)s->count);
    if (largest_gap(s) > UNEVEN * mean)
        ADD(reference, "unevenly, up to %.4g ms apart", largest_gap(s) * 1e3);
    else
        ADD(reference, "at %.4g kHz", 1e-3 / mean);
    ADD(reference, ", %.6g to %.6g ms, ", s->time[0] * 1e3, s->time[s->count - 1] * 1e3);
    if (o->cfc > 0)
        ADD(reference, "filtered with CFC %g", o->cfc);
    else
        ADD(reference, "not filtered");
    if (r->axes > 1)
        ADD(reference, ", resultant of the %s%.100s", o->columns ? "columns " : "axes",
            o->columns ? o->columns : "");
    if (o->invert)
        ADD(reference, ", inverted as asked for");
    if (reference->origin != 0)
        ADD(reference, ", its clock begins at %.6f s", reference->origin);
    if (reference->impacts[0])
        ADD(reference, ", of the impacts %s", reference->impacts);
    if (o->zero)
        ADD(reference, ", less %.4g g before contact", reference->offset);
}

static sf_status make(record *r, sf_reference *reference, sf_error *err) {
    const sf_reference_options *o = r->options;
    if (o->columns && (o->column || o->invert))
        return SF_REFUSE(err,
                         "%s: columns of axes have a resultant, which has no sign and is the "
                         "only acceleration: leave %s out",
                         o->path, o->column ? o->column_option : o->invert_option);
    SF_TRY(read_axes(r, err));
    if (r->axis[0].count < FEWEST_POINTS)
        return SF_REFUSE(err, "%s has %lld points" SF_AT_LEAST("%d"), o->path, (long long)r->axis[0].count,
                         FEWEST_POINTS);
    for (int64_t i = 0; o->invert && i < r->axis[0].count; i++)
        r->axis[0].value[i] = 0 - r->axis[0].value[i];
    SF_TRY(make_resultant(r->axis, r->axes, &reference->raw, err));
    set_clock(r, reference);
    SF_TRY(choose_part(r, reference, err));
    if (o->zero)
        SF_TRY(take_zero_away(r, reference, err));
    SF_TRY(check_sampling(r, &reference->raw, err));
    SF_TRY(filter_axes(r, reference, err));
    SF_TRY(check_sign(o, &reference->curve, err));
    describe(r, reference);
    const sf_record_facts facts = {r->other, o->speed, o->range};
    return sf_record_judge(&reference->raw, &reference->curve, &facts, &reference->record, err);
}

sf_status sf_reference_read(const sf_reference_options *options, sf_reference *reference, sf_error *err) {
    SF_OWNED_BY(record_free) record r = {.options = options};
    *reference = (sf_reference){0};
    if (make(&r, reference, err) != SF_OK)
        sf_reference_free(reference);
    return err->status;
}

void sf_reference_free(sf_reference *reference) {
    sf_series_free(&reference->raw);
    sf_series_free(&reference->curve);
    *reference = (sf_reference){0};
}
