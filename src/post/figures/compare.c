/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/figures/compare.h"

#include <string.h>

#include "base/text.h"

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
        return SF_REFUSE(err, "\"%s\" is not a window: write two times in ms, e.g. 10.5,25", text);
    return SF_OK;
}

sf_status sf_regions_parse(const char *text, sf_region **regions, int64_t *count, sf_error *err) {
    unsigned long most = 1;
    *count = 0;
    for (const char *c = text; *c; c++)
        most += *c == ',';
    if (most > MOST_REGIONS)
        return SF_REFUSE(err, "%lu regions" SF_AT_MOST("%d"), most, MOST_REGIONS);
    *regions = sf_alloc(err, most, sizeof **regions, "the regions");
    SF_TRY(err->status);
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
    return SF_REFUSE(
        err, "\"%s\" is not a list of regions: write ascending times in ms, e.g. 0-10,10-16,16-30", text);
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

sf_status sf_contact_instant(const sf_series *curve, const char *name, double zero, double *instant,
                             sf_error *err) {
    int64_t peak = sf_series_peak(curve);
    double a_max = curve->value[peak] - zero, low = 0, high = 0;
    if (!(a_max > 0))
        return SF_REFUSE(err,
                         "%s has no positive acceleration (largest value %g g): positive means that the "
                         "missile is slowed down",
                         name, a_max);
    double t_low = last_rise(curve, peak, zero + 0.02 * a_max, &low);
    double t_high = last_rise(curve, peak, zero + 0.10 * a_max, &high);
    if (!(t_high > t_low) || !(high > low))
        return SF_REFUSE(
            err, "%s begins at %g g, above 10 %% of its peak %g g: its contact cannot be found, give --shift",
            name, curve->value[0], a_max);
    *instant = t_low - (low - zero) * (t_high - t_low) / (high - low);
    return SF_OK;
}

static const double SLACK = 1e-5; /* s, of ends: one sample of a filtered curve */

/* A region must lie within the measured curve, and meet the model's, which must not break off in contact. */
static sf_status check_region(const sf_series *measured, const sf_series *model, bool left, double shift,
                              sf_region region, sf_error *err) {
    double begin = measured->time[0], end = measured->time[measured->count - 1];
    double model_begin = model->time[0] - shift, model_end = model->time[model->count - 1] - shift;
    if (!(region.end > region.begin) || region.begin < begin - SLACK || region.end > end + SLACK)
        return SF_REFUSE(err, "the region %g to %g ms does not lie within the measured curve (%g to %g ms)",
                         region.begin * 1e3, region.end * 1e3, begin * 1e3, end * 1e3);
    if (region.end <= model_begin || region.begin >= model_end)
        return SF_REFUSE(
            err, "the region %g to %g ms lies outside the model's curve (%g to %g ms of the measured time)",
            region.begin * 1e3, region.end * 1e3, model_begin * 1e3, model_end * 1e3);
    if (!left && region.end > model_end + SLACK)
        return SF_REFUSE(err,
                         "the region %g to %g ms goes beyond the model's curve, which ends in contact at %g "
                         "ms of the measured time: compare a shorter one (--window), or continue the run "
                         "(softfall-solve --restart --end-time)",
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

sf_status sf_compare_fit(const sf_series *measured, const sf_series *model, const sf_fit_of *of, sf_fit *fit,
                         sf_error *err) {
    sf_region region = of->region;
    double interval = of->interval;
    *fit =
        (sf_fit){.region = region, .first = NAN, .last = NAN, .interval = interval, .r2 = NAN, .rmse_g = NAN};
    SF_TRY(check_region(measured, model, of->left, of->shift, region, err));
    double sum = 0, squares = 0, residual = 0, origin = 0, slack = 1e-9;
    double intervals = floor((region.end - region.begin) / interval + slack);
    if (!(intervals < MOST_SAMPLES))
        return SF_REFUSE(err,
                         "the region %g to %g ms would be sampled %.3g times, every %g ms" SF_AT_MOST("%d"),
                         region.begin * 1e3, region.end * 1e3, intervals, interval * 1e3, MOST_SAMPLES);
    int64_t samples = (int64_t)intervals + 1;
    for (int64_t k = 0; k < samples; k++) {
        double time = region.begin + (double)k * interval;
        double a = sf_series_at(measured, time);
        double difference = a - model_at(model, time + of->shift, of->flight, &fit->flight);
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
    SF_TRY(err->status);
    for (int64_t k = -1; k < options->region_count; k++) {
        sf_region region = k < 0 ? window : options->regions[k];
        for (int j = 0; j < 2; j++) {
            sf_fit *fit = &c->fits[c->fit_count++];
            const sf_fit_of of = {region, intervals[j], c->shift, options->left, options->flight};
            SF_TRY(sf_compare_fit(&c->measured.curve, model, &of, fit, err));
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

static sf_status compare(const sf_compare_options *options, const sf_series *model, sf_comparison *c,
                         sf_error *err) {
    double measured_contact = 0, model_contact = 0, zero = NAN;
    const char *path = options->reference.path;
    const sf_series *raw = &c->measured.raw, *curve = &c->measured.curve;
    SF_TRY(sf_reference_read(&options->reference, &c->measured, err));
    SF_TRY(sf_injury_evaluate(curve, &c->injury, err));
    if (!(c->injury.a_max_g > 0))
        return SF_REFUSE(
            err, "%s has no positive acceleration: positive means that the missile is slowed down", path);
    if (!c->shift_given) {
        SF_TRY(sf_record_offset(raw, raw, &zero, err));
        SF_TRY(sf_contact_instant(curve, path, isnan(zero) ? 0 : zero, &measured_contact, err));
        SF_TRY(sf_contact_instant(model, "the computed curve", 0, &model_contact, err));
        c->shift = model_contact - measured_contact;
    }
    c->peak_error = model->value[sf_series_peak(model)] / c->injury.a_max_g - 1;
    return fit_all(options, model, c, err);
}

sf_status sf_compare_run(const sf_compare_options *options, const sf_series *model, sf_comparison *c,
                         sf_error *err) {
    *c = (sf_comparison){.cfc = options->reference.cfc,
                         .inverted = options->reference.invert,
                         .shift = options->shift,
                         .shift_given = !isnan(options->shift)};
    if (compare(options, model, c, err) != SF_OK)
        sf_comparison_free(c);
    return err->status;
}

/* "3.1 % above the measured HIC" */
static void put_error(char *text, size_t size, double error, const char *name) {
    if (isfinite(error))
        sf_text_add(text, size, "%.*f %% %s the measured %s", fabs(error) < 0.0995 ? 1 : 0, 100 * fabs(error),
                    error < 0 ? "below" : "above", name);
    else
        sf_text_add(text, size, "%s not comparable", name);
}

void sf_comparison_judge(sf_comparison *c, double model_hic, sf_grade run) {
    double r2 = c->fits[0].r2;
    c->hic_error = c->injury.hic.value > 0 ? model_hic / c->injury.hic.value - 1 : NAN;
    const char *obstacle = NULL;
    if (run == SF_GRADE_DO_NOT_USE)
        obstacle = "the figures of the run are not to be used";
    else if (c->measured.record.grade == SF_GRADE_DO_NOT_USE)
        obstacle = "the record is not to be used";
    else if (!isfinite(c->peak_error + c->hic_error + r2))
        obstacle = "not all of it is defined";
    bool agrees = !obstacle && fabs(c->peak_error) <= SF_AGREE_A_MAX && fabs(c->hic_error) <= SF_AGREE_HIC &&
                  r2 >= SF_AGREE_R2;
    c->agreement = obstacle ? "not judged" : "does not agree";
    if (agrees)
        c->agreement = "agrees";
    snprintf(c->finding, sizeof c->finding, "model ");
    put_error(c->finding, sizeof c->finding, c->peak_error, "a_max");
    sf_text_add(c->finding, sizeof c->finding, ", ");
    put_error(c->finding, sizeof c->finding, c->hic_error, "HIC");
    if (isfinite(r2))
        sf_text_add(c->finding, sizeof c->finding, ", R² %.2f", r2);
    if (obstacle)
        sf_text_add(c->finding, sizeof c->finding, ": %s, as %s", c->agreement, obstacle);
    else
        sf_text_add(c->finding, sizeof c->finding,
                    ": %s (bounds: a_max within %g %%, HIC within %g %%, R² at least %g)", c->agreement,
                    100 * SF_AGREE_A_MAX, 100 * SF_AGREE_HIC, SF_AGREE_R2);
}

void sf_comparison_free(sf_comparison *comparison) {
    sf_reference_free(&comparison->measured);
    SF_CLEAR(comparison, comparison->fits);
}
