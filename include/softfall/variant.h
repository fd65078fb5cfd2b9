/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Variants of a model, for many drops of one geometry (libsoftfall-build). */
#pragma once
#include "softfall/material.h"
#include "softfall/model.h"

/* A model of its own beside another one, with the same mesh; 0 or NULL: as it is there. */
typedef struct softfall_variant {
    double speed;     /* m/s, of the missile at first contact */
    double mass;      /* kg, of the whole missile */
    double thickness; /* m, of the pad, from 0.7 to 1.4 times that of the model; only of an axisymmetric one
                         that softfall_model_build has made: its heights are scaled */
    const softfall_material *material; /* of a pad of one material; borrowed for the call */
} softfall_variant;

/* Makes the variant without a process or a file: for many drops of one geometry. With another speed, mass and
 * material its drops are those of a model built with these values; with another thickness, of a mesh with as
 * many rows of cells. */
SOFTFALL_API softfall_status softfall_model_vary(const softfall_model *model, const softfall_variant *variant,
                                                 softfall_model **out, softfall_error *error);
