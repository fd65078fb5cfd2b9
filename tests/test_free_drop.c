/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Drops of a missile with six degrees of freedom: against the guided one, momentum and angular momentum,
 * sliding and rolling, a bar that turns as it lands. */
#include "body_fixture.h"
#include "extreme.h"
#include "model_fixture.h"

#include "base/mat3.h"
#include "solver/run/run.h"
#include "solver/step.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

/* A ball over a block on its base. */
typedef struct drop {
    int cells[3];
    double spacing, radius, mass, speed, slant, friction, gravity; /* slant: from the vertical, towards +x */
    double place[2];                                               /* of the centre, in plan */
    bool linear, triangles, free;
    double centre[3];  /* of mass, from that of the ball */
    double inertia[6]; /* 0: of the homogeneous ball */
    double spin[3];
} drop;

static void start(const drop *d, fixture *f) {
    fixture_block block = {.spacing = d->spacing};
    sf_case c;
    sf_mesh mesh;
    body ball;
    const double above[3] = {d->place[0], d->place[1], d->cells[2] * d->spacing + d->radius + 1e-5};
    memcpy(block.cells, d->cells, sizeof block.cells);
    fixture_case(&c, d->linear
                         ? (const char *const[]){"material.E=200 MPa", "material.density=2000 kg/m3", NULL}
                         : NULL);
    fixture_hold(&c, (const char *const[]){"base", NULL});
    if (d->linear) {
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
    c.shape_rule = d->triangles ? 2 : 0;
    fixture_block_mesh(&block, &mesh);
    body_ball(&ball, 8, d->radius, above);
    fixture_build(&c, &mesh, &ball.surface, f);
    sf_missile_card *card = &f->model.missile;
    double lowest = INFINITY;
    for (int64_t i = 0; i < f->model.surface_node_count; i++)
        lowest = smaller(lowest, f->model.surface_position[3 * i + 2]);
    card->freedom = d->free ? SF_MISSILE_FREE : SF_MISSILE_GUIDED;
    for (int k = 0; k < 3 && d->free; k++) {
        double middle = k < 2 ? d->place[k] : lowest + d->radius;
        if (k < 2) /* it was moved along its direction to its gap */
            middle += (lowest + d->radius - above[2]) * card->direction[k] / card->direction[2];
        card->centre[k] = middle + d->centre[k];
        card->inertia[k] = d->inertia[0] > 0 ? d->inertia[k] : 0.4 * d->mass * d->radius * d->radius;
        card->inertia[3 + k] = d->inertia[3 + k];
        card->angular_velocity[k] = d->spin[k];
    }
    fixture_start(f);
}

static void take_step(fixture *f) {
    fixture_step(f);
    sf_step_advance(&f->model, &f->state);
}

/* A ball in the middle of a symmetric block. */
static void a_centred_free_drop_is_the_guided_one(void **state) {
    (void)state;
    for (int triangles = 0; triangles < 2; triangles++) {
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
        start(&d, &guided);
        d.free = true;
        start(&d, &loose);
        double deepest = 0, hardest = 0, hardest_free = 0;
        const double same = triangles ? 1e-6 : 1e-9; /* ties of facets are decided by rounding */
        while (!sf_ending_rebounded(&guided.model, &guided.state)) {
            const sf_missile *a = &guided.state.missile, *b = &loose.state.missile;
            take_step(&guided);
            take_step(&loose);
            deepest = larger(deepest, a->displacement);
            hardest = larger(hardest, a->force[2]);
            assert_true(guided.state.time < 0.04);
            assert_close(loose.state.time, guided.state.time, same * guided.state.time);
            assert_close(b->displacement, a->displacement, same * deepest);
            assert_close(b->velocity_now, a->velocity_now, same * 4);
            hardest_free = larger(hardest_free, b->force[2]);
            assert_close(sf_missile_depth(&loose.model, b), sf_missile_depth(&guided.model, a),
                         same * deepest);
            assert_close(loose.state.ledger.error, guided.state.ledger.error, same);
            assert_close(b->translation[0] / deepest, 0, same);
            assert_close(b->quaternion[0], 1, same);
        }
        assert_true(sf_ending_rebounded(&loose.model, &loose.state));
        assert_close(hardest_free, hardest, same * hardest);
        assert_true(deepest > 0.02);
        fixture_free(&guided);
        fixture_free(&loose);
    }
}

/* Off the middle, oblique, with friction and spin, its centre of mass off that of the ball. */
static void an_oblique_drop_keeps_momentum_and_angular_momentum(void **state) {
    (void)state;
    for (int triangles = 0; triangles < 2; triangles++) {
        const drop d = {.cells = {8, 6, 5},
                        .spacing = 0.01,
                        .radius = 0.04,
                        .mass = 0.5,
                        .speed = 4,
                        .slant = 0.5,
                        .gravity = 9.81,
                        .friction = 0.4,
                        .free = true,
                        .triangles = triangles,
                        .place = {0.02, 0.035},
                        .centre = {0.01, -0.005, 0.01},
                        .inertia = {3e-4, 4e-4, 3.5e-4, 2e-5, 1e-5, -3e-5},
                        .spin = {5, -20, 10}};
        fixture f;
        start(&d, &f);
        const sf_ledger *l = &f.state.ledger;
        double turned = 1;
        int64_t touched = 0;
        while (f.state.time < 0.02) {
            take_step(&f);
            assert_close(l->vector_error, 0, 1e-10);
            assert_close(l->angular_error, 0, 1e-10);
            assert_close(l->momentum_error, 0, 1e-10);
            assert_close(l->error, 0, 5e-3);
            turned = smaller(turned, f.state.missile.quaternion[0]);
            touched += f.state.contact_count > 0;
        }
        assert_true(touched > 100);
        assert_true(turned < cos(0.1)); /* by more than 0.2 rad */
        assert_true(l->friction > 0.01 * l->reference);
        assert_int_equal(f.state.contact_unsettled, 0);
        fixture_free(&f);
    }
}

/* Sliding without spin on a hard pad it is braked by friction, m dv = mu N dt, which spins it up, I d omega =
 * mu N R dt, until it rolls with 5/7 of its speed, however N has changed. */
static void a_sliding_ball_rolls_in_the_end(void **state) {
    (void)state;
    const double slant = 1.55, mu = 0.2, gravity = 100, v0 = 0.5 * sin(slant);
    const drop d = {.cells = {16, 6, 1},
                    .spacing = 0.005,
                    .radius = 0.1,
                    .mass = 4,
                    .speed = 0.5,
                    .slant = slant,
                    .gravity = gravity,
                    .friction = mu,
                    .linear = true,
                    .free = true,
                    .place = {0.03, 0.015}};
    fixture f;
    start(&d, &f);
    const sf_state *s = &f.state;
    double pressed = 0;
    int64_t sliding = 0, rolling = 0;
    while (s->time < 20e-3) {
        fixture_step(&f);
        sf_missile_view view = sf_missile_read(&f.model, &s->missile);
        double rim = view.angular_velocity[1] * 0.1, v = view.velocity[0];
        pressed += 0.5 * (s->dt_old + s->dt) * s->missile.force[2];
        assert_close(v + 0.4 * rim, v0, 0.005 * v0); /* about the line of contact nothing turns it */
        assert_close(view.velocity[1], 0, 1e-3 * v0);
        if (s->time < 4e-3 && pressed > 0.1) {
            assert_close((v0 - v) * 4 / (mu * pressed), 1, 0.03);
            sliding++;
        } else if (s->time > 14e-3) {
            assert_close(v, 5.0 / 7 * v0, 0.01 * v0);
            assert_close(rim, v, 0.01 * v0);
            rolling++;
        }
        assert_close(s->ledger.vector_error, 0, 1e-10);
        assert_close(s->ledger.angular_error, 0, 1e-10);
        sf_step_advance(&f.model, &f.state);
    }
    assert_true(sliding > 100 && rolling > 100);
    fixture_free(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_centred_free_drop_is_the_guided_one),
        cmocka_unit_test(an_oblique_drop_keeps_momentum_and_angular_momentum),
        cmocka_unit_test(a_sliding_ball_rolls_in_the_end),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
