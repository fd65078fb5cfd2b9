/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/column.h"

/* ---- columns below the missile ---- */

enum { PARTS = 4 }; /* a triangle is cut into PARTS^2, so that large ones spread over the gaps they have */

typedef struct outline {
    double low[3], high[3];   /* m, of the pad */
    double bottom[3], top[3]; /* m, of the missile */
} outline;

/* Adds a patch of projected area `area` around `x`; gaps are summed with the area as weight. */
static void add_patch(const outline *o, const double x[3], double area, sf_columns *out) {
    double gap = x[2] - o->bottom[2];
    int k = (int)(gap / out->thickness * SF_COLUMNS);
    bool inside = x[0] >= o->low[0] && x[0] <= o->high[0] && x[1] >= o->low[1] && x[1] <= o->high[1];
    if (!inside || k < 0 || k >= SF_COLUMNS)
        return;
    out->area[k] += area;
    out->gap[k] += area * gap;
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
    outline o;
    sf_box3(r->node_count, r->position, o.low, o.high);
    sf_box3(r->surface_node_count, r->surface_position, o.bottom, o.top);
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
        return SF_REFUSE(err, "no part of the missile's surface faces the pad");
    return SF_OK;
}

/* ---- the drop ---- */

/* Time steps (s) and how far a step may turn the oscillation of the missile on the foam (rad). */
static const double STEP = 100e-6, FIRST_STEP = 10e-6, LEAST_STEP = 1e-7, LONGEST = 0.2, ANGLE = 0.04;
static const double GROWTH = 1.5; /* of a step over the last one */

/* A missile on its way. */
typedef struct flight {
    const sf_columns *columns;
    const sf_material_law *law;
    double time, depth, speed, force; /* s, m, m s-1 downwards, N */
    double deepest;                   /* m, the largest depth so far */
    double step;                      /* s, the last one */
    double stiffness;                 /* N m-1, along it */
    double stress[SF_COLUMNS];        /* Pa, of the last force */
    double work[SF_COLUMNS];          /* J m-3, of the steps downwards */
    sf_uniaxial point[SF_COLUMNS];
} flight;

static int columns_above(const sf_columns *c, double depth) {
    int n = 0;
    while (n < c->count && c->gap[n] < depth)
        n++;
    return n;
}

/* Force (N) at a depth `dt` after the points' last; infinite where a column has no height left. */
static double force(flight *f, double dt, double depth) {
    const sf_columns *c = f->columns;
    double sum = 0;
    for (int k = columns_above(c, depth) - 1; k >= 0; k--) {
        double strain = (depth - c->gap[k]) / c->thickness;
        if (strain >= 1)
            return INFINITY;
        double stress = f->law->law->uniaxial(f->law->numbers, dt, strain, &f->point[k]);
        f->stress[k] = fmax(0, stress); /* the missile does not pull */
        sum += c->area[k] * f->stress[k];
    }
    return sum;
}

/* One step of the velocity Verlet scheme; false if the foam collapses in it: then nothing has changed. */
static bool step(flight *f, double dt) {
    double mass = f->columns->mass, a = SF_STANDARD_GRAVITY - f->force / mass;
    double depth = f->depth + dt * (f->speed + 0.5 * dt * a), moved = depth - f->depth;
    sf_uniaxial saved[SF_COLUMNS];
    size_t size = (size_t)columns_above(f->columns, depth) * sizeof *saved;
    memcpy(saved, f->point, size);
    double after = force(f, dt, depth);
    if (!isfinite(after)) {
        memcpy(f->point, saved, size);
        return false;
    }
    if (fabs(moved) > 1e-3 * dt) /* slower, a difference of forces is no slope */
        f->stiffness = fabs((after - f->force) / moved);
    for (int k = columns_above(f->columns, depth) - 1; k >= 0 && moved > 0; k--)
        f->work[k] += f->stress[k] * moved / f->columns->thickness;
    f->time += dt;
    f->depth = depth;
    double falling = f->speed, upwards = after / mass - SF_STANDARD_GRAVITY;
    f->speed += 0.5 * dt * (a + SF_STANDARD_GRAVITY - after / mass);
    bool turns = falling > 0 && f->speed < 0 && upwards > 0; /* within the step, by a parabola */
    f->deepest = fmax(f->deepest, depth + (turns ? 0.5 * f->speed * f->speed / upwards : 0));
    f->force = after;
    f->step = dt;
    return true;
}

/* The next step, shortened until the foam bears it. */
static sf_status advance(flight *f, sf_error *err) {
    double dt = fmin(STEP, GROWTH * f->step);
    if (f->stiffness > 0)
        dt = fmin(dt, ANGLE * sqrt(f->columns->mass / f->stiffness));
    while (!step(f, dt))
        if ((dt /= 4) < LEAST_STEP)
            return SF_FAIL(err, SF_ERR_NUMERIC, "the foam of the columns collapsed at an indentation of %g m",
                           f->depth);
    return SF_OK;
}

static bool has_left(const flight *f) {
    return f->speed < 0 && f->force == 0;
}

/* The end of contact (s) within the step that `before` has not made yet, by ever smaller steps; it has made
 * them afterwards. */
static double end_of_contact(flight *f, double dt) {
    enum { LEVELS = 2, PARTS_OF_STEP = 10 };
    for (int level = 0; level < LEVELS; level++) {
        flight last = *f;
        dt /= PARTS_OF_STEP;
        do {
            last = *f;
        } while (step(f, dt) && !has_left(f));
        if (level < LEVELS - 1)
            *f = last;
    }
    double above = f->columns->gap[0] - f->depth;
    return f->time - (above > 0 ? fmin(dt, above / -f->speed) : 0.5 * dt);
}

static sf_status put_point(const flight *f, sf_series *curve, sf_error *err) {
    size_t n = (size_t)curve->count;
    if (!sf_grow(&curve->time, n, sizeof *curve->time) || !sf_grow(&curve->value, n, sizeof *curve->value))
        return SF_NO_MEMORY(err, "a curve");
    curve->time[curve->count] = f->time;
    curve->value[curve->count++] = f->force / f->columns->mass / SF_STANDARD_GRAVITY;
    return SF_OK;
}

void sf_columns_scale(const sf_columns_figures *f, double y[SF_COLUMNS_LOGARITHMS]) {
    y[SF_FIT_A_MAX] = log(f->a_max_g);
    y[SF_FIT_HIC] = log(f->hic);
    y[SF_FIT_WINDOW] = log(1e3 * f->hic_window);
    y[SF_FIT_REBOUND] = log(f->v_rebound);
    y[SF_FIT_CONTACT] = log(1e3 * f->contact_time);
    y[SF_COLUMNS_STRAIN] = log(f->strain);
    y[SF_COLUMNS_BEYOND] = f->beyond;
}

/* Returns the share of the work in columns beyond `informed`. Each column stands for the gaps up to the
 * middle between its own and the next ones, and counts by their part that is beyond: the share then has no
 * jumps. */
static double share_beyond(const flight *f) {
    const sf_columns *c = f->columns;
    double all = 0, beyond = 0, most = f->deepest - c->informed * c->thickness, low = 0;
    for (int k = 0; k < c->count; k++) {
        double high = k + 1 < c->count ? 0.5 * (c->gap[k] + c->gap[k + 1]) : 2 * c->gap[k] - low,
               work = c->area[k] * f->work[k];
        all += work;
        beyond += c->informed > 0 ? work * fmin(1, fmax(0, (most - low) / (high - low))) : 0;
        low = high;
    }
    return all > 0 ? beyond / all : 0;
}

/* A drop on the points as they are. */
static sf_status drop(flight *f, sf_series *curve, sf_columns_figures *out, sf_error *err) {
    flight before;
    out->v_rebound = out->contact_time = NAN;
    curve->count = 0;
    while (put_point(f, curve, err) == SF_OK && !has_left(f) && f->time < LONGEST) {
        if (f->speed < 0)
            before = *f;
        SF_TRY(advance(f, err));
        if (has_left(f)) {
            out->contact_time = end_of_contact(&before, f->step);
            out->v_rebound = -before.speed;
        }
    }
    out->strain = f->deepest / f->columns->thickness;
    out->beyond = share_beyond(f);
    return err->status;
}

sf_status sf_columns_drop(const sf_columns *columns, const sf_material_law *law, sf_series *curve,
                          sf_columns_figures *out, sf_error *err) {
    const flight start = {.columns = columns, .law = law, .speed = columns->speed, .step = FIRST_STEP};
    flight f = start;
    *curve = (sf_series){0};
    for (int k = 0; k < columns->before && drop(&f, curve, out, err) == SF_OK; k++) {
        flight next = start;
        for (int c = 0; c < columns->count; c++) {
            next.point[c] = f.point[c];
            sf_material_point_rest(law, columns->pause[k], &next.point[c]);
        }
        f = next;
    }
    if (err->status != SF_OK || drop(&f, curve, out, err) != SF_OK)
        sf_series_free(curve);
    return err->status;
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

sf_status sf_columns_read(const sf_series *filtered, sf_columns_figures *out, sf_error *err) {
    sf_hic hic;
    SF_TRY(sf_hic_evaluate(filtered, INFINITY, &hic, err));
    out->a_max_g = peak_of(filtered);
    out->hic = hic.value;
    out->hic_window = hic.t2 - hic.t1;
    return SF_OK;
}

sf_status sf_columns_respond(const sf_columns *columns, const sf_material_law *law, sf_columns_figures *out,
                             sf_series *filtered, sf_error *err) {
    SF_OWNED_BY(sf_series_free) sf_series curve = {0}, uniform = {0}, read = {0};
    SF_TRY(sf_columns_drop(columns, law, &curve, out, err));
    SF_TRY(sample(&curve, &uniform, err));
    SF_TRY(sf_signal_filter_cfc(&uniform, 1000, &read, err));
    SF_TRY(sf_columns_read(&read, out, err));
    if (filtered) {
        *filtered = read;
        read = (sf_series){0};
    }
    return SF_OK;
}

sf_status sf_columns_expect(const sf_columns *columns, const sf_material_law *law,
                            double y[SF_COLUMNS_LOGARITHMS], sf_error *err) {
    sf_columns_figures figures;
    if (sf_columns_respond(columns, law, &figures, NULL, err) == SF_OK)
        sf_columns_scale(&figures, y);
    return err->status;
}
