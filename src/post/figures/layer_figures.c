/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/figures/layer_figures.h"

#include "post/results/results_check.h"
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

static const double LARGE_SLIP = 0.02; /* of the thickness */

static const sf_row list[] = {{.key = "name",
                               .name = "layer",
                               SF_ROW_OF(STRING, sf_layer_figures, name),
                               .meaning = "of the layer in the case"},
#define ENTRY(member, row_key, row_factor, ...)                                                              \
    {.key = row_key,                                                                                         \
     .factor = row_factor,                                                                                   \
     SF_ROW_OF(NUMBER, sf_layer_figures, member),                                                            \
     .meaning = __VA_ARGS__},
                              SF_LAYER_FIGURES(ENTRY)
#undef ENTRY
};

sf_rows sf_layer_figure_rows(void) {
    return SF_ROWS(list);
}

/* Takes the sums of the solver by layer until the last frame. */
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

/* Adds the energies of the curves at the peak. */
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
            if (list[q].type == SF_ROW_NUMBER)
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

typedef struct placed_node {
    double x[3];
    int64_t node;
} placed_node;

static int by_place(const void *a, const void *b) {
    const placed_node *p = a, *q = b;
    for (int c = 0; c < 3; c++)
        if (p->x[c] != q->x[c])
            return p->x[c] < q->x[c] ? -1 : 1;
    return (p->node > q->node) - (p->node < q->node);
}

/* Returns the largest distance (m) between nodes that were at one place, and one of them in `at`. */
static double largest_slip(const sf_results *r, const double *displacement, placed_node *places,
                           int64_t *at) {
    double most = 0;
    for (int64_t i = 0; i < r->node_count; i++) {
        memcpy(places[i].x, &r->position[3 * i], sizeof places[i].x);
        places[i].node = i;
    }
    qsort(places, (size_t)r->node_count, sizeof *places, by_place);
    for (int64_t k = 1; k < r->node_count; k++) {
        if (memcmp(places[k].x, places[k - 1].x, sizeof places[k].x) != 0)
            continue;
        double square = 0;
        for (int c = 0; c < 3; c++)
            square += pow(displacement[3 * places[k].node + c] - displacement[3 * places[k - 1].node + c], 2);
        if (square > most) {
            most = square;
            *at = places[k].node;
        }
    }
    return sqrt(most);
}

sf_status sf_layers_note_slip(sf_results *r, sf_error *err) {
    sf_frame peak;
    sf_error problem = SF_ERROR_INIT;
    if (r->layer_count == 0 || !r->has_peak ||
        sf_frame_read_fields(r, &r->peak, SF_FIELD_DISPLACEMENT, &peak, &problem) != SF_OK)
        return SF_OK; /* the figures say what is damaged */
    placed_node *places = sf_alloc(err, (unsigned long)r->node_count, sizeof *places, "the slip of layers");
    int64_t at = 0;
    double slip = places && peak.field[SF_FRAME_DISPLACEMENT]
                      ? largest_slip(r, peak.field[SF_FRAME_DISPLACEMENT], places, &at)
                      : 0;
    const double *x = &r->position[3 * at];
    if (slip > LARGE_SLIP * r->thickness)
        sf_results_note(
            r,
            "layers slide on each other by up to %.3g mm, at (%.4g, %.4g, %.4g) mm: their ties hold "
            "along the undeformed normal, which is right for small slips",
            1e3 * slip, 1e3 * x[0], 1e3 * x[1], 1e3 * x[2]);
    free(places);
    sf_frame_free(&peak);
    return err->status;
}
