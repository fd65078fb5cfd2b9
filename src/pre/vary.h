/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Variants of a finished model, without its geometry: for many drops of one mesh. */
#pragma once
#include "model/model.h"

/* The kernel of a cloud, as of the case. */
typedef struct sf_kernel {
    double support_ratio;   /* R/h; 0: not known */
    double condition_limit; /* of the moment matrix */
} sf_kernel;

/* The factors on the thickness that keep the cells' shapes. */
#define SF_VARY_LEAST 0.7
#define SF_VARY_MOST 1.4

/* Makes the pad of an axisymmetric model `thickness` (m) thick: its heights are scaled, and spacing,
 * supports, rows and masses computed anew, as of a mesh with as many rows of cells. Missile, anvil, loads of
 * a resting pad and the expected mesh error follow. SF_ERR_INPUT: the model is solid, the kernel not known,
 * or the factor outside SF_VARY_LEAST to SF_VARY_MOST. */
sf_status sf_vary_thickness(sf_model *model, const sf_kernel *kernel, double thickness, sf_error *err);

/* Gives the pad, of one material, another foam: the masses are scaled. The material is copied. */
sf_status sf_vary_material(sf_model *model, const sf_material *material, sf_error *err);
