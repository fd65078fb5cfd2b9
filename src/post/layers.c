/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/layers.h"

#include <math.h>
#include <stddef.h>
#include <stdlib.h>

static const sf_layer_figure list[] = {
#define ENTRY(member, key, factor, meaning) {key, factor, offsetof(sf_layer_figures, member), meaning},
    SF_LAYER_FIGURES(ENTRY)
#undef ENTRY
};

const sf_layer_figure *sf_layer_figure_list(size_t *count) {
    *count = sizeof list / sizeof list[0];
    return list;
}

/* What the solver has summed up by layer until the last frame. */
static void take_sums(const sf_results *r, sf_layer_figures *f) {
    for (int k = 0; k < r->layer_count; k++) {
        const sf_layer_sums *sums = &r->layer_sums[k];
        f[k].max_local_strain = sums->compression;
        f[k].stored_energy = sums->stored;
        f[k].hysteresis_energy = sums->hysteresis;
        f[k].viscous_energy = sums->viscous;
        f[k].absorbed_energy = f[k].stored_energy + f[k].hysteresis_energy + f[k].viscous_energy;
    }
}

/* Energies of the curves at the peak. */
static void add_peak(const sf_results *r, const double *compression, const double *energy_density,
                     sf_layer_figures *f) {
    double all = 0;
    for (int k = 0; k < r->layer_count; k++)
        f[k].energy_share = f[k].energy_beyond_data = 0;
    for (int64_t i = 0; i < r->node_count; i++) {
        sf_layer_figures *own = &f[r->node_layer[i]];
        double energy = r->volume[i] * energy_density[i];
        own->energy_share += energy;
        own->energy_beyond_data += compression[i] > own->informed_strain ? energy : 0;
        all += energy;
    }
    for (int k = 0; k < r->layer_count; k++) {
        f[k].energy_beyond_data = f[k].energy_share > 0 ? f[k].energy_beyond_data / f[k].energy_share : 0;
        f[k].energy_share = all > 0 ? f[k].energy_share / all : 0;
    }
}

sf_layer_figures *sf_layer_figures_compute(const sf_results *r, const double *compression,
                                           const double *energy_density, sf_error *err) {
    sf_layer_figures *f = r->layer_count > 0 ? sf_alloc(err, (unsigned long)r->layer_count, sizeof *f,
                                                        "the figures of the layers")
                                             : NULL;
    if (!f)
        return NULL;
    for (int k = 0; k < r->layer_count; k++) {
        for (size_t q = 0; q < sizeof list / sizeof list[0]; q++)
            *(double *)((char *)&f[k] + list[q].offset) = NAN;
        f[k].name = r->layer_name[k];
        f[k].density = r->layer_density[k];
        f[k].informed_strain = r->layer_informed[k];
        f[k].volume = 0;
    }
    for (int64_t i = 0; i < r->node_count; i++)
        f[r->node_layer[i]].volume += sf_results_whole(r) * r->volume[i];
    if (r->layer_sums)
        take_sums(r, f);
    if (compression && energy_density)
        add_peak(r, compression, energy_density, f);
    return f;
}
