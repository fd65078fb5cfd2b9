/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/compression_config.h"

#include "core/units.h"

#include <errno.h>
#include <libconfig.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

typedef struct reader {
    const char *path;
    sf_units *units;
    sf_compression_config *out;
} reader;

static const char *const RATE_MODELS[] = {"none", "log", "maxwell", "curves", "auto"};
static const char *const RULES[] = {"auto", "H1", "H1_automatic", "H2"};

const char *sf_rate_model_name(sf_rate_model model) {
    return RATE_MODELS[model];
}

/* ---- values ---- */

static sf_status read_quantity(const reader *r, const config_setting_t *s, sf_quantity kind, double *value,
                               sf_error *err) {
    const char *text = config_setting_get_string(s), *key = config_setting_name(s);
    int line = (int)config_setting_source_line(s);
    sf_error inner = SF_ERROR_INIT;
    if (!text)
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: %s must be a text with a unit, for example \"%s\"", r->path,
                       line, key, sf_quantity_example(kind));
    if (sf_units_parse(r->units, text, kind, value, &inner) != SF_OK)
        return SF_FAIL(err, inner.status, "%s:%d: %s: %s", r->path, line, key, inner.text);
    if (!(*value > 0))
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: %s = \"%s\" is not above zero", r->path, line, key, text);
    return SF_OK;
}

static sf_status read_number(const reader *r, const config_setting_t *s, double low, double high,
                             double *value, sf_error *err) {
    int type = config_setting_type(s);
    if (type == CONFIG_TYPE_INT)
        *value = config_setting_get_int(s);
    else if (type == CONFIG_TYPE_FLOAT)
        *value = config_setting_get_float(s);
    else
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%u: %s must be a plain number from %g to %g", r->path,
                       config_setting_source_line(s), config_setting_name(s), low, high);
    if (!(*value >= low && *value <= high))
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%u: %s = %g is not between %g and %g", r->path,
                       config_setting_source_line(s), config_setting_name(s), *value, low, high);
    return SF_OK;
}

static sf_status read_choice(const reader *r, const config_setting_t *s, const char *const *words, int count,
                             int *index, sf_error *err) {
    const char *text = config_setting_get_string(s);
    char known[128] = "";
    for (int k = 0; k < count; k++) {
        if (text && strcmp(text, words[k]) == 0) {
            *index = k;
            return SF_OK;
        }
        size_t used = strlen(known);
        snprintf(known + used, sizeof known - used, "%s\"%s\"", k ? ", " : "", words[k]);
    }
    return SF_FAIL(err, SF_ERR_INPUT, "%s:%u: %s must be one of %s", r->path, config_setting_source_line(s),
                   config_setting_name(s), known);
}

/* ---- groups ---- */

static sf_status check_keys(const reader *r, const config_setting_t *group, const char *what,
                            const char *const *known, sf_error *err) {
    for (int i = 0; i < config_setting_length(group); i++) {
        const config_setting_t *s = config_setting_get_elem(group, (unsigned)i);
        const char *const *k = known;
        while (*k && strcmp(*k, config_setting_name(s)) != 0)
            k++;
        if (*k)
            continue;
        char list[256] = "";
        for (k = known; *k; k++) {
            size_t used = strlen(list);
            snprintf(list + used, sizeof list - used, "%s%s", used ? ", " : "", *k);
        }
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%u: unknown key \"%s\" in %s; there are %s", r->path,
                       config_setting_source_line(s), config_setting_name(s), what, list);
    }
    return SF_OK;
}

static sf_status read_specimen(const reader *r, const config_setting_t *group, sf_error *err) {
    static const char *const known[] = {"side", "thickness", NULL};
    if (!config_setting_is_group(group))
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s:%u: specimen must be a group { side = \"50 mm\"; thickness = \"50 mm\"; }",
                       r->path, config_setting_source_line(group));
    const config_setting_t *side = config_setting_get_member(group, "side");
    const config_setting_t *thickness = config_setting_get_member(group, "thickness");
    if (check_keys(r, group, "specimen", known, err) == SF_OK && side)
        read_quantity(r, side, SF_LENGTH, &r->out->side, err);
    if (err->status == SF_OK && thickness)
        read_quantity(r, thickness, SF_LENGTH, &r->out->thickness, err);
    return err->status;
}

static char *resolve(const reader *r, const char *name, sf_error *err) {
    const char *slash = strrchr(r->path, '/');
    char *path = NULL;
    int folder = slash && name[0] != '/' ? (int)(slash - r->path) + 1 : 0;
    if (asprintf(&path, "%.*s%s", folder, r->path, name) < 0) {
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the path %s", name);
        return NULL;
    }
    return path;
}

static sf_status check_rate(const reader *r, const config_setting_t *s, double rate, sf_error *err) {
    for (int k = 0; k < r->out->test_count; k++)
        if (fabs(log(rate / r->out->test[k].rate)) < 1e-6)
            return SF_FAIL(
                err, SF_ERR_INPUT,
                "%s:%u: the rate %g 1/s is that of %s already; give each rate once (join the tests "
                "or take their mean)",
                r->path, config_setting_source_line(s), rate, r->out->test[k].path);
    return SF_OK;
}

/* Puts the test in its place by rate. */
static void insert_test(sf_compression_config *c, const sf_compression_test *test) {
    int at = c->test_count++;
    for (; at > 0 && c->test[at - 1].rate > test->rate; at--)
        c->test[at] = c->test[at - 1];
    c->test[at] = *test;
}

static sf_status read_test(const reader *r, const config_setting_t *entry, sf_error *err) {
    static const char *const known[] = {"file", "rate", NULL};
    unsigned line = config_setting_source_line(entry);
    if (!config_setting_is_group(entry))
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s:%u: a test must be a group { file = \"slow.csv\"; rate = \"0.1 1/min\"; }",
                       r->path, line);
    if (check_keys(r, entry, "a test", known, err) != SF_OK)
        return err->status;
    const config_setting_t *rate = config_setting_get_member(entry, "rate");
    const char *file = NULL;
    sf_compression_test test;
    double value;
    if (!config_setting_lookup_string(entry, "file", &file))
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%u: the test has no key file (a text)", r->path, line);
    if (!rate)
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "%s:%u: the test %s has no rate; give its nominal strain rate, for example \"0.1 1/min\"",
            r->path, line, file);
    if (read_quantity(r, rate, SF_RATE, &value, err) != SF_OK || check_rate(r, rate, value, err) != SF_OK)
        return err->status;
    char *path = resolve(r, file, err);
    sf_error inner = SF_ERROR_INIT;
    if (path && sf_compression_test_read(path, value, &test, &inner) != SF_OK)
        SF_FAIL(err, inner.status, "%s (named at %s:%u)", inner.text, r->path, line);
    else if (path)
        insert_test(r->out, &test);
    free(path);
    return err->status;
}

static sf_status read_tests(const reader *r, const config_setting_t *tests, sf_error *err) {
    int count = tests ? config_setting_length(tests) : 0;
    if (!tests || !config_setting_is_list(tests) || count < 1 || count > SF_COMPRESSION_TESTS)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s:%u: tests must be a list of 1 to %d tests, ( { file = \"slow.csv\"; rate = \"0.1 "
                       "1/min\"; } )",
                       r->path, tests ? config_setting_source_line(tests) : 1, SF_COMPRESSION_TESTS);
    for (int i = 0; i < count && err->status == SF_OK; i++)
        read_test(r, config_setting_get_elem(tests, (unsigned)i), err);
    return err->status;
}

static sf_status read_name(const reader *r, const config_setting_t *s, sf_error *err) {
    const char *text = config_setting_get_string(s);
    if (!text || !*text || strlen(text) >= SF_COMPRESSION_NAME || strpbrk(text, "\n\r'\\"))
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s:%u: name must be a text of 1 to %d characters, without ', \\ and line ends",
                       r->path, config_setting_source_line(s), SF_COMPRESSION_NAME - 1);
    snprintf(r->out->name, sizeof r->out->name, "%s", text);
    return SF_OK;
}

static sf_status read_root(const reader *r, const config_setting_t *root, sf_error *err) {
    static const char *const known[] = {"name",
                                        "density",
                                        "tests",
                                        "DAMP",
                                        "E_range",
                                        "rate_model",
                                        "densification",
                                        "densification_start",
                                        "confidence",
                                        "specimen",
                                        NULL};
    sf_compression_config *c = r->out;
    int model = SF_RATE_AUTO, rule = SF_RULE_AUTO;
    if (check_keys(r, root, "the file", known, err) != SF_OK)
        return err->status;
    const config_setting_t *s = config_setting_get_member(root, "density");
    if (!s)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s: the key density is missing, for example density = \"35 kg/m3\"", r->path);
    read_quantity(r, s, SF_DENSITY, &c->density, err);
    if (err->status == SF_OK && (s = config_setting_get_member(root, "name")))
        read_name(r, s, err);
    if (err->status == SF_OK && (s = config_setting_get_member(root, "DAMP")))
        read_number(r, s, 0, 10, &c->damp, err);
    if (err->status == SF_OK && (s = config_setting_get_member(root, "E_range")))
        read_number(r, s, 0.001, 0.2, &c->modulus_range, err);
    if (err->status == SF_OK && (s = config_setting_get_member(root, "confidence")))
        read_number(r, s, 0.5, 0.9999, &c->confidence, err);
    if (err->status == SF_OK && (s = config_setting_get_member(root, "densification_start")))
        read_number(r, s, 0.05, 0.98, &c->densification_start, err);
    if (err->status == SF_OK && (s = config_setting_get_member(root, "rate_model")))
        read_choice(r, s, RATE_MODELS, SF_RATE_MODELS + 1, &model, err);
    if (err->status == SF_OK && (s = config_setting_get_member(root, "densification")))
        read_choice(r, s, RULES, sizeof RULES / sizeof RULES[0], &rule, err);
    if (err->status == SF_OK && (s = config_setting_get_member(root, "specimen")))
        read_specimen(r, s, err);
    c->rate_model = (sf_rate_model)model;
    c->rule = (sf_rule_choice)rule;
    if (err->status == SF_OK)
        read_tests(r, config_setting_get_member(root, "tests"), err);
    return err->status;
}

/* ---- what the tests must have together ---- */

static sf_status check_together(const reader *r, sf_error *err) {
    const sf_compression_config *c = r->out;
    double shortest = 1;
    int below = 0;
    for (int k = 0; k < c->test_count; k++)
        shortest = fmin(shortest, c->test[k].largest_strain);
    if (c->densification_start > 0.97 * shortest)
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "%s: densification_start = %g leaves no data to fit the densification to: the tests reach "
            "a strain of %g",
            r->path, c->densification_start, shortest);
    for (int i = 0; i < c->test[0].loading; i++)
        below += c->test[0].strain[i] <= c->modulus_range;
    if (below < 4)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s: %d points below the strain %g (E_range) while loading; E needs at least 4",
                       c->test[0].path, below, c->modulus_range);
    if (c->test_count == 1 && c->rate_model != SF_RATE_AUTO && c->rate_model != SF_RATE_NONE)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s: the rate model \"%s\" needs tests at two rates; there is one test", r->path,
                       sf_rate_model_name(c->rate_model));
    return SF_OK;
}

static sf_status load(reader *r, config_t *file, sf_error *err) {
    struct stat info;
    if (stat(r->path, &info) != 0)
        return SF_FAIL(err, SF_ERR_INPUT, "%s cannot be read: %s", r->path, strerror(errno));
    if (!S_ISREG(info.st_mode))
        return SF_FAIL(err, SF_ERR_INPUT, "%s is not a plain file", r->path);
    if (config_read_file(file, r->path) != CONFIG_TRUE)
        return SF_FAIL(err, SF_ERR_INPUT, "%s:%d: %s", r->path, config_error_line(file),
                       config_error_text(file));
    if (read_root(r, config_root_setting(file), err) != SF_OK)
        return err->status;
    return check_together(r, err);
}

sf_status sf_compression_config_read(const char *path, sf_compression_config *config, sf_error *err) {
    *config = (sf_compression_config){.name = "foam",
                                      .modulus_range = 0.02,
                                      .confidence = 0.95,
                                      .rate_model = SF_RATE_AUTO,
                                      .rule = SF_RULE_AUTO};
    reader r = {.path = path, .out = config};
    config_t file;
    config_init(&file);
    if (sf_units_open(&r.units, err) == SF_OK)
        load(&r, &file, err);
    sf_units_close(&r.units);
    config_destroy(&file);
    if (err->status != SF_OK)
        sf_compression_config_free(config);
    return err->status;
}

void sf_compression_config_free(sf_compression_config *config) {
    for (int k = 0; k < config->test_count; k++)
        sf_compression_test_free(&config->test[k]);
    *config = (sf_compression_config){0};
}
