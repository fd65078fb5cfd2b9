/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/figures/compare.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "base/units.h"
#include "io/table_csv.h"

enum { FEWEST_POINTS = 3 };
static const double SAMPLES_PER_CLASS = 10; /* least sampling rate over the class (SAE J211) */
static const double ROUNDING = 1.05;        /* of written times: 0.105 ms counts as 0.1 ms */
static const double UNEVEN = 1.5; /* largest over mean distance of samples that are told as uneven */

static const sf_table_name names[] = {
    {"time_s", 0, 1, "s"},
    {"time_ms", 0, 1e-3, "ms"},
    {"time_us", 0, 1e-6, "us"},
    {"acceleration_g", 1, 1, "g"},
    {"acceleration_m_s2", 1, 1 / SF_STANDARD_GRAVITY, "m/s2"},
    {"acceleration_km_s2", 1, 1e3 / SF_STANDARD_GRAVITY, "km/s2"},
};

static sf_status check_point(const sf_table_point *p, sf_error *err) {
    if (p->index > 0 && !(p->value[0] > p->before[0]))
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: time %g ms does not follow %g ms of the row before",
                       p->path, p->line, p->value[0] * 1e3, p->before[0] * 1e3);
    return SF_OK;
}

static sf_table_layout layout_of(const sf_reference_options *o) {
    return (sf_table_layout){
        .what = "reference",
        .column = {"time", "acceleration"},
        .wanted = {"time_s, time_ms or time_us (or \"Time (ms)\")",
                   "acceleration_g, acceleration_m_s2 or acceleration_km_s2 (or \"Acceleration (g)\")"},
        .names = names,
        .name_count = sizeof names / sizeof *names,
        .words = {"time|t|*zeit|temps|tiempo|tempo",
                  "acceleration|deceleration|accel|acc|a|*beschleunigung|accélération|aceleración|"
                  "accelerazione"},
        .kind = {SF_TIME, SF_ACCELERATION},
        .unit = {1, SF_STANDARD_GRAVITY},
        .chosen = {NULL, o->column},
        .choice = o->column_option,
        .ragged = true,
        .check = check_point,
    };
}

static double gap_before(const sf_series *s, int64_t i) {
    return s->time[i] - s->time[i - 1];
}

static double largest_gap(const sf_series *s) {
    double gap = 0;
    for (int64_t i = 1; i < s->count; i++)
        gap = fmax(gap, gap_before(s, i));
    return gap;
}

static sf_status check_sampling(const sf_reference_options *o, const sf_table *table, const sf_reference *r,
                                sf_error *err) {
    const sf_series *raw = &r->raw;
    static const double SHARE = 0.1; /* of the intervals: a gap alone is judged by post/figures/record.h */
    double most = 1 / (SAMPLES_PER_CLASS * o->cfc);
    int64_t coarse = 0;
    for (int64_t i = 1; o->cfc > 0 && i < raw->count; i++)
        coarse += gap_before(raw, i) > ROUNDING * most;
    for (int64_t i = 1; (double)coarse > SHARE * (double)raw->count && i < raw->count; i++)
        if (gap_before(raw, i) > ROUNDING * most)
            return SF_FAIL(
                err, SF_ERR_INPUT,
                "%s:%d: samples %.4g ms apart are too coarse for CFC %g, which needs %.4g ms (%g kHz) or "
                "less: choose a lower class, or %s if the curve is filtered already",
                o->path, table->line[i + r->skipped], gap_before(raw, i) * 1e3, o->cfc, most * 1e3,
                SAMPLES_PER_CLASS * o->cfc * 1e-3, o->unfiltered_option);
    return SF_OK;
}

/* The samples on their own uniform clock, if written times that are rounded are all that speaks against it.
 */
static bool take_uniform(const sf_series *raw, sf_series *uniform, sf_error *err) {
    static const double OFF = 0.05; /* of a step: a time that is rounded */
    double step = (raw->time[raw->count - 1] - raw->time[0]) / (double)(raw->count - 1);
    for (int64_t i = 0; i < raw->count; i++)
        if (fabs(raw->time[i] - raw->time[0] - (double)i * step) > OFF * step)
            return false;
    if (sf_series_create(raw->count, uniform, err) != SF_OK)
        return true;
    for (int64_t i = 0; i < raw->count; i++)
        uniform->time[i] = raw->time[0] + (double)i * step;
    memcpy(uniform->value, raw->value, (size_t)raw->count * sizeof(double));
    return true;
}

/* At the record's own rate: interpolation between samples would be a filter of its own. */
static sf_status filter(const sf_reference_options *o, sf_reference *r, sf_error *err) {
    sf_series uniform = {0};
    if (o->cfc > 0) {
        if (!take_uniform(&r->raw, &uniform, err))
            sf_signal_resample(&r->raw, sf_signal_rate(&r->raw), &uniform, err);
        if (err->status == SF_OK)
            sf_signal_filter_cfc(&uniform, o->cfc, &r->curve, err);
        sf_series_free(&uniform);
    } else if (sf_series_create(r->raw.count, &r->curve, err) == SF_OK) {
        memcpy(r->curve.time, r->raw.time, (size_t)r->raw.count * sizeof(double));
        memcpy(r->curve.value, r->raw.value, (size_t)r->raw.count * sizeof(double));
    }
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
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "%s: inverted, the channel's largest magnitude is negative (%.4g g, against %.4g g): the "
            "file has the right sign, leave %s out",
            o->path, low, high, o->invert_option);
    return SF_FAIL(
        err, SF_ERR_INPUT,
        "%s: the channel looks inverted: its largest magnitude is negative (%.4g g, against %.4g g), but "
        "a missile that is slowed down has a positive acceleration; if so, give %s",
        o->path, low, high, o->invert_option);
}

static void describe(const sf_reference_options *o, const sf_table *table, sf_reference *r) {
    const sf_series *s = &r->raw;
    double span = s->time[s->count - 1] - s->time[0], mean = span / (double)(s->count - 1);
    char spacing[64], class[32] = "not filtered";
    if (largest_gap(s) > UNEVEN * mean)
        snprintf(spacing, sizeof spacing, "unevenly, up to %.4g ms apart", largest_gap(s) * 1e3);
    else
        snprintf(spacing, sizeof spacing, "at %.4g kHz", 1e-3 / mean);
    if (o->cfc > 0)
        snprintf(class, sizeof class, "filtered with CFC %g", o->cfc);
    snprintf(r->interpretation, sizeof r->interpretation, "%.383s, %lld samples %s, %.6g to %.6g ms, %s%s",
             table->interpretation, (long long)s->count, spacing, s->time[0] * 1e3,
             s->time[s->count - 1] * 1e3, class, o->invert ? ", inverted as asked for" : "");
    size_t used = strlen(r->interpretation);
    if (r->origin != 0)
        snprintf(r->interpretation + used, sizeof r->interpretation - used, ", its clock begins at %.6f s",
                 r->origin);
    used = strlen(r->interpretation);
    if (r->impacts[0])
        snprintf(r->interpretation + used, sizeof r->interpretation - used, ", of the impacts %s",
                 r->impacts);
    used = strlen(r->interpretation);
    if (o->zero)
        snprintf(r->interpretation + used, sizeof r->interpretation - used, ", less %.4g g before contact",
                 r->offset);
}

/* Keeps the samples from `from` to `to` (s). */
static sf_status cut_out(const sf_reference_options *o, sf_reference *r, double from, double to,
                         sf_error *err) {
    sf_series *raw = &r->raw;
    int64_t first = 0, last = raw->count - 1;
    while (first < last && raw->time[first] < from)
        first++;
    while (last > first && raw->time[last] > to)
        last--;
    if (last - first + 1 < FEWEST_POINTS)
        return SF_FAIL(
            err, SF_ERR_INPUT, "%s: fewer than %d samples lie from %g to %g ms; it has %g to %g ms", o->path,
            FEWEST_POINTS, 1e3 * from, 1e3 * to, 1e3 * raw->time[0], 1e3 * raw->time[raw->count - 1]);
    raw->count = last - first + 1;
    r->skipped += first;
    memmove(raw->time, raw->time + first, (size_t)raw->count * sizeof(double));
    memmove(raw->value, raw->value + first, (size_t)raw->count * sizeof(double));
    return SF_OK;
}

/* The part or the impact that was asked for, and a list of the impacts if there are several. */
static sf_status choose_part(const sf_reference_options *o, sf_reference *r, sf_error *err) {
    sf_record_impact impact[SF_RECORD_IMPACTS];
    int count = 0;
    if (o->from < o->to)
        SF_TRY(cut_out(o, r, o->from, o->to, err));
    SF_TRY(sf_record_find_impacts(&r->raw, impact, &count, err));
    size_t used = 0;
    for (int k = 0; count > 1 && k < count && used < sizeof r->impacts; k++)
        used += (size_t)snprintf(r->impacts + used, sizeof r->impacts - used, "%s%d at %.4g ms (%.4g g)",
                                 k ? ", " : "", k + 1, 1e3 * impact[k].time, impact[k].peak);
    int chosen = o->impact;
    for (int k = 0; k < count && o->impact == 0; k++)
        chosen = chosen == 0 || impact[k].peak > impact[chosen - 1].peak ? k + 1 : chosen;
    for (int k = 0; k < count && o->impact == 0; k++)
        r->other = k + 1 == chosen ? r->other : fmax(r->other, impact[k].peak / impact[chosen - 1].peak);
    if (count < 2 && o->impact <= count)
        return SF_OK;
    if (o->impact > count)
        return SF_FAIL(err, SF_ERR_INPUT, "%s: impact %d was asked for; it has %d%s%s", o->path, o->impact,
                       count, count > 1 ? ": " : "", r->impacts);
    return cut_out(o, r, impact[chosen - 1].begin, impact[chosen - 1].end, err);
}

/* Begins the clock with the record, where it counts from long before, and takes the zero line away. */
static sf_status set_origins(const sf_reference_options *o, sf_reference *r, sf_error *err) {
    static const double LONG = 1000; /* s: with it nine digits no longer tell 10 us */
    if (fabs(r->raw.time[0]) > LONG) {
        r->origin = r->raw.time[0];
        for (int64_t i = 0; i < r->raw.count; i++)
            r->raw.time[i] -= r->origin;
    }
    SF_TRY(choose_part(o, r, err));
    if (!o->zero)
        return SF_OK;
    SF_TRY(sf_record_offset(&r->raw, &r->offset, err));
    if (isnan(r->offset))
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "%s: too few samples before contact to take the zero line from: leave --reference-zero out",
            o->path);
    for (int64_t i = 0; i < r->raw.count; i++)
        r->raw.value[i] -= r->offset;
    return SF_OK;
}

static sf_status take_table(const sf_reference_options *o, sf_table *table, sf_reference *r, sf_error *err) {
    if (table->count < FEWEST_POINTS)
        return SF_FAIL(err, SF_ERR_INPUT, "%s has %lld points, at least %d are needed", o->path,
                       (long long)table->count, FEWEST_POINTS);
    r->raw = (sf_series){.count = table->count, .time = table->value[0], .value = table->value[1]};
    table->value[0] = table->value[1] = NULL;
    for (int64_t i = 0; o->invert && i < r->raw.count; i++)
        r->raw.value[i] = 0 - r->raw.value[i];
    SF_TRY(set_origins(o, r, err));
    SF_TRY(check_sampling(o, table, r, err));
    SF_TRY(filter(o, r, err));
    SF_TRY(check_sign(o, &r->curve, err));
    describe(o, table, r);
    return SF_OK;
}

sf_status sf_reference_read(const sf_reference_options *options, sf_reference *reference, sf_error *err) {
    const sf_table_layout layout = layout_of(options);
    sf_table table;
    *reference = (sf_reference){0};
    if (sf_table_read(options->path, &layout, &table, err) != SF_OK)
        return err->status;
    take_table(options, &table, reference, err);
    sf_table_free(&table);
    if (err->status != SF_OK)
        sf_reference_free(reference);
    return err->status;
}

void sf_reference_free(sf_reference *reference) {
    sf_series_free(&reference->raw);
    sf_series_free(&reference->curve);
    *reference = (sf_reference){0};
}

enum { MOST_REGIONS = 100, MOST_SAMPLES = 1000000 /* of one region */ };

/* One number in ms at *text, moved behind it. */
static int parse_ms(const char **text, double *seconds) {
    double value = 0;
    const char *end = sf_decimal_read(*text, &value);
    if (!end || !isfinite(value))
        return 0;
    *seconds = value * 1e-3;
    *text = end;
    return 1;
}

static int parse_region(const char **text, const char *separators, sf_region *region) {
    if (!parse_ms(text, &region->begin) || **text == '\0' || !strchr(separators, **text))
        return 0;
    ++*text;
    return parse_ms(text, &region->end) && region->end > region->begin;
}

sf_status sf_region_parse(const char *text, sf_region *region, sf_error *err) {
    const char *rest = text;
    if (!parse_region(&rest, ",-", region) || *rest != '\0')
        return SF_FAIL(err, SF_ERR_INPUT, "\"%s\" is not a window: write two times in ms, e.g. 10.5,25",
                       text);
    return SF_OK;
}

sf_status sf_regions_parse(const char *text, sf_region **regions, int64_t *count, sf_error *err) {
    unsigned long most = 1;
    *count = 0;
    for (const char *c = text; *c; c++)
        most += *c == ',';
    if (most > MOST_REGIONS)
        return SF_FAIL(err, SF_ERR_INPUT, "%lu regions; at most %d are compared", most, MOST_REGIONS);
    *regions = sf_alloc(err, most, sizeof **regions, "the regions");
    if (!*regions)
        return err->status;
    const char *rest = text;
    while (parse_region(&rest, "-", &(*regions)[*count])) {
        ++*count;
        if (*rest == '\0')
            return SF_OK;
        if (*rest++ != ',')
            break;
    }
    free(*regions);
    *regions = NULL;
    *count = 0;
    return SF_FAIL(err, SF_ERR_INPUT,
                   "\"%s\" is not a list of regions: write ascending times in ms, e.g. 0-10,10-16,16-30",
                   text);
}

/* Last instant before point `peak` at which the curve rises through `level`; its first point if it is never
 * below. */
static double last_rise(const sf_series *curve, int64_t peak, double level, double *value) {
    for (int64_t i = peak; i > 0; i--) {
        double a1 = curve->value[i - 1], a2 = curve->value[i];
        if (a1 <= level) {
            *value = level;
            return curve->time[i - 1] + (curve->time[i] - curve->time[i - 1]) * (level - a1) / (a2 - a1);
        }
    }
    *value = curve->value[0];
    return curve->time[0];
}

sf_status sf_contact_instant(const sf_series *curve, const char *name, double *instant, sf_error *err) {
    int64_t peak = 0;
    for (int64_t i = 1; i < curve->count; i++)
        if (curve->value[i] > curve->value[peak])
            peak = i;
    double a_max = curve->value[peak], low = 0, high = 0;
    if (!(a_max > 0))
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s has no positive acceleration (largest value %g g): positive means that the "
                       "missile is slowed down",
                       name, a_max);
    double t_low = last_rise(curve, peak, 0.02 * a_max, &low);
    double t_high = last_rise(curve, peak, 0.10 * a_max, &high);
    if (!(t_high > t_low) || !(high > low))
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "%s begins at %g g, above 10 %% of its peak %g g: its contact cannot be found, give --shift",
            name, curve->value[0], a_max);
    *instant = t_low - low * (t_high - t_low) / (high - low);
    return SF_OK;
}

static double peak_of(const sf_series *curve) {
    double peak = curve->value[0];
    for (int64_t i = 1; i < curve->count; i++)
        peak = fmax(peak, curve->value[i]);
    return peak;
}

static const double SLACK = 1e-5; /* s, of ends: one sample of a filtered curve */

/* A region must lie within the measured curve, and meet the model's, which must not break off in contact. */
static sf_status check_region(const sf_series *measured, const sf_series *model, bool left, double shift,
                              sf_region region, sf_error *err) {
    double begin = measured->time[0], end = measured->time[measured->count - 1];
    double model_begin = model->time[0] - shift, model_end = model->time[model->count - 1] - shift;
    if (!(region.end > region.begin) || region.begin < begin - SLACK || region.end > end + SLACK)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "the region %g to %g ms does not lie within the measured curve (%g to %g ms)",
                       region.begin * 1e3, region.end * 1e3, begin * 1e3, end * 1e3);
    if (region.end <= model_begin || region.begin >= model_end)
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "the region %g to %g ms lies outside the model's curve (%g to %g ms of the measured time)",
            region.begin * 1e3, region.end * 1e3, model_begin * 1e3, model_end * 1e3);
    if (!left && region.end > model_end + SLACK)
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "the region %g to %g ms goes beyond the model's curve, which ends in contact at %g ms of the "
            "measured time: compare a shorter one (--window), or continue the run (softfall-solve "
            "--restart --end-time)",
            region.begin * 1e3, region.end * 1e3, model_end * 1e3);
    return SF_OK;
}

/* The model at `time`; `flight` in the free flight before and after its curve, of which `*beyond` counts. */
static double model_at(const sf_series *model, double time, double flight, int64_t *beyond) {
    if (time >= model->time[0] - SLACK && time <= model->time[model->count - 1] + SLACK)
        return sf_series_at(model, time);
    ++*beyond;
    return flight;
}

sf_status sf_compare_fit(const sf_series *measured, const sf_series *model, bool left, double flight,
                         double shift, sf_region region, double interval, sf_fit *fit, sf_error *err) {
    *fit =
        (sf_fit){.region = region, .first = NAN, .last = NAN, .interval = interval, .r2 = NAN, .rmse_g = NAN};
    if (check_region(measured, model, left, shift, region, err) != SF_OK)
        return err->status;
    double sum = 0, squares = 0, residual = 0, origin = 0, slack = 1e-9;
    double intervals = floor((region.end - region.begin) / interval + slack);
    if (!(intervals < MOST_SAMPLES))
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "the region %g to %g ms would be sampled %.3g times, every %g ms; at most %d are possible",
            region.begin * 1e3, region.end * 1e3, intervals, interval * 1e3, MOST_SAMPLES);
    int64_t samples = (int64_t)intervals + 1;
    for (int64_t k = 0; k < samples; k++) {
        double time = region.begin + (double)k * interval;
        double a = sf_series_at(measured, time);
        double difference = a - model_at(model, time + shift, flight, &fit->flight);
        if (fit->count++ == 0) {
            fit->first = time;
            origin = a; /* keeps the sum of squares free of cancellation */
        }
        fit->last = time;
        sum += a - origin;
        squares += (a - origin) * (a - origin);
        residual += difference * difference;
    }
    double total = squares - sum * sum / (double)fit->count;
    if (fit->count < 2)
        return SF_OK;
    fit->rmse_g = sqrt(residual / (double)fit->count);
    if (total > 1e-12 * squares)
        fit->r2 = 1 - residual / total;
    return SF_OK;
}

static sf_status fit_all(const sf_compare_options *options, const sf_series *model, sf_comparison *c,
                         sf_error *err) {
    const double intervals[2] = {0.25e-3, 0.50e-3};
    sf_region window = options->window;
    if (isnan(window.begin))
        window = (sf_region){c->injury.hic.t1, c->injury.hic.t2};
    c->fits =
        sf_alloc(err, 2 * (unsigned long)(options->region_count + 1), sizeof *c->fits, "the comparison");
    if (!c->fits)
        return err->status;
    for (int64_t k = -1; k < options->region_count; k++) {
        sf_region region = k < 0 ? window : options->regions[k];
        for (int j = 0; j < 2; j++) {
            sf_fit *fit = &c->fits[c->fit_count++];
            if (sf_compare_fit(&c->measured, model, options->left, options->flight, c->shift, region,
                               intervals[j], fit, err) != SF_OK)
                return err->status;
            fit->is_window = k < 0;
            snprintf(fit->span, sizeof fit->span, "%.3f to %.3f%s", region.begin * 1e3, region.end * 1e3,
                     k < 0 ? " window" : "");
        }
    }
    return SF_OK;
}

static sf_value kind_of_region(const void *record) {
    return sf_value_text(((const sf_fit *)record)->is_window ? "window" : "region");
}

sf_rows sf_fit_rows(void) {
    static const sf_row rows[] = {
        {.name = "measured time", .unit = "ms", SF_ROW_OF(TEXT, sf_fit, span)},
        {.key = "region", .type = SF_ROW_STRING, .value = kind_of_region},
        {.key = "t1_ms", .factor = 1e3, SF_ROW_OF(NUMBER, sf_fit, region.begin)},
        {.key = "t2_ms", .factor = 1e3, SF_ROW_OF(NUMBER, sf_fit, region.end)},
        {.key = "first_sample_ms", .factor = 1e3, SF_ROW_OF(NUMBER, sf_fit, first)},
        {.key = "last_sample_ms", .factor = 1e3, SF_ROW_OF(NUMBER, sf_fit, last)},
        {.key = "interval_ms",
         .factor = 1e3,
         .name = "interval",
         .unit = "ms",
         .format = "%.2f",
         SF_ROW_OF(NUMBER, sf_fit, interval)},
        {.key = "samples", .name = "samples", SF_ROW_OF(COUNT, sf_fit, count)},
        {.key = "samples_in_free_flight", .name = "in free flight", SF_ROW_OF(COUNT, sf_fit, flight)},
        {.key = "r2", .name = "R²", .format = "%.4f", SF_ROW_OF(NUMBER, sf_fit, r2)},
        {.key = "rmse_g", .name = "RMSE", .unit = "g", .format = "%.3f", SF_ROW_OF(NUMBER, sf_fit, rmse_g)},
    };
    return SF_ROWS(rows);
}

/* Reads the measured curve as it is compared. */
static sf_status read_measured(const sf_compare_options *options, sf_comparison *c, sf_error *err) {
    sf_reference reference;
    if (sf_reference_read(&options->reference, &reference, err) != SF_OK)
        return err->status;
    c->measured = reference.curve;
    c->raw = reference.raw;
    c->cfc = options->reference.cfc;
    c->inverted = options->reference.invert;
    c->origin = reference.origin;
    c->offset = reference.offset;
    SF_TRY(sf_record_judge(&c->raw, &c->measured, reference.other, &c->record, err));
    memcpy(c->interpretation, reference.interpretation, sizeof c->interpretation);
    return sf_injury_evaluate(&c->measured, &c->injury, err);
}

sf_status sf_compare_run(const sf_compare_options *options, const sf_series *model, sf_comparison *c,
                         sf_error *err) {
    double measured_contact = 0, model_contact = 0;
    const char *path = options->reference.path;
    *c = (sf_comparison){.shift = options->shift, .shift_given = !isnan(options->shift)};
    if (read_measured(options, c, err) != SF_OK)
        goto done;
    if (!(c->injury.a_max_g > 0)) {
        SF_FAIL(err, SF_ERR_INPUT,
                "%s has no positive acceleration: positive means that the missile is slowed down", path);
        goto done;
    }
    if (!c->shift_given) {
        if (sf_contact_instant(&c->measured, path, &measured_contact, err) != SF_OK ||
            sf_contact_instant(model, "the computed curve", &model_contact, err) != SF_OK)
            goto done;
        c->shift = model_contact - measured_contact;
    }
    c->peak_error = peak_of(model) / c->injury.a_max_g - 1;
    fit_all(options, model, c, err);
done:
    if (err->status != SF_OK)
        sf_comparison_free(c);
    return err->status;
}

void sf_comparison_free(sf_comparison *comparison) {
    sf_series_free(&comparison->measured);
    sf_series_free(&comparison->raw);
    free(comparison->fits);
    *comparison = (sf_comparison){0};
}
