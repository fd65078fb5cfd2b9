/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/view/cells.h"

#include "model/model.h"

int sf_cell_tetrahedra(int type, const int (**tetrahedra)[4]) {
    static const int simple[1][4] = {{0, 1, 2, 3}};
    static const int pyramid[2][4] = {{0, 1, 2, 4}, {0, 2, 3, 4}};
    static const int prism[3][4] = {{0, 1, 2, 5}, {0, 1, 4, 5}, {0, 4, 3, 5}};
    static const int hexahedron[6][4] = {{0, 1, 2, 6}, {0, 2, 3, 6}, {0, 3, 7, 6},
                                         {0, 7, 4, 6}, {0, 4, 5, 6}, {0, 5, 1, 6}};
    switch (type) {
    case SF_CELL_PYRAMID:
        *tetrahedra = pyramid;
        return 2;
    case SF_CELL_PRISM:
        *tetrahedra = prism;
        return 3;
    case SF_CELL_HEXAHEDRON:
        *tetrahedra = hexahedron;
        return 6;
    default:
        *tetrahedra = simple;
        return 1;
    }
}

int sf_cell_faces(int type, const int (**faces)[4]) {
    static const int tetrahedron[4][4] = {{0, 2, 1, -1}, {0, 1, 3, -1}, {1, 2, 3, -1}, {0, 3, 2, -1}};
    static const int pyramid[5][4] = {
        {0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}};
    static const int prism[5][4] = {{0, 2, 1, -1}, {3, 4, 5, -1}, {0, 1, 4, 3}, {1, 2, 5, 4}, {2, 0, 3, 5}};
    static const int hexahedron[6][4] = {{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                         {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    switch (type) {
    case SF_CELL_PYRAMID:
        *faces = pyramid;
        return 5;
    case SF_CELL_PRISM:
        *faces = prism;
        return 5;
    case SF_CELL_HEXAHEDRON:
        *faces = hexahedron;
        return 6;
    default:
        *faces = tetrahedron;
        return 4;
    }
}
