/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/field/domain_stress.h"

#include "solver/time_step.h"
#include "model/stability.h"

/* Columns of F - I of domain l, from the coefficients d that its group sees. Two sums run side by side,
 * because each addition waits for the one before. */
static inline void displacement_gradient(const sf_model *m, const sf_halo *h, const sf_vec *restrict d,
                                         int64_t l, sf_vec g[3]) {
    const int64_t first = m->domain_ptr[l], count = m->domain_ptr[l + 1] - first;
    const double *b = &m->domain_b[3 * first];
    const uint16_t *local = &h->local[first];
    sf_vec sum[2][3] = {{{0}, {0}, {0}}, {{0}, {0}, {0}}};
    for (int64_t k = 0; k + 1 < count; k += 2) {
        sf_vec x = d[local[k]], y = d[local[k + 1]];
        __builtin_prefetch(&b[3 * k + SF_AHEAD]);
        for (int c = 0; c < 3; c++) {
            sum[0][c] += x * b[3 * k + c];
            sum[1][c] += y * b[3 * k + 3 + c];
        }
    }
    for (int c = 0; c < 3; c++) {
        if (count % 2)
            sum[0][c] += d[local[count - 1]] * b[3 * (count - 1) + c];
        g[c] = sum[0][c] + sum[1][c];
    }
}

/* The coefficients that group g sees. */
static SF_KERNEL void gather_group(const sf_model *m, const sf_halo *h, int64_t g, const double *d,
                                   sf_vec *seen) {
    for (int64_t i = sf_halo_first(g); i < sf_halo_end(m, g); i++)
        *seen++ = sf_vec_load(&d[3 * i]);
    for (int64_t q = h->ptr[g]; q < h->ptr[g + 1]; q++)
        *seen++ = sf_vec_load(&d[3 * (int64_t)h->node[q]]);
}

/* Lanes first .. first + count - 1 of a batch from the state and the gathered coefficients `d`; spare lanes
 * are an undeformed point. */
static void load_batch(const sf_model *m, const sf_operators *op, const sf_state *s, const sf_vec *d,
                       int64_t block, int count, sf_law_batch *b) {
    int64_t first = block * SF_LANES;
    for (int l = 0; l < SF_LANES; l++) {
        static const double rest[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
        const double *old = l < count ? &s->f[9 * (first + l)] : rest;
        double fixed = l < count ? op->law[m->node_material[first + l]].length : 1;
        sf_vec g[3] = {{0}, {0}, {0}};
        if (l < count)
            displacement_gradient(m, &op->halo, d, first + l, g);
        for (int r = 0; r < 3; r++)
            for (int c = 0; c < 3; c++)
                b->f[3 * r + c][l] = (r == c) + g[c][r];
        if (m->axisymmetric) { /* the second column of B is the hoop row of u_R */
            b->f[4][l] = 1 + b->f[1][l];
            b->f[1][l] = b->f[7][l] = 0;
        }
        for (int k = 0; k < 9; k++)
            b->f_old[k][l] = old[k];
        b->length[l] = fixed > 0 ? fixed : m->spacing[first + l];
    }
}

/* The lanes of `part` that are of material k, into the batch and their history; spare lanes count as the last
 * material's. */
static void take_lanes(const sf_material_law *law, const uint8_t *material, int count, int k,
                       const sf_law_batch *part, double *history, sf_law_batch *b) {
    static const size_t row = SF_LANES * sizeof(double), end = offsetof(sf_law_batch, directions);
    for (int l = 0; l < SF_LANES; l++) {
        if (material[l < count ? l : count - 1] != k)
            continue;
        for (size_t at = (size_t)l * sizeof(double); at < end; at += row)
            memcpy((char *)b + at, (const char *)part + at, sizeof(double));
        for (int r = 0; r < law->rows && history; r++)
            history[SF_LANES * r + l] = part->history[law->row[r]][l];
    }
}

/* A step of dt for the history of a block, then a rest of `pause` (s; 0: none). */
typedef struct law_step {
    double dt, pause;
    const double *from;
    double *to; /* NULL: not stored; may be `from` */
} law_step;

/* Updates the batch of a block with the laws of its nodes' materials. Nodes are ordered by material: nearly
 * every block has one. A block at a border is updated once for each of its materials. */
static void update_laws(const sf_model *m, const sf_operators *op, const law_step *step, int64_t block,
                        int count, sf_law_batch *b) {
    double dt = step->dt, pause = step->pause;
    const uint8_t *material = &m->node_material[block * SF_LANES];
    int first = material[0], last = material[count - 1];
    if (first == last) {
        const sf_material_law *law = &op->law[first];
        sf_material_load_history(law, step->from, b);
        law->law->update(law->numbers, dt, b);
        if (pause > 0)
            law->law->rest(law->numbers, pause, b->history);
        if (step->to)
            sf_material_store_history(law, b, step->to);
        return;
    }
    const sf_law_batch start = *b;
    for (int k = first; k <= last; k++) {
        sf_law_batch part = start;
        sf_material_load_history(&op->law[k], step->from, &part);
        op->law[k].law->update(op->law[k].numbers, dt, &part);
        if (pause > 0)
            op->law[k].law->rest(op->law[k].numbers, pause, part.history);
        take_lanes(&op->law[k], material, count, k, &part, step->to, b);
    }
}

/* Sums and extremes of a chunk, lane by lane, so that one batch does not wait for the one before. */
typedef struct lane_sums {
    double stored[SF_LANES], hysteresis[SF_LANES], viscous[SF_LANES], given_back[SF_LANES];
    double slowness[SF_LANES]; /* s-1, largest inverse of a stable step, times 4 */
    double load[SF_LANES], shortest[SF_LANES];
    double jacobian[SF_LANES], block[SF_LANES]; /* smallest, and in which block of the chunk; a NaN is kept */
} lane_sums;

/* A spare lane weighs nothing and is not stiff. */
typedef struct lane_weights {
    double volume[SF_LANES], stability[SF_LANES];
} lane_weights;

/* Bounds of the time step (model/stability.h) and effective tangents. */
static void bound_steps(const lane_weights *w, double tightness, double dt_old, const sf_law_batch *b,
                        double tangent[SF_LANES], lane_sums *sum) {
    double inverse = dt_old > 0 ? 2 / dt_old : 0;
    for (int l = 0; l < SF_LANES; l++)
        tangent[l] = 0;
    for (int i = 0; i < 3; i++)
        SF_EACH_LANE (l) {
            double a = b->direction_tangent[i][l], eta = b->direction_viscosity[i][l];
            tangent[l] = sf_larger(a + eta * inverse, tangent[l]);
            sum->slowness[l] =
                sf_larger(sf_stability_slowness(w->stability[l] * tightness, a, eta), sum->slowness[l]);
        }
    SF_EACH_LANE (l)
        sum->load[l] = sf_larger(w->stability[l] * tangent[l], sum->load[l]);
}

static void add_batch(const lane_weights *w, double block, const sf_law_batch *b, lane_sums *sum) {
    SF_EACH_LANE (l) {
        double v = w->volume[l], shorter = sf_smaller(b->stretch[0][l], sum->shortest[l]);
        shorter = sf_smaller(b->stretch[1][l], shorter);
        sum->shortest[l] = sf_smaller(b->stretch[2][l], shorter);
        sum->stored[l] += v * b->stored[l];
        sum->hysteresis[l] += v * b->lost[l];
        sum->viscous[l] += v * b->work[l];
        bool kept = (b->jacobian[l] >= sum->jacobian[l]) | (sum->jacobian[l] != sum->jacobian[l]);
        sum->jacobian[l] = kept ? sum->jacobian[l] : b->jacobian[l];
        sum->block[l] = kept ? sum->block[l] : block;
    }
}

/* Lanes of the chunk into its sums. */
static void merge_lanes(const lane_sums *lane, int64_t first, sf_partial *sum) {
    double slowness = 0;
    *sum = (sf_partial){.jacobian = INFINITY, .shortest = INFINITY};
    for (int l = 0; l < SF_LANES; l++) {
        sum->stored += lane->stored[l];
        sum->hysteresis += lane->hysteresis[l];
        sum->viscous += lane->viscous[l];
        sum->given_back += lane->given_back[l];
        slowness = sf_larger(lane->slowness[l], slowness);
        sum->load = sf_larger(lane->load[l], sum->load);
        sum->shortest = sf_smaller(lane->shortest[l], sum->shortest);
        if (!(lane->jacobian[l] >= sum->jacobian) && !isnan(sum->jacobian)) {
            sum->jacobian = lane->jacobian[l];
            sum->jacobian_node = first + (int64_t)lane->block[l] * SF_LANES + l;
        }
    }
    sum->step = 4 / slowness;
}

static void store_batch(const sf_model *m, const sf_operators *op, sf_state *s, int64_t block, int count,
                        const sf_law_batch *b, lane_sums *sum) {
    int64_t first = block * SF_LANES;
    double tangent[SF_LANES];
    lane_weights w = {{0}, {0}};
    memcpy(w.volume, &m->volume[first], (size_t)count * sizeof *w.volume);
    memcpy(w.stability, &op->stability[first], (size_t)count * sizeof *w.stability);
    bound_steps(&w, s->tightness, s->dt_old, b, tangent, sum);
    add_batch(&w, (double)(block % (SF_CHUNK / SF_LANES)), b, sum);
    memcpy(&s->stiffness[first], b->stiffness, (size_t)count * sizeof *b->stiffness);
    memcpy(&s->tangent[first], tangent, (size_t)count * sizeof *tangent);
    for (int l = 0; l < count; l++) {
        int64_t i = first + l;
        double v = m->volume[i];
        for (int k = 0; k < 9; k++) {
            s->f[9 * i + k] = b->f[k][l];
            s->stress[9 * i + k] = v * b->p[k][l];
        }
        if (m->axisymmetric) { /* the hoop stress acts through the second column of B on f_R */
            s->stress[9 * i + 1] = s->stress[9 * i + 4];
            s->stress[9 * i + 4] = 0;
        }
        for (int k = 0; k < 6 && b->directions; k++)
            s->directional[6 * i + k] = (float)b->directional[k][l];
    }
}

/* Stores the viscous work of each node to date. */
static void store_work(const sf_model *m, sf_state *s, int64_t first, int count, const sf_law_batch *b,
                       lane_sums *sum) {
    double *restrict work = &s->viscous_work[first];
    const double *restrict volume = &m->volume[first];
#pragma omp simd
    for (int l = 0; l < count; l++) {
        work[l] += volume[l] * b->work[l];
        sum->given_back[l] += sf_larger(0, -work[l]);
    }
}

/* Stores the largest compressions for the report by layer at the end. */
static void store_layers(sf_state *s, int64_t first, int count, const sf_law_batch *b) {
    for (int l = 0; l < count; l++) {
        double shorter = sf_smaller(b->stretch[0][l], b->stretch[1][l]),
               compressed = 1 - sf_smaller(b->stretch[2][l], shorter);
        s->compressed[first + l] = sf_larger(compressed, s->compressed[first + l]);
    }
}

static SF_KERNEL void update_chunk(const sf_model *m, const sf_operators *op, sf_state *s, const sf_vec *d,
                                   int64_t chunk) {
    lane_sums sum = {.stored = {0}};
    for (int l = 0; l < SF_LANES; l++)
        sum.jacobian[l] = sum.shortest[l] = INFINITY;
    for (int64_t block = chunk * (SF_CHUNK / SF_LANES);
         block < (chunk + 1) * (SF_CHUNK / SF_LANES) && block * SF_LANES < m->node_count; block++) {
        sf_law_batch batch;
        int64_t left = m->node_count - block * SF_LANES;
        int count = left < SF_LANES ? (int)left : SF_LANES;
        batch.directions = sf_time_step_due(s);
        load_batch(m, op, s, d, block, count, &batch);
        double *history = &s->history[block * s->history_rows * SF_LANES];
        update_laws(m, op, &(law_step){s->dt_old, 0, history, history}, block, count, &batch);
        for (int l = count; l < SF_LANES; l++) /* nor is it short */
            batch.jacobian[l] = batch.stretch[0][l] = batch.stretch[1][l] = batch.stretch[2][l] = INFINITY;
        store_batch(m, op, s, block, count, &batch, &sum);
        store_work(m, s, block * SF_LANES, count, &batch, &sum);
        if (m->material_count > 1)
            store_layers(s, block * SF_LANES, count, &batch);
    }
    merge_lanes(&sum, chunk * SF_CHUNK, &s->partial[chunk]);
}

void sf_domain_law(const sf_model *m, const sf_operators *op, const sf_state *s, int64_t block,
                   sf_law_batch *b) {
    int64_t left = m->node_count - block * SF_LANES;
    memset(b, 0, sizeof *b);
    for (int l = 0; l < SF_LANES; l++) {
        int64_t i = block * SF_LANES + l;
        for (int k = 0; k < 9; k++)
            b->f[k][l] = b->f_old[k][l] = i < m->node_count ? s->f[9 * i + k] : k % 4 == 0;
        b->length[l] = 1;
    }
    update_laws(m, op, &(law_step){0, 0, &s->history[block * s->history_rows * SF_LANES], NULL}, block,
                left < SF_LANES ? (int)left : SF_LANES, b);
}

void sf_domain_rest(const sf_model *m, const sf_operators *op, sf_state *s, double pause) {
    s->pause = pause;
    s->ledger.before = 0;
    for (int64_t block = 0; block * SF_LANES < m->node_count; block++) {
        int64_t left = m->node_count - block * SF_LANES;
        double *history = &s->history[block * s->history_rows * SF_LANES];
        sf_law_batch b;
        memset(&b, 0, sizeof b);
        for (int l = 0; l < SF_LANES; l++) {
            for (int k = 0; k < 9; k += 4)
                b.f[k][l] = b.f_old[k][l] = 1;
            b.length[l] = 1;
        }
        for (int k = 0; k < 2; k++) /* the rest, and what is lost after it */
            update_laws(m, op, &(law_step){0, k ? 0 : pause, history, history}, block,
                        left < SF_LANES ? (int)left : SF_LANES, &b);
        for (int l = 0; l < SF_LANES && l < left; l++) {
            s->ledger.before += m->volume[block * SF_LANES + l] * b.lost[l];
            if (m->material_count > 1)
                s->lost_before[block * SF_LANES + l] = b.lost[l];
        }
    }
}

void sf_domain_stress(const sf_model *m, const sf_operators *op, sf_state *s) {
    static const int64_t chunks = SF_GROUP / SF_CHUNK;
    const sf_halo *h = &op->halo;
#pragma omp for schedule(static)
    for (int64_t g = 0; g < h->group_count; g++) {
        sf_vec d[SF_GROUP_SEES];
        gather_group(m, h, g, s->d, d);
        for (int64_t chunk = g * chunks; chunk < (g + 1) * chunks && chunk < s->chunk_count; chunk++)
            update_chunk(m, op, s, d, chunk);
    }
}

/* Adds V P B_J of domain l to the local sums of its nodes; x, y, z: columns of V P. */
static inline void add_domain(const sf_model *m, const sf_halo *h, int64_t l, sf_vec x, sf_vec y, sf_vec z,
                              sf_vec *restrict sum) {
    const int64_t first = m->domain_ptr[l], count = m->domain_ptr[l + 1] - first;
    const double *b = &m->domain_b[3 * first];
    const uint16_t *local = &h->local[first];
    for (int64_t k = 0; k < count; k++) {
        __builtin_prefetch(&b[3 * k + SF_AHEAD]);
        sum[local[k]] += x * b[3 * k] + y * b[3 * k + 1] + z * b[3 * k + 2];
    }
}

/* Forces of the domains of group g: on its own nodes at once; contributions to nodes owned by other groups
 * are stored and summed later in group order. */
static SF_KERNEL void collect_group(const sf_model *m, const sf_halo *h, const double *stress, int64_t g,
                                    double *force) {
    int64_t own = sf_halo_first(g), end = sf_halo_end(m, g), others = h->ptr[g + 1] - h->ptr[g];
    sf_vec seen[SF_GROUP_SEES];
    memset(seen, 0, (size_t)(end - own + others) * sizeof *seen);
    for (int64_t l = own; l < end; l++) {
        const double *p = &stress[9 * l];
        const sf_vec x = {p[0], p[3], p[6]}, y = {p[1], p[4], p[7]}, z = {p[2], p[5], p[8]};
        add_domain(m, h, l, x, y, z, seen);
    }
    for (int64_t i = own; i < end; i++)
        for (int r = 0; r < 3; r++)
            force[3 * i + r] -= seen[i - own][r];
    for (int64_t q = 0; q < others; q++)
        memcpy(&h->work[3 * (h->ptr[g] + q)], &seen[end - own + q], 3 * sizeof(double));
}

/* Subtracts the stored contributions of other groups from the forces on the nodes of group g. */
static SF_KERNEL void take_waiting(const sf_model *m, const sf_halo *h, int64_t g, double *force) {
    for (int64_t i = sf_halo_first(g); i < sf_halo_end(m, g); i++) {
        sf_vec f = {0};
        for (int32_t q = h->slot_ptr[i]; q < h->slot_ptr[i + 1]; q++)
            f += sf_vec_load(&h->work[3 * (int64_t)h->slot[q]]);
        for (int r = 0; r < 3; r++)
            force[3 * i + r] -= f[r];
    }
}

void sf_internal_force(const sf_model *m, const sf_operators *op, sf_state *s) {
    const sf_halo *h = &op->halo;
#pragma omp for schedule(static)
    for (int64_t g = 0; g < h->group_count; g++)
        collect_group(m, h, s->stress, g, s->force);
#pragma omp for schedule(static)
    for (int64_t g = 0; g < h->group_count; g++)
        take_waiting(m, h, g, s->force);
}
