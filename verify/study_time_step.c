/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The time step against the exact stability limit of small models whose tangent stiffness is assembled by
 * differences of the solver's own forces: estimate, guaranteed bound, leap-frog on both sides of the limit, a
 * whole drop, and the power iteration at a size where nothing can be assembled. */
#include "extreme.h"
#include "model_fixture.h"
#include "solver/field/domain_stress.h"
#include "solver/field/stabilisation.h"
#include "solver/step.h"
#include "solver/time_step.h"
#include "study.h"

#include <gsl/gsl_eigen.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { REGULAR, JITTERED, PAD, CLOUDS };
static const char *const CLOUD_NAME[] = {"regular block", "jittered block", "pad"};

enum { ELASTIC, MAXWELL, VISCOUS, MATERIALS };
static const char *const MATERIAL_NAME[] = {"curve, hysteresis", "with Maxwell",
                                            "with Maxwell, DAMP, Kelvin"};

enum { AT_REST, PRESSED_60, PRESSED_80, INDENTED, UNLOADED_5, UNLOADED_30, DEFORMATIONS };
static const char *const DEFORMATION_NAME[] = {
    "at rest",          "pressed to 60 %",        "pressed to 80 %",
    "locally indented", "60 %, unloaded to 55 %", "60 %, unloaded to 30 %"};

static const double RATE = 100; /* s-1, of the last 5 % of a deformation: what the Maxwell stress remembers */
static const double PROBE = 1e-6;   /* of the spacing: displacement of the differences */
static const double INSTANT = 1e-9; /* s, step of the stiffness: the Maxwell branch answers with all of ED */
static const double PROBE_STEP = 1e-5; /* s, step of the viscosity */

static void build(int cloud, int material, fixture *f) {
    sf_case c;
    sf_mesh mesh;
    sf_surface surface;
    fixture_case(&c, (const char *const[]){"geometry.parameters.fine_spacing=25.0",
                                           "geometry.parameters.outer_spacing=50.0", NULL});
    if (material < MAXWELL)
        sf_foam_card_of(&c.material)->shared.maxwell_modulus = 0;
    sf_foam_card_of(&c.material)->shared.kelvin_viscosity = material == VISCOUS ? 20 : 0;
    if (material < VISCOUS)
        sf_foam_card_of(&c.material)->shared.damp = 0;
    c.run.step_limit = c.run.step_safety = 1;
    if (cloud == PAD) {
        fixture_geometry(&c, &mesh, &surface);
    } else {
        const double jitter = cloud == JITTERED ? 0.25 : 0;
        const fixture_block block = {
            .cells = {4, 4, 4}, .spacing = 0.01, .jitter = jitter, .surface_jitter = 0.8 * jitter};
        fixture_hold(&c, (const char *const[]){"base", NULL});
        fixture_block_mesh(&block, &mesh);
        fixture_plate(1, 0, 0, &surface);
    }
    fixture_build(&c, &mesh, &surface, f);
    fixture_start(f);
}

/* Uniform uniaxial compression, or a dent of the given depth at the axis x = y = 0 (with a little lateral
 * stretch, which keeps the directions away from the kink of the law at rest). */
static void set_compression(fixture *f, double strain, bool dent) {
    double h = f->model.thickness;
    for (int64_t i = 0; i < f->model.node_count; i++) {
        const double *x = &f->model.position[3 * i];
        double *d = &f->state.d[3 * i], near = exp(-(x[0] * x[0] + x[1] * x[1]) / (0.5 * h * h));
        d[0] = dent ? (0.01 + 0.1 * x[2] / h * near) * x[0] : 0;
        d[1] = dent ? 0.01 * x[1] : 0;
        d[2] = -strain * x[2] * (dent ? 0.02 + near : 1);
    }
}

static void go_to(fixture *f, double strain, bool dent, double dt) {
    set_compression(f, strain, dent);
    f->state.dt_old = dt;
    fixture_forces(f);
}

static void deform(fixture *f, int deformation) {
    static const double first[] = {0, 0.55, 0.75, 0.55, 0.6, 0.6}, last[] = {0, 0.6, 0.8, 0.6, 0.55, 0.3};
    bool dent = deformation == INDENTED;
    go_to(f, first[deformation], dent, 0);
    if (deformation != AT_REST)
        go_to(f, last[deformation], dent, fabs(last[deformation] - first[deformation]) / RATE);
}

/* A state whose forces are asked for many displacements: history restored each time. */
typedef struct probe {
    fixture *f;
    size_t size; /* 3 n */
    double *d, *gradient, *history, *stiffness;
} probe;

static double *copy(const double *from, size_t count) {
    double *to = malloc(count * sizeof *to);
    memcpy(to, from, count * sizeof *to);
    return to;
}

static size_t history_size(const fixture *f) {
    return SF_LANES * (size_t)sf_state_rows(&f->model, 'h');
}

/* Domains on the loading curve stay on it: a largest W of zero is exceeded by whatever comes. */
static probe probe_begin(fixture *f) {
    const sf_state *s = &f->state;
    size_t n = (size_t)f->model.node_count, blocks = (n + SF_LANES - 1) / SF_LANES;
    probe p = {f,
               3 * n,
               copy(s->d, 3 * n),
               copy(s->f, 9 * n),
               copy(s->history, history_size(f)),
               copy(s->stiffness, n)};
    for (size_t block = 0; block < blocks; block++) {
        sf_law_batch b;
        double *peak = &p.history[(block * (size_t)s->history_rows + SF_FOAM_PEAK) * SF_LANES];
        sf_domain_law(&f->model, &f->operators, s, (int64_t)block, &b);
        for (int l = 0; l < SF_LANES; l++)
            if (b.energy[l] >= peak[l])
                peak[l] = 0;
    }
    return p;
}

static void probe_end(probe *p) {
    free(p->d);
    free(p->gradient);
    free(p->history);
    free(p->stiffness);
}

static void restore(const probe *p) {
    sf_state *s = &p->f->state;
    size_t n = p->size / 3;
    memcpy(s->f, p->gradient, 9 * n * sizeof *s->f);
    memcpy(s->history, p->history, history_size(p->f) * sizeof *s->history);
}

/* Forces at the state's d after a step of dt from the kept state; the pairs keep their stiffness. */
static void probe_forces(const probe *p, double dt) {
    sf_state *s = &p->f->state;
    restore(p);
    s->dt_old = dt;
    sf_domain_stress(&p->f->model, &p->f->operators, s);
    memcpy(s->stiffness, p->stiffness, p->size / 3 * sizeof *s->stiffness);
    sf_stabilisation(&p->f->model, &p->f->operators, s);
    sf_internal_force(&p->f->model, &p->f->operators, s);
}

/* - df/dd at a step of dt, symmetrised and scaled by the masses: M^-1/2 K M^-1/2. Returns the largest
 * difference from symmetry, relative to the largest entry. */
static double differentiate(const probe *p, double dt, gsl_matrix *k) {
    sf_state *s = &p->f->state;
    const sf_model *m = &p->f->model;
    double *ahead = copy(s->force, p->size), skew = 0, largest = 0;
    for (size_t j = 0; j < p->size; j++) {
        double step = PROBE * m->spacing[j / 3];
        s->d[j] = p->d[j] + step;
        probe_forces(p, dt);
        memcpy(ahead, s->force, p->size * sizeof *ahead);
        s->d[j] = p->d[j] - step;
        probe_forces(p, dt);
        s->d[j] = p->d[j];
        for (size_t i = 0; i < p->size; i++)
            gsl_matrix_set(k, i, j, (s->force[i] - ahead[i]) / (2 * step));
    }
    free(ahead);
    for (size_t i = 0; i < p->size; i++)
        for (size_t j = 0; j <= i; j++) {
            double a = gsl_matrix_get(k, i, j), b = gsl_matrix_get(k, j, i);
            double scaled = 0.5 * (a + b) / sqrt(m->mass[i / 3] * m->mass[j / 3]);
            skew = larger(skew, fabs(a - b));
            largest = larger(largest, fabs(a));
            gsl_matrix_set(k, i, j, scaled);
            gsl_matrix_set(k, j, i, scaled);
        }
    return skew / largest;
}

/* Stiffness and viscosity matrices: with the viscous terms off, and what they add. */
static double assemble(const probe *p, gsl_matrix *k, gsl_matrix *c) {
    sf_foam *foam = p->f->operators.law[0].numbers;
    double damp = foam->options.damp, kelvin = foam->options.kelvin;
    foam->options.damp = foam->options.kelvin = 0;
    double skew = differentiate(p, INSTANT, k);
    gsl_matrix_set_zero(c);
    if (damp > 0 || kelvin > 0) {
        gsl_matrix *elastic = gsl_matrix_alloc(p->size, p->size);
        differentiate(p, PROBE_STEP, elastic);
        foam->options.damp = damp;
        foam->options.kelvin = kelvin;
        differentiate(p, PROBE_STEP, c);
        gsl_matrix_sub(c, elastic);
        gsl_matrix_scale(c, PROBE_STEP);
        gsl_matrix_free(elastic);
    }
    return skew;
}

static double largest_eigenvalue(const gsl_matrix *k) {
    gsl_matrix *work = gsl_matrix_alloc(k->size1, k->size1);
    gsl_vector *value = gsl_vector_alloc(k->size1);
    gsl_eigen_symm_workspace *w = gsl_eigen_symm_alloc(k->size1);
    gsl_matrix_memcpy(work, k);
    gsl_eigen_symm(work, value, w);
    double largest = gsl_vector_max(value);
    gsl_eigen_symm_free(w);
    gsl_vector_free(value);
    gsl_matrix_free(work);
    return largest;
}

/* Is 4 - 2 dt C - dt^2 K positive definite? */
static bool is_stable(const gsl_matrix *k, const gsl_matrix *c, double dt) {
    gsl_matrix *work = gsl_matrix_alloc(k->size1, k->size1);
    for (size_t i = 0; i < k->size1; i++)
        for (size_t j = 0; j < k->size1; j++)
            gsl_matrix_set(work, i, j,
                           (i == j ? 4 : 0) - 2 * dt * gsl_matrix_get(c, i, j) -
                               dt * dt * gsl_matrix_get(k, i, j));
    bool stable = gsl_linalg_cholesky_decomp1(work) == GSL_SUCCESS;
    gsl_matrix_free(work);
    return stable;
}

/* The exact limit: 2/omega without viscosity; with it, the step at which 4 - 2 dt C - dt^2 K becomes
 * singular. */
static double exact_limit(const gsl_matrix *k, const gsl_matrix *c) {
    double high = 2 / sqrt(largest_eigenvalue(k)), low = 0.2 * high;
    if (gsl_matrix_isnull(c))
        return high;
    while (high - low > 1e-4 * high) {
        double middle = 0.5 * (low + high);
        *(is_stable(k, c, middle) ? &low : &high) = middle;
    }
    return low;
}

/* What the solver takes, at a safety of 1, with history and masses of the state; the bound alone into
 * `bound`. A step's viscosity needs the step before it, so the choice is repeated until it no longer moves.
 */
static double estimate(const probe *p, double *bound) {
    sf_state *s = &p->f->state;
    double dt = s->dt_old > 0 ? s->dt_old : INSTANT;
    memset(s->mode, 0, p->size / 3 * sizeof *s->mode);
    for (int pass = 0; pass < 3; pass++) {
        s->tightness = 1;
        s->step = 0;
        s->ceiling = INFINITY;
        probe_forces(p, dt);
        *bound = INFINITY;
        for (int64_t k = 0; k < s->chunk_count; k++)
            *bound = smaller(*bound, s->partial[k].step);
        sf_time_step_choose(&p->f->model, &p->f->operators, s);
        probe_forces(p, dt); /* partial sums with the measured tightness, as in the steps that follow */
        dt = INFINITY;
        for (int64_t k = 0; k < s->chunk_count; k++)
            dt = smaller(dt, s->partial[k].step);
    }
    return dt;
}

/* Leap-frog of the highest mode about the kept state with the real forces, small enough to be linear: its
 * largest amplitude over its start; ends early beyond `enough`. Motion is held to this mode, because a block
 * under stress and free to turn buckles. */
static double vibrate(const probe *p, const double *mode, double dt, int steps, double enough) {
    sf_state *s = &p->f->state;
    const sf_model *m = &p->f->model;
    double start = 1e-6 * m->spacing[0] * sqrt(m->mass[0]), x = start, v = 0, largest = 0;
    memcpy(s->d, p->d, p->size * sizeof *s->d);
    probe_forces(p, 0);
    double *rest = copy(s->force, p->size);
    for (int step = 0; step < steps && largest < enough; step++) {
        double acceleration = 0; /* mode and x are in coordinates scaled by sqrt(mass) */
        for (size_t i = 0; i < p->size; i++)
            s->d[i] = p->d[i] + x * mode[i] / sqrt(m->mass[i / 3]);
        probe_forces(p, 0);
        for (size_t i = 0; i < p->size; i++)
            acceleration += mode[i] * (s->force[i] - rest[i]) / sqrt(m->mass[i / 3]);
        v += (step ? dt : 0.5 * dt) * acceleration;
        x += dt * v;
        largest = larger(largest, fabs(x) / start);
    }
    memcpy(s->d, p->d, p->size * sizeof *s->d);
    free(rest);
    return largest;
}

/* Extremes over all states. */
typedef struct extremes {
    double estimate_low, estimate_high, bound_low, bound_high, skew, calm, growth;
} extremes;

static void try_leap_frog(const probe *p, const gsl_matrix *k, double limit, extremes *e) {
    gsl_matrix *work = gsl_matrix_alloc(p->size, p->size), *vectors = gsl_matrix_alloc(p->size, p->size);
    gsl_vector *values = gsl_vector_alloc(p->size);
    gsl_eigen_symmv_workspace *w = gsl_eigen_symmv_alloc(p->size);
    gsl_matrix_memcpy(work, k);
    gsl_eigen_symmv(work, values, vectors, w);
    size_t top = gsl_vector_max_index(values);
    double *mode = malloc(p->size * sizeof *mode);
    for (size_t i = 0; i < p->size; i++)
        mode[i] = gsl_matrix_get(vectors, i, top);
    e->calm = larger(e->calm, vibrate(p, mode, 0.95 * limit, 1000, 1e3));
    e->growth = smaller(e->growth, vibrate(p, mode, 1.05 * limit, 40, 1e3));
    free(mode);
    gsl_eigen_symmv_free(w);
    gsl_vector_free(values);
    gsl_matrix_free(vectors);
    gsl_matrix_free(work);
}

static void one_state(sf_study *s, int cloud, int material, int deformation, extremes *e) {
    fixture f;
    double bound;
    build(cloud, material, &f);
    deform(&f, deformation);
    probe p = probe_begin(&f);
    gsl_matrix *k = gsl_matrix_alloc(p.size, p.size), *c = gsl_matrix_alloc(p.size, p.size);
    double skew = assemble(&p, k, c), exact = exact_limit(k, c), chosen = estimate(&p, &bound);
    sf_study_text(s, "| %s | %s | %s | %.2f | %.3f | %.3f |\n", CLOUD_NAME[cloud], MATERIAL_NAME[material],
                  DEFORMATION_NAME[deformation], 1e6 * exact, bound / exact, chosen / exact);
    e->estimate_low = smaller(e->estimate_low, chosen / exact);
    e->estimate_high = larger(e->estimate_high, chosen / exact);
    e->bound_low = smaller(e->bound_low, bound / exact);
    e->bound_high = larger(e->bound_high, bound / exact);
    e->skew = larger(e->skew, skew);
    if (material == ELASTIC && deformation != AT_REST) /* at rest the law has a kink: no linear motion */
        try_leap_frog(&p, k, exact, e);
    gsl_matrix_free(k);
    gsl_matrix_free(c);
    probe_end(&p);
    fixture_free(&f);
}

static void all_states(sf_study *s) {
    extremes e = {.estimate_low = INFINITY, .bound_low = INFINITY, .growth = INFINITY};
    sf_study_text(
        s,
        "The exact limit comes from the assembled tangent stiffness (central differences of the solver's forces, "
        "stabilisation included): its largest eigenvalue, or, with viscosity, the Δt at which 4M − 2ΔtC − Δt²K "
        "becomes singular. It is taken for three foams in six states on three clouds. *Bound*: the guaranteed "
        "bound (theory, eq. 31). *Estimate*: the solver's time step at `step_safety` 1.\n\n"
        "| cloud | foam | state | exact limit, µs | bound / exact | estimate / exact |\n"
        "|---|---|---|---|---|---|\n");
    for (int cloud = 0; cloud < CLOUDS; cloud++)
        for (int material = 0; material < MATERIALS; material++)
            for (int deformation = 0; deformation < DEFORMATIONS; deformation++)
                one_state(s, cloud, material, deformation, &e);
    sf_study_text(s, "\n");
    sf_study_check(s, e.skew, 0, 1e-4, "asymmetry of the assembled stiffness");
    sf_study_check(s, e.estimate_high, 0, 1, "largest estimate / exact limit");
    sf_study_check(s, e.estimate_low, 0.8, INFINITY, "smallest estimate / exact limit");
    sf_study_check(s, e.bound_high, 0, 1, "largest guaranteed bound / exact limit");
    sf_study_check(s, e.calm, 0, 5,
                   "leap-frog at 0.95 of the limit, 1000 steps: largest growth of the highest mode");
    sf_study_check(s, e.growth, 1e3, INFINITY,
                   "leap-frog at 1.05 of the limit, 40 steps: smallest growth of this mode");
}

/* The solver itself, steps forced, from a small random motion of a linear block at rest: largest coefficient
 * over the start. */
static double free_vibration(fixture *f, double dt, int steps, double enough) {
    sf_state *s = &f->state;
    uint64_t seed = 3;
    double start = 1e-7 * f->model.spacing[0], largest = 0;
    sf_error err = SF_ERROR_INIT;
    fixture_start(f);
    f->model.run.step_limit = dt;
    f->model.run.step_safety = 10; /* the limit decides */
    for (int64_t i = 0; i < 3 * f->model.node_count; i++)
        s->d[i] = start * fixture_random(&seed);
    for (int step = 0; step < steps && largest < enough; step++) {
        if (sf_step_evaluate(&f->model, &f->operators, s, &err) != SF_OK)
            return INFINITY;
        sf_step_advance(&f->model, s);
        for (int64_t i = 0; i < 3 * f->model.node_count; i++)
            largest = larger(largest, fabs(s->d[i]) / start);
    }
    return largest;
}

static void linear_block(sf_study *s) {
    fixture f;
    sf_case c;
    const fixture_block block = {.cells = {4, 4, 4}, .spacing = 0.01, .jitter = 0.25, .surface_jitter = 0.2};
    fixture_case(&c, NULL);
    fixture_make_linear(&c);
    fixture_hold(&c, (const char *const[]){NULL});
    c.missile_card.gap = 100; /* out of the way */
    c.missile_card.gravity = 0;
    c.run.energy_limit = 1e9; /* an unstable run must not be stopped */
    fixture_under_plate(&c, &block, 1, 0, 0, &f);
    fixture_start(&f);
    deform(&f, AT_REST);
    probe p = probe_begin(&f);
    gsl_matrix *k = gsl_matrix_alloc(p.size, p.size);
    differentiate(&p, INSTANT, k);
    double limit = 2 / sqrt(largest_eigenvalue(k));
    sf_study_check(s, free_vibration(&f, 0.95 * limit, 2000, 1e6), 0, 20,
                   "free linear block through sf_step, 0.95 of the limit, 2000 steps: largest growth");
    sf_study_check(s, free_vibration(&f, 1.05 * limit, 200, 1e6), 1e6, INFINITY,
                   "the same block at 1.05 of the limit, within 200 steps");
    gsl_matrix_free(k);
    probe_end(&p);
    fixture_free(&f);
}

/* Exact limit at the state of a running drop, assembled on a twin of the model. */
static double limit_of(const fixture *drop, fixture *twin, gsl_matrix *k, gsl_matrix *c) {
    const sf_state *from = &drop->state;
    sf_state *to = &twin->state;
    size_t n = (size_t)drop->model.node_count;
    memcpy(to->d, from->d, 3 * n * sizeof *to->d);
    memcpy(to->f, from->f, 9 * n * sizeof *to->f);
    memcpy(to->history, from->history, history_size(twin) * sizeof *to->history);
    memcpy(to->stiffness, from->stiffness, n * sizeof *to->stiffness);
    probe p = probe_begin(twin);
    assemble(&p, k, c);
    probe_end(&p);
    return exact_limit(k, c);
}

/* A drop on a pad small enough to assemble, all terms of the law but Kelvin's: the step in use against the
 * exact limit. */
static void small_drop(sf_study *s) {
    fixture f, twin;
    sf_error err = SF_ERROR_INIT;
    double high = 0, low = INFINITY, sum = 0;
    int count = 0;
    FILE *steps = sf_study_file(s, "steps.txt"), *exact_file = sf_study_file(s, "exact.txt");
    build(PAD, VISCOUS, &f);
    build(PAD, VISCOUS, &twin);
    sf_state *st = &f.state;
    ((sf_foam *)f.operators.law[0].numbers)->options.kelvin =
        ((sf_foam *)twin.operators.law[0].numbers)->options.kelvin = 0;
    gsl_matrix *k = gsl_matrix_alloc(3 * (size_t)f.model.node_count, 3 * (size_t)f.model.node_count);
    gsl_matrix *c = gsl_matrix_alloc(k->size1, k->size1);
    while (st->time < 20e-3 && sf_step_evaluate(&f.model, &f.operators, st, &err) == SF_OK) {
        double used = st->dt / f.model.run.step_safety;
        if (steps)
            fprintf(steps, "%g %g %g\n", 1e3 * st->time, 1e6 * used, 2e6 / sqrt(st->bound_load));
        if (st->step % 25 == 24) {
            double exact = limit_of(&f, &twin, k, c);
            low = smaller(low, used / exact);
            high = larger(high, used / exact);
            sum += st->dt / exact;
            count++;
            if (exact_file)
                fprintf(exact_file, "%g %g\n", 1e3 * st->time, 1e6 * exact);
        }
        sf_step_advance(&f.model, st);
    }
    if (err.status != SF_OK)
        sf_study_fail(s, &err);
    if (steps && exact_file) {
        fclose(steps);
        fclose(exact_file);
    }
    sf_study_text(
        s,
        "A drop on the pad of %lld nodes with the foam of the examples. In every 25th step the "
        "study compares the step in use with the exact limit. The step in use includes the slow "
        "growth after stiffer states (2 %% a step, and only when the solver measures the frequency).\n\n",
        (long long)f.model.node_count);
    sf_study_check(s, high, 0, 1, "drop: largest step (at safety 1) / exact limit");
    sf_study_check(s, low, 0.8, INFINITY, "drop: smallest step (at safety 1) / exact limit");
    sf_study_check(s, sum / count, 0.8, 1, "drop: mean step, with the default safety / exact limit");
    sf_study_plot(
        s, "drop.png", "Time step of a drop, its guaranteed bound, and the exact limit",
        "set xlabel 'time (ms)'\nset ylabel 'time step (us)'\nset yrange [0:*]\nset key bottom left\n"
        "plot 'time_step-exact.txt' with linespoints lw 2 pt 7 title 'exact limit', "
        "'time_step-steps.txt' using 1:2 with lines lw 2 title 'estimate (safety 1)', "
        "'' using 1:3 with lines lw 2 title 'guaranteed bound'");
    gsl_matrix_free(k);
    gsl_matrix_free(c);
    fixture_free(&f);
    fixture_free(&twin);
}

/* The power iteration's estimate, with its margin, against its own limit at a size that cannot be assembled.
 */
static void power_iteration(sf_study *s) {
    fixture f;
    sf_error err = SF_ERROR_INIT;
    double low = INFINITY, high = 0;
    int64_t products = 0;
    fixture_pad((const char *const[]){"geometry.parameters.fine_spacing=10.0",
                                      "geometry.parameters.outer_spacing=20.0", NULL},
                &f);
    fixture_start(&f);
    sf_state *st = &f.state;
    size_t n = (size_t)f.model.node_count;
    while (st->time < 20e-3 && sf_step_evaluate(&f.model, &f.operators, st, &err) == SF_OK) {
        if (st->measured_at == st->step) {
            double used = st->tightness * st->bound_load, *mode = copy(st->mode, n);
            products = st->power_iterations;
            double ratio = used / sf_time_step_power(&f.model, &f.operators, st, 240, 0);
            st->power_iterations = products;
            memcpy(st->mode, mode, n * sizeof *mode);
            free(mode);
            low = smaller(low, ratio);
            high = larger(high, ratio);
        }
        sf_step_advance(&f.model, st);
    }
    if (err.status != SF_OK)
        sf_study_fail(s, &err);
    sf_study_text(
        s,
        "The same drop with %lld nodes. At every measurement the study compares the square of "
        "the frequency in use (from up to 80 Lanczos products at first, then 4 to 8 each time) with the result of "
        "240 more products. What it lacks is covered by the safety of 0.95, which is 0.90 on the square. The drop "
        "took %lld products in %lld steps.\n\n",
        (long long)n, (long long)products, (long long)st->step);
    sf_study_check(s, low, 0.95, INFINITY, "smallest square of the frequency in use / converged");
    sf_study_check(s, high, 1, 1.1, "largest square of the frequency in use / converged");
    fixture_free(&f);
}

int main(int argc, char **argv) {
    sf_study s;
    sf_study_begin(&s, "time_step", "Time step", argc, argv);
    gsl_set_error_handler_off();
    all_states(&s);
    linear_block(&s);
    small_drop(&s);
    power_iteration(&s);
    return sf_study_end(&s);
}
