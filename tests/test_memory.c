/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Memory of the foam laws: closed forms of cycles with rests, and, on random paths of both laws, dissipation,
 * energy, continuity and the bounds of the time step. */
#include "extreme.h"
#include "foam_fixture.h"

#include "material/hyperfoam.h"
#include "material/memory.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <string.h>
#include <cmocka.h>

static const sf_memory REMEMBERS = {
    .reload = 0.4, .drift = 0.15, .recovery = 0.1, .start = 1, .permanent = 0.3};

/* A foam law with memory: 0, 1 the low-density foam with ALPHA 1 and 0.4, 2, 3 the hyperfoam, which couples.
 */
typedef struct foam_variant {
    point_card eva;
    sf_hyperfoam_card terms;
    sf_material material;
    sf_material_law law;
} foam_variant;
enum { VARIANTS = 4 };

static void make(foam_variant *v, int number, const sf_memory *memory) {
    sf_error err = SF_ERROR_INIT;
    memset(v, 0, sizeof *v);
    point_card_init(&v->eva);
    point_card_add_eva(&v->eva, 0, 400, 0.9, 1);
    v->terms = (sf_hyperfoam_card){.term[0] = {.mu = 1e5, .alpha = 6, .nu = 0.2}};
    v->terms.shared.density = 35;
    sf_foam_shared *card = number < 2 ? &v->eva.card.shared : &v->terms.shared;
    card->hysteresis_hu = 0.05;
    card->hysteresis_shape = number % 2 ? 0.3 : 1;
    card->hysteresis_alpha = number % 2 ? 0.4 : 1;
    card->memory = *memory;
    if (card->maxwell_rate == 0)
        card->maxwell_rate = 5000;
    if (card->rate_filter_time == 0)
        card->rate_filter_time = 1e-4;
    v->material = (sf_material){.law = number < 2 ? &sf_low_density_foam : &sf_hyperfoam_law, .card = card};
    if (sf_material_law_build(&v->material, &v->law, &err) != SF_OK)
        fail_msg("%s", err.text);
}

static double axial(foam_variant *v, double strain, sf_uniaxial *point) {
    return v->law.law->uniaxial(v->law.numbers, 1e9, strain, point);
}

/* Takes the point to `strain` in steps; returns the stress there. */
static double go(foam_variant *v, double strain, sf_uniaxial *point) {
    double from = point->strain, stress = 0;
    for (int k = 1; k <= 400; k++)
        stress = axial(v, from + (strain - from) * k / 400, point);
    return stress;
}

static void rest(foam_variant *v, double pause, sf_uniaxial *point) {
    double rows[SF_LAW_HISTORY][SF_LANES] = {{0}};
    for (int k = 0; k < SF_LAW_HISTORY; k++)
        rows[k][0] = point->history[k];
    v->law.law->rest(v->law.numbers, pause, rows);
    for (int k = 0; k < SF_LAW_HISTORY; k++)
        point->history[k] = rows[k][0];
}

/* The factor of unloading and the stress of first loading at a strain, by points without memory. */
static double unloading(foam_variant *plain, double largest, double strain, double *first) {
    sf_uniaxial up = {0}, down = {0};
    *first = go(plain, strain, &up);
    go(plain, largest, &down);
    return go(plain, strain, &down) / *first;
}

/* Six loadings with a rest before the fourth, beyond the elastic range: [f + q (1 - f)] sigma, and sigma
 * beyond the largest strain. */
static void cycles_follow_the_closed_form(void **state) {
    (void)state;
    static const sf_memory none = {.start = 1};
    for (int n = 0; n < VARIANTS; n++) {
        foam_variant v, plain;
        sf_uniaxial point = {0};
        make(&v, n, &REMEMBERS);
        make(&plain, n, &none);
        double recovered = 0.1 * log10(1 + 90), first, f = unloading(&plain, 0.6, 0.4, &first);
        go(&v, 0.6, &point);
        double last = go(&v, 0.4, &point);
        assert_true(fabs(last / (f * first) - 1) < 1e-9);
        for (double cycle = 2, passes = 1, q; cycle <= 4; cycle++, passes += 1 - SF_MEMORY_ELASTIC * q) {
            q = 0.4 / (1 + 0.15 * (passes - 1));
            go(&v, 0, &point);
            if (cycle == 4) {
                rest(&v, 40, &point);
                rest(&v, 50, &point);
                q += recovered * (1 - q);
            }
            double stress = go(&v, 0.4, &point), expected = (f + q * (1 - f)) * first;
            if (!(fabs(stress / expected - 1) <
                  (cycle == 4 ? 1e-3 : 1e-6))) /* after the rests W_max is (1 - R^4) of it */
                fail_msg("law %d, cycle %g: %.9g Pa, not %.9g", n, cycle, stress, expected);
            go(&v, cycle == 4 ? 0.59 : 0.6 - 1e-9, &point);
        }
        go(&v, 0, &point); /* what had recovered has faded, the drift remains */
        const sf_memory_point *left = (const sf_memory_point *)&point.history[SF_FOAM_MEMORY];
        assert_true(left->recovered > 0 && left->recovered < 0.09 * recovered && left->passes > 3);
        sf_uniaxial virgin = {0};
        assert_true(fabs(go(&v, 0.65, &point) / go(&v, 0.65, &virgin) - 1) < 1e-9);
        sf_material_law_free(&v.law);
        sf_material_law_free(&plain.law);
    }
}

static void inner_loops_close(void **state) {
    (void)state;
    const sf_memory steady = {.reload = 0.4, .start = 1};
    for (int n = 0; n < VARIANTS; n++) {
        foam_variant v;
        sf_uniaxial point = {0};
        double at[4][3];
        make(&v, n, &steady);
        go(&v, 0.6, &point);
        for (int k = 0; k < 4; k++) {
            at[k][0] = go(&v, 0.25, &point);
            at[k][1] = go(&v, 0.3, &point);
            at[k][2] = go(&v, 0.45, &point);
        }
        for (int k = 2; k < 4; k++)
            for (int c = 0; c < 3; c++)
                assert_true(fabs(at[k][c] / at[1][c] - 1) < 1e-10);
        sf_material_law_free(&v.law);
    }
}

static void recovery_is_one_of_time(void **state) {
    (void)state;
    sf_memory_point once = {.passes = 1}, twice = once, ages = once;
    sf_memory_rest(&REMEMBERS, 90, &once);
    sf_memory_rest(&REMEMBERS, 30, &twice);
    sf_memory_rest(&REMEMBERS, 60, &twice);
    assert_true(fabs(once.recovered - twice.recovered) < 1e-14);
    assert_true(fabs(once.recovered - 0.1 * log10(91)) < 1e-14);
    assert_true(fabs(sf_memory_factor(&REMEMBERS, &once) - (0.4 + 0.6 * once.recovered)) < 1e-14);
    sf_memory_rest(&REMEMBERS, 1e30, &ages);
    assert_true(ages.recovered == 1 - REMEMBERS.permanent);
    sf_memory all = REMEMBERS;
    all.permanent = 0;
    sf_memory_point first = {.passes = 1}, second = first, fresh = first;
    double once_left = sf_memory_rest(&all, 1e4, &first), twice_left = sf_memory_rest(&all, 1e3, &second);
    twice_left *= sf_memory_rest(&all, 9e3, &second);
    assert_true(once_left > 0 && once_left < 1 && fabs(once_left - twice_left) < 1e-12);
    assert_true(sf_memory_rest(&all, 1e30, &fresh) == 0); /* new again */
}

static double product(const double p[9], const double q[9], const double f[9], const double g[9]) {
    double sum = 0;
    for (int k = 0; k < 9; k++)
        sum += 0.5 * (p[k] + q[k]) * (g[k] - f[k]);
    return sum;
}

/* Largest numbers over the random paths of a law. */
typedef struct path_errors {
    double gain;  /* of a step's lost energy below 0, over the point's largest energy */
    double jump;  /* of the stress in a part of 1e-9 of the way, at a reversal, over the stress */
    double error; /* of stored + lost against the work of a segment, over the point's largest energy */
} path_errors;

enum { SEGMENTS = 100000 / SF_LANES + 1, STEPS = 40 };

/* A symmetric deformation with stretches from 0.35 to 1.1; so are those on the straight way between two. */
static void symmetric(uint64_t *seed, double f[9]) {
    double q[9], turned[9], back[9], d[9] = {0};
    for (int i = 0; i < 3; i++)
        d[4 * i] = point_random(seed, 0.35, 1.1);
    point_rotation(seed, q);
    point_transpose(q, back);
    point_product(q, d, turned);
    point_product(turned, back, f);
}

static void advance(const sf_material_law *law, const double from[SF_LANES][9], const double to[SF_LANES][9],
                    double x, sf_law_batch *b) {
    memcpy(b->f_old, b->f, sizeof b->f);
    for (int l = 0; l < SF_LANES; l++)
        for (int k = 0; k < 9; k++)
            b->f[k][l] = from[l][k] + x * (to[l][k] - from[l][k]);
    law->law->update(law->numbers, 0, b);
}

static void segment(const sf_material_law *law, uint64_t *seed, double largest[SF_LANES], sf_law_batch *b,
                    path_errors *worst) {
    double from[SF_LANES][9], to[SF_LANES][9], work[SF_LANES] = {0};
    const sf_law_batch start = *b;
    for (int l = 0; l < SF_LANES; l++) {
        foam_get(b->f, l, from[l]);
        symmetric(seed, to[l]);
    }
    for (int s = 0; s <= STEPS; s++) {
        sf_law_batch before = *b;
        double x = s == 0 ? 1e-9 : (double)s / STEPS;
        advance(law, from, to, x, b);
        for (int l = 0; l < SF_LANES; l++) {
            double p[9], q[9], f[9], g[9], change[9];
            foam_get(before.p, l, p);
            foam_get(b->p, l, q);
            foam_get(before.f, l, f);
            foam_get(b->f, l, g);
            work[l] += product(p, q, f, g);
            largest[l] = larger(largest[l], b->energy[l]);
            worst->gain = larger(worst->gain, (before.lost[l] - b->lost[l]) / fmax(largest[l], 1));
            for (int k = 0; k < 9; k++)
                change[k] = q[k] - p[k];
            if (s == 0)
                worst->jump = larger(worst->jump, point_norm(9, change) / (1e4 + point_norm(9, p)));
        }
    }
    for (int l = 0; l < SF_LANES; l++)
        worst->error =
            fmax(worst->error, fabs(b->stored[l] + b->lost[l] - start.stored[l] - start.lost[l] - work[l]) /
                                   fmax(largest[l], 1e3));
}

/* No step of any path takes energy from what was lost. */
static void random_paths_dissipate(void **state) {
    (void)state;
    for (int n = 0; n < VARIANTS; n++) {
        foam_variant v;
        static sf_law_batch b;
        path_errors worst = {0};
        double largest[SF_LANES] = {0};
        uint64_t seed = 7 + (uint64_t)n;
        make(&v, n, &REMEMBERS);
        foam_reset(&b);
        for (int k = 0; k < SEGMENTS; k++) {
            if (k % 50 == 0) { /* a new point */
                foam_reset(&b);
                memset(largest, 0, sizeof largest);
            }
            segment(&v.law, &seed, largest, &b, &worst);
            if (k % 7 == 0) { /* q rises under load, too */
                v.law.law->rest(v.law.numbers, 100, b.history);
                v.law.law->update(v.law.numbers, 0, &b);
            }
        }
        print_message("law %d: gain %.2g, jump %.2g, error %.2g\n", n, worst.gain, worst.jump, worst.error);
        assert_true(worst.gain < 1e-13);
        assert_true(worst.jump < 1e-3);  /* ALPHA 0.4: (1e-9)^0.4 */
        assert_true(worst.error < 0.05); /* of 40 steps of a segment; a fine path is below */
        sf_material_law_free(&v.law);
    }
}

/* Stored and lost energy are the work of the stresses, through reversals, rests and growths of the largest W.
 */
static void energies_are_the_work(void **state) {
    (void)state;
    static const double turn[] = {0.6, 0.2, 0.35, 0.1, 0.65, 0, 0.5, 0.3, 0.7, 0.01, 0.695, 0.3};
    enum { FINE = 20000 };
    for (int n = 0; n < VARIANTS; n++) {
        foam_variant v;
        static sf_law_batch b;
        double work = 0, at = 0, worst = 0, largest = 0;
        make(&v, n, &REMEMBERS);
        foam_reset(&b);
        for (size_t t = 0; t < sizeof turn / sizeof *turn; t++) {
            for (int k = 1; k <= FINE; k++) {
                double f[9], before = b.p[0][0], strain = at + (turn[t] - at) * k / FINE, old = b.f[0][0];
                foam_uniaxial(1 - strain, f);
                const point_law law = {v.law.law->update, v.law.numbers, 0, false};
                point_law_step(&law, 0, f, &b);
                work += 0.5 * (before + b.p[0][0]) * (b.f[0][0] - old);
                largest = larger(largest, b.energy[0]);
                worst = larger(worst, fabs(b.stored[0] + b.lost[0] - work));
            }
            at = turn[t];
            v.law.law->rest(v.law.numbers, 10, b.history);
            work -= b.stored[0] + b.lost[0]; /* what a rest under load does is not the law's matter */
            v.law.law->update(v.law.numbers, 0, &b);
            work += b.stored[0] + b.lost[0];
        }
        if (!(worst < 1e-5 * largest))
            fail_msg("law %d: energies and work differ by %.3g of the largest", n, worst / largest);
        sf_material_law_free(&v.law);
    }
}

/* At random states below the largest W, within the elastic range, at its ends and beyond. */
static void bounds_cover_the_tangent(void **state) {
    (void)state;
    for (int n = 0; n < VARIANTS; n++) {
        foam_variant v;
        uint64_t seed = 11;
        make(&v, n, &REMEMBERS);
        const point_law law = {v.law.law->update, v.law.numbers, 0, n % 2 == 1};
        const sf_foam_options *options = v.law.numbers;
        double share = (1 - options->hu) * options->unloading.whole;
        for (int k = 0; k < 400; k++) {
            sf_law_batch b, after;
            double f[9], tangent[81];
            point_deformation(&seed, 0.3, 1.1, f);
            foam_reset(&b);
            point_law_step(&law, 0, f, &b);
            double *peak = &b.history[SF_FOAM_PEAK][0], *back = &b.history[SF_FOAM_MEMORY][0];
            *peak *= point_random(&seed, 1.1, 4);
            *back = share * *peak; /* unloads from there */
            after = b;
            law.update(law.numbers, 0, &after);
            *back = after.history[SF_FOAM_MEMORY][0] -
                    SF_MEMORY_ELASTIC * share * *peak * point_random(&seed, -0.1, 0.5);
            memcpy(b.f_old, b.f, sizeof b.f);
            after = b;
            point_law_tangent(&law, 0, &b, tangent);
            law.update(law.numbers, 0, &after);
            foam_assert_bounds(&after, tangent);
        }
        sf_material_law_free(&v.law);
    }
}

static void a_foam_without_memory_keeps_no_more(void **state) {
    (void)state;
    static const sf_memory none = {.start = 1};
    for (int n = 0; n < VARIANTS; n++) {
        foam_variant v, plain;
        make(&v, n, &REMEMBERS);
        make(&plain, n, &none);
        assert_int_equal(sf_material_history_rows(&plain.material), 1);
        assert_int_equal(sf_material_history_rows(&v.material), 5);
        sf_material_law_free(&v.law);
        sf_material_law_free(&plain.law);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(cycles_follow_the_closed_form),
        cmocka_unit_test(inner_loops_close),
        cmocka_unit_test(recovery_is_one_of_time),
        cmocka_unit_test(random_paths_dissipate),
        cmocka_unit_test(energies_are_the_work),
        cmocka_unit_test(bounds_cover_the_tangent),
        cmocka_unit_test(a_foam_without_memory_keeps_no_more),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
