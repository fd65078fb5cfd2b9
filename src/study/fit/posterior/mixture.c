/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/posterior/mixture.h"

#include "study/fit/least_squares.h"
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_randist.h>
#include <gsl/gsl_sf_gamma.h>
#include <gsl/gsl_sort.h>
#include <string.h>

enum { ROUNDS = 25, N = SF_POSTERIOR_MOST };
static const double RIDGE = 1e-6; /* of the samples' own variances, added to a part's */

gsl_rng *sf_random(uint64_t seed, sf_error *err) {
    gsl_rng *random = gsl_rng_alloc(gsl_rng_mt19937);
    if (random)
        gsl_rng_set(random, (unsigned long)seed & 0xffffffffu);
    else
        SF_NO_MEMORY(err, "a random generator");
    return random;
}

/* ---- density and draws ---- */

/* z = L^-1 (u - centre) [n]; returns |z|^2, the squared distance from the part's centre in its scale. */
static double standardise(const sf_mixture_part *part, int n, const double *u, double *z) {
    double sum = 0;
    for (int i = 0; i < n; i++) {
        z[i] = u[i] - part->centre[i];
        for (int j = 0; j < i; j++)
            z[i] -= part->factor[i][j] * z[j];
        z[i] /= part->factor[i][i];
        sum += z[i] * z[i];
    }
    return sum;
}

static double distance(const sf_mixture_part *part, int n, const double *u) {
    double z[N];
    return standardise(part, n, u, z);
}

static double part_log_density(const sf_mixture *m, const sf_mixture_part *part, const double *u) {
    return part->log_norm -
           0.5 * (m->freedom + m->parameters) * log1p(distance(part, m->parameters, u) / m->freedom);
}

double sf_mixture_log_density(const sf_mixture *m, const double *u) {
    double value[SF_MIXTURE_MOST], largest = -INFINITY, sum = 0;
    for (int k = 0; k < m->parts; k++) {
        value[k] = log(m->part[k].weight) + part_log_density(m, &m->part[k], u);
        largest = fmax(largest, value[k]);
    }
    for (int k = 0; k < m->parts; k++)
        sum += exp(value[k] - largest);
    return largest + log(sum);
}

void sf_mixture_draw(const sf_mixture *m, gsl_rng *random, double *u) {
    double z[N], choice = gsl_rng_uniform(random);
    int k = 0;
    while (k < m->parts - 1 && choice >= m->part[k].weight)
        choice -= m->part[k++].weight;
    for (int i = 0; i < m->parameters; i++)
        z[i] = gsl_ran_ugaussian(random);
    double stretch = sqrt(m->freedom / gsl_ran_chisq(random, m->freedom));
    for (int i = 0; i < m->parameters; i++) {
        u[i] = m->part[k].centre[i];
        for (int j = 0; j <= i; j++)
            u[i] += stretch * m->part[k].factor[i][j] * z[j];
    }
}

/* Factor and norm of a part from its scale matrix [n][n]. */
static sf_status set_scale(const sf_mixture *m, const double *scale, sf_mixture_part *part, sf_error *err) {
    int n = m->parameters;
    double copy[N * N], log_determinant = 0;
    memcpy(copy, scale, (size_t)(n * n) * sizeof *copy);
    gsl_matrix_view a = gsl_matrix_view_array(copy, (size_t)n, (size_t)n);
    if (gsl_linalg_cholesky_decomp1(&a.matrix) != GSL_SUCCESS)
        return SF_FAIL(err, SF_ERR_NUMERIC, "a covariance of %d parameters is not positive definite", n);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j <= i; j++)
            part->factor[i][j] = copy[i * n + j];
        log_determinant += log(copy[i * n + i]);
    }
    part->log_norm = gsl_sf_lngamma((m->freedom + n) / 2) - gsl_sf_lngamma(m->freedom / 2) -
                     0.5 * n * log(m->freedom * M_PI) - log_determinant;
    return isfinite(part->log_norm)
               ? SF_OK
               : SF_FAIL(err, SF_ERR_NUMERIC, "a covariance of %d parameters is not finite", n);
}

sf_status sf_mixture_single(int n, const double *centre, const double *scale, double freedom, sf_mixture *m,
                            sf_error *err) {
    if (n < 1 || n > N)
        return SF_REFUSE(err, "the number of parameters" SF_OUTSIDE("%d", "1", "%d"), n, N);
    *m = (sf_mixture){.parameters = n, .parts = 1, .freedom = freedom};
    m->part[0].weight = 1;
    memcpy(m->part[0].centre, centre, (size_t)n * sizeof *centre);
    return set_scale(m, scale, &m->part[0], err);
}

/* ---- matched to samples ---- */

void sf_moments(int n, int count, const double *sample, double *mean, double *covariance) {
    memset(mean, 0, (size_t)n * sizeof *mean);
    memset(covariance, 0, (size_t)(n * n) * sizeof *covariance);
    for (int k = 0; k < count; k++)
        for (int i = 0; i < n; i++)
            mean[i] += sample[k * n + i] / count;
    for (int k = 0; k < count; k++)
        for (int i = 0; i < n; i++)
            for (int j = 0; j < n; j++)
                covariance[i * n + j] +=
                    (sample[k * n + i] - mean[i]) * (sample[k * n + j] - mean[j]) / count;
}

sf_status sf_mixture_about(int n, int count, const double *sample, double freedom, sf_mixture *m,
                           sf_error *err) {
    double mean[N], covariance[N * N];
    sf_moments(n, count, sample, mean, covariance);
    return sf_mixture_single(n, mean, covariance, freedom, m, err);
}

typedef struct samples {
    int n, count;
    const double *u;  /* [count][n] */
    double *share;    /* [parts][count] of a sample in a part */
    double ridge[N];  /* added to the variances */
    double *position; /* [count] along their first principal axis */
} samples;

/* Positions of the samples along the first principal axis of the correlation matrix. */
static sf_status find_axis(samples *s, sf_error *err) {
    int n = s->n;
    double mean[N], c[N * N], sd[N];
    sf_moments(n, s->count, s->u, mean, c);
    for (int i = 0; i < n; i++) {
        sd[i] = sqrt(c[i * n + i]);
        s->ridge[i] = RIDGE * c[i * n + i];
        if (!(sd[i] > 0))
            return SF_FAIL(err, SF_ERR_NUMERIC, "the samples of a parameter are all alike");
    }
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            c[i * n + j] /= sd[i] * sd[j];
    gsl_matrix_view a = gsl_matrix_view_array(c, (size_t)n, (size_t)n);
    gsl_eigen_symmv_workspace *w = gsl_eigen_symmv_alloc((size_t)n);
    SF_VECTOR *value = sf_vector((size_t)n, err);
    SF_MATRIX *vector = sf_matrix((size_t)n, (size_t)n, err);
    if (w && err->status == SF_OK) {
        gsl_eigen_symmv(&a.matrix, value, vector, w);
        size_t first = gsl_vector_max_index(value);
        for (int k = 0; k < s->count; k++) {
            s->position[k] = 0;
            for (int i = 0; i < n; i++)
                s->position[k] += gsl_matrix_get(vector, (size_t)i, first) * s->u[k * n + i] / sd[i];
        }
    }
    gsl_eigen_symmv_free(w);
    return err->status;
}

/* First shares: equal slices along the axis. */
static sf_status slice(const samples *s, int parts, sf_error *err) {
    SF_OWN(double, sorted, s->count, "samples", err);
    memcpy(sorted, s->position, (size_t)s->count * sizeof *sorted);
    gsl_sort(sorted, 1, (size_t)s->count);
    for (int k = 0; k < s->count; k++)
        for (int p = 0; p < parts; p++) {
            bool above = p == 0 || s->position[k] >= sorted[s->count * p / parts];
            bool below = p == parts - 1 || s->position[k] < sorted[s->count * (p + 1) / parts];
            s->share[p * s->count + k] = above && below;
        }
    return SF_OK;
}

/* One part from its shares, each sample with the t-distribution's weight about the part before. */
static sf_status match_part(const sf_mixture *m, const samples *s, const double *share, bool first,
                            sf_mixture_part *part, sf_error *err) {
    int n = s->n;
    double sum = 0, weights = 0, centre[N] = {0}, scale[N * N] = {0};
    for (int pass = 0; pass < 2; pass++)
        for (int k = 0; k < s->count; k++) {
            const double *u = &s->u[k * n];
            double w = share[k] * (first ? 1 : (m->freedom + n) / (m->freedom + distance(part, n, u)));
            if (pass == 0) {
                sum += share[k];
                weights += w;
                for (int i = 0; i < n; i++)
                    centre[i] += w * u[i];
                continue;
            }
            for (int i = 0; i < n; i++)
                for (int j = 0; j <= i; j++)
                    scale[i * n + j] += w * (u[i] - centre[i] / weights) * (u[j] - centre[j] / weights) / sum;
        }
    for (int i = 0; i < n; i++) {
        part->centre[i] = centre[i] / weights;
        scale[i * n + i] += s->ridge[i];
        for (int j = 0; j < i; j++)
            scale[j * n + i] = scale[i * n + j];
    }
    part->weight = sum / s->count;
    return set_scale(m, scale, part, err);
}

static void share_out(const sf_mixture *m, const samples *s) {
    for (int k = 0; k < s->count; k++) {
        double all = sf_mixture_log_density(m, &s->u[k * s->n]);
        for (int p = 0; p < m->parts; p++)
            s->share[p * s->count + k] =
                exp(log(m->part[p].weight) + part_log_density(m, &m->part[p], &s->u[k * s->n]) - all);
    }
}

static sf_status match(const samples *s, int parts, double freedom, sf_mixture *m, sf_error *err) {
    *m = (sf_mixture){.parameters = s->n, .parts = parts, .freedom = freedom};
    SF_TRY(slice(s, parts, err));
    for (int round = 0; round < ROUNDS; round++) {
        for (int p = 0; p < parts; p++)
            SF_TRY(match_part(m, s, &s->share[p * s->count], round == 0, &m->part[p], err));
        share_out(m, s);
    }
    return SF_OK;
}

/* The number of parts, by the first half of the samples, that describes the other half best. */
static int choose_parts(samples *half, int rest, double freedom) {
    int best = 1;
    double highest = -INFINITY;
    sf_error err = SF_ERROR_INIT;
    sf_mixture m;
    for (int parts = 1; parts <= SF_MIXTURE_MOST && half->count >= 8 * (half->n + 1) * parts; parts++) {
        if (match(half, parts, freedom, &m, &err) != SF_OK)
            break;
        double value = 0; /* mean log density of the other half */
        for (int k = half->count; k < half->count + rest; k++)
            value += sf_mixture_log_density(&m, &half->u[k * half->n]);
        value /= rest;
        if (value > highest + 0.02) {
            highest = value;
            best = parts;
        }
    }
    return best;
}

sf_status sf_mixture_fit(int n, int count, const double *u, double freedom, sf_mixture *m, sf_error *err) {
    if (n < 1 || n > N || count < 2 * (n + 1))
        return SF_FAIL(err, SF_ERR_NUMERIC, "%d samples are too few to describe %d parameters", count, n);
    SF_OWN(double, share, (unsigned long)count *SF_MIXTURE_MOST, "samples", err);
    SF_OWN(double, position, count, "samples", err);
    samples all = {.n = n, .count = count, .u = u, .share = share, .position = position}, half = all;
    int parts = 1;
    half.count = count / 2;
    if (find_axis(&half, err) == SF_OK)
        parts = choose_parts(&half, count - half.count, freedom);
    if (err->status == SF_OK && find_axis(&all, err) == SF_OK)
        match(&all, parts, freedom, m, err);
    return err->status;
}

/* ---- emulator ---- */

enum { DEGREE = 4, POINTS_OF_A_TERM = 3 };
static const double REACH = 2;           /* of the squared distance of the farthest point */
static const double FRAME_RIDGE = 1e-10; /* of the columns' squares */

/* (n + degree) over degree. */
static int terms_of(int n, int degree) {
    double terms = 1;
    for (int k = 1; k <= degree; k++)
        terms = terms * (n + k) / k;
    return terms > SF_EMULATOR_MOST_TERMS ? SF_EMULATOR_MOST_TERMS + 1 : (int)(terms + 0.5);
}

/* Each degree extends the one before by variables that are not before its last one. */
static void list_terms(sf_emulator *e, int degree) {
    int first = 0, last = 1;
    e->terms = 1;
    for (int d = 0; d < degree; d++) {
        for (int t = first; t < last; t++)
            for (int v = t == 0 ? 0 : e->variable[t]; v < e->parameters; v++) {
                e->parent[e->terms] = t;
                e->variable[e->terms++] = v;
            }
        first = last;
        last = e->terms;
    }
}

static void fill_terms(const sf_emulator *e, const double *z, double *term) {
    term[0] = 1;
    for (int t = 1; t < e->terms; t++)
        term[t] = term[e->parent[t]] * z[e->variable[t]];
}

/* Centre and factor of the points; false: they span no volume. */
static bool find_frame(sf_emulator *e, int count, const double *u) {
    sf_mixture m;
    if (sf_mixture_about(e->parameters, count, u, 1, &m, SF_IGNORED) != SF_OK)
        return false;
    e->frame = m.part[0];
    return true;
}

/* Adds the points to the normal equations: lower triangle of `gram`, and `right` [responses][terms]. */
static void add_points(sf_emulator *e, int count, const double *u, const double *y, double *gram,
                       double *right) {
    double z[N], term[SF_EMULATOR_MOST_TERMS];
    int terms = e->terms, m = e->responses;
    for (int k = 0; k < count; k++) {
        e->most_distance =
            fmax(e->most_distance, standardise(&e->frame, e->parameters, &u[k * e->parameters], z));
        fill_terms(e, z, term);
        for (int i = 0; i < terms; i++)
            for (int j = 0; j <= i; j++)
                gram[i * terms + j] += term[i] * term[j];
        for (int r = 0; r < m; r++)
            for (int i = 0; i < terms; i++)
                right[r * terms + i] += term[i] * y[k * m + r];
    }
}

/* Solves them with columns scaled to one, and the ridge. */
static sf_status solve(sf_emulator *e, double *gram, double *right, sf_error *err) {
    size_t terms = (size_t)e->terms;
    double scale[SF_EMULATOR_MOST_TERMS];
    gsl_matrix_view a = gsl_matrix_view_array(gram, terms, terms);
    for (size_t i = 0; i < terms; i++)
        scale[i] = 1 / sqrt(gram[i * terms + i]);
    for (size_t i = 0; i < terms; i++)
        for (size_t j = 0; j <= i; j++)
            gram[i * terms + j] = gram[j * terms + i] =
                gram[i * terms + j] * scale[i] * scale[j] + (i == j ? FRAME_RIDGE : 0);
    if (gsl_linalg_cholesky_decomp1(&a.matrix) != GSL_SUCCESS)
        return SF_FAIL(err, SF_ERR_NUMERIC, "the emulator's normal equations are singular");
    for (size_t r = 0; r < (size_t)e->responses; r++) {
        gsl_vector_view x = gsl_vector_view_array(&right[r * terms], terms);
        for (size_t i = 0; i < terms; i++)
            right[r * terms + i] *= scale[i];
        gsl_linalg_cholesky_svx(&a.matrix, &x.vector);
        for (size_t i = 0; i < terms; i++)
            e->coefficient[r * terms + i] = right[r * terms + i] * scale[i];
    }
    return SF_OK;
}

sf_status sf_emulator_fit(int parameters, int responses, int count, const double *u, const double *y,
                          sf_emulator *e, sf_error *err) {
    *e = (sf_emulator){.parameters = parameters, .responses = responses};
    int degree = DEGREE;
    while (degree > 1 && (terms_of(parameters, degree) > SF_EMULATOR_MOST_TERMS ||
                          POINTS_OF_A_TERM * terms_of(parameters, degree) > count))
        degree--;
    if (degree < 2 || !find_frame(e, count, u))
        return SF_OK;
    list_terms(e, degree);
    unsigned long terms = (unsigned long)e->terms, all = terms * (unsigned long)responses;
    SF_OWNED double *gram = sf_alloc(err, terms * terms, sizeof *gram, "an emulator"),
                    *right = sf_alloc(err, all, sizeof *right, "an emulator");
    e->coefficient = sf_alloc(err, all, sizeof(double), "an emulator");
    SF_TRY(err->status);
    add_points(e, count, u, y, gram, right);
    if (solve(e, gram, right, SF_IGNORED) != SF_OK)
        sf_emulator_free(e);
    return err->status;
}

bool sf_emulator_at(const sf_emulator *e, const double *u, double *y) {
    double z[N], term[SF_EMULATOR_MOST_TERMS];
    if (!(standardise(&e->frame, e->parameters, u, z) <= REACH * e->most_distance))
        return false;
    fill_terms(e, z, term);
    for (int r = 0; r < e->responses; r++) {
        const double *c = &e->coefficient[r * e->terms];
        y[r] = 0;
        for (int t = 0; t < e->terms; t++)
            y[r] += c[t] * term[t];
    }
    return true;
}

void sf_emulator_free(sf_emulator *e) {
    SF_CLEAR(e, e->coefficient);
}
