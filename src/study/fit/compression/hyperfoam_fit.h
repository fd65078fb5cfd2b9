/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Identification of the hyperfoam from one compression test with free sides: its terms from nominal stress
 * and lateral strain while loading, by least squares (GSL, Levenberg-Marquardt from several starts); HU,
 * SHAPE and ALPHA from unloading. Terms have mu > 0 and 0 <= nu < 0.45, so that the law is stable at any
 * strain. */
#ifndef SF_FIT_COMPRESSION_HYPERFOAM_FIT_H
#define SF_FIT_COMPRESSION_HYPERFOAM_FIT_H

#include "study/fit/compression/compression_test.h"
#include "material/hyperfoam.h"

typedef struct sf_hyperfoam_data {
    sf_compression_test test; /* owned */
    int lateral_count;        /* 0: no lateral strain was measured */
    double *lateral_at;       /* [lateral_count] -, axial strain, ascending; owned */
    double *lateral;          /* [lateral_count] -, lateral strain, positive outwards; owned */
} sf_hyperfoam_data;
void sf_hyperfoam_data_free(sf_hyperfoam_data *data);

typedef struct sf_hyperfoam_fit {
    sf_hyperfoam_card card;               /* terms and unloading; the rest as given */
    double error[SF_HYPERFOAM_TERMS][3];  /* standard errors: mu over mu, alpha, nu; NaN: not fitted, or at
                                             its bound */
    bool at_bound[SF_HYPERFOAM_TERMS][3]; /* mu (never), alpha, nu */
    bool unloading_at_bound[3];           /* HU, SHAPE, ALPHA */
    double poisson[2];    /* -, -ln(lateral stretch)/ln(axial stretch), at 1 % strain and at the largest */
    double stress_rms;    /* -, of the deviations while loading, over the largest stress */
    double lateral_rms;   /* -, the same of the lateral strain; NaN: none */
    double unloading_rms; /* -, of the stress of unloading, over the largest; NaN: none */
} sf_hyperfoam_fit;

/* True if a deviation exceeds a tenth of the largest value: the law does not describe the test. */
bool sf_hyperfoam_fit_is_poor(const sf_hyperfoam_fit *fit);

/* Stress (Pa, compression positive), lateral strain and W (J m-3) of loading with free sides at an axial
 * strain; `lateral` is also the start of the search. */
double sf_hyperfoam_free_stress(const sf_hyperfoam *foam, double strain, double *lateral, double *energy);

/* Fits `terms` (1 to 3); `card` has density and the other keys. `nu` is that of every term if the data have
 * no lateral strain. SF_ERR_NUMERIC if no search converges. */
sf_status sf_hyperfoam_fit_run(const sf_hyperfoam_data *data, const sf_hyperfoam_card *card, int terms,
                               double nu, sf_hyperfoam_fit *fit, sf_error *err);

#endif
