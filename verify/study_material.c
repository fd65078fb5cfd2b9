/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The foam law in homogeneous compression of a cube, run by the solver's own steps: a heavy plate presses a
 * block on a smooth base at constant speed and withdraws. Domains, missile and base are compared with closed
 * forms of the curve, of hysteresis and of every viscous term. */
#include "extreme.h"
#include "formula.h"
#include "model_fixture.h"
#include "solver/step.h"
#include "study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CELLS = 3, LEGS = 8 };
static const double SIDE = 0.3;         /* m, of the cube */
static const double FLOOR = 1e3;        /* Pa: errors are relative to the stress, but to this at least */
static const double STRAIN_STEP = 2e-4; /* largest, of a time step */

/* What a pressing is to do: strains at which the plate turns, one leg after the other, at a constant rate. */
typedef struct pressing {
    double rate; /* s-1, nominal */
    int legs;
    double turn[LEGS]; /* strain at the end of each leg */
} pressing;

/* Where a pressing stands, for the closed forms. */
typedef struct place {
    double time, strain; /* s, - */
    double velocity;     /* s-1, of the stretch: negative while compressing */
    int leg;
    double leg_time;       /* s, since the leg began */
    double leg_stretch;    /* -, at its begin */
    double largest_strain; /* - */
    double size;           /* Pa, out: sum of the sizes of the stress's parts */
} place;

/* The nominal stress, compression positive. */
typedef double stress_law(const sf_foam_card *card, place *p, double *memory);

/* Largest errors over a pressing, and what a plot needs. */
typedef struct outcome {
    double domains, plate, base; /* relative errors of the stress */
    double uneven;               /* largest difference of F between domains */
    double retrace;              /* largest relative difference of the third leg's stress from the second's */
    double work_in, work_out;    /* J m-3, done on the cube by the plate while it goes down, and returned */
} outcome;

static double relative(double value, double expected, double size) {
    return fabs(value - expected) / fmax(size, FLOOR);
}

/* A jittered cube on rollers under a plate of a thousand tonnes, already moving as one with it. `card` sets
 * the losses. */
static void build_cube(const sf_foam_card *card, int curves, const double *rates, const double *factors,
                       double rate, fixture *f) {
    const fixture_block block = {
        .cells = {CELLS, CELLS, CELLS}, .spacing = SIDE / CELLS, .jitter = 0.2, .surface_jitter = 0.15};
    sf_case c;
    fixture_case(&c, NULL);
    fixture_make_elastic(&c);
    fixture_hold(&c, (const char *const[]){NULL});
    c.sliding_count = 1;
    snprintf(c.sliding_group[0], SF_CASE_NAME_SIZE, "base");
    sf_formula_table(sf_foam_card_of(&c.material), curves, rates, factors);
    sf_foam_card_of(&c.material)->shared.hysteresis_hu = card->shared.hysteresis_hu;
    sf_foam_card_of(&c.material)->shared.hysteresis_shape = card->shared.hysteresis_shape;
    sf_foam_card_of(&c.material)->shared.maxwell_modulus = card->shared.maxwell_modulus;
    sf_foam_card_of(&c.material)->shared.maxwell_rate = card->shared.maxwell_rate;
    sf_foam_card_of(&c.material)->shared.kelvin_viscosity = card->shared.kelvin_viscosity;
    sf_foam_card_of(&c.material)->shared.damp = card->shared.damp;
    sf_foam_card_of(&c.material)->shared.damp_length = card->shared.damp_length;
    sf_foam_card_of(&c.material)->shared.rate_filter_time = card->shared.rate_filter_time;
    c.missile_card.mass = 1e6;
    c.missile_card.speed = rate * SIDE;
    c.missile_card.gravity = 0;
    c.run.energy_limit = 1e9; /* the motion is prescribed: the ledger does not see who does the work */
    c.run.step_limit = STRAIN_STEP / rate;
    fixture_under_plate(&c, &block, 1, 0, 0, f);
    fixture_start(f);
}

/* The cube moves with the plate: v = -+ speed z / SIDE. */
static void set_motion(fixture *f, double speed) {
    f->state.missile.velocity = speed;
    for (int64_t i = 0; i < f->model.node_count; i++)
        f->state.v[3 * i + 2] = -speed * f->model.position[3 * i + 2] / SIDE;
}

static void compare(const fixture *f, double expected, double size, outcome *o) {
    const sf_state *s = &f->state;
    double area = SIDE * SIDE;
    for (int64_t i = 0; i < f->model.node_count; i++) {
        o->domains = larger(o->domains, relative(-s->stress[9 * i + 8] / f->model.volume[i], expected, size));
        for (int k = 0; k < 9; k++)
            o->uneven = larger(o->uneven, fabs(s->f[9 * i + k] - s->f[k]));
    }
    o->base = larger(o->base, relative(s->base_reaction[2] / area, expected, size));
    if (expected > 0) /* contact does not pull */
        o->plate = larger(o->plate, relative(s->missile.force[2] / area, expected, size));
}

/* Stress of the second leg by strain (descending), to compare the third with. */
typedef struct track {
    int count;
    double strain[8192], stress[8192];
} track;

static double track_error(const track *t, double strain, double stress) {
    for (int k = 1; k < t->count; k++)
        if (t->strain[k] <= strain && strain <= t->strain[k - 1]) {
            double x = (strain - t->strain[k]) / (t->strain[k - 1] - t->strain[k]);
            return relative(stress, t->stress[k] + x * (t->stress[k - 1] - t->stress[k]), stress);
        }
    return 0;
}

static void follow(track *t, int leg, double strain, double stress, outcome *o) {
    if (leg == 1 && t->count < 8192) {
        t->strain[t->count] = strain;
        t->stress[t->count++] = stress;
    } else if (leg == 2) {
        o->retrace = larger(o->retrace, track_error(t, strain, stress));
    }
}

/* At the end of a leg: true if the plate turns or goes on into the next one. */
static bool leg_ends(const pressing *program, place *p, double stretch) {
    if ((p->strain - program->turn[p->leg]) * p->velocity > -1e-12 * program->rate)
        return false;
    p->leg++;
    p->leg_time = p->time;
    p->leg_stretch = stretch;
    if (p->leg < program->legs)
        p->velocity = program->turn[p->leg] > p->strain ? -program->rate : program->rate;
    return true;
}

/* Runs the pressing and compares at every step with the law, compression positive. */
static outcome press(fixture *f, const pressing *program, stress_law *law, FILE *data) {
    sf_state *s = &f->state;
    outcome o = {0};
    static track second;
    place p = {.velocity = program->turn[0] > 0 ? -program->rate : program->rate, .leg_stretch = 1};
    double memory[2] = {0}, old = 0, old_strain = 0;
    second.count = 0;
    while (p.leg < program->legs) {
        set_motion(f, -p.velocity * SIDE);
        fixture_step(f);
        p.time = s->time;
        p.strain = 1 - s->f[8];
        p.largest_strain = larger(p.largest_strain, p.strain);
        double expected = law(sf_foam_card_of(&f->model.material[0]), &p, memory),
               stress = s->missile.force[2] / (SIDE * SIDE);
        compare(f, expected, p.size, &o);
        follow(&second, p.leg, p.strain, stress, &o);
        *(p.velocity < 0 ? &o.work_in : &o.work_out) += 0.5 * (stress + old) * fabs(p.strain - old_strain);
        old = stress;
        old_strain = p.strain;
        if (data)
            fprintf(data, "%g %g %g\n", p.strain, -1e-3 * s->stress[8] / f->model.volume[0], 1e-3 * expected);
        if (leg_ends(program, &p, s->f[8]))
            memory[0] = memory[1];
        set_motion(f, -p.velocity * SIDE);
        sf_step_advance(&f->model, s);
    }
    if (data)
        fprintf(data, "\n\n");
    return o;
}

/* ---- closed forms ---- */

static double hysteretic(const sf_foam_card *card, place *p, double *memory) {
    (void)memory;
    double stress = sf_formula_stress(p->strain);
    if (card->shared.hysteresis_hu < 1 && p->strain < p->largest_strain) {
        double part = sf_formula_energy(p->strain) / sf_formula_energy(p->largest_strain);
        stress *= 1 - (1 - card->shared.hysteresis_hu) * (1 - pow(part, card->shared.hysteresis_shape));
    }
    return p->size = stress;
}

/* Maxwell stress after the leg so far, from what it held at its begin: the convolution integral of E' =
 * lambda lambda' for a constant rate of the stretch. memory[0]: S at the leg's begin; memory[1]: S now. */
static double with_maxwell(const sf_foam_card *card, place *p, double *memory) {
    double b = card->shared.maxwell_rate, t = p->time - p->leg_time, v = p->velocity, from = p->leg_stretch,
           now = from + v * t;
    memory[1] = memory[0] * exp(-b * t) +
                card->shared.maxwell_modulus * v / b * (now - v / b - exp(-b * t) * (from - v / b));
    double stress = hysteretic(card, p, memory);
    p->size += fabs(now * memory[1]);
    return stress - now * memory[1];
}

/* Kelvin: P = eta lambda^2 lambda'; DAMP: P = DAMP rho c L lambda'. At the very start nothing has moved yet.
 */
static double with_viscosity(const sf_foam_card *card, place *p, double *memory) {
    double stretch = 1 - p->strain,
           g = fmax(fmax(card->modulus, sf_formula_slope(0)), sf_formula_slope(p->strain));
    double damp = card->shared.damp * card->shared.damp_length * sqrt(g * card->shared.density);
    double viscous = (card->shared.kelvin_viscosity * stretch * stretch + damp) * p->velocity;
    double stress = hysteretic(card, p, memory);
    p->size += fabs(viscous);
    return stress - (p->time > 0 ? viscous : 0);
}

static const double CURVE_RATE[3] = {20, 100, 500}, CURVE_FACTOR[3] = {1, 1.25, 1.6};

/* Curves at several rates, each a multiple of the slowest: the factor is piecewise linear in ln r behind the
 * filter. */
static double with_rates(const sf_foam_card *card, place *p, double *memory) {
    double r = -p->velocity * -expm1(-p->time / card->shared.rate_filter_time), factor = CURVE_FACTOR[0];
    (void)memory;
    for (int k = 0; k < 2; k++)
        if (r > CURVE_RATE[k])
            factor =
                CURVE_FACTOR[k] + fmin(1, log(r / CURVE_RATE[k]) / log(CURVE_RATE[k + 1] / CURVE_RATE[k])) *
                                      (CURVE_FACTOR[k + 1] - CURVE_FACTOR[k]);
    return p->size = factor * sf_formula_stress(p->strain);
}

static double in_tension(const sf_foam_card *card, place *p, double *memory) {
    if (p->strain >= 0)
        return hysteretic(card, p, memory);
    double stress = fmax(card->modulus * p->strain, -card->tension_cutoff);
    p->size = fabs(stress);
    return stress;
}

/* ---- studies ---- */

static const double ONE = 1, STILL = 0;
static const sf_foam_card ELASTIC = {.shared.hysteresis_hu = 1,
                                     .shared.hysteresis_shape = 1,
                                     .shared.hysteresis_alpha = 1,
                                     .shared.maxwell_rate = 5000,
                                     .shared.rate_filter_time = 1e-4,
                                     .tension_cutoff = 1e30};

static void check_outcome(sf_study *s, const outcome *o, const char *what) {
    sf_study_check(s, o->domains, 0, 1e-3, "%s: stress of every domain, relative error", what);
    sf_study_check(s, fmax(o->plate, o->base), 0, 1e-3,
                   "%s: force of plate and base per area, relative error", what);
    sf_study_check(s, o->uneven, 0, 1e-9, "%s: difference of F between domains", what);
}

static void loading_and_unloading(sf_study *s, FILE *data) {
    static const double cases[][2] = {{0.01, 1}, {0.1, 2}, {0.3, 0.5}, {1, 1}};
    fixture f;
    sf_foam_card card = ELASTIC;
    card.shared.hysteresis_hu = 0.01;
    const pressing back = {100, 2, {0.9, 0.001}}, again = {100, 4, {0.7, 0.2, 0.9, 0.3}};
    build_cube(&card, 1, &STILL, &ONE, back.rate, &f);
    outcome o = press(&f, &back, hysteretic, data);
    check_outcome(s, &o, "to 90 % and back, HU 0.01, SHAPE 1");
    fixture_free(&f);
    build_cube(&card, 1, &STILL, &ONE, again.rate, &f);
    o = press(&f, &again, hysteretic, data);
    check_outcome(s, &o, "70 %, 20 %, 90 %, 30 %");
    sf_study_check(s, o.retrace, 0, 1e-3,
                   "reloading against unloading, relative difference of the plate's force");
    fixture_free(&f);
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        card.shared.hysteresis_hu = cases[k][0];
        card.shared.hysteresis_shape = cases[k][1];
        build_cube(&card, 1, &STILL, &ONE, back.rate, &f);
        o = press(&f, &back, hysteretic, NULL);
        double expected = cases[k][0] + (1 - cases[k][0]) / (1 + cases[k][1]);
        sf_study_check(s, o.work_out / o.work_in, expected - 1e-3, expected + 1e-3,
                       "returned part of the plate's work, HU %g, SHAPE %g (closed form %.4f)", cases[k][0],
                       cases[k][1], expected);
        fixture_free(&f);
    }
}

static void viscous_terms(sf_study *s, FILE *data) {
    static const double rates[] = {1, 10, 100, 300};
    char what[64];
    fixture f;
    sf_foam_card maxwell = ELASTIC, viscous = ELASTIC;
    maxwell.shared.hysteresis_hu = 0.01;
    maxwell.shared.maxwell_modulus = 3.43e6;
    viscous.shared.kelvin_viscosity = 100;
    viscous.shared.damp = 0.35;
    viscous.shared.damp_length = 0.005;
    for (size_t k = 0; k < sizeof rates / sizeof rates[0]; k++) {
        const pressing back = {rates[k], 2, {0.9, 0.2}};
        build_cube(&maxwell, 1, &STILL, &ONE, rates[k], &f);
        outcome o = press(&f, &back, with_maxwell, rates[k] >= 100 ? data : NULL);
        snprintf(what, sizeof what, "Maxwell branch, %g 1/s, 90 %%, 20 %%", rates[k]);
        check_outcome(s, &o, what);
        fixture_free(&f);
    }
    for (size_t k = 1; k < 3; k++) {
        const pressing down = {rates[k], 1, {0.9}};
        build_cube(&viscous, 1, &STILL, &ONE, rates[k], &f);
        outcome o = press(&f, &down, with_viscosity, NULL);
        snprintf(what, sizeof what, "Kelvin viscosity and DAMP, %g 1/s", rates[k]);
        check_outcome(s, &o, what);
        fixture_free(&f);
    }
}

static void rates_and_tension(sf_study *s) {
    static const double rates[] = {10, 45, 300, 600};
    char what[64];
    fixture f;
    sf_foam_card card = ELASTIC;
    for (size_t k = 0; k < sizeof rates / sizeof rates[0]; k++) {
        const pressing down = {rates[k], 1, {0.9}};
        build_cube(&card, 3, CURVE_RATE, CURVE_FACTOR, rates[k], &f);
        outcome o = press(&f, &down, with_rates, NULL);
        snprintf(what, sizeof what, "three curves (20, 100, 500 1/s) at %g 1/s", rates[k]);
        check_outcome(s, &o, what);
        fixture_free(&f);
    }
    const pressing pull = {100, 3, {-0.3, 0.4, -0.1}};
    card.tension_cutoff = 30e3;
    build_cube(&card, 1, &STILL, &ONE, pull.rate, &f);
    sf_foam_card_of(&f.model.material[0])->tension_cutoff = ((sf_foam *)f.operators.law[0].numbers)->cutoff =
        card.tension_cutoff;
    outcome o = press(&f, &pull, in_tension, NULL);
    check_outcome(s, &o, "tension to 30 %, cut-off 30 kPa at 7.3 %");
    fixture_free(&f);
}

int main(int argc, char **argv) {
    sf_study s;
    sf_study_begin(&s, "material", "Material", argc, argv);
    sf_study_text(
        &s,
        "A plate presses a jittered cube of %d × %d × %d cells on a smooth base at constant speed, with the solver's "
        "own time steps. The curve is a table up to 80 %%, then rule H1. Each error is the largest of all steps, "
        "relative to the stress (the sum of the magnitudes of its elastic and viscous parts), or to %g Pa where that "
        "is larger.\n\n",
        CELLS, CELLS, CELLS, FLOOR);
    FILE *data = sf_study_file(&s, "curves.txt");
    loading_and_unloading(&s, data);
    viscous_terms(&s, data);
    rates_and_tension(&s);
    if (data)
        fclose(data);
    sf_study_plot(
        &s, "curves.png",
        "Stress against strain of the pressed cube: loading, unloading, reloading, Maxwell branch",
        "set xlabel 'strain'\nset ylabel 'nominal stress (kPa)'\nset xrange [0:0.9]\nset yrange [-100:1000]\n"
        "set key left top\n"
        "plot for [k=0:3] 'material-curves.txt' index k every 80 using 1:2 with points pt 6 lc k+1 "
        "title word('0-90-0% 0-70-20-90-30% Maxwell,100/s Maxwell,300/s', k+1), "
        "for [k=0:3] '' index k using 1:3 with lines lc k+1 notitle");
    return sf_study_end(&s);
}
