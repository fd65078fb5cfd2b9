/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What matters: one change at a time of the 50 mm, 4.5 m/s drop. */
#include "drop.h"
#include "study.h"

#include <math.h>

enum { MAX_OVERRIDES = 3 };

typedef enum group { NUMERICS, PAD, MATERIAL, KINDS } group;
static const char *const kind_name[KINDS] = {
    "numerics (model size, stabilisation, support, time step, outer spacing, triangles)",
    "boundary of the pad (its size, glue, friction)", "foam and drop"};

typedef struct variation {
    group kind;
    const char *what;
    const char *overrides[MAX_OVERRIDES + 1];
    double a_bound, hic_bound; /* %, required; 0 = none */
} variation;

static const variation variations[] = {
    {NUMERICS,
     "full model",
     {"geometry.parameters.quarter=0", "geometry.missile_parameters.quarter=0"},
     0.5,
     0.5},
    {NUMERICS, "stabilisation 0.05", {"kernel.stabilisation=0.05"}, 1, 1},
    {NUMERICS, "stabilisation 0.2", {"kernel.stabilisation=0.2"}, 1, 1},
    {NUMERICS, "stabilisation 0.5", {"kernel.stabilisation=0.5"}, 0, 0},
    {NUMERICS, "no stabilisation", {"kernel.stabilisation=0.0"}, 0, 0},
    {NUMERICS, "R/h = 1.2", {"kernel.support_ratio=1.2"}, 0, 0},
    {NUMERICS, "R/h = 1.5", {"kernel.support_ratio=1.5"}, 0, 0},
    {NUMERICS, "R/h = 1.7", {"kernel.support_ratio=1.7"}, 0, 0},
    {NUMERICS, "condition limit 1000", {"kernel.condition_limit=1000.0"}, 0, 0},
    {NUMERICS, "time step halved", {"solver.step_safety=0.485"}, 0, 0},
    {PAD, "pad side 280 mm", {"geometry.parameters.side=280"}, 0, 0},
    {PAD, "pad side 600 mm", {"geometry.parameters.side=600"}, 0, 0},
    {NUMERICS, "impact zone 260 mm", {"geometry.parameters.zone_side=260"}, 0, 0},
    {NUMERICS, "outer spacing 20 mm", {"geometry.parameters.outer_spacing=20"}, 0, 0},
    {PAD, "smooth anvil instead of glue", {"pad.fixed=[]", "pad.sliding=[\"base\"]"}, 0, 0},
    {NUMERICS, "contact with the 10 mm triangles", {"missile.shape=surface"}, 0, 0},
    {NUMERICS,
     "contact with 5 mm triangles",
     {"missile.shape=surface", "geometry.missile_parameters.element_size=5"},
     0,
     0},
    {PAD, "friction 0.2", {"missile.friction=0.2"}, 0, 0},
    {PAD, "friction 0.5", {"missile.friction=0.5"}, 0, 0},
    {MATERIAL, "DAMP 0", {"material.DAMP=0.0"}, 0, 0},
    {MATERIAL, "DAMP with L = 5 mm everywhere", {"material.damp_length=5 mm"}, 0, 0},
    {MATERIAL, "no rate term", {"material.ED=0 Pa"}, 0, 0},
    {MATERIAL, "no hysteresis (HU = 1)", {"material.HU=1.0"}, 0, 0},
    {MATERIAL, "curve cut at 80 %, then H1", {"material.densification.start=0.8"}, 0, 0},
    {MATERIAL, "tension cut-off 20 kPa", {"material.tension_cutoff=20 kPa"}, 0, 0},
    {MATERIAL, "no gravity", {"missile.gravity=0 m/s2"}, 0, 0},
    {MATERIAL, "speed + 1 %", {"missile.velocity=4.545 m/s"}, 0, 0},
    {MATERIAL, "mass + 1 %", {"missile.mass=4.646 kg"}, 0, 0},
};
enum { VARIATIONS = sizeof variations / sizeof variations[0] };

/* The largest change of a_max of each kind, and what made it. */
static void conclude(sf_study *study, const sf_drop *base, const sf_drop *drop) {
    double numerics = 0;
    sf_study_text(study, "\n| kind | largest change of a_max (%%) | by |\n|---|---|---|\n");
    for (int kind = 0; kind < KINDS; kind++) {
        int worst = -1;
        double largest = 0;
        for (int k = 0; k < VARIATIONS; k++) {
            double change = 100 * fabs(drop[k].a_max_g / base->a_max_g - 1);
            if ((int)variations[k].kind == kind && !(change <= largest)) {
                largest = change;
                worst = k;
            }
        }
        sf_study_text(study, "| %s | %.2f | %s |\n", kind_name[kind], largest,
                      worst < 0 ? "" : variations[worst].what);
        numerics = kind == NUMERICS ? largest : numerics;
    }
    sf_study_text(
        study, "\nThere is no contact stiffness to vary: contact forces are Lagrange multipliers (ADR 0003). "
               "There is one method of stabilisation, for the reason given in theory, section 4.\n\n");
    sf_study_check(study, numerics, -INFINITY, 1, "numerics: largest change of a_max (%%)");
}

int main(int argc, char **argv) {
    sf_study study;
    sf_drop base, drop[VARIATIONS];
    sf_error err = SF_ERROR_INIT;
    sf_study_begin(&study, "sensitivity", "Sensitivity of the 50 mm, 4.5 m/s drop", argc, argv);
    if (sf_drop_run("eva50-v4.5", NULL, 1, NULL, &base, &err) != SF_OK) {
        sf_study_fail(&study, &err);
        return sf_study_end(&study);
    }
    sf_study_text(
        &study,
        "Each row has one change; the foam is that of verify/materials/eva_like.cfg. Without a "
        "change the drop has a_max %.3f g, HIC %.2f, largest local strain %.4f and rebound %.3f m/s "
        "in %.0f steps.\n\n| change | a_max (%%) | HIC (%%) | largest local strain | "
        "rebound (%%) | steps "
        "|\n|---|---|---|---|---|---|\n",
        base.a_max_g, base.hic, base.max_local_strain, base.v_rebound_m_s, base.steps);
    for (int k = 0; k < VARIATIONS; k++) {
        const sf_drop *d = &drop[k];
        sf_error failed = SF_ERROR_INIT;
        if (sf_drop_run("eva50-v4.5", variations[k].overrides, 1, NULL, &drop[k], &failed) != SF_OK) {
            sf_study_fail(&study, &failed);
            drop[k].a_max_g = drop[k].hic = NAN;
            continue;
        }
        sf_study_text(&study, "| %s | %+.2f | %+.2f | %.4f | %+.2f | %.0f |\n", variations[k].what,
                      100 * (d->a_max_g / base.a_max_g - 1), 100 * (d->hic / base.hic - 1),
                      d->max_local_strain, 100 * (d->v_rebound_m_s / base.v_rebound_m_s - 1), d->steps);
    }
    conclude(&study, &base, drop);
    for (int k = 0; k < VARIATIONS; k++) {
        if (variations[k].a_bound == 0)
            continue;
        sf_study_check(&study, 100 * fabs(drop[k].a_max_g / base.a_max_g - 1), -INFINITY,
                       variations[k].a_bound, "%s: change of a_max (%%)", variations[k].what);
        sf_study_check(&study, 100 * fabs(drop[k].hic / base.hic - 1), -INFINITY, variations[k].hic_bound,
                       "%s: change of HIC (%%)", variations[k].what);
    }
    return sf_study_end(&study);
}
