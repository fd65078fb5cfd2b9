/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The hyperfoam against an independent code: material points and the indentation of a pad in CalculiX (ccx).
 * Exit code 77, "skipped", without ccx. */
#include "extreme.h"
#include "study.h"

#include "calculix/ccx.h"
#include "calculix/indentation.h"
#include "material/hyperfoam.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS = 40, SKIPPED = 77, MESHES = 2 };
static const int layers[MESHES] = {7, 10};
static const sf_indentation_case usual = {.layers = 7,
                                          .depth = 30e-3,
                                          .interval = 2e-3,
                                          .speed = 1,
                                          .modulus = 1,
                                          .nodes = true,
                                          .penalty = 100,
                                          .facet = 3};

/* ---- material points ---- */

typedef enum path { UNIAXIAL, BIAXIAL, CONFINED, SHEAR, PATHS } path;
static const char *const path_names[PATHS] = {"uniaxial, sides free", "biaxial, third direction free",
                                              "confined", "simple shear at 30 % compression"};

static sf_hyperfoam make_law(const sf_ogden *law) {
    sf_hyperfoam_card card = {.shared.density = 35,
                              .shared.hysteresis_hu = 1,
                              .shared.hysteresis_shape = 1,
                              .shared.hysteresis_alpha = 1,
                              .shared.maxwell_rate = 5000};
    for (int k = 0; k < SF_OGDEN_TERMS; k++)
        card.term[k] = (sf_hyperfoam_term){.mu = law->mu[k], .alpha = law->alpha[k], .nu = law->nu[k]};
    return sf_hyperfoam_build(&card);
}

/* Compression to 85 %, shear to 100 %. Where sides are free, they move as softfall's law says: CalculiX must
 * find no force there. */
static void make_path(const sf_hyperfoam *law, path p, double f[POINTS][9]) {
    double x[3] = {1, 1, 1};
    for (int k = 0; k < POINTS; k++) {
        double part = (k + 1.) / POINTS, stretch = 1 - 0.85 * part;
        memset(f[k], 0, sizeof f[k]);
        x[0] = stretch;
        x[1] = p == BIAXIAL ? stretch : p == UNIAXIAL ? x[1] : 1;
        if (p == UNIAXIAL || p == BIAXIAL)
            sf_hyperfoam_release(law, p == UNIAXIAL ? 1 : 2, x);
        if (p == SHEAR)
            x[0] = 1 - 0.3 * part;
        for (int i = 0; i < 3; i++)
            f[k][4 * i] = x[i];
        f[k][1] = p == SHEAR ? part : 0;
    }
}

/* Nominal stresses of softfall's batch, MPa. */
static void softfall_stress(const sf_hyperfoam *law, const double f[9], double p[9]) {
    static sf_law_batch b;
    memset(&b, 0, sizeof b);
    for (int k = 0; k < 9; k++)
        for (int l = 0; l < SF_LANES; l++)
            b.f[k][l] = b.f_old[k][l] = f[k];
    sf_hyperfoam_update(law, 0, &b);
    for (int k = 0; k < 9; k++)
        p[k] = 1e-6 * b.p[k][0];
}

/* Largest difference of a component of P, over the largest component of that state. */
static double point_difference(const char *folder, const sf_ogden *ogden, path p, sf_error *err) {
    static const char set[3][3] = {"NX", "NY", "NZ"};
    char name[1024];
    double f[POINTS][9], worst = 0;
    sf_hyperfoam law = make_law(ogden);
    sf_ccx_run ended;
    sf_ccx_forces forces[3] = {{0}};
    make_path(&law, p, f);
    snprintf(name, sizeof name, "%s/point.inp", folder);
    FILE *file = fopen(name, "w");
    if (file)
        sf_deck_path(ogden, POINTS, (const double(*)[9])f, file);
    if (!file || fclose(file) != 0)
        SF_FAIL(err, SF_ERR_IO, "%s cannot be written", name);
    if (err->status == SF_OK)
        sf_ccx_solve(folder, "point", &ended, err);
    for (int c = 0; c < 3 && err->status == SF_OK; c++)
        if (sf_ccx_forces_read(folder, "point", set[c], &forces[c], err) == SF_OK &&
            forces[c].count != POINTS)
            SF_FAIL(err, SF_ERR_NUMERIC, "%d of %d states", forces[c].count, POINTS);
    for (int k = 0; k < POINTS && err->status == SF_OK; k++) {
        double stress[9], scale = 0;
        softfall_stress(&law, f[k], stress);
        for (int i = 0; i < 9; i++)
            scale = larger(scale, fabs(stress[i]));
        for (int i = 0; i < 3; i++)
            for (int j = 0; j < 3; j++)
                worst = larger(worst, fabs(forces[j].force[3 * k + i] - stress[3 * i + j]) / scale);
    }
    for (int c = 0; c < 3; c++)
        sf_ccx_forces_free(&forces[c]);
    return worst;
}

static void study_points(sf_study *s, const char *folder) {
    static const double nus[][SF_OGDEN_TERMS] = {{0, 0}, {0.1, 0.1}, {0.25, 0.25}, {0, 0.3}};
    sf_study_text(
        s,
        "### Material points\n\nOne C3D8 element, `*HYPERFOAM` with two terms (μ = 11.2 and 90.6 kPa, α = -2 and "
        "3.25), in %d increments: compression to 85 %%, shear to 100 %%. Largest difference of a component of P, "
        "over the largest component of its state; CalculiX's force on free sides counts as a difference. CalculiX "
        "prints 7 digits.\n\n",
        POINTS);
    for (size_t n = 0; n < sizeof nus / sizeof *nus; n++)
        for (int p = 0; p < PATHS; p++) {
            sf_error err = SF_ERROR_INIT;
            sf_ogden law = sf_ogden_foam();
            memcpy(law.nu, nus[n], sizeof law.nu);
            double difference = point_difference(folder, &law, (path)p, &err);
            if (err.status != SF_OK)
                sf_study_fail(s, &err);
            else
                sf_study_check(s, difference, 0, 1e-6, "ν = %g and %g: %s", nus[n][0], nus[n][1],
                               path_names[p]);
        }
}

/* ---- the pad ---- */

typedef struct pair {
    sf_indentation_curve softfall, calculix;
} pair;

/* The value at h = 0 through both meshes, F = F0 + a h2. */
static double limit(double coarse, double fine) {
    double c = layers[0] * layers[0], f = layers[1] * layers[1];
    return (f * fine - c * coarse) / (f - c);
}

static double limit_difference(const pair p[MESHES], int k) {
    return limit(p[0].softfall.force[k], p[1].softfall.force[k]) /
               limit(p[0].calculix.force[k], p[1].calculix.force[k]) -
           1;
}

static double difference(const sf_indentation_curve *a, const sf_indentation_curve *b, int k) {
    return a->force[k] / b->force[k] - 1;
}

/* Of the points from `first` on that both have. */
static double largest_difference(const sf_indentation_curve *a, const sf_indentation_curve *b, int first) {
    double worst = 0;
    for (int k = first; k < a->count && k < b->count; k++)
        worst = larger(worst, fabs(difference(a, b, k)));
    return worst;
}

static int fewest(const pair p[MESHES]) {
    int a = p[0].calculix.count, b = p[1].calculix.count;
    return a < b ? a : b;
}

static double largest_of_limits(const pair p[MESHES], int first) {
    double worst = 0;
    for (int k = first; k < fewest(p); k++)
        worst = larger(worst, fabs(limit_difference(p, k)));
    return worst;
}

static void describe(sf_study *s, const sf_indentation *in) {
    sf_study_text(
        s,
        "### Indentation\n\nThe sphere and the quarter pad of the study above, with ν = %g in both terms. The bound "
        "of 2 %% is for CalculiX's contact *node to surface*, which keeps the nodes of the pad's top out of the "
        "sphere, as softfall does; *face to face* keeps the faces between them out, too, up to h² / 4R deeper. Node "
        "to surface diverges before 30 mm at 7.14 mm, so the depth is checked at 5 mm only. The bound and this choice "
        "were made after face to face had shown 1.8 to 3.7 %% at 5 mm.\n\n",
        in->law.nu[0]);
}

static void print_number(sf_study *s, const sf_indentation_curve *softfall,
                         const sf_indentation_curve *calculix, int k) {
    if (k < calculix->count)
        sf_study_text(s, " | %.1f | %+.1f %%", calculix->force[k], 100 * difference(softfall, calculix, k));
    else
        sf_study_text(s, " | | ");
}

static void print_forces(sf_study *s, const pair p[MESHES], const sf_indentation_curve *faces) {
    sf_study_text(s, "Force in N, and softfall's difference from CalculiX; h → 0: the line F₀ + a h² through "
                     "both meshes, node to surface.\n\n| depth");
    for (int m = 0; m < MESHES; m++)
        sf_study_text(s, " | %.3g mm: softfall | nodes | ", 50. / layers[m]);
    sf_study_text(s, " | h → 0 | %.3g mm: faces | |\n|---|---|---|---|---|---|---|---|---|---|\n",
                  50. / layers[0]);
    for (int k = 0; k < p[0].softfall.count; k++) {
        sf_study_text(s, "| %.0f mm", 1e3 * usual.interval * (k + 1));
        for (int m = 0; m < MESHES; m++) {
            sf_study_text(s, " | %.1f", p[m].softfall.force[k]);
            print_number(s, &p[m].softfall, &p[m].calculix, k);
        }
        if (k < fewest(p))
            sf_study_text(s, " | %+.1f %%", 100 * limit_difference(p, k));
        else
            sf_study_text(s, " | ");
        print_number(s, &p[0].softfall, faces, k);
        sf_study_text(s, " |\n");
    }
    sf_study_text(s, "\nCPU seconds of softfall and CalculiX: ");
    for (int m = 0; m < MESHES; m++)
        sf_study_text(s, "%.0f and %.0f at %.3g mm; ", p[m].softfall.cpu, p[m].calculix.cpu, 50. / layers[m]);
    sf_study_text(s, "%.0f face to face.\n\n", faces->cpu);
}

static void check_pad(sf_study *s, const pair p[MESHES]) {
    sf_study_check(s, 2 * p[1].calculix.count, 30, INFINITY, "depth that CalculiX reached at %.3g mm (mm)",
                   50. / layers[1]);
    sf_study_check(s, largest_difference(&p[1].softfall, &p[1].calculix, 0), 0, 0.02,
                   "difference at %.3g mm, every point from 2 to 30 mm", 50. / layers[1]);
    sf_study_check(s, largest_of_limits(p, 4), 0, 0.02,
                   "difference of the limits h → 0, every point from 10 to %d mm", 2 * fewest(p));
}

static sf_status study_pad(sf_study *s, const sf_indentation *in, sf_error *err) {
    pair p[MESHES];
    sf_indentation_case c = usual;
    sf_indentation_curve faces;
    for (int m = 0; m < MESHES; m++) {
        c.layers = layers[m];
        if (sf_indentation_softfall(in, &c, &p[m].softfall, err) != SF_OK ||
            sf_indentation_calculix(in, &c, &p[m].calculix, err) != SF_OK)
            return err->status;
    }
    c.layers = layers[0];
    c.nodes = false;
    if (sf_indentation_calculix(in, &c, &faces, err) != SF_OK)
        return err->status;
    describe(s, in);
    print_forces(s, p, &faces);
    check_pad(s, p);
    return SF_OK;
}

int main(int argc, char **argv) {
    char version[64];
    sf_study s;
    sf_indentation in;
    sf_error err = SF_ERROR_INIT;
    bool present = sf_ccx_present(version);
    sf_study_begin(&s, "hyperfoam", "Hyperfoam against CalculiX", argc, argv);
    if (!present) {
        sf_study_text(
            &s, "Skipped: CalculiX (the program `ccx`, Debian package calculix-ccx) is not installed.\n\n");
        sf_study_end(&s);
        return SKIPPED;
    }
    if (sf_indentation_begin_hyperfoam(&in, 0.25, &err) == SF_OK) {
        study_points(&s, in.folder);
        study_pad(&s, &in, &err);
        sf_indentation_end(&in);
    }
    if (err.status != SF_OK)
        sf_study_fail(&s, &err);
    return sf_study_end(&s);
}
