/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes the interval of a critical fall height: its parts, the draws, their checks. */
#ifndef SF_CFH_SPREAD_REPORT_H
#define SF_CFH_SPREAD_REPORT_H

#include "study/cfh/spread.h"
#include "report/html.h"
#include "report/json.h"

/* "1.52 to 1.85 m", or a bound, of which the end of the heights looked at. Returns `text`. */
const char *sf_cfh_interval_text(const sf_cfh_interval *interval, char *text, size_t size);
/* Writes the sentences of a warning, or "": draws that have no crossing of their own or one beyond the
 * simulated heights, checks that failed, a material of the case that is none of the draws'. */
void sf_cfh_draws_text(const sf_cfh_spread *spread, char *text, size_t size);
/* Returns a sentence if the draws state no errors of the responses, else "". Static storage. */
const char *sf_cfh_response_text(const sf_cfh_spread *spread);

/* The section of report.html. */
void sf_cfh_put_spread(FILE *page, const sf_cfh_spread *spread, const sf_cfh_rig *rig);
/* The members `name`_low_m, `name`_median_m, `name`_high_m and `name`_open ("no", "above", "below", "both");
 * all null with `interval` NULL. An interval wholly beyond the heights looked at has the end of these as its
 * low or high. */
void sf_cfh_put_interval_json(sf_json *json, const char *name, const sf_cfh_interval *interval);
/* The members of the object `posterior` of cfh.json. */
void sf_cfh_put_spread_json(sf_json *json, const sf_cfh_spread *spread);

/* cfh_band.csv and cfh_draws.csv. */
sf_status sf_cfh_write_band(const sf_staging *output, const sf_cfh_spread *spread, sf_error *err);
sf_status sf_cfh_write_crossings(const sf_staging *output, const sf_cfh_spread *spread, sf_error *err);

#endif
