/* SPDX-License-Identifier: GPL-3.0-or-later */
/* HIC of a single pulse, a hundred times as fast as the search of post/figures/hic.h, for surrogates. */
#ifndef SF_SURROGATE_PULSE_H
#define SF_SURROGATE_PULSE_H

#include "post/figures/hic.h"

/* Of a curve that rises to one peak and falls, both ends of the window have the same deceleration: the
 * maximum over one level is found instead of that over two instants. The part below a fifth of the peak may
 * have any shape. Any other curve goes to sf_hic_evaluate; so do pulses whose best level is below a quarter
 * of the peak. No limit of the window. */
sf_status sf_pulse_hic(const sf_series *acceleration_g, sf_hic *hic, sf_error *err);

#endif
