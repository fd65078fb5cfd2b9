/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/cushion.h"

#include "post/figures/signal.h"
#include <math.h>

/* Time steps (s) and how far a step may turn the oscillation of the mass on the foam (rad). */
static const double STEP = 100e-6, FIRST_STEP = 10e-6, LEAST_STEP = 1e-7, LONGEST = 0.2, ANGLE = 0.04;
static const double GROWTH = 1.5; /* of a step over the last one */

/* The mass on its way. */
typedef struct flight {
    const sf_material_law *law;
    double mass, thickness;            /* kg m-2, m */
    double time, depth, speed, stress; /* s, m, m s-1 downwards, Pa */
    double step;                       /* s, the last one */
    double stiffness;                  /* Pa m-1, along it */
    sf_uniaxial point;
} flight;

/* One step of the velocity Verlet scheme; false if the foam collapses in it: then nothing has changed. */
static bool step(flight *f, double dt) {
    double a = SF_STANDARD_GRAVITY - f->stress / f->mass;
    double depth = f->depth + dt * (f->speed + 0.5 * dt * a), moved = depth - f->depth;
    sf_uniaxial point = f->point;
    if (depth >= f->thickness)
        return false;
    double after = depth <= 0 ? 0 : fmax(0, f->law->law->uniaxial(f->law->numbers, dt, depth / f->thickness, &point));
    if (!isfinite(after))
        return false;
    if (fabs(moved) > 1e-3 * dt) /* slower, a difference of stresses is no slope */
        f->stiffness = fabs((after - f->stress) / moved);
    f->point = point;
    f->time += dt;
    f->depth = depth;
    f->speed += 0.5 * dt * (a + SF_STANDARD_GRAVITY - after / f->mass);
    f->stress = after;
    f->step = dt;
    return true;
}

/* The next step, shortened until the foam bears it. */
static sf_status advance(flight *f, sf_error *err) {
    double dt = fmin(STEP, GROWTH * f->step);
    if (f->stiffness > 0)
        dt = fmin(dt, ANGLE * sqrt(f->mass / f->stiffness));
    while (!step(f, dt))
        if ((dt /= 4) < LEAST_STEP)
            return SF_FAIL(err, SF_ERR_NUMERIC, "the foam of the block collapsed at an indentation of %g m",
                           f->depth);
    return SF_OK;
}

static sf_status put_point(const flight *f, sf_series *curve, sf_error *err) {
    size_t n = (size_t)curve->count;
    if (!sf_grow(&curve->time, n, sizeof *curve->time) || !sf_grow(&curve->value, n, sizeof *curve->value))
        return SF_NO_MEMORY(err, "a curve");
    curve->time[curve->count] = f->time;
    curve->value[curve->count++] = f->stress / f->mass / SF_STANDARD_GRAVITY;
    return SF_OK;
}
/* ---- its reading ---- */

static const double FREE_FLIGHT = 5e-3; /* s, before contact, as softfall-post puts it there */
static const double SAMPLING = 20e3;    /* Hz: the columns have no details that need more */

/* Slope at a point by the parabola through its neighbours. */
static double slope_at(const sf_series *c, int64_t i) {
    const double *t = c->time, *v = c->value;
    int64_t last = c->count - 1;
    if (i == 0 || i == last)
        return (v[i + (i == 0)] - v[i - (i != 0)]) / (t[i + (i == 0)] - t[i - (i != 0)]);
    double before = t[i] - t[i - 1], after = t[i + 1] - t[i], left = (v[i] - v[i - 1]) / before,
           right = (v[i + 1] - v[i]) / after;
    return (left * after + right * before) / (before + after);
}

/* Between point i and the next one by the cubic of their slopes: figures then change smoothly with the foam's
 * parameters, wherever the steps fall. */
static double cubic_at(const sf_series *c, int64_t i, double time) {
    double h = c->time[i + 1] - c->time[i], x = (time - c->time[i]) / h, y = 1 - x;
    return c->value[i] * y * y * (1 + 2 * x) + c->value[i + 1] * x * x * (1 + 2 * y) +
           h * x * y * (slope_at(c, i) * y - slope_at(c, i + 1) * x);
}

/* Uniform samples from free flight to the curve's end. */
static sf_status sample(const sf_series *curve, sf_series *uniform, sf_error *err) {
    int64_t before = (int64_t)(FREE_FLIGHT * SAMPLING), i = 0,
            count = before + 1 + (int64_t)(curve->time[curve->count - 1] * SAMPLING);
    SF_TRY(sf_series_create(count, uniform, err));
    for (int64_t k = 0; k < count; k++) {
        double time = uniform->time[k] = (double)(k - before) / SAMPLING;
        while (i < curve->count - 2 && curve->time[i + 1] < time)
            i++;
        uniform->value[k] = time > 0 ? cubic_at(curve, i, time) : 0;
    }
    return SF_OK;
}

/* Top of the parabola through the largest sample and its neighbours. */
static double peak_of(const sf_series *c) {
    int64_t k = sf_series_peak(c);
    if (k == 0 || k == c->count - 1)
        return c->value[k];
    double bend = c->value[k - 1] - 2 * c->value[k] + c->value[k + 1],
           rise = 0.5 * (c->value[k + 1] - c->value[k - 1]);
    return bend < 0 ? c->value[k] - 0.5 * rise * rise / bend : c->value[k];
}

sf_status sf_cushion_peak(const sf_cushion *cushion, const sf_material_law *law, double *peak,
                          sf_error *err) {
    SF_OWNED_BY(sf_series_free) sf_series curve = {0}, uniform = {0}, read = {0};
    if (!(cushion->static_stress > 0 && cushion->thickness > 0 && cushion->height > 0))
        return SF_REFUSE(err, "a static stress of %g Pa on %g m from %g m: all three are above 0",
                         cushion->static_stress, cushion->thickness, cushion->height);
    flight f = {.law = law,
                .mass = cushion->static_stress / SF_STANDARD_GRAVITY,
                .thickness = cushion->thickness,
                .speed = sqrt(2 * SF_STANDARD_GRAVITY * cushion->height),
                .step = FIRST_STEP};
    while (put_point(&f, &curve, err) == SF_OK && !(f.speed < 0 && f.stress == 0) && f.time < LONGEST)
        SF_TRY(advance(&f, err));
    SF_TRY(err->status);
    SF_TRY(sample(&curve, &uniform, err));
    SF_TRY(sf_signal_filter_cfc(&uniform, 1000, &read, err));
    *peak = peak_of(&read);
    return SF_OK;
}
