/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/view/summary.h"

#include "build_info.h"
#include "report/json.h"
#include <assert.h>
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

static void put_figures(sf_json *json, const sf_summary *s) {
    size_t count;
    const sf_figure *figure = sf_figure_list(&count);
    for (size_t k = 0; k < count; k++) {
        const char *key = figure[k].key;
        const void *place = sf_figure_place(&figure[k], s->results, s->figures);
        switch (figure[k].type) {
        case SF_FIGURE_DOUBLE:
            sf_json_number(json, key, *(const double *)place * figure[k].factor);
            break;
        case SF_FIGURE_INTEGER:
            sf_json_integer(json, key, *(const int64_t *)place);
            break;
        case SF_FIGURE_BOOL:
            sf_json_bool(json, key, *(const bool *)place);
            break;
        case SF_FIGURE_TEXT: /* empty: unknown */
            sf_json_text(json, key, *(const char *)place ? place : NULL);
            break;
        }
    }
    sf_json_open(json, "notes", '[');
    for (int k = 0; k < s->results->note_count; k++)
        sf_json_text(json, NULL, s->results->notes[k]);
    sf_json_close(json, ']');
}

/* A pad of several materials has a group for each. */
static void put_layers(sf_json *json, const sf_summary *s) {
    size_t count;
    const sf_layer_figure *list = sf_layer_figure_list(&count);
    if (!s->figures->layers)
        return;
    sf_json_open(json, "layers", '[');
    for (int k = 0; k < s->results->layer_count; k++) {
        const sf_layer_figures *layer = &s->figures->layers[k];
        sf_json_open(json, NULL, '{');
        sf_json_text(json, "name", layer->name);
        for (size_t q = 0; q < count; q++)
            sf_json_number(json, list[q].key,
                           *(const double *)((const char *)layer + list[q].offset) * list[q].factor);
        sf_json_close(json, '}');
    }
    sf_json_close(json, ']');
}

/* Infinity, a bound that there is not, becomes null. */
static void put_checks(sf_json *json, const sf_verdict *v) {
    sf_json_open(json, "checks", '[');
    for (int k = 0; k < v->count; k++) {
        const sf_check *c = &v->rows[k];
        sf_json_open(json, NULL, '{');
        sf_json_text(json, "key", c->key);
        sf_json_text(json, "title", c->title);
        sf_json_number(json, "value", c->value);
        sf_json_number(json, "bound", c->bound);
        sf_json_number(json, "use_bound", c->use_bound);
        sf_json_text(json, "unit", c->unit);
        sf_json_text(json, "grade", isnan(c->value) ? NULL : sf_verdict_phrase(c->grade));
        sf_json_text(json, "finding", c->text);
        sf_json_text(json, "why", c->why);
        sf_json_close(json, '}');
    }
    sf_json_close(json, ']');
}

static void put_limits(sf_json *json, const sf_verdict *v) {
    sf_json_open(json, "limits", '[');
    for (int k = 0; k < v->limit_count; k++) {
        const sf_limit *limit = &v->limits[k];
        sf_json_open(json, NULL, '{');
        sf_json_text(json, "key", limit->key);
        sf_json_number(json, "value", limit->value);
        sf_json_number(json, "bound", limit->bound);
        sf_json_text(json, "unit", limit->unit);
        if (limit->judged)
            sf_json_bool(json, "passed", limit->passed);
        else
            sf_json_text(json, "passed", NULL);
        sf_json_close(json, '}');
    }
    sf_json_close(json, ']');
}

static void put_verdict(sf_json *json, const sf_verdict *v) {
    sf_json_open(json, "verdict", '{');
    sf_json_text(json, "grade", sf_verdict_phrase(v->grade));
    put_checks(json, v);
    put_limits(json, v);
    sf_json_close(json, '}');
}

static void put_comparison(sf_json *json, const char *path, const sf_comparison *c) {
    sf_json_open(json, "reference", '{');
    sf_json_text(json, "file", path);
    sf_json_text(json, "understood", c->understood);
    sf_json_number(json, "cfc", c->cfc > 0 ? c->cfc : NAN);
    sf_json_bool(json, "inverted", c->inverted);
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
        sf_json_integer(json, "samples_in_free_flight", fit->flight);
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
    put_verdict(&json, s->verdict);
    put_figures(&json, s);
    put_layers(&json, s);
    if (s->comparison)
        put_comparison(&json, s->reference_path, s->comparison);
    sf_json_close(&json, '}');
    return sf_staging_close(file, "summary.json", err);
}

/* A line of the printed table: the figure `key` times `factor`. */
typedef struct report_line {
    const char *key, *label;
    double factor;
    int digits;
    const char *unit;
    const char *begin, *end; /* keys of the window to be shown instead of a unit, or NULL */
} report_line;

static const report_line drop_lines[] = {
    {"a_max_g", "a_max", 1, 2, "g", NULL, NULL},
    {"a_max_raw_g", "a_max, raw", 1, 2, "g", NULL, NULL},
    {"hic", "HIC", 1, 1, "", "hic_t1_ms", "hic_t2_ms"},
    {"hic15", "HIC15", 1, 1, "", "hic15_t1_ms", "hic15_t2_ms"},
    {"hic36", "HIC36", 1, 1, "", "hic36_t1_ms", "hic36_t2_ms"},
    {"gadd", "Gadd index", 1, 1, "", NULL, NULL},
    {"clip_3ms_g", "3 ms clip", 1, 2, "g", NULL, NULL},
    {"v_rebound_m_s", "rebound speed", 1, 3, "m/s", NULL, NULL},
    {"absorbed_energy_fraction", "absorbed energy", 100, 1, "%", NULL, NULL},
    {NULL, NULL, 0, 0, NULL, NULL, NULL},
};
static const report_line rotation_lines[] = {
    {"peak_angular_acceleration_rad_s2", "angular acceleration", 1, 1, "rad/s2", NULL, NULL},
    {"peak_angular_velocity_rad_s", "angular velocity", 1, 2, "rad/s", NULL, NULL},
    {NULL, NULL, 0, 0, NULL, NULL, NULL},
};
static const report_line compression_lines[] = {
    {"peak_force_N", "largest force", 1, 2, "N", NULL, NULL},
    {"peak_stress_kPa", "  over mean section", 1, 2, "kPa", NULL, NULL},
    {"work_J", "work", 1, 4, "J", NULL, NULL},
    {"returned_energy_fraction", "  given back", 100, 1, "%", NULL, NULL},
    {NULL, NULL, 0, 0, NULL, NULL, NULL},
};
static const report_line common_lines[] = {
    {"max_indentation_mm", "largest indentation", 1, 2, "mm", NULL, NULL},
    {"max_mean_strain", "  over thickness", 1, 3, "", NULL, NULL},
    {"max_local_strain", "largest local strain", 1, 3, "", NULL, NULL},
    {"energy_error", "energy error", 100, 4, "%", NULL, NULL},
    {"stabilisation_energy_fraction", "stabilisation energy", 100, 3, "% of the internal energy", NULL, NULL},
    {"contact_energy_fraction", "contact energy", 100, 3, "% of the internal energy", NULL, NULL},
    {NULL, NULL, 0, 0, NULL, NULL, NULL},
};

/* The figure of that key, in the unit of the key. */
static double find_figure(const sf_summary *s, const char *key) {
    const sf_figure *figure = sf_figure_find(key);
    assert(figure && figure->type == SF_FIGURE_DOUBLE);
    return *(const double *)sf_figure_place(figure, s->results, s->figures) * figure->factor;
}

static void print_lines(FILE *out, const sf_summary *s, const report_line *line) {
    for (; line->key; line++) {
        double value = find_figure(s, line->key) * line->factor;
        if (!isfinite(value))
            fprintf(out, "  %-24s %12s\n", line->label, "-");
        else if (line->begin && value > 0)
            fprintf(out, "  %-24s %12.*f    %.3f to %.3f ms\n", line->label, line->digits, value,
                    find_figure(s, line->begin), find_figure(s, line->end));
        else
            fprintf(out, "  %-24s %12.*f %s\n", line->label, line->digits, value, line->unit);
    }
}

static void print_cell(FILE *out, double value, int width, int digits) {
    if (isfinite(value))
        fprintf(out, " %*.*f", width, digits, value);
    else
        fprintf(out, " %*s", width, "-");
}

static void print_layers(FILE *out, const sf_summary *s) {
    if (!s->figures->layers)
        return;
    fprintf(out, "  %-24s %12s %14s %20s\n", "layer", "largest strain", "absorbed (J)",
            "beyond its data (%)");
    for (int k = 0; k < s->results->layer_count; k++) {
        const sf_layer_figures *layer = &s->figures->layers[k];
        fprintf(out, "  %-24s", layer->name);
        print_cell(out, layer->max_local_strain, 14, 3);
        print_cell(out, layer->absorbed_energy, 14, 2);
        print_cell(out, 100 * layer->energy_beyond_data, 20, 1);
        fputc('\n', out);
    }
}

static void print_comparison(FILE *out, const char *path, const sf_comparison *c) {
    fprintf(out, "Compared with\nreference %s: %s\n", path, c->understood);
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
        if (fit->flight > 0)
            fprintf(out, "   %lld of them beyond the model's curve: free flight", (long long)fit->flight);
        fputc('\n', out);
    }
}

static void print_drop(FILE *out, const sf_summary *s) {
    const sf_figures *f = s->figures;
    fprintf(out, "Drop of %.4g kg at %.4g m/s on %.4g mm (CFC %.0f%s%s)\n", s->results->missile_mass, f->v0,
            s->results->thickness * 1e3, f->cfc, f->kinematic ? ", kinematic acceleration" : "",
            f->turns ? ", free missile: a_max, HIC and all that follows of the resultant" : "");
    print_lines(out, s, drop_lines);
    if (f->turns)
        print_lines(out, s, rotation_lines);
}

static void print_compression(FILE *out, const sf_summary *s) {
    fprintf(out, "Prescribed motion of the missile on %.4g mm: no drop, so no injury figures\n",
            s->results->thickness * 1e3);
    print_lines(out, s, compression_lines);
}

static void print_verdict(FILE *out, const sf_verdict *v) {
    char line[SF_VERDICT_LINE_SIZE];
    sf_verdict_line(v, line, sizeof line);
    fprintf(out, "Verdict: %s\n", line);
    for (int k = 0; k < v->count; k++)
        if (v->rows[k].grade != SF_GRADE_VALID)
            fprintf(out, "  %-18s %-20s %s\n", sf_verdict_phrase(v->rows[k].grade), v->rows[k].key,
                    v->rows[k].why);
    for (int k = 0; k < v->limit_count; k++) {
        const sf_limit *limit = &v->limits[k];
        if (isfinite(limit->value))
            fprintf(out, "  limit of %-5s %6.4g: %s (%.4g)\n", limit->title, limit->bound,
                    sf_limit_phrase(limit), limit->value);
    }
}

void sf_summary_print(FILE *out, const sf_summary *s) {
    print_verdict(out, s->verdict);
    if (s->figures->driven)
        print_compression(out, s);
    else
        print_drop(out, s);
    print_lines(out, s, common_lines);
    print_layers(out, s);
    if (s->comparison)
        print_comparison(out, s->reference_path, s->comparison);
    fprintf(out, "These figures are %s.\n", caution);
}
