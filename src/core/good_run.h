/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The limits of a good run: beyond one of them its figures are not to be trusted. This list is the only one
 * of them; what warns, the studies and the table in docs/formats.md follow it. */
#ifndef SF_CORE_GOOD_RUN_H
#define SF_CORE_GOOD_RUN_H

/* X(name, limit of the magnitude, figures of summary.json, reason). */
/* clang-format off */
#define SF_GOOD_RUN(X)                                                                                                 \
    X(energy_error, 0.01, "energy_error", "the energy balance holds")                                                  \
    X(stabilisation, 0.05, "stabilisation_energy_fraction", "the stabilisation does not stiffen the pad")              \
    X(contact, 0.01, "contact_energy_fraction", "contact does not consume the energy")                                 \
    X(filter, 0.03, "a_max_raw_g / a_max_g - 1", "the filter does not make the peak")                                  \
    X(local_strain_excess, 0.12, "local_strain_excess", "the foam does not collapse locally")
/* clang-format on */

#define SF_GOOD_RUN_LIMIT(name, ...) double name;
typedef struct sf_good_run {
    SF_GOOD_RUN(SF_GOOD_RUN_LIMIT)
} sf_good_run;
#undef SF_GOOD_RUN_LIMIT

/* The limits; static storage. */
const sf_good_run *sf_good_run_limits(void);

#endif
