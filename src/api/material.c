/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libsoftfall-build: foams, and points of them under compression. */
#include "api/material.h"

#include "case/read.h"
#include "material/hyperfoam.h"
#include "material/laws.h"
#include "material/low_density_foam.h"
#include "study/cushion.h"
#include "study/fit/form/form.h"
#include "study/material_file.h"
#include <math.h>

static const double LEAST_RISE = 1e-6; /* of a bent curve, from point to point */

softfall_status softfall_material_read(const char *path, double temperature, softfall_material **out,
                                       softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    *out = sf_alloc(&err, 1, sizeof **out, "a material");
    if (*out && sf_case_read_material(path, temperature, &(*out)->data, &(*out)->parameters, &err) != SF_OK) {
        free(*out);
        *out = NULL;
    }
    return softfall_return(&err, error);
}

softfall_material *sf_material_handle(const sf_material *material, sf_error *err) {
    softfall_material *m = sf_alloc(err, 1, sizeof *m, "a material");
    if (m && !(m->parameters = strdup("")))
        SF_NO_MEMORY(err, "a material");
    if (m && (err->status != SF_OK || sf_material_copy(material, &m->data, err) != SF_OK)) {
        softfall_material_free(m);
        m = NULL;
    }
    return m;
}

void softfall_material_free(softfall_material *material) {
    if (material) {
        sf_material_free(&material->data);
        free(material->parameters);
    }
    free(material);
}

const char *softfall_material_parameters(const softfall_material *material) {
    return material->parameters;
}

int64_t softfall_material_curve(const softfall_material *material, int index, double *rate,
                                const double **strain, const double **stress) {
    const sf_law_curves *curves = sf_material_curves(&material->data);
    if (!curves || index < 0 || index >= curves->curve_count)
        return 0;
    *rate = curves->curve_rate[index];
    *strain = &curves->curve_strain[curves->curve_ptr[index]];
    *stress = &curves->curve_stress[curves->curve_ptr[index]];
    return curves->curve_ptr[index + 1] - curves->curve_ptr[index];
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
        SF_REFUSE(&err, "only curves of the law %s can be bent, at 1 strain or more",
                  sf_low_density_foam.name);
    else
        sf_foam_card_resample(card, &err);
    for (int64_t c = 0; err.status == SF_OK && c < card->curves.curve_count; c++)
        for (int64_t k = card->curves.curve_ptr[c]; k < card->curves.curve_ptr[c + 1]; k++) {
            double before =
                k > card->curves.curve_ptr[c] ? card->curves.curve_stress[k - 1] * (1 + LEAST_RISE) : 0;
            card->curves.curve_stress[k] =
                fmax(before, card->curves.curve_stress[k] *
                                 exp(bend_at(count, strain, bend, card->curves.curve_strain[k])));
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

static sf_status check_path(const sf_point_path *path, sf_error *err) {
    enum { MOST = 10000000 };
    if (path->count < 2 || path->count > MOST)
        return SF_REFUSE(err, "the path of strain has %lld points; it must have 2 to %d",
                         (long long)path->count, MOST);
    if (path->strain[0] != 0)
        return SF_REFUSE(err, "the first strain is %g; a path of strain begins with 0", path->strain[0]);
    for (int64_t i = 0; i < path->count; i++) {
        if (!(path->strain[i] >= -1 && path->strain[i] < 1))
            return SF_REFUSE(err, "strain %lld is %g; it must be from -1 to below 1", (long long)i + 1,
                             path->strain[i]);
        if (!isfinite(path->time[i]) || (i > 0 && !(path->time[i] > path->time[i - 1])))
            return SF_REFUSE(err, "time %lld is %g s; times are finite and ascend", (long long)i + 1,
                             path->time[i]);
    }
    return SF_OK;
}

softfall_status softfall_compress(const softfall_material *material, int free_sides, const double *time,
                                  const double *strain, int64_t count, double *stress,
                                  softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    sf_material_law law = {0};
    const sf_point_path path = {count, time, strain, free_sides != 0};
    if (check_path(&path, &err) == SF_OK && sf_material_law_build(&material->data, &law, &err) == SF_OK)
        sf_material_point_follow(&law, &path, stress, &err);
    sf_material_law_free(&law);
    return softfall_return(&err, error);
}

softfall_status softfall_compress_cycles(const softfall_material *material, const double *time,
                                         const double *strain, const double *pause, int64_t count,
                                         double *stress, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    SF_OWNED_BY(sf_material_law_free) sf_material_law law = {0};
    sf_uniaxial point = {0};
    if (sf_material_law_build(&material->data, &law, &err) == SF_OK)
        for (int64_t i = 0; i < count; i++) {
            if (pause[i] > 0)
                sf_material_point_rest(&law, pause[i], &point);
            stress[i] = law.law->uniaxial(law.numbers, i > 0 ? time[i] - time[i - 1] : 1, strain[i], &point);
        }
    return softfall_return(&err, error);
}

softfall_status softfall_hyperfoam_material(const softfall_hyperfoam *values, softfall_material **out,
                                            softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    sf_hyperfoam_card card = {.shared.density = values->density,
                              .shared.damp = values->damp,
                              .shared.hysteresis_hu = values->hu,
                              .shared.hysteresis_shape = values->shape,
                              .shared.hysteresis_alpha = values->unloading_alpha,
                              .shared.maxwell_rate = 5000,
                              .shared.rate_reference = 0.01,
                              .shared.rate_filter_time = 1e-4,
                              .stable_to = 0.9,
                              .shared.informed_strain = values->informed};
    for (int k = 0; k < values->terms && k < SF_HYPERFOAM_TERMS; k++)
        card.term[k] =
            (sf_hyperfoam_term){.mu = values->mu[k], .alpha = values->alpha[k], .nu = values->nu[k]};
    const sf_material made = sf_hyperfoam_material(&card);
    *out = sf_material_handle(&made, &err);
    return softfall_return(&err, error);
}

softfall_status softfall_hyperfoam_loading(const softfall_material *material, const double *strain,
                                           int64_t count, double *stress, double *lateral, double *energy,
                                           softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    double stretch[3] = {1, 1, 1};
    if (material->data.law != &sf_hyperfoam_law)
        return SF_REFUSE(&err, "the material is no hyperfoam"), softfall_return(&err, error);
    const sf_hyperfoam foam = sf_hyperfoam_build(material->data.card);
    for (int64_t i = 0; i < count; i++) {
        stretch[0] = 1 - strain[i];
        bool found = sf_hyperfoam_release(&foam, 1, stretch);
        sf_hyperfoam_point p = sf_hyperfoam_evaluate(&foam, stretch);
        stress[i] = found ? -p.t[0] : NAN;
        lateral[i] = found ? stretch[1] - 1 : NAN;
        energy[i] = found ? p.energy : NAN;
        stretch[1] = stretch[2] = found ? stretch[1] : 1;
    }
    return softfall_return(&err, error);
}

softfall_status softfall_cushion(const softfall_material *material, double static_stress, double thickness,
                                 double drop_height, double *peak_g, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    SF_OWNED_BY(sf_material_law_free) sf_material_law law = {0};
    const sf_cushion cushion = {static_stress, thickness, drop_height};
    *peak_g = NAN;
    if (sf_material_law_build(&material->data, &law, &err) == SF_OK)
        sf_cushion_peak(&cushion, &law, peak_g, &err);
    return softfall_return(&err, error);
}
