/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libsoftfall-build: forms of a foam's loading curve, and foams of their parameters. */
#include "api/api_material.h"

#include "base/text.h"
#include "case/read.h"
#include "material/low_density_foam.h"
#include "report/row.h"
#include "study/fit/form/form.h"
#include "study/material_file.h"
#include <math.h>

static const double LEAST_RISE = 1e-6; /* of a bent curve, from point to point */

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
}

static char *list_parameters(const sf_foam_form *form, sf_error *err) {
    SF_TEXT_STREAM(out, text, size);
    if (out) {
        sf_json json = {.file = out};
        SF_JSON_OBJECT(&json, NULL);
        SF_JSON_TEXTS(&json, {"curve", form->curve->name}, {"formula", form->curve->formula});
        SF_JSON_NUMBERS(&json, {"density", form->base.density}, {"curves", (double)form->base.curve_count});
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

static sf_status read_form(const char *path, const char *curve, double solid_density, softfall_form *f,
                           sf_error *err) {
    f->form.curve = sf_curve_form_find(curve);
    if (!f->form.curve)
        return SF_REFUSE(err, "there is no form \"%.80s\"; expected one of %s", curve, sf_curve_form_words());
    SF_TRY(take_base(path, &f->form, err));
    f->form.solid_density = solid_density;
    f->parameters = list_parameters(&f->form, err);
    return err->status;
}

softfall_status softfall_form_read(const char *material, const char *curve, double solid_density,
                                   softfall_form **out, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    *out = sf_alloc(&err, 1, sizeof **out, "a form");
    if (*out && read_form(material, curve, solid_density, *out, &err) != SF_OK) {
        softfall_form_free(*out);
        *out = NULL;
    }
    return softfall_return(&err, error);
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

softfall_status softfall_form_material(const softfall_form *form, const double *value, double informed,
                                       softfall_material **out, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    SF_OWNED_BY(sf_foam_card_free) sf_foam_card card = {0};
    *out = NULL;
    if (sf_foam_form_card(&form->form, value, &card, &err) != SF_OK ||
        sf_foam_check_shared(&card, &err) != SF_OK)
        return softfall_return(&err, error);
    card.informed_strain = informed;
    const sf_material made = sf_foam_material(&card);
    softfall_material *m = sf_alloc(&err, 1, sizeof *m, "a material");
    if (m && !(m->parameters = strdup("")))
        SF_NO_MEMORY(&err, "a material");
    if (m && (err.status != SF_OK || sf_material_copy(&made, &m->data, &err) != SF_OK)) {
        softfall_material_free(m);
        m = NULL;
    }
    *out = m;
    return softfall_return(&err, error);
}

static double bend_at(int64_t count, const double *strain, const double *bend, double e) {
    int64_t k = 0;
    while (k < count && strain[k] <= e)
        k++;
    if (k == 0 || k == count)
        return bend[k == 0 ? 0 : count - 1];
    return bend[k - 1] + (bend[k] - bend[k - 1]) * (e - strain[k - 1]) / (strain[k] - strain[k - 1]);
}

softfall_status softfall_material_bend(softfall_material *material, int64_t count, const double *strain,
                                       const double *bend, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    sf_foam_card *card = material->data.law == &sf_low_density_foam ? sf_foam_card_of(&material->data) : NULL;
    if (!card || count < 1)
        SF_REFUSE(&err, "only curves of the law %s can be bent, at 1 strain or more", sf_low_density_foam.name);
    else
        sf_foam_card_resample(card, &err);
    for (int64_t c = 0; err.status == SF_OK && c < card->curve_count; c++)
        for (int64_t k = card->curve_ptr[c]; k < card->curve_ptr[c + 1]; k++) {
            double before = k > card->curve_ptr[c] ? card->curve_stress[k - 1] * (1 + LEAST_RISE) : 0;
            card->curve_stress[k] =
                fmax(before, card->curve_stress[k] * exp(bend_at(count, strain, bend, card->curve_strain[k])));
        }
    return softfall_return(&err, error);
}

softfall_status softfall_material_write(const softfall_material *material, const char *folder,
                                        const char *name, const char *title, const char *comments,
                                        softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    const sf_material_text text = {.title = title, .provenance = comments};
    sf_material_write_checked(folder, name, &material->data, &text, &err);
    return softfall_return(&err, error);
}
