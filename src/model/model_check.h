/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Checks of a complete model, and its hash. */
#pragma once
#include "model/model.h"

/* The hash of every field, with the mesh, in hex digits: are two models the same, is a file as it was
 * written? */
enum { SF_MODEL_HASH_SIZE = 17 };
void sf_model_hash(const sf_model *model, char text[SF_MODEL_HASH_SIZE]);
/* The hash of its materials: are two pads of the same foam? */
void sf_model_foam_hash(const sf_model *model, char text[SF_MODEL_HASH_SIZE]);

/* True if sizes, index ranges, finiteness, CSR monotonicity and the physical bounds of the cards hold;
 * otherwise records SF_ERR_MODEL with the first violation. Everything that reads a model.h5 calls it. */
sf_status sf_model_check(const sf_model *model, sf_error *err);
