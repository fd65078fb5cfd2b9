/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Curves of your own, such as measured ones (libsoftfall). */
#pragma once
#include "softfall/status.h"

/* Curves [count] are piecewise linear over `time`, in s, ascending. */

/* Head injury criterion of a deceleration in g, with windows of at most `window` s (INFINITY: no limit): its
 * value, and the start and the end (s) of the window where it is reached. The value is NaN, and these are 0,
 * on failure and if the curve never decelerates. */
SOFTFALL_API softfall_status softfall_hic(const double *time, const double *deceleration, int64_t count,
                                          double window, double hic[3], softfall_error *error);
/* Values of the curve filtered with a channel frequency class, at the same times, as softfall-post filters a
 * measured curve: at its own rate if that is uniform. `filtered` [count] belongs to the caller. */
SOFTFALL_API softfall_status softfall_cfc(const double *time, const double *value, int64_t count,
                                          double filter, double *filtered, softfall_error *error);
/* The instrument that a deceleration passes before it is read. */
typedef struct softfall_instrument {
    double frequency; /* Hz, of the accelerometer on its mount; 0: rigid */
    double damping;   /* -, of the mount, between 0 and 1 */
    double coupling;  /* s, time constant of a high pass; 0: none */
    double filter;    /* channel frequency class */
} softfall_instrument;

/* Reads a deceleration in g, which has begun at rest, as `instrument` (not NULL) does. Fills `read` [count]
 * at the same times, and `contact` (s), the instant at which contact begins by the curve alone, as
 * softfall-post aligns it. */
SOFTFALL_API softfall_status softfall_reading(const double *time, const double *value, int64_t count,
                                              const softfall_instrument *instrument, double *read,
                                              double *contact, softfall_error *error);
