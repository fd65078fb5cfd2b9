/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The figures of a run, from its history: of a drop, or of a compression test (prescribed motion). A figure
 * that the run does not define (the bodies never touched, contact had not ended, no drop) is NaN. */
#ifndef SF_POST_FIGURES_H
#define SF_POST_FIGURES_H

#include "post/injury.h"
#include "post/results.h"

typedef struct sf_figures {
    bool touched;       /* the missile touched the pad */
    bool driven;        /* its motion was prescribed */
    bool rebounded;     /* contact had ended before the last row, upwards */
    double cfc;         /* channel frequency class of `filtered` */
    double rate;        /* Hz, sampling of `filtered` */
    sf_series raw;      /* s, g: the history as it is; owned */
    sf_series filtered; /* s, g: resampled and CFC filtered; owned */
    sf_injury injury_raw;
    sf_injury injury; /* of the filtered curve */

    double v0;                            /* m s-1, at contact */
    double v_rebound;                     /* m s-1, upwards, in the first row after contact */
    double rebound_time;                  /* s */
    double max_indentation;               /* m */
    double max_indentation_time;          /* s */
    double max_mean_strain;               /* 1, largest indentation / thickness */
    double max_local_strain;              /* 1, largest of largest_compression */
    double max_local_strain_time;         /* s */
    double smallest_jacobian;             /* 1 */
    double max_penetration;               /* m, of the penalty */
    double energy_error;                  /* 1, largest absolute value */
    double momentum_error;                /* 1, largest absolute value */
    double constraint_residual;           /* m s-1, largest */
    double internal_energy_peak;          /* J, largest stored + hysteresis + viscous + stabilisation */
    double internal_energy_peak_time;     /* s */
    double stabilisation_energy_fraction; /* 1, at that instant, of that energy */
    double contact_energy_fraction;       /* 1, likewise */
    double absorbed_energy;               /* J, m (v0^2 - v_rebound^2) / 2 */
    double absorbed_energy_fraction;      /* 1, of m v0^2 / 2 */
    double area;                          /* m2, mean cross-section: volume of the whole pad / thickness */
    double peak_force;                    /* N, largest contact force (prescribed motion, like the next) */
    double peak_force_time;               /* s */
    double peak_stress;                   /* Pa, that force / area */
    double work;                          /* J, largest work of the motion on the pad so far */
    double returned_energy_fraction;      /* 1, of it, that the pad has given back when contact ends */
} sf_figures;

/* Release with sf_figures_free. */
sf_status sf_figures_compute(const sf_results *results, double cfc, sf_figures *figures, sf_error *err);
void sf_figures_free(sf_figures *figures);

#endif
