/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/compression/compression_config.h"

#include <math.h>
#include <string.h>

const char *const sf_rate_model_names[] = {"none", "log", "maxwell", "curves", "auto"};
/* In the order of sf_rate_model and sf_rule_choice. */
static const char RATE_WORDS[] = "none|log|maxwell|curves|auto", RULE_WORDS[] = "auto|H1|H1_automatic|H2";

/* ---- specimen and tests ---- */

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
    SF_TRY(sf_config_quantity(file, group, "side", SF_LENGTH, false, &s.side, err));
    SF_TRY(sf_config_quantity(file, group, "width", SF_LENGTH, false, &s.width, err));
    SF_TRY(sf_config_quantity(file, group, "diameter", SF_LENGTH, false, &s.diameter, err));
    SF_TRY(sf_config_quantity(file, group, "area", SF_AREA, false, &s.area, err));
    SF_TRY(sf_config_quantity(file, group, "thickness", SF_LENGTH, false, &s.thickness, err));
    if ((s.side > 0) + (s.diameter > 0) + (s.area > 0) > 1 || (s.width > 0 && !(s.side > 0)))
        return sf_config_refuse(
            file, group, err, "specimen: give side (with width, if the face is no square), diameter or area");
    if (s.side > 0)
        s.area = s.side * (s.width > 0 ? s.width : s.side);
    if (s.diameter > 0)
        s.area = M_PI / 4 * s.diameter * s.diameter;
    *specimen = s;
    return SF_OK;
}

/* Tests differ in rate or, all of them, in temperature. */
static sf_status check_rate(const sf_config *file, sf_config_item *entry, double rate, double temperature,
                            const sf_compression_config *c, sf_error *err) {
    for (int k = 0; k < c->test_count; k++)
        if (!(temperature > 0) != !(c->test[k].temperature > 0))
            return sf_config_refuse(
                file, entry, err,
                "one of the tests has a temperature, another has none: give it to all or to none");
        else if (temperature > 0 && (fabs(temperature - c->test[k].temperature) < 0.1 ||
                                     fabs(log(rate / c->test[k].rate)) > 0.01))
            return sf_config_refuse(file, entry, err,
                                    "%.4g degC at %g 1/s beside %.4g degC at %g 1/s (%s): tests at "
                                    "temperatures have each its own, and all the same rate",
                                    temperature - SF_CELSIUS, rate, c->test[k].temperature - SF_CELSIUS,
                                    c->test[k].rate, c->test[k].path);
        else if (!(temperature > 0) && fabs(log(rate / c->test[k].rate)) < 1e-6)
            return sf_config_refuse(file, config_setting_get_member(entry, "rate"), err,
                                    "the rate %g 1/s is that of %s already; give each rate once (join the "
                                    "tests or take their mean)",
                                    rate, c->test[k].path);
    return SF_OK;
}

/* The same points under another rate would say that the rate has no effect, under one rate that nothing
 * scatters. */
static sf_status check_points(const sf_config *file, sf_config_item *entry, const sf_compression_test *test,
                              const sf_compression_config *c, sf_error *err) {
    for (int k = 0; k < c->test_count; k++) {
        const sf_compression_test *earlier = &c->test[k];
        size_t size = (size_t)test->count * sizeof *test->strain;
        if (earlier->count == test->count && memcmp(earlier->strain, test->strain, size) == 0 &&
            memcmp(earlier->stress, test->stress, size) == 0)
            return sf_config_refuse(file, config_setting_get_member(entry, "file"), err,
                                    "the points of %s are those of %s: give the same data once", test->path,
                                    earlier->path);
    }
    return SF_OK;
}

/* Puts the test in its place by temperature and rate. */
static void insert_test(sf_compression_test *tests, int *count, const sf_compression_test *test) {
    int at = (*count)++;
    for (; at > 0 && (tests[at - 1].temperature > test->temperature ||
                      (tests[at - 1].temperature == test->temperature && tests[at - 1].rate > test->rate));
         at--)
        tests[at] = tests[at - 1];
    tests[at] = *test;
}

/* A strain rate, or the crosshead's speed over the thickness. */
static sf_status read_rate(const sf_config *file, sf_config_item *entry, double thickness, double *rate,
                           sf_error *err) {
    sf_config_item *setting = config_setting_get_member(entry, "rate");
    const char *text = setting ? config_setting_get_string(setting) : NULL;
    double speed = 0;
    if (!text || sf_units_parse(file->units, text, SF_SPEED, &speed, SF_IGNORED) != SF_OK)
        return sf_config_quantity(file, entry, "rate", SF_RATE, true, rate, err);
    if (!(speed > 0))
        return sf_config_refuse(file, setting, err, "rate: a speed of %s" SF_NOT_ABOVE_0, text);
    if (!(thickness > 0))
        return sf_config_refuse(file, setting, err,
                                "rate is a speed (%s): give the specimen's thickness, for example specimen = "
                                "{ thickness = \"50 mm\"; }",
                                text);
    *rate = speed / thickness;
    return SF_OK;
}

/* Reads the keys of a test beside its file and temperature; `specimen` and `source->toe` are those of tests
 * without their own. */
static sf_status read_source(const sf_config *file, sf_config_item *entry, sf_compression_specimen specimen,
                             sf_compression_source *source, sf_error *err) {
    int invert = SF_INVERT_NONE;
    SF_TRY(read_specimen(file, entry, &specimen, err));
    SF_TRY(read_rate(file, entry, specimen.thickness, &source->rate, err));
    SF_TRY(sf_config_flag(file, entry, "toe_correction", &source->toe, err));
    SF_TRY(sf_config_choice(file, entry, "invert", "none|strain|stress|both", &invert, err));
    SF_TRY(sf_config_quantity(file, entry, "contact_force", SF_FORCE, false, &source->contact_force, err));
    SF_TRY(sf_config_text(file, entry, "cycle", false, &source->cycle, err));
    if (source->contact_force > 0 && !(specimen.area > 0))
        return sf_config_refuse(file, config_setting_get_member(entry, "contact_force"), err,
                                "contact_force is given: the test must have force and displacement of a "
                                "specimen with an area");
    source->invert = (sf_inversion)invert;
    source->area = specimen.area;
    source->thickness = specimen.thickness;
    return SF_OK;
}

static sf_status read_test(const sf_config *file, sf_config_item *entry, sf_compression_config *c,
                           sf_error *err) {
    SF_OWNED_BY(sf_compression_test_free) sf_compression_test test = {0};
    sf_error inner = SF_ERROR_INIT;
    SF_OWNED char *path = NULL;
    sf_compression_source source = {.toe = c->toe};
    double temperature = 0;
    SF_TRY(sf_config_names(file, entry,
                           "file|temperature|rate|specimen|cycle|contact_force|toe_correction|invert", err));
    SF_TRY(sf_config_quantity(file, entry, "temperature", SF_TEMPERATURE, false, &temperature, err));
    SF_TRY(read_source(file, entry, c->specimen, &source, err));
    SF_TRY(check_rate(file, entry, source.rate, temperature, c, err));
    SF_TRY(sf_config_file(file, entry, "file", true, &path, err));
    source.path = path;
    if (sf_compression_test_read(&source, &test, &inner) != SF_OK)
        return SF_FAIL(err, inner.status, "%s (named at %s:%u)", inner.text, file->path,
                       config_setting_source_line(entry));
    if (temperature > 0 && !(temperature >= 100 && temperature <= 600)) /* as pad.temperature */
        return sf_config_refuse(file, entry, err, "temperature" SF_OUTSIDE("%g K", "100", "600 K"),
                                temperature);
    test.temperature = temperature;
    SF_TRY(check_points(file, entry, &test, c, err));
    insert_test(c->test, &c->test_count, &test);
    test = (sf_compression_test){0};
    return SF_OK;
}

static sf_status read_tests(const sf_config *file, sf_config_item *root, sf_compression_config *c,
                            sf_error *err) {
    sf_config_item *tests;
    SF_TRY(sf_config_list(file, root, "tests", true, SF_COMPRESSION_TESTS, &tests, err));
    for (int i = 0; i < config_setting_length(tests) && err->status == SF_OK; i++)
        read_test(file, config_setting_get_elem(tests, (unsigned)i), c, err);
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

/* Tests at temperatures have a curve each, as those at rates where `rate_model` is "curves". */
static sf_status take_temperatures(const sf_config *file, sf_config_item *root, sf_compression_config *c,
                                   sf_error *err) {
    static const double USUAL = SF_CELSIUS + 23;
    c->thermal = c->test[0].temperature > 0;
    if (!c->thermal)
        return SF_OK;
    if (c->test_count == 1 || c->rate_model != SF_RATE_AUTO)
        return sf_config_refuse(
            file, config_setting_get_member(root, c->test_count == 1 ? "tests" : "rate_model"), err,
            c->test_count == 1 ? "one test has a temperature: a material needs curves at two or more"
                               : "rate_model is for tests at several rates, and these have "
                                 "temperatures");
    c->rate_model = SF_RATE_CURVES;
    for (int k = 1; k < c->test_count; k++)
        if (fabs(c->test[k].temperature - USUAL) < fabs(c->test[c->middle].temperature - USUAL))
            c->middle = k;
    return SF_OK;
}

/* Refuses the kinds of fits that the command softfall does. */
static sf_status check_kind(const sf_config *file, sf_config_item *root, sf_error *err) {
    static const char *const usual[][2] = {{"curve_form", "free"}, {"law", "low_density_foam"}};
    for (int k = 0; k < 2; k++) {
        const char *word = usual[k][1];
        SF_TRY(sf_config_text(file, root, usual[k][0], false, &word, err));
        if (strcmp(word, usual[k][1]) != 0)
            return sf_config_refuse(file, config_setting_get_member(root, usual[k][0]), err,
                                    "%s = \"%.80s\": this program fits a free curve; for forms, cycles and "
                                    "hyperfoams use softfall fit compression %s -o DIR",
                                    usual[k][0], word, file->path);
    }
    return SF_OK;
}

static sf_status read_root(const sf_config *file, sf_compression_config *c, sf_error *err) {
    sf_config_item *root = config_root_setting(&file->config);
    int model = SF_RATE_AUTO, rule = SF_RULE_AUTO;
    SF_TRY(check_kind(file, root, err));
    SF_TRY(sf_config_names(file, root,
                           "law|name|density|tests|DAMP|E_range|rate_model|densification|densification_start|"
                           "confidence|specimen|toe_correction|curve_form",
                           err));
    SF_TRY(sf_config_quantity(file, root, "density", SF_DENSITY, true, &c->density, err));
    SF_TRY(read_name(file, root, c, err));
    SF_TRY(sf_config_number(file, root, "DAMP", 0, 10, &c->damp, err));
    SF_TRY(sf_config_number(file, root, "E_range", 0.001, 0.2, &c->modulus_range, err));
    SF_TRY(sf_config_number(file, root, "confidence", 0.5, 0.9999, &c->confidence, err));
    SF_TRY(sf_config_number(file, root, "densification_start", 0.05, 0.98, &c->densification_start, err));
    SF_TRY(sf_config_choice(file, root, "rate_model", RATE_WORDS, &model, err));
    SF_TRY(sf_config_choice(file, root, "densification", RULE_WORDS, &rule, err));
    SF_TRY(sf_config_flag(file, root, "toe_correction", &c->toe, err));
    SF_TRY(read_specimen(file, root, &c->specimen, err));
    c->rate_model = (sf_rate_model)model;
    c->rule = (sf_rule_choice)rule;
    SF_TRY(read_tests(file, root, c, err));
    return take_temperatures(file, root, c, err);
}

/* ---- requirements on all tests together ---- */

/* The tests stand in ascending rate. A test that is softer than one at a lower rate, on the mean of its
 * plateau, has the other's rate, or both are of different foams: no rate dependence of the laws can be so. */
static sf_status check_order_of_rates(const sf_compression_config *c, sf_error *err) {
    enum { PLACES = 32 };
    static const double FIRST = 0.1, LAST = 0.9; /* of the common range of strain */
    static const double SOFTER = 0.05;           /* more than specimens of one block scatter */
    if (c->thermal)                              /* their rates are alike, and a warmer one is softer */
        return SF_OK;
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
            return SF_REFUSE(err,
                             "%s at %g 1/s is softer than %s at %g 1/s, by %.3g %% on the mean over its "
                             "loading: are the rates exchanged? The stress of a foam does not fall with the "
                             "rate",
                             fast->path, fast->rate, slow->path, slow->rate, 100 * softer);
    }
    return SF_OK;
}

static sf_status check_together(const char *path, const sf_compression_config *c, sf_error *err) {
    double shortest = 1;
    int below = 0;
    SF_TRY(check_order_of_rates(c, err));
    for (int k = 0; k < c->test_count; k++)
        shortest = fmin(shortest, c->test[k].largest_strain);
    if (c->densification_start > 0.97 * shortest)
        return SF_REFUSE(err,
                         "%s: densification_start = %g leaves no data to fit the densification to: the tests "
                         "reach a strain of %g",
                         path, c->densification_start, shortest);
    for (int i = 0; i < c->test[c->middle].loading; i++)
        below += c->test[c->middle].strain[i] <= c->modulus_range;
    if (below < 4)
        return SF_REFUSE(err, "%s: %d points below the strain %g (E_range) while loading" SF_AT_LEAST("4"),
                         c->test[c->middle].path, below, c->modulus_range);
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
    for (int k = 0; k < config->test_count; k++)
        sf_compression_test_free(&config->test[k]);
    *config = (sf_compression_config){0};
}
