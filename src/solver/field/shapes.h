/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The shape functions at the nodes in slabs of nodes, as frames need them: from the model, or once more from
 * its file when the model has dropped those of inner nodes (sf_model_drop_inner_shapes). */
#ifndef SF_SOLVER_FIELD_SHAPES_H
#define SF_SOLVER_FIELD_SHAPES_H

#include "core/error.h"
#include "core/lanes.h"
#include "core/model.h"
#include "io/h5.h"

enum { SF_SLAB = 64 * SF_LANES }; /* nodes: more would be felt in the memory of a run */

/* The rows in the model's file, which stays open meanwhile and may lose its name. */
typedef struct sf_shapes {
    sf_h5_source ptr, node, value;
    int64_t node_count;
    uint64_t *hash; /* [slabs] of the rows in the model that was read */
} sf_shapes;

/* Of a `model` with all its rows and the `file` that it was read from. Release with sf_shapes_close, also if
 * it failed. */
sf_status sf_shapes_open(const sf_model *model, const sf_h5 *file, sf_shapes *shapes, sf_error *err);
void sf_shapes_close(sf_shapes *shapes);

/* Row i of a slab that begins with node `first`: entries [ptr[i - first], ptr[i - first + 1]) - ptr[0]. */
typedef struct sf_shape_rows {
    int64_t first;
    const int64_t *ptr;
    const int32_t *node;
    const double *value;
    void *own[3]; /* what is not the model's */
} sf_shape_rows;

/* The slab of `count` rows from `first` on, a multiple of SF_SLAB. `shapes` NULL: the model has all rows.
 * SF_ERR_IO if the file does not give what it gave when the model was read. Release with sf_shapes_release.
 */
sf_status sf_shapes_read(const sf_shapes *shapes, const sf_model *model, int64_t first, int64_t count,
                         sf_shape_rows *rows, sf_error *err);
void sf_shapes_release(sf_shape_rows *rows);

#endif
