/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The compression curve of a foam as the solver evaluates it: nominal stress, slope and strain energy against
 * engineering strain, compression positive.
 *
 * Inside the data: Steffen's monotone interpolant (Steffen 1990, the slopes of the ends by parabolas),
 * resampled to a uniform table of cubic Hermite pieces, monotone too, whose integral is exact, so that stress
 * is the derivative of energy to rounding. Beyond the densification start eps_e: sigma = A + B / (eps_L -
 * eps)^m, continuous with its slope there ("Du Bois extrapolation"; theory, section "Densification"). Rule H1
 * is eps_L = 1; without an exponent m is the one that makes A vanish.
 *
 * Near the pole the curve goes on straight, so that stress, slope and energy are finite at any strain, that
 * of a point that a time step throws beyond the pole too: where SF_STRAIGHT_ROOM of the way from eps_e to
 * eps_L is left or the slope is SF_STRAIGHT_SLOPE times that at eps_e, whichever comes first. With the pole
 * at full compression no strain is left beyond it in which the line could stop a missile: there it begins
 * later.
 *
 * A weak law (m near 1 or below) takes little energy on the whole way to full compression, which a missile
 * would then reach: det F = 0. Where the curve with its line would take less than SF_STOP_ENERGY, the line
 * begins SF_STOP_ROOM before 1 (not before eps_e), and a square of the strain beyond its start is added that
 * takes the rest.
 */
#pragma once
#include "material/foam_card.h"

enum { SF_CURVE_INTERVALS = 1024 };

#define SF_STRAIGHT_ROOM 0.05
#define SF_STRAIGHT_SLOPE 1e3
#define SF_STRAIGHT_ROOM_AT_1 0.01 /* the same for eps_L = 1 */
#define SF_STRAIGHT_SLOPE_AT_1 1e6
#define SF_STOP_ENERGY 5e6 /* J m-3 to full compression: that of a solid polymer (2 GPa) at 7 % */
#define SF_STOP_ROOM 0.05  /* -, strain */

/* One piece: energy at its left end and the cubic's coefficients in t = strain - left end. */
typedef struct sf_curve_piece {
    double energy;
    double c[4];
} sf_curve_piece;

/* The law beyond the data. */
typedef struct sf_densification {
    double start;        /* -, eps_e */
    double limit;        /* -, eps_L */
    double exponent;     /* -, m */
    double constant;     /* Pa, A */
    double factor;       /* Pa, B (with (eps_L - eps) dimensionless) */
    double start_energy; /* J m-3, energy at eps_e */
} sf_densification;

/* The straight line that ends the curve, and the stop of a weak one. */
typedef struct sf_curve_line {
    double start;  /* -, its first strain */
    double stress; /* Pa, there */
    double slope;  /* Pa, there */
    double energy; /* J m-3, there */
    double stop;   /* Pa, factor of the square of the strain beyond its start; 0: none is needed */
} sf_curve_line;

typedef struct sf_curve {
    double step;           /* -, width of a piece */
    double start;          /* -, eps_e */
    sf_curve_piece *piece; /* [SF_CURVE_INTERVALS] owned */
    sf_densification beyond;
    sf_curve_line straight;
} sf_curve;

/* The law from `start` to `limit` that continues stress (Pa), slope (Pa) and energy (J m-3) at the start. */
sf_densification sf_densification_join(double start, double limit, double exponent, double stress,
                                       double slope, double energy);
/* m that makes A vanish. */
double sf_densification_natural_exponent(double start, double limit, double stress, double slope);
/* The same, but at least 1: with less the energy up to the pole is finite. */
double sf_densification_steep_exponent(double start, double limit, double stress, double slope);
/* Stress (Pa), slope (Pa) and energy (J m-3) at a strain from the start on; INFINITY from the limit on. */
void sf_densification_evaluate(const sf_densification *law, double strain, double *stress, double *slope,
                               double *energy);

/* Builds curve `index` of the card. Errors: fewer than 3 points, strains that do not ascend, densification
 * start beyond the data, a slope at the start that is not positive, eps_L not beyond the start. */
sf_status sf_curve_build(const sf_foam_card *foam, int64_t index, sf_curve *curve, sf_error *err);
void sf_curve_free(sf_curve *curve);

/* Stress (Pa), slope (Pa) and energy (J m-3) at a compressive strain of at least 0; finite, beyond 1 too. */
void sf_curve_evaluate(const sf_curve *curve, double strain, double *stress, double *slope, double *energy);

/* The same at SF_LANES strains; one below 0 counts as 0, NaN too. */
void sf_curve_evaluate_lanes(const sf_curve *curve, const double strain[SF_LANES], double stress[SF_LANES],
                             double slope[SF_LANES], double energy[SF_LANES]);
