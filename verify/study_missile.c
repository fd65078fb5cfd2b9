/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The missile with six degrees of freedom: tumbling, precession, momentum of an oblique drop, sliding and
 * rolling, and the guided drop as a special case. */
#include "body_fixture.h"
#include "extreme.h"
#include "model_fixture.h"
#include "study.h"

#include "base/mat3.h"
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
    sf_rigid_product(inertia, omega, r.spin);
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

/* A ball over a block on its base. */
typedef struct drop {
    int cells[3];
    double spacing, radius, mass, speed, friction, gravity;
    double slant;      /* from the vertical towards +x, rad */
    double place[2];   /* of the ball's centre in plan, m */
    double centre[3];  /* of mass, from that of the ball, m */
    double inertia[6]; /* 0: that of the homogeneous ball */
    double spin[3];    /* rad/s */
    bool hard, triangles, free;
} drop;

/* Middle of the ball over the block; with triangles from its lowest node. */
static void ball_middle(const drop *d, const sf_model *m, const double above[3], double out[3]) {
    double lowest = INFINITY;
    for (int64_t i = 0; i < m->surface_node_count; i++)
        lowest = smaller(lowest, m->surface_position[3 * i + 2]);
    out[2] = lowest + d->radius;
    for (int k = 0; k < 2; k++) /* it has moved along its direction to its gap */
        out[k] = above[k] + (out[2] - above[2]) * m->missile.direction[k] / m->missile.direction[2];
    if (!d->triangles)
        memcpy(out, m->missile.sphere_centre, 3 * sizeof *out);
}

static void start(const drop *d, fixture *f) {
    fixture_block block = {.spacing = d->spacing};
    sf_case c;
    sf_mesh mesh;
    body ball;
    const double above[3] = {d->place[0], d->place[1], d->cells[2] * d->spacing + d->radius + 1e-5};
    double middle[3];
    memcpy(block.cells, d->cells, sizeof block.cells);
    fixture_case(&c, d->hard
                         ? (const char *const[]){"material.E=200 MPa", "material.density=2000 kg/m3", NULL}
                         : NULL);
    fixture_hold(&c, (const char *const[]){"base", NULL});
    if (d->hard) {
        fixture_make_linear(&c);
        sf_foam_card_of(&c.material)->shared.damp = 0.3;
    }
    c.missile_card.mass = d->mass;
    c.missile_card.speed = d->speed;
    c.missile_card.friction = d->friction;
    c.missile_card.gravity = d->gravity;
    c.run.step_limit = 20e-6; /* fine enough for the slowest drops */
    c.shape_rule = d->triangles ? 2 : 0;
    fixture_slant(&c, d->slant);
    fixture_block_mesh(&block, &mesh);
    body_ball(&ball, 8, d->radius, above);
    fixture_build(&c, &mesh, &ball.surface, f);
    sf_missile_card *card = &f->model.missile;
    ball_middle(d, &f->model, above, middle);
    card->freedom = d->free ? SF_MISSILE_FREE : SF_MISSILE_GUIDED;
    for (int k = 0; k < 3 && d->free; k++) {
        card->centre[k] = middle[k] + d->centre[k];
        card->inertia[k] = d->inertia[0] > 0 ? d->inertia[k] : 0.4 * d->mass * d->radius * d->radius;
        card->inertia[3 + k] = d->inertia[3 + k];
        card->angular_velocity[k] = d->spin[k];
    }
    fixture_start(f);
}

/* Largest difference of two drops now in time, displacement, speed, indentation and energy error, and of the
 * second one's sideways motion and turn from none, each over its scale. */
static double difference(const fixture *guided, const fixture *loose, double deepest) {
    const sf_missile *a = &guided->state.missile, *b = &loose->state.missile;
    const double length = deepest > 0 ? deepest : 1;
    const double apart[] = {
        (b->displacement - a->displacement) / length,
        (sf_missile_depth(&loose->model, b) - sf_missile_depth(&guided->model, a)) / length,
        b->translation[0] / length,
        (b->velocity_now - a->velocity_now) / guided->model.missile.speed,
        loose->state.ledger.error - guided->state.ledger.error,
        b->quaternion[0] - 1,
        guided->state.time > 0 ? loose->state.time / guided->state.time - 1 : loose->state.time};
    return largest_of(apart, sizeof apart / sizeof apart[0]);
}

static void compare_guided(sf_study *study) {
    sf_study_text(
        study,
        "### Drops\n\nA ball on the middle of a symmetric block, free and guided, as a sphere and as "
        "triangles (ties of facets are decided by rounding, and the forces of sharp edges settle to 1e-5):\n\n");
    for (int triangles = 0; triangles < 2; triangles++) {
        const char *const ball = triangles ? "triangles" : "sphere";
        const double same = triangles ? 1e-5 : 1e-9; /* sweeps of sharp edges end at 1e-5 */
        drop d = {.cells = {8, 8, 5},
                  .spacing = 0.01,
                  .radius = 0.04,
                  .mass = 0.5,
                  .speed = 4,
                  .gravity = 9.81,
                  .friction = 0.3,
                  .triangles = triangles,
                  .place = {0.04, 0.04}};
        fixture guided, loose;
        double hardest = 0, hardest_free = 0, apart = 0, deepest = 0, motion = 0;
        start(&d, &guided);
        d.free = true;
        start(&d, &loose);
        while (!(sf_ending_rebounded(&guided.model, &guided.state) &&
                 sf_ending_rebounded(&loose.model, &loose.state)) &&
               guided.state.time < 0.04) {
            fixture_step(&guided);
            fixture_step(&loose);
            hardest = larger(hardest, guided.state.missile.force[2]);
            hardest_free = larger(hardest_free, loose.state.missile.force[2]);
            apart = larger(apart, fabs(guided.state.missile.force[2] - loose.state.missile.force[2]));
            sf_step_advance(&guided.model, &guided.state);
            sf_step_advance(&loose.model, &loose.state);
            deepest = larger(deepest, guided.state.missile.displacement);
            motion = larger(motion, difference(&guided, &loose, deepest));
        }
        bool both = sf_ending_rebounded(&guided.model, &guided.state) &&
                    sf_ending_rebounded(&loose.model, &loose.state) && deepest > 0.019;
        sf_study_check(study, both, 1, 1, "%s: both rebound after more than 19 mm", ball);
        if (triangles)
            sf_study_check(study, fabs(hardest_free / hardest - 1), 0, same,
                           "%s: difference of the forces (triangles: of the largest), over the peak", ball);
        else
            sf_study_check(study, apart / hardest, 0, same,
                           "%s: difference of the forces (triangles: of the largest), over the peak", ball);
        sf_study_check(
            study, motion, 0, same,
            "%s: of time, displacement, speed, indentation, sideways motion, turn and energy error", ball);
        fixture_free(&guided);
        fixture_free(&loose);
    }
}

static void balance(sf_study *study) {
    sf_study_text(study,
                  "An uneven, spinning ball that hits a block obliquely beside its middle, with friction; "
                  "missile, pad and anvil:\n\n");
    for (int triangles = 0; triangles < 2; triangles++) {
        const drop d = {.cells = {8, 6, 5},
                        .spacing = 0.01,
                        .radius = 0.04,
                        .mass = 0.5,
                        .speed = 4,
                        .slant = 0.5,
                        .gravity = 9.81,
                        .friction = 0.4,
                        .place = {0.02, 0.035},
                        .centre = {0.01, -0.005, 0.01},
                        .inertia = {3e-4, 4e-4, 3.5e-4, 2e-5, 1e-5, -3e-5},
                        .spin = {5, -20, 10},
                        .triangles = triangles,
                        .free = true};
        fixture f;
        double linear = 0, angular = 0, turned = 1;
        int64_t touched = 0;
        start(&d, &f);
        const sf_ledger *l = &f.state.ledger;
        while (f.state.time < 0.02) {
            fixture_advance(&f);
            linear = larger(linear, larger(fabs(l->vector_error), fabs(l->momentum_error)));
            angular = larger(angular, fabs(l->angular_error));
            turned = smaller(turned, f.state.missile.quaternion[0]);
            touched += f.state.contact_count > 0;
        }
        bool proper = touched > 100 && l->friction > 0.01 * l->reference && f.state.contact_unsettled == 0;
        const char *ball = triangles ? "triangles" : "sphere";
        sf_study_check(study, proper, 1, 1,
                       "%s: more than 100 steps in contact, 1 %% of the energy lost in friction", ball);
        sf_study_check(study, 2 * acos(turned), 0.2, INFINITY, "%s: largest turn, rad", ball);
        sf_study_check(study, linear, 0, 1e-10,
                       "%s: largest error of the momentum, along its direction and in space", ball);
        sf_study_check(study, angular, 0, 1e-10, "%s: largest error of the angular momentum", ball);
        sf_study_check(study, l->largest_error, 0, 5e-3, "%s: largest error of the energy", ball);
        fixture_free(&f);
    }
}

/* Friction brakes a ball that slides without spin, m dv = mu N dt, and spins it up, I d omega = mu N R dt,
 * until it rolls with 5/7 of its speed, however N has changed. */
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
    double pressed = 0, least = INFINITY, most = 0, about = 0, aside = 0, momenta = 0, slow = INFINITY,
           fast = 0, slip = 0;
    int64_t sliding = 0, rolling = 0;
    start(&d, &f);
    while (f.state.time < 20e-3) {
        fixture_step(&f);
        sf_missile_view view = sf_missile_read(&f.model, &f.state.missile);
        double v = view.velocity[0], rim = view.angular_velocity[1] * d.radius;
        pressed += 0.5 * (f.state.dt_old + f.state.dt) * f.state.missile.force[2];
        about = larger(about, fabs(v + 0.4 * rim - v0) / v0);
        aside = larger(aside, fabs(view.velocity[1]) / v0);
        momenta = larger(momenta, larger(f.state.ledger.vector_error, f.state.ledger.angular_error));
        if (f.state.time < 4e-3 && pressed > 0.1) {
            double braked = (v0 - v) * d.mass / (mu * pressed);
            least = smaller(least, braked);
            most = larger(most, braked);
            sliding++;
        } else if (f.state.time > 14e-3) {
            slow = smaller(slow, v / v0);
            fast = larger(fast, v / v0);
            slip = larger(slip, fabs(rim - v) / v0);
            rolling++;
        }
        sf_step_advance(&f.model, &f.state);
    }
    sf_study_text(study, "A ball slides on a hard pad without spin, until it rolls:\n\n");
    sf_study_check(study, sliding > 100 && rolling > 100, 1, 1, "more than 100 steps of each");
    const double loss[] = {least, most}, speed[] = {slow, fast};
    for (int k = 0; k < 2; k++) {
        const char *end = k == 0 ? "least" : "most";
        sf_study_check(study, loss[k], 0.97, 1.03,
                       "%s: loss of momentum over mu times the impulse, while it slides", end);
        sf_study_check(study, speed[k], 0.99 * 5 / 7, 1.01 * 5 / 7,
                       "%s: its speed, rolling, over that at first (5/7)", end);
    }
    sf_study_check(study, slip, 0, 0.01 * 5 / 7,
                   "largest difference of omega R from its speed, rolling, over that at first");
    sf_study_check(study, about, 0, 0.005, "largest change of v + 2/5 omega R, over v at first");
    sf_study_check(study, aside, 0, 1e-3, "largest speed across, over v at first");
    sf_study_check(study, momenta, 0, 1e-10, "largest error of momentum and angular momentum");
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
