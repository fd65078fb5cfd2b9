/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "extreme.h"
#include "column.h"

#include "formula.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double LATEST = 0.1; /* s, end of any run */

/* Nominal stress of loading curve and hysteresis, compression positive. */
static double elastic_stress(const sf_foam_card *foam, double strain, double energy, double peak) {
    if (strain <= 0)
        return foam->modulus * strain;
    double stress = sf_formula_stress(strain);
    if (energy < peak)
        stress *=
            1 - (1 - foam->shared.hysteresis_hu) * (1 - pow(energy / peak, foam->shared.hysteresis_shape));
    return stress;
}

static sf_status append(sf_series *s, int64_t *room, double time, double value, sf_error *err) {
    if (s->count == *room) {
        int64_t more = *room > 0 ? 2 * *room : 4096;
        double *t = realloc(s->time, (size_t)more * sizeof *t);
        s->time = t ? t : s->time;
        double *v = realloc(s->value, (size_t)more * sizeof *v);
        s->value = v ? v : s->value;
        if (!t || !v)
            return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for %lld points of a force", (long long)more);
        *room = more;
    }
    s->time[s->count] = time;
    s->value[s->count++] = value;
    return SF_OK;
}

/* State of the ordinary differential equation: compression (m), velocity (m/s), Maxwell stress S (Pa), W
 * (J/m3). */
enum { DEPTH, VELOCITY, MAXWELL, ENERGY, STATES };

static double column_force(const sf_column *c, const double y[STATES], double peak) {
    double strain = y[DEPTH] / c->height;
    return c->area * (elastic_stress(c->foam, strain, y[ENERGY], peak) - (1 - strain) * y[MAXWELL]);
}

static void derivative(const sf_column *c, const double y[STATES], double peak, double out[STATES]) {
    double strain = y[DEPTH] / c->height, rate = y[VELOCITY] / c->height;
    out[DEPTH] = y[VELOCITY];
    out[VELOCITY] = c->gravity - column_force(c, y, peak) / c->mass;
    out[MAXWELL] =
        -c->foam->shared.maxwell_rate * y[MAXWELL] - c->foam->shared.maxwell_modulus * (1 - strain) * rate;
    out[ENERGY] = (strain > 0 ? sf_formula_stress(strain) : c->foam->modulus * strain) * rate;
}

sf_status sf_column_quasi_static(const sf_column *c, double dt, sf_series *force, sf_error *err) {
    double y[STATES] = {0, c->speed, 0, 0}, peak = 0;
    int64_t room = 0;
    *force = (sf_series){0};
    for (int64_t step = 0; (double)step * dt < LATEST; step++) {
        double k[4][STATES], z[STATES], now;
        static const double at[4] = {0, 0.5, 0.5, 1};
        peak = larger(peak, y[ENERGY]);
        now = column_force(c, y, peak);
        if (append(force, &room, (double)step * dt, now, err) != SF_OK)
            return err->status;
        if (step > 0 && now <= 0)
            break;
        for (int stage = 0; stage < 4; stage++) { /* classical Runge-Kutta */
            for (int i = 0; i < STATES; i++)
                z[i] = y[i] + (stage > 0 ? at[stage] * dt * k[stage - 1][i] : 0);
            derivative(c, z, fmax(peak, z[ENERGY]), k[stage]);
        }
        for (int i = 0; i < STATES; i++)
            y[i] += dt / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
    }
    return SF_OK;
}

/* One element after its strain has become `strain`: advances W, its maximum and the Maxwell stress; returns
 * the nominal stress. */
typedef struct element {
    double strain, energy, peak, maxwell, loading; /* loading: stress of the loading curve at the last step */
} element;

static double advance(const sf_column *c, element *e, double strain, double decay, double gain) {
    const sf_foam_card *foam = c->foam;
    double loading = strain > 0 ? sf_formula_stress(strain) : foam->modulus * strain, factor = 1;
    double rise = strain - e->strain, mean = 1 - 0.5 * (strain + e->strain);
    e->energy = fmax(0, e->energy + 0.5 * (loading + e->loading) * rise);
    e->maxwell = decay * e->maxwell - gain * mean * rise;
    e->strain = strain;
    e->loading = loading;
    if (e->energy >= e->peak)
        e->peak = e->energy;
    else
        factor = 1 - (1 - foam->shared.hysteresis_hu) *
                         (1 - pow(e->energy / e->peak, foam->shared.hysteresis_shape));
    return factor * loading - (1 - strain) * e->maxwell;
}

/* u: downward displacement of node k at (k + 1) h above the base; the top node moves with the missile. */
static sf_status run_wave(const sf_column *c, int n, double dt, int stride, double *u, double *v, element *e,
                          sf_series *force, sf_error *err) {
    double h = c->height / n, node = c->foam->shared.density * c->area * h, top = c->mass + 0.5 * node;
    double decay = exp(-c->foam->shared.maxwell_rate * dt);
    double gain = c->foam->shared.maxwell_modulus * -expm1(-c->foam->shared.maxwell_rate * dt) /
                  (c->foam->shared.maxwell_rate * dt);
    int64_t room = 0;
    v[n - 1] = c->speed * c->mass / top; /* what catching up the top node leaves */
    for (int64_t step = 0; (double)step * dt < LATEST; step++) {
        double below = 0, last = 0;
        for (int k = 0; k < n; k++) {
            double stress = advance(c, &e[k], (u[k] - (k > 0 ? u[k - 1] : 0)) / h, decay, gain);
            if (k > 0)
                v[k - 1] += dt * c->area * (stress - below) / node;
            below = stress;
        }
        double acceleration = (c->mass * c->gravity - c->area * below) / top;
        last = c->mass * (c->gravity - acceleration);
        v[n - 1] += (step ? dt : 0.5 * dt) * acceleration;
        if (step % stride == 0 && append(force, &room, (double)step * dt, last, err) != SF_OK)
            return err->status;
        if (v[n - 1] < 0 && last <= 0)
            break;
        for (int k = 0; k < n; k++)
            u[k] += dt * v[k];
    }
    return SF_OK;
}

sf_status sf_column_wave(const sf_column *c, int elements, double dt, int stride, sf_series *force,
                         sf_error *err) {
    unsigned long n = (unsigned long)elements;
    double *u = sf_alloc(err, n, sizeof *u, "column"), *v = sf_alloc(err, n, sizeof *v, "column");
    element *e = sf_alloc(err, n, sizeof *e, "column");
    *force = (sf_series){0};
    if (err->status == SF_OK)
        run_wave(c, elements, dt, stride, u, v, e, force, err);
    free(u);
    free(v);
    free(e);
    return err->status;
}
