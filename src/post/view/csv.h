/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Curves and the mid-section of a drop as CSV: a heading whose names carry the units, then one row per point.
 */
#pragma once
#include "post/figures/compare.h"

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

/* section.csv: the pad's mid-section at the instant of the largest acceleration. Rows of the set `section`
 * are the nodes of the vertical plane y = constant through the missile's axis (nodes within half their own
 * spacing of it); rows of the set `axis` are points under the axis, evenly spaced through the thickness,
 * interpolated linearly in the cells. */

/* Writes the section of /peak, or without it of the frame of the largest acceleration. `*written` is false
 * if that holds no von Mises stress: then there is no file. */
sf_status sf_section_write(const sf_staging *output, const sf_results *results, bool *written, sf_error *err);
