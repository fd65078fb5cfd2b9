/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/strain_field.h"

#include <math.h>
#include <stdlib.h>

/* The cells of each node: those of node n are cell[first[n]] to cell[first[n + 1] - 1]. */
typedef struct node_cells {
    int64_t *first; /* [node_count + 2] owned */
    int64_t *cell;  /* [cell_nnz] owned */
} node_cells;

static void list_cells(const sf_results *r, node_cells *n) {
    for (int64_t k = 0; k < r->cell_nnz; k++)
        n->first[r->cell_node[k] + 2]++;
    for (int64_t i = 0; i < r->node_count; i++)
        n->first[i + 2] += n->first[i + 1];
    for (int64_t c = 0; c < r->cell_count; c++) /* moves first[i + 1] from the start of node i to its end */
        for (int64_t k = r->cell_ptr[c]; k < r->cell_ptr[c + 1]; k++)
            n->cell[n->first[r->cell_node[k] + 1]++] = c;
}

/* Copies the neighbours' values of a node; room: NULL counts only. */
static int64_t gather(const sf_results *r, const node_cells *n, int64_t node, const double *value,
                      double *room) {
    int64_t count = 0;
    for (int64_t k = n->first[node]; k < n->first[node + 1]; k++)
        for (int64_t j = r->cell_ptr[n->cell[k]]; j < r->cell_ptr[n->cell[k] + 1]; j++) {
            if (r->cell_node[j] == node)
                continue;
            if (room)
                room[count] = value[r->cell_node[j]];
            count++;
        }
    return count;
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Of an even number of values the upper one of the two in the middle, so that half of them reach it. */
static double median(double *value, int64_t count) {
    qsort(value, (size_t)count, sizeof *value, ascending);
    return value[count / 2];
}

static int64_t most_neighbours(const sf_results *r, const node_cells *n) {
    int64_t most = 0;
    for (int64_t i = 0; i < r->node_count; i++) {
        int64_t count = gather(r, n, i, NULL, NULL);
        most = count > most ? count : most;
    }
    return most;
}

sf_status sf_strain_field_collapse(const sf_results *r, const double *compression, double *collapse,
                                   sf_error *err) {
    node_cells n = {.first =
                        sf_alloc(err, (unsigned long)r->node_count + 2, sizeof *n.first, "cells of nodes"),
                    .cell = sf_alloc(err, (unsigned long)r->cell_nnz, sizeof *n.cell, "cells of nodes")};
    double *room = NULL;
    *collapse = 0;
    if (err->status == SF_OK) {
        list_cells(r, &n);
        room = sf_alloc(err, (unsigned long)most_neighbours(r, &n), sizeof *room, "neighbours of a node");
    }
    for (int64_t i = 0; err->status == SF_OK && i < r->node_count; i++) {
        int64_t count = compression[i] > *collapse ? gather(r, &n, i, compression, room) : 0;
        if (count > 0)
            *collapse = fmax(*collapse, compression[i] - median(room, count));
    }
    free(room);
    free(n.first);
    free(n.cell);
    return err->status;
}

double sf_strain_field_energy_beyond(const sf_results *r, const double *compression,
                                     const double *energy_density, double strain) {
    double all = 0, beyond = 0;
    for (int64_t i = 0; i < r->node_count; i++) {
        double energy = r->volume[i] * energy_density[i];
        all += energy;
        beyond += compression[i] > strain ? energy : 0;
    }
    return all > 0 ? beyond / all : 0;
}
