/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "core/curve.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_interp.h>
#include <math.h>
#include <stdlib.h>

/* The law beyond the data, C1 at (start, stress) with the given slope. */
static sf_status build_densification(const sf_foam_card *foam, double stress, double slope, sf_curve *curve,
                                     sf_error *err) {
    curve->limit = foam->densification_limit;
    if (!(curve->limit > curve->start))
        return SF_FAIL(err, SF_ERR_INPUT, "the densification limit %g is not beyond its start %g", curve->limit,
                       curve->start);
    if (!(slope > 0 && stress > 0))
        return SF_FAIL(err, SF_ERR_INPUT, "the compression curve is flat (stress %g Pa, slope %g Pa) at the strain %g "
                       "where densification starts", stress, slope, curve->start);
    double room = curve->limit - curve->start;
    curve->exponent = foam->densification_exponent > 0 ? foam->densification_exponent : room * slope / stress;
    curve->factor = slope * pow(room, curve->exponent + 1) / curve->exponent;
    curve->constant = stress - slope * room / curve->exponent;
    return SF_OK;
}

/* Hermite pieces through values and slopes of the interpolant at uniform points. */
static void build_pieces(const gsl_interp *interp, const double *x, const double *y, sf_curve *curve) {
    double energy = 0;
    for (int k = 0; k < SF_CURVE_INTERVALS; k++) {
        double a = k * curve->step, b = k + 1 == SF_CURVE_INTERVALS ? curve->start : (k + 1) * curve->step;
        double h = b - a, y0, y1, d0, d1;
        gsl_interp_eval_e(interp, x, y, a, NULL, &y0);
        gsl_interp_eval_e(interp, x, y, b, NULL, &y1);
        gsl_interp_eval_deriv_e(interp, x, y, a, NULL, &d0);
        gsl_interp_eval_deriv_e(interp, x, y, b, NULL, &d1);
        sf_curve_piece *p = &curve->piece[k];
        p->energy = energy;
        p->c[0] = y0;
        p->c[1] = d0;
        p->c[2] = (3 * (y1 - y0) / h - 2 * d0 - d1) / h;
        p->c[3] = (2 * (y0 - y1) / h + d0 + d1) / (h * h);
        energy += h * (p->c[0] + h * (p->c[1] / 2 + h * (p->c[2] / 3 + h * p->c[3] / 4)));
        curve->largest_slope = fmax(curve->largest_slope, fmax(d0, d1));
    }
    curve->start_energy = energy;
}

sf_status sf_curve_build(const sf_foam_card *foam, int64_t index, sf_curve *curve, sf_error *err) {
    int64_t first = foam->curve_ptr[index], count = foam->curve_ptr[index + 1] - first;
    const double *x = &foam->curve_strain[first], *y = &foam->curve_stress[first];
    *curve = (sf_curve){0};
    curve->start = foam->densification_start > 0 ? foam->densification_start : x[count - 1];
    if (curve->start > x[count - 1])
        return SF_FAIL(err, SF_ERR_INPUT, "densification starts at strain %g, but the curve ends at %g", curve->start,
                       x[count - 1]);
    curve->step = curve->start / SF_CURVE_INTERVALS;
    curve->piece = sf_alloc(err, SF_CURVE_INTERVALS, sizeof *curve->piece, "curve table");
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    gsl_interp *interp = gsl_interp_alloc(gsl_interp_steffen, (size_t)count);
    if (err->status == SF_OK && (!interp || gsl_interp_init(interp, x, y, (size_t)count) != GSL_SUCCESS))
        SF_FAIL(err, SF_ERR_LIBRARY, "GSL cannot interpolate compression curve %lld", (long long)index);
    if (err->status == SF_OK) {
        double stress = gsl_interp_eval(interp, x, y, curve->start, NULL);
        double slope = gsl_interp_eval_deriv(interp, x, y, curve->start, NULL);
        build_pieces(interp, x, y, curve);
        build_densification(foam, stress, slope, curve, err);
    }
    if (interp)
        gsl_interp_free(interp);
    gsl_set_error_handler(handler);
    if (err->status != SF_OK)
        sf_curve_free(curve);
    return err->status;
}

void sf_curve_free(sf_curve *curve) {
    free(curve->piece);
    *curve = (sf_curve){0};
}

static void evaluate_densification(const sf_curve *curve, double strain, double *stress, double *slope,
                                   double *energy) {
    double left = curve->limit - strain, room = curve->limit - curve->start, m = curve->exponent;
    if (!(left > 0)) {
        *stress = *slope = *energy = INFINITY;
        return;
    }
    double singular = curve->factor * pow(left, -m);
    *stress = curve->constant + singular;
    *slope = m * singular / left;
    *energy = curve->start_energy + curve->constant * (strain - curve->start);
    if (fabs(m - 1) < 1e-9)
        *energy += curve->factor * log(room / left);
    else
        *energy += (singular * left - curve->factor * pow(room, 1 - m)) / (m - 1);
}

void sf_curve_evaluate(const sf_curve *curve, double strain, double *stress, double *slope, double *energy) {
    if (!(strain < curve->start)) {
        evaluate_densification(curve, strain, stress, slope, energy);
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
