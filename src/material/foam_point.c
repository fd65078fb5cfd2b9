/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "material/foam_point.h"

enum { XX, YY, ZZ, XY, YZ, XZ };
static const int SYM[3][3] = {{XX, XY, XZ}, {XY, YY, YZ}, {XZ, YZ, ZZ}};

sf_foam_options sf_foam_options_build(const sf_foam_shared *card) {
    sf_foam_options o = {
        .density = card->density,
        .hu = card->hysteresis_hu,
        .shape = card->hysteresis_shape,
        .damp = card->damp,
        .maxwell = card->maxwell_modulus,
        .maxwell_rate = card->maxwell_rate,
        .kelvin = card->kelvin_viscosity,
        .rate_factor = card->rate_factor,
        .rate_reference = card->rate_reference,
        .filter_time = card->rate_filter_time,
        .memory = card->memory,
    };
    sf_unloading_build(card->hysteresis_hu, card->hysteresis_shape, card->hysteresis_alpha, &o.unloading);
    return o;
}

/* Batched symmetric eigenproblem. Cyclic Jacobi has no special case for repeated roots and converges
 * quadratically; without branches it vectorises over lanes, so that a point costs about as much as a closed
 * form. */

enum { MAX_SWEEPS = 8 };

/* One rotation of a, (xx, yy, zz, xy, yz, xz), in the plane (p, q). Element (row,
 * column) of v is v[3 * row + column]. With d = aqq - app, h = sqrt(d^2 + 4 apq^2) the tangent of the angle
 * is 2 apq / (d +- h), and the eigenvalues move by (h - |d|) / 2. */
static inline void rotate(double a[6][SF_LANES], double v[9][SF_LANES], int p, int q) {
    int third = 3 - p - q;
    double *restrict app = a[p], *restrict aqq = a[q], *restrict apq = a[SYM[p][q]],
                     *restrict arp = a[SYM[third][p]], *restrict arq = a[SYM[third][q]];
    double c[SF_LANES], s[SF_LANES];
    SF_EACH_LANE (l) {
        double d = aqq[l] - app[l], o = 2 * apq[l], oo = o * o;
        double h = sqrt(d * d + oo), u = fabs(d) + h + 1e-150, r = 1 / sqrt(u * u + oo);
        double shift = copysign(0.5 * (h - fabs(d)), d);
        c[l] = u * r;
        s[l] = copysign(1, d) * o * r;
        app[l] -= shift;
        aqq[l] += shift;
        apq[l] = 0;
        double rp = arp[l], rq = arq[l];
        arp[l] = c[l] * rp - s[l] * rq;
        arq[l] = s[l] * rp + c[l] * rq;
    }
    for (int row = 0; row < 3; row++) {
        double *restrict vp = v[3 * row + p], *restrict vq = v[3 * row + q];
        SF_EACH_LANE (l) {
            double left = vp[l], right = vq[l];
            vp[l] = c[l] * left - s[l] * right;
            vq[l] = s[l] * left + c[l] * right;
        }
    }
}

SF_KERNEL void sf_foam_eigen(double a[6][SF_LANES], double v[9][SF_LANES]) {
    for (int k = 0; k < 9; k++)
        for (int l = 0; l < SF_LANES; l++)
            v[k][l] = k % 4 == 0;
    for (int sweep = 0; sweep < MAX_SWEEPS; sweep++) {
        int left = 0;
#pragma omp simd reduction(| : left)
        for (int l = 0; l < SF_LANES; l++) {
            double trace = a[0][l] + a[1][l] + a[2][l];
            double off = a[3][l] * a[3][l] + a[4][l] * a[4][l] + a[5][l] * a[5][l];
            left |= off > 1e-34 * trace * trace;
        }
        if (!left)
            break;
        rotate(a, v, 0, 1);
        rotate(a, v, 0, 2);
        rotate(a, v, 1, 2);
    }
}

/* C = Ft F as (xx, yy, zz, xy, yz, xz). */
static void right_cauchy_green(double f[9][SF_LANES], double c[6][SF_LANES]) {
    static const int pair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
    for (int k = 0; k < 6; k++) {
        int i = pair[k][0], j = pair[k][1];
        SF_EACH_LANE (l)
            c[k][l] = f[i][l] * f[j][l] + f[3 + i][l] * f[3 + j][l] + f[6 + i][l] * f[6 + j][l];
    }
}

/* a = J F^-T, row-major; returns J in b->jacobian. */
static void cofactor(sf_law_batch *b, double a[9][SF_LANES]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            SF_EACH_LANE (l)
                a[3 * i + j][l] =
                    b->f[3 * i1 + j1][l] * b->f[3 * i2 + j2][l] - b->f[3 * i1 + j2][l] * b->f[3 * i2 + j1][l];
        }
    SF_EACH_LANE (l)
        b->jacobian[l] = b->f[0][l] * a[0][l] + b->f[1][l] * a[1][l] + b->f[2][l] * a[2][l];
}

/* out = sum of value[i] N_i N_i^T, N_i the columns of v. */
static void compose(const double value[3][SF_LANES], double v[9][SF_LANES], double out[6][SF_LANES]) {
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++) {
            double *restrict sum = out[SYM[i][j]];
            SF_EACH_LANE (l)
                sum[l] = value[0][l] * v[3 * i][l] * v[3 * j][l] +
                         value[1][l] * v[3 * i + 1][l] * v[3 * j + 1][l] +
                         value[2][l] * v[3 * i + 2][l] * v[3 * j + 2][l];
        }
}

/* Viscosity of DAMP (theory eq. 21), Pa s. */
static void damp_viscosity(const sf_foam_options *foam, const sf_law_batch *b, double eta[SF_LANES]) {
    double damp = foam->damp, density = foam->density;
    SF_EACH_LANE (l)
        eta[l] = damp * b->length[l] * sqrt(density * b->stiffness[l]);
}

static void green_rates(double v[9][SF_LANES], double rate_of_e[6][SF_LANES], double out[3][SF_LANES]) {
    memset(out, 0, 3 * sizeof out[0]);
    for (int i = 0; i < 3; i++)
        for (int p = 0; p < 3; p++)
            for (int q = 0; q < 3; q++) {
                const double *left = v[3 * p + i], *rate = rate_of_e[SYM[p][q]], *right = v[3 * q + i];
                SF_EACH_LANE (l)
                    out[i][l] += left[l] * rate[l] * right[l];
            }
}

/* Part of the stress on which the rate acts: all, or that of compressed directions. */
static inline double acting(bool compression, double t) {
    return (compression & (t > 0)) ? 0 : t;
}

/* Stress by which the power of the stresses is divided for a rate: the sum of compressed directions, which
 * are columns of their own, or the largest of coupled ones. */
static void size_of(bool compression, const sf_foam_loading *law, double size[SF_LANES]) {
    for (int l = 0; l < SF_LANES; l++)
        size[l] = 0;
    for (int i = 0; i < 3; i++)
        SF_EACH_LANE (l) {
            double t = fabs(acting(compression, law->t[i][l]));
            size[l] = compression ? size[l] + t : sf_larger(t, size[l]);
        }
}

SF_KERNEL void sf_foam_point_filter(const sf_foam_options *foam, bool compression, double dt, sf_law_batch *b,
                                    const sf_foam_loading *law, const sf_foam_rate *rate) {
    double *restrict filtered = b->history[SF_FOAM_RATE], weight = -expm1(-dt / foam->filter_time);
    double power[SF_LANES] = {0}, size[SF_LANES];
    size_of(compression, law, size);
    for (int i = 0; i < 3; i++)
        SF_EACH_LANE (l)
            power[l] += acting(compression, law->t[i][l]) * rate->green[i][l] / b->stretch[i][l];
    SF_EACH_LANE (l)
        filtered[l] += weight * ((size[l] > 0 ? power[l] / size[l] : 0) - filtered[l]);
}

/* The rate factor: loading stresses times 1 + c log10(rate / reference). Its tangent is that of loading times
 * the same, and what a change of the filtered rate does to all three. */
static SF_KERNEL void rate_factor(const sf_foam_options *foam, bool compression, double dt, sf_law_batch *b,
                                  const sf_foam_loading *law, sf_foam_rate *rate) {
    double decade = foam->rate_factor / M_LN10, reference = foam->rate_reference, time = foam->filter_time;
    double gain[SF_LANES], sum[SF_LANES] = {0}, size[SF_LANES];
    size_of(compression, law, size);
    sf_foam_point_filter(foam, compression, dt, b, law, rate);
    const double *restrict now = b->history[SF_FOAM_RATE];
    SF_EACH_LANE (l)
        gain[l] = decade * sf_lane_log(sf_larger(now[l] / reference, 1));
    for (int i = 0; i < 3; i++)
        SF_EACH_LANE (l) {
            double t = acting(compression, law->t[i][l]);
            rate->part[i][l] += gain[l] * t / b->stretch[i][l];
            sum[l] += t * t;
        }
    SF_EACH_LANE (l) {
        double rise = decade / (sf_larger(now[l], reference) * time) * sum[l] / sf_larger(size[l], 1e-300);
        rate->factor[l] += gain[l];
        rate->extra[l] += gain[l] > 0 ? rise : 0;
    }
}

/* The overstress of the rate, and its work: by the mean of its values at both ends of the step. */
static void rate_stress(const sf_foam_options *foam, const sf_foam_kind *kind, double dt, sf_law_batch *b,
                        const sf_foam_loading *law, double rate_of_e[6][SF_LANES], sf_foam_rate *rate) {
    double added[3][SF_LANES], tensor[6][SF_LANES];
    memcpy(added, rate->part, sizeof added);
    if (kind->overstress)
        kind->overstress(kind->numbers, dt, b, law, rate);
    else
        rate_factor(foam, kind->compression, dt, b, law, rate);
    for (int i = 0; i < 3; i++)
        SF_EACH_LANE (l)
            added[i][l] = rate->part[i][l] - added[i][l];
    compose(added, rate->v, tensor);
    for (int k = 0; k < 6; k++) {
        double *restrict held = b->history[SF_FOAM_OVERSTRESS + k], half = (k < 3 ? 0.5 : 1) * dt;
        SF_EACH_LANE (l) {
            b->work[l] += half * (held[l] + tensor[k][l]) * rate_of_e[k][l];
            held[l] = tensor[k][l];
        }
    }
}

/* The bounds of a step that ends where the curve is steeper than where it begins. No direction shortens
 * faster than by the norm of the rate, which, unlike the rates of the directions, is certain where stretches
 * are equal. */
static void look_ahead(const sf_foam_kind *kind, double dt, const sf_law_batch *b,
                       double rate_of_e[6][SF_LANES], sf_foam_loading *law) {
    double next[3][SF_LANES];
    int dense = 0;
    for (int i = 0; i < 3; i++)
        for (int l = 0; l < SF_LANES; l++)
            dense |= b->stretch[i][l] < kind->dense;
    if (!dense)
        return;
    for (int l = 0; l < SF_LANES; l++) {
        double square = 0;
        for (int k = 0; k < 6; k++)
            square += (k < 3 ? 1 : 2) * rate_of_e[k][l] * rate_of_e[k][l];
        for (int i = 0; i < 3; i++)
            next[i][l] = b->stretch[i][l] - dt * sqrt(square) / b->stretch[i][l];
    }
    kind->ahead(kind->numbers, next, law->steepest);
}

/* Bounds by direction on the tangent of the foam law at SF_LANES points (theory eq. 18): numbers a[i] of the
 * principal directions N_i with dF : dP <= sum over i of a[i] |dF N_i|^2 for every dF. The time step follows
 * the largest of them, the power iteration uses all three. */

/* The elastic law in principal directions; borrowed. */
typedef struct principal {
    double (*stretch)[SF_LANES]; /* [3] - */
    double (*stress)[SF_LANES];  /* [3] Pa, nominal, of the loading curve */
    double (*slope)[SF_LANES];   /* [3] Pa, its derivative; at rest the larger of both sides */
    const double *factor;        /* -, of hysteresis */
    const double *softening;     /* m3 J-1, its derivative by W */
} principal;

/* In principal axes the normal parts of dF stand alone, and each pair of directions has a quadratic form of
 * its own in its two off-diagonal parts. */

/* Raises ai, aj until aj x^2 + ai y^2 covers p x^2 + 2 o x y + q y^2, x = dF_ij, y = dF_ji; the larger one
 * first, since little of it then makes the other superfluous. */
static inline void cover_pair(double *ai, double *aj, double p, double o, double q) {
    bool turned = *ai > *aj;
    double low = turned ? *aj : *ai, high = turned ? *ai : *aj;
    double under_high = turned ? q : p, under_low = turned ? p : q;
    bool covered =
        (low >= under_low) & (high >= under_high) & ((high - under_high) * (low - under_low) >= o * o);
    double raised = sf_larger(under_high + fabs(o), high), room = raised - under_high;
    double other = room > 0 ? sf_larger(under_low + o * o / room, low) : low;
    high = covered ? high : raised;
    low = covered ? low : other;
    *ai = turned ? high : low;
    *aj = turned ? low : high;
}

/* Elastic part with the Maxwell branch's instantaneous `maxwell` (Pa) into a, Pa. */
static SF_KERNEL void tangent_elastic(const principal *law, double maxwell, double a[3][SF_LANES]) {
    double half = 0.5 * maxwell, size[SF_LANES];
    const double *factor = law->factor, *softening = law->softening;
    SF_EACH_LANE (l)
        size[l] = fabs(law->stress[0][l]) + fabs(law->stress[1][l]) + fabs(law->stress[2][l]);
    for (int i = 0; i < 3; i++) { /* |T_i| sum |T_j| covers the rank-one term T T^T of unloading */
        const double *t = law->stress[i], *slope = law->slope[i], *stretch = law->stretch[i];
        SF_EACH_LANE (l)
            a[i][l] = factor[l] * slope[l] + softening[l] * fabs(t[l]) * size[l] +
                      maxwell * stretch[l] * stretch[l];
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3;
        const double *ti = law->stress[i], *tj = law->stress[j], *xi = law->stretch[i], *xj = law->stretch[j];
        const double *slope_i = law->slope[i], *slope_j = law->slope[j];
        double *restrict ai = a[i], *restrict aj = a[j];
        SF_EACH_LANE (l) {
            double gap = xi[l] - xj[l], secant = (ti[l] - tj[l]) / gap;
            double equal = fabs(gap) > 1e-7 ? secant : sf_larger(slope_i[l], slope_j[l]);
            double opposite = (ti[l] + tj[l]) / (xi[l] + xj[l]);
            double mean = 0.5 * factor[l] * (equal + opposite),
                   difference = 0.5 * factor[l] * (equal - opposite);
            double first = ai[l], second = aj[l];
            cover_pair(&first, &second, mean + half * xi[l] * xi[l], difference + half * xi[l] * xj[l],
                       mean + half * xj[l] * xj[l]);
            ai[l] = first;
            aj[l] = second;
        }
    }
}

/* Kelvin viscosity alone. */
static void kelvin_bounds(double stretch[3][SF_LANES], double kelvin, double eta[3][SF_LANES]) {
    double half = 0.5 * kelvin;
    for (int i = 0; i < 3; i++)
        for (int l = 0; l < SF_LANES; l++)
            eta[i][l] = kelvin * stretch[i][l] * stretch[i][l];
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3;
        for (int l = 0; l < SF_LANES; l++) {
            double xi = stretch[i][l], xj = stretch[j][l];
            cover_pair(&eta[i][l], &eta[j][l], half * xi * xi, half * xi * xj, half * xj * xj);
        }
    }
}

/* Kelvin viscosity `kelvin` and DAMP's `damp` (Pa s): the same bound on dP by a rate of F, into eta, Pa s. */
static SF_KERNEL void tangent_viscous(double stretch[3][SF_LANES], double kelvin, const double damp[SF_LANES],
                                      double eta[3][SF_LANES]) {
    if (kelvin > 0)
        kelvin_bounds(stretch, kelvin, eta);
    else
        memset(eta, 0, 3 * sizeof eta[0]);
    for (int i = 0; i < 3; i++) { /* DAMP needs no more than its normal parts */
        const double *x = stretch[(i + 1) % 3], *y = stretch[(i + 2) % 3];
        double *restrict out = eta[i];
        SF_EACH_LANE (l) {
            double area = x[l] * y[l];
            out[l] += damp[l] * area * area;
        }
    }
}

/* A of the power iteration, of the bounds so far. */
static void directional(double dt, double v[9][SF_LANES], sf_law_batch *b) {
    double inverse = dt > 0 ? 2 / dt : 0, effective[3][SF_LANES];
    for (int i = 0; i < 3; i++)
        SF_EACH_LANE (l)
            effective[i][l] = b->direction_tangent[i][l] + inverse * b->direction_viscosity[i][l];
    compose(effective, v, b->directional);
}

/* Strain of a batch; each tensor is (xx, yy, zz, xy, yz, xz). */
typedef struct strain {
    double c[6][SF_LANES];    /* C = Ft F */
    double rate[6][SF_LANES]; /* s-1, of the Green strain over the step; 0 without one */
} strain;

static void strain_find(sf_law_batch *b, double dt, strain *e) {
    double old[6][SF_LANES], half = 0.5 / dt;
    right_cauchy_green(b->f, e->c);
    memset(e->rate, 0, sizeof e->rate);
    if (!(dt > 0))
        return;
    right_cauchy_green(b->f_old, old);
    for (int k = 0; k < 6; k++)
        SF_EACH_LANE (l)
            e->rate[k][l] = half * (e->c[k][l] - old[k][l]);
}

/* Elastic part of every lane: second Piola-Kirchhoff stress into s [6][lane], with energies and bounds; `eta`
 * is the viscosity of DAMP. */
static void elastic_stress(const sf_foam_options *foam, const sf_foam_kind *kind, double dt, sf_law_batch *b,
                           strain *e, double s[6][SF_LANES], double eta[SF_LANES]) {
    double eigen[6][SF_LANES], rest = kind->rest;
    sf_foam_rate rate;
    sf_foam_loading law;
    sf_unloaded made;
    memcpy(eigen, e->c, sizeof eigen);
    sf_foam_eigen(eigen, rate.v);
    for (int i = 0; i < 3; i++)
        SF_EACH_LANE (l)
            b->stretch[i][l] = sqrt(eigen[i][l]);
    kind->loading(kind->numbers, b->stretch, &law);
    if (kind->ahead && dt > 0)
        look_ahead(kind, dt, b, e->rate, &law);
    memcpy(b->energy, law.energy, sizeof b->energy);
    if (sf_memory_acts(&foam->memory))
        sf_memory_lanes(&foam->memory, &foam->unloading, b->energy, b->history[SF_FOAM_PEAK],
                        b->history + SF_FOAM_MEMORY, &made);
    else
        sf_unloading_lanes(&foam->unloading, b->energy, b->history[SF_FOAM_PEAK], &made);
    memcpy(b->factor, made.factor, sizeof b->factor);
    memcpy(b->stored, made.stored, sizeof b->stored);
    memcpy(b->lost, made.lost, sizeof b->lost);
    for (int i = 0; i < 3; i++)
        SF_EACH_LANE (l)
            rate.part[i][l] = b->factor[l] * law.t[i][l] / b->stretch[i][l];
    SF_EACH_LANE (l) {
        b->stiffness[l] =
            sf_larger(law.slope[0][l], sf_larger(law.slope[1][l], sf_larger(law.slope[2][l], rest)));
        b->work[l] = rate.extra[l] = 0;
        rate.factor[l] = b->factor[l];
    }
    if ((kind->overstress || foam->rate_factor > 0) && dt > 0) {
        green_rates(rate.v, e->rate, rate.green);
        rate_stress(foam, kind, dt, b, &law, e->rate, &rate);
    }
    compose(rate.part, rate.v, s);
    damp_viscosity(foam, b, eta);
    tangent_elastic(&(principal){b->stretch, law.t, law.steepest, rate.factor, made.softening}, foam->maxwell,
                    b->direction_tangent);
    tangent_viscous(b->stretch, foam->kelvin, eta, b->direction_viscosity);
    for (int i = 0; i < 3; i++)
        SF_EACH_LANE (l)
            b->direction_tangent[i][l] += rate.extra[l];
    if (b->directions)
        directional(dt, rate.v, b);
}

/* Maxwell branch and Kelvin viscosity on the Green strain, added to s, and their work; closes the bounds. The
 * Maxwell stress is integrated exactly for a constant rate over the step. */
static void viscous_stress(const sf_foam_options *foam, double dt, sf_law_batch *b,
                           double rate_of_e[6][SF_LANES], double s[6][SF_LANES]) {
    double decay = exp(-foam->maxwell_rate * dt);
    double gain =
        foam->maxwell > 0 ? foam->maxwell / foam->maxwell_rate * -expm1(-foam->maxwell_rate * dt) : 0;
    double norm[SF_LANES] = {0}, work[SF_LANES] = {0};
    for (int k = 0; k < 6; k++) {
        double *restrict m = b->history[SF_FOAM_MAXWELL + k], *restrict out = s[k],
                         *restrict rate = rate_of_e[k];
        double twice = k < 3 ? 1 : 2;
        SF_EACH_LANE (l) {
            double old = m[l], kelvin = foam->kelvin * rate[l];
            m[l] = decay * old + gain * rate[l];
            out[l] += m[l] + kelvin;
            work[l] += twice * (0.5 * (old + m[l]) + kelvin) * rate[l] * dt;
            norm[l] += twice * (m[l] + kelvin) * (m[l] + kelvin);
        }
        if (b->directions) { /* dF S: exactly of the directional kind */
            SF_EACH_LANE (l)
                b->directional[k][l] += m[l] + foam->kelvin * rate[l];
        }
    }
    SF_EACH_LANE (l) {
        double geometric = sqrt(norm[l]);
        b->work[l] += work[l];
        b->tangent[l] = b->viscosity[l] = 0;
        for (int i = 0; i < 3; i++) {
            b->direction_tangent[i][l] += geometric;
            b->tangent[l] = sf_larger(b->direction_tangent[i][l], b->tangent[l]);
            b->viscosity[l] = sf_larger(b->direction_viscosity[i][l], b->viscosity[l]);
        }
    }
}

/* DAMP: sigma = DAMP rho c L D with everything current (theory eq. 21), added to p, and its work. */
static void damping_stress(double dt, const double eta[SF_LANES], double a[9][SF_LANES], sf_law_batch *b) {
    double inverse = 1 / dt, rate[9][SF_LANES], jd[9][SF_LANES];
    for (int k = 0; k < 9; k++)
        SF_EACH_LANE (l)
            rate[k][l] = (b->f[k][l] - b->f_old[k][l]) * inverse;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j <= i; j++)
            SF_EACH_LANE (l) {
                double ij = 0, ji = 0;
                for (int k = 0; k < 3; k++) {
                    ij += rate[3 * i + k][l] * a[3 * j + k][l];
                    ji += rate[3 * j + k][l] * a[3 * i + k][l];
                }
                jd[3 * i + j][l] = jd[3 * j + i][l] = 0.5 * (ij + ji);
            }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            SF_EACH_LANE (l) {
                double value = eta[l] * (jd[3 * i][l] * a[j][l] + jd[3 * i + 1][l] * a[3 + j][l] +
                                         jd[3 * i + 2][l] * a[6 + j][l]);
                b->p[3 * i + j][l] += value;
                b->work[l] += value * rate[3 * i + j][l] * dt;
            }
}

SF_KERNEL void sf_foam_point_update(const sf_foam_options *foam, const sf_foam_kind *kind, double dt,
                                    sf_law_batch *b) {
    strain e;
    double s[6][SF_LANES], a[9][SF_LANES], eta[SF_LANES];
    strain_find(b, dt, &e);
    cofactor(b, a);
    elastic_stress(foam, kind, dt, b, &e, s, eta);
    viscous_stress(foam, dt, b, e.rate, s);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            SF_EACH_LANE (l)
                b->p[3 * i + j][l] = b->f[3 * i][l] * s[SYM[0][j]][l] + b->f[3 * i + 1][l] * s[SYM[1][j]][l] +
                                     b->f[3 * i + 2][l] * s[SYM[2][j]][l];
    if (foam->damp > 0 && dt > 0)
        damping_stress(dt, eta, a, b);
}

static sf_memory_point memory_of(double (*history)[SF_LANES], int lane) {
    sf_memory_point point;
    for (int k = 0; k < 4; k++)
        ((double *)&point)[k] = history[SF_FOAM_MEMORY + k][lane];
    return point;
}

void sf_foam_point_rest(const void *numbers, double pause, double (*history)[SF_LANES]) {
    const sf_foam_options *foam = numbers;
    double left = exp(-foam->maxwell_rate * pause);
    for (int l = 0; l < SF_LANES; l++) {
        sf_memory_point point = memory_of(history, l);
        history[SF_FOAM_PEAK][l] *= sf_memory_rest(&foam->memory, pause, &point);
        history[SF_FOAM_MEMORY + 3][l] = point.recovered;
        for (int k = 0; k < 6; k++) {
            history[SF_FOAM_MAXWELL + k][l] *= left;
            history[SF_FOAM_OVERSTRESS + k][l] = 0;
        }
        history[SF_FOAM_RATE][l] *= exp(-pause / foam->filter_time);
    }
}

double sf_foam_point_softening(const void *numbers, double (*history)[SF_LANES], int lane) {
    const sf_foam_options *foam = numbers;
    sf_memory_point point = memory_of(history, lane);
    double q = sf_memory_acts(&foam->memory) ? sf_memory_factor(&foam->memory, &point) : 0;
    return (1 - q) * (1 - foam->hu) * foam->unloading.whole * history[SF_FOAM_PEAK][lane];
}

double sf_foam_axial_factor(const sf_foam_options *foam, double energy, sf_uniaxial *point) {
    double *peak = &point->history[SF_FOAM_PEAK];
    const sf_unloading *u = &foam->unloading;
    if (sf_memory_acts(&foam->memory))
        return sf_memory_advance(&foam->memory, u, energy, peak,
                                 (sf_memory_point *)&point->history[SF_FOAM_MEMORY]);
    if (energy < *peak)
        return sf_unloading_factor(u->hu, u->shape, u->alpha, energy / *peak);
    *peak = energy;
    return 1;
}

double sf_foam_axial_filter(const sf_foam_options *foam, double dt, double working, sf_uniaxial *point) {
    double *rate = &point->history[SF_FOAM_RATE];
    *rate += -expm1(-dt / foam->filter_time) * (working - *rate);
    return *rate;
}

double sf_foam_axial_gain(const sf_foam_options *foam, double dt, double working, sf_uniaxial *point) {
    if (!(foam->rate_factor > 0))
        return 0;
    double rate = sf_foam_axial_filter(foam, dt, working, point);
    return rate > foam->rate_reference ? foam->rate_factor * log10(rate / foam->rate_reference) : 0;
}

double sf_foam_axial_viscous(const sf_foam_options *foam, double dt, double green_rate, sf_uniaxial *point) {
    double *maxwell = &point->history[SF_FOAM_MAXWELL];
    if (foam->maxwell > 0)
        *maxwell = sf_foam_maxwell(foam->maxwell, foam->maxwell_rate, dt, green_rate, *maxwell);
    return *maxwell + foam->kelvin * green_rate;
}
