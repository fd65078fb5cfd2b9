/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sf_material: a law and a card of it. The functions here use the law's declarations and depend on no
 * particular law. */
#ifndef SF_CORE_MATERIAL_H
#define SF_CORE_MATERIAL_H

#include "material/law.h"

enum { SF_MATERIAL_NAME_SIZE = 64 };

typedef struct sf_material {
    const sf_law *law;                /* constant, of the table */
    void *card;                       /* law->card_size bytes, owned; its curves too */
    char name[SF_MATERIAL_NAME_SIZE]; /* of its layer; "" in a pad of one material */
} sf_material;

/* A card of zeros. */
sf_status sf_material_create(const sf_law *law, sf_material *material, sf_error *err);
/* Safe on a zeroed material; leaves one. */
void sf_material_free(sf_material *material);

/* The curves of the card; NULL if the law has none. */
sf_law_curves *sf_material_curves(const sf_material *material);
void sf_law_curves_free(sf_law_curves *curves);

double sf_material_density(const sf_material *material);      /* kg m-3 */
double sf_material_informed(const sf_material *material);     /* -, see sf_law.informed_strain */
double sf_material_rest_modulus(const sf_material *material); /* Pa */
/* m, L of damping at a node with this spacing (m). */
double sf_material_length(const sf_material *material, double spacing);

/* Bounds of all parameters, the curves, the law's own rules. SF_ERR_MODEL with a sentence that names material
 * `index`, parameter, value and bound. */
sf_status sf_material_check(const sf_material *material, int64_t index, sf_error *err);

/* The hash continued over name, law, parameters and curves. */
uint64_t sf_material_hash(uint64_t hash, const sf_material *material);

/* True if the value at `parameter` has an effect. */
bool sf_parameter_acts(const sf_parameter *parameter, const void *card);

#endif
