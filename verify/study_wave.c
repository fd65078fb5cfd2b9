/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Longitudinal waves in the linear foam: free vibration of a column and a travelling pulse, run with the
 * program's own steps, against c = sqrt(E / rho); and the dispersion of plane waves on the lattice, from its
 * own forces. The law has no Poisson effect, so that columns are one-dimensional whatever their width. */
#include "extreme.h"
#include "model_fixture.h"
#include "order.h"
#include "study.h"

#include <math.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;
static const double LENGTH = 0.1;     /* m, of the columns */
static const double AMPLITUDE = 1e-7; /* m: strains of 1e-6, far from any nonlinearity */

/* The linear foam in a block, its base held, the missile out of reach; time step `dt`, whatever the program's
 * bound. */
static void start_column(const int cells[3], double dt, fixture *f) {
    const fixture_block block = {.cells = {cells[0], cells[1], cells[2]}, .spacing = LENGTH / cells[2]};
    sf_case c;
    fixture_case(&c, (const char *const[]){"missile.gap=1 m", "solver.end_time=1 s", NULL});
    fixture_make_linear(&c);
    fixture_hold(&c, (const char *const[]){"base", NULL});
    fixture_under_plate(&c, &block, 1, 0, 0, f);
    f->model.run.step_limit = dt;
    f->model.run.step_safety = 1;
    fixture_start(f);
}

static double wave_speed(const sf_model *m) {
    return sqrt(sf_foam_card_of(&m->material[0])->modulus / sf_foam_card_of(&m->material[0])->shared.density);
}

/* Largest time step that the program would take at rest. */
static double stable_step(const int cells[3]) {
    fixture f;
    start_column(cells, 1, &f);
    fixture_step(&f);
    double dt = f.state.dt;
    fixture_free(&f);
    return dt;
}

/* One Gauss-Newton step for q = p0 cos(p2 t) + p1 sin(p2 t); returns the change of p2. */
static double improve_fit(int64_t count, const double *q, double dt, double p[3]) {
    double a[3][4] = {{0}};
    for (int64_t k = 0; k < count; k++) {
        double t = (double)k * dt, c = cos(p[2] * t), s = sin(p[2] * t);
        const double row[4] = {c, s, t * (p[1] * c - p[0] * s), q[k] - p[0] * c - p[1] * s};
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 4; j++)
                a[i][j] += row[i] * row[j];
    }
    for (int i = 0; i < 3; i++)
        for (int r = 0; r < 3; r++) {
            double factor = r == i ? 0 : a[r][i] / a[i][i];
            for (int j = i; j < 4; j++)
                a[r][j] -= factor * a[i][j];
        }
    for (int i = 0; i < 3; i++)
        p[i] += a[i][3] / a[i][i];
    return a[2][3] / a[2][2];
}

/* Frequency (rad/s) of the lowest mode over two periods, from its modal coordinate. */
static double column_frequency(const int cells[3], double dt) {
    fixture f;
    start_column(cells, dt, &f);
    const sf_model *m = &f.model;
    sf_state *s = &f.state;
    double exact = 0.5 * PI / LENGTH * wave_speed(m), end = 2 * 2 * PI / exact;
    int64_t count = (int64_t)(end / dt);
    double *q = calloc((size_t)count, sizeof *q), p[3] = {AMPLITUDE, 0, exact}, scale = 0;
    if (!q)
        abort();
    for (int64_t i = 0; i < m->node_count; i++) {
        double shape = sin(0.5 * PI * m->position[3 * i + 2] / LENGTH);
        s->d[3 * i + 2] = AMPLITUDE * shape;
        scale += m->mass[i] * shape * shape;
    }
    for (int64_t k = 0; k < count; k++) {
        for (int64_t i = 0; i < m->node_count; i++)
            q[k] += m->mass[i] * sin(0.5 * PI * m->position[3 * i + 2] / LENGTH) * s->d[3 * i + 2] / scale;
        fixture_advance(&f);
    }
    for (int k = 0; k < 20 && fabs(improve_fit(count, q, dt, p)) > 1e-14 * exact; k++)
        continue;
    free(q);
    fixture_free(&f);
    return p[2];
}

static double exact_frequency(void) {
    const int cells[3] = {2, 2, 4};
    fixture f;
    start_column(cells, 1, &f);
    double value = 0.5 * PI / LENGTH * wave_speed(&f.model);
    fixture_free(&f);
    return value;
}

static void vibration_in_h(sf_study *study) {
    enum { LEVELS = 3 };
    const double exact = exact_frequency(),
                 dt = 0.5 * PI / exact / 160; /* a fifth of h / c on the finest mesh */
    double h[LEVELS], error[LEVELS];
    FILE *file = sf_study_file(study, "vibration.dat");
    sf_study_text(
        study,
        "### Free vibration: error against the spacing\n\nLowest longitudinal mode of a column of 100 × 25 × 25 mm "
        "with one end held, two periods, time step L/(160 c). Exact: ω = (π/2L) √(E/ρ) = %.3f rad/s.\n\n"
        "| cells along L | h, mm | ω, rad/s | error |\n|---|---|---|---|\n",
        exact);
    for (int k = 0; k < LEVELS; k++) {
        int n = 8 << k;
        double omega = column_frequency((const int[3]){n / 4, n / 4, n}, dt);
        h[k] = LENGTH / n;
        error[k] = fabs(omega / exact - 1);
        sf_study_text(study, "| %d | %.4g | %.4f | %+.3e |\n", n, 1e3 * h[k], omega, omega / exact - 1);
        if (file)
            fprintf(file, "%g %g\n", h[k] / LENGTH, error[k]);
    }
    sf_study_text(study, "\n");
    sf_study_check(study, sf_order_fit(LEVELS, h, error, LEVELS), 1.8, INFINITY,
                   "order of the frequency's error in h");
    if (file)
        fclose(file);
}

static void vibration_in_dt(sf_study *study) {
    enum { LEVELS = 4 };
    static const int cells[3] = {2, 2, 8};
    double limit = stable_step(cells), reference = column_frequency(cells, limit / 64), dt[LEVELS],
           error[LEVELS];
    FILE *file = sf_study_file(study, "step.dat");
    sf_study_text(
        study,
        "### Free vibration: error against the time step\n\nThe column of 8 cells against a step of 1/64 of the "
        "stability limit (%.3g µs). Central differences raise the frequency by (ω Δt)²/24.\n\n| Δt / limit | error | "
        "(ω Δt)²/24 |\n|---|---|---|\n",
        1e6 * limit);
    for (int k = 0; k < LEVELS; k++) {
        dt[k] = 0.9 * limit / (1 << k);
        error[k] = column_frequency(cells, dt[k]) / reference - 1;
        sf_study_text(study, "| %.4g | %+.3e | %+.3e |\n", dt[k] / limit, error[k],
                      pow(reference * dt[k], 2) / 24);
        if (file)
            fprintf(file, "%g %g\n", dt[k] / limit, error[k]);
    }
    sf_study_text(study, "\n");
    sf_study_check(study, sf_order_fit(LEVELS, dt, error, LEVELS), 1.8, INFINITY,
                   "order of the frequency's error in Δt");
    sf_study_check(study, 24 * error[0] / pow(reference * dt[0], 2), 0.95, 1.05,
                   "error / ((ω Δt)²/24), largest step");
    if (file)
        fclose(file);
}

/* A smooth pulse, 1 at x = 0 and 0 for |x| >= 1; its slope. */
static double pulse(double x, double *slope) {
    double c = fabs(x) < 1 ? cos(0.5 * PI * x) : 0, s = sin(0.5 * PI * x);
    *slope = -2 * PI * c * c * c * s;
    return c * c * c * c;
}

/* Relative L2 error of u_h after the pulse has run 0.4 L down a column of n cells. */
static double pulse_error(int n) {
    const double width = 0.25 * LENGTH, start = 0.7 * LENGTH, travel = 0.4 * LENGTH;
    fixture f;
    double h = LENGTH / n, slope, difference = 0, size = 0;
    start_column((const int[3]){2, 2, n}, 1, &f);
    const sf_model *m = &f.model;
    sf_state *s = &f.state;
    double c = wave_speed(m);
    int64_t steps = llround(travel / (0.5 * h));
    f.model.run.step_limit = travel / c / (double)steps;
    for (int64_t i = 0; i < m->node_count; i++) {
        s->d[3 * i + 2] = AMPLITUDE * pulse((m->position[3 * i + 2] - start) / width, &slope);
        s->v[3 * i + 2] = AMPLITUDE * slope / width * c;
    }
    for (int64_t k = 0; k < steps; k++) {
        fixture_advance(&f);
    }
    for (int64_t i = 0; i < m->node_count; i++) {
        double u = 0, exact = AMPLITUDE * pulse((m->position[3 * i + 2] - start + travel) / width, &slope);
        for (int64_t k = m->phi_ptr[i]; k < m->phi_ptr[i + 1]; k++)
            u += m->phi_value[k] * s->d[3 * (int64_t)m->phi_node[k] + 2];
        difference += m->volume[i] * (u - exact) * (u - exact);
        size += m->volume[i] * exact * exact;
    }
    fixture_free(&f);
    return sqrt(difference / size);
}

static void travelling_pulse(sf_study *study) {
    enum { LEVELS = 4 };
    double h[LEVELS], error[LEVELS];
    FILE *file = sf_study_file(study, "pulse.dat");
    sf_study_text(study,
                  "### Travelling pulse\n\nA cos⁴ pulse of width L/2 travels 0.4 L through a column, time "
                  "step 0.5 h/c; relative error of u_h in L2.\n\n| cells along L | error |\n|---|---|\n");
    for (int k = 0; k < LEVELS; k++) {
        int n = 20 << k;
        h[k] = LENGTH / n;
        error[k] = pulse_error(n);
        sf_study_text(study, "| %d | %.3e |\n", n, error[k]);
        if (file)
            fprintf(file, "%g %g\n", h[k] / LENGTH, error[k]);
    }
    sf_study_text(study, "\n");
    sf_study_check(study, sf_order_fit(LEVELS, h, error, 3), 1.8, INFINITY,
                   "order of the pulse's error in h and Δt together, last three meshes");
    if (file)
        fclose(file);
    sf_study_plot(
        study, "orders.png", "Orders of free vibration and travelling pulse",
        "set logscale xy\nset yrange [1e-5:1]\nset format y '10^{%T}'\nset key outside bottom center "
        "horizontal\nset xlabel 'h/L, or time step / "
        "limit'\n"
        "set ylabel 'relative error'\nset xrange [0.004:1.2]\n"
        "plot 'wave-vibration.dat' w lp lw 2 pt 7 t 'frequency, against h', "
        "'wave-step.dat' w lp lw 2 pt 5 t 'frequency, against the time step', "
        "'wave-pulse.dat' w lp lw 2 pt 9 t 'pulse, against h', x**2 lw 1 dt 2 lc 'black' t 'slope 2'");
}

/* omega h / c of a longitudinal plane wave with `phase` = k_i h in each direction of `axes` (1: x only, 3:
 * all), from the force on the centre of a block of the infinite lattice's rows. */
static double lattice_frequency(fixture *f, int axes, double phase) {
    const sf_model *m = &f->model;
    sf_state *s = &f->state;
    double h = m->spacing[0], centre = 6 * h, projected = 0;
    int64_t node = -1;
    for (int64_t i = 0; i < m->node_count; i++) {
        double argument = 0, far = 0;
        for (int c = 0; c < 3; c++) {
            double x = m->position[3 * i + c] - centre;
            argument += c < axes ? phase * x / h : 0;
            far = larger(far, fabs(x));
        }
        for (int c = 0; c < 3; c++)
            s->d[3 * i + c] = c < axes ? AMPLITUDE * cos(argument) / sqrt(axes) : 0;
        if (far < 0.1 * h)
            node = i;
    }
    fixture_forces(f);
    for (int c = 0; c < axes; c++)
        projected -= s->force[3 * node + c] / sqrt(axes);
    return sqrt(fmax(0, projected / (m->mass[node] * AMPLITUDE))) * h / wave_speed(m);
}

/* The same of lumped trilinear hexahedra, fully integrated, without Poisson effect. */
static double hexahedron_frequency(int axes, double phase) {
    double stiff = 2 * (1 - cos(phase)), mass = (2 + cos(phase)) / 3, cross = sin(phase) * sin(phase);
    return axes == 1 ? 2 * sin(0.5 * phase) : sqrt(2 * stiff * mass * mass + cross * mass);
}

static void start_lattice(double stabilisation, fixture *f) {
    const fixture_block block = {.cells = {12, 12, 12}, .spacing = 0.005};
    sf_case c;
    fixture_case(&c, NULL);
    fixture_make_linear(&c);
    fixture_hold(&c, (const char *const[]){"base", NULL});
    fixture_under_plate(&c, &block, 1, 0, 0, f);
    f->model.run.stabilisation = stabilisation;
    fixture_start(f);
}

static void dispersion_table(sf_study *study, fixture *lattice, fixture *plain) {
    sf_study_text(study,
                  "| k h / π | axis: softfall | no stabilisation | hexahedra | diagonal: softfall | no "
                  "stabilisation | hexahedra |\n|---|---|---|---|---|---|---|\n");
    for (int k = 1; k <= 8; k += k < 2 ? 1 : 2) {
        sf_study_text(study, "| %.3g", k / 8.0);
        for (int axes = 1; axes <= 3; axes += 2) {
            double phase = PI * k / 8, exact = sqrt(axes) * phase;
            sf_study_text(study, " | %.4f | %.4f | %.4f", lattice_frequency(lattice, axes, phase) / exact,
                          lattice_frequency(plain, axes, phase) / exact,
                          hexahedron_frequency(axes, phase) / exact);
        }
        sf_study_text(study, " |\n");
    }
    sf_study_text(study, "\n");
}

static void dispersion_plot(sf_study *study, fixture *lattice, fixture *plain) {
    FILE *file = sf_study_file(study, "dispersion.dat");
    if (!file)
        return;
    for (int k = 0; k <= 64; k++) {
        double phase = PI * k / 64;
        fprintf(file, "%g", k / 64.0);
        for (int axes = 1; axes <= 3; axes += 2)
            fprintf(file, " %g %g %g %g", sqrt(axes) * phase, lattice_frequency(lattice, axes, phase),
                    lattice_frequency(plain, axes, phase), hexahedron_frequency(axes, phase));
        fprintf(file, "\n");
    }
    fclose(file);
    sf_study_plot(
        study, "dispersion.png", "Dispersion of longitudinal plane waves",
        "set multiplot layout 1,2\nset xlabel 'k_i h / {/Symbol p}'\nset ylabel '{/Symbol w} h / c'\n"
        "set key top left Left reverse\nset yrange [0:5.5]\nset title 'along an axis'\n"
        "plot 'wave-dispersion.dat' u 1:2 w l dt 2 lc 'black' t 'exact', '' u 1:3 w l lw 3 t 'softfall', "
        "'' u 1:4 w l lw 2 t 'no stabilisation', '' u 1:5 w l lw 2 t 'hexahedra, lumped'\n"
        "set title 'along the diagonal of space'\n"
        "plot 'wave-dispersion.dat' u 1:6 w l dt 2 lc 'black' t 'exact', '' u 1:7 w l lw 3 t 'softfall', "
        "'' u 1:8 w l lw 2 t 'no stabilisation', '' u 1:9 w l lw 2 t 'hexahedra, lumped'\nunset multiplot");
}

static void dispersion(sf_study *study) {
    const double coefficient = 0.1;
    fixture lattice, plain;
    start_lattice(coefficient, &lattice);
    start_lattice(0, &plain);
    sf_study_text(
        study,
        "### Dispersion\n\nRatio of the phase speed of longitudinal plane waves d = a cos(k·X) to the exact one on "
        "the infinite lattice, from the program's own force on a node, with stabilisation 0.1 and without, along an "
        "axis and the diagonal of space (k h / π in each direction); beside trilinear hexahedra with lumped mass (ω "
        "h/c = 2 sin(kh/2) along an axis).\n\n");
    dispersion_table(study, &lattice, &plain);
    for (int axes = 1; axes <= 3; axes += 2) {
        double phase[2] = {PI / 8, PI / 16}, error[2];
        for (int k = 0; k < 2; k++)
            error[k] = fabs(lattice_frequency(&lattice, axes, phase[k]) / (sqrt(axes) * phase[k]) - 1);
        sf_study_check(study, sf_order_fit(2, phase, error, 2), 1.8, INFINITY,
                       "order of the phase speed in kh, %s", axes == 1 ? "axis" : "diagonal");
    }
    /* F vanishes for the sawtooth, so that only the two pairs along the axis act: omega^2 = 4/3 alpha E /
     * (rho h^2). */
    sf_study_check(study, lattice_frequency(&lattice, 1, PI) / sqrt(4 * coefficient / 3), 0.999, 1.001,
                   "sawtooth along an axis: ω h/c over √(4 α/3)");
    sf_study_check(study, lattice_frequency(&plain, 1, PI), 0, 1e-4,
                   "the same without stabilisation: ω h/c (a zero-energy mode)");
    dispersion_plot(study, &lattice, &plain);
    fixture_free(&lattice);
    fixture_free(&plain);
}

int main(int argc, char **argv) {
    sf_study study;
    omp_set_num_threads(1); /* small models: threads would mostly wait for each other */
    sf_study_begin(&study, "wave", "Waves", argc, argv);
    vibration_in_h(&study);
    vibration_in_dt(&study);
    travelling_pulse(&study);
    dispersion(&study);
    return sf_study_end(&study);
}
