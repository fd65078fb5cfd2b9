/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A pad that rests on the anvil: rocking, and under the drops of a glued one. tests/test_anvil.c has the pad
 * at rest, thrown, sliding and sticking, and the balances. */
#include "extreme.h"
#include "drop.h"
#include "resting_fixture.h"
#include "solver/step.h"
#include "study.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

static void study_rocking(sf_study *study) {
    fixture f;
    int64_t fewest = 1000;
    double lift = 0;
    FILE *data = sf_study_file(study, "rocking.txt");
    resting_start(&f, &(resting){.friction = 0.3, .across = 0.018, .speed = 0.5});
    while (f.state.time < 0.15) {
        fixture_step(&f);
        fewest = f.state.anvil_count < fewest ? f.state.anvil_count : fewest;
        double high = 0;
        for (int64_t c = f.model.contact_count; c < sf_model_points(&f.model); c++)
            high = larger(high, f.state.contact.position[3 * c + 2]);
        lift = larger(lift, high);
        if (data)
            fprintf(data, "%.6g %.6g %.6g %lld\n", 1e3 * f.state.time, 1e3 * high,
                    f.state.of_body[SF_BODY_ANVIL].force[2], (long long)f.state.anvil_count);
        sf_step_advance(&f.model, &f.state);
    }
    if (data)
        fclose(data);
    sf_study_text(
        study,
        "A drop 18 mm off the middle tips the block: %lld of its %lld base nodes stay on the anvil, and "
        "it lifts off by %.2f mm.\n\n",
        (long long)fewest, (long long)f.model.rest_count, 1e3 * lift);
    sf_study_plot(study, "rocking.png",
                  "Rocking block: height of its highest base node, nodes on the anvil, anvil's force",
                  "set xlabel 'time (ms)'\nset multiplot layout 3,1\nset ylabel 'height (mm)'\n"
                  "plot 'base-rocking.txt' using 1:2 with lines lw 2 notitle\nset ylabel 'nodes'\n"
                  "plot '' using 1:4 with lines lw 2 notitle\nset ylabel 'force (N)'\n"
                  "plot '' using 1:3 with lines lw 2 notitle\nunset multiplot");
    fixture_free(&f);
}

typedef struct base {
    const char *what, *rule, *friction;
} base;

static void study_drops(sf_study *study) {
    static const base bases[] = {{"glued", "pad.base=glued", NULL},
                                 {"resting, friction 0.5", "pad.base=resting", "pad.friction=0.5"},
                                 {"resting, friction 0.2", "pad.base=resting", "pad.friction=0.2"},
                                 {"resting, no friction", "pad.base=resting", "pad.friction=0.0"},
                                 {"smooth", "pad.base=smooth", NULL}};
    enum { BASES = sizeof bases / sizeof bases[0] };
    sf_drop drop[BASES];
    sf_study_text(
        study,
        "\nThe drop of 4.5 m/s on 50 mm of the foam of verify/materials/eva_like.cfg with a spacing of 7 mm:\n\n"
        "| base | a_max (g) | HIC | rebound (m/s) | contact energy (%%) | time (s) |\n|---|---|---|---|---|---|\n");
    for (int k = 0; k < BASES; k++) {
        const char *const overrides[] = {"geometry.parameters.fine_spacing=7.0",
                                         "geometry.parameters.outer_spacing=14.0", bases[k].rule,
                                         bases[k].friction, NULL};
        sf_error err = SF_ERROR_INIT;
        if (sf_drop_run("eva50-v4.5", overrides, 1, NULL, &drop[k], &err) != SF_OK) {
            sf_study_fail(study, &err);
            return;
        }
        sf_study_text(study, "| %s | %.2f | %.1f | %.3f | %.3f | %.1f |\n", bases[k].what, drop[k].a_max_g,
                      drop[k].hic, drop[k].v_rebound_m_s, 100 * drop[k].contact_energy_fraction,
                      drop[k].wall_s);
    }
    sf_study_text(study, "\n");
    sf_study_check(study, drop[1].a_max_g / drop[0].a_max_g, 0.99, 1.01,
                   "a_max, resting with friction 0.5 over glued");
    sf_study_check(study, drop[1].hic / drop[0].hic, 0.99, 1.01, "HIC, resting with friction 0.5 over glued");
    sf_study_check(study, drop[3].a_max_g / drop[4].a_max_g, 0.99, 1.01,
                   "a_max, resting without friction over smooth");
    sf_study_check(study, drop[3].hic / drop[4].hic, 0.99, 1.01, "HIC, resting without friction over smooth");
}

int main(int argc, char **argv) {
    sf_study study;
    sf_study_begin(&study, "base", "A pad that rests on the anvil", argc, argv);
    sf_study_text(
        &study,
        "`tests/test_anvil.c` checks the pad alone on the anvil:\n\n"
        "- At rest for 20 ms it moves by less than 1e-16 m, and the anvil's force is its weight to 1e-6.\n"
        "- Thrown up with 0.05 m/s it flies by the closed form to 0.2 um, and lies within 10 um of its "
        "place after six flights.\n"
        "- Sliding with 0.1 m/s on friction 0.2, 0.3 and 0.4 it stops after v0^2 / (2 mu g) and loses its "
        "kinetic energy in friction, both to 0.2 %%. Then it creeps by less than 1 um.\n"
        "- In the rocking drop below, momentum and angular momentum hold to 1e-12 and the energy to 1 %%.\n\n");
    study_rocking(&study);
    study_drops(&study);
    return sf_study_end(&study);
}
