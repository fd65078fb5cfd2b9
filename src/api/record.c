/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libsoftfall: measured records of one impact. */
#include "api/api.h"
#include "post/figures/reference.h"

struct softfall_record {
    sf_reference reference;
    sf_injury injury;
    char line[SF_VERDICT_LINE_SIZE];
};

static const struct {
    const char *key;
    size_t place; /* in sf_injury */
    double factor;
} figures[] = {{"a_max_g", offsetof(sf_injury, a_max_g), 1},
               {"a_max_time_ms", offsetof(sf_injury, a_max_time), 1e3},
               {"hic", offsetof(sf_injury, hic.value), 1},
               {"hic_t1_ms", offsetof(sf_injury, hic.t1), 1e3},
               {"hic_t2_ms", offsetof(sf_injury, hic.t2), 1e3},
               {"hic15", offsetof(sf_injury, hic15.value), 1},
               {"hic36", offsetof(sf_injury, hic36.value), 1},
               {"gadd", offsetof(sf_injury, gadd), 1},
               {"clip_3ms_g", offsetof(sf_injury, clip_contiguous_g), 1},
               {"clip_3ms_cumulative_g", offsetof(sf_injury, clip_cumulative_g), 1}};

/* ---- options, "name=value" or "name" ---- */

typedef struct settings {
    sf_reference_options options;
    char *texts[16]; /* values, owned */
    int count;
} settings;

static sf_status take_number(const char *name, const char *value, double *out, sf_error *err) {
    char *end;
    *out = strtod(value, &end);
    return end != value && *end == '\0' ? SF_OK
                                        : SF_REFUSE(err, "%s: \"%.80s\" is not a number", name, value);
}

static sf_status take_option(sf_reference_options *o, const char *name, const char *value, sf_error *err) {
    if (strcmp(name, "column") == 0)
        o->column = value;
    else if (strcmp(name, "columns") == 0)
        o->columns = value;
    else if (strcmp(name, "range") == 0)
        sf_reference_parse_range(value, &o->range, err);
    else if (strcmp(name, "speed") == 0)
        sf_units_read(value, SF_SPEED, &o->speed, err);
    else if (strcmp(name, "filter") == 0 && strcmp(value, "none") == 0)
        o->cfc = 0;
    else if (strcmp(name, "filter") == 0)
        take_number(name, value, &o->cfc, err);
    else if (strcmp(name, "impact") == 0)
        sf_reference_parse_impact(name, value, &o->impact, err);
    else if (strcmp(name, "invert") == 0)
        o->invert = true;
    else if (strcmp(name, "zero") == 0)
        o->zero = true;
    else if (err->status == SF_OK)
        SF_REFUSE(err,
                  "a record has no option \"%.80s\"; there are column, columns, filter, impact, "
                  "invert, zero, speed and range",
                  name);
    return err->status;
}

static sf_status take_options(settings *s, const char *const *options, int count, sf_error *err) {
    for (int k = 0; k < count && err->status == SF_OK; k++) {
        if (s->count == (int)(sizeof s->texts / sizeof s->texts[0]))
            return SF_REFUSE(err, "%d options of a record" SF_AT_MOST("%d"), s->count + 1, s->count);
        char *text = s->texts[s->count++] = strdup(options[k]), *value = text ? strchr(text, '=') : NULL;
        if (!text)
            return SF_NO_MEMORY(err, "the options of a record");
        if (value)
            *value++ = '\0';
        take_option(&s->options, text, value ? value : "", err);
    }
    return err->status;
}

static sf_status read_record(softfall_record *r, const sf_reference_options *options, sf_error *err) {
    SF_TRY(sf_reference_read(options, &r->reference, err));
    SF_TRY(sf_injury_evaluate(&r->reference.curve, &r->injury, err));
    sf_record_line(&r->reference.record, r->line, sizeof r->line);
    return SF_OK;
}

static softfall_status make_record(const char *path, const sf_reference_samples *samples,
                                   const char *const *options, int count, softfall_record **out,
                                   softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    settings s = {.options = {.path = path,
                              .samples = samples,
                              .cfc = 1000,
                              .column_option = "column=HEADING",
                              .filter_option = "filter=",
                              .invert_option = "invert",
                              .zero_option = "zero"}};
    *out = sf_alloc(&err, 1, sizeof **out, "a record");
    if (*out &&
        (take_options(&s, options, count, &err) != SF_OK || read_record(*out, &s.options, &err) != SF_OK)) {
        softfall_record_free(*out);
        *out = NULL;
    }
    sf_free_all((size_t)s.count, s.texts);
    return softfall_return(&err, error);
}

softfall_status softfall_record_read(const char *path, const char *const *options, int count,
                                     softfall_record **out, softfall_error *error) {
    return make_record(path, NULL, options, count, out, error);
}

softfall_status softfall_record_make(const softfall_samples *samples, const char *const *options, int count,
                                     softfall_record **out, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    sf_reference_samples s = {samples->count, samples->time, samples->axes, {NULL}, samples->reading};
    if (s.axes < 1 || s.axes > SF_REFERENCE_AXES || s.count < 1) {
        *out = NULL;
        SF_REFUSE(&err, "%s: %lld samples of %d axes: a record has samples of 1 to %d axes", samples->name,
                  (long long)s.count, s.axes, SF_REFERENCE_AXES);
        return softfall_return(&err, error);
    }
    memcpy(s.value, samples->value, sizeof s.value);
    return make_record(samples->name, &s, options, count, out, error);
}

void softfall_record_free(softfall_record *r) {
    if (r)
        sf_reference_free(&r->reference);
    free(r);
}

int64_t softfall_record_curve(const softfall_record *r, const double **time, const double **deceleration) {
    *time = r->reference.curve.time;
    *deceleration = r->reference.curve.value;
    return r->reference.curve.count;
}

int softfall_record_grade(const softfall_record *r) {
    return (int)r->reference.record.grade;
}

const char *softfall_record_verdict(const softfall_record *r) {
    return r->line;
}

const char *softfall_record_interpretation(const softfall_record *r) {
    return r->reference.interpretation;
}

softfall_status softfall_record_figure(const softfall_record *r, const char *key, double *value,
                                       softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    for (size_t k = 0; k < sizeof figures / sizeof figures[0]; k++)
        if (strcmp(figures[k].key, key) == 0) {
            *value = figures[k].factor * *(const double *)((const char *)&r->injury + figures[k].place);
            return softfall_return(&err, error);
        }
    SF_REFUSE(&err, "unknown figure \"%.80s\" of a record", key);
    return softfall_return(&err, error);
}
