/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/field/stabilisation.h"

#include "solver/operators.h"
#include "solver/state.h"

/* The data of a node that its pairs need. */
typedef struct pair_node {
    sf_vec x, d, f[3];
    double stiffness, before;
} pair_node;

/* True of a node on the axis of a section. Its domain's mean of F_RZ and F_ZR belongs to R = h / 3, but on
 * the axis both are 0: the pairs leave them out. */
static inline bool is_on_axis(const sf_model *m, int64_t i) {
    return m->axisymmetric && m->position[3 * i] == 0;
}

static inline void load_node(const sf_model *m, const sf_pair_field *field, int64_t i, pair_node *node) {
    node->stiffness = field->stiffness[i];
    node->before = field->before[i];
    node->x = sf_vec_load(&sf_model_coefficients(m)[3 * i]);
    node->d = sf_vec_load(&field->d[3 * i]);
    sf_vec_columns(&field->f[9 * i], node->f);
    if (is_on_axis(m, i))
        node->f[0][2] = node->f[2][0] = 0;
}

/* Contributions of one pair to its nodes: force on a, the opposite on b; the same couple and energies on
 * both. */
typedef struct pair_effect {
    sf_vec force, couple[3], before, after;
} pair_effect;

/* Stiffnesses (N m-1) of a pair that was passive with the first one at the end of the last step. */
typedef struct pair_stiffness {
    double before, now;
} pair_stiffness;

static inline pair_stiffness stiffness_of(const pair_node *a, const pair_node *b, double weight) {
    return (pair_stiffness){weight * (a->before + b->before), weight * (a->stiffness + b->stiffness)};
}

/* 2 F of the pair times v. */
static inline sf_vec map_twice(const pair_node *a, const pair_node *b, sf_vec v) {
    return (a->f[0] + b->f[0]) * v[0] + (a->f[1] + b->f[1]) * v[1] + (a->f[2] + b->f[2]) * v[2];
}

/* A pair without an offset whose stiffness does not rise. */
static inline void pull_pair(const pair_node *a, const pair_node *b, pair_stiffness k, pair_effect *out) {
    sf_vec arm = b->x - a->x, half = 0.5 * arm;
    sf_vec e = arm + (b->d - a->d) - map_twice(a, b, half), square = e * e;
    out->before = (0.25 * k.before) * square;
    out->after = (0.25 * k.now) * square;
    out->force = k.now * e;
    for (int c = 0; c < 3; c++)
        out->couple[c] = out->force * half[c];
}

static inline double dot(sf_vec a, sf_vec b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline sf_vec cross(sf_vec a, sf_vec b) {
    return (sf_vec){a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/* The x with F x = v, F the mean of the pair; 0 where F is singular. */
static inline sf_vec solve_mean(const pair_node *a, const pair_node *b, sf_vec v) {
    sf_vec f[3] = {a->f[0] + b->f[0], a->f[1] + b->f[1], a->f[2] + b->f[2]};
    sf_vec g[3] = {cross(f[1], f[2]), cross(f[2], f[0]), cross(f[0], f[1])};
    double det = dot(f[0], g[0]), inverse = det != 0 ? 2 / det : 0;
    return (sf_vec){inverse * dot(g[0], v), inverse * dot(g[1], v), inverse * dot(g[2], v)};
}

/* The least part of an offset whose image is b with |e + b - part b|^2 <= bound, which holds for all of it.
 */
static inline double least_part(sf_vec e, sf_vec b, double bound) {
    sf_vec all = e + b;
    double square = dot(b, b), along = dot(all, b), excess = dot(all, all) - bound;
    if (!(excess > 0 && square > 0))
        return 0;
    double root = along * along - square * excess, part = (along - sqrt(root > 0 ? root : 0)) / square;
    if (!(part > 0))
        return 0;
    return part < 1 ? part : 1;
}

/* The same with an offset P of the arm: e = x_b - x_a - F (X + P). Where the stiffness rises, e shrinks with
 * P so that 1/2 k |e|^2 stays; where it falls, P shrinks as far as the energy set free allows. */
static inline void pull_offset_pair(const pair_node *a, const pair_node *b, pair_stiffness k, double *offset,
                                    pair_effect *out) {
    sf_vec arm = b->x - a->x, p = sf_vec_load(offset);
    sf_vec e = arm + (b->d - a->d) - map_twice(a, b, 0.5 * (arm + p));
    out->before = (0.25 * k.before) * (e * e);
    if (k.now > k.before) {
        double s = sqrt(k.before / k.now);
        p += solve_mean(a, b, (k.now - k.before) / (k.now * (1 + s)) * e);
        e *= s;
    } else if (k.now < k.before && (p[0] != 0 || p[1] != 0 || p[2] != 0)) {
        sf_vec image = map_twice(a, b, 0.5 * p);
        double part = least_part(e, image, dot(e, e) * (k.before / k.now));
        e += (1 - part) * image;
        p *= part;
    }
    for (int c = 0; c < 3; c++)
        offset[c] = p[c];
    out->after = (0.25 * k.now) * (e * e);
    out->force = k.now * e;
    for (int c = 0; c < 3; c++)
        out->couple[c] = out->force * (0.5 * (arm[c] + p[c]));
}

/* The loop over the pairs of a group; `offsets`: they have some, or their stiffness rises. Returns whether
 * the stiffness of a pair rises. */
static inline __attribute__((always_inline)) bool sum_group(const sf_model *m, const sf_pairs *pairs,
                                                            const sf_pair_field *field, int64_t g,
                                                            bool offsets, sf_pair_sums *sums) {
    int64_t first = sf_halo_first(g), count = sf_halo_end(m, g) - first;
    int64_t inner = pairs->inner_ptr[g], outer = pairs->outer_ptr[g];
    double *inner_offset = field->offset, *outer_offset = field->offset + 3 * pairs->inner_ptr[pairs->groups];
    pair_node own[SF_GROUP], other;
    pair_effect pair;
    bool rises = false;
    memset(sums, 0, sizeof *sums);
    for (int64_t p = 0; p < count; p++)
        load_node(m, field, first + p, &own[p]);
    for (int64_t p = 0; p < count; p++) {
        int64_t i = first + p;
        sf_vec force = sums->force[p], before = sums->before[p], after = sums->after[p],
               couple[3] = {sums->couple[p][0], sums->couple[p][1], sums->couple[p][2]};
        for (; inner < pairs->inner_ptr[g] + pairs->inner_end[i]; inner++) {
            int64_t q = pairs->inner_place[inner];
            pair_stiffness k = stiffness_of(&own[p], &own[q], pairs->inner_weight[inner]);
            rises |= k.now > k.before;
            if (offsets)
                pull_offset_pair(&own[p], &own[q], k, &inner_offset[3 * inner], &pair);
            else
                pull_pair(&own[p], &own[q], k, &pair);
            force += pair.force;
            before += pair.before;
            after += pair.after;
            sums->force[q] -= pair.force;
            sums->before[q] += pair.before;
            sums->after[q] += pair.after;
            for (int c = 0; c < 3; c++) {
                couple[c] -= pair.couple[c];
                sums->couple[q][c] -= pair.couple[c];
            }
        }
        for (; outer < pairs->outer_ptr[g] + pairs->outer_end[i]; outer++) {
            load_node(m, field, pairs->outer_node[outer], &other);
            pair_stiffness k = stiffness_of(&own[p], &other, pairs->outer_weight[outer]);
            rises |= k.now > k.before;
            if (offsets)
                pull_offset_pair(&own[p], &other, k, &outer_offset[3 * outer], &pair);
            else
                pull_pair(&own[p], &other, k, &pair);
            force += pair.force;
            before += pair.before;
            after += pair.after;
            for (int c = 0; c < 3; c++)
                couple[c] -= pair.couple[c];
        }
        sums->force[p] = force;
        sums->before[p] = before;
        sums->after[p] = after;
        if (is_on_axis(m, i))
            couple[0][2] = couple[2][0] = 0;
        memcpy(sums->couple[p], couple, sizeof couple);
    }
    return rises;
}

SF_KERNEL bool sf_stabilisation_group(const sf_model *m, const sf_pairs *pairs, const sf_pair_field *field,
                                      int64_t g, sf_pair_sums *sums) {
    if (field->has_offsets[g] == 0 && !sum_group(m, pairs, field, g, false, sums))
        return false;
    sum_group(m, pairs, field, g, true, sums);
    return true;
}

static double total(sf_vec energy) {
    return energy[0] + energy[1] + energy[2];
}

/* The sums of group g into the state, and the work of its chunks. */
static void take_sums(const sf_model *m, const sf_pair_sums *sums, int64_t g, sf_state *s) {
    for (int64_t i = sf_halo_first(g); i < sf_halo_end(m, g); i++) {
        sf_partial *partial = &s->partial[i / SF_CHUNK];
        int64_t p = i - sf_halo_first(g);
        memcpy(&s->force[3 * i], &sums->force[p], 3 * sizeof *s->force);
        for (int k = 0; k < 9; k++)
            s->stress[9 * i + k] += sums->couple[p][k % 3][k / 3];
        double work = total(sums->before[p]) - s->pair_energy[i];
        s->pair_work[i] += work;
        partial->stabilisation += work;
        partial->given_back += sf_larger(0, -s->pair_work[i]);
        s->pair_energy[i] = total(sums->after[p]);
    }
}

void sf_stabilisation(const sf_model *m, const sf_operators *op, sf_state *s) {
    const sf_pair_field field = {
        s->d, s->f, s->stiffness, s->pair_stiffness, s->pair_offset, s->group_has_offsets};
#pragma omp for schedule(static)
    for (int64_t g = 0; g < op->halo.group_count; g++) {
        sf_pair_sums sums;
        s->group_has_offsets[g] = sf_stabilisation_group(m, &op->pairs, &field, g, &sums);
        take_sums(m, &sums, g, s);
    }
#pragma omp for schedule(static)
    for (int64_t g = 0; g < op->halo.group_count; g++) /* after all groups that see these nodes */
        memcpy(&s->pair_stiffness[sf_halo_first(g)], &s->stiffness[sf_halo_first(g)],
               (size_t)(sf_halo_end(m, g) - sf_halo_first(g)) * sizeof *s->stiffness);
}
