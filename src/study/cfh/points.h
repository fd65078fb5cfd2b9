/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "io/table_csv.h"
#include "post/figures/verdict.h"

/* Drop height and speed at contact. In free fall v^2 = 2 g h with g = 9.80665 m s-2. On a rig whose guides
 * rub, v^2 = 2 g_eff h with a g_eff below that, fitted to measured pairs of height and speed. */

enum { SF_CFH_MAX_PAIRS = 64 };

typedef struct sf_cfh_rig {
    int pairs;                                    /* 0: free fall */
    double gravity;                               /* m s-2, g_eff, or g */
    double standard_error;                        /* m s-2 */
    double margin;                                /* -, half-width of the 95 % interval of ln(g_eff) */
    char interpretation[SF_TABLE_INTERPRETATION]; /* how its file was read; empty: there is none */
} sf_cfh_rig;

/* Free fall. */
sf_cfh_rig sf_cfh_free_fall(void);

/* The same from a CSV file (io/table_csv.h) with a column height_m, h_m or h_m_m ("h_m" in m) and a column
 * speed_m_s or v_test_m_s, or a height and a speed with units. */
sf_status sf_cfh_rig_read(const char *path, sf_cfh_rig *rig, sf_error *err);

double sf_cfh_speed(double free_fall_height);
double sf_cfh_free_fall_height(double speed);

/* The height at which a quantity that grows with the drop height reaches its limit: a quadratic of
 * ln(value) in ln(height) through the simulated points near the limit, its crossing, and the crossing's
 * confidence interval. */

enum { SF_CFH_MIN_POINTS = 4 }; /* of a fit: a quadratic and one degree of freedom */

/* ln(value) = c[0] + c[1] d + c[2] d^2, d = ln(height) - centre. */
typedef struct sf_cfh_fit {
    int count; /* points in the fit, 0: no fit */
    int first; /* index of the lowest of them */
    double low, high; /* m, the lowest and the highest of them */
    double centre;
    double c[3];
    double covariance[3][3];
    double rms; /* -, of the residuals of ln(value) */
} sf_cfh_fit;

typedef enum sf_cfh_side {
    SF_CFH_CROSSED,     /* the limit lies between two points */
    SF_CFH_NOT_REACHED, /* every point is below the limit */
    SF_CFH_EXCEEDED,    /* every point is at or above it */
} sf_cfh_side;

typedef struct sf_cfh_crossing {
    sf_cfh_side side;
    double height;    /* m, NaN unless crossed */
    double margin;    /* -, half-width of the 95 % interval of ln(height) */
    double low, high; /* m, that interval */
    bool bracketed;   /* the quadratic does not describe the points: the interval is that of the two drops on
                         both sides of the limit, the height lies on the chord between them */
    sf_cfh_fit fit;   /* without a crossing: of the points nearest the limit, if they are enough */
} sf_cfh_crossing;

/* height: [count] m, ascending; value: [count] positive. `name` is the quantity, for sentences. The fit takes
 * the points within a factor of 1.6 of the crossing, and at least the nearest four. The interval is that of
 * the fit (Student's t, first order): it measures how well a quadratic fits the points, not the error of the
 * model. Where its residuals exceed 3 %, as of a foam that locks up, or it crosses the limit elsewhere than
 * the drops do, the crossing is bracketed. Errors: SF_ERR_INPUT for points that are not as described, or
 * fewer than four with a crossing among them; SF_ERR_NUMERIC for values that fall by more than 2 % from one
 * height to a greater one. */
sf_status sf_cfh_cross(const char *name, int count, const double *height, const double *value, double limit,
                       sf_cfh_crossing *crossing, sf_error *err);

/* Value of the fit at a height (m). */
double sf_cfh_fit_at(const sf_cfh_fit *fit, double height);

/* The simulated drops of a critical fall height, in ascending height, and the results read from them. Heights
 * are those of free fall unless a name says "rig". */

typedef enum sf_cfh_criterion { SF_CFH_A_MAX, SF_CFH_HIC, SF_CFH_CRITERIA } sf_cfh_criterion;

enum { SF_CFH_MAX_POINTS = 16, SF_CFH_NOTE_SIZE = 1100 };

typedef struct sf_cfh_point {
    double height;  /* m */
    double speed;   /* m s-1, at contact */
    bool failed;    /* no figures (they are NaN): the simulation failed, or its verdict is "do not use" */
    bool on_anvil;  /* it failed as the missile reached the anvil: worse than every limit */
    double least[SF_CFH_CRITERIA]; /* g, -: if it failed, what is sure of them all the same; 0: nothing */
    sf_grade grade; /* of the run; "do not use" if it failed */
    double value[SF_CFH_CRITERIA];   /* g, - */
    double scatter[SF_CFH_CRITERIA]; /* -, of single pads and drops (a_max_scatter, hic_scatter); NaN: not
                                        known */
    double v_rebound;                /* m s-1, NaN: contact had not ended */
    double max_indentation;          /* m */
    double max_local_strain;         /* - */
    double energy_error;             /* - */
    char note[SF_CFH_NOTE_SIZE];     /* sentence, or "" */
} sf_cfh_point;

typedef struct sf_cfh_points {
    int count;
    sf_cfh_point point[SF_CFH_MAX_POINTS];
} sf_cfh_points;

typedef enum sf_cfh_verdict {
    SF_CFH_FOUND,
    SF_CFH_ABOVE,   /* no limit was reached: the critical height is above the highest point, and below
                       `exceeding` */
    SF_CFH_BELOW,   /* a limit was exceeded at the lowest point, or no point is below `exceeding`: it is
                       below that */
    SF_CFH_UNKNOWN, /* no simulation succeeded or exceeds a limit, or no crossing could be read: `problem`
                       says why */
} sf_cfh_verdict;

typedef struct sf_cfh_result {
    sf_cfh_verdict verdict;
    sf_cfh_criterion deciding; /* of FOUND and BELOW; unless `lowest` is NaN */
    double lowest, highest;    /* m, of the simulations that succeeded, below `exceeding`; NaN: none */
    const sf_cfh_point *exceeding; /* of the points, the lowest that failed and yet exceeds a limit: on the
                                      anvil, or by `least`; NULL: none */
    sf_cfh_crossing crossing[SF_CFH_CRITERIA];
    sf_error problem; /* of UNKNOWN */
} sf_cfh_result;

/* Inserts a point in order of height; the caller ensures that there is room. */
void sf_cfh_points_add(sf_cfh_points *points, const sf_cfh_point *point);

/* The crossings with limit[SF_CFH_CRITERIA], and which of them decides: the lowest. */
void sf_cfh_evaluate(const sf_cfh_points *points, const double *limit, sf_cfh_result *result);

/* "a_max" and "HIC"; " g" and "" (units with a blank before them). Static storage. */
const char *sf_cfh_name(sf_cfh_criterion criterion);
const char *sf_cfh_unit(sf_cfh_criterion criterion);

/* Height on the rig (m) for one of free fall, and the half-width of the 95 % interval of its logarithm when
 * that of the height is `margin`. */
double sf_cfh_rig_height(const sf_cfh_rig *rig, double height);
double sf_cfh_rig_margin(const sf_cfh_rig *rig, double margin);

/* Which heights to simulate next: up or down in ln(height) until the limit that is met first lies between two
 * points, then on both sides of its crossing, where the quadratic needs them. Two heights at a time, which
 * may be simulated side by side. Depends on the points alone, so a search that is repeated, with whatever
 * number of drops at once, takes the same way. */

typedef enum sf_cfh_step {
    SF_CFH_SIMULATE,      /* the heights given */
    SF_CFH_LIST_DONE,     /* every height of the list */
    SF_CFH_ENOUGH,        /* points on both sides, the crossing known to 1 % or no place left */
    SF_CFH_AT_MAX_HEIGHT, /* no limit reached up to the greatest height allowed */
    SF_CFH_AT_MIN_HEIGHT, /* a limit exceeded down to 1 cm */
    SF_CFH_COLLAPSED,     /* no limit reached up to where simulations fail */
    SF_CFH_AT_CAP,        /* as many drops as allowed */
} sf_cfh_step;

typedef struct sf_cfh_plan {
    double limit[SF_CFH_CRITERIA]; /* g, - */
    double first;                  /* m, height of the first drop */
    double max_height;             /* m */
    int max_drops; /* of a search, but for those that divide a bracket: SF_CFH_MAX_POINTS in all */
    int list_count;                 /* a list instead of a search, 0: none */
    double list[SF_CFH_MAX_POINTS]; /* m, ascending */
    double unit; /* m of free fall for 1 m on the user's scale; heights are rounded there */
} sf_cfh_plan;

/* Heights that are simulated before the next are chosen. */
typedef struct sf_cfh_round {
    int count;    /* 1 or 2 of a search; of a list all of it */
    bool divides; /* they divide the bracket of a limit, which a quadratic misses: the cap does not hold */
    double height[SF_CFH_MAX_POINTS];
} sf_cfh_round;

/* `round` is set for SF_CFH_SIMULATE. */
sf_cfh_step sf_cfh_next(const sf_cfh_plan *plan, const sf_cfh_points *points, sf_cfh_round *round);

/* Why the search ended, in words; static storage. */
const char *sf_cfh_step_text(sf_cfh_step step);
