/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mesh study of the paper's drops: a_max and HIC against the core spacing, with observed order, extrapolated
 * value and error bar; and the bounds that the drops must keep. */
#include "drop.h"
#include "study.h"
#include "model/good_run.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CASES = 5, SPACINGS = 5, REFERENCE = 2 };

static const char *const examples[CASES] = {"eva50-v4.5", "eva50-v5.2", "eva70-v4.5", "eva70-v5.2",
                                            "eva70-v6.2"};
/* mm; the thickness of the pads is no multiple of 20/3 and 10/3 mm, so that the layers come out slightly
 * thinner or thicker */
static const double spacing[SPACINGS] = {10, 20.0 / 3, 5, 4, 10.0 / 3};

typedef struct fit {
    double order, limit, bar;
} fit;

/* Residual of the best y = limit + c h^order through all points, for a given order. */
static double residual(const double *y, double order, double *limit, double *c) {
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0, sum = 0;
    for (int k = 0; k < SPACINGS; k++) {
        double x = pow(spacing[k], order);
        n++;
        sx += x;
        sy += y[k];
        sxx += x * x;
        sxy += x * y[k];
    }
    *c = (n * sxy - sx * sy) / (n * sxx - sx * sx);
    *limit = (sy - *c * sx) / n;
    for (int k = 0; k < SPACINGS; k++) {
        double r = y[k] - *limit - *c * pow(spacing[k], order);
        sum += r * r;
    }
    return sum;
}

/* Order by least squares over 0.5 to 4; the bar is Roache's 1.25 x the difference to the limit at 5 mm, or
 * three times the scatter of the fit if that is larger. */
static fit extrapolate(const double *y) {
    fit best = {0, 0, 0};
    double least = INFINITY, c, limit;
    for (double p = 0.5; p <= 4.0001; p += 0.01) {
        double r = residual(y, p, &limit, &c);
        if (r < least) {
            least = r;
            best = (fit){p, limit, 0};
        }
    }
    best.bar = fmax(1.25 * fabs(y[REFERENCE] - best.limit), 3 * sqrt(least / SPACINGS));
    return best;
}

static void check_bounds(sf_study *study, const char *name, const sf_drop *drop) {
    const sf_drop *d = &drop[REFERENCE];
    const sf_good_run *good = sf_good_run_limits();
    double v0 = atof(strstr(name, "-v") + 2);
    sf_study_check(study, 100 * fabs(drop[0].a_max_g / d->a_max_g - 1), -INFINITY, 3,
                   "%s: a_max, 10 against 5 mm (%%)", name);
    sf_study_check(study, 100 * fabs(drop[0].hic / d->hic - 1), -INFINITY, 4, "%s: HIC, 10 against 5 mm (%%)",
                   name);
    sf_study_check(study, 100 * fabs(d->a_max_raw_g / d->a_max_g - 1), -INFINITY, 100 * good->filter,
                   "%s: raw against CFC 1000 (%%)", name);
    sf_study_check(study, d->energy_error, -INFINITY, good->energy_error, "%s: energy error", name);
    sf_study_check(study, d->stabilisation_energy_fraction, -INFINITY, good->stabilisation,
                   "%s: stabilisation energy share", name);
    sf_study_check(study, d->contact_energy_fraction, -INFINITY, good->contact, "%s: contact energy share",
                   name);
    sf_study_check(study, d->momentum_error, -INFINITY, 1e-6, "%s: momentum against impulse", name);
    sf_study_check(study, d->constraint_residual_m_s / v0, -INFINITY, 1e-10,
                   "%s: constraint residual over v0", name);
    sf_study_check(study, d->local_collapse, -INFINITY, good->local_collapse,
                   "%s: compression of a node above the median of its neighbours", name);
}

static void tabulate(sf_study *study, FILE *data, const char *name, const sf_drop *drop) {
    double a[SPACINGS], hic[SPACINGS];
    for (int k = 0; k < SPACINGS; k++) {
        const sf_drop *d = &drop[k];
        a[k] = d->a_max_g;
        hic[k] = d->hic;
        sf_study_text(
            study, "| %s | %.3f | %.0f | %.0f | %.3f | %.2f | %.2f to %.2f | %.4f | %.3f | %.1e | %.0f |\n",
            name, spacing[k], d->nodes, d->steps, d->a_max_g, d->hic, d->hic_t1_ms, d->hic_t2_ms,
            d->max_local_strain, d->v_rebound_m_s, d->energy_error, d->wall_s);
        if (data)
            fprintf(data, "%g %g %g\n", spacing[k], d->a_max_g, d->hic);
    }
    if (data)
        fputs("\n\n", data);
    fit fa = extrapolate(a), fh = extrapolate(hic);
    sf_study_text(study, "| %s | → 0 | | | %.2f ± %.2f (order %.1f) | %.1f ± %.1f (order %.1f) | | | | | |\n",
                  name, fa.limit, fa.bar, fa.order, fh.limit, fh.bar, fh.order);
}

int main(int argc, char **argv) {
    sf_study study;
    sf_drop drop[CASES][SPACINGS];
    sf_study_begin(&study, "mesh", "Mesh study of the paper's drops", argc, argv);
    sf_study_text(
        &study,
        "Quarter models with an outer spacing twice that of the core and the foam of "
        "verify/materials/eva_like.cfg. The last row of each case is extrapolated by a + c h^p over all five "
        "spacings; its error bar is 1.25 times its distance from the 5 mm value, or three times the scatter "
        "of the fit if that is larger.\n\n| case | core spacing (mm) | nodes | steps | a_max (g) | HIC | "
        "window (ms) | largest local strain | rebound (m/s) | energy error | wall (s) "
        "|\n|---|---|---|---|---|---|---|---|---|---|---|\n");
    FILE *data = sf_study_file(&study, "data.txt");
    int done = 0;
    for (int c = 0; c < CASES; c++) {
        sf_error err = SF_ERROR_INIT;
        for (int k = 0; k < SPACINGS && err.status == SF_OK; k++) {
            char fine[96], outer[96];
            snprintf(fine, sizeof fine, "geometry.parameters.fine_spacing=%.17g", spacing[k]);
            snprintf(outer, sizeof outer, "geometry.parameters.outer_spacing=%.17g", 2 * spacing[k]);
            const char *const overrides[] = {fine, outer, NULL};
            sf_drop_run(examples[c], overrides, 1, NULL, &drop[c][k], &err);
        }
        if (err.status != SF_OK) {
            sf_study_fail(&study, &err);
            return sf_study_end(&study);
        }
        tabulate(&study, data, examples[c], drop[c]);
        done++;
    }
    if (data)
        fclose(data);
    sf_study_plot(&study, "convergence.png", "a_max against the core spacing, relative to 5 mm",
                  "set xlabel 'core spacing (mm)'\nset ylabel 'a_{max} relative to 5 mm'\nset xrange "
                  "[0:11]\nset key bottom left\n"
                  "do for [k=0:4] { stats 'mesh-data.txt' index k every ::2::2 using 2 nooutput; "
                  "eval sprintf('r%d=%.17g', k, STATS_max) }\n"
                  "plot 'mesh-data.txt' index 0 u 1:($2/r0) w lp lw 2 t '50 mm, 4.5 m/s', '' index 1 u "
                  "1:($2/r1) w lp lw 2 t "
                  "'50 mm, 5.2 m/s', '' index 2 u 1:($2/r2) w lp lw 2 t '70 mm, 4.5 m/s', '' index 3 u "
                  "1:($2/r3) w lp lw 2 t "
                  "'70 mm, 5.2 m/s', '' index 4 u 1:($2/r4) w lp lw 2 t '70 mm, 6.2 m/s'\n");
    for (int c = 0; c < done; c++)
        check_bounds(&study, examples[c], drop[c]);
    return sf_study_end(&study);
}
