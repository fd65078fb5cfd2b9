/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The body of revolution that the section of an axisymmetric drop makes: a quarter of it, x >= 0 and y >= 0,
 * as a solid mesh, so that everything that shows a quarter model shows it as well. */
#pragma once
#include "base/error.h"

#include <stdint.h>

/* The nodes of the quarter: those of the section on the axis once, all others once for each of its half
 * planes. */
typedef struct sf_revolution {
    int64_t section_nodes, axis_nodes, nodes;
    int32_t *place; /* [section_nodes] among the nodes on the axis, or among the others */
    int32_t *node;  /* [nodes] its number in the section */
    uint8_t *plane; /* [nodes] number of its half plane, from y = 0 on */
} sf_revolution;

/* `position` [nodes][3] (m) of the section, x = 0 on the axis. */
sf_status sf_revolution_build(int64_t nodes, const double *position, sf_revolution *out, sf_error *err);
void sf_revolution_free(sf_revolution *revolution);

/* Cells of a section, by XDMF's codes, become those of the quarter; at the axis prisms, pyramids and
 * tetrahedra. The arrays are replaced. */
typedef struct sf_cell_lists {
    int64_t count, entries;
    uint8_t *type; /* [count] */
    int64_t *ptr;  /* [count + 1] */
    int32_t *node; /* [entries] */
} sf_cell_lists;
sf_status sf_revolution_cells(const sf_revolution *revolution, sf_cell_lists *cells, sf_error *err);

/* Part of a node's ring that belongs to the node of the quarter; their sum over the quarter is 1/4. */
double sf_revolution_share(const sf_revolution *revolution, int64_t node);

/* Turns a field of the section's nodes, [section_nodes][components], into one of the quarter's: vectors and
 * tensors (9 components, row-major) turn with their nodes, `vector` tells vectors from three scalars.
 * `*field` is replaced. */
sf_status sf_revolution_field(const sf_revolution *revolution, int components, bool vector, double **field,
                              sf_error *err);
