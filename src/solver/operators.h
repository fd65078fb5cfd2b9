/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sf_operators: data derived from the model before the first step, constant afterwards. */
#pragma once
#include "material/laws.h"
#include "solver/constraint/constraint.h"
#include "solver/contact/sharp.h"
#include "solver/field/pairs.h"
#include "solver/field/membrane.h"
#include "solver/weight.h"

typedef struct sf_operators {
    int64_t law_count;
    sf_material_law *law; /* [law_count] of the model's materials */
    double *stability;    /* [n] m kg-1, model/stability.h */

    sf_halo halo; /* gather and scatter of groups of domains */

    sf_pairs pairs;

    sf_constraint constraint;
    sf_membrane membrane;
    sf_weight weight;
    sf_body body[SF_BODIES];            /* what the pad may touch, but for the supports */
    sf_skin contact, skin;              /* points and faces that touch missile and anvil, and all others */
    sf_sharp contact_sharp, skin_sharp; /* sharp edges of missile and supports, which press them */
} sf_operators;

sf_status sf_operators_build(const sf_model *model, sf_operators *operators, sf_error *err);
/* The same, and releases the arrays of the model that only this function needs (domain_node, support, the
 * edges), so that arrays and operators are never in memory together. */
sf_status sf_operators_take(sf_model *model, sf_operators *operators, sf_error *err);
void sf_operators_free(sf_operators *operators);
