/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A measured curve from a CSV file: lines that begin with # are comments, the first other line names the
 * columns. One column must be time_s, time_ms or time_us, one acceleration_g, acceleration_m_s2 or
 * acceleration_km_s2 (positive while the missile is slowed down); others are ignored. */
#ifndef SF_POST_REFERENCE_H
#define SF_POST_REFERENCE_H

#include "post/signal.h"

/* `curve` in s and g. SF_ERR_INPUT names the file, the line and what was expected. */
sf_status sf_reference_read(const char *path, sf_series *curve, sf_error *err);

#endif
