/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/operators.h"

#include "model/stability.h"
#include "solver/contact/shapes.h"
#include "solver/set.h"

static sf_status build_laws(const sf_model *m, sf_operators *op, sf_error *err) {
    op->law = sf_alloc(err, m->material_count, sizeof *op->law, "laws");
    for (; op->law && op->law_count < m->material_count; op->law_count++)
        if (sf_material_law_build(&m->material[op->law_count], &op->law[op->law_count], err) != SF_OK)
            break;
    return err->status;
}

/* `owned`: the same model if arrays that are no longer needed may be released at once; else NULL. */
static sf_status build(const sf_model *m, sf_model *owned, sf_operators *op, sf_error *err) {
    memset(op, 0, sizeof *op);
    op->stability = sf_alloc(err, m->node_count, sizeof *op->stability, "stability constants");
    if (err->status != SF_OK || build_laws(m, op, err) != SF_OK ||
        sf_stability_constants(m, op->stability, err) != SF_OK || sf_halo_build(m, &op->halo, err) != SF_OK)
        return err->status;
    if (owned)
        sf_model_drop_domain_nodes(owned);
    SF_TRY(sf_pairs_build(m, &op->pairs, err));
    if (owned) {
        owned->edge_pairs = sf_pairs_count(m);
        sf_model_drop_edges(owned);
    }
    SF_TRY(sf_constraint_build(m, &op->constraint, err));
    SF_TRY(sf_membrane_build(m, &op->membrane, err));
    SF_TRY(sf_skin_build(m, &op->skin, err));
    SF_TRY(sf_skin_build_contact(m, &op->contact, err));
    SF_TRY(sf_weight_build(m, &op->contact.rows, &op->weight, err));
    for (int b = 0; b <= SF_BODY_MISSILE; b++)
        SF_TRY(sf_body_build(m, b, &op->body[b], err));
    const sf_shape_triangles missile = sf_shape_triangles_of(m, SF_BODY_MISSILE),
                             support = sf_shape_triangles_of(m, SF_BODY_SUPPORT);
    SF_TRY(sf_sharp_build(m, &missile, &op->contact, &op->contact_sharp, err));
    SF_TRY(sf_sharp_build(m, &support, &op->skin, &op->skin_sharp, err));
    return m->set ? sf_set_check_missile(m, &op->body[SF_BODY_MISSILE], err) : SF_OK;
}

sf_status sf_operators_build(const sf_model *m, sf_operators *op, sf_error *err) {
    if (build(m, NULL, op, err) != SF_OK)
        sf_operators_free(op);
    return err->status;
}

sf_status sf_operators_take(sf_model *m, sf_operators *op, sf_error *err) {
    if (build(m, m, op, err) != SF_OK)
        sf_operators_free(op);
    return err->status;
}

void sf_operators_free(sf_operators *op) {
    for (int64_t k = 0; k < op->law_count; k++)
        sf_material_law_free(&op->law[k]);
    sf_halo_free(&op->halo);
    sf_constraint_free(&op->constraint);
    sf_membrane_free(&op->membrane);
    sf_weight_free(&op->weight);
    for (int b = 0; b < SF_BODIES; b++)
        sf_body_free(&op->body[b]);
    sf_skin_free(&op->contact);
    sf_skin_free(&op->skin);
    sf_sharp_free(&op->contact_sharp);
    sf_sharp_free(&op->skin_sharp);
    sf_pairs_free(&op->pairs);
    SF_CLEAR(op, op->law, op->stability);
}
