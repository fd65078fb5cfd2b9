/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "model/stability.h"

#include "base/mat3.h"
#include "material/laws.h"

sf_status sf_stability_constants(const sf_model *model, double *c, sf_error *err) {
    SF_OWN(double, share, model->node_count, "stability constants", err);
    for (int64_t l = 0; l < model->node_count; l++)
        for (int64_t k = model->domain_ptr[l]; k < model->domain_ptr[l + 1]; k++) {
            const double *b = &model->domain_b[3 * k];
            share[model->domain_node[k]] += model->volume[l] * sqrt(sf_dot3(b, b));
        }
    for (int64_t l = 0; l < model->node_count; l++) {
        double sum[6] = {0};
        for (int64_t k = model->domain_ptr[l]; k < model->domain_ptr[l + 1]; k++) {
            const double *b = &model->domain_b[3 * k];
            int32_t node = model->domain_node[k];
            double length = sqrt(sf_dot3(b, b));
            if (!(length > 0))
                continue;
            double weight = share[node] / (model->volume[l] * length * model->mass[node]);
            const double outer[6] = {b[0] * b[0], b[1] * b[1], b[2] * b[2],
                                     b[0] * b[1], b[1] * b[2], b[0] * b[2]};
            for (int q = 0; q < 6; q++)
                sum[q] += weight * outer[q];
        }
        c[l] = model->volume[l] * sf_sym3_largest(sum);
    }
    return SF_OK;
}

/* Lengths of the gradients of a triangle's shape functions, m-1: the opposite side over twice the area, which
 * is returned, m2. */
static double gradients(const sf_model *m, const int32_t node[3], double length[3]) {
    const double *x[3];
    double side[3][3], normal[3];
    sf_corners(m->position, node, x);
    for (int k = 0; k < 3; k++)
        sf_sub3(x[(k + 2) % 3], x[(k + 1) % 3], side[k]);
    sf_cross3(side[0], side[1], normal);
    double twice = sqrt(sf_dot3(normal, normal));
    for (int k = 0; k < 3; k++)
        length[k] = sqrt(sf_dot3(side[k], side[k])) / twice;
    return 0.5 * twice;
}

sf_status sf_stability_membrane(const sf_model *m, double *load, sf_error *err) {
    const sf_membrane_card *card = &m->membrane;
    double plane = card->modulus * card->thickness / (1 - card->poisson * card->poisson);
    SF_OWNED double *stiff = sf_alloc(err, m->node_count, sizeof *stiff, "membrane");
    SF_OWNED double *column = sf_alloc(err, m->node_count, sizeof *column, "membrane");
    *load = 0;
    for (int64_t t = 0; err->status == SF_OK && t < m->membrane_count; t++) {
        const int32_t *node = &m->membrane_triangle[3 * t];
        double length[3], area = m->membrane_share[t] * gradients(m, node, length);
        for (int k = 0; k < 3; k++)
            stiff[node[k]] += plane * area * length[k] * (length[0] + length[1] + length[2]);
    }
    for (int64_t i = 0; err->status == SF_OK && i < m->node_count; i++)
        for (int64_t e = m->phi_ptr[i]; e < m->phi_ptr[i + 1] && stiff[i] > 0; e++)
            column[m->phi_node[e]] += fabs(m->phi_value[e]);
    for (int64_t i = 0; err->status == SF_OK && i < m->node_count; i++) {
        double row = 0;
        for (int64_t e = m->phi_ptr[i]; e < m->phi_ptr[i + 1] && stiff[i] > 0; e++)
            row += fabs(m->phi_value[e]) * column[m->phi_node[e]] / m->mass[m->phi_node[e]];
        *load = fmax(*load, row * stiff[i]);
    }
    return err->status;
}

/* The bound on the step at rest. */
static sf_status first_step(const sf_model *m, double *step, int64_t *critical, double *constant,
                            sf_error *err) {
    SF_OWN(double, c, m->node_count, "stability constants", err);
    SF_TRY(sf_stability_constants(m, c, err));
    *step = INFINITY;
    for (int64_t i = 0; i < m->node_count; i++) {
        const sf_material *material = sf_model_material(m, i);
        double tangent, viscosity;
        material->law->rest_bounds(material->card, sf_material_length(material, m->spacing[i]), &tangent,
                                   &viscosity);
        double own = sf_stability_step(c[i], tangent, viscosity);
        if (own < *step) {
            *step = own;
            *critical = i;
            *constant = c[i];
        }
    }
    return SF_OK;
}

/* The steps shrink as the foam stiffens, by its curves and its rate terms: takes the law of the node with the
 * shortest first step through half a sine of compression that begins at the missile's speed over the
 * thickness, and returns the mean over time of the first step over the present one. */
static sf_status estimate_slowdown(const sf_model *m, int64_t critical, double constant, double first,
                                   double *slowdown, sf_error *err) {
    enum { STEPS = 400 };
    const double deepest = 0.7, speed = fmax(m->missile.speed, 1e-3);
    const sf_material *material = sf_model_material(m, critical);
    double length = sf_material_length(material, m->spacing[critical]), sum = 0,
           start = fmin(m->run.step_limit, m->run.step_safety * first);
    sf_law_batch batch;
    SF_OWNED_BY(sf_material_law_free) sf_material_law law = {0};
    SF_TRY(sf_material_law_build(material, &law, err));
    memset(&batch, 0, sizeof batch);
    sf_material_point_stretch(batch.f, 1);
    for (int l = 0; l < SF_LANES; l++)
        batch.length[l] = length;
    for (int k = 1; k <= STEPS; k++) {
        memcpy(batch.f_old, batch.f, sizeof batch.f);
        sf_material_point_stretch(batch.f, 1 - deepest * sin(M_PI * k / STEPS));
        law.law->update(law.numbers, M_PI * deepest * m->thickness / speed / STEPS, &batch);
        double own = sf_stability_step(constant, batch.tangent[0], batch.viscosity[0]);
        sum += start / fmin(m->run.step_limit, m->run.step_safety * own);
    }
    *slowdown = sum / STEPS;
    return SF_OK;
}

sf_status sf_stability_first_step(const sf_model *m, double *step, int64_t *critical, double *slowdown,
                                  sf_error *err) {
    double constant = 0;
    *slowdown = 1;
    SF_TRY(first_step(m, step, critical, &constant, err));
    if (!sf_missile_is_driven(m))
        estimate_slowdown(m, *critical, constant, *step, slowdown, err);
    return err->status;
}
