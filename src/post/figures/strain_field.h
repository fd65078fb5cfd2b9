/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Figures of the strain over the pad at the peak, from the fields of /peak. */
#ifndef SF_POST_STRAIN_FIELD_H
#define SF_POST_STRAIN_FIELD_H

#include "post/results/results.h"

/* Largest excess of a node's compression (1 - smallest principal stretch) over the median of its neighbours,
 * the nodes that share a cell with it, counted once per cell. Where the strain is smooth it is small, below a
 * missile in a pad of any thickness, and so it is along a straight edge of the loaded area; single nodes,
 * rows or layers that collapse alone stand out. A node without cells has no excess.
 *
 * At a tied interface of a pad of layers, whose nodes at one place have moved together, the excess is the
 * less of that over the neighbours in the node's own layer and that over those in all layers there: a layer
 * that its stiffer or softer partner carries along does not collapse. compression: [node_count];
 * displacement: [node_count][3] m, or NULL: own layers only. */
sf_status sf_strain_field_collapse(const sf_results *results, const double *compression,
                                   const double *displacement, double *collapse, sf_error *err);

/* Share, of the energy of the foam, of the nodes whose compression exceeds `strain`; 0 without energy.
 * energy_density: [node_count] J m-3. */
double sf_strain_field_energy_beyond(const sf_results *results, const double *compression,
                                     const double *energy_density, double strain);

#endif
