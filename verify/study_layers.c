/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pads of layers: a slow series compression and waves across an impedance step against closed forms, and a
 * stack of equal layers against one layer through the programs. tests/test_layers.c has the patch test. */
#include "drop.h"
#include "extreme.h"
#include "layer_fixture.h"
#include "study.h"

#include "solver/step.h"
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double H = 0.01; /* m, spacing of the pair */
enum { PAIR = 6, COLUMN = 200 };

/* ---- series compression ---- */

static int upper_half_of_pair(const double x[3]) {
    return x[2] > PAIR / 2;
}

/* Displacement of the platen, m: smooth from rest to rest. */
static void make_motion(sf_case *c, double depth, double time) {
    enum { POINTS = 2001 };
    const double pi = acos(-1);
    c->motion_count = POINTS;
    c->motion_time = malloc(POINTS * sizeof *c->motion_time);
    c->motion_displacement = malloc(POINTS * sizeof *c->motion_displacement);
    for (int k = 0; k < POINTS; k++) {
        double x = (double)k / (POINTS - 1);
        c->motion_time[k] = x * time;
        c->motion_displacement[k] = depth * 0.5 * (1 - cos(pi * x));
    }
    c->missile_card.mass = c->missile_card.speed = c->missile_card.gravity = 0;
    c->run.end_time = time;
}

/* Strains of both halves at the same stress, whose mean is `mean`. */
static void solve_pair(const sf_model *m, double mean, double strain[2]) {
    double low = 0, high = smaller(2 * mean, 0.95);
    for (int k = 0; k < 80; k++) {
        strain[0] = 0.5 * (low + high);
        strain[1] = 2 * mean - strain[0];
        *(layers_stress(&m->material[0], strain[0]) < layers_stress(&m->material[1], strain[1]) ? &low
                                                                                                : &high) =
            strain[0];
    }
}

static void start_pair(double depth, double time, fixture *f) {
    const fixture_block block = {.cells = {2, 2, PAIR}, .spacing = H};
    sf_case c;
    layers_case(&c, NULL, (const char *const[]){"base", NULL}, 2);
    layers_make_elastic(&c.layer[0], 1);
    layers_make_elastic(&c.layer[1], 3);
    fixture_mirror(&c, 2); /* or it would buckle */
    make_motion(&c, depth, time);
    layers_under_plate(&c, &block, upper_half_of_pair, f);
    fixture_start(f);
}

static void series_compression(sf_study *study) {
    const double depth = 0.6 * PAIR * H, time = 0.4, area = 4 * H * H;
    fixture f;
    sf_study_text(
        study,
        "### Series compression\n\nTwo foams on each other, the upper one three times as stiff, each 30 "
        "mm thick, pressed slowly (60 %% in 0.4 s) without losses. Closed form: the same stress in both, "
        "strains that add up.\n\n| mean strain | force / closed form − 1 | strain below | exact | strain "
        "above | exact |\n|---|---|---|---|---|---|\n");
    start_pair(depth, time, &f);
    const sf_model *m = &f.model;
    sf_state *s = &f.state;
    double worst_force = 0, worst_strain = 0, next = 0.1;
    while (s->time < time * 0.97) {
        fixture_step(&f);
        double mean = sf_missile_depth(m, &s->missile) / (PAIR * H);
        if (mean >= next) {
            double exact[2], strain[2] = {0, 0}, count[2] = {0, 0}, away = 0;
            solve_pair(m, mean, exact);
            for (int64_t i = 0; i < m->node_count; i++) {
                int k = m->node_material[i];
                strain[k] += 1 - s->f[9 * i + 8];
                count[k]++;
                away = larger(away, fabs(1 - s->f[9 * i + 8] - exact[k]));
            }
            double force =
                sf_missile_contact_force(m, &s->missile) / (area * layers_stress(&m->material[0], exact[0])) -
                1;
            sf_study_text(study, "| %.3f | %+.1e | %.4f | %.4f | %.4f | %.4f |\n", mean, force,
                          strain[0] / count[0], exact[0], strain[1] / count[1], exact[1]);
            worst_force = larger(worst_force, fabs(force));
            worst_strain = larger(worst_strain, away);
            next += 0.1;
        }
        sf_step_advance(m, s);
    }
    sf_study_text(study, "\n");
    sf_study_check(study, worst_force, 0, 1e-3, "largest error of the force");
    sf_study_check(
        study, worst_strain, 0, 2e-3,
        "largest error of the strain of any node, those of the interface included: the jump is inside "
        "one nodal spacing");
    sf_study_check(study, s->ledger.largest_error, 0, 2e-3, "largest energy error");
    fixture_free(&f);
}

/* ---- waves ---- */

static int upper_half_of_column(const double x[3]) {
    return x[2] > COLUMN / 2;
}

static double height_of(const fixture *f, int64_t i) {
    double u = 0;
    for (int64_t k = f->model.phi_ptr[i]; k < f->model.phi_ptr[i + 1]; k++)
        u += f->model.phi_value[k] * f->state.d[3 * (int64_t)f->model.phi_node[k] + 2];
    return u;
}

/* A cos^4 pulse of 40 mm runs up a column of 200 mm with spacing 1 mm; the largest u_h in both halves after
 * it has met the step, over its own. */
static void run_pulse(const double modulus[2], const double density[2], double amplitude[2]) {
    const fixture_block block = {.cells = {2, 2, COLUMN}, .spacing = 0.001};
    const double width = 0.02, start = 0.06, top = 1e-7, travel = 0.08, pi = acos(-1),
                 speed = sqrt(modulus[0] / density[0]);
    fixture f;
    sf_case c;
    layers_case(&c, (const char *const[]){"missile.gap=1 m", "solver.end_time=1 s", NULL},
                (const char *const[]){"base", NULL}, 2);
    for (int k = 0; k < 2; k++)
        layers_make_linear(&c.layer[k], modulus[k], density[k]);
    layers_under_plate(&c, &block, upper_half_of_column, &f);
    f.model.run.step_limit = 0.5 * block.spacing / speed;
    fixture_start(&f);
    for (int64_t i = 0; i < f.model.node_count; i++) {
        double x = (f.model.position[3 * i + 2] - start) / width, w = fabs(x) < 1 ? cos(0.5 * pi * x) : 0;
        f.state.d[3 * i + 2] = top * w * w * w * w;
        f.state.v[3 * i + 2] = top * 2 * pi * w * w * w * sin(0.5 * pi * x) / width * speed;
    }
    while (f.state.time < travel / speed) {
        fixture_advance(&f);
    }
    amplitude[0] = amplitude[1] = 0;
    for (int64_t i = 0; i < f.model.node_count; i++) {
        double u = height_of(&f, i) / top, *most = &amplitude[f.model.node_material[i]];
        *most = fabs(u) > fabs(*most) ? u : *most;
    }
    fixture_free(&f);
}

static void waves(sf_study *study) {
    static const double MODULUS[][2] = {{1e6, 2e6}, {4e6, 1e6}, {1e6, 1e7}, {1e6, 1e6}},
                        DENSITY[][2] = {{50, 200}, {150, 50}, {50, 400}, {50, 50}};
    double worst = 0, relative = 0;
    sf_study_text(
        study,
        "### Waves across an impedance step\n\nA pulse of 40 spacings in a column of two linear "
        "foams with the impedances Z = √(E ρ). Closed forms: (Z₁ − Z₂)/(Z₁ + Z₂) is reflected, "
        "2 Z₁/(Z₁ + Z₂) goes on.\n\n| Z₂/Z₁ | reflected | exact | transmitted | exact |\n|---|---|---|---|---|\n");
    for (int k = 0; k < 4; k++) {
        double amplitude[2], z[2];
        for (int l = 0; l < 2; l++)
            z[l] = sqrt(MODULUS[k][l] * DENSITY[k][l]);
        double exact[2] = {(z[0] - z[1]) / (z[0] + z[1]), 2 * z[0] / (z[0] + z[1])};
        run_pulse(MODULUS[k], DENSITY[k], amplitude);
        sf_study_text(study, "| %.4g | %.4f | %.4f | %.4f | %.4f |\n", z[1] / z[0], amplitude[0], exact[0],
                      amplitude[1], exact[1]);
        worst = larger(worst, fabs(amplitude[0] - exact[0]));
        relative = larger(relative, fabs(amplitude[1] / exact[1] - 1));
    }
    sf_study_text(study, "\n");
    sf_study_check(study, worst, 0, 0.005, "largest error of the reflected amplitude, over the arriving one");
    sf_study_check(study, relative, 0, 0.01, "largest relative error of the transmitted amplitude");
}

/* ---- drops ---- */

static void equal_layers(sf_study *study) {
    const char *source = getenv("SF_SOURCE_DIR");
    char one_case[1024], stack_case[1024], file[1100], material[4][1100];
    static const char *const parameters =
        "geometry.parameters={side=200.0; zone_side=140.0; lower=%s; upper=%s; cover=%s; fine_spacing=5.0; "
        "outer_spacing=10.0; quarter=1;}";
    char one_pad[400], stack_pad[400];
    sf_drop one, stack;
    sf_error err = SF_ERROR_INIT;
    snprintf(one_case, sizeof one_case, "%s/examples/eva50-v4.5/case.cfg", source);
    snprintf(stack_case, sizeof stack_case, "%s/examples/layers/case.cfg", source);
    snprintf(file, sizeof file, "geometry.file=%s/geo/layers.geo", source);
    snprintf(one_pad, sizeof one_pad, parameters, "50.0", "0.0", "0.0");
    snprintf(stack_pad, sizeof stack_pad, parameters, "20.0", "25.0", "5.0");
    for (int k = 0; k < 4; k++) {
        static const char *const groups[] = {"material", "materials.lower", "materials.upper",
                                             "materials.cover"};
        snprintf(material[k], sizeof material[k], "%s=@%s/verify/materials/eva_like.cfg", groups[k], source);
    }
    const char *one_words[] = {file, one_pad, material[0], "pad.group=lower", NULL},
               *stack_words[] = {stack_pad, material[1], material[2], material[3], NULL};
    if (sf_drop_run(one_case, one_words, 1, NULL, &one, &err) != SF_OK ||
        sf_drop_run(stack_case, stack_words, 1, NULL, &stack, &err) != SF_OK) {
        sf_study_fail(study, &err);
        return;
    }
    sf_study_text(
        study,
        "### Equal layers\n\nThe hemisphere at 4.5 m/s on 50 mm of one foam with nodes 5 mm apart, in one "
        "layer and in three (20, 25 and 5 mm, the cover one cell thick).\n\n| | nodes | steps | a_max, g | "
        "HIC | energy error | momentum error |\n|---|---|---|---|---|---|---|\n");
    const sf_drop *rows[] = {&one, &stack};
    for (int k = 0; k < 2; k++)
        sf_study_text(study, "| %s | %.0f | %.0f | %.3f | %.2f | %.1e | %.1e |\n",
                      k ? "three layers" : "one layer", rows[k]->nodes, rows[k]->steps, rows[k]->a_max_g,
                      rows[k]->hic, rows[k]->energy_error, rows[k]->momentum_error);
    sf_study_text(study, "\n");
    sf_study_check(study, fabs(stack.a_max_g / one.a_max_g - 1), 0, 0.003, "difference of a_max");
    sf_study_check(study, fabs(stack.hic / one.hic - 1), 0, 0.003, "difference of HIC");
    sf_study_check(study, stack.energy_error, 0, 2e-4, "energy error of the stack");
    sf_study_check(study, fabs(stack.momentum_error), 0, 1e-12, "momentum error of the stack");
}

int main(int argc, char **argv) {
    sf_study study;
    omp_set_num_threads(1); /* small models */
    sf_study_begin(&study, "layers", "Layers", argc, argv);
    sf_study_text(&study, "The patch test across flat and stepped interfaces, junctions of three layers and "
                          "inclusions is `tests/test_layers.c` (1e-10).\n\n");
    series_compression(&study);
    waves(&study);
    equal_layers(&study);
    return sf_study_end(&study);
}
