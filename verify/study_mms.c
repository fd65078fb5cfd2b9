/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Convergence to a manufactured finite-strain solution with a body force, in static equilibrium of the
 * program's own forces under its own constraints, found by dynamic relaxation. */
#include "extreme.h"
#include "mms_field.h"
#include "model_fixture.h"
#include "order.h"
#include "solver/time_step.h"
#include "study.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

static const double SIDE = 0.05;      /* m */
static const double TOLERANCE = 1e-7; /* of the residual force, relative to the body force */
enum { MAX_ITERATIONS = 20000 };

enum cloud { REGULAR, JITTERED, TETRAHEDRA, CLOUDS };
static const char *const CLOUD_NAME[CLOUDS] = {"regular lattice", "jittered lattice", "tetrahedra"};
enum rule { GALERKIN, LUMPED }; /* of the body force: sum V b(X_L) phi_I(X_L), or V_I b(X_I) */

typedef struct mms_result {
    double h; /* m, typical spacing */
    int64_t nodes;
    int iterations;
    double displacement; /* L2 of u_h - u over L2 of w, at the nodes */
    double gradient;     /* L2 of F - exact over L2 of grad w, at the nodes */
} mms_result;

/* A cube of about `cells` cells along a side, all of its surface held, without losses. */
static void build_cloud(enum cloud cloud, int cells, fixture *f) {
    char fine[80], outer[80], file[1100];
    sf_case c;
    sf_mesh mesh;
    sf_surface surface;
    snprintf(file, sizeof file, "geometry.file=\"%s\"", fixture_source("verify/geo/pad_tet.geo"));
    snprintf(fine, sizeof fine, "geometry.parameters.fine_spacing=%.6f", 1e3 * SIDE / cells);
    snprintf(outer, sizeof outer, "geometry.parameters.outer_spacing=%.6f", 1e3 * SIDE / cells);
    if (cloud == TETRAHEDRA) {
        fixture_case(&c, (const char *const[]){file, fine, outer, "geometry.parameters.side=100.0",
                                               "geometry.parameters.zone_side=50.0",
                                               "geometry.missile_parameters.quarter=0", NULL});
        fixture_hold(&c, (const char *const[]){"base", "top", "sides", "symmetry_x", "symmetry_y", NULL});
        fixture_geometry(&c, &mesh, &surface);
    } else {
        double jitter = cloud == JITTERED ? 0.2 : 0;
        const fixture_block block = {.cells = {cells, cells, cells},
                                     .spacing = SIDE / cells,
                                     .jitter = jitter,
                                     .surface_jitter = jitter};
        fixture_case(&c, NULL);
        fixture_hold(&c, (const char *const[]){"base", "top", "sides", NULL});
        fixture_block_mesh(&block, &mesh);
        fixture_plate(1, 0, 0, &surface);
    }
    fixture_make_elastic(&c);
    fixture_build(&c, &mesh, &surface, f);
    f->model.run.step_limit = 1;
    fixture_start(f);
}

static double *vector(int64_t count) {
    double *out = calloc((size_t)count, sizeof *out);
    if (!out)
        abort();
    return out;
}

/* Nodal forces of the body force. */
static void load(const fixture *f, const sf_mms_field *field, enum rule rule, double *force) {
    const sf_model *m = &f->model;
    memset(force, 0, 3 * (size_t)m->node_count * sizeof *force);
    for (int64_t l = 0; l < m->node_count; l++) {
        double b[3];
        sf_mms_body_force(field, f->operators.law[0].numbers, &m->position[3 * l], b);
        if (rule == LUMPED) {
            for (int c = 0; c < 3; c++)
                force[3 * l + c] = m->volume[l] * b[c];
            continue;
        }
        for (int64_t k = m->phi_ptr[l]; k < m->phi_ptr[l + 1]; k++)
            for (int c = 0; c < 3; c++)
                force[3 * (int64_t)m->phi_node[k] + c] += m->volume[l] * b[c] * m->phi_value[k];
    }
}

/* Projected acceleration of the present coefficients under `body`, into `a`. */
static void accelerations(fixture *f, const double *body, double dt, double *a) {
    const sf_model *m = &f->model;
    sf_state *s = &f->state;
    fixture_forces(f);
    for (int64_t k = 0; k < 3 * m->node_count; k++)
        s->force[k] += body[k];
    sf_constraint_step held = {.force = s->force, .v = s->v, .dt = dt, .reaction = s->reaction};
    sf_constraint_project(&f->operators.constraint, &held);
    for (int64_t k = 0; k < 3 * m->node_count; k++)
        a[k] = (s->force[k] - s->reaction[k]) / m->mass[k / 3];
}

/* Start: A X + w, with G w = 0. Both A X and w meet the boundary conditions then, because u_h reproduces A X.
 */
static void set_start(fixture *f, const sf_mms_field *field) {
    const sf_model *m = &f->model;
    sf_state *s = &f->state;
    for (int64_t i = 0; i < m->node_count; i++)
        sf_mms_disturbance(field, &m->position[3 * i], &s->v[3 * i]);
    sf_constraint_step held = {.force = s->force, .v = s->v, .dt = 1, .reaction = s->reaction};
    memset(s->force, 0, 3 * (size_t)m->node_count * sizeof *s->force);
    sf_constraint_project(&f->operators.constraint, &held);
    for (int64_t k = 0; k < 3 * m->node_count; k++) {
        double w = s->v[k] - s->reaction[k] / m->mass[k / 3];
        s->d[k] = (field->stretch[k % 3] - 1) * m->position[k] + w;
        s->v[k] = 0;
    }
}

/* Dynamic relaxation with the damping of the lowest active mode, from the Rayleigh quotient of the last step
 * (Underwood 1983). Returns the iterations, or -1. */
static int relax(fixture *f, const double *body, sf_error *err) {
    const sf_model *m = &f->model;
    sf_state *s = &f->state;
    int64_t n = 3 * m->node_count;
    double *a = vector(n), *old = vector(n), scale = 0, dt = 1e-6;
    int k, result = -1;
    for (int64_t q = 0; q < n; q++)
        scale += body[q] * body[q] / m->mass[q / 3];
    for (k = 0; k < MAX_ITERATIONS; k++) {
        double norm = 0, work = 0, kinetic = 0;
        accelerations(f, body, dt, a);
        for (int64_t q = 0; q < n; q++) {
            double mass = m->mass[q / 3];
            norm += mass * a[q] * a[q];
            work += mass * s->v[q] * (old[q] - a[q]);
            kinetic += mass * s->v[q] * s->v[q];
        }
        if (norm < TOLERANCE * TOLERANCE * scale) {
            result = k;
            break;
        }
        double omega = kinetic > 0 && work > 0 ? sqrt(work / (dt * kinetic)) : 0;
        sf_time_step_choose(m, &f->operators, s);
        dt = s->dt_old = s->dt;
        s->step++;
        double damping = fmin(2 * omega * dt, 1.9);
        for (int64_t q = 0; q < n; q++) {
            s->v[q] = ((2 - damping) * s->v[q] + 2 * dt * a[q]) / (2 + damping);
            s->d[q] += dt * s->v[q];
            old[q] = a[q];
        }
    }
    free(a);
    free(old);
    if (result < 0 && err->status == SF_OK)
        SF_FAIL(err, SF_ERR_NUMERIC, "dynamic relaxation of %lld nodes has not converged in %d steps",
                (long long)m->node_count, MAX_ITERATIONS);
    return result;
}

static void measure_errors(const fixture *f, const sf_mms_field *field, mms_result *out) {
    const sf_model *m = &f->model;
    double error = 0, size = 0, gradient_error = 0, gradient_size = 0;
    for (int64_t i = 0; i < m->node_count; i++) {
        const double *x = &m->position[3 * i];
        double w[3], gradient[9], u[3] = {0};
        sf_mms_disturbance(field, x, w);
        sf_mms_gradient(field, x, gradient);
        for (int64_t k = m->phi_ptr[i]; k < m->phi_ptr[i + 1]; k++)
            for (int c = 0; c < 3; c++)
                u[c] += m->phi_value[k] * f->state.d[3 * (int64_t)m->phi_node[k] + c];
        for (int c = 0; c < 3; c++) {
            double exact = (field->stretch[c] - 1) * x[c] + w[c];
            error += m->volume[i] * (u[c] - exact) * (u[c] - exact);
            size += m->volume[i] * w[c] * w[c];
        }
        for (int c = 0; c < 9; c++) {
            double change = gradient[c] - (c % 4 == 0 ? field->stretch[c / 4] : 0);
            gradient_error += m->volume[i] * pow(f->state.f[9 * i + c] - gradient[c], 2);
            gradient_size += m->volume[i] * change * change;
        }
    }
    out->displacement = sqrt(error / size);
    out->gradient = sqrt(gradient_error / gradient_size);
}

static int ascending(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* From the upper quartile of the domains' volumes: those on the surface are cut. */
static double typical_spacing(const sf_model *m) {
    double *volume = vector(m->node_count);
    memcpy(volume, m->volume, (size_t)m->node_count * sizeof *volume);
    qsort(volume, (size_t)m->node_count, sizeof *volume, ascending);
    double value = cbrt(volume[m->node_count * 3 / 4]);
    free(volume);
    return value;
}

static sf_status solve(enum cloud cloud, int cells, enum rule rule, mms_result *out, sf_error *err) {
    const sf_mms_field field = sf_mms_field_on(SIDE);
    fixture f;
    build_cloud(cloud, cells, &f);
    double *body = vector(3 * f.model.node_count);
    *out = (mms_result){.h = typical_spacing(&f.model), .nodes = f.model.node_count};
    load(&f, &field, rule, body);
    set_start(&f, &field);
    if ((out->iterations = relax(&f, body, err)) >= 0)
        measure_errors(&f, &field, out);
    free(body);
    fixture_free(&f);
    return err->status;
}

/* Range of the exact stretches: the smallest, and the one nearest to the kink at 1. */
static void check_field(sf_study *study) {
    const sf_mms_field field = sf_mms_field_on(SIDE);
    sf_error err = SF_ERROR_INIT;
    sf_case c;
    sf_foam foam;
    double smallest = INFINITY, largest = 0, nearest = INFINITY;
    fixture_case(&c, NULL);
    fixture_make_elastic(&c);
    if (sf_foam_build(sf_foam_card_of(&c.material), &foam, &err) != SF_OK) {
        sf_study_fail(study, &err);
        sf_case_free(&c);
        return;
    }
    for (int k = 0; k < 21 * 21 * 21; k++) {
        const double x[3] = {SIDE * (k % 21) / 20, SIDE * (k / 21 % 21) / 20, SIDE * (k / 441) / 20.0};
        double p[9], stretch[3];
        sf_mms_stress(&field, &foam, x, p, stretch);
        for (int i = 0; i < 3; i++) {
            smallest = smaller(smallest, stretch[i]);
            largest = larger(largest, stretch[i]);
            nearest = smaller(nearest, fabs(stretch[i] - 1));
        }
    }
    sf_study_text(
        study,
        "The principal stretches are %.2f to %.2f. They keep away from 1, where the law has a kink and b would "
        "jump:\n\n",
        smallest, largest);
    sf_study_check(study, nearest, 0.05, INFINITY, "distance of the stretches from 1");
    sf_foam_free(&foam);
    sf_case_free(&c);
}

enum { LEVELS = 4, FITTED = 3 };

/* Nodes of a kind with a rule for the body force, refined LEVELS times. */
typedef struct family {
    enum cloud cloud;
    enum rule rule;
    double order[2]; /* of u_h and F, found; NaN: a solution failed */
} family;

/* Prints one row with the orders against the row before. */
static void print_row(sf_study *study, const family *f, const mms_result *r, const mms_result *before) {
    sf_study_text(study, "| %s | %s | %.3g | %lld | %.3e |",
                  f->rule == LUMPED ? "lumped body force" : "body force like the stresses",
                  CLOUD_NAME[f->cloud], 1e3 * r->h, (long long)r->nodes, r->displacement);
    if (!before) {
        sf_study_text(study, " | %.3e | | %d |\n", r->gradient, r->iterations);
        return;
    }
    double ratio = log(before->h / r->h);
    sf_study_text(study, " %.2f | %.3e | %.2f | %d |\n", log(before->displacement / r->displacement) / ratio,
                  r->gradient, log(before->gradient / r->gradient) / ratio, r->iterations);
}

/* Solves one family: rows of the table, data of the plot, orders. */
static void study_family(sf_study *study, family *f, FILE *file) {
    static const int cells[CLOUDS][LEVELS] = {{8, 12, 16, 24}, {8, 12, 16, 24}, {8, 11, 15, 20}};
    double h[LEVELS], displacement[LEVELS], gradient[LEVELS];
    mms_result r[LEVELS];
    f->order[0] = f->order[1] = NAN;
    for (int k = 0; k < LEVELS; k++) {
        sf_error err = SF_ERROR_INIT;
        if (solve(f->cloud, cells[f->cloud][k], f->rule, &r[k], &err) != SF_OK) {
            sf_study_fail(study, &err);
            return;
        }
        h[k] = r[k].h;
        displacement[k] = r[k].displacement;
        gradient[k] = r[k].gradient;
        print_row(study, f, &r[k], k ? &r[k - 1] : NULL);
        if (file)
            fprintf(file, "%g %g %g\n", h[k] / SIDE, displacement[k], gradient[k]);
    }
    if (file)
        fprintf(file, "\n\n");
    f->order[0] = sf_order_fit(LEVELS, h, displacement, FITTED);
    f->order[1] = sf_order_fit(LEVELS, h, gradient, FITTED);
}

static void plot(sf_study *study) {
    sf_study_plot(
        study, "orders.png", "Errors of the manufactured solution",
        "set logscale xy\nset format y '10^{%T}'\nset key outside bottom center horizontal maxcols 3\n"
        "set xlabel 'h / side'\nset ylabel 'relative error, L2'\nset xrange [0.035:0.16]\n"
        "f = 'mms-orders.dat'\n"
        "plot f i 0 u 1:2 w lp lw 2 pt 7 lc 1 t 'u_h, regular', f i 1 u 1:2 w lp lw 2 pt 5 lc 2 t 'u_h, "
        "jittered', f i 2 u 1:2 w lp lw 2 pt 9 lc 4 t 'u_h, tetrahedra', f i 0 u 1:3 w lp dt 2 pt 6 lc 1 t "
        "'F, regular', f i 1 u 1:3 w lp dt 2 pt 4 lc 2 t 'F, jittered', f i 2 u 1:3 w lp dt 2 pt 8 lc 4 t "
        "'F, tetrahedra', 2.5*x**2 lc 'black' lw 1 t 'slope 2', 0.5*x lc 'black' dt 3 t 'slope 1'");
}

int main(int argc, char **argv) {
    family families[] = {{.cloud = REGULAR, .rule = GALERKIN},
                         {.cloud = JITTERED, .rule = GALERKIN},
                         {.cloud = TETRAHEDRA, .rule = GALERKIN},
                         {.cloud = JITTERED, .rule = LUMPED},
                         {.cloud = TETRAHEDRA, .rule = LUMPED}};
    enum { FAMILIES = sizeof families / sizeof families[0] };
    sf_study study;
    omp_set_num_threads(1); /* small models: threads would mostly wait for each other */
    sf_study_begin(&study, "mms", "Manufactured finite-strain solution", argc, argv);
    FILE *file = sf_study_file(&study, "orders.dat");
    sf_study_text(
        &study,
        "The exact solution compresses a cube of 50 mm of an EVA-like foam (its curve, without losses) to 65 "
        "%% of its height, stretches it by 15 %% sideways and adds an irregular field w with gradients up to "
        "0.2, which vanishes on the surface. The body force b = − Div P keeps it in equilibrium; P comes "
        "from the program's own law. u_h is held on the surface, and dynamic relaxation finds the "
        "equilibrium (stabilisation 0.1, residual 1e-7 of the body force). The body force is integrated like "
        "the stresses, f_I = Σ_L V_L b(X_L) φ_I(X_L), or lumped, f_I = V_I b(X_I). Errors: of u_h relative "
        "to w, of F relative to the gradient of w.\n\n");
    check_field(&study);
    sf_study_text(&study,
                  "| body force | nodes of | h, mm | nodes | u_h, L2 | order | F, L2 | order | steps |\n"
                  "|---|---|---|---|---|---|---|---|---|\n");
    for (int k = 0; k < FAMILIES; k++)
        study_family(&study, &families[k], file);
    sf_study_text(&study, "\n");
    for (int k = 0; k < FAMILIES; k++) {
        const char *name = CLOUD_NAME[families[k].cloud];
        const char *lumped = families[k].rule == LUMPED ? ", lumped body force" : "";
        sf_study_check(&study, families[k].order[0], 1.8, INFINITY,
                       "%s%s: order of u_h in L2, last three meshes", name, lumped);
        sf_study_check(&study, families[k].order[1], 0.9, INFINITY,
                       "%s%s: order of F in L2, last three meshes", name, lumped);
    }
    if (file)
        fclose(file);
    plot(&study);
    return sf_study_end(&study);
}
