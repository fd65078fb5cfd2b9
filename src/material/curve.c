/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "material/curve.h"

double sf_densification_natural_exponent(double start, double limit, double stress, double slope) {
    return (limit - start) * slope / stress;
}

double sf_densification_steep_exponent(double start, double limit, double stress, double slope) {
    return fmax(1, sf_densification_natural_exponent(start, limit, stress, slope));
}

sf_densification sf_densification_join(double start, double limit, double exponent, double stress,
                                       double slope, double energy) {
    double room = limit - start;
    return (sf_densification){.start = start,
                              .limit = limit,
                              .exponent = exponent,
                              .constant = stress - slope * room / exponent,
                              .factor = slope * pow(room, exponent + 1) / exponent,
                              .start_energy = energy};
}

/* At a strain beyond the line's start. */
static void evaluate_line(const sf_curve_line *line, double strain, double *stress, double *slope,
                          double *energy) {
    double past = strain - line->start;
    *stress = line->stress + past * (line->slope + line->stop * past);
    *slope = line->slope + 2 * line->stop * past;
    *energy = line->energy + past * (line->stress + past * (0.5 * line->slope + line->stop * past / 3));
}

/* J m-3 at full compression, the line's share included. */
static double energy_to_the_end(const sf_curve_line *line) {
    double energy, ignored[2];
    evaluate_line(line, 1, &ignored[0], &ignored[1], &energy);
    return energy;
}

static sf_curve_line line_from(const sf_densification *law, double start) {
    sf_curve_line line = {.start = start};
    sf_densification_evaluate(law, start, &line.stress, &line.slope, &line.energy);
    return line;
}

/* A weak law ends earlier, with a stop. */
static sf_curve_line stopped(const sf_densification *law, const sf_curve_line *line) {
    double start = fmax(law->start, 1 - SF_STOP_ROOM);
    sf_curve_line end = line_from(law, fmin(line->start, start));
    end.stop = 3 * fmax(0, SF_STOP_ENERGY - energy_to_the_end(&end)) / pow(1 - end.start, 3);
    return end;
}

/* Returns the straight line with which the law beyond the data ends. */
static sf_curve_line straight_end(const sf_densification *law) {
    bool full = law->limit >= 1;
    double least = full ? SF_STRAIGHT_ROOM_AT_1 : SF_STRAIGHT_ROOM,
           steep = full ? SF_STRAIGHT_SLOPE_AT_1 : SF_STRAIGHT_SLOPE;
    double left = (law->limit - law->start) * fmax(least, pow(steep, -1 / (law->exponent + 1)));
    sf_curve_line line = line_from(law, law->limit - left);
    return line.start < 1 && energy_to_the_end(&line) < SF_STOP_ENERGY ? stopped(law, &line) : line;
}

/* The law beyond the data, C1 at (start, stress) with the given slope. */
static sf_status build_densification(const sf_foam_card *foam, double stress, double slope, double energy,
                                     sf_curve *curve, sf_error *err) {
    double start = curve->start, limit = foam->densification_limit, exponent = foam->densification_exponent;
    if (!(limit > start))
        return SF_REFUSE(err, "the densification limit %g is not beyond its start %g", limit, start);
    if (!(slope > 0 && stress > 0))
        return SF_REFUSE(err,
                         "the compression curve is flat (stress %g Pa, slope %g Pa) at the strain %g where "
                         "densification starts",
                         stress, slope, start);
    if (!(exponent > 0))
        exponent = sf_densification_natural_exponent(start, limit, stress, slope);
    curve->beyond = sf_densification_join(start, limit, exponent, stress, slope, energy);
    curve->straight = straight_end(&curve->beyond);
    return SF_OK;
}

/* Steffen's slopes at the points. Those of the ends come from the parabola through three points, as in the
 * paper; GSL takes the secant of the last interval, which is of first order and would hand a wrong exponent
 * to the densification. */
static void steffen_slopes(int64_t count, const double *x, const double *y, double *slope) {
    for (int64_t i = 0; i < count; i++) {
        bool first = i == 0, last = i + 1 == count;
        int64_t k = last ? i - 1 : i,
                n = first ? 1 : k - 1; /* the interval at the point, and the next or other one */
        double h = x[k + 1] - x[k], g = x[n + 1] - x[n], s = (y[k + 1] - y[k]) / h, r = (y[n + 1] - y[n]) / g;
        if (first || last)
            slope[i] = fmax(0, fmin(s + (s - r) * h / (h + g), 2 * s));
        else
            slope[i] = 2 * fmin(fmin(s, r), 0.5 * (r * h + s * g) / (h + g));
    }
}

static sf_status check_points(int64_t index, int64_t count, const double *x, sf_error *err) {
    if (count < 3)
        return SF_REFUSE(err, "compression curve %lld has %lld points" SF_AT_LEAST("3"), (long long)index,
                         (long long)count);
    for (int64_t i = 1; i < count; i++)
        if (!(x[i] > x[i - 1]))
            return SF_REFUSE(err, "the strains of compression curve %lld are not ascending: %g after %g",
                             (long long)index, x[i], x[i - 1]);
    return SF_OK;
}

/* Stress and slope of the interpolant at the ends of the pieces, into c[0] and c[1] of the piece that begins
 * there, and at the end of the last. Data denser than the table can be steeper at an end than the table's
 * secants: slopes within three times both secants keep every cubic piece rising (Fritsch, Carlson 1980,
 * doi:10.1137/0717021). */
static void sample_pieces(const double *x, const double *y, const double *slope, sf_curve *curve,
                          double *end_stress, double *end_slope) {
    sf_curve_piece *p = curve->piece;
    int64_t i = 0;
    for (int k = 0; k <= SF_CURVE_INTERVALS; k++) {
        bool last = k == SF_CURVE_INTERVALS;
        double at = last ? curve->start : k * curve->step;
        while (x[i + 1] < at)
            i++;
        double h = x[i + 1] - x[i], q = (at - x[i]) / h, s = (y[i + 1] - y[i]) / h;
        double c2 = 3 * s - 2 * slope[i] - slope[i + 1], c3 = slope[i] + slope[i + 1] - 2 * s;
        *(last ? end_stress : &p[k].c[0]) = y[i] + h * q * (slope[i] + q * (c2 + q * c3));
        *(last ? end_slope : &p[k].c[1]) = slope[i] + q * (2 * c2 + q * 3 * c3);
    }
    for (int k = 0; k < SF_CURVE_INTERVALS; k++) {
        bool last = k + 1 == SF_CURVE_INTERVALS;
        double bound = 3 * ((last ? *end_stress : p[k + 1].c[0]) - p[k].c[0]) / curve->step;
        double *next = last ? end_slope : &p[k + 1].c[1];
        p[k].c[1] = fmin(p[k].c[1], bound);
        *next = fmin(*next, bound);
    }
}

/* Hermite pieces through the sampled stresses and slopes; returns the energy (J m-3) at their end. */
static double build_pieces(double end_stress, double end_slope, sf_curve *curve) {
    double energy = 0;
    for (int k = 0; k < SF_CURVE_INTERVALS; k++) {
        bool last = k + 1 == SF_CURVE_INTERVALS;
        sf_curve_piece *p = &curve->piece[k];
        double h = (last ? curve->start : (k + 1) * curve->step) - k * curve->step;
        double y0 = p->c[0], d0 = p->c[1], y1 = last ? end_stress : p[1].c[0],
               d1 = last ? end_slope : p[1].c[1];
        p->energy = energy;
        p->c[2] = (3 * (y1 - y0) / h - 2 * d0 - d1) / h;
        p->c[3] = (2 * (y0 - y1) / h + d0 + d1) / (h * h);
        energy += h * (p->c[0] + h * (p->c[1] / 2 + h * (p->c[2] / 3 + h * p->c[3] / 4)));
    }
    return energy;
}

sf_status sf_curve_build(const sf_foam_card *foam, int64_t index, sf_curve *curve, sf_error *err) {
    int64_t first = foam->curves.curve_ptr[index], count = foam->curves.curve_ptr[index + 1] - first;
    const double *x = &foam->curves.curve_strain[first], *y = &foam->curves.curve_stress[first];
    *curve = (sf_curve){0};
    SF_TRY(check_points(index, count, x, err));
    curve->start = foam->densification_start > 0 ? foam->densification_start : x[count - 1];
    if (curve->start > x[count - 1])
        return SF_REFUSE(err, "densification starts at strain %g, but the curve ends at %g", curve->start,
                         x[count - 1]);
    curve->step = curve->start / SF_CURVE_INTERVALS;
    curve->piece = sf_alloc(err, SF_CURVE_INTERVALS, sizeof *curve->piece, "curve table");
    SF_OWNED double *slopes = sf_alloc(err, count, sizeof *slopes, "curve slopes");
    if (err->status == SF_OK) {
        double stress, slope;
        steffen_slopes(count, x, y, slopes);
        sample_pieces(x, y, slopes, curve, &stress, &slope);
        double energy = build_pieces(stress, slope, curve);
        build_densification(foam, stress, slope, energy, curve, err);
    }
    if (err->status != SF_OK)
        sf_curve_free(curve);
    return err->status;
}

void sf_curve_free(sf_curve *curve) {
    SF_CLEAR(curve, curve->piece);
}

void sf_densification_evaluate(const sf_densification *law, double strain, double *stress, double *slope,
                               double *energy) {
    double left = law->limit - strain, room = law->limit - law->start, m = law->exponent;
    if (!(left > 0)) {
        *stress = *slope = *energy = INFINITY;
        return;
    }
    double singular = law->factor * pow(left, -m);
    *stress = law->constant + singular;
    *slope = m * singular / left;
    *energy = law->start_energy + law->constant * (strain - law->start);
    if (fabs(m - 1) < 1e-9)
        *energy += law->factor * log(room / left);
    else
        *energy += (singular * left - law->factor * pow(room, 1 - m)) / (m - 1);
}

/* At a strain from the end of the table on. */
static void evaluate_beyond(const sf_curve *curve, double strain, double *stress, double *slope,
                            double *energy) {
    const sf_curve_line *line = &curve->straight;
    if (strain < line->start) {
        sf_densification_evaluate(&curve->beyond, strain, stress, slope, energy);
        return;
    }
    evaluate_line(line, strain, stress, slope, energy);
}

void sf_curve_evaluate(const sf_curve *curve, double strain, double *stress, double *slope, double *energy) {
    if (!(strain < curve->start)) {
        evaluate_beyond(curve, strain, stress, slope, energy);
        return;
    }
    int k = (int)(strain / curve->step);
    if (k >= SF_CURVE_INTERVALS)
        k = SF_CURVE_INTERVALS - 1;
    const sf_curve_piece *p = &curve->piece[k];
    double t = strain - k * curve->step;
    *stress = p->c[0] + t * (p->c[1] + t * (p->c[2] + t * p->c[3]));
    *slope = p->c[1] + t * (2 * p->c[2] + t * 3 * p->c[3]);
    *energy = p->energy + t * (p->c[0] + t * (p->c[1] / 2 + t * (p->c[2] / 3 + t * p->c[3] / 4)));
}

SF_KERNEL void sf_curve_evaluate_lanes(const sf_curve *curve, const double strain[SF_LANES],
                                       double stress[SF_LANES], double slope[SF_LANES],
                                       double energy[SF_LANES]) {
    const sf_curve_piece *piece = curve->piece;
    double step = curve->step, start = curve->start, inverse = 1 / step;
    int dense = 0;
#pragma omp simd reduction(| : dense)
    for (int l = 0; l < SF_LANES; l++) {
        double inside = sf_smaller(sf_larger(strain[l], 0), start);
        int k = (int)(inside * inverse);
        k = k < SF_CURVE_INTERVALS ? k : SF_CURVE_INTERVALS - 1;
        const sf_curve_piece *p = &piece[k];
        double t = inside - k * step;
        stress[l] = p->c[0] + t * (p->c[1] + t * (p->c[2] + t * p->c[3]));
        slope[l] = p->c[1] + t * (2 * p->c[2] + t * 3 * p->c[3]);
        energy[l] = p->energy + t * (p->c[0] + t * (p->c[1] / 2 + t * (p->c[2] / 3 + t * p->c[3] / 4)));
        dense |= strain[l] >= start;
    }
    if (!dense)
        return;
    for (int l = 0; l < SF_LANES; l++) /* few points at any time */
        if (strain[l] >= start)
            evaluate_beyond(curve, strain[l], &stress[l], &slope[l], &energy[l]);
}
