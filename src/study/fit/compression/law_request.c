/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/compression/compression_config.h"

#include "io/table_csv.h"
#include "material/hyperfoam.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *const sf_form_rate_names[] = {"none", "factor", "maxwell", "both"};
static const char RATE_WORDS[] = "none|factor|maxwell|both";
static const char FREE_FORM[] = "free";
enum { LEAST_POINTS = 4 }; /* of the slope that E begins with */

/* A material with a rate factor: its filter of the rate is short beside an impact and costs no time step, and
 * little damping is enough (ADR 20). */
static const double FILTER_TIME = 1e-4, FACTOR_FILTER_TIME = 5e-4; /* s */
static const double FACTOR_DAMP = 0.05;

sf_status sf_form_request_asked(const sf_config *file, sf_config_item *root, bool *asked, sf_error *err) {
    const char *name = FREE_FORM;
    SF_TRY(sf_config_text(file, root, "curve_form", false, &name, err));
    const sf_curve_form *form = sf_curve_form_find(name);
    *asked = strcmp(name, FREE_FORM) != 0;
    if (*asked && (!form || !form->stress))
        return sf_config_refuse(file, config_setting_get_member(root, "curve_form"), err,
                                "curve_form is \"%.80s\": free or one of %s is expected, but not table", name,
                                sf_curve_form_words());
    return SF_OK;
}

/* Slope through the origin of the first points of loading. */
static double first_slope(const sf_compression_test *t, double range) {
    double top = 0, bottom = 0;
    for (int i = 0, used = 0; i < t->loading && (used < LEAST_POINTS || t->strain[i] <= range); i++) {
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
    bool factor = p == SF_PARAMETER_RATE_FACTOR || p == SF_PARAMETER_RATE_REFERENCE,
         maxwell = p == SF_PARAMETER_ED || p == SF_PARAMETER_BETA1;
    if ((factor && !(r->rate & SF_FORM_RATE_FACTOR)) || (maxwell && !(r->rate & SF_FORM_RATE_MAXWELL)))
        return sf_config_refuse(file, item, err,
                                "%s is given, but rate_model = \"%s\" has none: give rate_model = \"%s\" "
                                "or \"both\", or leave it out",
                                sf_parameter_get(p)->name, sf_form_rate_names[r->rate],
                                sf_form_rate_names[factor ? SF_FORM_RATE_FACTOR : SF_FORM_RATE_MAXWELL]);
    return SF_OK;
}

static sf_status read_value(const sf_config *file, sf_config_item *group, sf_config_item *item,
                            sf_form_request *r, sf_error *err) {
    const char *name = config_setting_name(item);
    sf_foam_parameter p = sf_parameter_find(name);
    if (!is_of_curve(r, p) && p != SF_PARAMETER_RATE_FACTOR && p != SF_PARAMETER_ED &&
        p != SF_PARAMETER_BETA1)
        return sf_config_refuse(
            file, item, err,
            "start: \"%.80s\" is neither E, a parameter of curve_form = \"%s\", nor rate_factor, ED or BETA1",
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
        return sf_config_refuse(file, list, err, "unknown has more than %d parameters", SF_FORM_UNKNOWNS - 4);
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

static sf_status read_rate(const sf_config *file, sf_config_item *root, sf_compression_config *c,
                           sf_error *err) {
    sf_form_request *r = &c->form;
    int rate = SF_FORM_RATE_NONE;
    const sf_compression_test *slowest = &c->test[0], *fastest = &c->test[c->test_count - 1];
    SF_TRY(sf_config_choice(file, root, "rate_model", RATE_WORDS, &rate, err));
    r->rate = (sf_form_rate)rate;
    bool factor = r->rate & SF_FORM_RATE_FACTOR, maxwell = r->rate & SF_FORM_RATE_MAXWELL;
    if (r->rate != SF_FORM_RATE_NONE && c->test_count < 2)
        return sf_config_refuse(file, config_setting_get_member(root, "rate_model"), err,
                                "the rate model \"%s\" needs tests at two rates; there is one test",
                                sf_form_rate_names[rate]);
    SF_TRY(read_reference(file, root, c, err));
    r->start[SF_PARAMETER_RATE_FACTOR] = 0;
    r->start[SF_PARAMETER_ED] = maxwell ? 0.1 * fastest->largest_stress : 0;
    r->start[SF_PARAMETER_BETA1] = maxwell ? sqrt(slowest->rate * fastest->rate) : 5000;
    if (factor) {
        sf_foam_form_start_rate(r->start);
        r->form.base.rate_filter_time = FACTOR_FILTER_TIME;
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

sf_status sf_form_request_read(const sf_config *file, sf_config_item *root, sf_compression_config *c,
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
    SF_TRY(read_rate(file, root, c, err));
    SF_TRY(read_start(file, root, r, err));
    SF_TRY(sf_foam_form_check_fraction(file, root, root, "curve_form", &r->form, r->unknown_count, r->unknown,
                                       err));
    SF_TRY(check_pole(file, root, c->test_count, c->test, r, err));
    return check_pole(file, root, c->predicted_count, c->predicted, r, err);
}

/* ---- the hyperfoam: terms, nu and lateral strain ---- */

enum { LAW_HYPERFOAM = 1, LEAST_LATERAL = 6 };
#define LAW_WORDS "low_density_foam|hyperfoam"

sf_status sf_hyperfoam_request_asked(const sf_config *file, sf_config_item *root, bool *asked,
                                     sf_error *err) {
    int law = 0;
    SF_TRY(sf_config_choice(file, root, "law", LAW_WORDS, &law, err));
    *asked = law == LAW_HYPERFOAM;
    return SF_OK;
}

/* ---- lateral strain ---- */

static sf_status check_lateral(const sf_table_point *p, sf_error *err) {
    if (p->value[0] >= 1 || p->value[1] <= -1 || p->value[1] >= 1)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s:%d: strain %s and lateral strain %s: both must be between -1 and 1; columns in "
                       "percent are named strain_percent and lateral_strain_percent",
                       p->path, p->line, p->text[0], p->text[1]);
    return SF_OK;
}

static sf_table_layout lateral_layout(void) {
    static const sf_table_name names[] = {{"strain", 0, 1, "1"},
                                          {"strain_percent", 0, 0.01, "%"},
                                          {"lateral_strain", 1, 1, "1"},
                                          {"lateral_strain_percent", 1, 0.01, "%"},
                                          {"transverse_strain", 1, 1, "1"},
                                          {"transverse_strain_percent", 1, 0.01, "%"}};
    return (sf_table_layout){
        .what = "test",
        .column = {"strain", "lateral strain"},
        .wanted = {"\"strain\" or \"strain_percent\"", "\"lateral_strain\" or \"lateral_strain_percent\""},
        .names = names,
        .name_count = sizeof names / sizeof *names,
        .check = check_lateral};
}

/* Rows up to the largest strain: loading. Ascending afterwards. */
static sf_status read_lateral(const char *path, sf_hyperfoam_request *data, sf_error *err) {
    const sf_table_layout layout = lateral_layout();
    SF_OWNED_BY(sf_table_free) sf_table table = {0};
    SF_TRY(sf_table_read(path, &layout, &table, err));
    int64_t end = 0;
    for (int64_t i = 1; i < table.count; i++)
        end = table.value[0][i] > table.value[0][end] ? i : end;
    data->lateral_count = (int)(end + 1);
    data->lateral_at = table.value[0];
    data->lateral = table.value[1];
    table.value[0] = table.value[1] = NULL;
    for (int i = 1; i < data->lateral_count; i++)
        for (int k = i; k > 0 && data->lateral_at[k] < data->lateral_at[k - 1]; k--) {
            double at = data->lateral_at[k], side = data->lateral[k];
            data->lateral_at[k] = data->lateral_at[k - 1];
            data->lateral[k] = data->lateral[k - 1];
            data->lateral_at[k - 1] = at;
            data->lateral[k - 1] = side;
        }
    if (data->lateral_count < LEAST_LATERAL)
        return SF_FAIL(err, SF_ERR_INPUT, "%s: %d points of lateral strain while loading; %d are needed",
                       path, data->lateral_count, LEAST_LATERAL);
    return SF_OK;
}

/* ---- the keys ---- */

static sf_status read_test(const sf_config *file, sf_config_item *root, sf_hyperfoam_request *r,
                           sf_compression_test *test, sf_error *err) {
    sf_config_item *tests, *entry;
    sf_compression_source source = {0};
    SF_OWNED char *path = NULL, *lateral = NULL;
    sf_error inner = SF_ERROR_INIT;
    SF_TRY(sf_config_list(file, root, "tests", true, 8, &tests, err));
    entry = config_setting_get_elem(tests, 0);
    if (config_setting_length(tests) != 1)
        return sf_config_refuse(
            file, tests, err,
            "the hyperfoam is fitted to one test, at one rate; fit the others in files of "
            "their own, and compare nu and mu");
    SF_TRY(sf_config_names(file, entry, "file|rate|lateral", err));
    SF_TRY(sf_config_quantity(file, entry, "rate", SF_RATE, true, 0, &source.rate, err));
    SF_TRY(sf_config_file(file, entry, "lateral", false, &lateral, err));
    SF_TRY(sf_config_file(file, entry, "file", true, &path, err));
    source.path = path;
    if (sf_compression_test_read(&source, test, &inner) == SF_OK && lateral)
        read_lateral(lateral, r, &inner);
    if (inner.status != SF_OK)
        SF_FAIL(err, inner.status, "%s (named at %s:%u)", inner.text, file->path,
                config_setting_source_line(entry));
    return err->status;
}

sf_status sf_hyperfoam_request_read(const sf_config *file, sf_config_item *root, sf_hyperfoam_request *r,
                                    sf_compression_test *test, sf_error *err) {
    double terms = 2;
    SF_TRY(sf_config_number(file, root, "terms", false, 1, SF_HYPERFOAM_TERMS, &terms, err));
    SF_TRY(sf_config_number(file, root, "nu", false, 0, 0.45, &r->nu, err));
    r->terms = (int)terms;
    if (r->terms != terms)
        return sf_config_refuse(file, config_setting_get_member(root, "terms"), err,
                                "terms is %g; it must be 1, 2 or 3", terms);
    SF_TRY(read_test(file, root, r, test, err));
    bool given = config_setting_get_member(root, "nu") != NULL, measured = r->lateral_count > 0;
    if (given == measured)
        return sf_config_refuse(file, root, err,
                                given ? "nu is given, and lateral strain is measured; one of them says it"
                                      : "give the test a table of lateral strain (lateral = \"FILE\", which "
                                        "may be its own file), or nu for all terms");
    return SF_OK;
}

void sf_hyperfoam_request_free(sf_hyperfoam_request *r) {
    free(r->lateral_at);
    free(r->lateral);
    *r = (sf_hyperfoam_request){0};
}
