/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes bodies that can be shown from model and results: the skin of the pad, and the missile. */
#ifndef SF_GUI_SHAPE_H
#define SF_GUI_SHAPE_H

#include "model/cells.h"
#include "model/model.h"
#include "gui/gmsh/view.h"
#include "post/results/results.h"

/* Pad and missile. */
typedef struct sf_shape {
    double unit; /* m per unit of the pictures */
    sf_body pad;
    int64_t *pad_node; /* [pad.node_count] node of the model that each node of the skin is; owned */
    sf_body missile;
    double *missile_position; /* [missile.node_count][3] m, at t = 0; owned */
} sf_shape;

/* The faces that belong to one cell only, in the length unit `unit`. Release with sf_shape_free. */
sf_status sf_shape_of_model(const sf_model *model, double unit, sf_shape *shape, sf_error *err);
sf_status sf_shape_of_results(const sf_results *results, double unit, sf_shape *shape, sf_error *err);
void sf_shape_free(sf_shape *shape);

/* One frame: displacement of pad and missile in units, and the pad's von Mises stress (kPa), for the nodes of
 * the bodies. Arrays from sf_alloc, owned by the caller; `stress` NULL if the frame has none. */
typedef struct sf_shape_frame {
    double *pad, *stress, *missile;
} sf_shape_frame;
sf_status sf_shape_read_frame(const sf_shape *shape, const sf_results *results, const sf_frame_head *head,
                              sf_shape_frame *frame, sf_error *err);
void sf_shape_frame_free(sf_shape_frame *frame);

#endif
