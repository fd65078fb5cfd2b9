/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "programs/softfall-solve-report.h"

#include "model/good_run.h"
#include "base/program.h"
#include "base/units.h"
#include "solver/run/notes.h"
#include <math.h>
#include <stdio.h>
#include <sys/resource.h>

void sf_solve_print_model(const sf_model *m, int threads) {
    printf("%lld nodes, %lld interactions, %lld held nodes, ", (long long)m->node_count,
           (long long)m->domain_nnz, (long long)m->fixed_count);
    if (m->rest_count > 0)
        printf("%lld resting nodes, ", (long long)m->rest_count);
    printf("%lld contact points, 1/%lld of the pad, %d threads\n", (long long)m->contact_count,
           (long long)m->symmetry_factor, threads);
}

void sf_solve_print_ledger(const sf_model *m, const sf_state *s, const sf_run *run) {
    const sf_sink sink = sf_program_sink("softfall-solve");
    const sf_ledger *l = &s->ledger;
    const sf_extremes *x = &run->extremes;
    double whole = sf_model_whole(m);
    bool driven = sf_missile_is_driven(m);
    struct rusage usage;
    getrusage(RUSAGE_SELF, &usage);
    printf("ended: %s at %.3f ms after %lld steps, %.1f s, %.2f million node-steps/s, peak memory %.0f MB\n",
           run->ending, 1e3 * s->time, (long long)s->step, run->wall_time,
           (double)m->node_count * (double)s->step / run->wall_time / 1e6, (double)usage.ru_maxrss / 1e3);
    printf("energies at the end (J, whole pad): missile %.4f  pad %.4f  stored %.4f  hysteresis %.4f  "
           "viscous %.4f\n"
           "  stabilisation %.4f  contact %.5f  friction %.5f  %s work %.4f\n",
           whole * l->kinetic_missile, whole * l->kinetic_pad, whole * l->stored, whole * l->hysteresis,
           whole * l->viscous, whole * l->stabilisation, whole * l->contact, whole * l->friction,
           driven ? "the motion's" : "gravity's", whole * l->external);
    if (m->rest_count > 0)
        printf("  of contact and friction at the anvil %.5f  work of the pad's weight %.5f\n",
               whole * l->anvil, whole * l->weight);
    printf("energy error %.2e (largest), momentum error %.1e, |G v| %.1e m/s, penetration %.2g mm\n",
           l->largest_error, x->largest_momentum, x->largest_residual, 1e3 * x->largest_penetration);
    printf("at the peak of the internal energy (%.3f J): stabilisation %.2f %%, contact %.3f %%\n",
           x->peak_internal, 100 * x->stabilisation_share, 100 * x->contact_share);
    if (driven)
        printf("largest contact force %.2f N at %.3f ms, largest local compression %.4f\n", x->peak_value,
               1e3 * x->peak_time, x->largest_compression);
    else
        printf(
            "largest specific force %.2f g at %.3f ms, largest local compression %.4f, speed upwards at the "
            "end %.3f m/s\n",
            x->peak_value / SF_STANDARD_GRAVITY, 1e3 * x->peak_time, x->largest_compression,
            fmax(0, sf_missile_turns(m) ? s->missile.rate_now[2] : -s->missile.velocity_now));
    sf_run_tell(m, s, x, &sink);
    const sf_good_run *good = sf_good_run_limits();
    if (l->largest_error > good->energy_error || fabs(x->stabilisation_share) > good->stabilisation ||
        fabs(x->contact_share) > good->contact)
        sf_sink_tell(
            &sink, SF_WARNING,
            "energy error %.2f %% (good: %g), stabilisation %.2f %% (%g), contact %.2f %% (%g): beyond "
            "the limits of a good run, softfall-post gives the verdict",
            100 * l->largest_error, 100 * good->energy_error, 100 * x->stabilisation_share,
            100 * good->stabilisation, 100 * x->contact_share, 100 * good->contact);
}
