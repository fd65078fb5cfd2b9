/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/time_step.h"

#include "model/stability.h"

enum {
    POWER_INTERVAL = 40, /* steps between measurements at most */
    POWER_PAUSE = 5,     /* and at least, when the bound moves */
    POWER_FIRST = 80,    /* products of the first measurement at most */
    BASIS = 8,           /* Lanczos vectors kept */
    POWER_WARM = BASIS,  /* of the later ones */
    POWER_LEAST = 4,     /* of a cycle, before it may count as settled */
};
/* Converged when the last product or cycle adds less than this share to the frequency squared. */
static const double SETTLED = 1e-4;
static const double POWER_CHANGE =
    0.1; /* of the bound on the frequency squared, that calls for a measurement */
/* The iteration converges from below, by less than the safety of the step. The ratio is rounded up to a
 * multiple of 1 / POWER_ROUNDING: rounding errors of the iteration do not change the time steps, and so not
 * the results. */
static const double POWER_ROUNDING = 16384;
static const double GROWTH = 1.02;

/* Arrays of the iteration in what other passes work in (solver/field/halo.h): 8 doubles per node, or more
 * where `waiting` needs them. Single precision is far within the safety of the step. */
typedef struct power_work {
    double *out;     /* [n] product of the stiffness and the mode, kg s-2 times it */
    float *basis;    /* [BASIS][n] Lanczos vectors */
    float *flux;     /* [n][3] what every domain exerts */
    float *gradient; /* [n][3] of the mode, in every domain; then, in its place: */
    float *waiting;  /* [others of all groups] sums for nodes of other groups */
} power_work;

_Static_assert(2 * SF_HALO_WORK == 2 + BASIS + 3 + 3, "floats per node in the order of power_work");

/* With more than 3 n others the work array has 6 floats for each of them, and 13 n + others are enough. */
static power_work use_work(const sf_model *m, const sf_halo *h) {
    int64_t n = m->node_count;
    power_work w = {.out = h->work, .basis = (float *)(h->work + n)};
    w.flux = w.basis + BASIS * n;
    w.gradient = w.waiting = w.flux + 3 * n;
    return w;
}

/* The gradient of a field in domain l; two sums run side by side, as an addition waits for the one before. */
static inline void field_gradient(const sf_model *m, const sf_halo *h, int64_t l, const double *field,
                                  float g[3]) {
    const int64_t first = m->domain_ptr[l], count = m->domain_ptr[l + 1] - first;
    const double *b = &m->domain_b[3 * first];
    const uint16_t *local = &h->local[first];
    double even[3] = {0}, odd[3] = {0};
    for (int64_t k = 0; k + 1 < count; k += 2) {
        double x = field[local[k]], y = field[local[k + 1]];
        __builtin_prefetch(&b[3 * k + SF_AHEAD]);
        for (int c = 0; c < 3; c++) {
            even[c] += x * b[3 * k + c];
            odd[c] += y * b[3 * k + 3 + c];
        }
    }
    for (int c = 0; c < 3; c++) {
        if (count % 2)
            even[c] += field[local[count - 1]] * b[3 * (count - 1) + c];
        g[c] = (float)(even[c] + odd[c]);
    }
}

/* Gradient of the mode in the domains of a group. */
static SF_KERNEL void mode_gradients(const sf_model *m, const sf_halo *h, const double *field, int64_t group,
                                     float *gradient) {
    int64_t own = sf_halo_first(group), end = sf_halo_end(m, group);
    double seen[SF_GROUP_SEES];
    memcpy(seen, &field[own], (size_t)(end - own) * sizeof *seen);
    for (int64_t q = h->ptr[group]; q < h->ptr[group + 1]; q++)
        seen[end - own + q - h->ptr[group]] = field[h->node[q]];
    for (int64_t l = own; l < end; l++)
        field_gradient(m, h, l, seen, &gradient[3 * l]);
}

typedef struct pair {
    int64_t i, j;
    double weight;
    const double *offset; /* [3] m, of the arm; NULL: 0 */
} pair;

/* Contributions of one pair for a scalar field: force on i, the opposite on j; the same couple on both. */
static inline double pull_pair(const sf_model *m, const sf_state *s, const float *gradient, pair p,
                               double couple[3]) {
    const double *at = sf_model_coefficients(m), *offset = p.offset;
    int64_t i = p.i, j = p.j;
    double half[3], explained = 0;
    for (int c = 0; c < 3; c++) {
        half[c] = 0.5 * (at[3 * j + c] - at[3 * i + c] + (offset ? offset[c] : 0));
        explained += (gradient[3 * i + c] + gradient[3 * j + c]) * half[c];
    }
    double force = p.weight * (s->stiffness[i] + s->stiffness[j]) * (s->mode[j] - s->mode[i] - explained);
    for (int c = 0; c < 3; c++)
        couple[c] = force * half[c];
    return force;
}

/* Pair forces of a group into w->out, fluxes of its domains into w->flux. */
static SF_KERNEL void mode_fluxes(const sf_model *m, const sf_operators *op, const sf_state *s, int64_t group,
                                  const power_work *w) {
    const sf_pairs *pairs = &op->pairs;
    int64_t own = sf_halo_first(group), end = sf_halo_end(m, group);
    int64_t inner = pairs->inner_ptr[group], outer = pairs->outer_ptr[group];
    double *out = w->out, flux[3 * SF_GROUP];
    const double *offset = s->group_has_offsets[group] != 0 ? s->pair_offset : NULL;
    memset(&out[own], 0, (size_t)(end - own) * sizeof *out);
    for (int64_t i = own; i < end; i++) {
        const float *g = &w->gradient[3 * i];
        double v = m->volume[i], *q = &flux[3 * (i - own)];
        const float *a = &s->directional[6 * i];
        q[0] = v * (a[0] * g[0] + a[3] * g[1] + a[5] * g[2]);
        q[1] = v * (a[3] * g[0] + a[1] * g[1] + a[4] * g[2]);
        q[2] = v * (a[5] * g[0] + a[4] * g[1] + a[2] * g[2]);
    }
    for (int64_t i = own; i < end; i++) {
        double force = out[i], *q = &flux[3 * (i - own)], sum[3] = {q[0], q[1], q[2]}, couple[3];
        for (; inner < pairs->inner_ptr[group] + pairs->inner_end[i]; inner++) {
            int64_t j = own + pairs->inner_place[inner];
            const pair p = {i, j, pairs->inner_weight[inner], offset ? &offset[3 * inner] : NULL};
            double pull = pull_pair(m, s, w->gradient, p, couple);
            force -= pull;
            out[j] += pull;
            for (int c = 0; c < 3; c++) {
                sum[c] -= couple[c];
                flux[3 * (j - own) + c] -= couple[c];
            }
        }
        for (; outer < pairs->outer_ptr[group] + pairs->outer_end[i]; outer++) {
            const pair p = {i, pairs->outer_node[outer], pairs->outer_weight[outer],
                            offset ? &offset[3 * (pairs->inner_ptr[pairs->groups] + outer)] : NULL};
            force -= pull_pair(m, s, w->gradient, p, couple);
            for (int c = 0; c < 3; c++)
                sum[c] -= couple[c];
        }
        out[i] = force;
        memcpy(q, sum, sizeof sum);
    }
    for (int64_t q = 0; q < 3 * (end - own); q++)
        w->flux[3 * own + q] = (float)flux[q];
}

static inline void add_flux(const sf_model *m, const sf_halo *h, int64_t l, const float q[3],
                            double *restrict sum) {
    const int64_t first = m->domain_ptr[l], count = m->domain_ptr[l + 1] - first;
    const double *b = &m->domain_b[3 * first], x = q[0], y = q[1], z = q[2];
    const uint16_t *local = &h->local[first];
    for (int64_t k = 0; k < count; k++) {
        __builtin_prefetch(&b[3 * k + SF_AHEAD]);
        sum[local[k]] += x * b[3 * k] + y * b[3 * k + 1] + z * b[3 * k + 2];
    }
}

/* Forces of the domains of a group: on its own nodes at once; contributions to nodes owned by other groups
 * are stored and summed later in group order. */
static SF_KERNEL void collect_fluxes(const sf_model *m, const sf_halo *h, int64_t group,
                                     const power_work *w) {
    int64_t own = sf_halo_first(group), end = sf_halo_end(m, group),
            others = h->ptr[group + 1] - h->ptr[group];
    double sum[SF_GROUP_SEES];
    memset(sum, 0, (size_t)(end - own + others) * sizeof *sum);
    for (int64_t l = own; l < end; l++)
        add_flux(m, h, l, &w->flux[3 * l], sum);
    for (int64_t i = own; i < end; i++)
        w->out[i] += sum[i - own];
    for (int64_t q = 0; q < others; q++)
        w->waiting[h->ptr[group] + q] = (float)sum[end - own + q];
}

/* The product K mode: the same sums as in the step itself. By all threads. */
static void apply_operator(const sf_model *m, const sf_operators *op, const sf_state *s,
                           const power_work *w) {
    const sf_halo *h = &op->halo;
#pragma omp for schedule(static)
    for (int64_t g = 0; g < h->group_count; g++)
        mode_gradients(m, h, s->mode, g, w->gradient);
#pragma omp for schedule(static)
    for (int64_t g = 0; g < h->group_count; g++)
        mode_fluxes(m, op, s, g, w);
#pragma omp for schedule(static)
    for (int64_t g = 0; g < h->group_count; g++)
        collect_fluxes(m, h, g, w);
#pragma omp for schedule(static)
    for (int64_t i = 0; i < m->node_count; i++)
        for (int32_t q = h->slot_ptr[i]; q < h->slot_ptr[i + 1]; q++)
            w->out[i] += w->waiting[h->slot[q]];
}

/* Largest eigenvalue of the tridiagonal matrix (diagonal alpha, off-diagonal beta) and its eigenvector z, by
 * bisection on the signs of the pivots: beyond the largest eigenvalue all are negative, and back-substitution
 * is stable. */
static double tridiagonal_top(int size, const double *alpha, const double *beta, double *z) {
    double low = alpha[0], high = 0, pivot[BASIS];
    for (int j = 0; j < size; j++) {
        low = fmax(low, alpha[j]);
        double before = j > 0 ? beta[j - 1] : 0, after = j + 1 < size ? beta[j] : 0;
        high = fmax(high, alpha[j] + before + after);
    }
    high *= 1 + 1e-14;
    for (int pass = 0; pass < 60; pass++) {
        double value = pass == 0 ? high : 0.5 * (low + high);
        bool above = true;
        for (int j = 0; j < size && above; j++) {
            pivot[j] = alpha[j] - value - (j > 0 ? beta[j - 1] * beta[j - 1] / pivot[j - 1] : 0);
            above = pivot[j] < 0;
        }
        *(above ? &high : &low) = value;
    }
    for (int j = 0; j < size; j++)
        pivot[j] = alpha[j] - high - (j > 0 ? beta[j - 1] * beta[j - 1] / pivot[j - 1] : 0);
    z[size - 1] = 1;
    for (int j = size - 2; j >= 0; j--)
        z[j] = -beta[j] * z[j + 1] / pivot[j];
    return high;
}

/* Up to `products` <= BASIS Lanczos steps from the mode, in the inner product of the masses; the
 * mode becomes the Ritz vector of the largest Ritz value, which is returned. Ends early when a product adds
 * `settled` of the value or less. */
static double lanczos_cycle(const sf_model *m, const sf_operators *op, sf_state *s, int products,
                            double settled) {
    int64_t n = m->node_count;
    double alpha[BASIS], beta[BASIS] = {0}, z[BASIS], norm = 0, value = 0, before_last;
    const power_work w = use_work(m, &op->halo);
    const double *out = w.out;
    int size = 0;
    for (int64_t i = 0; i < n; i++)
        norm += m->mass[i] * s->mode[i] * s->mode[i];
    if (!(norm > 0))
        return 0;
    for (double length = sqrt(norm); size < products; length = beta[size - 1]) {
        float *q = &w.basis[size * n], *before = size > 0 ? q - n : NULL;
        for (int64_t i = 0; i < n; i++)
            q[i] = (float)(s->mode[i] /= length);
        SF_BY_ALL_THREADS(true, apply_operator(m, op, s, &w));
        alpha[size] = norm = 0;
        for (int64_t i = 0; i < n; i++)
            alpha[size] += s->mode[i] * out[i];
        for (int64_t i = 0; i < n; i++) {
            double r = out[i] / m->mass[i] - alpha[size] * s->mode[i] - (before ? length * before[i] : 0);
            s->mode[i] = r;
            norm += m->mass[i] * r * r;
        }
        beta[size++] = sqrt(norm);
        before_last = value;
        value = tridiagonal_top(size, alpha, beta, z);
        if (!(beta[size - 1] > 1e-7 * fabs(alpha[size - 1])) || /* an exact vector */
            (size >= POWER_LEAST && value - before_last < settled * value))
            break;
    }
    s->power_iterations += size;
    for (int64_t i = 0; i < n; i++) {
        s->mode[i] = 0;
        for (int j = 0; j < size; j++)
            s->mode[i] += z[j] * w.basis[j * n + i];
    }
    return value;
}

double sf_time_step_power(const sf_model *m, const sf_operators *op, sf_state *s, int products,
                          double settled) {
    double estimate = 0;
    for (int left = products; left > 0; left -= BASIS) {
        double before = estimate;
        estimate = fmax(before, lanczos_cycle(m, op, s, left < BASIS ? left : BASIS, settled));
        if (estimate - before < settled * estimate)
            break;
    }
    return estimate;
}

/* A little of every node's sawtooth, weighted by how stiff its domain is, so that the iteration finds a new
 * stiff spot even if the old mode vanishes there. */
static void seed_mode(const sf_model *m, const sf_operators *op, sf_state *s) {
    double largest = 0;
    for (int64_t i = 0; i < m->node_count; i++)
        largest = fmax(largest, fabs(s->mode[i]));
    double amplitude = largest > 0 ? 0.2 * largest : 1;
    for (int64_t i = 0; i < m->node_count; i++) {
        uint64_t hash = ((uint64_t)i + 1) * 0x9e3779b97f4a7c15ULL;
        double sign = (double)(hash >> 40) / (double)(1 << 23) - 1;
        double stiff = op->stability[i] * s->tangent[i] / s->bound_load;
        s->mode[i] += amplitude * sign * stiff * stiff;
    }
}

static void merge_bounds(sf_state *s) {
    s->bound_step = INFINITY;
    s->bound_load = 0;
    for (int64_t k = 0; k < s->chunk_count; k++) {
        s->bound_step = fmin(s->bound_step, s->partial[k].step);
        s->bound_load = fmax(s->bound_load, s->partial[k].load);
    }
}

bool sf_time_step_due(const sf_state *s) {
    int64_t since = s->step - s->measured_at;
    return s->step == 0 || since >= POWER_INTERVAL ||
           (since >= POWER_PAUSE && fabs(s->bound_load - s->measured_load) > POWER_CHANGE * s->measured_load);
}

void sf_time_step_choose(const sf_model *m, const sf_operators *op, sf_state *s) {
    bool due = sf_time_step_due(s);
    merge_bounds(s);
    if (due) {
        seed_mode(m, op, s);
        double power = sf_time_step_power(m, op, s, s->step == 0 ? POWER_FIRST : POWER_WARM, SETTLED);
        double tightness = ceil(POWER_ROUNDING * power / s->bound_load) / POWER_ROUNDING;
        if (!(power > 0)) /* nothing came of it: the bound is safe alone */
            tightness = 1;
        double change = s->tightness / tightness;
        s->tightness = tightness;
        s->bound_step *= fmin(change, sqrt(change)); /* safe with any damping; exact from the next step on */
        s->measured_at = s->step;
        s->measured_load = s->bound_load;
        s->ceiling = INFINITY;
    } else { /* a bound that falls says nothing about the rest of the pad */
        s->ceiling = s->bound_step = fmin(s->bound_step, s->ceiling);
    }
    double step = sf_stability_with_membrane(s->membrane.load, s->bound_step),
           dt = fmin(m->run.step_safety * step, m->run.step_limit);
    s->dt = s->step == 0 ? dt : fmin(dt, GROWTH * s->dt_old);
}
