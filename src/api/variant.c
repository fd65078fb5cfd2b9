/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libsoftfall-build: variants of a model in memory. */
#include "api/material.h"

#include "model/model_check.h"
#include "pre/vary.h"
#include <math.h>

static sf_status check_value(const char *name, double value, double most, sf_error *err) {
    if (value == 0 || (value > 0 && value <= most))
        return SF_OK;
    return SF_REFUSE(err, "%s: %g is neither 0, as it is, nor above 0 and at most %g", name, value, most);
}

static sf_status apply(const softfall_model *from, const softfall_variant *v, sf_model *m, sf_error *err) {
    SF_TRY(check_value("speed", v->speed, 200, err));
    SF_TRY(check_value("mass", v->mass, 1e9, err));
    SF_TRY(check_value("thickness", v->thickness, 1e3, err));
    if ((v->speed > 0 || v->mass > 0) && sf_missile_is_driven(m))
        return SF_REFUSE(err, "speed, mass: the missile has a prescribed motion, and no mass or speed");
    m->section = (sf_section_drop){0}; /* of another drop */
    m->missile.speed = v->speed > 0 ? v->speed : m->missile.speed;
    m->missile.mass = v->mass > 0 ? v->mass : m->missile.mass;
    if (v->material)
        SF_TRY(sf_vary_material(m, &v->material->data, err));
    if (v->thickness > 0 && v->thickness != m->thickness)
        SF_TRY(sf_vary_thickness(m, &from->kernel, v->thickness, err));
    return sf_model_check(m, err);
}

/* The texts of the model it was made of, with the changes as comments behind the case. */
static sf_status keep_texts(const softfall_model *from, const softfall_variant *v, softfall_model *m,
                            sf_error *err) {
    SF_TEXT_STREAM(out, text, size);
    if (!out)
        return SF_NO_MEMORY(err, "the texts of a case");
    fprintf(out, "%s\n# variant:", from->case_text ? from->case_text : "");
    if (v->speed > 0)
        fprintf(out, " speed = %.17g m/s", v->speed);
    if (v->mass > 0)
        fprintf(out, " mass = %.17g kg", v->mass);
    if (v->thickness > 0)
        fprintf(out, " thickness = %.17g m", v->thickness);
    fprintf(out, "%s\n", v->material ? " another material" : "");
    fclose(out);
    m->case_text = text;
    m->mesh_hash = from->mesh_hash ? strdup(from->mesh_hash) : NULL;
    m->geometry_files = from->geometry_files ? strdup(from->geometry_files) : NULL;
    m->kernel = from->kernel;
    memcpy(m->libraries, from->libraries, sizeof m->libraries);
    return SF_OK;
}

softfall_status softfall_model_vary(const softfall_model *model, const softfall_variant *variant,
                                    softfall_model **out, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    softfall_model *m = *out = sf_alloc(&err, 1, sizeof *m, "a model");
    if (m && sf_model_copy(&model->model, &m->model, &err) == SF_OK &&
        apply(model, variant, &m->model, &err) == SF_OK)
        keep_texts(model, variant, m, &err);
    if (err.status != SF_OK) {
        softfall_model_free(m);
        *out = NULL;
    }
    return softfall_return(&err, error);
}
