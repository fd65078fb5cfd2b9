/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "foam_fixture.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

void foam_build(const point_card *card, sf_foam *foam) {
    sf_error err = SF_ERROR_INIT;
    if (sf_foam_build(&card->card, foam, &err) != SF_OK)
        fail_msg("%s", err.text);
}

void foam_set(double matrix[9][SF_LANES], int lane, const double f[9]) {
    for (int k = 0; k < 9; k++)
        matrix[k][lane] = f[k];
}

void foam_get(double matrix[9][SF_LANES], int lane, double out[9]) {
    for (int k = 0; k < 9; k++)
        out[k] = matrix[k][lane];
}

void foam_uniaxial(double stretch, double f[9]) {
    const double diagonal[9] = {stretch, 0, 0, 0, 1, 0, 0, 0, 1};
    memcpy(f, diagonal, sizeof diagonal);
}

void foam_reset(sf_law_batch *batch) {
    double identity[9];
    memset(batch, 0, sizeof *batch);
    batch->directions = true;
    foam_uniaxial(1, identity);
    for (int lane = 0; lane < SF_LANES; lane++) {
        foam_set(batch->f, lane, identity);
        foam_set(batch->f_old, lane, identity);
        batch->length[lane] = 1;
    }
}

void point_law_step(const point_law *law, double dt, const double f[9], sf_law_batch *batch) {
    double old[9];
    foam_get(batch->f, 0, old);
    for (int lane = 0; lane < SF_LANES; lane++) {
        foam_set(batch->f_old, lane, old);
        foam_set(batch->f, lane, f);
    }
    law->update(law->numbers, dt, batch);
}

static point_law law_of(const sf_foam *foam) {
    return (point_law){sf_low_density_foam.update, foam, foam->options.maxwell, false};
}

void foam_step(const sf_foam *foam, double dt, const double f[9], sf_law_batch *batch) {
    const point_law law = law_of(foam);
    point_law_step(&law, dt, f, batch);
}

foam_point foam_elastic(const sf_foam *foam, const double f[9], double peak) {
    sf_law_batch batch;
    foam_reset(&batch);
    for (int lane = 0; lane < SF_LANES; lane++)
        batch.history[SF_FOAM_PEAK][lane] = peak;
    foam_step(foam, 0, f, &batch);
    foam_point point = {.energy = batch.energy[0],
                        .tangent = batch.tangent[0],
                        .factor = batch.factor[0],
                        .stiffness = batch.stiffness[0]};
    foam_get(batch.p, 0, point.p);
    return point;
}

void point_law_tangent(const point_law *law, double dt, const sf_law_batch *batch, double tangent[81]) {
    const double h = 1e-6;
    for (int column = 0; column < 9; column++) {
        double p[2][9];
        for (int side = 0; side < 2; side++) {
            sf_law_batch moved = *batch;
            moved.f[column][0] += side ? h : -h;
            law->update(law->numbers, dt, &moved);
            foam_get(moved.p, 0, p[side]);
        }
        for (int row = 0; row < 9; row++)
            tangent[9 * row + column] = (p[1][row] - p[0][row]) / (2 * h);
    }
}

void foam_tangent(const sf_foam *foam, double dt, const sf_law_batch *batch, double tangent[81]) {
    const point_law law = law_of(foam);
    point_law_tangent(&law, dt, batch, tangent);
}

void foam_assert_bounds(const sf_law_batch *batch, const double tangent[81]) {
    static const int sym[9] = {0, 3, 5, 3, 1, 4, 5, 4, 2};
    double bound = batch->tangent[0], rest[81], largest = point_largest_eigenvalue(9, tangent);
    if (!(largest <= bound * (1 + 1e-6)))
        fail_msg("largest eigenvalue %.9g Pa, bound %.9g Pa", largest, bound);
    for (int row = 0; row < 9; row++) /* minus trace(dF A dFt) */
        for (int column = 0; column < 9; column++)
            rest[9 * row + column] =
                tangent[9 * row + column] -
                (row / 3 == column / 3 ? batch->directional[sym[3 * (row % 3) + column % 3]][0] : 0);
    double excess = point_largest_eigenvalue(9, rest);
    if (!(excess <= 1e-6 * bound))
        fail_msg("the tangent exceeds the bound by direction by %.9g Pa of %.9g Pa", excess, bound);
}

void point_law_assert_bounds(const point_law *law, uint64_t *seed, double low, double high, double dt) {
    sf_law_batch batch;
    double f[9], old[9], tangent[81];
    point_deformation(seed, low, high, old);
    foam_reset(&batch);
    point_law_step(law, 0, old, &batch);
    for (int lane = 0; lane < SF_LANES; lane++) {
        for (int k = 0; k < 6; k++)
            batch.history[SF_FOAM_MAXWELL + k][lane] = law->maxwell * point_random(seed, -0.1, 0.1);
        batch.history[SF_FOAM_RATE][lane] = point_random(seed, 0, 120);
    }
    for (int k = 0; k < 9; k++)
        f[k] = old[k] + point_random(seed, -50, 50) * dt;
    foam_set(batch.f_old, 0, old);
    foam_set(batch.f, 0, f);
    if (point_random(seed, 0, 1) < 0.5)
        batch.history[SF_FOAM_PEAK][0] *= 2;
    else if (law->away)
        batch.history[SF_FOAM_PEAK][0] = 0;
    sf_law_batch after = batch;
    point_law_tangent(law, dt, &batch, tangent);
    law->update(law->numbers, dt, &after);
    foam_assert_bounds(&after, tangent);
}

void foam_assert_tangent_bounds(const sf_foam *foam, uint64_t *seed, double dt) {
    const point_law law = law_of(foam);
    point_law_assert_bounds(&law, seed, 0.2, 1.2, dt);
}
