/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/hold.h"

#include <gsl/gsl_eigen.h>
#include <math.h>
#include <string.h>

enum { MOTIONS = 6 }; /* of each layer: along x, y, z, about x, y, z */

static const double FREE = 1e-9; /* of the mean square of what is held: a motion that moves no held node */
static const double PART = 1e-6; /* of a motion: none */
static const double UNDERSIDE = 1e-3; /* of the thickness */

/* Middle and half size of the pad. */
static void find_box(const sf_model *m, double middle[3], double *size) {
    *size = 0;
    for (int c = 0; c < 3; c++) {
        double low = INFINITY, high = -INFINITY;
        for (int64_t i = 0; i < m->node_count; i++) {
            low = fmin(low, m->position[3 * i + c]);
            high = fmax(high, m->position[3 * i + c]);
        }
        middle[c] = 0.5 * (low + high);
        *size = fmax(*size, 0.5 * (high - low));
    }
}

/* Displacement of the place r along axis c in each rigid motion of one layer. */
static void motion_row(const double r[3], int c, double row[MOTIONS]) {
    int next = (c + 1) % 3, last = (c + 2) % 3;
    memset(row, 0, MOTIONS * sizeof *row);
    row[c] = 1;
    row[3 + next] = r[last];
    row[3 + last] = -r[next];
}

/* Adds the square of what is forbidden: the displacement of one node, less that of another (-1: none) at the
 * same place, along axis c. */
static void add_row(const sf_model *m, const double r[3], int c, int32_t node, int32_t other,
                    gsl_matrix *sum) {
    double row[MOTIONS], weight = 1 / fmax(1, (double)(m->fixed_count + m->rest_count));
    const int32_t nodes[2] = {node, other};
    motion_row(r, c, row);
    for (int p = 0; p < 2; p++)
        for (int q = 0; q < 2; q++) {
            if (nodes[p] < 0 || nodes[q] < 0)
                continue;
            size_t first = MOTIONS * (size_t)m->node_material[nodes[p]],
                   second = MOTIONS * (size_t)m->node_material[nodes[q]];
            for (size_t a = 0; a < MOTIONS; a++)
                for (size_t b = 0; b < MOTIONS; b++)
                    *gsl_matrix_ptr(sum, first + a, second + b) +=
                        (p == q ? 1 : -1) * row[a] * row[b] * weight;
        }
}

/* Displacements that are forbidden: of one node, or of one less that of another. The weight holds what rests.
 */
typedef struct rows {
    int64_t count;
    const int32_t *node, *other; /* [count]; other NULL: of one */
    const uint8_t *mask;         /* [count]; NULL: z */
} rows;

/* Sum of the squares of what constraints, the anvil and ties forbid, as a matrix; its null space is free. */
static void add_rows(const sf_model *m, gsl_matrix *sum, sf_hold *hold) {
    double middle[3], size;
    find_box(m, middle, &size);
    const rows part[] = {{m->fixed_count, m->fixed_node, NULL, m->fixed_mask},
                         {m->rest_count, m->rest_node, NULL, NULL},
                         {m->tie_count, m->tie_node, m->tie_other, m->tie_mask}};
    for (const rows *p = part; p < part + 3; p++)
        for (int64_t k = 0; k < p->count; k++) {
            uint8_t mask = p->mask ? p->mask[k] : SF_FIX_Z;
            double r[3];
            for (int i = 0; i < 3; i++)
                r[i] = (m->position[3 * (int64_t)p->node[k] + i] - middle[i]) / size;
            for (int c = 0; c < 3; c++) {
                if (!(mask & 1 << c))
                    continue;
                hold->rows[c] += p->other == NULL;
                add_row(m, r, c, p->node[k], p->other ? p->other[k] : -1, sum);
            }
        }
}

static void name_motion(const gsl_matrix *vector, size_t k, size_t layer, sf_hold *hold) {
    double part[MOTIONS];
    for (size_t a = 0; a < MOTIONS; a++)
        part[a] = fabs(gsl_matrix_get(vector, MOTIONS * layer + a, k));
    if (!hold->lifts && (part[2] > PART || part[3] > PART || part[4] > PART)) {
        hold->lifts = true;
        hold->lifted = (int64_t)layer;
    }
    hold->slides[0] = hold->slides[0] || part[0] > PART;
    hold->slides[1] = hold->slides[1] || part[1] > PART;
    hold->turns = hold->turns || part[5] > PART;
}

static void find_underside(const sf_model *m, sf_hold *hold) {
    double low = INFINITY, high = -INFINITY;
    int64_t nodes = 0, held = m->rest_count; /* which are the lowest nodes */
    for (int64_t i = 0; i < m->node_count; i++) {
        low = fmin(low, m->position[3 * i + 2]);
        high = fmax(high, m->position[3 * i + 2]);
    }
    double top = low + UNDERSIDE * (high - low);
    for (int64_t i = 0; i < m->node_count; i++)
        nodes += m->position[3 * i + 2] <= top;
    for (int64_t k = 0; k < m->fixed_count; k++)
        held += m->position[3 * (int64_t)m->fixed_node[k] + 2] <= top && (m->fixed_mask[k] & SF_FIX_Z);
    hold->underside = (double)held / (double)nodes;
    hold->underside_low = low;
}

sf_status sf_hold_find(const sf_model *m, sf_hold *hold, sf_error *err) {
    *hold = (sf_hold){0};
    size_t layers = (size_t)m->node_material[m->node_count - 1] + 1, size = MOTIONS * layers;
    gsl_matrix *sum = gsl_matrix_calloc(size, size), *vector = gsl_matrix_alloc(size, size);
    gsl_vector *value = gsl_vector_alloc(size);
    gsl_eigen_symmv_workspace *work = gsl_eigen_symmv_alloc(size);
    if (!sum || !vector || !value || !work) {
        SF_FAIL(err, SF_ERR_MEMORY, "out of memory for the rigid motions of the pad");
    } else {
        add_rows(m, sum, hold);
        gsl_eigen_symmv(sum, value, vector, work);
        for (size_t k = 0; k < size; k++)
            for (size_t layer = 0; layer < layers && !(gsl_vector_get(value, k) > FREE); layer++)
                name_motion(vector, k, layer, hold);
        find_underside(m, hold);
    }
    gsl_matrix_free(sum);
    gsl_matrix_free(vector);
    gsl_vector_free(value);
    gsl_eigen_symmv_free(work);
    return err->status;
}

sf_status sf_hold_check(const sf_hold *hold, const sf_model *m, sf_error *err) {
    if (!hold->lifts)
        return SF_OK;
    if (m->material_count > 1 && hold->rows[2] > 0)
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "pad.fixed, pad.sliding, pad.sliding_interfaces: nothing keeps the layer \"%s\" from being lifted or "
            "tilted: what holds it along z lies at a point or on a line, or is nothing",
            m->material[hold->lifted].name);
    if (hold->rows[2] == 0)
        return SF_FAIL(
            err, SF_ERR_INPUT,
            "pad.fixed, pad.sliding: nothing holds the pad along z: the missile would push it away whole; name "
            "its underside in one of them");
    return SF_FAIL(
        err, SF_ERR_INPUT,
        "pad.fixed, pad.sliding: the %lld nodes that are held along z lie at a point or on a line: the pad "
        "can tilt; name its underside in one of them",
        (long long)hold->rows[2]);
}

void sf_hold_warn(const sf_hold *hold, const sf_model *m, const sf_sink *sink) {
    if (hold->underside < SF_HOLD_MOST)
        sf_sink_tell(
            sink, SF_WARNING,
            "pad.fixed, pad.sliding: %.3g %% of the nodes of the pad's underside (z = %.4g mm) are held along z: "
            "the rest hangs free",
            100 * hold->underside, 1e3 * hold->underside_low);
    for (int c = 0; c < 2; c++)
        if (hold->slides[c] && m->missile.direction[c] != 0 && !(m->anvil.friction > 0))
            sf_sink_tell(
                sink, SF_WARNING,
                "nothing holds the pad along %c, where missile.direction has the component %g: it will slide "
                "away",
                'x' + c, m->missile.direction[c]);
}
