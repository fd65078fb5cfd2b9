/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "material/memory.h"

/* Sum of c[k] x^k. */
static inline double sum(const double c[SF_UNLOADING_TERMS], double x) {
    double total = 0;
    for (int k = SF_UNLOADING_TERMS - 1; k >= 0; k--)
        total = total * x + c[k];
    return total;
}

/* (1 - x)^a = sum of b[k] x^k, integrated as x^(scale k + shift) dx / x. */
static void make_series(double a, double scale, double shift, double c[SF_UNLOADING_TERMS]) {
    double binomial = 1;
    for (int k = 0; k < SF_UNLOADING_TERMS; k++) {
        c[k] = binomial / (scale * k + shift);
        binomial *= (k - a) / (k + 1);
    }
}

/* Part of the integral above w: u = 1 - w^SHAPE, power = u^ALPHA. */
static inline double upper(const sf_unloading *o, double u, double power) {
    return u * power * sum(o->high, u);
}

void sf_unloading_build(double hu, double shape, double alpha, sf_unloading *o) {
    *o = (sf_unloading){.hu = hu, .shape = shape, .alpha = alpha};
    o->whole = shape / (1 + shape);
    o->steepest = INFINITY;
    if (alpha == 1)
        return;
    make_series(alpha, shape, 1, o->low);
    make_series(1 / shape - 1, shape, shape * (alpha + 1), o->high);
    o->whole = pow(0.5, 1 / shape) * sum(o->low, 0.5) + upper(o, 0.5, pow(0.5, alpha));
    if (alpha < 1)
        o->steepest = (1 - hu) * pow(-expm1(shape * log1p(-SF_UNLOADING_BAND)), alpha) / SF_UNLOADING_BAND;
}

double sf_unloading_integral(const sf_unloading *o, double ratio) {
    double power = pow(ratio, o->shape), u = 1 - power;
    if (o->alpha == 1)
        return ratio * (1 - power / (1 + o->shape));
    return power <= 0.5 ? ratio * sum(o->low, power) : o->whole - upper(o, u, pow(u, o->alpha));
}

/* ALPHA = 1; `power` is w^SHAPE, 1 while loading. */
static inline void straight(const sf_unloading *o, const double energy[SF_LANES], double peak[SF_LANES],
                            const double power[SF_LANES], sf_unloaded *out) {
    double hu = o->hu, shape = o->shape, kept = (1 - hu) / (1 + shape);
    SF_EACH_LANE (l) {
        double w = energy[l], ratio = (1 - hu) * shape * power[l] / w;
        bool unloaded = w < peak[l];
        out->factor[l] = unloaded ? 1 - (1 - hu) * (1 - power[l]) : 1;
        out->softening[l] = unloaded && w > 0 ? ratio : 0;
        peak[l] = unloaded ? peak[l] : w;
        out->stored[l] = w * (hu + kept * power[l]);
        out->lost[l] = peak[l] * kept * shape;
    }
}

static inline void curved(const sf_unloading *o, const double energy[SF_LANES], double peak[SF_LANES],
                          const double power[SF_LANES], sf_unloaded *out) {
    double gap = 1 - o->hu, alpha = o->alpha, shape = o->shape, whole = o->whole, most = o->steepest;
    double bent[SF_LANES], low[SF_LANES], high[SF_LANES];
    for (int l = 0; l < SF_LANES; l++)
        bent[l] = power[l] == 1 ? 0 : pow(1 - power[l], alpha);
    SF_EACH_LANE (l)
        low[l] = high[l] = 0;
    for (int k = SF_UNLOADING_TERMS - 1; k >= 0; k--)
        SF_EACH_LANE (l) {
            low[l] = low[l] * power[l] + o->low[k];
            high[l] = high[l] * (1 - power[l]) + o->high[k];
        }
    SF_EACH_LANE (l) {
        double w = energy[l], top = peak[l], rest = 1 - power[l];
        double below = w * low[l], above = whole - bent[l] * rest * high[l];
        double slope = gap * alpha * shape * bent[l] / rest * power[l] / w, bound = most / top;
        double lower = slope < bound ? slope : bound;
        bool unloaded = w < top;
        double base = unloaded ? top : w;
        double integral = power[l] <= 0.5 ? below : base * above;
        out->factor[l] = unloaded ? 1 - gap * bent[l] : 1;
        double steep = alpha < 1 ? bound : 0, tangent = rest > 0 ? lower : steep;
        out->softening[l] = (unloaded & (w > 0)) ? tangent : 0;
        peak[l] = base;
        out->stored[l] = w - gap * integral;
        out->lost[l] = base * gap * whole;
    }
}

SF_KERNEL void sf_unloading_lanes(const sf_unloading *o, const double energy[SF_LANES], double peak[SF_LANES],
                                  sf_unloaded *out) {
    double power[SF_LANES], shape = o->shape;
    SF_EACH_LANE (l)
        power[l] = energy[l] < peak[l] ? energy[l] / peak[l] : 1;
    for (int l = 0; l < SF_LANES && shape != 1; l++)
        if (power[l] != 1)
            power[l] = pow(power[l], shape);
    if (o->alpha == 1)
        straight(o, energy, peak, power, out);
    else
        curved(o, energy, peak, power, out);
}

/* Decay of what has recovered, with each whole unloading: 5 % remain. */
static const double RENEWAL = 3;

static inline double factor_of(const sf_memory *m, double passes, double recovered) {
    double q = m->reload / (1 + m->drift * sf_larger(passes - 1, 0));
    return q + recovered * (1 - q);
}

double sf_memory_factor(const sf_memory *m, const sf_memory_point *p) {
    return factor_of(m, p->passes, p->recovered);
}

/* The part of the largest W that a point with a recovered part R of its softening still remembers is 1 - R^4:
 * all of it, nearly, up to R = 1/2. */
static double remembered(double recovered) {
    double square = recovered * recovered;
    return recovered < 1 ? 1 - square * square : 0;
}

double sf_memory_rest(const sf_memory *m, double pause, sf_memory_point *p) {
    double most = 1 - m->permanent;
    static const double MOST_DECADES = 300; /* of an earlier rest, beside which every pause is nothing */
    if (!(m->recovery > 0) || p->recovered >= most || p->recovered > MOST_DECADES * m->recovery)
        return 1;
    double start = remembered(p->recovered), before = pow(10, p->recovered / m->recovery),
           after = log10(before + pause / m->start);
    p->recovered = fmin(most, m->recovery * after);
    return remembered(p->recovered) / start;
}

/* One step of a point: `z` at the W of the step, `top` the largest Z before it, `risen` the new one if this W
 * is the largest, else -1. Returns p. At a W beyond all before, 1 - f is 0: the range begins anew, and what
 * its elastic part held is lost. */
static inline double step(const sf_memory *m, double z, double top, double risen,
                          sf_memory_point *restrict point) {
    double length = sf_larger(SF_MEMORY_ELASTIC * top, 1e-300),
           q = factor_of(m, point->passes, point->recovered);
    double trial = (z - point->back) / length, low = sf_larger(trial, 0), p = sf_smaller(low, q);
    bool virgin = risen >= 0;
    double rest, slid = SF_MEMORY_ELASTIC * sf_larger(-trial, 0),
                 younger = point->passes * top / sf_larger(risen, 1e-300);
    point->loops += q * length * (low - p) + (virgin ? 0.5 * length * p * p : 0);
    point->passes = virgin ? younger : point->passes + slid;
    point->recovered = virgin ? 0 : point->recovered * (1 + sf_lane_expm1(-RENEWAL * slid, &rest));
    point->back = virgin ? risen : z - length * p;
    return virgin ? 0 : p;
}

SF_KERNEL void sf_memory_lanes(const sf_memory *m, const sf_unloading *u, const double energy[SF_LANES],
                               double peak[SF_LANES], double (*point)[SF_LANES], sf_unloaded *out) {
    double old[SF_LANES], share = (1 - u->hu) * u->whole;
    for (int l = 0; l < SF_LANES; l++)
        old[l] = peak[l];
    sf_unloading_lanes(u, energy, peak, out);
    SF_EACH_LANE (l) {
        bool below = energy[l] < old[l];
        double top = share * old[l], gap = 1 - out->factor[l], z = below ? energy[l] - out->stored[l] : top;
        sf_memory_point now = {point[0][l], point[1][l], point[2][l], point[3][l]};
        double p = step(m, z, top, below ? -1 : share * peak[l], &now);
        point[0][l] = now.back;
        point[1][l] = now.loops;
        point[2][l] = now.passes;
        point[3][l] = now.recovered;
        double length = sf_larger(SF_MEMORY_ELASTIC * top, 1e-300);
        out->factor[l] = 1 - gap * (1 - p);
        out->softening[l] = below ? out->softening[l] * (1 - p) + gap * gap / length : out->softening[l];
        out->stored[l] += 0.5 * length * p * p;
        out->lost[l] += now.loops;
    }
}

double sf_memory_advance(const sf_memory *m, const sf_unloading *u, double energy, double *peak,
                         sf_memory_point *point) {
    double old = *peak, share = 1 - u->hu, top = share * u->whole * old;
    bool below = energy < old;
    double ratio = below ? energy / old : 1,
           z = share * old * (below ? sf_unloading_integral(u, ratio) : u->whole);
    double gap = below ? 1 - sf_unloading_factor(u->hu, u->shape, u->alpha, ratio) : 0;
    *peak = below ? old : energy;
    double p = step(m, z, top, below ? -1 : share * u->whole * energy, point);
    return 1 - gap * (1 - p);
}
