/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/hold.h"

#include "base/sets.h"
#include "pre/mesh/mesh.h"
#include <gsl/gsl_eigen.h>

#include "base/mat3.h"

enum { ALL = SF_FIX_X | SF_FIX_Y | SF_FIX_Z };

/* The connected parts of a pad of layers: cells that share a face, within a layer or where all the nodes of
 * the face are tied in all components. Parts move rigidly against each other unless ties or supports hold
 * them. */
typedef struct body_list {
    int64_t count;
    int64_t *cell;  /* [cell_count] owned */
    int32_t *node;  /* [node_count] owned; of a node where several bodies meet one of them */
    int32_t *first; /* [count] owned; the first node of each, ascending */
} body_list;

/* [cell_count] the lowest cell of each one's body; owned by the caller. */
static int64_t *join_cells(const sf_model *m, sf_error *err) {
    int64_t count = 0;
    SF_OWNED sf_cell_face *face = NULL;
    SF_OWNED int64_t *place = sf_sets_alone(m->node_count, "parts of the pad", err);
    int64_t *parent = sf_sets_alone(m->cell_count, "parts of the pad", err);
    for (int64_t k = 0; place && k < m->tie_count; k++)
        if (m->tie_mask[k] == ALL)
            sf_sets_join(place, m->tie_node[k], m->tie_other[k]);
    if (place && parent &&
        (face = sf_cell_faces(&SF_CELLS_OF(m), place, sf_cell_face_compare, &count, err))) {
        for (int64_t k = 1; k < count; k++)
            if (memcmp(face[k].key, face[k - 1].key, sizeof face[k].key) == 0)
                sf_sets_join(parent, face[k].cell, face[k - 1].cell);
        for (int64_t c = 0; c < m->cell_count; c++)
            parent[c] = sf_sets_find(parent, c);
    }
    return sf_keep(parent, err);
}

/* Bodies in the order of their first nodes; b->cell holds the lowest cells and becomes the numbers. `number`
 * [cell_count] is room. */
static void number_bodies(const sf_model *m, int32_t *number, body_list *b) {
    for (int64_t i = 0; i < m->node_count; i++)
        b->node[i] = -1;
    for (int64_t c = 0; c < m->cell_count; c++) {
        number[c] = -1;
        for (int64_t k = m->cell_ptr[c]; k < m->cell_ptr[c + 1]; k++)
            if (b->node[m->cell_node[k]] < 0)
                b->node[m->cell_node[k]] = (int32_t)b->cell[c];
    }
    for (int32_t i = 0; i < (int32_t)m->node_count; i++) {
        int32_t body = b->node[i] < 0 ? 0 : b->node[i];
        if (number[body] < 0) {
            b->first[b->count] = i;
            number[body] = (int32_t)b->count++;
        }
        b->node[i] = number[body];
    }
    for (int64_t c = 0; c < m->cell_count; c++)
        b->cell[c] = number[b->cell[c]];
}

static sf_status find_parts(const sf_model *m, body_list *b, sf_error *err) {
    SF_OWNED int32_t *number = sf_alloc(err, m->cell_count, sizeof *number, "parts of the pad");
    SF_ALLOC_ALL(err, "parts of the pad", SF_ROOM(b->node, m->node_count), SF_ROOM(b->first, m->cell_count));
    if (err->status == SF_OK && (b->cell = join_cells(m, err)))
        number_bodies(m, number, b);
    return err->status;
}

static void free_bodies(body_list *b) {
    SF_CLEAR(b, b->cell, b->node, b->first);
}

/* A pad of one material and without ties is one body. On failure `*b` is empty. */
static sf_status find_bodies(const sf_model *m, body_list *b, sf_error *err) {
    *b = (body_list){0};
    if (m->node_material[m->node_count - 1] > 0) {
        find_parts(m, b, err);
    } else {
        b->count = 1;
        SF_ALLOC_ALL(err, "parts of the pad", SF_ROOM(b->cell, m->cell_count),
                     SF_ROOM(b->node, m->node_count), SF_ROOM(b->first, 1));
    }
    if (err->status != SF_OK)
        free_bodies(b);
    return err->status;
}

enum {
    MOTIONS = 6, /* of each part: along x, y, z, about x, y, z */
    MOST_BODIES = 200,
};

static const double FREE =
    1e-9; /* of the mean square of what holds a part: a motion that moves no held node */
static const double PART = 1e-6;      /* of a motion: none */
static const double UNDERSIDE = 1e-3; /* of the thickness */

/* Middle and half size of the pad. */
static void find_box(const sf_model *m, double middle[3], double *size) {
    double low[3], high[3];
    sf_box3(m->node_count, m->position, low, high);
    *size = 0;
    for (int c = 0; c < 3; c++) {
        middle[c] = 0.5 * (low[c] + high[c]);
        *size = fmax(*size, 0.5 * (high[c] - low[c]));
    }
}

/* Displacement of the place r along axis c in each rigid motion of one part. */
static void motion_row(const double r[3], int c, double row[MOTIONS]) {
    int next = (c + 1) % 3, last = (c + 2) % 3;
    memset(row, 0, MOTIONS * sizeof *row);
    row[c] = 1;
    row[3 + next] = r[last];
    row[3 + last] = -r[next];
}

/* The sum of squares of what is forbidden. */
typedef struct holder {
    const sf_model *model;
    const body_list *bodies;
    double middle[3], size;
    gsl_matrix *sum;   /* [6 bodies][6 bodies] */
    double *row_count; /* [bodies] */
} holder;

/* Adds the displacement of one part, less that of another (-1: none), at a node along axis c. */
static void add_row(holder *h, int32_t node, int32_t body, int32_t other, int c) {
    double row[MOTIONS], r[3];
    const int32_t bodies[2] = {body, other};
    for (int k = 0; k < 3; k++)
        r[k] = (h->model->position[3 * (int64_t)node + k] - h->middle[k]) / h->size;
    motion_row(r, c, row);
    for (int p = 0; p < 2; p++) {
        if (bodies[p] < 0)
            continue;
        h->row_count[bodies[p]]++;
        for (int q = 0; q < 2; q++) {
            if (bodies[q] < 0)
                continue;
            size_t first = MOTIONS * (size_t)bodies[p], second = MOTIONS * (size_t)bodies[q];
            for (size_t a = 0; a < MOTIONS; a++)
                for (size_t b = 0; b < MOTIONS; b++)
                    *gsl_matrix_ptr(h->sum, first + a, second + b) += (p == q ? 1 : -1) * row[a] * row[b];
        }
    }
}

/* Displacements that are forbidden: of one node, or of one less that of another. */
typedef struct rows {
    int64_t count;
    const int32_t *node, *other; /* [count]; other NULL: of one */
    const uint8_t *mask;         /* [count]; NULL: z */
} rows;

/* Adds the motions that constraints, the anvil (the weight holds a resting pad) and ties forbid. */
static void add_rows(holder *h, sf_hold *hold) {
    const sf_model *m = h->model;
    const int32_t *body = h->bodies->node;
    const rows part[] = {{m->fixed_count, m->fixed_node, NULL, m->fixed_mask},
                         {m->rest_count, m->rest_node, NULL, NULL},
                         {m->tie_count, m->tie_node, m->tie_other, m->tie_mask}};
    for (const rows *p = part; p < part + 3; p++)
        for (int64_t k = 0; k < p->count; k++) {
            int32_t own = body[p->node[k]], other = p->other ? body[p->other[k]] : -1;
            for (int c = 0; c < 3; c++) {
                if (!((p->mask ? p->mask[k] : SF_FIX_Z) & 1 << c))
                    continue;
                hold->rows[c] += p->other == NULL;
                if (own != other)
                    add_row(h, p->node[k], own, other, c);
            }
        }
}

/* Parts of a layer that share an edge or a point only are joined there. */
static void add_hinges(holder *h) {
    const sf_model *m = h->model;
    const body_list *b = h->bodies;
    for (int64_t cell = 0; cell < m->cell_count; cell++)
        for (int64_t k = m->cell_ptr[cell]; k < m->cell_ptr[cell + 1]; k++) {
            int32_t node = m->cell_node[k];
            for (int c = 0; c < 3 && b->node[node] != b->cell[cell]; c++)
                add_row(h, node, b->node[node], (int32_t)b->cell[cell], c);
        }
}

/* Small parts count as much as large ones: every part's rows by their number. */
static void scale_sum(holder *h) {
    for (size_t i = 0; i < h->sum->size1; i++) {
        h->row_count[i / MOTIONS] = fmax(1, h->row_count[i / MOTIONS]);
        for (size_t j = 0; j < h->sum->size2; j++)
            *gsl_matrix_ptr(h->sum, i, j) /=
                sqrt(h->row_count[i / MOTIONS] * fmax(1, h->row_count[j / MOTIONS]));
    }
}

/* The middle of a part, m; `alone`: it is the whole of its layer. */
static void place_part(const sf_model *m, const body_list *b, int64_t body, double middle[3], bool *alone) {
    double count = 0;
    uint8_t layer = m->node_material[b->first[body]];
    *alone = true;
    middle[0] = middle[1] = middle[2] = 0;
    for (int64_t i = 0; i < m->node_count; i++) {
        *alone = *alone && (b->node[i] == body || m->node_material[i] != layer);
        if (b->node[i] != body)
            continue;
        count++;
        for (int c = 0; c < 3; c++)
            middle[c] += m->position[3 * i + c];
    }
    for (int c = 0; c < 3; c++)
        middle[c] /= count;
}

static void name_motion(const holder *h, const gsl_matrix *vector, size_t k, size_t body, sf_hold *hold) {
    double part[MOTIONS], most = 0;
    for (size_t i = 0; i < vector->size1; i++)
        most = fmax(most, fabs(gsl_matrix_get(vector, i, k)) / sqrt(h->row_count[i / MOTIONS]));
    for (size_t a = 0; a < MOTIONS; a++)
        part[a] = fabs(gsl_matrix_get(vector, MOTIONS * body + a, k)) / sqrt(h->row_count[body]) / most;
    if (!hold->lifts && (part[2] > PART || part[3] > PART || part[4] > PART)) {
        hold->lifts = true;
        hold->lifted = h->model->node_material[h->bodies->first[body]];
        place_part(h->model, h->bodies, (int64_t)body, hold->lifted_middle, &hold->lifted_whole);
    }
    hold->slides[0] = hold->slides[0] || part[0] > PART;
    hold->slides[1] = hold->slides[1] || part[1] > PART;
    hold->turns = hold->turns || part[5] > PART;
}

static void find_underside(const sf_model *m, sf_hold *hold) {
    double low[3], high[3];
    int64_t nodes = 0, held = m->rest_count; /* which are the lowest nodes */
    sf_box3(m->node_count, m->position, low, high);
    double top = low[2] + UNDERSIDE * (high[2] - low[2]);
    for (int64_t i = 0; i < m->node_count; i++)
        nodes += m->position[3 * i + 2] <= top;
    for (int64_t k = 0; k < m->fixed_count; k++)
        held += m->position[3 * (int64_t)m->fixed_node[k] + 2] <= top && (m->fixed_mask[k] & SF_FIX_Z);
    hold->underside = (double)held / (double)nodes;
    hold->underside_low = low[2];
}

/* The null space of the sum is free. */
static sf_status find_motions(holder *h, sf_hold *hold, sf_error *err) {
    size_t bodies = (size_t)h->bodies->count, size = MOTIONS * bodies;
    h->sum = gsl_matrix_calloc(size, size);
    h->row_count = calloc(bodies, sizeof *h->row_count);
    gsl_matrix *vector = gsl_matrix_alloc(size, size);
    gsl_vector *value = gsl_vector_alloc(size);
    gsl_eigen_symmv_workspace *work = gsl_eigen_symmv_alloc(size);
    if (!h->sum || !h->row_count || !vector || !value || !work) {
        SF_NO_MEMORY(err, "the rigid motions of the pad");
    } else {
        find_box(h->model, h->middle, &h->size);
        add_rows(h, hold);
        add_hinges(h);
        scale_sum(h);
        gsl_eigen_symmv(h->sum, value, vector, work);
        for (size_t k = 0; k < size; k++)
            for (size_t body = 0; body < bodies && !(gsl_vector_get(value, k) > FREE); body++)
                name_motion(h, vector, k, body, hold);
    }
    gsl_matrix_free(h->sum);
    gsl_matrix_free(vector);
    gsl_vector_free(value);
    gsl_eigen_symmv_free(work);
    free(h->row_count);
    return err->status;
}

/* A section moves rigidly along the axis alone. */
static void find_section_hold(const sf_model *m, sf_hold *hold) {
    for (int64_t k = 0; k < m->fixed_count; k++)
        for (int c = 0; c < 3; c++)
            hold->rows[c] += m->fixed_mask[k] >> c & 1;
    hold->rows[2] += m->rest_count;
    hold->lifts = hold->lifted_whole = hold->rows[2] == 0;
    find_underside(m, hold);
}

sf_status sf_hold_find(const sf_model *m, sf_hold *hold, sf_error *err) {
    SF_OWNED_BY(free_bodies) body_list bodies = {0};
    *hold = (sf_hold){0};
    if (m->axisymmetric) {
        find_section_hold(m, hold);
        return SF_OK;
    }
    SF_TRY(find_bodies(m, &bodies, err));
    holder h = {.model = m, .bodies = &bodies};
    if (bodies.count > MOST_BODIES)
        SF_REFUSE(err,
                  "the layers fall into %lld parts that are not tied to each other altogether; at most %d "
                  "are supported",
                  (long long)bodies.count, MOST_BODIES);
    else if (find_motions(&h, hold, err) == SF_OK)
        find_underside(m, hold);
    return err->status;
}

/* A permanent set: motion as a whole in a drop would count as one. */
static sf_status check_set(const sf_hold *hold, const sf_model *m, sf_error *err) {
    const char *wrong =
        hold->lifts || hold->slides[0] || hold->slides[1] || hold->turns || m->rest_count > 0
            ? "a pad whose layers its base holds: none rests, stands on supports or smoothly, is loose or slides"
            : NULL;
    bool set = false;
    for (int64_t k = 0; k < m->material_count; k++) {
        const sf_memory *own = sf_foam_memory(&m->material[k]), *one = sf_foam_memory(m->material);
        set = set || own->set > 0;
        if (own->set != one->set || own->set_recovery != one->set_recovery ||
            (one->set_recovery > 0 && (own->start != one->start || own->permanent != one->permanent)))
            wrong =
                "foams with the same set and set_recovery, and where it recovers recovery_start and permanent";
    }
    return set && wrong ? SF_REFUSE(err, "material.memory.set: a permanent set needs %s", wrong) : SF_OK;
}

sf_status sf_hold_check(const sf_hold *hold, bool separate, const sf_model *m, sf_error *err) {
    SF_TRY(check_set(hold, m, err));
    if (!hold->lifts || m->support_triangle_count > 0 || (separate && hold->rows[2] > 0))
        return SF_OK;
    const double *x = hold->lifted_middle;
    char about[96] = "";
    if (!hold->lifted_whole)
        snprintf(about, sizeof about, " about (%.4g, %.4g, %.4g) mm", 1e3 * x[0], 1e3 * x[1], 1e3 * x[2]);
    if (m->material_count > 1 && hold->rows[2] > 0)
        return SF_REFUSE(err,
                         "pad.fixed, pad.sliding, pad.sliding_interfaces: nothing keeps the %slayer \"%s\"%s "
                         "from being lifted or tilted: what holds it along z lies at a point or on a line, "
                         "or is nothing",
                         *about ? "part of the " : "", m->material[hold->lifted].name, about);
    if (hold->rows[2] == 0)
        return SF_REFUSE(err,
                         "pad.fixed, pad.sliding: nothing holds the pad along z: the missile would push it "
                         "away whole; name its underside in one of them");
    return SF_REFUSE(err,
                     "pad.fixed, pad.sliding: the %lld nodes that are held along z lie at a point or on a "
                     "line: the pad can tilt; name its underside in one of them",
                     (long long)hold->rows[2]);
}

void sf_hold_warn(const sf_hold *hold, const sf_model *m, const sf_sink *sink) {
    if (hold->underside < SF_HOLD_MOST && m->support_triangle_count == 0)
        sf_sink_tell(sink, SF_WARNING,
                     "pad.fixed, pad.sliding: %.3g %% of the nodes of the pad's underside (z = %.4g mm) are "
                     "held along z: the rest hangs free",
                     100 * hold->underside, 1e3 * hold->underside_low);
    double friction = m->anvil.friction;
    for (int64_t k = 0; k < m->support_count; k++)
        friction = fmax(friction, m->support_friction[k]);
    for (int c = 0; c < 2; c++)
        if (hold->slides[c] && m->missile.direction[c] != 0 && !(friction > 0))
            sf_sink_tell(sink, SF_WARNING,
                         "nothing holds the pad along %c, where missile.direction has the component %g: it "
                         "will slide away",
                         'x' + c, m->missile.direction[c]);
}

/* ---- bodies that nothing reaches ---- */

typedef struct box {
    double low[3], high[3]; /* m */
} box;

static void widen(box *b, const double x[3], const double along[3], double way) {
    for (int r = 0; r < 3; r++) {
        b->low[r] = fmin(b->low[r], x[r] + way * along[r]);
        b->high[r] = fmax(b->high[r], x[r] + way * along[r]);
    }
}

static bool is_near(const box *a, const box *b, double reach) {
    bool near = true;
    for (int r = 0; r < 3; r++)
        near = near && a->low[r] < b->high[r] + reach && b->low[r] < a->high[r] + reach;
    return near;
}

/* Marks the bodies near the missile's way, the last box, or near one that is marked. */
static void spread_reach(int64_t bodies, const box *body, double reach, uint8_t *reached) {
    reached[bodies] = 1;
    for (bool changed = true; changed;) {
        changed = false;
        for (int64_t k = 0; k < bodies; k++)
            for (int64_t j = 0; j <= bodies && !reached[k]; j++)
                changed |= reached[k] = reached[j] && is_near(&body[k], &body[j], reach);
    }
}

sf_status sf_hold_warn_apart(const sf_model *m, const sf_sink *sink, sf_error *err) {
    SF_OWNED_BY(free_bodies) body_list b = {0};
    SF_TRY(find_parts(m, &b, err));
    SF_OWNED box *body = sf_alloc(err, b.count + 1, sizeof *body, "bodies of the pad");
    SF_OWN(uint8_t, reached, b.count + 1, "bodies of the pad", err);
    int64_t apart = 0, first = 0;
    for (int64_t k = 0; k <= b.count; k++)
        sf_box3(0, NULL, body[k].low, body[k].high);
    for (int64_t i = 0; i < m->node_count; i++)
        widen(&body[b.node[i]], &m->position[3 * i], m->missile.direction, 0);
    for (int64_t i = 0; i < m->surface_node_count; i++)
        for (int end = 0; end < 2; end++)
            widen(&body[b.count], &m->surface_position[3 * i], m->missile.direction,
                  end * (m->missile.gap + m->thickness));
    spread_reach(b.count, body, m->thickness, reached);
    for (int64_t k = b.count - 1; k >= 0; k--)
        if (!reached[k]) {
            apart++;
            first = k;
        }
    const box *own = &body[first];
    if (apart > 0)
        sf_sink_tell(sink, SF_WARNING,
                     "pad.separate: %lld of %lld bodies are out of reach, the first about (%.4g, %.4g, %.4g) "
                     "mm: neither the missile nor a body that it may move comes nearer than the pad's "
                     "thickness (%.4g mm), and they stay at rest",
                     (long long)apart, (long long)b.count, 500 * (own->low[0] + own->high[0]),
                     500 * (own->low[1] + own->high[1]), 500 * (own->low[2] + own->high[2]),
                     1e3 * m->thickness);
    return SF_OK;
}
