/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Curves as CSV: a heading whose names carry the units, then one row per point. */
#ifndef SF_POST_CSV_H
#define SF_POST_CSV_H

#include "post/figures/compare.h"
#include "post/figures/figures.h"
#include "io/staging.h"

/* history.csv: every row of the history; the filtered acceleration is interpolated to its instants. */
sf_status sf_csv_write_history(const sf_staging *output, const sf_results *results, const sf_figures *figures,
                               sf_error *err);

/* acceleration.csv: the filtered curve of which a_max and HIC are, uniform samples from free flight on. */
sf_status sf_csv_write_acceleration(const sf_staging *output, const sf_figures *figures, sf_error *err);

/* compression.csv: engineering strain (indentation / thickness) and nominal stress (contact force / mean
 * cross-section at rest) of every row; of a run with a prescribed motion. */
sf_status sf_csv_write_compression(const sf_staging *output, const sf_results *results,
                                   const sf_figures *figures, sf_error *err);

/* reference.csv: the measured curve on the clock of the model, and the model at the same instants (empty
 * outside). */
sf_status sf_csv_write_reference(const sf_staging *output, const sf_comparison *comparison,
                                 const sf_figures *figures, sf_error *err);

#endif
