/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers and choices of a fit in words, for report, summary and material file. */
#ifndef SF_FIT_COMPRESSION_PHRASE_H
#define SF_FIT_COMPRESSION_PHRASE_H

#include "study/fit/compression/table_fit.h"
#include <stddef.h>

/* "0.4136 MPa": value, error or bound of an estimate in a unit that reads well; "-" for one that is not
 * finite. */
void sf_compression_text(const sf_estimate *e, double value, char *out, size_t size);
/* A phrase that describes a form of the law. */
const char *sf_compression_rate_phrase(sf_rate_model model);
const char *sf_compression_rule_phrase(sf_rule rule);

#endif
