/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "extreme.h"
#include "foam_reference.h"

#include <math.h>

enum { XX, YY, ZZ, XY, YZ, XZ };
static const int SYM[3][3] = {{XX, XY, XZ}, {XY, YY, YZ}, {XZ, YZ, ZZ}};

/* What the law says of one point in its principal directions. */
typedef struct principal {
    double n[9]; /* columns: directions */
    double stretch[3], t[3], slope[3], steepest[3];
    double energy, factor, softening;
} principal;

void sf_foam_energies(const sf_foam *foam, double energy, double peak, double *stored, double *lost) {
    double s = foam->options.shape, hu = foam->options.hu;
    *lost = peak * (1 - hu) * s / (1 + s);
    *stored = peak > 0 ? energy * (hu + (1 - hu) * pow(energy / peak, s) / (1 + s)) : 0;
}

static void right_cauchy_green(double f[9][SF_LANES], int l, double c[9]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            c[3 * i + j] = f[i][l] * f[j][l] + f[3 + i][l] * f[3 + j][l] + f[6 + i][l] * f[6 + j][l];
}

/* Cyclic Jacobi (Golub, Van Loan, section 8.5), in the kernel's order of planes: the order of the directions
 * is its result. */
static void eigen(double c[9], double stretch[3], double n[9]) {
    static const int plane[3][3] = {{0, 1, 2}, {0, 2, 1}, {1, 2, 0}};
    for (int k = 0; k < 9; k++)
        n[k] = k % 4 == 0;
    for (int turn = 0; turn < 30; turn++) {
        int p = plane[turn % 3][0], q = plane[turn % 3][1], r = plane[turn % 3][2];
        double o = c[3 * p + q];
        if (o == 0)
            continue;
        double tau = (c[3 * q + q] - c[3 * p + p]) / (2 * o);
        double t = (tau >= 0 ? 1 : -1) / (fabs(tau) + sqrt(1 + tau * tau)), cosine = 1 / sqrt(1 + t * t);
        double sine = t * cosine, rp = c[3 * r + p], rq = c[3 * r + q];
        c[3 * p + p] -= t * o;
        c[3 * q + q] += t * o;
        c[3 * p + q] = c[3 * q + p] = 0;
        c[3 * r + p] = c[3 * p + r] = cosine * rp - sine * rq;
        c[3 * r + q] = c[3 * q + r] = sine * rp + cosine * rq;
        for (int row = 0; row < 3; row++) {
            double x = n[3 * row + p], y = n[3 * row + q];
            n[3 * row + p] = cosine * x - sine * y;
            n[3 * row + q] = sine * x + cosine * y;
        }
    }
    for (int i = 0; i < 3; i++)
        stretch[i] = sqrt(c[4 * i]);
}

/* Theory eq. 11 to 13. */
static void base_law(const sf_foam *foam, principal *p) {
    double rest = fmax(foam->modulus, foam->curve[0].piece[0].c[1]);
    p->energy = 0;
    for (int i = 0; i < 3; i++) {
        double strain = 1 - p->stretch[i], yield = foam->cutoff / foam->modulus, energy;
        if (strain > 0) {
            sf_curve_evaluate(&foam->curve[0], strain, &p->t[i], &p->slope[i], &energy);
            p->t[i] = -p->t[i];
        } else if (-strain <= yield) {
            p->t[i] = -strain * foam->modulus;
            p->slope[i] = foam->modulus;
            energy = 0.5 * strain * strain * foam->modulus;
        } else {
            p->t[i] = foam->cutoff;
            p->slope[i] = 0;
            energy = foam->cutoff * (-strain - 0.5 * yield);
        }
        p->steepest[i] = fabs(strain) < 1e-6 ? rest : p->slope[i];
        p->energy += energy;
    }
}

/* Theory eq. 14. */
static void hysteresis(const sf_foam *foam, double *peak, principal *p) {
    p->factor = 1;
    p->softening = 0;
    if (p->energy >= *peak) {
        *peak = p->energy;
        return;
    }
    double power = pow(p->energy / *peak, foam->options.shape);
    p->factor = 1 - (1 - foam->options.hu) * (1 - power);
    if (p->energy > 0)
        p->softening = (1 - foam->options.hu) * foam->options.shape * power / p->energy;
}

static double quadratic(const principal *p, int i, const double e[6]) {
    double sum = 0;
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            sum += p->n[3 * r + i] * e[SYM[r][c]] * p->n[3 * c + i];
    return sum;
}

/* Where the present rate may lead into densification within a step, the slope there. */
static void look_ahead(const sf_foam *foam, double dt, const double e[6], principal *p) {
    const sf_curve *curve = &foam->curve[0];
    double square = 0;
    for (int k = 0; k < 6; k++)
        square += (k < 3 ? 1 : 2) * e[k] * e[k];
    for (int i = 0; i < 3; i++) {
        double strain = 1 - p->stretch[i] + dt * sqrt(square) / p->stretch[i], stress, slope, energy;
        if (strain < curve->start)
            continue;
        sf_curve_evaluate(curve, strain, &stress, &slope, &energy);
        p->steepest[i] = larger(p->steepest[i], slope);
    }
}

/* Rate overstress (theory eq. 22): changes the principal stresses s, returns its bound. */
static double overstress(const sf_foam *foam, double dt, const principal *p, const double e[6], double *rate,
                         double s[3]) {
    double bound = 0, rates = 0, extra[3];
    double power = 0, size = 0;
    for (int i = 0; i < 3; i++)
        if (p->t[i] < 0) {
            power += p->t[i] * quadratic(p, i, e) / p->stretch[i];
            size -= p->t[i];
        }
    *rate += -expm1(-dt / foam->options.filter_time) * ((size > 0 ? power / size : 0) - *rate);
    for (int i = 0; i < 3; i++) {
        double slope, rate_slope;
        extra[i] = sf_foam_overstress(foam, 1 - p->stretch[i], *rate, &slope, &rate_slope);
        s[i] -= extra[i] / p->stretch[i];
        bound = larger(bound, slope);
        rates += rate_slope * rate_slope;
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3;
        double gap = p->stretch[j] - p->stretch[i];
        if (fabs(gap) > 1e-7)
            bound = larger(bound, (extra[i] - extra[j]) / gap);
    }
    return bound + sqrt(rates) / foam->options.filter_time;
}

/* Work of the overstress, by the mean of its values at both ends of the step. */
static void work_of(const principal *p, const double added[3], double dt, const double e[6], sf_law_batch *b,
                    int l) {
    for (int r = 0; r < 3; r++)
        for (int k = r; k < 3; k++) {
            double now = 0, *held = &b->history[SF_FOAM_OVERSTRESS + SYM[r][k]][l], twice = k > r ? 2 : 1;
            for (int i = 0; i < 3; i++)
                now += added[i] * p->n[3 * r + i] * p->n[3 * k + i];
            b->work[l] += twice * 0.5 * (*held + now) * e[SYM[r][k]] * dt;
            *held = now;
        }
}

/* Raises a[i], a[j] until a[j] x^2 + a[i] y^2 covers p x^2 + 2 o x y + q y^2. */
static void cover_pair(double *ai, double *aj, double p, double o, double q) {
    if (*ai > *aj) {
        cover_pair(aj, ai, q, o, p);
        return;
    }
    if (*ai >= q && *aj >= p && (*aj - p) * (*ai - q) >= o * o)
        return;
    *aj = larger(*aj, p + fabs(o));
    if (*aj > p)
        *ai = larger(*ai, q + o * o / (*aj - p));
}

/* Theory eq. 18. */
static void bounds(const sf_foam *foam, const principal *p, double damp, double a[3], double eta[3]) {
    const double *t = p->t, *x = p->stretch;
    double size = fabs(t[0]) + fabs(t[1]) + fabs(t[2]);
    for (int i = 0; i < 3; i++) {
        a[i] = p->factor * p->steepest[i] + p->softening * fabs(t[i]) * size +
               foam->options.maxwell * x[i] * x[i];
        eta[i] = foam->options.kelvin * x[i] * x[i];
    }
    for (int i = 0; i < 3; i++) {
        int j = (i + 1) % 3;
        double gap = x[i] - x[j], opposite = (t[i] + t[j]) / (x[i] + x[j]);
        double equal = fabs(gap) > 1e-7 ? (t[i] - t[j]) / gap : fmax(p->steepest[i], p->steepest[j]);
        double mean = 0.5 * p->factor * (equal + opposite), half = 0.5 * foam->options.maxwell;
        double difference = 0.5 * p->factor * (equal - opposite), kelvin = 0.5 * foam->options.kelvin;
        cover_pair(&a[i], &a[j], mean + half * x[i] * x[i], difference + half * x[i] * x[j],
                   mean + half * x[j] * x[j]);
        cover_pair(&eta[i], &eta[j], kelvin * x[i] * x[i], kelvin * x[i] * x[j], kelvin * x[j] * x[j]);
    }
    for (int i = 0; i < 3; i++) {
        double area = x[(i + 1) % 3] * x[(i + 2) % 3];
        eta[i] += damp * area * area;
    }
}

/* Maxwell branch and Kelvin viscosity (theory eq. 19, 20) into s; returns the norm of their stress. */
static double viscous(const sf_foam *foam, double dt, sf_law_batch *b, int l, const double e[6],
                      double s[6]) {
    double decay = exp(-foam->options.maxwell_rate * dt), norm = 0;
    double gain =
        foam->options.maxwell > 0 ? foam->options.maxwell / foam->options.maxwell_rate * (1 - decay) : 0;
    for (int k = 0; k < 6; k++) {
        double old = b->history[SF_FOAM_MAXWELL + k][l], now = decay * old + gain * e[k],
               twice = k < 3 ? 1 : 2;
        double stress = now + foam->options.kelvin * e[k];
        b->history[SF_FOAM_MAXWELL + k][l] = now;
        b->work[l] += twice * (0.5 * (old + now) + foam->options.kelvin * e[k]) * e[k] * dt;
        b->directional[k][l] += stress;
        norm += twice * stress * stress;
        s[k] += stress;
    }
    return sqrt(norm);
}

/* Theory eq. 21: P_D = eta (J D) cof F. */
static void damping(double dt, double eta, sf_law_batch *b, int l) {
    double a[9], rate[9], jd[9];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            a[3 * i + j] =
                b->f[3 * i1 + j1][l] * b->f[3 * i2 + j2][l] - b->f[3 * i1 + j2][l] * b->f[3 * i2 + j1][l];
            rate[3 * i + j] = (b->f[3 * i + j][l] - b->f_old[3 * i + j][l]) / dt;
        }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            jd[3 * i + j] = 0;
            for (int k = 0; k < 3; k++)
                jd[3 * i + j] += 0.5 * (rate[3 * i + k] * a[3 * j + k] + rate[3 * j + k] * a[3 * i + k]);
        }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double value = 0;
            for (int k = 0; k < 3; k++)
                value += eta * jd[3 * i + k] * a[3 * k + j];
            b->p[3 * i + j][l] += value;
            b->work[l] += value * rate[3 * i + j] * dt;
        }
}

static double determinant(double f[9][SF_LANES], int l) {
    return f[0][l] * (f[4][l] * f[8][l] - f[5][l] * f[7][l]) -
           f[1][l] * (f[3][l] * f[8][l] - f[5][l] * f[6][l]) +
           f[2][l] * (f[3][l] * f[7][l] - f[4][l] * f[6][l]);
}

void foam_reference_update(const sf_foam *foam, double dt, sf_law_batch *b, int l) {
    double c[9], old[9], e[6] = {0}, s[6] = {0}, part[3], added[3], a[3], eta[3], extra = 0;
    principal p;
    right_cauchy_green(b->f, l, c);
    right_cauchy_green(b->f_old, l, old);
    for (int r = 0; r < 3 && dt > 0; r++)
        for (int k = r; k < 3; k++)
            e[SYM[r][k]] = 0.5 * (c[3 * r + k] - old[3 * r + k]) / dt;
    b->jacobian[l] = determinant(b->f, l);
    eigen(c, p.stretch, p.n);
    base_law(foam, &p);
    if (dt > 0)
        look_ahead(foam, dt, e, &p);
    hysteresis(foam, &b->history[SF_FOAM_PEAK][l], &p);
    b->energy[l] = p.energy;
    b->factor[l] = p.factor;
    sf_foam_energies(foam, p.energy, b->history[SF_FOAM_PEAK][l], &b->stored[l], &b->lost[l]);
    b->stiffness[l] = fmax(fmax(foam->modulus, foam->curve[0].piece[0].c[1]),
                           fmax(p.slope[0], fmax(p.slope[1], p.slope[2])));
    b->work[l] = 0;
    for (int i = 0; i < 3; i++)
        part[i] = p.factor * p.t[i] / p.stretch[i];
    if (foam->curve_count > 1 && dt > 0)
        extra = overstress(foam, dt, &p, e, &b->history[SF_FOAM_RATE][l], part);
    for (int i = 0; i < 3; i++)
        added[i] = part[i] - p.factor * p.t[i] / p.stretch[i];
    if (foam->curve_count > 1 && dt > 0)
        work_of(&p, added, dt, e, b, l);
    double damp = foam->options.damp * b->length[l] * sqrt(foam->options.density * b->stiffness[l]);
    bounds(foam, &p, damp, a, eta);
    for (int k = 0; k < 6; k++)
        b->directional[k][l] = 0;
    for (int r = 0; r < 3; r++)
        for (int k = r; k < 3; k++)
            for (int i = 0; i < 3; i++) {
                double nn = p.n[3 * r + i] * p.n[3 * k + i];
                s[SYM[r][k]] += part[i] * nn;
                b->directional[SYM[r][k]][l] += (a[i] + extra + (dt > 0 ? 2 / dt : 0) * eta[i]) * nn;
            }
    double geometric = viscous(foam, dt, b, l, e, s);
    b->tangent[l] = b->viscosity[l] = 0;
    for (int i = 0; i < 3; i++) {
        b->stretch[i][l] = p.stretch[i];
        b->direction_tangent[i][l] = a[i] + extra + geometric;
        b->direction_viscosity[i][l] = eta[i];
        b->tangent[l] = larger(b->tangent[l], a[i] + extra + geometric);
        b->viscosity[l] = larger(b->viscosity[l], eta[i]);
    }
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            b->p[3 * i + j][l] = 0;
            for (int k = 0; k < 3; k++)
                b->p[3 * i + j][l] += b->f[3 * i + k][l] * s[SYM[k][j]];
        }
    if (foam->options.damp > 0 && dt > 0)
        damping(dt, damp, b, l);
}
