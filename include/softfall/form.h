/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forms of a foam's loading curve (libsoftfall-build). */
#pragma once
#include "softfall/material.h"

/* A form of the loading curve (docs/identification.md, "Forms of the curve") on a start material, which has
 * all that the form does not. Its parameters are numbers in SI units, in the order of the list. */
typedef struct softfall_form softfall_form;

/* `curve`: gas, gas_solid, rusch, avalle, spline or table. `solid_density`: kg/m3, of the solid in the cell
 * walls, 0: not known. */
SOFTFALL_API softfall_status softfall_form_read(const char *material, const char *curve, double solid_density,
                                                softfall_form **out, softfall_error *error);
/* A form without a start material: of a foam of this density without hysteresis and terms of the rate. */
SOFTFALL_API softfall_status softfall_form_make(double density, const char *curve, double solid_density,
                                                softfall_form **out, softfall_error *error);
SOFTFALL_API void softfall_form_free(softfall_form *form);
/* JSON: "curve", "formula", "density" (kg/m3) and "curves" (of the start material), and of each of the
 * "parameters" "name", "unit" of "per_unit" SI units, SI unit ("quantity", "" of a number), bounds "low" and
 * "high", "prior_sd" of its logarithm, "used" (by this form), "usual" (unknown in a usual fit),
 * "of_curve" (the form's own), "rate" (the term of the rate that it belongs to) and "description"; owned by
 * the form. */
SOFTFALL_API const char *softfall_form_parameters(const softfall_form *form);
/* Fills `value` with medians of the priors and values of the start material, but for those that are `given`
 * (NaN: not given). `unknown` 1: a term that the start material does not have gets a median. */
SOFTFALL_API void softfall_form_start(const softfall_form *form, const double *given, const int *unknown,
                                      double *value);
/* Strain at which the curve of these values has its pole; it is infinite there. */
SOFTFALL_API double softfall_form_pole(const softfall_form *form, const double *value);
/* Fills `stress` [count] (Pa) of loading from rest at a constant rate (1/s; 0: the curve alone), with rate
 * factor and Maxwell branch, whether the curve rises or not. Strains ascend, from 0 on. */
SOFTFALL_API void softfall_form_loading(const softfall_form *form, const double *value, double rate,
                                        const double *strain, int64_t count, double *stress);
/* Makes the foam of these values; `informed`: largest strain about which the data inform, 0: that of the
 * curve's end. SOFTFALL_NUMERIC: they make no rising curve. */
SOFTFALL_API softfall_status softfall_form_material(const softfall_form *form, const double *value,
                                                    double informed, softfall_material **out,
                                                    softfall_error *error);
