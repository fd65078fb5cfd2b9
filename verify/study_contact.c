/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contact and base reaction: Hertz's sphere, a plate dropped on a column, friction, the momentum of the pad,
 * and the energy that contact loses. */
#include "extreme.h"
#include "base/units.h"
#include "column.h"
#include "formula.h"
#include "model_fixture.h"
#include "order.h"
#include "base/program.h"
#include "solver/step.h"
#include "study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double PI = 3.14159265358979323846;

/* ---- Hertz ---- */

enum { LEVELS = 5, DEPTHS = 4 };

/* Rigid sphere on an elastic layer bonded to its base, nu = 0: Hertz with the correction of Dimitriadis et
 * al., Biophys. J. 82 (2002) 2798-2810, doi:10.1016/S0006-3495(02)75620-8, in powers of sqrt(R depth) /
 * thickness. */
static double hertz(double modulus, double radius, double thickness, double depth) {
    const double a = -1.2876, b = 0.6387;
    double x = sqrt(radius * depth) / thickness, cube = a * a * a;
    double series = 1 - 2 * a / PI * x + 4 * a * a / (PI * PI) * x * x -
                    8 / pow(PI, 3) * (cube + 4 * PI * PI / 15 * b) * pow(x, 3) +
                    16 * a / pow(PI, 4) * (cube + 3 * PI * PI / 5 * b) * pow(x, 4);
    return 4.0 / 3 * modulus * sqrt(radius) * pow(depth, 1.5) * series;
}

/* Quarter of a block 400 x 400 x 200 mm of the linear foam under a sphere of radius 200 mm. Masses are free
 * in a static problem: they are chosen so that every node has about the same highest frequency. */
static void build_halfspace(double spacing_mm, fixture *f) {
    char file[1200], spacing[80];
    sf_case c;
    sf_mesh mesh;
    sf_surface surface;
    snprintf(file, sizeof file, "geometry.file=%s", fixture_source("verify/geo/halfspace.geo"));
    snprintf(spacing, sizeof spacing, "geometry.parameters.fine_spacing=%.6f", spacing_mm);
    fixture_case(&c, (const char *const[]){file, spacing, "geometry.parameters.thickness=200.0",
                                           "geometry.parameters.zone_side=30.0",
                                           "geometry.parameters.outer_spacing=40.0",
                                           "geometry.missile_parameters.diameter=400.0",
                                           "geometry.missile_parameters.element_size=40.0", NULL});
    fixture_make_linear(&c);
    c.missile_card.gravity = 0;
    c.run.step_limit = 1;
    c.run.energy_limit = 1e9; /* the missile's motion is prescribed, the pad's is damped */
    fixture_geometry(&c, &mesh, &surface);
    fixture_build(&c, &mesh, &surface, f);
    double smallest = INFINITY;
    for (int64_t i = 0; i < f->model.node_count; i++)
        smallest = smaller(smallest, f->model.spacing[i]);
    for (int64_t i = 0; i < f->model.node_count; i++)
        f->model.mass[i] *= pow(smallest / f->model.spacing[i], 2);
    fixture_start(f);
}

/* Moves the sphere to `depth` and holds it until the pad, slowed down by 6 % a step, is at rest. Returns the
 * force of the whole pad; `*base` is that on the base. */
static double indent(fixture *f, double depth, double *base) {
    enum { RAMP = 40, LEAST = 100, MOST = 2000 };
    sf_state *s = &f->state;
    double from = s->missile.displacement, last = 0;
    for (int step = 0; step < MOST; step++) {
        double left = depth - s->missile.displacement;
        double speed = s->dt_old > 0 ? fmax(0, fmin((depth - from) / RAMP, left)) / s->dt_old : 0;
        s->missile.velocity = speed;
        fixture_step(f);
        s->missile.velocity = fmin(speed, left / s->dt);
        for (int64_t i = 0; i < 3 * f->model.node_count; i++)
            s->v[i] *= 0.94;
        sf_step_advance(&f->model, s);
        double force = s->missile.force[2];
        if (step > LEAST && fabs(force - last) < 1e-6 * force &&
            fabs(s->base_reaction[2] - force) < 5e-4 * force)
            break;
        last = force;
    }
    *base = 4 * s->base_reaction[2];
    return 4 * s->missile.force[2];
}

static void hertz_depths(sf_study *s, double spacing) {
    fixture f;
    FILE *data = sf_study_file(s, "hertz.txt");
    double worst = 0, unbalance = 0;
    build_halfspace(spacing, &f);
    double radius = f.model.missile.sphere_radius, modulus = sf_foam_card_of(&f.model.material[0])->modulus;
    sf_study_text(s,
                  "Spacing %.2f mm, %lld nodes:\n\n| depth, mm | contact radius / spacing | force, N | "
                  "closed form, N | ratio |\n|---|---|---|---|---|\n",
                  spacing, (long long)f.model.node_count);
    for (int k = 0; k < DEPTHS; k++) {
        double a = (5 + 5.0 / 3 * k) * 1e-3, base, force = indent(&f, a * a / radius, &base);
        double depth = f.state.missile.displacement, exact = hertz(modulus, radius, f.model.thickness, depth);
        sf_study_text(s, "| %.4f | %.1f | %.4f | %.4f | %.4f |\n", 1e3 * depth, a / (1e-3 * spacing), force,
                      exact, force / exact);
        worst = larger(worst, fabs(force / exact - 1));
        unbalance = larger(unbalance, fabs(base / force - 1));
        if (data)
            fprintf(data, "%g %g\n", 1e3 * depth, force);
    }
    if (data) {
        fprintf(data, "\n\n");
        for (double depth = 0; depth < 0.52e-3; depth += 0.01e-3)
            fprintf(data, "%g %g\n", 1e3 * depth, hertz(modulus, radius, f.model.thickness, depth));
        fclose(data);
    }
    sf_study_text(s, "\n");
    sf_study_check(s, worst, 0, 0.03, "Hertz, %.2f mm: largest relative error of the force", spacing);
    sf_study_check(s, unbalance, 0, 1e-3, "base reaction against missile force at rest");
    fixture_free(&f);
}

static void hertz_study(sf_study *s) {
    static const double spacing[LEVELS] = {5, 2.5, 5.0 / 3, 1.25, 1};
    double error[LEVELS], ratio[LEVELS];
    sf_study_text(
        s,
        "### Rigid sphere on a thick linear pad\n\nA sphere of radius 200 mm indents a quarter of a block of 400 "
        "× 400 × 200 mm of a linear foam (ν = 0), bonded at its base, by 0.5 mm (contact radius a = 10 mm), and "
        "rests. Reference: Hertz with the finite-thickness series of Dimitriadis et al. 2002 (a correction of 4 "
        "%% at that depth).\n\n");
    sf_study_text(s, "| spacing h, mm | a/h | force / closed form |\n|---|---|---|\n");
    for (int k = 0; k < LEVELS; k++) {
        fixture f;
        double base;
        build_halfspace(spacing[k], &f);
        double radius = f.model.missile.sphere_radius, force = indent(&f, 1e-4 / radius, &base);
        ratio[k] = force / hertz(sf_foam_card_of(&f.model.material[0])->modulus, radius, f.model.thickness,
                                 f.state.missile.displacement);
        error[k] = fabs(ratio[k] - 1);
        sf_study_text(s, "| %.3f | %.1f | %.4f |\n", spacing[k], 10 / spacing[k], ratio[k]);
        fixture_free(&f);
    }
    sf_study_text(s, "\n");
    bool falling = true;
    for (int k = 1; k < LEVELS; k++)
        falling = falling && error[k] < error[k - 1];
    sf_study_check(s, falling, 1, 1, "Hertz: error falls at every refinement (1 = yes)");
    sf_study_check(s, sf_order_fit(LEVELS, spacing, error, LEVELS), 1, INFINITY,
                   "Hertz: order of the force's error in h");
    sf_study_check(s, error[LEVELS - 1], 0, 0.03, "Hertz: error at the finest spacing");
    hertz_depths(s, 1);
    sf_study_plot(s, "hertz.png", "Sphere on a thick linear pad: force against depth",
                  "set xlabel 'depth (mm)'\nset ylabel 'force (N)'\nset key left top\n"
                  "plot 'contact-hertz.txt' index 1 with lines lw 2 title 'Hertz, finite thickness', "
                  "'' index 0 with points pt 7 ps 2 title 'softfall, 1 mm'");
}

/* ---- plate on a column ---- */

/* A block as wide as the column needs not to buckle under the plate, which holds it laterally too. */
static void build_column(const sf_column *column, const fixture_block *block, fixture *f) {
    static const double still = 0, one = 1;
    sf_case c;
    fixture_case(&c, NULL);
    fixture_make_elastic(&c);
    fixture_hold(&c, (const char *const[]){"base", NULL});
    sf_formula_table(sf_foam_card_of(&c.material), 1, &still, &one);
    sf_foam_card_of(&c.material)->shared.density = column->foam->shared.density;
    sf_foam_card_of(&c.material)->shared.hysteresis_hu = column->foam->shared.hysteresis_hu;
    sf_foam_card_of(&c.material)->shared.hysteresis_shape = column->foam->shared.hysteresis_shape;
    sf_foam_card_of(&c.material)->shared.maxwell_modulus = column->foam->shared.maxwell_modulus;
    sf_foam_card_of(&c.material)->shared.maxwell_rate = column->foam->shared.maxwell_rate;
    c.missile_card.mass = column->mass;
    c.missile_card.speed = column->speed;
    c.missile_card.gravity = column->gravity;
    c.missile_card.friction = 10;
    fixture_under_plate(&c, block, 1, 0, 0, f);
    fixture_start(f);
}

/* Result of a drop against a reference force history. */
typedef struct comparison {
    double peak, reference_peak; /* N */
    double largest, rms;         /* difference over the contact, relative to the reference's peak */
    double raw;                  /* the largest of the unfiltered curves */
    double energy;               /* largest energy error */
} comparison;

/* The solver's force until the plate moves up without contact. */
static sf_series run_column(fixture *f, double end, double *energy) {
    enum { ROOM = 1 << 17 };
    sf_error err = SF_ERROR_INIT;
    sf_series force;
    sf_state *s = &f->state;
    if (sf_series_create(ROOM, &force, &err) != SF_OK)
        exit(sf_error_report(&err, "study_contact"));
    for (force.count = 0; force.count < ROOM && s->time < end; force.count++) {
        fixture_step(f);
        force.time[force.count] = s->time;
        force.value[force.count] = s->missile.force[2];
        sf_step_advance(&f->model, s);
    }
    *energy = s->ledger.largest_error;
    return force;
}

/* CFC 1000 of a force that begins at first contact, with a millisecond of silence before it. */
static sf_series filtered(const sf_series *force) {
    sf_error err = SF_ERROR_INIT;
    sf_series before = {0}, uniform = {0}, out = {0};
    if (sf_signal_lead_in(force, 1e-3, 0, &before, &err) != SF_OK ||
        sf_signal_resample(&before, SF_SIGNAL_RATE, &uniform, &err) != SF_OK ||
        sf_signal_filter_cfc(&uniform, 1000, &out, &err) != SF_OK)
        exit(sf_error_report(&err, "study_contact"));
    sf_series_free(&before);
    sf_series_free(&uniform);
    return out;
}

static comparison compare(const sf_series *force, const sf_series *reference, FILE *data) {
    comparison c = {0};
    sf_series a = filtered(force), b = filtered(reference);
    double square = 0, end = reference->time[reference->count - 1];
    int64_t used = 0;
    for (int64_t i = 0; i < b.count; i++)
        c.reference_peak = larger(c.reference_peak, b.value[i]);
    for (int64_t i = 0; i < a.count && a.time[i] <= end; i++, used++) {
        double t = a.time[i], difference = fabs(a.value[i] - sf_series_at(&b, t)) / c.reference_peak;
        c.peak = larger(c.peak, a.value[i]);
        c.largest = larger(c.largest, difference);
        square += difference * difference;
        if (data && i % 5 == 0)
            fprintf(data, "%g %g %g\n", 1e3 * t, a.value[i], sf_series_at(&b, t));
    }
    for (int64_t i = 0; i < force->count && force->time[i] <= end; i++)
        c.raw =
            larger(c.raw, fabs(force->value[i] - sf_series_at(reference, force->time[i])) / c.reference_peak);
    if (data)
        fprintf(data, "\n\n");
    c.rms = sqrt(square / (double)used);
    sf_series_free(&a);
    sf_series_free(&b);
    return c;
}

static void check_column(sf_study *s, const comparison *c, const char *what) {
    sf_study_check(s, c->peak / c->reference_peak, 0.99, 1.01, "%s: largest force / reference", what);
    sf_study_check(s, c->largest, 0, 0.01, "%s: largest difference of the force / peak (CFC 1000)", what);
    sf_study_check(s, c->rms, 0, 0.01, "%s: root mean square of this difference", what);
    sf_study_check(s, c->energy, 0, 1e-3, "%s: energy error", what);
}

/* Runs the plate on a column of one foam against the reference, and releases it. `title` begins the sentence,
 * `name` the checks. */
static void one_column(sf_study *s, const sf_column *column, const fixture_block *block, sf_series *reference,
                       FILE *data, const char *title, const char *name) {
    fixture f;
    double energy, end = reference->time[reference->count - 1];
    build_column(column, block, &f);
    sf_series force = run_column(&f, end, &energy);
    comparison c = compare(&force, reference, data);
    c.energy = energy;
    sf_study_text(s,
                  "%s: peak %.1f g, contact %.2f ms, %lld steps; largest difference of the "
                  "unfiltered force %.2f %% of the peak.\n\n",
                  title, c.peak / column->mass / SF_STANDARD_GRAVITY, 1e3 * end, (long long)force.count,
                  100 * c.raw);
    check_column(s, &c, name);
    sf_series_free(reference);
    sf_series_free(&force);
    fixture_free(&f);
}

static void plate_study(sf_study *s) {
    sf_error err = SF_ERROR_INIT;
    sf_foam_card light = {.shared.density = 0.35,
                          .modulus = 0.4136e6,
                          .shared.hysteresis_hu = 0.01,
                          .shared.hysteresis_shape = 1,
                          .shared.hysteresis_alpha = 1,
                          .shared.maxwell_rate = 5000};
    sf_foam_card heavy = light;
    heavy.shared.density = 35;
    heavy.shared.maxwell_modulus = 3.43e6;
    sf_column column = {.height = 0.05, .speed = 4.5, .gravity = SF_STANDARD_GRAVITY, .foam = &light};
    sf_series reference;
    FILE *data = sf_study_file(s, "plate.txt");
    sf_study_text(
        s,
        "### Plate on a column\n\nA plate as wide as the pad, of 460 kg/m², falls at 4.5 m/s on 50 mm of foam with "
        "curve and hysteresis: one of 0.35 kg/m³, whose inertia is negligible (mass of pad / plate %.1e; the first "
        "wave carries ρcv = %.1f kPa), against the ordinary differential equation; one of 35 kg/m³ with the Maxwell "
        "branch against a one-dimensional wave model of 200 elements.\n\n",
        0.35 * 0.05 / 460, 1e-3 * column.speed * sqrt(0.35 * sf_formula_slope(0)));
    const fixture_block coarse = {.cells = {6, 6, 4}, .spacing = 0.0125};
    const fixture_block fine = {.cells = {6, 6, 20}, .spacing = 0.0125, .flatness = 0.2};
    column.area = 0.075 * 0.075;
    column.mass = 460 * column.area;
    if (sf_column_quasi_static(&column, 2e-6, &reference, &err) != SF_OK)
        sf_study_fail(s, &err);
    one_column(s, &column, &coarse, &reference, data, "Light foam", "light foam");
    column.foam = &heavy;
    if (sf_column_wave(&column, 200, 0.1e-6, 20, &reference, &err) != SF_OK)
        sf_study_fail(s, &err);
    one_column(s, &column, &fine, &reference, data, "Foam of 35 kg/m³", "35 kg/m³");
    if (data)
        fclose(data);
    sf_study_plot(
        s, "plate.png",
        "Plate on a column: force per area against time, solver and one-dimensional references",
        "set xlabel 'time (ms)'\nset ylabel 'force (N)'\nset multiplot layout 2,1\n"
        "plot 'contact-plate.txt' index 0 every 8 using 1:2 with points pt 6 title '0.35 kg/m3', '' index "
        "0 using 1:3 with lines lw 2 title 'without inertia'\n"
        "plot 'contact-plate.txt' index 1 every 8 using 1:2 with points pt 6 title '35 kg/m3', '' index 1 "
        "using 1:3 with lines lw 2 title 'wave model'\n"
        "unset multiplot");
}

/* ---- friction ---- */

static const double TILT = 45; /* degrees between the plate's motion and its normal */
static const double PAD_HEIGHT = 0.015, PAD_WIDTH = 0.11; /* m */
static const double PRESS = 0.003, PRESS_SPEED = 0.015;   /* strain at the end; m s-1 */

/* A wide, thin block of the linear foam under a heavy plate that moves obliquely; the block starts with the
 * motion that it would have if it stuck, so that nothing rings. */
static void build_oblique(double friction, fixture *f) {
    const fixture_block block = {.cells = {22, 22, 3}, .spacing = PAD_HEIGHT / 3};
    sf_case c;
    fixture_case(&c, NULL);
    fixture_make_linear(&c);
    fixture_hold(&c, (const char *const[]){"base", NULL});
    c.missile_card.mass = 1e6;
    c.missile_card.speed = PRESS_SPEED;
    c.missile_card.gravity = 0;
    c.missile_card.friction = friction;
    fixture_slant(&c, TILT * PI / 180);
    c.run.energy_limit = 1e9;
    fixture_under_plate(&c, &block, 1, 0.5 * PAD_WIDTH, 0.5 * PAD_WIDTH, f);
    fixture_start(f);
    for (int64_t i = 0; i < 3 * f->model.node_count; i++)
        f->state.v[i] =
            PRESS_SPEED * f->model.missile.direction[i % 3] * f->model.position[3 * (i / 3) + 2] / PAD_HEIGHT;
}

typedef struct sliding {
    double ratio;   /* tangential over normal force of the plate */
    double centre;  /* the same of the contact point in the middle, mean of the second half of the motion */
    double sliding; /* part of the points on the bound */
    double beyond;  /* largest |q_t| / (mu p) - 1 */
    double slip;    /* m, the middle point's motion against the plate */
    double work;    /* J, of friction, by the ledger */
} sliding;

/* The contact point in the middle of the block. */
static int64_t middle_point(const sf_model *m) {
    for (int64_t c = 0; c < m->contact_count; c++) {
        const double *x = &m->position[3 * (int64_t)m->contact_node[c]];
        if (hypot(x[0] - 0.5 * PAD_WIDTH, x[1] - 0.5 * PAD_WIDTH) < 1e-6)
            return c;
    }
    abort();
}

static sliding press_obliquely(double friction) {
    fixture f;
    build_oblique(friction, &f);
    sf_state *s = &f.state;
    const sf_model *m = &f.model;
    const double *e = m->missile.direction;
    double end = PRESS * PAD_HEIGHT / -e[2], across = 0, along = 0;
    int64_t middle = middle_point(m), bound = 0, points = 0;
    const double *x = &m->position[3 * (int64_t)m->contact_node[middle]], *q = &s->contact.force[3 * middle];
    sliding r = {.beyond = -1};
    while (s->missile.displacement < end) {
        fixture_step(&f);
        if (s->missile.displacement > 0.5 * end) {
            across += hypot(q[0], q[1]);
            along -= q[2];
        }
        r.slip = fabs(s->contact.position[3 * middle] - x[0] - s->missile.displacement * e[0]);
        for (int64_t c = 0; c < m->contact_count; c++) {
            const double *force = &s->contact.force[3 * c];
            if (force[2] < 0)
                r.beyond = larger(r.beyond, hypot(force[0], force[1]) / (-friction * force[2]) - 1);
        }
        sf_step_advance(m, s);
    }
    for (int64_t c = 0; c < m->contact_count; c++) {
        const double *force = &s->contact.force[3 * c];
        points += force[2] < 0;
        bound += force[2] < 0 && hypot(force[0], force[1]) > -(1 - 1e-6) * friction * force[2];
    }
    r.centre = across / along;
    r.sliding = (double)bound / (double)points;
    r.ratio = hypot(s->missile.force[0], s->missile.force[1]) / s->missile.force[2];
    r.work = s->ledger.friction;
    fixture_free(&f);
    return r;
}

static void friction_study(sf_study *s) {
    static const double coefficients[] = {0.1, 0.3, 0.45, 0.6, 1};
    const double stuck = 0.5 * tan(TILT * PI / 180);
    sf_study_text(
        s,
        "### Friction\n\nA plate moves at %g degrees into a wide block (110 × 110 × 15 mm) of the linear "
        "foam, to 0.3 %% strain. If it sticks, tangential over normal force away from the edges is half "
        "the tangent of that angle: %.2f.\n\n| friction coefficient | tangential / normal force | in the "
        "middle | points on the bound | slip in the middle, mm | friction work, J "
        "|\n|---|---|---|---|---|---|\n",
        TILT, stuck);
    double beyond = -1, sliding_error = 0, centre_error = 0, slip = 0, least_work = INFINITY;
    for (size_t k = 0; k < sizeof coefficients / sizeof coefficients[0]; k++) {
        double mu = coefficients[k];
        sliding r = press_obliquely(mu);
        sf_study_text(s, "| %.2f | %.5f | %.5f | %.0f %% | %.2e | %.3e |\n", mu, r.ratio, r.centre,
                      100 * r.sliding, 1e3 * r.slip, r.work);
        beyond = larger(beyond, r.beyond);
        if (mu < stuck) {
            sliding_error = larger(sliding_error, fabs(r.centre / mu - 1));
            least_work = smaller(least_work, r.work);
        } else {
            centre_error = larger(centre_error, fabs(r.centre / stuck - 1));
            slip = larger(slip, r.slip);
        }
    }
    sf_study_text(s, "\n");
    sf_study_check(s, beyond, -INFINITY, 1e-6,
                   "largest tangential force / its bound - 1, all points and coefficients");
    sf_study_check(s, sliding_error, 0, 0.01,
                   "sliding (0.1, 0.3, 0.45): middle point's ratio against the coefficient, relative error");
    sf_study_check(s, least_work, 1e-8, INFINITY, "sliding: friction work, J");
    sf_study_check(s, centre_error, 0, 0.01,
                   "sticking (0.6, 1): middle point's ratio against the closed form, relative error");
    sf_study_check(s, slip, 0, 1e-9, "sticking: slip of the middle point, m");
}

/* ---- momentum and energy of a drop ---- */

typedef struct drop_record {
    double imbalance; /* largest, over the largest force of the missile */
    double reaction;  /* N, largest force on the base, whole pad */
    double force;     /* N, of the missile */
    double lost;      /* contact's share of the internal energy at its maximum */
} drop_record;

static drop_record run_drop(double spacing, FILE *data) {
    char fine[80], outer[80];
    drop_record r = {0};
    fixture f;
    snprintf(fine, sizeof fine, "geometry.parameters.fine_spacing=%.6f", spacing);
    snprintf(outer, sizeof outer, "geometry.parameters.outer_spacing=%.6f", 2 * spacing);
    fixture_pad((const char *const[]){fine, outer, NULL}, &f);
    fixture_start(&f);
    sf_state *s = &f.state;
    const sf_model *m = &f.model;
    double old = 0, internal = 0;
    while (s->time < 22e-3) {
        double momentum = 0, dt = s->dt_old;
        fixture_step(&f);
        dt = 0.5 * (dt + s->dt);
        for (int64_t i = 0; i < m->node_count; i++)
            momentum += m->mass[i] * s->v[3 * i + 2];
        /* The missile pushes the pad down, the base holds it up; the rest is inertia. */
        r.imbalance =
            larger(r.imbalance, fabs((momentum - old) / dt + s->missile.force[2] - s->base_reaction[2]));
        r.reaction = larger(r.reaction, 4 * s->base_reaction[2]);
        r.force = larger(r.force, 4 * s->missile.force[2]);
        if (sf_ledger_internal(&s->ledger) > internal) {
            internal = sf_ledger_internal(&s->ledger);
            r.lost = s->ledger.contact / internal;
        }
        if (data)
            fprintf(data, "%g %g %g\n", 1e3 * s->time, 4 * s->missile.force[2], 4 * s->base_reaction[2]);
        old = momentum;
        sf_step_advance(m, s);
    }
    r.imbalance *= 4 / r.force;
    fixture_free(&f);
    return r;
}

static void drop_study(sf_study *s) {
    enum { SIZES = 3 };
    static const double spacing[SIZES] = {20, 10, 20.0 / 3};
    double lost[SIZES], imbalance = 0;
    sf_study_text(
        s,
        "### Base reaction and energy of the 50 mm drop at 4.5 m/s\n\nIn every step the missile's force, the "
        "base's reaction and the rate of change of the pad's momentum balance; contact loses energy by the "
        "inelastic impact of surface nodes.\n\n| spacing, mm | largest missile force, N | largest base reaction, "
        "N | lost in contact / internal energy |\n|---|---|---|---|\n");
    for (int k = 0; k < SIZES; k++) {
        FILE *data = k == 1 ? sf_study_file(s, "drop.txt") : NULL;
        drop_record r = run_drop(spacing[k], data);
        if (data)
            fclose(data);
        lost[k] = r.lost;
        imbalance = larger(imbalance, r.imbalance);
        sf_study_text(s, "| %.2f | %.1f | %.1f | %.2e |\n", spacing[k], r.force, r.reaction, r.lost);
    }
    sf_study_text(s, "\n");
    sf_study_check(s, imbalance, 0, 1e-6,
                   "missile force + base reaction + inertia, largest of all steps / largest force");
    sf_study_check(s, lost[SIZES - 1], 0, 1e-3,
                   "energy lost in contact at the finest spacing / internal energy");
    sf_study_check(s, sf_order_fit(SIZES, spacing, lost, SIZES), 0.9, INFINITY,
                   "order in h of the energy lost in contact");
    sf_study_plot(s, "drop.png", "Missile force and base reaction of the drop, 10 mm",
                  "set xlabel 'time (ms)'\nset ylabel 'force (N)'\n"
                  "plot 'contact-drop.txt' using 1:2 with lines lw 2 title 'missile', '' using 1:3 with "
                  "lines lw 2 title 'base'");
}

int main(int argc, char **argv) {
    sf_study s;
    sf_study_begin(&s, "contact", "Contact and base reaction", argc, argv);
    hertz_study(&s);
    plate_study(&s);
    friction_study(&s);
    drop_study(&s);
    return sf_study_end(&s);
}
