/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Figures of drops and of results.h5 (libsoftfall). */
#pragma once
#include "softfall/drop.h"

/* The numbers of summary.json (docs/formats.md), by their keys there and in the units that the keys name:
 * "a_max_g", "hic", "hic_t1_ms", "max_indentation_mm", "rebounded" (0 or 1), and the verdict with them.
 * A figure that the run does not define (the missile never touched, contact had not ended, its motion was
 * prescribed) is NaN. Indicative, not a certification. */
typedef struct softfall_figures softfall_figures;

/* Computes the figures of a drop so far (three steps at least), or of a results.h5 of softfall-solve.
 * `filter`: channel frequency class (SAE J211) 60, 180, 600 or 1000; softfall-post takes 1000 by default.
 * `out` is owned by the caller. */
SOFTFALL_API softfall_status softfall_drop_figures(const softfall_drop *drop, double filter,
                                                   softfall_figures **out, softfall_error *error);
SOFTFALL_API softfall_status softfall_results_figures(const char *path, double filter, softfall_figures **out,
                                                      softfall_error *error);
SOFTFALL_API void softfall_figures_free(softfall_figures *figures);

/* The list of figures [count]: name (the key) and description; the unit stands in the key. It is the same of
 * all figures, and of NULL. */
SOFTFALL_API const softfall_quantity *softfall_figures_list(const softfall_figures *figures, int *count);
/* Sets `value`, NaN if the run does not define the figure. SOFTFALL_INPUT: there is no such figure. */
SOFTFALL_API softfall_status softfall_figure(const softfall_figures *figures, const char *key, double *value,
                                             softfall_error *error);

/* The verdict of softfall-post: 0: valid, 1: valid with remarks, 2: do not use; and that with the findings,
 * in words, the worst first; owned by the figures. */
SOFTFALL_API int softfall_figures_grade(const softfall_figures *figures);
SOFTFALL_API const char *softfall_figures_verdict(const softfall_figures *figures);
/* Returns the part of a_max that is certain although the verdict is "do not use" (1: a_max can only be too
 * low; 0: nothing is certain). */
SOFTFALL_API double softfall_figures_sure(const softfall_figures *figures);
/* Returns how the run ended: "rebound", "finished", a sentence, or "" if it has not ended; owned by the
 * figures. */
SOFTFALL_API const char *softfall_figures_status(const softfall_figures *figures);

/* A figure at ever finer meshes and its error, `refined`, from those at a spacing and at `ratio` times it
 * (docs/python.md, "Two meshes for one answer"). `cells`: the finer mesh's number of cells over the coarser
 * one's; INFINITY: not known. SOFTFALL_INPUT, and NaN, where the pair tells no value; the sentence says why.
 */
SOFTFALL_API softfall_status softfall_refine(double fine, double coarse, double ratio, double cells,
                                             double refined[2], softfall_error *error);
