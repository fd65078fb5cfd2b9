/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The smoothing domains of a mesh, kept in a store (io/folder.h) for the drops of a campaign. */
#pragma once
#include "pre/cloud/domains.h"

/* sf_domains_build, unless the store (NULL: none) has its results of the same mesh, supports and limit, by
 * this very program. The same bits. */
sf_status sf_domain_store_build(const char *folder, const sf_mesh *mesh, const sf_dual *dual,
                                double condition_limit, double *support, sf_domains *out, sf_error *err);
