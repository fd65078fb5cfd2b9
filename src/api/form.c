/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libsoftfall-build: forms of a foam's loading curve, and foams of their parameters. */
#include "api/material.h"

#include "base/text.h"
#include "case/read.h"
#include "material/low_density_foam.h"
#include "report/row.h"
#include "study/fit/compression/compression_model.h"
#include "study/fit/form/form.h"
#include <math.h>

struct softfall_form {
    sf_foam_form form;
    char *parameters; /* owned */
};

static void put_parameter(sf_json *json, const sf_foam_form *form, sf_foam_parameter p) {
    const sf_parameter_info *about = sf_parameter_get(p);
    const sf_form_entry *entry = sf_curve_form_entry(form->curve, p);
    bool plain = about->quantity == SF_QUANTITY_COUNT;
    SF_JSON_OBJECT(json, NULL);
    SF_JSON_TEXTS(json, {"name", about->name}, {"unit", about->unit}, {"description", about->description},
                  {"quantity", plain ? "" : sf_quantity_unit(about->quantity)},
                  {"rate", sf_form_rate_names[sf_form_rate_of(p)]});
    SF_JSON_NUMBERS(json, {"per_unit", about->per_unit}, {"low", about->low}, {"high", about->high},
                    {"prior_sd", sf_foam_form_prior_sd(form, p)});
    sf_json_bool(json, "used", sf_curve_form_uses(form->curve, p));
    sf_json_bool(json, "usual", entry && entry->usual);
    sf_json_bool(json, "of_curve", entry != NULL);
}

static char *list_parameters(const sf_foam_form *form, sf_error *err) {
    SF_TEXT_STREAM(out, text, size);
    if (out) {
        sf_json json = {.file = out};
        SF_JSON_OBJECT(&json, NULL);
        SF_JSON_TEXTS(&json, {"curve", form->curve->name}, {"formula", form->curve->formula});
        SF_JSON_NUMBERS(&json, {"density", form->base.shared.density},
                        {"curves", (double)form->base.curves.curve_count});
        SF_JSON_ARRAY(&json, "parameters");
        for (int p = 0; p < SF_PARAMETER_COUNT; p++)
            put_parameter(&json, form, (sf_foam_parameter)p);
    }
    char *made = sf_text_close(out, &text);
    if (!made)
        SF_NO_MEMORY(err, "the parameters of a form");
    return made;
}

/* Takes the card of a material file. */
static sf_status take_base(const char *path, sf_foam_form *form, sf_error *err) {
    SF_OWNED_BY(sf_material_free) sf_material material = {0};
    SF_TRY(sf_case_read_material(path, 0, &material, NULL, err));
    if (material.law != &sf_low_density_foam)
        return SF_REFUSE(err, "%s is of the law %s; the parameters that drops identify are those of %s", path,
                         material.law->name, sf_low_density_foam.name);
    form->base = *sf_foam_card_of(&material);
    sf_foam_card_of(&material)->curves = (sf_law_curves){0};
    return SF_OK;
}

/* `path` NULL: the base is there. */
static sf_status read_form(const char *path, const char *curve, double solid_density, softfall_form *f,
                           sf_error *err) {
    f->form.curve = sf_curve_form_find(curve);
    if (!f->form.curve)
        return SF_REFUSE(err, "there is no form \"%.80s\"; expected one of %s", curve, sf_curve_form_words());
    if (path)
        SF_TRY(take_base(path, &f->form, err));
    f->form.solid_density = solid_density;
    f->parameters = list_parameters(&f->form, err);
    return err->status;
}

static softfall_status make_form(const char *material, double density, const char *curve,
                                 double solid_density, softfall_form **out, softfall_error *error) {
    static const double USUAL_MODULUS = 1e6;
    sf_error err = SF_ERROR_INIT;
    *out = sf_alloc(&err, 1, sizeof **out, "a form");
    if (*out)
        (*out)->form.base = (sf_foam_card){.shared = {.density = density,
                                                      .hysteresis_hu = 1,
                                                      .hysteresis_shape = 1,
                                                      .hysteresis_alpha = 1,
                                                      .maxwell_rate = 5000,
                                                      .rate_filter_time = 1e-4,
                                                      .memory = {.start = 1}},
                                           .modulus = USUAL_MODULUS,
                                           .tension_cutoff = 1e30,
                                           .densification_limit = 1};
    if (*out && read_form(material, curve, solid_density, *out, &err) != SF_OK) {
        softfall_form_free(*out);
        *out = NULL;
    }
    return softfall_return(&err, error);
}

softfall_status softfall_form_read(const char *material, const char *curve, double solid_density,
                                   softfall_form **out, softfall_error *error) {
    return make_form(material, 0, curve, solid_density, out, error);
}

softfall_status softfall_form_make(double density, const char *curve, double solid_density,
                                   softfall_form **out, softfall_error *error) {
    return make_form(NULL, density, curve, solid_density, out, error);
}

void softfall_form_free(softfall_form *form) {
    if (form) {
        sf_foam_card_free(&form->form.base);
        free(form->parameters);
    }
    free(form);
}

const char *softfall_form_parameters(const softfall_form *form) {
    return form->parameters;
}

void softfall_form_start(const softfall_form *form, const double *given, const int *unknown, double *value) {
    sf_foam_form_start(&form->form, value);
    for (int pass = 0; pass < 2; pass++) { /* medians follow the modulus and the solid fraction */
        if (pass == 1)
            form->form.curve->start(value);
        for (int p = 0; p < SF_PARAMETER_COUNT; p++)
            value[p] = isnan(given[p]) ? value[p] : given[p];
    }
    if (unknown[SF_PARAMETER_RATE_FACTOR])
        sf_foam_form_start_rate(value);
    if (unknown[SF_PARAMETER_LOCKED])
        sf_foam_form_start_lock(value);
}

double softfall_form_pole(const softfall_form *form, const double *value) {
    return form->form.curve->pole ? sf_curve_form_pole(form->form.curve, value) : 1;
}

void softfall_form_loading(const softfall_form *form, const double *value, double rate, const double *strain,
                           int64_t count, double *stress) {
    double reference = value[SF_PARAMETER_RATE_REFERENCE], time = value[SF_PARAMETER_RATE_FILTER_TIME];
    sf_compression_walk walk = {0};
    if (!form->form.curve->stress)
        return;
    sf_curve_form_stresses(form->form.curve, value, (int)count, strain, stress);
    for (int64_t i = 0; rate > 0 && i < count; i++) {
        /* the rate is behind the low pass (theory, eq. 22) */
        double over = rate / reference * (time > 0 ? -expm1(-strain[i] / (rate * time)) : 1);
        if (value[SF_PARAMETER_RATE_FACTOR] > 0 && over > 1)
            stress[i] *= 1 + value[SF_PARAMETER_RATE_FACTOR] * log10(over);
        if (value[SF_PARAMETER_ED] > 0)
            stress[i] += value[SF_PARAMETER_ED] *
                         sf_compression_maxwell(value[SF_PARAMETER_BETA1], rate, 1, strain[i], false, &walk);
    }
}

softfall_status softfall_form_material(const softfall_form *form, const double *value, double informed,
                                       softfall_material **out, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    SF_OWNED_BY(sf_foam_card_free) sf_foam_card card = {0};
    *out = NULL;
    if (sf_foam_form_card(&form->form, value, &card, &err) != SF_OK ||
        sf_foam_check_shared(&card, &err) != SF_OK)
        return softfall_return(&err, error);
    card.shared.informed_strain = informed;
    const sf_material made = sf_foam_material(&card);
    *out = sf_material_handle(&made, &err);
    return softfall_return(&err, error);
}
