/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Everything that a compression fit writes: the material file, the figures (fit.json), the report, the tables
 * and the picture. */
#ifndef SF_FIT_COMPRESSION_OUTPUT_H
#define SF_FIT_COMPRESSION_OUTPUT_H

#include "fit/compression/cube.h"
#include "fit/compression/fit.h"
#include "post/output.h"

/* How the fit stands against the data, and the card in the solver's own law against the fit. */
typedef struct sf_compression_check {
    double rms[SF_COMPRESSION_TESTS]
              [2]; /* of deviation over sigma, loading and unloading; NaN: no such branch */
    double percent[SF_COMPRESSION_TESTS][2]; /* root mean square of deviation, % of the stress, counted as one
                                                hundredth of the largest at least */
    double card_percent;                     /* largest difference of card and fit, counted likewise */
    bool simulated;
    sf_cube_test cube[SF_COMPRESSION_TESTS]; /* if simulated */
} sf_compression_check;

/* Writes into `directory` (sf_output) and prints the summary. `path`: FIT.cfg, as given. Simulates the tests
 * first if `cube` names a case. */
sf_status sf_compression_output(const sf_compression_fit *fit, const char *path, const char *directory,
                                bool force, const sf_cube_options *cube, sf_error *err);

/* Parts, each into the staging directory. */
sf_status sf_compression_write_report(const sf_output *output, const sf_compression_fit *fit,
                                      const sf_compression_check *check, const char *path, sf_error *err);
sf_status sf_compression_write_json(const sf_output *output, const sf_compression_fit *fit,
                                    const sf_compression_check *check, const char *path, sf_error *err);
sf_status sf_compression_write_plot(const sf_output *output, const sf_compression_fit *fit, char *warning,
                                    size_t size, sf_error *err);

/* "0.4136 MPa": value, error or bound of an estimate in a unit that reads well; "-" for one that is not
 * finite. */
void sf_compression_text(const sf_estimate *e, double value, char *out, size_t size);
/* What a form of the law means, in a phrase. */
const char *sf_compression_rate_phrase(sf_rate_model model);
const char *sf_compression_rule_phrase(sf_rule rule);

#endif
