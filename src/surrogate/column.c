/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "surrogate/column.h"

#include "surrogate/pulse.h"

#include "core/units.h"
#include "post/hic.h"
#include <math.h>
#include <string.h>

/* ---- columns below the missile ---- */

enum { PARTS = 4 }; /* a triangle is cut into PARTS^2, so that large ones spread over the gaps they have */

typedef struct outline {
    double low[2], high[2]; /* m, of the pad from above */
    double lowest;          /* m, z of the missile's lowest point */
} outline;

static outline find_outline(const sf_results *r) {
    outline o = {{INFINITY, INFINITY}, {-INFINITY, -INFINITY}, INFINITY};
    for (int64_t i = 0; i < r->node_count; i++)
        for (int c = 0; c < 2; c++) {
            o.low[c] = fmin(o.low[c], r->position[3 * i + c]);
            o.high[c] = fmax(o.high[c], r->position[3 * i + c]);
        }
    for (int64_t i = 0; i < r->surface_node_count; i++)
        o.lowest = fmin(o.lowest, r->surface_position[3 * i + 2]);
    return o;
}

/* Adds a patch of projected area `area` around `x`; gaps are summed with the area as weight. */
static void add_patch(const outline *o, const double x[3], double area, sf_columns *out) {
    int k = (int)((x[2] - o->lowest) / out->thickness * SF_COLUMNS);
    bool inside = x[0] >= o->low[0] && x[0] <= o->high[0] && x[1] >= o->low[1] && x[1] <= o->high[1];
    if (!inside || k < 0 || k >= SF_COLUMNS)
        return;
    out->area[k] += area;
    out->gap[k] += area * (x[2] - o->lowest);
}

static void add_triangle(const outline *o, const double *a, const double *b, const double *c, double factor,
                         sf_columns *out) {
    double twice =
        (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]); /* z of the outward normal */
    if (!(twice < 0))
        return;
    double part = -0.5 * twice * factor / (PARTS * PARTS), x[3];
    for (int i = 0; i < PARTS; i++)
        for (int j = 0; j < PARTS - i; j++)
            for (int turned = 0; turned <= (i + j < PARTS - 1); turned++) {
                double third = turned ? 2. / 3 : 1. / 3, p = (i + third) / PARTS, q = (j + third) / PARTS;
                for (int k = 0; k < 3; k++)
                    x[k] = a[k] + p * (b[k] - a[k]) + q * (c[k] - a[k]);
                add_patch(o, x, part, out);
            }
}

sf_status sf_columns_build(const sf_results *r, sf_columns *out, sf_error *err) {
    *out =
        (sf_columns){.mass = r->missile_mass, .speed = sf_results_fall_speed(r), .thickness = r->thickness};
    outline o = find_outline(r);
    for (int64_t t = 0; t < r->surface_triangle_count; t++) {
        const int32_t *v = &r->surface_triangle[3 * t];
        add_triangle(&o, &r->surface_position[3 * (int64_t)v[0]], &r->surface_position[3 * (int64_t)v[1]],
                     &r->surface_position[3 * (int64_t)v[2]], sf_results_whole(r), out);
    }
    for (int k = 0; k < SF_COLUMNS; k++) {
        if (!(out->area[k] > 0))
            continue;
        out->gap[out->count] = out->gap[k] / out->area[k];
        out->area[out->count++] = out->area[k];
    }
    if (out->count == 0)
        return SF_FAIL(err, SF_ERR_INPUT, "no part of the missile's surface faces the pad");
    return SF_OK;
}

/* ---- the drop ---- */

static const double STEP = 20e-6, LONGEST = 0.2; /* s */

static double force(const sf_columns *columns, const sf_material_law *law, double indentation,
                    sf_uniaxial *point) {
    double sum = 0;
    for (int k = 0; k < columns->count && columns->gap[k] < indentation; k++) {
        double strain = (indentation - columns->gap[k]) / columns->thickness;
        double stress = law->law->uniaxial(law->numbers, STEP, strain, &point[k]);
        sum += columns->area[k] * fmax(0, stress); /* the missile does not pull */
    }
    return sum;
}

/* The curve until the missile has left the foam, when `*rebound` is its speed upwards; else NaN. */
static sf_status fall(const sf_columns *columns, const sf_material_law *law, sf_series *curve,
                      double *rebound, sf_error *err) {
    sf_uniaxial point[SF_COLUMNS] = {{0}};
    int64_t most = (int64_t)(LONGEST / STEP), count = 0;
    double depth = 0, speed = columns->speed;
    *rebound = NAN;
    if (sf_series_create(most, curve, err) != SF_OK)
        return err->status;
    while (count < most && isnan(*rebound)) {
        double f = force(columns, law, depth, point);
        if (!isfinite(f)) {
            sf_series_free(curve);
            return SF_FAIL(err, SF_ERR_NUMERIC, "the foam of the columns collapsed at an indentation of %g m",
                           depth);
        }
        curve->time[count] = (double)count * STEP;
        curve->value[count++] = f / columns->mass / SF_STANDARD_GRAVITY;
        if (speed < 0 && f == 0)
            *rebound = -speed;
        speed += STEP * (SF_STANDARD_GRAVITY - f / columns->mass);
        depth += STEP * speed;
    }
    curve->count = count;
    return SF_OK;
}

sf_status sf_columns_drop(const sf_columns *columns, const sf_material_law *law, sf_series *curve,
                          sf_error *err) {
    double rebound;
    return fall(columns, law, curve, &rebound, err);
}

/* ---- its reading ---- */

static const double FREE_FLIGHT = 5e-3; /* s, before contact, as softfall-post puts it there */

static sf_status filter(const sf_series *curve, sf_series *filtered, sf_error *err) {
    sf_series before = {0}, uniform = {0};
    if (sf_signal_lead_in(curve, FREE_FLIGHT, 0, &before, err) == SF_OK &&
        sf_signal_resample(&before, 1 / STEP, &uniform, err) == SF_OK)
        sf_signal_filter_cfc(&uniform, 1000, filtered, err);
    sf_series_free(&before);
    sf_series_free(&uniform);
    return err->status;
}

sf_status sf_columns_respond(const sf_columns *columns, const sf_material_law *law, sf_columns_figures *out,
                             sf_series *filtered, sf_error *err) {
    sf_series curve = {0}, read = {0};
    sf_hic hic;
    double rebound;
    if (fall(columns, law, &curve, &rebound, err) == SF_OK && filter(&curve, &read, err) == SF_OK &&
        sf_pulse_hic(&read, &hic, err) == SF_OK) {
        *out = (sf_columns_figures){.hic = hic.value, .hic_window = hic.t2 - hic.t1, .v_rebound = rebound};
        out->contact_time = isnan(rebound) ? NAN : curve.time[curve.count - 1];
        for (int64_t k = 0; k < read.count; k++)
            out->a_max_g = fmax(out->a_max_g, read.value[k]);
    }
    sf_series_free(&curve);
    if (err->status == SF_OK && filtered)
        *filtered = read;
    else
        sf_series_free(&read);
    return err->status;
}
