/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The law with memory along a record of cycles: the form's unknowns, HU, SHAPE and ALPHA, reload and drift,
 * and recovery where the record has pauses, together by least squares over the fitted cycles. */
#ifndef SF_FIT_COMPRESSION_CYCLE_FIT_H
#define SF_FIT_COMPRESSION_CYCLE_FIT_H

#include "study/fit/compression/form_fit.h"

/* "reload", "drift", "recovery", and the half width of their interval (two standard errors; NaN: the record
 * does not tell it, and its value is that without effect). */
const char *sf_cycle_fit_name(int number);

/* Refines `fit`, whose values are the start, by the record of its configuration, and fills fit->cycles. */
sf_status sf_cycle_fit_run(sf_form_fit *fit, sf_error *err);

/* Largest rms, over the largest stress, of loading (0) or unloading (1) of the cycles first .. last - 1. */
double sf_cycle_fit_worst(const sf_form_fit *fit, int unloading, int first, int last);

#endif
