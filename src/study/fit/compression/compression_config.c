/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/compression/compression_config.h"

const char *const sf_rate_model_names[] = {"none", "log", "maxwell", "curves", "auto"};
/* In the order of sf_rate_model and sf_rule_choice. */
static const char RATE_WORDS[] = "none|log|maxwell|curves|auto", RULE_WORDS[] = "auto|H1|H1_automatic|H2";

/* ---- a form of the loading curve ---- */

static const char FREE_FORM[] = "free";
enum { SLOPE_POINTS = 4 }; /* of the slope that E begins with */

/* A material with a rate factor: its filter of the rate is short beside an impact and costs no time step, and
 * little damping is enough (ADR 20). */
static const double FILTER_TIME = 1e-4, FACTOR_FILTER_TIME = 5e-4; /* s */
static const double FACTOR_DAMP = 0.05;

/* True if the file names a form other than "free". */
static sf_status is_form_asked(const sf_config *file, sf_config_item *root, bool *asked, sf_error *err) {
    const char *name = FREE_FORM;
    SF_TRY(sf_config_text(file, root, "curve_form", false, &name, err));
    const sf_curve_form *form = sf_curve_form_find(name);
    *asked = strcmp(name, FREE_FORM) != 0;
    if (*asked && (!form || !form->stress))
        return sf_config_refuse(file, config_setting_get_member(root, "curve_form"), err,
                                "curve_form is \"%.80s\"; expected free or one of %s, but not table", name,
                                sf_curve_form_words());
    return SF_OK;
}

/* Slope through the origin of the first points of loading. */
static double first_slope(const sf_compression_test *t, double range) {
    double top = 0, bottom = 0;
    for (int i = 0, used = 0; i < t->loading && (used < SLOPE_POINTS || t->strain[i] <= range); i++) {
        used += t->strain[i] > 0;
        top += t->strain[i] * t->stress[i];
        bottom += t->strain[i] * t->strain[i];
    }
    return fmax(1e3, top / bottom);
}

static bool is_of_curve(const sf_form_request *r, sf_foam_parameter p) {
    return p < SF_PARAMETER_COUNT &&
           (p == SF_PARAMETER_E || p == SF_PARAMETER_LOCKED || sf_curve_form_entry(r->form.curve, p));
}

/* A value of the rate that the rate model does not have would be lost, or act where none is asked for. */
static sf_status check_rate_value(const sf_config *file, sf_config_item *item, sf_foam_parameter p,
                                  const sf_form_request *r, sf_error *err) {
    sf_form_rate term = sf_form_rate_of(p);
    if ((r->rate & term) != term)
        return sf_config_refuse(file, item, err,
                                "%s is given, but rate_model = \"%s\" has none: give rate_model = \"%s\" "
                                "or \"both\", or leave it out",
                                sf_parameter_get(p)->name, sf_form_rate_names[r->rate],
                                sf_form_rate_names[term]);
    return SF_OK;
}

static sf_status read_value(const sf_config *file, sf_config_item *group, sf_config_item *item,
                            sf_form_request *r, sf_error *err) {
    const char *name = config_setting_name(item);
    sf_foam_parameter p = sf_parameter_find(name);
    if (!is_of_curve(r, p) && (p == SF_PARAMETER_RATE_REFERENCE || !sf_form_rate_of(p)))
        return sf_config_refuse(file, item, err,
                                "start: \"%.80s\" is neither E, a parameter of curve_form = \"%s\", nor "
                                "rate_factor, ED or BETA1",
                                name, r->form.curve->name);
    SF_TRY(check_rate_value(file, item, p, r, err));
    return sf_parameter_read(file, group, p, &r->start[p], err);
}

static sf_status read_start(const sf_config *file, sf_config_item *root, sf_form_request *r, sf_error *err) {
    sf_config_item *group = config_setting_get_member(root, "start");
    if (group && !config_setting_is_group(group))
        return sf_config_refuse(file, group, err, "start must be a group: start = { p0 = \"101 kPa\"; }");
    for (int k = 0; group && k < config_setting_length(group); k++)
        SF_TRY(read_value(file, group, config_setting_get_elem(group, (unsigned)k), r, err));
    return SF_OK;
}

static void add_unknown(sf_form_request *r, sf_foam_parameter p) {
    for (int k = 0; k < r->unknown_count; k++)
        if (r->unknown[k] == p)
            return;
    r->unknown[r->unknown_count++] = p;
}

/* Reads the unknowns of the curve; unloading and rate have keys of their own. */
static sf_status read_unknowns(const sf_config *file, sf_config_item *root, sf_form_request *r,
                               sf_error *err) {
    sf_config_item *list = config_setting_get_member(root, "unknown");
    if (list && !config_setting_is_array(list) && !config_setting_is_list(list))
        return sf_config_refuse(file, list, err, "unknown must be a list: unknown = ( \"E\", \"s0\" )");
    if (list && config_setting_length(list) > SF_FORM_UNKNOWNS - 4)
        return sf_config_refuse(file, list, err, "unknown has %d entries" SF_AT_MOST("%d"),
                                config_setting_length(list), SF_FORM_UNKNOWNS - 4);
    for (int k = 0; list && k < config_setting_length(list); k++) {
        const char *name = config_setting_get_string_elem(list, k);
        sf_foam_parameter p = name ? sf_parameter_find(name) : SF_PARAMETER_COUNT;
        if (!is_of_curve(r, p))
            return sf_config_refuse(file, list, err,
                                    "unknown: \"%.80s\" is neither E nor a parameter of curve_form = \"%s\"",
                                    name ? name : "(no text)", r->form.curve->name);
        if (p == SF_PARAMETER_LOCKED)
            sf_foam_form_start_lock(r->start);
        add_unknown(r, p);
    }
    if (!list)
        add_unknown(r, SF_PARAMETER_E);
    for (int k = 0; !list && k < r->form.curve->entry_count; k++)
        if (r->form.curve->entry[k].usual)
            add_unknown(r, r->form.curve->entry[k].parameter);
    return SF_OK;
}

/* At its pole the curve is infinite: no test can get there. */
static sf_status check_pole(const sf_config *file, sf_config_item *root, int test_count,
                            const sf_compression_test *test, const sf_form_request *r, sf_error *err) {
    double pole = sf_curve_form_pole(r->form.curve, r->start);
    for (int k = 0; k < test_count; k++)
        if (!(test[k].largest_strain < pole))
            return sf_config_refuse(
                file, config_setting_get_member(root, "curve_form"), err,
                "%s reaches a strain of %.3g, but with solid_fraction = %.3g%s the curve of "
                "curve_form = \"%s\" ends at %.3g: it is too large",
                test[k].path, test[k].largest_strain, r->start[SF_PARAMETER_SOLID_FRACTION],
                r->start[SF_PARAMETER_LOCKED] > 0 ? " and locked_fraction" : "", r->form.curve->name, pole);
    return SF_OK;
}

/* The rate up to which the curve holds as it is: below the fastest test, or the factor would be 1 in all. */
static sf_status read_reference(const sf_config *file, sf_config_item *root, sf_compression_config *c,
                                sf_error *err) {
    sf_form_request *r = &c->form;
    const sf_parameter_info *about = sf_parameter_get(SF_PARAMETER_RATE_REFERENCE);
    sf_config_item *given = config_setting_get_member(root, about->name);
    double *reference = &r->start[SF_PARAMETER_RATE_REFERENCE], fastest = c->test[c->test_count - 1].rate;
    *reference = c->test[0].rate;
    if (!given)
        return SF_OK;
    SF_TRY(check_rate_value(file, given, SF_PARAMETER_RATE_REFERENCE, r, err));
    SF_TRY(sf_config_quantity(file, root, about->name, SF_RATE, false, about->low, reference, err));
    if (!(*reference < fastest))
        return sf_config_refuse(file, given, err,
                                "rate_reference is %g 1/s, but the fastest test has %g 1/s: the rate factor "
                                "would be 1 in every test; give a rate below it, or leave it out",
                                *reference, fastest);
    return SF_OK;
}

static sf_status read_form_rate(const sf_config *file, sf_config_item *root, sf_compression_config *c,
                                sf_error *err) {
    sf_form_request *r = &c->form;
    int rate = SF_FORM_RATE_NONE;
    const sf_compression_test *slowest = &c->test[0], *fastest = &c->test[c->test_count - 1];
    SF_TRY(sf_config_choice(file, root, "rate_model", SF_FORM_RATE_WORDS, &rate, err));
    r->rate = (sf_form_rate)rate;
    bool factor = r->rate & SF_FORM_RATE_FACTOR, maxwell = r->rate & SF_FORM_RATE_MAXWELL;
    if (r->rate != SF_FORM_RATE_NONE && fastest->rate < slowest->rate * (1 + 1e-6))
        return sf_config_refuse(file, config_setting_get_member(root, "rate_model"), err,
                                "the rate model \"%s\" needs tests at two rates; there is one rate",
                                sf_form_rate_names[rate]);
    SF_TRY(read_reference(file, root, c, err));
    r->start[SF_PARAMETER_RATE_FACTOR] = 0;
    r->start[SF_PARAMETER_ED] = maxwell ? 0.1 * fastest->largest_stress : 0;
    r->start[SF_PARAMETER_BETA1] = maxwell ? sqrt(slowest->rate * fastest->rate) : 5000;
    if (factor) {
        sf_foam_form_start_rate(r->start);
        r->form.base.rate_filter_time = r->start[SF_PARAMETER_RATE_FILTER_TIME] = FACTOR_FILTER_TIME;
        if (!config_setting_get_member(root, "DAMP"))
            r->form.base.damp = r->start[SF_PARAMETER_DAMP] = FACTOR_DAMP;
        add_unknown(r, SF_PARAMETER_RATE_FACTOR);
    }
    if (maxwell) {
        add_unknown(r, SF_PARAMETER_ED);
        add_unknown(r, SF_PARAMETER_BETA1);
    }
    if (r->unknown_count == 0)
        return sf_config_refuse(file, config_setting_get_member(root, "unknown"), err,
                                "unknown is empty and rate_model is \"none\": there is nothing to fit");
    return SF_OK;
}

/* Reads the keys of a form; the tests and the numbers of all laws are there. E begins as the slope of the
 * slowest test's first points, up to modulus_range. */
static sf_status read_form(const sf_config *file, sf_config_item *root, sf_compression_config *c,
                           sf_error *err) {
    sf_form_request *r = &c->form;
    const char *name = NULL;
    SF_TRY(sf_config_text(file, root, "curve_form", true, &name, err));
    *r = (sf_form_request){.form = {.curve = sf_curve_form_find(name),
                                    .base = {.density = c->density,
                                             .modulus = first_slope(&c->test[0], c->modulus_range),
                                             .hysteresis_hu = 1,
                                             .hysteresis_shape = 1,
                                             .hysteresis_alpha = 1,
                                             .damp = c->damp,
                                             .maxwell_rate = 5000,
                                             .tension_cutoff = 1e30,
                                             .densification_limit = 1,
                                             .rate_filter_time = FILTER_TIME}}};
    SF_TRY(sf_foam_form_read_solid(file, root, &r->form, err));
    sf_foam_form_start(&r->form, r->start);
    SF_TRY(read_unknowns(file, root, r, err));
    SF_TRY(read_form_rate(file, root, c, err));
    SF_TRY(read_start(file, root, r, err));
    SF_TRY(sf_foam_form_check_fraction(file, root, root, "curve_form", &r->form, r->unknown_count, r->unknown,
                                       err));
    SF_TRY(check_pole(file, root, c->test_count, c->test, r, err));
    return check_pole(file, root, c->predicted_count, c->predicted, r, err);
}

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
        return sf_config_quantity(file, entry, "rate", SF_RATE, true, 0, rate, err);
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

sf_status sf_compression_source_read(const sf_config *file, sf_config_item *entry,
                                     sf_compression_specimen specimen, sf_compression_source *source,
                                     sf_error *err) {
    int invert = SF_INVERT_NONE;
    SF_TRY(read_specimen(file, entry, &specimen, err));
    SF_TRY(read_rate(file, entry, specimen.thickness, &source->rate, err));
    SF_TRY(sf_config_flag(file, entry, "toe_correction", &source->toe, err));
    SF_TRY(sf_config_choice(file, entry, "invert", "none|strain|stress|both", &invert, err));
    SF_TRY(sf_config_quantity(file, entry, "contact_force", SF_FORCE, false, 0, &source->contact_force, err));
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

/* Into the tests that are fitted, each rate once unless they are of several specimens, or those that are
 * predicted. */
static sf_status read_test(const sf_config *file, sf_config_item *entry, bool predicted,
                           sf_compression_config *c, sf_error *err) {
    SF_OWNED_BY(sf_compression_test_free) sf_compression_test test = {0};
    sf_error inner = SF_ERROR_INIT;
    SF_OWNED char *path = NULL;
    sf_compression_source source = {.toe = c->toe};
    double temperature = 0;
    const char *names =
        c->specimens ? "file|" SF_COMPRESSION_SOURCE_KEYS : "file|temperature|" SF_COMPRESSION_SOURCE_KEYS;
    SF_TRY(sf_config_names(file, entry, names, err));
    SF_TRY(sf_config_quantity(file, entry, "temperature", SF_TEMPERATURE, false, 0, &temperature, err));
    SF_TRY(sf_compression_source_read(file, entry, c->specimen, &source, err));
    if (!c->specimens)
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
    if (!predicted)
        SF_TRY(check_points(file, entry, &test, c, err));
    insert_test(predicted ? c->predicted : c->test, predicted ? &c->predicted_count : &c->test_count, &test);
    test = (sf_compression_test){0};
    return SF_OK;
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

static sf_status read_root(const sf_config *file, sf_compression_config *c, sf_error *err) {
    sf_config_item *root = config_root_setting(&file->config);
    int model = SF_RATE_AUTO, rule = SF_RULE_AUTO, hyperfoam = 0;
    bool form = false;
    SF_TRY(sf_config_choice(file, root, "law", "low_density_foam|hyperfoam", &hyperfoam, err));
    if (!hyperfoam)
        SF_TRY(is_form_asked(file, root, &form, err));
    SF_TRY(sf_config_names(
        file, root,
        hyperfoam ? SF_HYPERFOAM_REQUEST_KEYS
        : form    ? "law|name|density|tests|DAMP|E_range|specimen|toe_correction|cycles|curve_form|"
                    "solid_density|start|unknown|rate_model|rate_reference|predict"
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
    c->specimens = form;
    SF_TRY(read_tests(file, root, "tests", false, c, err));
    if (!form)
        return take_temperatures(file, root, c, err);
    SF_TRY(read_tests(file, root, "predict", true, c, err));
    SF_TRY(sf_cycle_records_read(file, root, c, err));
    return read_form(file, root, c, err);
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
    if (c->form.form.curve || c->hyperfoam.terms > 0)
        return SF_OK; /* these need nothing of the tests together */
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
    sf_hyperfoam_request_free(&config->hyperfoam);
    for (int k = 0; k < SF_CYCLE_RECORDS; k++)
        sf_cycle_record_free(&config->cycles[k]);
    for (int k = 0; k < config->test_count; k++)
        sf_compression_test_free(&config->test[k]);
    for (int k = 0; k < config->predicted_count; k++)
        sf_compression_test_free(&config->predicted[k]);
    *config = (sf_compression_config){0};
}
