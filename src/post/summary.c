/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/summary.h"

#include "build_info.h"
#include "io/json.h"
#include <math.h>
#include <string.h>

static const char caution[] = "indicative, not a certification";

static void put_hic(sf_json *json, const char *prefix, const sf_hic *hic) {
    char key[32];
    sf_json_number(json, prefix, hic->value);
    snprintf(key, sizeof key, "%s_t1_ms", prefix);
    sf_json_number(json, key, hic->t1 * 1e3);
    snprintf(key, sizeof key, "%s_t2_ms", prefix);
    sf_json_number(json, key, hic->t2 * 1e3);
}

static void put_injury(sf_json *json, const sf_figures *f) {
    sf_json_number(json, "a_max_g", f->injury.a_max_g);
    sf_json_number(json, "a_max_time_ms", f->injury.a_max_time * 1e3);
    put_hic(json, "hic", &f->injury.hic);
    put_hic(json, "hic15", &f->injury.hic15);
    put_hic(json, "hic36", &f->injury.hic36);
    sf_json_number(json, "gadd", f->injury.gadd);
    sf_json_number(json, "clip_3ms_g", f->injury.clip_contiguous_g);
    sf_json_number(json, "clip_3ms_cumulative_g", f->injury.clip_cumulative_g);
    sf_json_number(json, "a_max_raw_g", f->injury_raw.a_max_g);
    sf_json_number(json, "hic_raw", f->injury_raw.hic.value);
    sf_json_number(json, "cfc", f->cfc);
    sf_json_number(json, "sampling_rate_Hz", f->rate);
}

static void put_mechanics(sf_json *json, const sf_figures *f) {
    sf_json_number(json, "v0_m_s", f->driven ? NAN : f->v0);
    sf_json_number(json, "v_rebound_m_s", f->v_rebound);
    sf_json_number(json, "rebound_time_ms", f->rebound_time * 1e3);
    sf_json_number(json, "absorbed_energy_J", f->absorbed_energy);
    sf_json_number(json, "absorbed_energy_fraction", f->absorbed_energy_fraction);
    sf_json_number(json, "max_indentation_mm", f->max_indentation * 1e3);
    sf_json_number(json, "max_indentation_time_ms", f->max_indentation_time * 1e3);
    sf_json_number(json, "max_mean_strain", f->max_mean_strain);
    sf_json_number(json, "max_local_strain", f->max_local_strain);
    sf_json_number(json, "max_local_strain_time_ms", f->max_local_strain_time * 1e3);
    sf_json_number(json, "local_strain_excess", f->max_local_strain - f->max_mean_strain);
    sf_json_number(json, "smallest_jacobian", f->smallest_jacobian);
    sf_json_number(json, "max_penetration_mm", f->max_penetration * 1e3);
    sf_json_number(json, "energy_error", f->energy_error);
    sf_json_number(json, "momentum_error", f->momentum_error);
    sf_json_number(json, "constraint_residual_m_s", f->constraint_residual);
    sf_json_number(json, "internal_energy_peak_J", f->internal_energy_peak);
    sf_json_number(json, "internal_energy_peak_time_ms", f->internal_energy_peak_time * 1e3);
    sf_json_number(json, "stabilisation_energy_fraction", f->stabilisation_energy_fraction);
    sf_json_number(json, "contact_energy_fraction", f->contact_energy_fraction);
}

static void put_compression(sf_json *json, const sf_figures *f) {
    sf_json_number(json, "section_mm2", f->area * 1e6);
    sf_json_number(json, "peak_force_N", f->peak_force);
    sf_json_number(json, "peak_force_time_ms", f->peak_force_time * 1e3);
    sf_json_number(json, "peak_stress_kPa", f->peak_stress * 1e-3);
    sf_json_number(json, "work_J", f->work);
    sf_json_number(json, "returned_energy_fraction", f->returned_energy_fraction);
}

static void put_run(sf_json *json, const sf_summary *s) {
    const sf_results *r = s->results;
    sf_json_text(json, "status", r->has_summary ? r->status : NULL);
    sf_json_bool(json, "touched", s->figures->touched);
    sf_json_bool(json, "prescribed_motion", s->figures->driven);
    sf_json_bool(json, "rebounded", s->figures->rebounded);
    sf_json_number(json, "contact_time_ms", r->contact_time * 1e3);
    sf_json_number(json, "end_time_ms", r->history[SF_HISTORY_TIME][r->history_rows - 1] * 1e3);
    sf_json_number(json, "thickness_mm", r->thickness * 1e3);
    sf_json_number(json, "missile_mass_kg", s->figures->driven ? NAN : r->missile_mass);
    sf_json_number(json, "density_kg_m3", r->density);
    sf_json_integer(json, "symmetry_factor", r->symmetry_factor);
    sf_json_integer(json, "nodes", r->node_count);
    sf_json_integer(json, "cells", r->cell_count);
    sf_json_integer(json, "interactions", r->interactions);
    sf_json_integer(json, "frames", r->frame_count);
    sf_json_integer(json, "steps", r->has_summary ? r->steps : r->history_rows - 1);
    sf_json_number(json, "wall_s", r->wall_time);
    sf_json_integer(json, "threads", r->threads);
    sf_json_open(json, "notes", '[');
    for (int k = 0; k < r->note_count; k++)
        sf_json_text(json, NULL, r->notes[k]);
    sf_json_close(json, ']');
}

static void put_comparison(sf_json *json, const char *path, const sf_comparison *c) {
    sf_json_open(json, "reference", '{');
    sf_json_text(json, "file", path);
    sf_json_number(json, "shift_ms", c->shift * 1e3);
    sf_json_text(json, "shift_from", c->shift_given ? "command line" : "contact of both curves");
    sf_json_number(json, "a_max_g", c->injury.a_max_g);
    put_hic(json, "hic", &c->injury.hic);
    sf_json_number(json, "hic15", c->injury.hic15.value);
    sf_json_number(json, "hic36", c->injury.hic36.value);
    sf_json_number(json, "a_max_error", c->peak_error);
    sf_json_open(json, "fits", '[');
    for (int64_t k = 0; k < c->fit_count; k++) {
        const sf_fit *fit = &c->fits[k];
        sf_json_open(json, NULL, '{');
        sf_json_text(json, "region", k < 2 ? "window" : "region");
        sf_json_number(json, "t1_ms", fit->region.begin * 1e3);
        sf_json_number(json, "t2_ms", fit->region.end * 1e3);
        sf_json_number(json, "first_sample_ms", fit->first * 1e3);
        sf_json_number(json, "last_sample_ms", fit->last * 1e3);
        sf_json_number(json, "interval_ms", fit->interval * 1e3);
        sf_json_integer(json, "samples", fit->count);
        sf_json_number(json, "r2", fit->r2);
        sf_json_number(json, "rmse_g", fit->rmse_g);
        sf_json_close(json, '}');
    }
    sf_json_close(json, ']');
    sf_json_close(json, '}');
}

sf_status sf_summary_write(const sf_staging *output, const sf_summary *s, sf_error *err) {
    FILE *file = sf_staging_open(output, "summary.json", err);
    if (!file)
        return err->status;
    sf_json json = {.file = file};
    sf_json_open(&json, NULL, '{');
    sf_json_text(&json, "program", "softfall-post " SF_VERSION);
    sf_json_text(&json, "results", s->results_path);
    sf_json_text(&json, "caution", caution);
    put_injury(&json, s->figures);
    put_mechanics(&json, s->figures);
    put_compression(&json, s->figures);
    put_run(&json, s);
    if (s->comparison)
        put_comparison(&json, s->reference_path, s->comparison);
    sf_json_close(&json, '}');
    return sf_staging_close(file, "summary.json", err);
}

static void print_row(FILE *out, const char *name, double value, int digits, const char *unit) {
    if (isfinite(value))
        fprintf(out, "  %-24s %12.*f %s\n", name, digits, value, unit);
    else
        fprintf(out, "  %-24s %12s\n", name, "-");
}

static void print_hic(FILE *out, const char *name, const sf_hic *hic) {
    if (hic->value > 0)
        fprintf(out, "  %-24s %12.1f    %.3f to %.3f ms\n", name, hic->value, hic->t1 * 1e3, hic->t2 * 1e3);
    else
        print_row(out, name, hic->value, 1, "");
}

static void print_cell(FILE *out, double value, int width, int digits) {
    if (isfinite(value))
        fprintf(out, " %*.*f", width, digits, value);
    else
        fprintf(out, " %*s", width, "-");
}

static void print_comparison(FILE *out, const char *path, const sf_comparison *c) {
    fprintf(out, "Compared with %s\n", path);
    fprintf(out, "  measured a_max %.2f g (model %+.1f %%), HIC %.1f\n", c->injury.a_max_g,
            c->peak_error * 100, c->injury.hic.value);
    fprintf(out, "  model time = measured time %+.4f ms (%s)\n", c->shift * 1e3,
            c->shift_given ? "as given" : "contact of both curves");
    fprintf(out, "  %-24s %8s %8s %8s %10s\n", "measured time (ms)", "dt (ms)", "samples", "R2", "RMSE (g)");
    for (int64_t k = 0; k < c->fit_count; k++) {
        const sf_fit *fit = &c->fits[k];
        char span[48];
        snprintf(span, sizeof span, "%.3f to %.3f%s", fit->region.begin * 1e3, fit->region.end * 1e3,
                 k < 2 ? " window" : "");
        fprintf(out, "  %-24s %8.2f %8lld", span, fit->interval * 1e3, (long long)fit->count);
        print_cell(out, fit->r2, 8, 4);
        print_cell(out, fit->rmse_g, 10, 3);
        fputc('\n', out);
    }
}

static void print_drop(FILE *out, const sf_summary *s) {
    const sf_figures *f = s->figures;
    fprintf(out, "Drop of %.4g kg at %.4g m/s on %.4g mm (CFC %.0f)\n", s->results->missile_mass, f->v0,
            s->results->thickness * 1e3, f->cfc);
    print_row(out, "a_max", f->injury.a_max_g, 2, "g");
    print_row(out, "a_max, raw", f->injury_raw.a_max_g, 2, "g");
    print_hic(out, "HIC", &f->injury.hic);
    print_hic(out, "HIC15", &f->injury.hic15);
    print_hic(out, "HIC36", &f->injury.hic36);
    print_row(out, "Gadd index", f->injury.gadd, 1, "");
    print_row(out, "3 ms clip", f->injury.clip_contiguous_g, 2, "g");
    print_row(out, "rebound speed", f->v_rebound, 3, "m/s");
    print_row(out, "absorbed energy", f->absorbed_energy_fraction * 100, 1, "%");
}

static void print_compression(FILE *out, const sf_summary *s) {
    const sf_figures *f = s->figures;
    fprintf(out, "Prescribed motion of the missile on %.4g mm: no drop, so no injury figures\n",
            s->results->thickness * 1e3);
    print_row(out, "largest force", f->peak_force, 2, "N");
    print_row(out, "  over mean section", f->peak_stress * 1e-3, 2, "kPa");
    print_row(out, "work", f->work, 4, "J");
    print_row(out, "  given back", f->returned_energy_fraction * 100, 1, "%");
}

void sf_summary_print(FILE *out, const sf_summary *s) {
    const sf_figures *f = s->figures;
    if (f->driven)
        print_compression(out, s);
    else
        print_drop(out, s);
    print_row(out, "largest indentation", f->max_indentation * 1e3, 2, "mm");
    print_row(out, "  over thickness", f->max_mean_strain, 3, "");
    print_row(out, "largest local strain", f->max_local_strain, 3, "");
    print_row(out, "energy error", f->energy_error * 100, 4, "%");
    print_row(out, "stabilisation energy", f->stabilisation_energy_fraction * 100, 3,
              "% of the internal energy");
    print_row(out, "contact energy", f->contact_energy_fraction * 100, 3, "% of the internal energy");
    if (s->comparison)
        print_comparison(out, s->reference_path, s->comparison);
    fprintf(out, "These figures are %s.\n", caution);
}
