/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "solver/material/foam.h"

#include "solver/material/foam_tangent.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { XX, YY, ZZ, XY, YZ, XZ };
static const int SYM[3][3] = {{XX, XY, XZ}, {XY, YY, YZ}, {XZ, YZ, ZZ}};

sf_status sf_foam_build(const sf_foam_card *card, sf_foam *foam, sf_error *err) {
    *foam = (sf_foam){
        .density = card->density,
        .modulus = card->modulus,
        .hu = card->hysteresis_hu,
        .shape = card->hysteresis_shape,
        .damp = card->damp,
        .maxwell = card->maxwell_modulus,
        .maxwell_rate = card->maxwell_rate,
        .kelvin = card->kelvin_viscosity,
        .cutoff = card->tension_cutoff,
        .filter_time = card->rate_filter_time,
        .curve_count = card->curve_count,
    };
    foam->curve = sf_alloc(err, (unsigned long)card->curve_count, sizeof *foam->curve, "curves");
    foam->curve_rate = sf_alloc(err, (unsigned long)card->curve_count, sizeof *foam->curve_rate, "curves");
    for (int64_t k = 0; k < card->curve_count && err->status == SF_OK; k++) {
        foam->curve_rate[k] = card->curve_rate[k];
        sf_curve_build(card, k, &foam->curve[k], err);
    }
    if (err->status != SF_OK)
        sf_foam_free(foam);
    return err->status;
}

void sf_foam_free(sf_foam *foam) {
    for (int64_t k = 0; foam->curve && k < foam->curve_count; k++)
        sf_curve_free(&foam->curve[k]);
    free(foam->curve);
    free(foam->curve_rate);
    *foam = (sf_foam){0};
}

/* Principal law: nominal stress, slope and energy of each stretch. */
typedef struct principal {
    double t[3][SF_LANES];        /* Pa */
    double slope[3][SF_LANES];    /* Pa */
    double steepest[3][SF_LANES]; /* Pa, the same; at rest, where tension meets compression, the larger of
                                     both sides */
    double energy[SF_LANES];      /* J m-3 */
} principal;

static const double REST = 1e-6; /* strain below which a direction counts as at rest */

/* The larger modulus of tension and of compression, Pa. */
static double rest_stiffness(const sf_foam *foam) {
    return fmax(foam->modulus, foam->curve[0].piece[0].c[1]);
}

static void base_law(const sf_foam *foam, double stretch[3][SF_LANES], principal *law) {
    double modulus = foam->modulus, cutoff = foam->cutoff, yield = cutoff / modulus;
    double rest = rest_stiffness(foam);
    memset(law->energy, 0, sizeof law->energy);
    for (int i = 0; i < 3; i++) {
        double strain[SF_LANES], stress[SF_LANES], slope[SF_LANES], energy[SF_LANES];
        double *restrict t = law->t[i], *restrict tangent = law->slope[i],
                         *restrict steepest = law->steepest[i];
#pragma omp simd
        for (int l = 0; l < SF_LANES; l++)
            strain[l] = 1 - stretch[i][l];
        sf_curve_evaluate_lanes(&foam->curve[0], strain, stress, slope, energy);
#pragma omp simd
        for (int l = 0; l < SF_LANES; l++) {
            double pull = -strain[l] * modulus, work = 0.5 * strain[l] * strain[l] * modulus;
            bool squeezed = strain[l] > 0, elastic = pull <= cutoff, still = fabs(strain[l]) < REST;
            t[l] = squeezed ? -stress[l] : elastic ? pull : cutoff;
            tangent[l] = squeezed ? slope[l] : elastic ? modulus : 0;
            steepest[l] = still ? rest : tangent[l];
            law->energy[l] += squeezed ? energy[l] : elastic ? work : cutoff * (-strain[l] - 0.5 * yield);
        }
    }
}

double sf_foam_overstress(const sf_foam *foam, double strain, double rate, double *slope,
                          double *rate_slope) {
    const double *r = foam->curve_rate;
    int64_t k = foam->curve_count - 2;
    *slope = *rate_slope = 0;
    if (!(rate > r[0]) || !(strain > 0))
        return 0;
    while (k > 0 && rate < r[k])
        k--;
    double low, high, low_slope, high_slope, base, base_slope, energy;
    sf_curve_evaluate(&foam->curve[0], strain, &base, &base_slope, &energy);
    sf_curve_evaluate(&foam->curve[k], strain, &low, &low_slope, &energy);
    sf_curve_evaluate(&foam->curve[k + 1], strain, &high, &high_slope, &energy);
    double span = log(r[k + 1] / r[k]), x = fmin(1, log(rate / r[k]) / span);
    *slope = fmax(0, low_slope + x * (high_slope - low_slope) - base_slope);
    *rate_slope = x < 1 ? fmax(0, (high - low) / (span * rate)) : 0;
    return low + x * (high - low) - base;
}

/* Adds the rate overstress of lane l to the principal second Piola-Kirchhoff stress s; returns a bound on its
 * tangent: slopes, the shear moduli between directions, and what a change of the filtered rate does to all
 * three. */
static double add_overstress(const sf_foam *foam, double dt, sf_law_batch *b, int l, double v[9][SF_LANES],
                             const double rate_of_e[6], double s[3]) {
    double bound = 0, rates = 0, fastest = 0, shortest = INFINITY, extra[3];
    for (int i = 0; i < 3; i++) {
        double quadratic = 0;
        for (int p = 0; p < 3; p++)
            for (int q = 0; q < 3; q++)
                quadratic += v[3 * p + i][l] * rate_of_e[SYM[p][q]] * v[3 * q + i][l];
        if (b->stretch[i][l] < shortest) {
            shortest = b->stretch[i][l];
            fastest = fmax(0, -quadratic / shortest);
        }
    }
    b->history[SF_FOAM_RATE][l] += -expm1(-dt / foam->filter_time) * (fastest - b->history[SF_FOAM_RATE][l]);
    for (int i = 0; i < 3; i++) {
        double slope, rate_slope;
        extra[i] =
            sf_foam_overstress(foam, 1 - b->stretch[i][l], b->history[SF_FOAM_RATE][l], &slope, &rate_slope);
        s[i] -= extra[i] / b->stretch[i][l];
        bound = fmax(bound, slope);
        rates += rate_slope * rate_slope;
    }
    for (int i = 0; i < 3; i++) {
        double gap = b->stretch[(i + 1) % 3][l] - b->stretch[i][l];
        if (fabs(gap) > 1e-7)
            bound = fmax(bound, (extra[i] - extra[(i + 1) % 3]) / gap);
    }
    return bound + sqrt(rates) / foam->filter_time;
}

/* C = Ft F as (xx, yy, zz, xy, yz, xz). */
static void right_cauchy_green(double f[9][SF_LANES], double c[6][SF_LANES]) {
    static const int pair[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {1, 2}, {0, 2}};
    for (int k = 0; k < 6; k++) {
        int i = pair[k][0], j = pair[k][1];
#pragma omp simd
        for (int l = 0; l < SF_LANES; l++)
            c[k][l] = f[i][l] * f[j][l] + f[3 + i][l] * f[3 + j][l] + f[6 + i][l] * f[6 + j][l];
    }
}

/* a = J F^-T, row-major; returns J in b->jacobian. */
static void cofactor(sf_law_batch *b, double a[9][SF_LANES]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
#pragma omp simd
            for (int l = 0; l < SF_LANES; l++)
                a[3 * i + j][l] =
                    b->f[3 * i1 + j1][l] * b->f[3 * i2 + j2][l] - b->f[3 * i1 + j2][l] * b->f[3 * i2 + j1][l];
        }
#pragma omp simd
    for (int l = 0; l < SF_LANES; l++)
        b->jacobian[l] = b->f[0][l] * a[0][l] + b->f[1][l] * a[1][l] + b->f[2][l] * a[2][l];
}

/* out = sum of value[i] N_i N_i^T, N_i the columns of v. */
static void compose(const double value[3][SF_LANES], double v[9][SF_LANES], double out[6][SF_LANES]) {
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++) {
            double *restrict sum = out[SYM[i][j]];
#pragma omp simd
            for (int l = 0; l < SF_LANES; l++)
                sum[l] = value[0][l] * v[3 * i][l] * v[3 * j][l] +
                         value[1][l] * v[3 * i + 1][l] * v[3 * j + 1][l] +
                         value[2][l] * v[3 * i + 2][l] * v[3 * j + 2][l];
        }
}

/* Viscosity of DAMP (theory eq. 21), Pa s. */
static void damp_viscosity(const sf_foam *foam, const sf_law_batch *b, double eta[SF_LANES]) {
    double damp = foam->damp, density = foam->density;
#pragma omp simd
    for (int l = 0; l < SF_LANES; l++)
        eta[l] = damp * b->length[l] * sqrt(density * b->stiffness[l]);
}

/* Hysteresis (theory eq. 14 to 16) at W of the batch: its factor and `softening`, its derivative by W, the
 * new largest W, and the energies. */
static void hysteresis(const sf_foam *foam, sf_law_batch *b, double softening[SF_LANES]) {
    double hu = foam->hu, shape = foam->shape, power[SF_LANES];
    double kept = (1 - hu) / (1 + shape);
#pragma omp simd
    for (int l = 0; l < SF_LANES; l++)
        power[l] =
            b->energy[l] < b->history[SF_FOAM_PEAK][l] ? b->energy[l] / b->history[SF_FOAM_PEAK][l] : 1;
    for (int l = 0; l < SF_LANES && shape != 1; l++)
        if (power[l] != 1)
            power[l] = pow(power[l], shape);
#pragma omp simd
    for (int l = 0; l < SF_LANES; l++) {
        double w = b->energy[l], ratio = (1 - hu) * shape * power[l] / w;
        bool unloaded = w < b->history[SF_FOAM_PEAK][l];
        b->factor[l] = unloaded ? 1 - (1 - hu) * (1 - power[l]) : 1;
        softening[l] = unloaded && w > 0 ? ratio : 0;
        b->history[SF_FOAM_PEAK][l] = unloaded ? b->history[SF_FOAM_PEAK][l] : w;
        b->stored[l] = w * (hu + kept * power[l]);
        b->lost[l] = b->history[SF_FOAM_PEAK][l] * kept * shape;
    }
}

double sf_foam_uniaxial(const sf_foam *foam, double dt, double strain, sf_uniaxial *point) {
    double stress, slope, energy, rate_slope, stretch = 1 - strain, old = 1 - point->strain;
    double *peak = &point->history[SF_FOAM_PEAK], *rate = &point->history[SF_FOAM_RATE],
           *maxwell = &point->history[SF_FOAM_MAXWELL];
    double green_rate = 0.5 * (stretch * stretch - old * old) / dt;
    if (strain > 0) {
        sf_curve_evaluate(&foam->curve[0], strain, &stress, &slope, &energy);
    } else {
        stress = fmax(foam->modulus * strain, -foam->cutoff);
        energy = 0.5 * stress * stress / foam->modulus - stress * (stress / foam->modulus - strain);
    }
    if (energy >= *peak)
        *peak = energy;
    else
        stress *= sf_foam_unloading(foam->hu, foam->shape, energy / *peak);
    if (foam->curve_count > 1) {
        double fastest = fmax(0, -green_rate / stretch);
        *rate += -expm1(-dt / foam->filter_time) * (fastest - *rate);
        stress += sf_foam_overstress(foam, strain, *rate, &slope, &rate_slope);
    }
    if (foam->maxwell > 0)
        *maxwell = sf_foam_maxwell(foam->maxwell, foam->maxwell_rate, dt, green_rate, *maxwell);
    point->strain = strain;
    return stress - stretch * (*maxwell + foam->kelvin * green_rate);
}

/* Adds the rate overstress of every lane to the principal stresses `part`, adds its work and returns what it
 * adds to the bounds. */
static void rate_stress(const sf_foam *foam, double dt, sf_law_batch *b, double v[9][SF_LANES],
                        double rate_of_e[6][SF_LANES], double part[3][SF_LANES], double extra[SF_LANES]) {
    for (int l = 0; l < SF_LANES; l++) {
        double e[6], s[3];
        for (int k = 0; k < 6; k++)
            e[k] = rate_of_e[k][l];
        for (int i = 0; i < 3; i++)
            s[i] = part[i][l];
        extra[l] = add_overstress(foam, dt, b, l, v, e, s);
        for (int i = 0; i < 3; i++) {
            double quadratic = 0;
            for (int p = 0; p < 3; p++)
                for (int q = 0; q < 3; q++)
                    quadratic += v[3 * p + i][l] * e[SYM[p][q]] * v[3 * q + i][l];
            b->work[l] += (s[i] - part[i][l]) * quadratic * dt;
            part[i][l] = s[i];
        }
    }
}

/* Elastic part of every lane: second Piola-Kirchhoff stress into s [6][lane], with energies and bounds; `eta`
 * is the viscosity of DAMP. */
static void elastic_stress(const sf_foam *foam, double dt, sf_law_batch *b, double c[6][SF_LANES],
                           double rate_of_e[6][SF_LANES], double s[6][SF_LANES], double eta[SF_LANES]) {
    double v[9][SF_LANES], eigen[6][SF_LANES], part[3][SF_LANES], softening[SF_LANES], extra[SF_LANES] = {0};
    double rest = rest_stiffness(foam);
    principal law;
    memcpy(eigen, c, sizeof eigen);
    sf_foam_eigen(eigen, v);
    for (int i = 0; i < 3; i++)
#pragma omp simd
        for (int l = 0; l < SF_LANES; l++)
            b->stretch[i][l] = sqrt(eigen[i][l]);
    base_law(foam, b->stretch, &law);
    memcpy(b->energy, law.energy, sizeof b->energy);
    hysteresis(foam, b, softening);
    for (int i = 0; i < 3; i++)
#pragma omp simd
        for (int l = 0; l < SF_LANES; l++)
            part[i][l] = b->factor[l] * law.t[i][l] / b->stretch[i][l];
#pragma omp simd
    for (int l = 0; l < SF_LANES; l++) {
        b->stiffness[l] =
            sf_larger(law.slope[0][l], sf_larger(law.slope[1][l], sf_larger(law.slope[2][l], rest)));
        b->work[l] = 0;
    }
    if (foam->curve_count > 1 && dt > 0)
        rate_stress(foam, dt, b, v, rate_of_e, part, extra);
    compose(part, v, s);
    damp_viscosity(foam, b, eta);
    sf_foam_tangent_elastic(&(sf_foam_principal){b->stretch, law.t, law.steepest, b->factor, softening},
                            foam->maxwell, b->direction_tangent);
    sf_foam_tangent_viscous(b->stretch, foam->kelvin, eta, b->direction_viscosity);
    for (int i = 0; i < 3; i++)
#pragma omp simd
        for (int l = 0; l < SF_LANES; l++)
            b->direction_tangent[i][l] += extra[l];
    if (b->directions) {
        double inverse = dt > 0 ? 2 / dt : 0, effective[3][SF_LANES];
        for (int i = 0; i < 3; i++)
#pragma omp simd
            for (int l = 0; l < SF_LANES; l++)
                effective[i][l] = b->direction_tangent[i][l] + inverse * b->direction_viscosity[i][l];
        compose(effective, v, b->directional);
    }
}

/* Maxwell branch and Kelvin viscosity on the Green strain, added to s, and their work; closes the bounds. The
 * Maxwell stress is integrated exactly for a constant rate over the step. */
static void viscous_stress(const sf_foam *foam, double dt, sf_law_batch *b, double rate_of_e[6][SF_LANES],
                           double s[6][SF_LANES]) {
    double decay = exp(-foam->maxwell_rate * dt);
    double gain =
        foam->maxwell > 0 ? foam->maxwell / foam->maxwell_rate * -expm1(-foam->maxwell_rate * dt) : 0;
    double norm[SF_LANES] = {0}, work[SF_LANES] = {0};
    for (int k = 0; k < 6; k++) {
        double *restrict m = b->history[SF_FOAM_MAXWELL + k], *restrict out = s[k],
                         *restrict rate = rate_of_e[k];
        double twice = k < 3 ? 1 : 2;
#pragma omp simd
        for (int l = 0; l < SF_LANES; l++) {
            double old = m[l], kelvin = foam->kelvin * rate[l];
            m[l] = decay * old + gain * rate[l];
            out[l] += m[l] + kelvin;
            work[l] += twice * (0.5 * (old + m[l]) + kelvin) * rate[l] * dt;
            norm[l] += twice * (m[l] + kelvin) * (m[l] + kelvin);
        }
        if (b->directions) { /* dF S: exactly of the directional form */
#pragma omp simd
            for (int l = 0; l < SF_LANES; l++)
                b->directional[k][l] += m[l] + foam->kelvin * rate[l];
        }
    }
#pragma omp simd
    for (int l = 0; l < SF_LANES; l++) {
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
#pragma omp simd
        for (int l = 0; l < SF_LANES; l++)
            rate[k][l] = (b->f[k][l] - b->f_old[k][l]) * inverse;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j <= i; j++)
#pragma omp simd
            for (int l = 0; l < SF_LANES; l++) {
                double ij = 0, ji = 0;
                for (int k = 0; k < 3; k++) {
                    ij += rate[3 * i + k][l] * a[3 * j + k][l];
                    ji += rate[3 * j + k][l] * a[3 * i + k][l];
                }
                jd[3 * i + j][l] = jd[3 * j + i][l] = 0.5 * (ij + ji);
            }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
#pragma omp simd
            for (int l = 0; l < SF_LANES; l++) {
                double value = eta[l] * (jd[3 * i][l] * a[j][l] + jd[3 * i + 1][l] * a[3 + j][l] +
                                         jd[3 * i + 2][l] * a[6 + j][l]);
                b->p[3 * i + j][l] += value;
                b->work[l] += value * rate[3 * i + j][l] * dt;
            }
}

SF_KERNEL void sf_foam_update(const sf_foam *foam, double dt, sf_law_batch *b) {
    double c[6][SF_LANES], old[6][SF_LANES], rate_of_e[6][SF_LANES] = {{0}}, s[6][SF_LANES], a[9][SF_LANES],
                                             eta[SF_LANES];
    right_cauchy_green(b->f, c);
    if (dt > 0) {
        right_cauchy_green(b->f_old, old);
        double half = 0.5 / dt;
        for (int k = 0; k < 6; k++)
#pragma omp simd
            for (int l = 0; l < SF_LANES; l++)
                rate_of_e[k][l] = half * (c[k][l] - old[k][l]);
    }
    cofactor(b, a);
    elastic_stress(foam, dt, b, c, rate_of_e, s, eta);
    viscous_stress(foam, dt, b, rate_of_e, s);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
#pragma omp simd
            for (int l = 0; l < SF_LANES; l++)
                b->p[3 * i + j][l] = b->f[3 * i][l] * s[SYM[0][j]][l] + b->f[3 * i + 1][l] * s[SYM[1][j]][l] +
                                     b->f[3 * i + 2][l] * s[SYM[2][j]][l];
    if (foam->damp > 0 && dt > 0)
        damping_stress(dt, eta, a, b);
}
