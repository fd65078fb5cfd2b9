/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "solver/contact/shape.h"

/* A plane that stops the pad: that of the anvil, and those of symmetry, beyond which its mirror image is. */
typedef struct sf_plane {
    int axis;     /* of its normal */
    double place; /* m, on that axis */
    double side;  /* 1 or -1: the pad lies above or below it on that axis */
} sf_plane;

sf_status sf_plane_build(const sf_plane *plane, sf_body *body, sf_error *err);
