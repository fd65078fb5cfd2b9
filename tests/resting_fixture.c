/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "resting_fixture.h"

void resting_start(fixture *f, const resting *r) {
    const fixture_block block = {
        .cells = {5, 4, r->layers ? r->layers : 3}, .spacing = 0.01, .jitter = 0.1, .surface_jitter = 0.05};
    sf_case c;
    fixture_case(&c, NULL);
    fixture_hold(&c, (const char *const[]){"base", NULL});
    fixture_mirror(&c, (int)r->symmetry);
    c.base_rule = SF_BASE_RESTING;
    c.anvil_card.friction = r->friction;
    c.missile_card.mass = 0.5 * (1 << r->symmetry);
    c.missile_card.gap = r->gap;
    if (r->speed > 0)
        c.missile_card.speed = r->speed;
    fixture_under_dome(&c, &block, 0.02, 8, r->symmetry >= HALF ? 0 : 0.025 + r->across,
                       r->symmetry == QUARTER ? 0 : 0.02, f);
    fixture_start(f);
}

double resting_mass(const sf_model *m) {
    double mass = 0;
    for (int64_t i = 0; i < m->node_count; i++)
        mass += m->mass[i];
    return mass;
}

void resting_centre(const fixture *f, double out[3]) {
    double sum[3] = {0}, mass = resting_mass(&f->model);
    for (int64_t i = 0; i < f->model.node_count; i++)
        for (int r = 0; r < 3; r++)
            sum[r] += f->model.mass[i] * f->state.d[3 * i + r];
    for (int r = 0; r < 3; r++)
        out[r] = sum[r] / mass;
}

void resting_throw(fixture *f, double x, double z) {
    for (int64_t i = 0; i < f->model.node_count; i++) {
        f->state.v[3 * i] = x;
        f->state.v[3 * i + 2] = z;
    }
}

void resting_advance_to(fixture *f, double time) {
    while (f->state.time < time)
        fixture_advance(f);
}
