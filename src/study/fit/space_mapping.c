/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/space_mapping.h"

#include "study/fit/least_squares.h"
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_qrng.h>
#include <string.h>

/* The regression of M expects, in logarithms, this: the simulation's own noise, the second derivative of y -
 * s, and the size of M; without the surrogate ([1]) the part of a change by which it is curved over a step of
 * 1, and the size of the Jacobian. */
static const double NOISE = 0.002, CURVATURE[2] = {0.05, 1}, SLOPE[2] = {0.3, 3};

static const double MOST_MISS = 10; /* root of the misfit per degree of freedom: no minimum that counts */
enum { MOST_IDLE = 5 };                  /* steps in a row that gain nothing: the phase ends */
static const double LEAST_RADIUS = 0.02; /* of the trust region: shorter steps only tell the noise */
/* Between simulations for a derivative; the prior's standard deviation, if that is less. */
static const double LEAST_DIFFERENCE = 0.1;
static const double LONGEST_STEP = 1; /* of the second phase where shorter steps gain nothing */

/* c = (a / scale^2 + prior)^-1; positive definite by the prior. */
static void invert_information(const sf_mapping_problem *p, const gsl_matrix *a, double scale,
                               gsl_matrix *c) {
    gsl_matrix_memcpy(c, a);
    gsl_matrix_scale(c, 1 / (scale * scale));
    for (int j = 0; j < p->parameters; j++)
        *gsl_matrix_ptr(c, (size_t)j, (size_t)j) += 1 / (p->prior_sd[j] * p->prior_sd[j]);
    gsl_linalg_cholesky_decomp1(c);
    gsl_linalg_cholesky_invert(c);
}

/* a = J^T J over the data, their number. */
static int collect_information(const sf_mapping_problem *p, const double *jacobian, gsl_matrix *a) {
    int data = 0, n = p->parameters;
    for (int i = 0; i < p->responses; i++) {
        if (isinf(p->sd[i]))
            continue;
        data++;
        const double *row = &jacobian[i * n];
        for (int j = 0; j < n; j++)
            for (int k = 0; k < n; k++)
                *gsl_matrix_ptr(a, (size_t)j, (size_t)k) += row[j] * row[k] / (p->sd[i] * p->sd[i]);
    }
    return data;
}

/* True if the residuals contradict the stated standard deviations (chi-squared, 5 %): without a degree of
 * freedom, too, when there should be no residual. */
static bool contradicts(const sf_mapping_result *r) {
    return gsl_cdf_chisq_Q(r->misfit, fmax(1, r->freedom)) < 0.05;
}

/* Covariance with the stated standard deviations of the data, or with those times the scale that the misfit
 * shows; degrees of freedom: data less trace(J C J^T). */
static sf_status estimate(const sf_mapping_problem *p, bool scaled, sf_mapping_result *r, sf_error *err) {
    size_t n = (size_t)p->parameters;
    SF_MATRIX *a = sf_matrix(n, n, err), *c = sf_matrix(n, n, err);
    SF_TRY(err->status);
    double effective = 0;
    int data = collect_information(p, r->corrected, a);
    invert_information(p, a, 1, c);
    for (size_t j = 0; j < n; j++)
        for (size_t k = 0; k < n; k++)
            effective += gsl_matrix_get(a, j, k) * gsl_matrix_get(c, k, j);
    r->freedom = data - effective;
    r->scale = scaled && contradicts(r) ? sqrt(r->misfit / fmax(1, r->freedom)) : 1;
    invert_information(p, a, r->scale, c);
    for (size_t j = 0; j < n; j++)
        for (size_t k = 0; k < n; k++)
            r->covariance[j][k] = gsl_matrix_get(c, j, k);
    return err->status;
}

static double misfit_of(const sf_mapping_problem *p, const double *y) {
    double sum = 0;
    for (int i = 0; i < p->responses; i++)
        sum += pow(sf_mapping_residual(p, p->sd, y, i), 2);
    return sum;
}

/* True if a bound holds the point: the data alone would move it beyond. */
static bool is_bound(const sf_mapping_problem *p, const double *y) {
    for (int i = 0; i < p->responses && p->bound_sd; i++)
        if (!isinf(p->bound_sd[i]) && sf_mapping_residual(p, p->sd, y, i) > p->tolerance)
            return true;
    return false;
}

static double prior_of(const sf_mapping_problem *p, const double *u) {
    double sum = 0;
    for (int j = 0; j < p->parameters; j++)
        sum += pow((u[j] - p->prior[j]) / p->prior_sd[j], 2);
    return sum;
}

/* A simulated point with the surrogate's value there. */
typedef struct point {
    double u[SF_MAPPING_MAX_PARAMETERS];
    double *y, *offset; /* [responses]; owned */
    double misfit, objective;
} point;

typedef struct search {
    const sf_mapping_problem *problem;
    sf_mapping_result *result; /* its matrix is that at `best` */
    point best, trial;
    bool linear; /* the second phase: M alone has the derivatives, and the offsets are those of y */
    int count;   /* of simulated points */
    double (*u)[SF_MAPPING_MAX_PARAMETERS]; /* [count] of them; owned */
    double *y, *offset;                     /* [count][responses]; owned */
} search;

static sf_mapping_model model_at(const search *s) {
    return (sf_mapping_model){s->problem, s->linear, s->best.u, s->best.offset, s->result->matrix};
}

static sf_status simulate(search *s, point *at, sf_error *err) {
    const sf_mapping_problem *p = s->problem;
    size_t n = (size_t)p->responses;
    SF_TRY(p->simulate(p->context, at->u, at->y, err));
    if (!s->linear)
        SF_TRY(p->surrogate(p->context, at->u, at->offset, err));
    for (size_t i = 0; i < n; i++)
        at->offset[i] = at->y[i] - (s->linear ? 0 : at->offset[i]);
    at->misfit = misfit_of(p, at->y);
    at->objective = at->misfit + prior_of(p, at->u);
    memcpy(s->u[s->count], at->u, sizeof at->u);
    memcpy(&s->y[n * (size_t)s->count], at->y, n * sizeof *at->y);
    memcpy(&s->offset[n * (size_t)s->count++], at->offset, n * sizeof *at->offset);
    if (p->progress)
        p->progress(p->context, s->result->iterations, at->u, at->y, at->objective);
    return SF_OK;
}

/* Standard deviation of the change of y - s to a point, `length` away, as a secant: the noise, and the
 * curvature. Without the surrogate that is a part of the change itself, as what hardly counts is hardly
 * curved: long steps along it tell its derivative. */
static double secant_error(const search *s, int k, double length) {
    const sf_mapping_problem *p = s->problem;
    double change = s->linear ? 0 : length;
    for (int i = 0; i < p->responses && s->linear; i++)
        if (!isinf(p->sd[i]))
            change = fmax(change, fabs(s->offset[k * p->responses + i] - s->best.offset[i]));
    return hypot(NOISE, CURVATURE[s->linear] * length * change);
}

/* Adds a point to the normal equations (A, b) of the rows of M; the farther it is from `best`, the less the
 * secant to it tells about the derivative there. */
static void add_secant(const search *s, int k, gsl_matrix *a, gsl_matrix *b) {
    double step[SF_MAPPING_MAX_PARAMETERS], square = 0;
    int n = s->problem->parameters, responses = s->problem->responses;
    for (int j = 0; j < n; j++) {
        step[j] = s->u[k][j] - s->best.u[j];
        square += step[j] * step[j];
    }
    double weight = pow(secant_error(s, k, sqrt(square)), -2);
    for (int j = 0; j < n; j++) {
        for (int l = 0; l < n; l++)
            *gsl_matrix_ptr(a, (size_t)j, (size_t)l) += weight * step[j] * step[l];
        for (int i = 0; i < responses; i++) {
            double change = s->offset[k * responses + i] - s->best.offset[i];
            if (isfinite(change))
                *gsl_matrix_ptr(b, (size_t)i, (size_t)j) += weight * change * step[j];
        }
    }
}

/* M by a ridge regression of y - s over all simulated points, about the M that the problem begins with; in
 * the second phase of y, about 0. */
static sf_status regress_matrix(search *s, sf_error *err) {
    const sf_mapping_problem *p = s->problem;
    size_t n = (size_t)p->parameters, responses = (size_t)p->responses;
    bool anew = s->linear && !p->first_linear;
    const double *first = anew ? NULL : p->first_matrix, slope = SLOPE[anew];
    SF_MATRIX *a = sf_matrix(n, n, err), *b = sf_matrix(responses, n, err);
    SF_TRY(err->status);
    for (size_t k = 0; k < responses * n; k++)
        b->data[k] = first && isfinite(first[k]) ? first[k] / (slope * slope) : 0;
    for (size_t j = 0; j < n; j++)
        gsl_matrix_set(a, j, j, 1 / (slope * slope));
    for (int k = 0; k < s->count; k++)
        add_secant(s, k, a, b);
    gsl_linalg_cholesky_decomp1(a);
    for (size_t i = 0; i < responses; i++) {
        gsl_vector_view row = gsl_matrix_row(b, i);
        gsl_linalg_cholesky_svx(a, &row.vector);
        memcpy(&s->result->matrix[i * n], row.vector.data, n * sizeof(double));
    }
    return err->status;
}

/* Largest step to the trial in standard deviations, with the curvature of the anchor's Jacobian; by how much
 * the corrected surrogate expects the objective to fall. Overwrites the trial's y. */
static sf_status measure_step(search *s, double *step, double *gain, sf_error *err) {
    const sf_mapping_problem *p = s->problem;
    sf_mapping_result *r = s->result;
    const sf_mapping_model model = model_at(s);
    r->misfit = s->best.misfit;
    SF_TRY(sf_mapping_differentiate(&model, r->corrected, err));
    SF_TRY(estimate(p, false, r, err));
    SF_TRY(sf_mapping_evaluate(&model, s->trial.u, s->trial.y, err));
    *gain = s->best.objective - misfit_of(p, s->trial.y) - prior_of(p, s->trial.u);
    *step = 0;
    for (int j = 0; j < p->parameters; j++)
        *step = fmax(*step, fabs(s->trial.u[j] - s->best.u[j]) / sqrt(r->covariance[j][j]));
    return SF_OK;
}

static double distance(const search *s) {
    double largest = 0;
    for (int j = 0; j < s->problem->parameters; j++)
        largest = fmax(largest, fabs(s->trial.u[j] - s->best.u[j]));
    return largest;
}

/* The trial becomes the minimum of the corrected surrogate from `from`, held back from `best` by `hold`. */
static sf_status propose(search *s, const double *from, double hold, sf_error *err) {
    const sf_mapping_model model = model_at(s);
    memmove(s->trial.u, from, (size_t)s->problem->parameters * sizeof *from);
    return sf_mapping_minimise(&model, s->problem->sd, s->best.u, hold, s->trial.u, err);
}

/* Objective by the corrected surrogate at the trial; INFINITY: the law cannot be there. */
static double expect(search *s, sf_error *err) {
    const sf_mapping_model model = model_at(s);
    sf_error failure = SF_ERROR_INIT;
    if (sf_mapping_evaluate(&model, s->trial.u, s->trial.y, &failure) == SF_OK)
        return misfit_of(s->problem, s->trial.y) + prior_of(s->problem, s->trial.u);
    if (failure.status == SF_ERR_MEMORY)
        *err = failure;
    return INFINITY;
}

enum { ROUNDS = 8, PLACES = 8 /* of a design over the prior, in each */ };

/* The trial becomes the lowest of the minima of the corrected surrogate from `best` and from the best place
 * of each round of a design (Halton's sequence). */
static sf_status propose_widely(search *s, sf_error *err) {
    const sf_mapping_problem *p = s->problem;
    double place[SF_MAPPING_MAX_PARAMETERS], next[SF_MAPPING_MAX_PARAMETERS], from[SF_MAPPING_MAX_PARAMETERS];
    double lowest = INFINITY;
    gsl_qrng *places = gsl_qrng_alloc(gsl_qrng_halton, (unsigned)p->parameters);
    if (!places)
        SF_NO_MEMORY(err, "the starts of a search");
    memcpy(next, s->best.u, sizeof next);
    memcpy(from, s->best.u, sizeof from);
    for (int k = 0; k <= ROUNDS && err->status == SF_OK; k++) {
        double least = INFINITY;
        for (int l = 0; k > 0 && l < PLACES; l++) {
            gsl_qrng_get(places, place);
            for (int j = 0; j < p->parameters; j++)
                s->trial.u[j] =
                    sf_mapping_inside(p, j, p->prior[j] + p->prior_sd[j] * gsl_cdf_ugaussian_Pinv(place[j]));
            double objective = expect(s, err);
            if (objective < least) {
                least = objective;
                memcpy(from, s->trial.u, sizeof from);
            }
        }
        sf_error failure = SF_ERROR_INIT;
        if ((k > 0 && isinf(least)) || propose(s, from, INFINITY, &failure) != SF_OK)
            continue;
        double objective = expect(s, err);
        if (objective < lowest) {
            lowest = objective;
            memcpy(next, s->trial.u, sizeof next);
        }
    }
    memcpy(s->trial.u, next, sizeof next);
    gsl_qrng_free(places);
    return err->status;
}

/* Simulates the trial point; a drop that fails numerically there is a point of infinite objective. */
static sf_status try_point(search *s, sf_error *err) {
    sf_error failure = SF_ERROR_INIT;
    if (simulate(s, &s->trial, &failure) == SF_OK)
        return SF_OK;
    if (failure.status != SF_ERR_NUMERIC)
        *err = failure;
    s->trial.objective = INFINITY;
    return err->status;
}

/* Standard deviation by which the simulation's own noise moves the objective; 0 in the first phase, whose
 * derivatives are the surrogate's. */
static double noise_of(const search *s) {
    const sf_mapping_problem *p = s->problem;
    double sum = 0;
    for (int i = 0; i < p->responses && s->linear; i++)
        if (!isinf(p->sd[i]))
            sum += pow(2 * sf_mapping_residual(p, p->sd, s->best.y, i) * NOISE / p->sd[i], 2);
    return sqrt(sum);
}

/* The end: the free step is short, or would gain nothing that counts, or two steps in a row lowered nothing
 * that counts where little is expected. A matrix that began as another problem's can make the step short in
 * every parameter although the objective would fall along correlated ones: the step must then gain little,
 * too. */
static bool is_settled(const sf_mapping_problem *p, double step, double gain, int idle, double noise) {
    bool is_short = step < p->tolerance && (!p->first_matrix || gain < 2 * p->tolerance);
    return is_short || gain < p->tolerance * p->tolerance || (idle >= 2 && gain < 10 * p->tolerance + noise);
}

/* The first simulation, at the minimum with the given offset or at the start; there too if it fails. */
static sf_status begin(search *s, sf_error *err) {
    const sf_mapping_problem *p = s->problem;
    point *best = &s->best;
    size_t size = (size_t)p->parameters * sizeof *best->u;
    sf_error failure = SF_ERROR_INIT;
    memcpy(best->u, p->start, size);
    if (!p->first_offset)
        return simulate(s, best, err);
    if (p->first_point)
        memcpy(best->u, p->first_point, size);
    for (int i = 0; i < p->responses; i++)
        best->offset[i] = isfinite(p->first_offset[i]) ? p->first_offset[i] : 0;
    if (propose(s, best->u, INFINITY, &failure) == SF_OK) {
        memcpy(best->u, s->trial.u, size);
        if (simulate(s, best, &failure) == SF_OK)
            return SF_OK;
    }
    if (failure.status != SF_ERR_NUMERIC)
        return SF_FAIL(err, failure.status, "%s", failure.text);
    memcpy(best->u, p->start, size);
    return simulate(s, best, err);
}

/* The trial becomes the best point if it is. */
static void keep_better(search *s) {
    if (!(s->trial.objective < s->best.objective))
        return;
    point before = s->best;
    s->best = s->trial;
    s->trial = before;
}

/* Simulates the trial and keeps the better point. The radius of the trust region follows the ratio of what
 * the objective lost to what it was expected to lose. */
static sf_status advance(search *s, double expected, double *radius, int *idle, sf_error *err) {
    static const double POOR = 0.25, GOOD = 0.75;
    double length = distance(s);
    SF_TRY(try_point(s, err));
    double loss = s->best.objective - s->trial.objective,
           noise = fmax(s->problem->tolerance, 0.5 * noise_of(s)),
           ratio = (loss + noise) / (expected + noise);
    *idle = loss < 2 * noise ? *idle + 1 : 0;
    if (ratio < POOR)
        *radius = fmax(LEAST_RADIUS, fmin(*radius, length) / (ratio < 0 ? 4 : 2));
    else if (ratio > GOOD)
        *radius = fmax(*radius, 2 * length);
    keep_better(s);
    return regress_matrix(s, err);
}

/* True if the surrogate is the simulation, as of a fit without drops: its derivatives are right. */
static bool is_exact(const search *s) {
    double largest = 0;
    for (int i = 0; i < s->problem->responses; i++)
        largest = fmax(largest, fabs(s->best.offset[i]));
    return largest < 1e-9;
}

/* Step of a parameter that changes a datum by five times the noise, as the columns have it. */
static double difference_of(const search *s, int j) {
    const sf_mapping_problem *p = s->problem;
    double slope = 0;
    for (int i = 0; i < p->responses; i++)
        if (!isinf(p->sd[i]))
            slope = fmax(slope, fabs(s->result->corrected[i * p->parameters + j]));
    return fmin(fmin(fmax(LEAST_DIFFERENCE, 5 * NOISE / slope), LONGEST_STEP), p->prior_sd[j]);
}

/* Begins the second phase: where the columns lock up and the simulation does not, M cannot
 * correct their derivatives. One simulation along each parameter, to the side of the last proposal or away
 * from a bound, tells those of the simulation itself. */
static sf_status leave_surrogate(search *s, sf_error *err) {
    const sf_mapping_problem *p = s->problem;
    double towards[SF_MAPPING_MAX_PARAMETERS];
    for (int j = 0; j < p->parameters; j++)
        towards[j] = s->trial.u[j] - s->best.u[j];
    s->linear = true;
    memcpy(s->offset, s->y, (size_t)s->count * (size_t)p->responses * sizeof *s->y);
    memcpy(s->best.offset, s->best.y, (size_t)p->responses * sizeof *s->y);
    for (int j = 0; j < p->parameters && err->status == SF_OK; j++, s->result->iterations++) {
        double step = copysign(difference_of(s, j), towards[j]);
        memcpy(s->trial.u, s->best.u, sizeof s->trial.u);
        s->trial.u[j] += sf_mapping_inside(p, j, s->best.u[j] + step) == s->best.u[j] + step ? step : -step;
        SF_TRY(try_point(s, err));
        if (isinf(s->trial.objective)) { /* the other side may do */
            s->trial.u[j] = sf_mapping_inside(p, j, 2 * s->best.u[j] - s->trial.u[j]);
            s->result->iterations++;
            SF_TRY(try_point(s, err));
        }
        keep_better(s);
    }
    SF_TRY(err->status);
    return regress_matrix(s, err);
}

/* Ends the second phase: offset and M are those of the surrogate again, which other fits to the same data
 * begin with; 0 where the columns collapse. */
static sf_status return_to_surrogate(search *s, sf_error *err) {
    const sf_mapping_problem *p = s->problem;
    int entries = p->responses * p->parameters;
    sf_mapping_result *r = s->result;
    sf_error failure = SF_ERROR_INIT;
    r->linear = true;
    s->linear = false;
    memcpy(r->corrected, r->matrix, (size_t)entries * sizeof *r->matrix);
    memset(r->matrix, 0, (size_t)entries * sizeof *r->matrix);
    memset(s->best.offset, 0, (size_t)p->responses * sizeof *s->best.offset);
    SF_OWNED double *told = sf_alloc(err, p->responses, sizeof *told, "responses"),
                    *slope = sf_alloc(err, entries, sizeof *slope, "Jacobian");
    SF_TRY(err->status);
    const sf_mapping_model model = model_at(s);
    if (p->surrogate(p->context, s->best.u, told, &failure) != SF_OK ||
        sf_mapping_differentiate(&model, slope, &failure) != SF_OK)
        return failure.status == SF_ERR_NUMERIC ? SF_OK : (*err = failure, err->status);
    for (int i = 0; i < p->responses; i++)
        s->best.offset[i] = s->best.y[i] - told[i];
    for (int k = 0; k < entries; k++)
        r->matrix[k] = isfinite(slope[k]) ? r->corrected[k] - slope[k] : 0;
    return SF_OK;
}

/* Proposes again until the trial is no farther from the best point than `radius`. */
static sf_status hold_back(search *s, double radius, sf_error *err) {
    for (double hold = 2 * radius; err->status == SF_OK && distance(s) > radius; hold /= 2)
        propose(s, s->best.u, hold, err);
    return err->status;
}

/* True if no step over the distance of the second phase's differences is expected to gain what counts: beyond
 * it their noise is extrapolated. */
static bool is_flat(search *s, sf_error *err) {
    double step, gain = INFINITY;
    if (s->linear && hold_back(s, LEAST_DIFFERENCE, err) == SF_OK)
        measure_step(s, &step, &gain, err);
    return gain < 10 * s->problem->tolerance + noise_of(s);
}

static sf_status iterate(search *s, sf_error *err) {
    const sf_mapping_problem *p = s->problem;
    sf_mapping_result *r = s->result;
    double radius = INFINITY, step = 0, expected = 0;
    int idle = 0;        /* steps in a row, taken or not, that lowered the objective by nothing that counts */
    bool longer = false; /* the longest step is tried, or was in vain */
    SF_TRY(begin(s, err));
    r->iterations = 1;
    for (;;) {
        bool widely = p->wide && r->iterations == 1 && !p->first_matrix;
        SF_TRY(widely ? propose_widely(s, err) : propose(s, s->best.u, INFINITY, err));
        SF_TRY(measure_step(s, &step, &r->gain, err));
        bool settled = is_settled(p, step, r->gain, idle, noise_of(s));
        bool doubtful = settled ? contradicts(r) && !p->first_matrix : idle >= MOST_IDLE;
        if (doubtful && !s->linear && !is_exact(s) && r->iterations + p->parameters < p->max_iterations) {
            SF_TRY(leave_surrogate(s, err));
            radius = LEAST_DIFFERENCE;
            idle = 0;
            continue;
        }
        if (idle >= MOST_IDLE && s->linear && !settled && !longer) {
            longer = true;
            idle--;
            radius = LONGEST_STEP;
        }
        settled = settled || (idle >= MOST_IDLE && is_flat(s, err));
        SF_TRY(err->status);
        bool misses = !is_exact(s) && r->misfit > pow(MOST_MISS, 2) * fmax(1, r->freedom);
        r->reason = settled && is_bound(p, s->best.y) ? "a drop stands at the bound of what can be used"
                    : settled && misses ? "the data are missed by ten times their standard deviations"
                    : settled           ? NULL
                    : idle >= MOST_IDLE ? "no proposed step lowers the objective"
                                        : "the limit of simulations came first";
        r->converged = !r->reason;
        if (settled || idle >= MOST_IDLE || r->iterations >= p->max_iterations)
            break;
        SF_TRY(hold_back(s, radius, err));
        SF_TRY(measure_step(s, &step, &expected, err));
        SF_TRY(advance(s, expected, &radius, &idle, err));
        longer = longer && idle > 0;
        r->iterations++;
    }
    if (s->linear)
        SF_TRY(return_to_surrogate(s, err));
    return estimate(p, true, r, err);
}

sf_status sf_mapping_solve(const sf_mapping_problem *p, sf_mapping_result *r, sf_error *err) {
    unsigned long n = (unsigned long)p->responses, entries = n * (unsigned long)p->parameters,
                  points = (unsigned long)p->max_iterations + 2;
    *r = (sf_mapping_result){.corrected = sf_alloc(err, entries, sizeof(double), "Jacobian"),
                             .matrix = sf_alloc(err, entries, sizeof(double), "matrix")};
    search s = {.problem = p,
                .result = r,
                .linear = p->first_linear,
                .best = {.y = sf_alloc(err, n, sizeof(double), "responses"),
                         .offset = sf_alloc(err, n, sizeof(double), "responses")},
                .trial = {.y = sf_alloc(err, n, sizeof(double), "responses"),
                          .offset = sf_alloc(err, n, sizeof(double), "responses")},
                .u = sf_alloc(err, points, sizeof *s.u, "points"),
                .y = sf_alloc(err, points * n, sizeof(double), "points"),
                .offset = sf_alloc(err, points * n, sizeof(double), "points")};
    if (err->status == SF_OK && regress_matrix(&s, err) == SF_OK)
        iterate(&s, err);
    memcpy(r->u, s.best.u, sizeof r->u);
    r->y = s.best.y;
    r->offset = s.best.offset;
    r->misfit = s.best.misfit;
    r->objective = s.best.objective;
    SF_FREE(s.trial.y, s.trial.offset, s.u, s.y, s.offset);
    return err->status;
}

void sf_mapping_free(sf_mapping_result *r) {
    SF_FREE(r->y, r->corrected, r->offset, r->matrix);
    *r = (sf_mapping_result){0};
}

sf_status sf_mapping_refit(const sf_mapping_problem *p, const sf_mapping_result *r, const double *sd,
                           double *u, double *y, sf_error *err) {
    const sf_mapping_model model = {p, r->linear, r->u, r->linear ? r->y : r->offset,
                                    r->linear ? r->corrected : r->matrix};
    memcpy(u, r->u, (size_t)p->parameters * sizeof *u);
    SF_TRY(sf_mapping_minimise(&model, sd, r->u, INFINITY, u, err));
    return sf_mapping_evaluate(&model, u, y, err);
}
