/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A pad that rests on the anvil: at rest, thrown, sliding, sticking, rocking, and under the drops of a glued
 * one. */
#include "extreme.h"
#include "base/units.h"
#include "drop.h"
#include "model_fixture.h"
#include "solver/step.h"
#include "study.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static const double G = SF_STANDARD_GRAVITY;

/* A block of 50 x 40 x 30 mm on the anvil; a dome of 20 mm radius over (0.025 + across, 0.02) m. */
static void start(fixture *f, double friction, double gap, double speed, double across) {
    const fixture_block block = {.cells = {5, 4, 3}, .spacing = 0.01, .jitter = 0.1, .surface_jitter = 0.05};
    sf_case c;
    sf_mesh mesh;
    sf_surface surface;
    fixture_case(&c, NULL);
    fixture_hold(&c, (const char *const[]){"base", NULL});
    c.base_rule = SF_BASE_RESTING;
    c.anvil_card.friction = friction;
    c.missile_card.mass = 0.5;
    c.missile_card.gap = gap;
    c.missile_card.speed = speed;
    fixture_block_mesh(&block, &mesh);
    fixture_dome(0.02, 8, 0.025 + across, 0.02, &surface);
    fixture_build(&c, &mesh, &surface, f);
    fixture_start(f);
}

static double pad_mass(const sf_model *m) {
    double mass = 0;
    for (int64_t i = 0; i < m->node_count; i++)
        mass += m->mass[i];
    return mass;
}

static void throw_pad(fixture *f, double x, double z) {
    for (int64_t i = 0; i < f->model.node_count; i++) {
        f->state.v[3 * i] = x;
        f->state.v[3 * i + 2] = z;
    }
}

static double centre(const fixture *f, int axis) {
    double sum = 0;
    for (int64_t i = 0; i < f->model.node_count; i++)
        sum += f->model.mass[i] * f->state.d[3 * i + axis];
    return sum / pad_mass(&f->model);
}

static void advance_to(fixture *f, double time) {
    while (f->state.time < time) {
        fixture_step(f);
        sf_step_advance(&f->model, &f->state);
    }
}

static void study_rest(sf_study *study) {
    fixture f;
    double moved = 0, force = 0;
    start(&f, 0.5, 1, 4.5, 0);
    double settlement = 0.5 * G * pad_mass(&f.model) / (0.05 * 0.04) * 0.03 /
                        sf_foam_card_of((sf_material *)sf_model_material(&f.model, 0))->modulus;
    while (f.state.time < 0.02) {
        fixture_step(&f);
        force = larger(force, fabs(f.state.base_reaction[2] / (G * pad_mass(&f.model)) - 1));
        sf_step_advance(&f.model, &f.state);
    }
    for (int64_t k = 0; k < 3 * f.model.node_count; k++)
        moved = larger(moved, fabs(f.state.d[k]));
    sf_study_text(
        study, "At rest for 20 ms the settlement under its weight, %.3g nm at its top, is the measure.\n\n",
        1e9 * settlement);
    sf_study_check(study, moved / settlement, 0, 1e-6, "largest displacement over the settlement");
    sf_study_check(study, force, 0, 1e-6, "anvil's force over the weight, largest error");
    fixture_free(&f);
}

static void study_flight(sf_study *study) {
    const double speed = 0.05, flight = 2 * speed / G;
    fixture f;
    start(&f, 0.5, 1, 4.5, 0);
    throw_pad(&f, 0, speed);
    advance_to(&f, 0.5 * flight);
    double t = f.state.time;
    sf_study_check(study, centre(&f, 2) / (speed * t - 0.5 * G * t * t), 0.998, 1.002,
                   "thrown up with 0.05 m/s: height at half of the flight over the closed form");
    advance_to(&f, 8 * flight);
    sf_study_check(study, 1e3 * centre(&f, 2), -0.01, 0.01, "height after eight flights (mm)");
    fixture_free(&f);
}

static void study_sliding(sf_study *study) {
    const double speed = 0.1, frictions[] = {0.2, 0.4};
    for (int k = 0; k < 2; k++) {
        const double time = speed / (frictions[k] * G);
        fixture f;
        start(&f, frictions[k], 1, 4.5, 0);
        throw_pad(&f, speed, 0);
        advance_to(&f, 1.3 * time);
        sf_study_check(study, centre(&f, 0) / (0.5 * speed * time), 0.998, 1.002,
                       "sliding with 0.1 m/s, friction %.1f: way over v0^2 / (2 mu g)", frictions[k]);
        sf_study_check(study, f.state.ledger.friction / (0.5 * pad_mass(&f.model) * speed * speed), 0.998,
                       1.002, "energy lost in friction over the kinetic energy");
        double before = centre(&f, 0);
        advance_to(&f, 2.3 * time);
        sf_study_check(study, 1e6 * fabs(centre(&f, 0) - before), 0, 1, "and then it sticks: creep (um)");
        fixture_free(&f);
    }
}

static void study_rocking(sf_study *study) {
    fixture f;
    int64_t fewest = 1000;
    double lift = 0, momentum = 0, vector = 0, angular = 0;
    FILE *data = sf_study_file(study, "rocking.txt");
    start(&f, 0.3, 0, 0.5, 0.018);
    while (f.state.time < 0.15) {
        fixture_step(&f);
        momentum = larger(momentum, fabs(f.state.ledger.momentum_error));
        vector = larger(vector, f.state.ledger.vector_error);
        angular = larger(angular, f.state.ledger.angular_error);
        fewest = f.state.anvil_count < fewest ? f.state.anvil_count : fewest;
        double high = 0;
        for (int64_t c = f.model.contact_count; c < sf_model_points(&f.model); c++)
            high = larger(high, f.state.contact_position[3 * c + 2]);
        lift = larger(lift, high);
        if (data)
            fprintf(data, "%.6g %.6g %.6g %lld\n", 1e3 * f.state.time, 1e3 * high, f.state.anvil_force[2],
                    (long long)f.state.anvil_count);
        sf_step_advance(&f.model, &f.state);
    }
    if (data)
        fclose(data);
    sf_study_text(
        study,
        "\nA drop 18 mm off the middle tips the block: %lld of its %lld base nodes stay on the anvil, and "
        "it lifts off by %.2f mm.\n\n",
        (long long)fewest, (long long)f.model.rest_count, 1e3 * lift);
    sf_study_plot(study, "rocking.png",
                  "Rocking block: height of its highest base node, nodes on the anvil, anvil's force",
                  "set xlabel 'time (ms)'\nset multiplot layout 3,1\nset ylabel 'height (mm)'\n"
                  "plot 'base-rocking.txt' using 1:2 with lines lw 2 notitle\nset ylabel 'nodes'\n"
                  "plot '' using 1:4 with lines lw 2 notitle\nset ylabel 'force (N)'\n"
                  "plot '' using 1:3 with lines lw 2 notitle\nunset multiplot");
    sf_study_check(study, momentum, 0, 1e-6,
                   "momentum of missile and pad with the anvil's impulse, vertical");
    sf_study_check(study, vector, 0, 1e-6, "in space");
    sf_study_check(study, angular, 0, 1e-6, "angular momentum");
    sf_study_check(study, f.state.ledger.largest_error, 0, 0.01, "energy error");
    fixture_free(&f);
}

typedef struct base {
    const char *what, *rule, *friction;
} base;

static void study_drops(sf_study *study) {
    static const base bases[] = {{"glued", "pad.base=glued", NULL},
                                 {"resting, friction 0.5", "pad.base=resting", "pad.friction=0.5"},
                                 {"resting, friction 0.2", "pad.base=resting", "pad.friction=0.2"},
                                 {"resting, no friction", "pad.base=resting", "pad.friction=0.0"},
                                 {"smooth", "pad.base=smooth", NULL}};
    enum { BASES = sizeof bases / sizeof bases[0] };
    sf_drop drop[BASES];
    sf_study_text(
        study,
        "\nThe drop of 4.5 m/s on 50 mm of the foam of verify/materials/eva_like.cfg with a spacing of 7 mm:\n\n"
        "| base | a_max (g) | HIC | rebound (m/s) | contact energy (%%) | time (s) |\n|---|---|---|---|---|---|\n");
    for (int k = 0; k < BASES; k++) {
        const char *const overrides[] = {"geometry.parameters.fine_spacing=7.0",
                                         "geometry.parameters.outer_spacing=14.0", bases[k].rule,
                                         bases[k].friction, NULL};
        sf_error err = SF_ERROR_INIT;
        if (sf_drop_run("eva50-v4.5", overrides, 1, NULL, &drop[k], &err) != SF_OK) {
            sf_study_fail(study, &err);
            return;
        }
        sf_study_text(study, "| %s | %.2f | %.1f | %.3f | %.3f | %.1f |\n", bases[k].what, drop[k].a_max_g,
                      drop[k].hic, drop[k].v_rebound_m_s, 100 * drop[k].contact_energy_fraction,
                      drop[k].wall_s);
    }
    sf_study_text(study, "\n");
    sf_study_check(study, drop[1].a_max_g / drop[0].a_max_g, 0.99, 1.01,
                   "a_max, resting with friction 0.5 over glued");
    sf_study_check(study, drop[1].hic / drop[0].hic, 0.99, 1.01, "HIC, resting with friction 0.5 over glued");
    sf_study_check(study, drop[3].a_max_g / drop[4].a_max_g, 0.99, 1.01,
                   "a_max, resting without friction over smooth");
    sf_study_check(study, drop[3].hic / drop[4].hic, 0.99, 1.01, "HIC, resting without friction over smooth");
}

int main(int argc, char **argv) {
    sf_study study;
    sf_study_begin(&study, "base", "A pad that rests on the anvil", argc, argv);
    study_rest(&study);
    study_flight(&study);
    study_sliding(&study);
    study_rocking(&study);
    study_drops(&study);
    return sf_study_end(&study);
}
