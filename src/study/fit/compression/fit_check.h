/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The quality of a fit: against the data, and as a card in the solver's own law. */
#ifndef SF_FIT_COMPRESSION_CHECK_H
#define SF_FIT_COMPRESSION_CHECK_H

#include "study/fit/compression/cube.h"
#include "study/fit/compression/table_fit.h"

/* The deviations of the data from the fit, and of the card in the solver's own law from the fit. */
typedef struct sf_compression_check {
    double rms[SF_COMPRESSION_TESTS]
              [2]; /* of deviation over sigma, loading and unloading; NaN: no such branch */
    double percent[SF_COMPRESSION_TESTS][2]; /* root mean square of deviation, % of the stress, counted as one
                                                hundredth of the largest at least */
    double card_percent;                     /* largest difference of card and fit, counted likewise */
    bool simulated;
    sf_cube_test cube[SF_COMPRESSION_TESTS]; /* if simulated */
} sf_compression_check;

/* Fills a zeroed `check`, except the simulated part. `card`: of sf_compression_card. */
sf_status sf_compression_check_card(const sf_compression_fit *fit, const sf_foam_card *card,
                                    sf_compression_check *check, sf_error *err);

#endif
