/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A polynomial through responses that cost much: where Markov chains look before they pay for the responses
 * themselves (chains.h). It need not be exact for the chains to be. */
#ifndef SF_FIT_POSTERIOR_EMULATOR_H
#define SF_FIT_POSTERIOR_EMULATOR_H

#include "study/fit/posterior/mixture.h"

enum { SF_EMULATOR_MOST_TERMS = 600 };

typedef struct sf_emulator {
    int parameters, responses;
    int terms;             /* 0: no emulator */
    sf_mixture_part frame; /* of the points' mean and covariance: u = centre + L z */
    double most_distance;  /* |z|^2 of the farthest point */
    int parent[SF_EMULATOR_MOST_TERMS],
        variable[SF_EMULATOR_MOST_TERMS]; /* term = term[parent] z[variable] */
    double *coefficient;                  /* [responses][terms]; owned */
} sf_emulator;

/* Least squares on `count` points u [count][parameters] with y [count][responses]: of the degree (4, 3 or 2)
 * for which the points are three times the terms; without terms where they are too few even for that, or
 * span no volume. Release with sf_emulator_free, also on failure. */
sf_status sf_emulator_fit(int parameters, int responses, int count, const double *u, const double *y,
                          sf_emulator *emulator, sf_error *err);
/* y [responses] at u [parameters]. False: u is farther out than every point of the fit. */
bool sf_emulator_at(const sf_emulator *emulator, const double *u, double *y);
void sf_emulator_free(sf_emulator *emulator);

#endif
