/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/cell_topology.h"

#include "model/model.h"
#include <stddef.h>

static const sf_cell_topology tetrahedron = {
    4,
    6,
    4,
    {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}},
    {3, 3, 3, 3},
    {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}},
    {{1, 0}, {2, 0}, {3, 0}, {3, 1}, {1, 2}, {2, 3}},
};

static const sf_cell_topology pyramid = {
    5,
    8,
    5,
    {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 4}, {1, 4}, {2, 4}, {3, 4}},
    {4, 3, 3, 3, 3},
    {{0, 3, 2, 1}, {0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}},
    {{1, 0}, {2, 0}, {3, 0}, {4, 0}, {4, 1}, {1, 2}, {2, 3}, {3, 4}},
};

static const sf_cell_topology prism = {
    6,
    9,
    5,
    {{0, 1}, {1, 2}, {2, 0}, {3, 4}, {4, 5}, {5, 3}, {0, 3}, {1, 4}, {2, 5}},
    {3, 3, 4, 4, 4},
    {{0, 2, 1}, {3, 4, 5}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}},
    {{2, 0}, {3, 0}, {4, 0}, {1, 2}, {1, 3}, {1, 4}, {4, 2}, {2, 3}, {3, 4}},
};

static const sf_cell_topology hexahedron = {
    8,
    12,
    6,
    {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {4, 5}, {5, 6}, {6, 7}, {7, 4}, {0, 4}, {1, 5}, {2, 6}, {3, 7}},
    {4, 4, 4, 4, 4, 4},
    {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}},
    {{2, 0}, {3, 0}, {4, 0}, {5, 0}, {1, 2}, {1, 3}, {1, 4}, {1, 5}, {5, 2}, {2, 3}, {3, 4}, {4, 5}},
};

const sf_cell_topology *sf_cell_topology_of(int type) {
    switch (type) {
    case SF_CELL_TETRAHEDRON:
        return &tetrahedron;
    case SF_CELL_PYRAMID:
        return &pyramid;
    case SF_CELL_PRISM:
        return &prism;
    case SF_CELL_HEXAHEDRON:
        return &hexahedron;
    default:
        return NULL;
    }
}
