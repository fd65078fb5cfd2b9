/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/sweep/plan.h"

#include "base/text.h"
#include "case/values.h"
#include "io/plain_file.h"
#include "study/fit/posterior/mixture.h"
#include "study/material_file.h"
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_qrng.h>
#include <gsl/gsl_randist.h>
#include <unistd.h>

enum { MOST_LEVELS = 1000000, MOST_DRAWS = 1000, DRAW_PATH = PATH_MAX + 32, NAMES_SIZE = 256 };

/* A factor while it is read: the kind of quantity of its unit is found by its first value. */
typedef struct reading {
    const sf_config *config;
    const config_setting_t *group;
    sf_factor *factor;
    bool begun;       /* a number has been read */
    sf_quantity kind; /* of `unit` */
    double scale;     /* SI of one `unit` */
} reading;

/* ---- numbers ---- */

/* True if the text is a number with a unit of some kind. */
static bool find_kind(const sf_units *units, const char *text, sf_quantity *kind, double *si) {
    for (int k = 0; k < SF_QUANTITY_COUNT; k++) {
        if (sf_units_parse(units, text, (sf_quantity)k, si, SF_IGNORED) == SF_OK) {
            *kind = (sf_quantity)k;
            return true;
        }
    }
    return false;
}

static void trim(const char *text, char *out, size_t size) {
    text += strspn(text, " \t");
    size_t length = strlen(text);
    while (length > 0 && strchr(" \t", text[length - 1]))
        length--;
    snprintf(out, size, "%.*s", (int)(length < size ? length : size - 1), text);
}

/* The unit of the first number decides. */
static sf_status begin_unit(reading *r, const config_setting_t *s, const char *unit, sf_quantity kind,
                            sf_error *err) {
    trim(unit, r->factor->unit, sizeof r->factor->unit);
    SF_PRINTED(one, SF_FACTOR_UNIT_SIZE + 4, "1 %s", r->factor->unit);
    r->kind = kind;
    r->begun = true;
    if (*r->factor->unit && sf_units_parse(r->config->units, one, kind, &r->scale, err) != SF_OK)
        return sf_config_refuse(r->config, s, err, "%s: the unit of \"%s\" cannot be used", r->factor->key,
                                unit);
    return SF_OK;
}

/* The SI value of 0 in a unit: not 0 of degC. */
static double zero_of(const reading *r, const char *unit) {
    double zero = 0;
    SF_PRINTED(text, SF_FACTOR_UNIT_SIZE + 4, "0 %s", unit);
    return sf_units_parse(r->config->units, text, r->kind, &zero, SF_IGNORED) == SF_OK ? zero : 0;
}

static sf_status take_quantity(reading *r, const config_setting_t *s, const char *text, double number,
                               const char *unit, double *out, sf_error *err) {
    sf_error inner = SF_ERROR_INIT;
    sf_quantity kind = SF_LENGTH;
    double si = 0;
    char own[SF_FACTOR_UNIT_SIZE];
    if (!r->begun && !find_kind(r->config->units, text, &kind, &si))
        return sf_config_refuse(r->config, s, err, "%s: unknown unit in \"%s\"", r->factor->key, text);
    if (!r->begun && begin_unit(r, s, unit, kind, err) != SF_OK)
        return err->status;
    if (!*r->factor->unit)
        return sf_config_refuse(r->config, s, err, "%s: \"%s\" has a unit, the values before it have none",
                                r->factor->key, text);
    if (sf_units_parse(r->config->units, text, r->kind, &si, &inner) != SF_OK)
        return sf_config_refuse(r->config, s, err, "%s: %s", r->factor->key, inner.text);
    trim(unit, own, sizeof own);
    if (strcmp(own, r->factor->unit) != 0 && (zero_of(r, own) != 0 || zero_of(r, r->factor->unit) != 0))
        return sf_config_refuse(r->config, s, err,
                                "%s: %s and %s have different zeros: give all values in one of them",
                                r->factor->key, own, r->factor->unit);
    *out = strcmp(own, r->factor->unit) == 0 ? number : si / r->scale;
    return SF_OK;
}

/* A number, with or without a unit. */
static sf_status take_number(reading *r, const config_setting_t *s, double *out, sf_error *err) {
    const char *text = config_setting_get_string(s);
    double number = 0;
    const char *unit = text ? sf_decimal_read(text + strspn(text, " \t"), &number) : NULL;
    if (sf_config_is_number(s, out)) {
        if (*r->factor->unit)
            return sf_config_refuse(r->config, s, err, "%s: %g has no unit, the values before it have one",
                                    r->factor->key, *out);
        r->begun = true;
        return isfinite(*out) ? SF_OK
                              : sf_config_refuse(r->config, s, err, "%s is not finite", r->factor->key);
    }
    if (!unit)
        return sf_config_refuse(r->config, s, err, "%s: expected a number, with its unit as a text",
                                r->factor->key);
    return take_quantity(r, s, text, number, unit, out, err);
}

/* True if the value is a number, or a text of a number with a unit. */
static bool looks_numeric(const sf_config *config, const config_setting_t *s) {
    const char *text = config_setting_get_string(s);
    double number;
    sf_quantity kind;
    return sf_config_is_number(s, &number) || (text && find_kind(config->units, text, &kind, &number));
}

/* ---- words ---- */

static sf_status make_levels(sf_factor *f, int64_t count, bool words, sf_error *err) {
    f->words = words;
    f->count = count;
    if (words) {
        SF_ALLOC_ALL(err, "levels", SF_ROOM(f->text, count), SF_ROOM(f->label, count));
    } else {
        f->number = sf_alloc(err, count, sizeof *f->number, "levels");
    }
    return err->status;
}

/* `text`: from malloc, taken over. */
static sf_status set_word(sf_factor *f, int64_t k, char *text, const char *label, sf_error *err) {
    f->text[k] = text;
    f->label[k] = strdup(label);
    return text && f->label[k] ? SF_OK : SF_NO_MEMORY(err, "the levels of %s", f->key);
}

/* All with a point, as an array of libconfig has whole or fractional numbers, not both. */
static void print_fractions(FILE *out, const config_setting_t *array) {
    for (int k = 0; k < config_setting_length(array); k++) {
        SF_PRINTED(number, 40, "%.12g", config_setting_get_float_elem(array, k));
        fprintf(out, "%s%s%s", k ? ", " : "[", number, strpbrk(number, ".e") ? "" : ".0");
    }
    fputc(']', out);
}

/* The setting in libconfig syntax, as --set takes it or, `plain`, as a table has it; from malloc, NULL
 * without memory. */
static char *print_word(const config_setting_t *s, bool plain) {
    const config_setting_t *first = config_setting_is_array(s) ? config_setting_get_elem(s, 0) : NULL;
    SF_TEXT_STREAM(out, text, size);
    if (out && first && config_setting_type(first) == CONFIG_TYPE_FLOAT && !plain)
        print_fractions(out, s);
    else if (out)
        sf_case_print_setting(out, s);
    return sf_text_close(out, &text);
}

static sf_status take_word(reading *r, const config_setting_t *s, int64_t k, sf_error *err) {
    SF_OWNED char *label = print_word(s, true);
    const char *own = config_setting_get_string(s);
    if (!label)
        return SF_NO_MEMORY(err, "the levels of %s", r->factor->key);
    set_word(r->factor, k, print_word(s, false), own ? own : label, err);
    return err->status;
}

/* A group of the case is replaced by a file, "@file"; a key takes the path as a text. */
static bool is_group(const char *key) {
    const char *dot = strchr(key, '.');
    return !dot || (strncmp(key, "materials.", 10) == 0 && !strchr(dot + 1, '.'));
}

static sf_status take_file(reading *r, const config_setting_t *s, const char *label, int64_t k,
                           sf_error *err) {
    char *text = NULL, path[DRAW_PATH], real[PATH_MAX];
    sf_error inner = SF_ERROR_INIT;
    sf_config_path(r->config, label, path);
    if (sf_plain_check(path, NULL, &inner) != SF_OK)
        return sf_config_refuse(r->config, s, err, "%s: %s", r->factor->key, inner.text);
    const char *whole = realpath(path, real) ? real : path;
    bool group = is_group(r->factor->key);
    if (!group && strpbrk(whole, "\"\\"))
        return sf_config_refuse(r->config, s, err,
                                "%s: a path with a quote or a backslash cannot be used: %s", r->factor->key,
                                whole);
    if (asprintf(&text, group ? "@%s" : "\"%s\"", whole) < 0)
        text = NULL;
    return set_word(r->factor, k, text, label, err);
}

/* ---- the kinds of lists ---- */

static sf_status check_list(const reading *r, const config_setting_t *list, sf_error *err) {
    if (!config_setting_is_array(list) && !config_setting_is_list(list))
        return sf_config_refuse(r->config, list, err, "%s must be a list, [ ... ] or ( ... )",
                                config_setting_name(list));
    if (config_setting_length(list) == 0)
        return sf_config_refuse(r->config, list, err, "%s: the list of %s is empty: there is no run to do",
                                config_setting_name(list), r->factor->key);
    return SF_OK;
}

static sf_status read_files(reading *r, const config_setting_t *list, sf_error *err) {
    SF_TRY(check_list(r, list, err));
    int count = config_setting_length(list);
    SF_TRY(make_levels(r->factor, count, true, err));
    for (int k = 0; k < count && err->status == SF_OK; k++) {
        const config_setting_t *s = config_setting_get_elem(list, (unsigned)k);
        const char *label = config_setting_get_string(s);
        if (!label || !*label)
            return sf_config_refuse(r->config, s, err, "files must be texts, the names of files");
        take_file(r, s, label, k, err);
    }
    return err->status;
}

/* True if the case would look for the value beside itself, not beside the plan; a group takes a file and
 * nothing else. */
static bool is_file(const sf_factor *f, const config_setting_t *s) {
    const char *text = config_setting_get_string(s);
    return is_group(f->key) || (text && *text && *text != '/' && sf_case_key_is_file(f->key));
}

static sf_status read_values(reading *r, const config_setting_t *list, sf_error *err) {
    SF_TRY(check_list(r, list, err));
    int count = config_setting_length(list);
    bool words = !looks_numeric(r->config, config_setting_get_elem(list, 0));
    SF_TRY(make_levels(r->factor, count, words, err));
    for (int k = 0; k < count && err->status == SF_OK; k++) {
        const config_setting_t *s = config_setting_get_elem(list, (unsigned)k);
        if (is_file(r->factor, s))
            return sf_config_refuse(
                r->config, s, err,
                "%s is given by a file: give files, relative to the plan, in place of values",
                r->factor->key);
        if (words)
            take_word(r, s, k, err);
        else
            take_number(r, s, &r->factor->number[k], err);
    }
    return err->status;
}

static sf_status read_range(reading *r, const config_setting_t *first, sf_error *err) {
    sf_factor *f = r->factor;
    double from = 0, to = 0, count = 0;
    int logarithmic = 0;
    const config_setting_t *last = config_setting_get_member(r->group, "to");
    if (!last)
        return sf_config_refuse(r->config, r->group, err, "%s: from needs to and count", f->key);
    SF_TRY(take_number(r, first, &from, err));
    SF_TRY(take_number(r, last, &to, err));
    SF_TRY(sf_config_whole(r->config, r->group, "count", true, 2, MOST_LEVELS, &count, err));
    SF_TRY(sf_config_choice(r->config, r->group, "spacing", "linear|log", &logarithmic, err));
    SF_TRY(make_levels(f, (int64_t)count, false, err));
    if (logarithmic && !(from > 0 && to > 0))
        return sf_config_refuse(r->config, first, err, "%s: a logarithmic range needs values above 0",
                                f->key);
    for (int64_t k = 0; k < f->count; k++) {
        double s = (double)k / (double)(f->count - 1);
        f->number[k] = logarithmic ? exp(log(from) + s * (log(to) - log(from))) : from + s * (to - from);
    }
    return SF_OK;
}

/* ---- a posterior ---- */

/* The number of draw `k` (from 0) of `count` of them, in the middle of equal parts of those that are there:
 * softfall-fit writes them model by model. */
static int chosen_draw(int k, int count, int there) {
    return (2 * k + 1) * there / (2 * count) + 1;
}

static sf_status read_posterior(reading *r, const config_setting_t *s, sf_error *err) {
    const char *name = config_setting_get_string(s);
    char folder[PATH_MAX], path[DRAW_PATH];
    double draws = MOST_DRAWS;
    if (!name || !*name)
        return sf_config_refuse(r->config, s, err, "posterior must be a text, the name of a folder of draws");
    if (!is_group(r->factor->key))
        return sf_config_refuse(r->config, s, err,
                                "a posterior is of key = \"material\" or of a layer, not of %s",
                                r->factor->key);
    SF_TRY(sf_config_whole(r->config, r->group, "draws", false, 1, MOST_DRAWS, &draws, err));
    bool given = config_setting_get_member(r->group, "draws") != NULL;
    sf_config_path(r->config, name, folder);
    int there = sf_draws_count(folder, MOST_DRAWS), count = given ? (int)draws : there;
    if (there == 0)
        return sf_config_refuse(r->config, s, err, "posterior: there is no draw-001.cfg in %s", folder);
    if (there < count)
        return sf_config_refuse(r->config, s, err, "draws is %d, but %s holds %d", count, folder, there);
    SF_TRY(make_levels(r->factor, count, true, err));
    r->factor->uncertain = r->factor->posterior = true;
    for (int k = 0; k < count && err->status == SF_OK; k++) {
        sf_draw_path(name, chosen_draw(k, count, there), path, sizeof path);
        take_file(r, s, path, k, err);
    }
    return err->status;
}

/* ---- distributions: one entry for each ---- */

static double uniform_at(const sf_factor *f, double u) {
    return f->a + u * (f->b - f->a);
}

static double normal_at(const sf_factor *f, double u) {
    return f->a + f->b * gsl_cdf_ugaussian_Pinv(u);
}

static double lognormal_at(const sf_factor *f, double u) {
    return f->a * exp(f->b * gsl_cdf_ugaussian_Pinv(u));
}

static const char *uniform_fault(const sf_factor *f) {
    return f->a < f->b ? NULL : "low must be below high";
}

static const char *normal_fault(const sf_factor *f) {
    return f->b > 0 ? NULL : "the deviation must be above 0";
}

static const char *lognormal_fault(const sf_factor *f) {
    return !(f->b > 0) ? normal_fault(f) : f->a > 0 ? NULL : "the median must be above 0";
}

struct sf_distribution {
    const char *name, *first, *second; /* keys of the two numbers */
    bool pure;                         /* the second number has no unit */
    const char *(*fault)(const sf_factor *f);
    double (*at)(const sf_factor *f, double u);
    const char *phrase; /* format of both numbers and the unit, for a report */
};

static const sf_distribution distributions[] = {
    {"uniform", "low", "high", false, uniform_fault, uniform_at, "uniform, %.6g to %.6g %s"},
    {"normal", "mean", "deviation", false, normal_fault, normal_at,
     "normal, mean %.6g, standard deviation %.6g %s"},
    {"lognormal", "median", "deviation_ln", true, lognormal_fault, lognormal_at,
     "lognormal, median %.6g, deviation of the logarithm %.6g (%s)"}};
enum { DISTRIBUTIONS = sizeof distributions / sizeof distributions[0] };

/* Appends "|word" to a list of words. */
static void add_word(char list[NAMES_SIZE], const char *word) {
    if (*word)
        sf_text_add(list, NAMES_SIZE, "%s%s", *list ? "|" : "", word);
}

static sf_status read_distribution(reading *r, sf_error *err) {
    sf_factor *f = r->factor;
    char words[NAMES_SIZE] = "", own[NAMES_SIZE] = "key|name|distribution";
    int which = 0;
    for (int k = 0; k < DISTRIBUTIONS; k++)
        add_word(words, distributions[k].name);
    SF_TRY(sf_config_choice(r->config, r->group, "distribution", words, &which, err));
    const sf_distribution *d = f->distribution = &distributions[which];
    add_word(own, d->first);
    add_word(own, d->second);
    SF_TRY(sf_config_names(r->config, r->group, own, err));
    const config_setting_t *first = config_setting_get_member(r->group, d->first),
                           *second = config_setting_get_member(r->group, d->second);
    if (!first || !second)
        return sf_config_refuse(r->config, r->group, err, "%s: give %s and %s, or values, files or posterior",
                                f->key, d->first, d->second);
    SF_TRY(take_number(r, first, &f->a, err));
    SF_TRY(d->pure ? sf_config_number(r->config, r->group, d->second, true, 0, 10, &f->b, err)
                   : take_number(r, second, &f->b, err));
    f->uncertain = true;
    const char *fault = d->fault(f);
    return fault ? sf_config_refuse(r->config, r->group, err, "%s: %s", f->key, fault) : SF_OK;
}

/* ---- the kinds of factor: one entry for each ---- */

/* A group has the key of one kind; a sampled group without such a key has a distribution. */
typedef struct factor_kind {
    const char *key;    /* by which the kind is recognised */
    const char *more;   /* keys that belong to it, "a|b" */
    const char *phrase; /* in a sentence that says what may be given */
    bool sampled;       /* it may also stand in a sample */
    sf_status (*read)(reading *r, const config_setting_t *setting, sf_error *err);
} factor_kind;

static const factor_kind kinds[] = {
    {"values", "", "values", true, read_values},
    {"files", "", "files", true, read_files},
    {"posterior", "draws", "posterior", true, read_posterior},
    {"from", "to|count|spacing", "or from, to and count", false, read_range},
};
enum { KINDS = sizeof kinds / sizeof kinds[0] };

/* The keys that a group may have: of one kind, or (NULL) of all. */
static void list_keys(const factor_kind *kind, bool sampled, char names[NAMES_SIZE]) {
    snprintf(names, NAMES_SIZE, "key|name");
    for (int k = 0; k < KINDS; k++) {
        if (kind ? kind != &kinds[k] : sampled && !kinds[k].sampled)
            continue;
        add_word(names, kinds[k].key);
        add_word(names, kinds[k].more);
    }
    if (!sampled)
        add_word(names, "uncertain");
    if (!sampled || kind)
        return;
    add_word(names, "distribution");
    for (int k = 0; k < DISTRIBUTIONS; k++) {
        add_word(names, distributions[k].first);
        add_word(names, distributions[k].second);
    }
}

/* ---- the whole ---- */

static sf_status read_head(reading *r, sf_error *err) {
    const char *key = NULL, *name = NULL;
    sf_factor *f = r->factor;
    sf_config_place(r->config, r->group, f->where, sizeof f->where);
    SF_TRY(sf_config_text(r->config, r->group, "key", true, &key, err));
    SF_TRY(sf_config_text(r->config, r->group, "name", false, &name, err));
    if (strlen(key) >= sizeof f->key || strpbrk(key, "= \t\"@") || (name && strlen(name) >= sizeof f->name))
        return sf_config_refuse(r->config, r->group, err, "unknown key \"%.80s\" of a case", key);
    snprintf(f->key, sizeof f->key, "%s", key);
    snprintf(f->name, sizeof f->name, "%s", name ? name : key);
    return SF_OK;
}

static sf_status refuse_without_kind(const reading *r, sf_error *err) {
    char phrases[NAMES_SIZE] = "";
    for (int k = 0; k < KINDS; k++)
        sf_text_add(phrases, sizeof phrases, "%s%s", k ? ", " : "", kinds[k].phrase);
    return sf_config_refuse(r->config, r->group, err,
                            "%s: give %s; a distribution belongs into a group with sample", r->factor->key,
                            phrases);
}

static sf_status read_kind(reading *r, bool sampled, sf_error *err) {
    const factor_kind *kind = NULL;
    const config_setting_t *found = NULL;
    char names[NAMES_SIZE];
    for (int k = 0; k < KINDS; k++) {
        const config_setting_t *s = config_setting_get_member(r->group, kinds[k].key);
        if (s && kind)
            return sf_config_refuse(r->config, s, err, "%s: %s and %s exclude each other", r->factor->key,
                                    kind->key, kinds[k].key);
        found = s ? s : found;
        kind = s ? &kinds[k] : kind;
    }
    if (!kind)
        return sampled ? read_distribution(r, err) : refuse_without_kind(r, err);
    list_keys(kind, sampled, names);
    SF_TRY(sf_config_names(r->config, r->group, names, err));
    return kind->read(r, found, err);
}

sf_status sf_factor_read(const sf_config *config, const config_setting_t *group, bool sampled, sf_factor *f,
                         sf_error *err) {
    reading r = {.config = config, .group = group, .factor = f};
    char names[NAMES_SIZE];
    *f = (sf_factor){0};
    list_keys(NULL, sampled, names);
    SF_TRY(sf_config_names(config, group, names, err));
    SF_TRY(read_head(&r, err));
    SF_TRY(read_kind(&r, sampled, err));
    f->uncertain |= sampled;
    return sf_config_flag(config, group, "uncertain", &f->uncertain, err);
}

void sf_factor_free(sf_factor *f) {
    sf_free_all((size_t)f->count, f->text);
    sf_free_all((size_t)f->count, f->label);
    SF_CLEAR(f, f->text, f->label, f->number, f->value);
}

double sf_factor_quantile(const sf_factor *f, double u) {
    int64_t level = (int64_t)(u * (double)f->count);
    if (f->distribution)
        return f->distribution->at(f, u);
    level = level < f->count ? level : f->count - 1;
    return f->words ? (double)level : f->number[level];
}

void sf_factor_override(const sf_factor *f, double value, char *text, size_t size) {
    if (f->words)
        snprintf(text, size, "%s=%s", f->key, f->text[(int64_t)value]);
    else if (*f->unit)
        snprintf(text, size, "%s=\"%.12g %s\"", f->key, value, f->unit);
    else
        snprintf(text, size, "%s=%.12g", f->key, value);
}

const char *sf_factor_text(const sf_factor *f, double value, char *text, size_t size) {
    if (f->words)
        snprintf(text, size, "%s", f->label[(int64_t)value]);
    else
        snprintf(text, size, "%.12g", value);
    return text;
}

const char *sf_factor_heading(const sf_factor *f, char *text, size_t size) {
    snprintf(text, size, *f->unit ? "%s (%s)" : "%s", f->name, f->unit);
    return text;
}

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral" /* formats are those of the table */
void sf_factor_distribution_text(const sf_factor *f, char *text, size_t size) {
    snprintf(text, size, f->distribution->phrase, f->a, f->b, f->unit);
}
#pragma GCC diagnostic pop

/* ---- samples ---- */

int64_t sf_sample_rows(sf_sampling method, int d, int64_t count) {
    return method == SF_SAMPLING_SALTELLI ? count * (d + 2) : count;
}

/* The sequence, or, with another seed than 1, moved as a whole (modulo 1; Cranley and Patterson 1976,
 * doi:10.1137/0713071): each coordinate is as evenly spread, at other points. */
static sf_status sobol(int d, int64_t count, uint64_t seed, double *u, sf_error *err) {
    double shift[SF_SOBOL_DIMENSIONS] = {0};
    if (d > SF_SOBOL_DIMENSIONS)
        return SF_REFUSE(err, "%d coordinates of a Sobol' sequence" SF_AT_MOST("%d"), d, SF_SOBOL_DIMENSIONS);
    gsl_qrng *q = gsl_qrng_alloc(gsl_qrng_sobol, (unsigned)d);
    if (!q)
        return SF_NO_MEMORY(err, "the Sobol' sequence");
    SF_RANDOM *rng = seed != 1 ? sf_random(seed, err) : NULL;
    for (int i = 0; rng && i < d; i++)
        shift[i] = gsl_rng_uniform_pos(rng);
    for (int64_t k = 0; k < count && err->status == SF_OK; k++) {
        gsl_qrng_get(q, u + k * d);
        for (int i = 0; i < d; i++) {
            double x = u[k * d + i] + shift[i];
            u[k * d + i] = x > 1 ? x - 1 : x < 1 ? x : 0.5; /* 1 is no quantile */
        }
    }
    gsl_qrng_free(q);
    return err->status;
}

/* One stratum of each coordinate for each point, shuffled; the place within it at random. */
static sf_status latin(gsl_rng *rng, int d, int64_t count, double *u, sf_error *err) {
    SF_OWNED int64_t *stratum = sf_alloc(err, count, sizeof *stratum, "strata");
    for (int i = 0; i < d && stratum; i++) {
        for (int64_t k = 0; k < count; k++)
            stratum[k] = k;
        gsl_ran_shuffle(rng, stratum, (size_t)count, sizeof *stratum);
        for (int64_t k = 0; k < count; k++)
            u[k * d + i] = ((double)stratum[k] + gsl_rng_uniform_pos(rng)) / (double)count;
    }
    return err->status;
}

static sf_status saltelli(int d, int64_t count, uint64_t seed, double *u, sf_error *err) {
    SF_OWNED double *both = sf_alloc(err, count, 2 * (unsigned long)d * sizeof *both, "samples");
    if (both && sobol(2 * d, count, seed, both, err) == SF_OK)
        for (int64_t k = 0; k < count; k++)
            for (int block = 0; block < d + 2; block++) {
                double *row = u + (block * count + k) * d;
                memcpy(row, both + 2 * k * d + (block == 1 ? d : 0), (size_t)d * sizeof *row);
                if (block >= 2)
                    row[block - 2] = both[2 * k * d + d + block - 2];
            }
    return err->status;
}

sf_status sf_sample(sf_sampling method, int d, int64_t count, uint64_t seed, double *u, sf_error *err) {
    if (method == SF_SAMPLING_SOBOL)
        return sobol(d, count, seed, u, err);
    if (method == SF_SAMPLING_SALTELLI)
        return saltelli(d, count, seed, u, err);
    SF_RANDOM *rng = sf_random(seed, err);
    if (rng && method == SF_SAMPLING_LATIN)
        latin(rng, d, count, u, err);
    for (int64_t k = 0; rng && method != SF_SAMPLING_LATIN && k < count * d; k++)
        u[k] = gsl_rng_uniform_pos(rng);
    return err->status;
}
