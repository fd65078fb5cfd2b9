/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/drop/drop_fit.h"

#include <sys/stat.h>

#include "io/plain_file.h"
#include "post/figures/compare.h"

static const double SAMPLE_INTERVAL = 0.5e-3; /* s, of a measured curve */
static const double SAMPLE_LEVEL = 0.05;      /* of its peak: samples below are left out */

/* ---- measured curves ---- */

/* Samples from contact on, where the curve is above the level. */
static sf_status sample_curve(const sf_reference_options *options, sf_fit_drop *drop, sf_error *err) {
    SF_OWNED_BY(sf_reference_free) sf_reference reference = {0};
    char line[SF_VERDICT_LINE_SIZE];
    double contact = 0, peak = 0, zero = NAN;
    SF_TRY(sf_reference_read(options, &reference, err));
    const sf_series *curve = &reference.curve;
    sf_record_line(&reference.record, line, sizeof line);
    snprintf(drop->interpretation, sizeof drop->interpretation, "%.600s; record: %.400s",
             reference.interpretation, line);
    if (reference.record.grade == SF_GRADE_DO_NOT_USE)
        return SF_REFUSE(err, "%s: a foam cannot be fitted to this record: %s", options->path, line);
    SF_TRY(sf_record_offset(&reference.raw, &reference.raw, &zero, err));
    SF_TRY(sf_contact_instant(curve, options->path, isnan(zero) ? 0 : zero, &contact, err));
    SF_TRY(SF_ALLOC_ALL(err, "samples", SF_ROOM(drop->sample_time, SF_FIT_CURVE_SAMPLES),
                        SF_ROOM(drop->sample_value, SF_FIT_CURVE_SAMPLES)));
    for (int64_t k = 0; k < curve->count; k++)
        peak = fmax(peak, curve->value[k]);
    for (int k = 1; contact + k * SAMPLE_INTERVAL <= curve->time[curve->count - 1]; k++) {
        double value = sf_series_at(curve, contact + k * SAMPLE_INTERVAL);
        if (value < SAMPLE_LEVEL * peak || drop->samples == SF_FIT_CURVE_SAMPLES)
            continue;
        drop->sample_time[drop->samples] = k * SAMPLE_INTERVAL;
        drop->sample_value[drop->samples++] = value;
    }
    drop->sample_scale = peak;
    return SF_OK;
}

/* The measured curve of a drop, filtered like the simulated one unless the file says otherwise. */
static sf_status read_curve(const sf_config *config, sf_config_item *group, sf_fit_drop *drop,
                            sf_error *err) {
    static const double classes[] = {0, 60, 180, 600, 1000};
    sf_reference_options o = {.column_option = "curve_column = \"...\"",
                              .filter_option = "curve_filter = \"",
                              .invert_option = "curve_invert = true",
                              .zero_option = "curve_zero = true"};
    sf_error inner = SF_ERROR_INIT;
    int class = 4;
    SF_TRY(sf_config_choice(config, group, "curve_filter", "none|60|180|600|1000", &class, err));
    SF_TRY(sf_config_text(config, group, "curve_column", false, &o.column, err));
    SF_TRY(sf_config_flag(config, group, "curve_invert", &o.invert, err));
    SF_TRY(sf_config_flag(config, group, "curve_zero", &o.zero, err));
    SF_TRY(sf_config_text(config, group, "curve_columns", false, &o.columns, err));
    SF_TRY(sf_config_file(config, group, "curve", false, &drop->curve_path, err));
    if (!drop->curve_path)
        return SF_OK;
    o.path = drop->curve_path;
    drop->sample_class = o.cfc = classes[class];
    if (sample_curve(&o, drop, &inner) != SF_OK)
        return SF_FAIL(err, inner.status, "%s (named at %s:%u)", inner.text, config->path,
                       config_setting_source_line(group));
    return SF_OK;
}

/* ---- drops ---- */

static sf_status name_drop(const sf_config *config, sf_config_item *group, int count, sf_fit_drop *drop,
                           sf_error *err) {
    sf_fit_drop *const last = &drop[count];
    SF_TRY(sf_fit_name_read(config, group, "drop-", count + 1, last->name, err));
    if (strspn(last->name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._-") !=
        strlen(last->name))
        return sf_config_refuse(config, group, err,
                                "the name \"%s\" begins file names: use letters, digits, dots, dashes",
                                last->name);
    for (int k = 0; k < count; k++)
        if (strcmp(drop[k].name, last->name) == 0)
            return sf_config_refuse(config, group, err, "two drops are called \"%s\"", last->name);
    return SF_OK;
}

static const double VALUE_LOW = 1e-3, VALUE_HIGH = 1e7, SD_LOW = 1e-4;

/* A value and its standard deviation. */
static sf_status read_kind(const sf_config *config, sf_config_item *group, int kind, sf_fit_drop *drop,
                           sf_error *err) {
    const sf_drop_kind_info *about = sf_drop_kind_get(kind);
    double *value = &drop->value[kind], *sd = &drop->sd[kind];
    *value = NAN;
    *sd = about->sd;
    SF_TRY(sf_config_number(config, group, about->key, false, VALUE_LOW, VALUE_HIGH, value, err));
    SF_TRY(sf_config_number(config, group, about->sd_key, false, SD_LOW, 1, sd, err));
    sf_config_item *stated = config_setting_get_member(group, about->sd_key);
    if (stated && isnan(*value))
        return sf_config_refuse(config, stated, err, "%s is given, but no %s", about->sd_key, about->key);
    return SF_OK;
}

/* A window printed in steps of r: both its ends are uniform over a step, so that its length has the variance
 * 2 r^2 / 12; beside a stated scatter, or alone. */
static sf_status read_resolution(const sf_config *config, sf_config_item *group, sf_fit_drop *drop,
                                 sf_error *err) {
    static const char key[] = "HIC_window_resolution_ms";
    sf_config_item *setting = config_setting_get_member(group, key);
    double *sd = &drop->sd[SF_FIT_WINDOW], step = 0;
    if (!setting)
        return SF_OK;
    if (isnan(drop->value[SF_FIT_WINDOW]))
        return sf_config_refuse(config, setting, err, "%s is given, but no HIC_window_ms", key);
    SF_TRY(sf_config_number(config, group, key, false, 1e-3, drop->value[SF_FIT_WINDOW], &step, err));
    double stated = config_setting_get_member(group, "HIC_window_sd") ? *sd : 0;
    *sd = hypot(stated, step / sqrt(6) / drop->value[SF_FIT_WINDOW]);
    return SF_OK;
}

static sf_status read_measurement(const sf_config *config, sf_config_item *group, sf_fit_drop *drop,
                                  sf_error *err) {
    bool any = false;
    drop->sample_sd = 0.03;
    for (int kind = 0; kind < SF_FIT_SAMPLES; kind++) {
        SF_TRY(read_kind(config, group, kind, drop, err));
        any = any || !isnan(drop->value[kind]);
    }
    SF_TRY(read_resolution(config, group, drop, err));
    SF_TRY(sf_config_number(config, group, "speed_sd", false, 0, 0.2, &drop->speed_sd, err));
    SF_TRY(sf_config_number(config, group, "curve_sd", false, SD_LOW, 1, &drop->sample_sd, err));
    SF_TRY(read_curve(config, group, drop, err));
    if (!any && drop->samples == 0)
        sf_config_refuse(config, group, err,
                         "the drop \"%s\" has no a_max_g, no HIC, nothing else measured and no curve",
                         drop->name);
    return err->status;
}

/* The folder that holds the file. */
static bool stat_folder(const char *path, struct stat *info) {
    char folder[PATH_MAX];
    sf_path_split(path, folder);
    return stat(folder, info) == 0;
}

/* The file, or a copy of it in its folder: elsewhere the files that it names are others. */
static bool is_same_file(const char *a, const char *b) {
    sf_error none = SF_ERROR_INIT;
    uint64_t first, second;
    struct stat here, there;
    return stat_folder(a, &here) && stat_folder(b, &there) && here.st_dev == there.st_dev &&
           here.st_ino == there.st_ino && sf_plain_hash(a, NULL, SF_PLAIN_TEXT, &first, &none) == SF_OK &&
           sf_plain_hash(b, NULL, SF_PLAIN_TEXT, &second, &none) == SF_OK && first == second;
}

/* Two drops differ by more than digits and units change a copy, which may also be cut at its end. */
static bool is_same_curve(const sf_fit_drop *a, const sf_fit_drop *b) {
    static const double COPY = 1e-3; /* of the peak */
    int count = a->samples < b->samples ? a->samples : b->samples;
    double peak = 0, difference = 0;
    for (int k = 0; k < count; k++) {
        peak = fmax(peak, fabs(a->sample_value[k]));
        difference = fmax(difference, fabs(a->sample_value[k] - b->sample_value[k]));
    }
    return count == 0 ? a->samples == b->samples
                      : 2 * count > fmax(a->samples, b->samples) && difference <= COPY * peak;
}

/* Everything that was measured, number by number and sample by sample. */
static bool is_same_measurement(const sf_fit_drop *a, const sf_fit_drop *b) {
    bool same = is_same_curve(a, b);
    for (int kind = 0; kind < SF_FIT_SAMPLES; kind++)
        same = same && (a->value[kind] == b->value[kind] || (isnan(a->value[kind]) && isnan(b->value[kind])));
    return same;
}

/* Twice, a drop would weigh more than it tells, and would foretell itself where it is left out. */
static sf_status check_drop(const sf_config *config, sf_config_item *group, const sf_fit_drop *first,
                            const sf_fit_drop *drop, sf_error *err) {
    for (const sf_fit_drop *earlier = first; earlier < drop; earlier++) {
        if (earlier->number == drop->number && is_same_measurement(earlier, drop) &&
            is_same_file(earlier->case_path, drop->case_path))
            return sf_config_refuse(config, group, err,
                                    "the drop \"%s\" has the case and every measured value of \"%s\": give "
                                    "the same data once (of drops that were repeated, the mean)",
                                    drop->name, earlier->name);
        if (drop->samples > 0 && is_same_curve(earlier, drop))
            return sf_config_refuse(config, group, err,
                                    "the curve of the drop \"%s\" is that of \"%s\", sample by sample: a "
                                    "curve was measured in one drop",
                                    drop->name, earlier->name);
    }
    return SF_OK;
}

#define KIND_KEYS(name, key, error_key, ...) key "|" SF_DROP_SD(error_key) "|"

sf_status sf_drop_input_read(const sf_config *config, sf_config_item *group, bool predicted, int count,
                             sf_fit_drop *drop, sf_error *err) {
    static const char *const names[2] = {
        "name|case|drop|" SF_DROP_KINDS(
            KIND_KEYS) "HIC_window_resolution_ms|speed_sd|curve|curve_sd|curve_filter|curve_column|curve_columns|curve_invert|curve_zero",
        "name|case|drop"};
    sf_fit_drop *last = &drop[count];
    double number = 0;
    *last = (sf_fit_drop){.predicted = predicted};
    for (int kind = 0; kind < SF_FIT_SAMPLES; kind++)
        last->value[kind] = NAN;
    SF_TRY(sf_config_names(config, group, names[predicted], err));
    SF_TRY(name_drop(config, group, count, drop, err));
    SF_TRY(sf_config_file(config, group, "case", true, &last->case_path, err));
    SF_TRY(sf_config_whole(config, group, "drop", false, 1, SF_SERIES_MOST, &number, err));
    last->number = (int)number;
    if (predicted)
        return SF_OK;
    SF_TRY(read_measurement(config, group, last, err));
    return check_drop(config, group, drop, last, err);
}

void sf_drop_input_free(sf_fit_drop *drop) {
    SF_CLEAR(drop, drop->case_path, drop->curve_path, drop->sample_time, drop->sample_value);
}
