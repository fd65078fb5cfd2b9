/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rounds the smoothed gradient B to what the solver keeps of it (core/packed_gradient.h), so that packing
 * changes nothing any more. The identities of B survive: the takers of a row, which stay doubles, are
 * corrected so that sum B = 0 and sum X B = I, and every other number goes to its nearest, or the other way
 * where that keeps the sums of V B over the domains, at its node and the takers', closer to what they were.
 * Rows of up to four entries, all of them takers, and numbers that are zero stay what they are. */
#ifndef SF_PRE_CLOUD_ROUNDING_H
#define SF_PRE_CLOUD_ROUNDING_H

#include "core/error.h"
#include "pre/cloud/domains.h"
#include "pre/mesh/mesh.h"

sf_status sf_domains_round(const sf_mesh *mesh, sf_domains *domains, sf_error *err);

#endif
