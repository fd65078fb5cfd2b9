/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The missile with six degrees of freedom: tumbling, precession, momentum of an oblique drop, sliding and
 * rolling, and the guided drop as a special case. */
#include "body_fixture.h"
#include "extreme.h"
#include "model_fixture.h"
#include "study.h"

#include "base/mat3.h"
#include "solver/rigid.h"
#include "solver/run/run.h"
#include "solver/step.h"

#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

/* ---- the body alone ---- */

typedef struct rotor {
    double inertia[6], spin[3], q[4];
} rotor;

static rotor make_rotor(const double inertia[6], const double omega[3]) {
    rotor r = {.q = {1, 0, 0, 0}};
    memcpy(r.inertia, inertia, sizeof r.inertia);
    sf_rigid_momentum(inertia, omega, r.spin);
    return r;
}

static void drift(rotor *r, double dt) {
    double turn[3], next[4];
    sf_rigid_turn(r->inertia, r->q, r->spin, dt, turn);
    sf_rotation_advance(r->q, turn, next);
    memcpy(r->q, next, sizeof next);
}

static double energy(const rotor *r) {
    double omega[3];
    sf_rigid_angular_velocity(r->inertia, r->q, r->spin, omega);
    return 0.5 * sf_dot3(omega, r->spin);
}

static void tumble(sf_study *study) {
    const double inertia[6] = {0.02, 0.035, 0.045, 0.002, -0.001, 0.003}, omega[3] = {0.3, 30, 0.2};
    rotor r = make_rotor(inertia, omega);
    const double first = energy(&r), dt = 2 * PI / 30 / 200;
    double worst = 0;
    for (int step = 0; step < 1000 * 200; step++) {
        drift(&r, dt);
        worst = larger(worst, fabs(energy(&r) / first - 1));
    }
    sf_study_text(
        study,
        "### Without torque\n\nA body with three different moments turns about its unstable axis, 1000 "
        "turns of 200 steps. Its angular momentum is a number of the state that nothing "
        "changes; the energy depends on the orientation.\n\n");
    sf_study_check(study, worst, 0, 1e-10, "largest relative change of the energy");
}

/* Largest distance of two points of an axisymmetric body from the closed form, after one turn about L. */
static double precession_error(int steps) {
    const double inertia[6] = {0.02, 0.02, 0.03, 0, 0, 0}, omega[3] = {12, 0, 25};
    rotor r = make_rotor(inertia, omega);
    double size = sqrt(sf_dot3(r.spin, r.spin)), rate = size / 0.02, time = 2 * PI / rate, worst = 0,
           own = 0.5 * 25 * (1 - 1.5) * time;
    for (int step = 0; step < steps; step++)
        drift(&r, time / steps);
    for (int p = 0; p < 2; p++) {
        const double point[3] = {p == 0, p == 1, 0.3}, about[4] = {cos(own), 0, 0, sin(own)};
        double exact[3], found[3]; /* a whole turn about L: only the body's own rotation is left */
        sf_rotate(about, point, exact);
        sf_rotate(r.q, point, found);
        for (int k = 0; k < 3; k++)
            worst = larger(worst, fabs(found[k] - exact[k]));
    }
    return worst;
}

static void precess(sf_study *study) {
    double coarse = precession_error(200), fine = precession_error(400);
    sf_study_text(
        study, "An axisymmetric body (moments 0.02, 0.02, 0.03 kg m2) goes round its angular momentum by the "
               "closed form; points at 1 m, one turn:\n\n");
    sf_study_check(study, fine, 0, 1e-3, "error with 400 steps, m");
    sf_study_check(study, log2(coarse / fine), 1.95, 2.05, "order, from 200 to 400 steps");
    sf_study_check(study, precession_error(40000), 0, 1e-7, "error with 40000 steps, m");
}

/* ---- drops of a ball on a block ---- */

typedef struct drop {
    int cells[3];
    double spacing, radius, mass, speed, slant, friction, gravity, place[2];
    bool hard, free, uneven; /* uneven: its centre of mass is off that of the ball, and it spins */
} drop;

static void start(const drop *d, fixture *f) {
    fixture_block block = {.spacing = d->spacing};
    sf_case c;
    sf_mesh mesh;
    body ball;
    const double above[3] = {d->place[0], d->place[1], d->cells[2] * d->spacing + d->radius + 1e-5};
    memcpy(block.cells, d->cells, sizeof block.cells);
    fixture_case(&c, d->hard
                         ? (const char *const[]){"material.E=200 MPa", "material.density=2000 kg/m3", NULL}
                         : NULL);
    fixture_hold(&c, (const char *const[]){"base", NULL});
    if (d->hard) {
        fixture_make_linear(&c);
        sf_foam_card_of(&c.material)->damp = 0.3;
    }
    c.missile_card.mass = d->mass;
    c.missile_card.speed = d->speed;
    c.missile_card.friction = d->friction;
    c.missile_card.gravity = d->gravity;
    c.missile_card.direction[0] = sin(d->slant);
    c.missile_card.direction[1] = 0;
    c.missile_card.direction[2] = -cos(d->slant);
    fixture_block_mesh(&block, &mesh);
    body_ball(&ball, 8, d->radius, above);
    fixture_build(&c, &mesh, &ball.surface, f);
    sf_missile_card *card = &f->model.missile;
    card->freedom = d->free ? SF_MISSILE_FREE : SF_MISSILE_GUIDED;
    for (int k = 0; k < 3 && d->free; k++) {
        card->centre[k] = card->sphere_centre[k] + (d->uneven ? 0.01 * (k - 0.5) : 0);
        card->inertia[k] = 0.4 * d->mass * d->radius * d->radius * (d->uneven ? 1 + 0.1 * k : 1);
        card->angular_velocity[k] = d->uneven ? 5 * (k == 1 ? -4 : k + 1) : 0;
    }
    fixture_start(f);
}

static void compare_guided(sf_study *study) {
    drop d = {.cells = {8, 8, 5},
              .spacing = 0.01,
              .radius = 0.04,
              .mass = 0.5,
              .speed = 4,
              .gravity = 9.81,
              .friction = 0.3,
              .place = {0.04, 0.04}};
    fixture guided, loose;
    double hardest = 0, apart = 0;
    start(&d, &guided);
    d.free = true;
    start(&d, &loose);
    while (!sf_ending_rebounded(&guided.model, &guided.state)) {
        fixture_step(&guided);
        fixture_step(&loose);
        hardest = larger(hardest, guided.state.missile.force[2]);
        apart = larger(apart, fabs(guided.state.missile.force[2] - loose.state.missile.force[2]));
        sf_step_advance(&guided.model, &guided.state);
        sf_step_advance(&loose.model, &loose.state);
    }
    sf_study_text(study, "### Drops\n\nA ball on the middle of a symmetric block, free and guided:\n\n");
    sf_study_check(study, apart / hardest, 0, 1e-9, "largest difference of the forces, over the peak");
    fixture_free(&guided);
    fixture_free(&loose);
}

static void balance(sf_study *study) {
    const drop d = {.cells = {8, 6, 5},
                    .spacing = 0.01,
                    .radius = 0.04,
                    .mass = 0.5,
                    .speed = 4,
                    .slant = 0.5,
                    .gravity = 9.81,
                    .friction = 0.4,
                    .place = {0.02, 0.035},
                    .free = true,
                    .uneven = true};
    fixture f;
    double linear = 0, angular = 0;
    start(&d, &f);
    while (f.state.time < 0.02) {
        fixture_step(&f);
        linear = larger(linear, fabs(f.state.ledger.vector_error));
        angular = larger(angular, fabs(f.state.ledger.angular_error));
        sf_step_advance(&f.model, &f.state);
    }
    sf_study_text(study,
                  "An uneven, spinning ball that hits a block obliquely beside its middle, with friction; "
                  "missile, pad and anvil:\n\n");
    sf_study_check(study, linear, 0, 1e-8, "largest error of the momentum in space");
    sf_study_check(study, angular, 0, 1e-8, "largest error of the angular momentum");
    sf_study_check(study, f.state.ledger.largest_error, 0, 5e-3, "largest error of the energy");
    fixture_free(&f);
}

static void roll(sf_study *study) {
    const double mu = 0.2, v0 = 0.5 * sin(1.55);
    const drop d = {.cells = {16, 6, 1},
                    .spacing = 0.005,
                    .radius = 0.1,
                    .mass = 4,
                    .speed = 0.5,
                    .slant = 1.55,
                    .gravity = 100,
                    .friction = mu,
                    .place = {0.03, 0.015},
                    .hard = true,
                    .free = true};
    fixture f;
    double pressed = 0, braked = 0, rim = 0, v = v0;
    start(&d, &f);
    while (f.state.time < 20e-3) {
        fixture_step(&f);
        sf_missile_view view = sf_missile_read(&f.model, &f.state.missile);
        v = view.velocity[0];
        rim = view.angular_velocity[1] * d.radius;
        pressed += 0.5 * (f.state.dt_old + f.state.dt) * f.state.missile.force[2];
        if (f.state.time < 4e-3)
            braked = (v0 - v) * d.mass / (mu * pressed);
        sf_step_advance(&f.model, &f.state);
    }
    sf_study_text(study, "A ball slides on a hard pad without spin, until it rolls:\n\n");
    sf_study_check(study, braked, 0.97, 1.03, "loss of momentum over mu times the impulse, while it slides");
    sf_study_check(study, v / v0, 0.99 * 5 / 7, 1.01 * 5 / 7,
                   "its speed at the end over that at first (5/7)");
    sf_study_check(study, rim / v, 0.99, 1.01, "omega R over its speed at the end");
    fixture_free(&f);
}

int main(int argc, char **argv) {
    sf_study study;
    sf_study_begin(&study, "missile", "Six degrees of freedom", argc, argv);
    tumble(&study);
    precess(&study);
    compare_guided(&study);
    balance(&study);
    roll(&study);
    return sf_study_end(&study);
}
