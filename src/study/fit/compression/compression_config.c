/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/compression/compression_config.h"

#include <math.h>
#include <string.h>

const char *const sf_rate_model_names[] = {"none", "log", "maxwell", "curves", "auto"};
/* In the order of sf_rate_model and sf_rule_choice. */
static const char RATE_WORDS[] = "none|log|maxwell|curves|auto", RULE_WORDS[] = "auto|H1|H1_automatic|H2";

static const double PI = 3.14159265358979323846;

/* Replaces the default of the tests, if the group is there. */
static sf_status read_specimen(const sf_config *file, sf_config_item *parent,
                               sf_compression_specimen *specimen, sf_error *err) {
    sf_config_item *group = config_setting_get_member(parent, "specimen");
    sf_compression_specimen s = {0};
    if (!group)
        return SF_OK;
    if (!config_setting_is_group(group))
        return sf_config_refuse(file, group, err,
                                "specimen must be a group { side = \"50 mm\"; thickness = \"50 mm\"; }");
    SF_TRY(sf_config_names(file, group, "side|width|diameter|area|thickness", err));
    SF_TRY(sf_config_quantity(file, group, "side", SF_LENGTH, false, 0, &s.side, err));
    SF_TRY(sf_config_quantity(file, group, "width", SF_LENGTH, false, 0, &s.width, err));
    SF_TRY(sf_config_quantity(file, group, "diameter", SF_LENGTH, false, 0, &s.diameter, err));
    SF_TRY(sf_config_quantity(file, group, "area", SF_AREA, false, 0, &s.area, err));
    SF_TRY(sf_config_quantity(file, group, "thickness", SF_LENGTH, false, 0, &s.thickness, err));
    if ((s.side > 0) + (s.diameter > 0) + (s.area > 0) > 1 || (s.width > 0 && !(s.side > 0)))
        return sf_config_refuse(
            file, group, err, "specimen: give side (with width, if the face is no square), diameter or area");
    if (s.side > 0)
        s.area = s.side * (s.width > 0 ? s.width : s.side);
    if (s.diameter > 0)
        s.area = PI / 4 * s.diameter * s.diameter;
    *specimen = s;
    return SF_OK;
}

/* ---- tests ---- */

static sf_status check_rate(const sf_config *file, sf_config_item *entry, double rate,
                            const sf_compression_config *c, sf_error *err) {
    for (int k = 0; k < c->test_count; k++)
        if (fabs(log(rate / c->test[k].rate)) < 1e-6)
            return sf_config_refuse(file, config_setting_get_member(entry, "rate"), err,
                                    "the rate %g 1/s is that of %s already; give each rate once (join the "
                                    "tests or take their mean)",
                                    rate, c->test[k].path);
    return SF_OK;
}

/* The same points under another rate would say that the rate has no effect. */
static sf_status check_points(const sf_config *file, sf_config_item *entry, const sf_compression_test *test,
                              const sf_compression_config *c, sf_error *err) {
    for (int k = 0; k < c->test_count; k++) {
        const sf_compression_test *earlier = &c->test[k];
        size_t size = (size_t)test->count * sizeof *test->strain;
        if (earlier->count == test->count && memcmp(earlier->strain, test->strain, size) == 0 &&
            memcmp(earlier->stress, test->stress, size) == 0)
            return sf_config_refuse(file, config_setting_get_member(entry, "file"), err,
                                    "the points of %s are those of %s, which has another rate: give the same "
                                    "data once",
                                    test->path, earlier->path);
    }
    return SF_OK;
}

/* Puts the test in its place by rate. */
static void insert_test(sf_compression_test *tests, int *count, const sf_compression_test *test) {
    int at = (*count)++;
    for (; at > 0 && tests[at - 1].rate > test->rate; at--)
        tests[at] = tests[at - 1];
    tests[at] = *test;
}

/* A strain rate, or the crosshead's speed over the thickness. */
static sf_status read_rate(const sf_config *file, sf_config_item *entry, double thickness, double *rate,
                           sf_error *err) {
    sf_config_item *setting = config_setting_get_member(entry, "rate");
    const char *text = setting ? config_setting_get_string(setting) : NULL;
    sf_error no_speed = SF_ERROR_INIT;
    double speed = 0;
    if (!text || sf_units_parse(file->units, text, SF_SPEED, &speed, &no_speed) != SF_OK)
        return sf_config_quantity(file, entry, "rate", SF_RATE, true, 0, rate, err);
    if (!(speed > 0))
        return sf_config_refuse(file, setting, err, "rate is %s; the speed must be above 0", text);
    if (!(thickness > 0))
        return sf_config_refuse(
            file, setting, err,
            "rate is a speed (%s): give the specimen's thickness, for example specimen = { "
            "thickness = \"50 mm\"; }",
            text);
    *rate = speed / thickness;
    return SF_OK;
}

sf_status sf_compression_source_read(const sf_config *file, sf_config_item *entry,
                                     sf_compression_specimen specimen, sf_compression_source *source,
                                     sf_error *err) {
    int invert = SF_INVERT_NONE;
    SF_TRY(read_specimen(file, entry, &specimen, err));
    SF_TRY(read_rate(file, entry, specimen.thickness, &source->rate, err));
    SF_TRY(sf_config_flag(file, entry, "toe_correction", &source->toe, err));
    SF_TRY(sf_config_choice(file, entry, "invert", "none|strain|stress|both", &invert, err));
    SF_TRY(sf_config_quantity(file, entry, "contact_force", SF_FORCE, false, 0, &source->contact_force, err));
    SF_TRY(sf_config_text(file, entry, "specimen_number", false, &source->specimen, err));
    SF_TRY(sf_config_text(file, entry, "cycle", false, &source->cycle, err));
    SF_TRY(sf_config_text(file, entry, "heading", false, &source->heading, err));
    if (source->contact_force > 0 && !(specimen.area > 0))
        return sf_config_refuse(file, config_setting_get_member(entry, "contact_force"), err,
                                "contact_force is given: the test must have force and displacement of a "
                                "specimen with an area");
    source->invert = (sf_inversion)invert;
    source->area = specimen.area;
    source->thickness = specimen.thickness;
    return SF_OK;
}

/* Into the tests that are fitted, each rate once, or those that are predicted. */
static sf_status read_test(const sf_config *file, sf_config_item *entry, bool predicted,
                           sf_compression_config *c, sf_error *err) {
    sf_compression_test test;
    sf_error inner = SF_ERROR_INIT;
    SF_OWNED char *path = NULL;
    sf_compression_source source = {.toe = c->toe};
    if (sf_config_names(file, entry, "file|" SF_COMPRESSION_SOURCE_KEYS, err) == SF_OK &&
        sf_compression_source_read(file, entry, c->specimen, &source, err) == SF_OK &&
        (predicted || check_rate(file, entry, source.rate, c, err) == SF_OK) &&
        sf_config_file(file, entry, "file", true, &path, err) == SF_OK) {
        source.path = path;
        if (sf_compression_test_read(&source, &test, &inner) != SF_OK)
            SF_FAIL(err, inner.status, "%s (named at %s:%u)", inner.text, file->path,
                    config_setting_source_line(entry));
        else if (predicted)
            insert_test(c->predicted, &c->predicted_count, &test);
        else if (check_points(file, entry, &test, c, err) == SF_OK)
            insert_test(c->test, &c->test_count, &test);
        else
            sf_compression_test_free(&test);
    }
    return err->status;
}

static sf_status read_tests(const sf_config *file, sf_config_item *root, const char *name, bool predicted,
                            sf_compression_config *c, sf_error *err) {
    sf_config_item *tests;
    SF_TRY(sf_config_list(file, root, name, !predicted, SF_COMPRESSION_TESTS, &tests, err));
    for (int i = 0; tests && i < config_setting_length(tests) && err->status == SF_OK; i++)
        read_test(file, config_setting_get_elem(tests, (unsigned)i), predicted, c, err);
    return err->status;
}

/* ---- the file ---- */

static sf_status read_name(const sf_config *file, sf_config_item *root, sf_compression_config *c,
                           sf_error *err) {
    const char *text = c->name;
    if (sf_config_text(file, root, "name", false, &text, err) != SF_OK || text == c->name)
        return err->status;
    if (strlen(text) >= SF_COMPRESSION_NAME || strpbrk(text, "\n\r'\\"))
        return sf_config_refuse(file, config_setting_get_member(root, "name"), err,
                                "name must be a text of 1 to %d characters, without ', \\ and line ends",
                                SF_COMPRESSION_NAME - 1);
    snprintf(c->name, sizeof c->name, "%s", text);
    return SF_OK;
}

static sf_status read_root(const sf_config *file, sf_compression_config *c, sf_error *err) {
    sf_config_item *root = config_root_setting(&file->config);
    int model = SF_RATE_AUTO, rule = SF_RULE_AUTO;
    bool form, hyperfoam;
    SF_TRY(sf_hyperfoam_request_asked(file, root, &hyperfoam, err));
    if (!hyperfoam)
        SF_TRY(sf_form_request_asked(file, root, &form, err));
    SF_TRY(sf_config_names(
        file, root,
        hyperfoam ? SF_HYPERFOAM_REQUEST_KEYS
        : form    ? "law|name|density|tests|DAMP|E_range|specimen|toe_correction|cycles|" SF_FORM_REQUEST_KEYS
                  : "law|name|density|tests|DAMP|E_range|rate_model|densification|densification_start|"
                    "confidence|specimen|toe_correction|curve_form",
        err));
    SF_TRY(sf_config_quantity(file, root, "density", SF_DENSITY, true, 0, &c->density, err));
    SF_TRY(read_name(file, root, c, err));
    SF_TRY(sf_config_number(file, root, "DAMP", false, 0, 10, &c->damp, err));
    if (hyperfoam) {
        sf_hyperfoam_request_read(file, root, &c->hyperfoam, &c->test[0], err);
        c->test_count = 1;
        return err->status;
    }
    SF_TRY(sf_config_number(file, root, "E_range", false, 0.001, 0.2, &c->modulus_range, err));
    SF_TRY(sf_config_number(file, root, "confidence", false, 0.5, 0.9999, &c->confidence, err));
    SF_TRY(
        sf_config_number(file, root, "densification_start", false, 0.05, 0.98, &c->densification_start, err));
    if (!form)
        SF_TRY(sf_config_choice(file, root, "rate_model", RATE_WORDS, &model, err));
    SF_TRY(sf_config_choice(file, root, "densification", RULE_WORDS, &rule, err));
    SF_TRY(sf_config_flag(file, root, "toe_correction", &c->toe, err));
    SF_TRY(read_specimen(file, root, &c->specimen, err));
    c->rate_model = (sf_rate_model)model;
    c->rule = (sf_rule_choice)rule;
    SF_TRY(read_tests(file, root, "tests", false, c, err));
    if (!form)
        return SF_OK;
    SF_TRY(read_tests(file, root, "predict", true, c, err));
    SF_TRY(sf_cycle_record_read(file, root, &c->cycles, err));
    return sf_form_request_read(file, root, c, err);
}

/* ---- requirements on all tests together ---- */

/* The tests stand in ascending rate. A test that is softer than one at a lower rate, on the mean of its
 * plateau, has the other's rate, or both are of different foams: no rate dependence of the laws can be so. */
static sf_status check_order_of_rates(const sf_compression_config *c, sf_error *err) {
    enum { PLACES = 32 };
    static const double FIRST = 0.1, LAST = 0.9; /* of the common range of strain */
    static const double SOFTER = 0.05;           /* more than specimens of one block scatter */
    for (int k = 1; k < c->test_count; k++) {
        const sf_compression_test *slow = &c->test[k - 1], *fast = &c->test[k];
        double end = fmin(slow->largest_strain, fast->largest_strain), sum = 0;
        for (int i = 0; i < PLACES; i++) {
            double strain = end * (FIRST + (LAST - FIRST) * i / (PLACES - 1));
            sum += log(fmax(sf_compression_loading_stress(fast, strain), 1e-9) /
                       fmax(sf_compression_loading_stress(slow, strain), 1e-9));
        }
        double softer = -expm1(sum / PLACES);
        if (fast->rate > slow->rate && softer > SOFTER)
            return SF_REFUSE(
                err,
                "%s at %g 1/s is softer than %s at %g 1/s, by %.3g %% on the mean over its loading: are "
                "the rates exchanged? The stress of a foam does not fall with the rate",
                fast->path, fast->rate, slow->path, slow->rate, 100 * softer);
    }
    return SF_OK;
}

static sf_status check_together(const char *path, const sf_compression_config *c, sf_error *err) {
    double shortest = 1;
    int below = 0;
    SF_TRY(check_order_of_rates(c, err));
    if (c->form.form.curve || c->hyperfoam.terms > 0)
        return SF_OK; /* these need nothing of the tests together */
    for (int k = 0; k < c->test_count; k++)
        shortest = fmin(shortest, c->test[k].largest_strain);
    if (c->densification_start > 0.97 * shortest)
        return SF_REFUSE(err,
                         "%s: densification_start = %g leaves no data to fit the densification to: the tests "
                         "reach a strain of %g",
                         path, c->densification_start, shortest);
    for (int i = 0; i < c->test[0].loading; i++)
        below += c->test[0].strain[i] <= c->modulus_range;
    if (below < 4)
        return SF_REFUSE(err, "%s: %d points below the strain %g (E_range) while loading; E needs at least 4",
                         c->test[0].path, below, c->modulus_range);
    if (c->test_count == 1 && c->rate_model != SF_RATE_AUTO && c->rate_model != SF_RATE_NONE)
        return SF_REFUSE(err, "%s: the rate model \"%s\" needs tests at two rates; there is one test", path,
                         sf_rate_model_names[c->rate_model]);
    return SF_OK;
}

sf_status sf_compression_config_read(const char *path, sf_compression_config *config, sf_error *err) {
    SF_OWNED_BY(sf_config_close) sf_config file = {0};
    *config = (sf_compression_config){.name = "foam",
                                      .modulus_range = 0.02,
                                      .confidence = 0.95,
                                      .rate_model = SF_RATE_AUTO,
                                      .rule = SF_RULE_AUTO};
    if (sf_config_open(path, &file, err) == SF_OK && read_root(&file, config, err) == SF_OK)
        check_together(path, config, err);
    if (err->status != SF_OK)
        sf_compression_config_free(config);
    return err->status;
}

void sf_compression_config_free(sf_compression_config *config) {
    sf_hyperfoam_request_free(&config->hyperfoam);
    sf_cycle_record_free(&config->cycles);
    for (int k = 0; k < config->test_count; k++)
        sf_compression_test_free(&config->test[k]);
    for (int k = 0; k < config->predicted_count; k++)
        sf_compression_test_free(&config->predicted[k]);
    *config = (sf_compression_config){0};
}
