/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/view/summary.h"

#include "build_info.h"
#include "post/results/origin.h"
#include <assert.h>

static const char caution[] = "indicative, not a certification";

/* ---- declarations ---- */

static sf_value grade_of_check(const void *record) {
    const sf_check *c = record;
    return sf_value_text(isnan(c->value) ? NULL : sf_verdict_phrase(c->grade));
}

/* An infinite bound, which means that there is none, becomes null. */
static const sf_row check_rows[] = {
    {.key = "key", SF_ROW_OF(STRING, sf_check, key)},
    {.key = "title", SF_ROW_OF(STRING, sf_check, title)},
    {.key = "value", SF_ROW_OF(NUMBER, sf_check, value)},
    {.key = "bound", SF_ROW_OF(NUMBER, sf_check, bound)},
    {.key = "use_bound", SF_ROW_OF(NUMBER, sf_check, use_bound)},
    {.key = "unit", SF_ROW_OF(STRING, sf_check, unit)},
    {.key = "grade", .type = SF_ROW_STRING, .value = grade_of_check},
    {.key = "finding", SF_ROW_OF(TEXT, sf_check, text)},
    {.key = "why", SF_ROW_OF(STRING, sf_check, why)},
};

static sf_value passed_limit(const void *record) {
    const sf_limit *limit = record;
    return limit->judged ? sf_value_flag(limit->passed) : sf_value_text(NULL);
}

static const sf_row limit_rows[] = {
    {.key = "key", SF_ROW_OF(STRING, sf_limit, key)},
    {.key = "value", SF_ROW_OF(NUMBER, sf_limit, value)},
    {.key = "bound", SF_ROW_OF(NUMBER, sf_limit, bound)},
    {.key = "unit", SF_ROW_OF(STRING, sf_limit, unit)},
    {.key = "passed", .type = SF_ROW_FLAG, .value = passed_limit},
};

static sf_value class_of_measured(const void *record) {
    double cfc = ((const sf_comparison *)record)->cfc;
    return sf_value_real(cfc > 0 ? cfc : NAN);
}

static sf_value origin_of_shift(const void *record) {
    return sf_value_text(((const sf_comparison *)record)->shift_given ? "command line"
                                                                      : "contact of both curves");
}

static const sf_row comparison_rows[] = {
    {.key = "understood", SF_ROW_OF(TEXT, sf_comparison, measured.interpretation)},
    {.key = "cfc", .value = class_of_measured},
    {.key = "inverted", SF_ROW_OF(FLAG, sf_comparison, inverted)},
    {.key = "clock_origin_s", SF_ROW_OF(NUMBER, sf_comparison, measured.origin)},
    {.key = "zero_line_g", SF_ROW_OF(NUMBER, sf_comparison, measured.offset)},
    {.key = "shift_ms", .factor = 1e3, SF_ROW_OF(NUMBER, sf_comparison, shift)},
    {.key = "shift_from", .type = SF_ROW_STRING, .value = origin_of_shift},
    {.key = "a_max_g", SF_ROW_OF(NUMBER, sf_comparison, injury.a_max_g)},
    {.key = "hic", SF_ROW_OF(NUMBER, sf_comparison, injury.hic.value)},
    {.key = "hic_t1_ms", .factor = 1e3, SF_ROW_OF(NUMBER, sf_comparison, injury.hic.t1)},
    {.key = "hic_t2_ms", .factor = 1e3, SF_ROW_OF(NUMBER, sf_comparison, injury.hic.t2)},
    {.key = "hic15", SF_ROW_OF(NUMBER, sf_comparison, injury.hic15.value)},
    {.key = "hic36", SF_ROW_OF(NUMBER, sf_comparison, injury.hic36.value)},
    {.key = "a_max_error", SF_ROW_OF(NUMBER, sf_comparison, peak_error)},
    {.key = "hic_error", SF_ROW_OF(NUMBER, sf_comparison, hic_error)},
    {.key = "agreement", SF_ROW_OF(STRING, sf_comparison, agreement)},
    {.key = "finding", SF_ROW_OF(TEXT, sf_comparison, finding)},
};

/* ---- summary.json ---- */

static void put_figures(sf_json *json, const sf_summary *s) {
    for (size_t k = 0; k < SF_FIGURE_TOTAL; k++)
        sf_row_json(json, &sf_figure_at[k].row, sf_figure_record(&sf_figure_at[k], s->results, s->figures));
    SF_JSON_ARRAY(json, "notes");
    for (int k = 0; k < s->results->note_count; k++)
        sf_json_text(json, NULL, s->results->notes[k]);
}

static sf_records layers_of(const sf_summary *s) {
    return (sf_records){s->figures->layers, sizeof *s->figures->layers, s->results->layer_count};
}

static void put_verdict(sf_json *json, const sf_verdict *v) {
    SF_JSON_OBJECT(json, "verdict");
    sf_json_text(json, "grade", sf_verdict_phrase(v->grade));
    sf_rows_json_array(json, "checks", SF_ROWS(check_rows),
                       (sf_records){v->rows, sizeof v->rows[0], v->count});
    sf_rows_json_array(json, "limits", SF_ROWS(limit_rows),
                       (sf_records){v->limits, sizeof v->limits[0], v->limit_count});
}

/* Words of the case about the test; null: not given. */
static void put_test(sf_json *json, const sf_results *r) {
    sf_origin_key key;
    SF_OWNED char *parameters = sf_origin_text(r, "/provenance/model/parameters");
    for (int k = 0; k < SF_ORIGIN_REPORT_KEYS; k++) {
        const char *name = sf_origin_report_keys[k];
        sf_json_text(json, name,
                     parameters && sf_origin_find_report(parameters, name, &key) ? key.value : NULL);
    }
}

static void put_comparison(sf_json *json, const char *path, const sf_comparison *c) {
    SF_JSON_OBJECT(json, "reference");
    sf_json_text(json, "file", path);
    sf_rows_json(json, SF_ROWS(comparison_rows), c);
    sf_json_open(json, "record", '{');
    sf_json_text(json, "grade", sf_verdict_phrase(c->measured.record.grade));
    sf_rows_json_array(
        json, "checks", SF_ROWS(check_rows),
        (sf_records){c->measured.record.rows, sizeof c->measured.record.rows[0], SF_RECORD_CHECKS});
    sf_json_close(json);
    sf_rows_json_array(json, "fits", sf_fit_rows(), (sf_records){c->fits, sizeof *c->fits, c->fit_count});
}

sf_status sf_summary_write(const sf_staging *output, const sf_summary *s, sf_error *err) {
    SF_JSON_FILE(json, output, "summary.json", err);
    SF_JSON_TEXTS(&json, {"program", "softfall-post " SF_VERSION}, {"git_revision", SF_GIT_REVISION},
                  {"command_line", s->command_line}, {"results", s->results_path}, {"caution", caution});
    put_test(&json, s->results);
    put_verdict(&json, s->verdict);
    SF_PRINTED(acceleration, 256, "%s%s", s->figures->acceleration, s->figures->passed);
    sf_json_text(&json, "acceleration", acceleration);
    put_figures(&json, s);
    if (s->figures->layers)
        sf_rows_json_array(&json, "layers", sf_layer_figure_rows(), layers_of(s));
    if (s->comparison)
        put_comparison(&json, s->reference_path, s->comparison);
    sf_json_close(&json);
    return sf_staging_close(json.file, "summary.json", err);
}

/* ---- the printed table ---- */

/* Keys of the printed figures, in their order. */
/* clang-format off */
static const char *const drop_keys[] = {
    "a_max_g", "a_max_raw_g", "hic", "hic15", "hic36", "gadd", "clip_3ms_g", "v_rebound_m_s",
    "absorbed_energy_fraction", "a_max_change_by_speed", "a_max_change_by_thickness", "a_max_scatter",
    "hic_scatter", "a_max_mesh_error", "hic_mesh_error", "max_indentation_mesh_error", NULL};
/* clang-format on */
static const char *const rotation_keys[] = {"peak_angular_acceleration_rad_s2", "peak_angular_velocity_rad_s",
                                            "bric", NULL};
static const char *const compression_keys[] = {"peak_force_N", "peak_stress_kPa", "work_J",
                                               "returned_energy_fraction", NULL};
/* clang-format off */
static const char *const common_keys[] = {
    "max_indentation_mm", "max_mean_strain", "max_local_strain", "energy_error",
    "stabilisation_energy_fraction", "contact_energy_fraction", NULL};
/* clang-format on */

/* Returns the end of the window of a figure (ms), `which` "t1" or "t2"; NaN: the figure has no window. */
static double window_end(const sf_summary *s, const char *key, const char *which) {
    SF_PRINTED(name, 64, "%s_%s_ms", key, which);
    const sf_figure *figure = sf_figure_find(name);
    return figure ? sf_figure_number(figure, s->results, s->figures) : NAN;
}

static void print_figures(FILE *out, const sf_summary *s, const char *const *key) {
    for (; *key; key++) {
        const sf_figure *figure = sf_figure_find(*key);
        assert(figure && figure->row.name);
        const void *record = sf_figure_record(figure, s->results, s->figures);
        double begin = window_end(s, *key, "t1"), end = window_end(s, *key, "t2");
        char text[48];
        if (isfinite(begin) && isfinite(end) && sf_row_number(&figure->row, record) > 0)
            fprintf(out, "  %-24s %12s    %.3f to %.3f ms\n", figure->row.name,
                    sf_row_shown(&figure->row, record, "-", text, sizeof text), begin, end);
        else
            sf_row_text(out, &figure->row, record);
    }
}

static void print_comparison(FILE *out, const char *path, const sf_comparison *c) {
    fprintf(out, "Compared with\nreference %s: %s\n", path, c->measured.interpretation);
    fprintf(out, "  measured a_max %.2f g (model %+.1f %%), HIC %.1f\n", c->injury.a_max_g,
            c->peak_error * 100, c->injury.hic.value);
    fprintf(out, "  model time = measured time %+.4f ms (%s)\n", c->shift * 1e3,
            c->shift_given ? "as given" : "contact of both curves");
    char line[SF_VERDICT_LINE_SIZE];
    sf_record_line(&c->measured.record, line, sizeof line);
    fprintf(out, "  record: %s\n%s", line,
            c->measured.record.grade == SF_GRADE_DO_NOT_USE ? "  comparison not usable\n" : "");
    fprintf(out, "  %s\n", c->finding);
    sf_rows_text_table(out, sf_fit_rows(), (sf_records){c->fits, sizeof *c->fits, c->fit_count});
}

static void print_drop(FILE *out, const sf_summary *s) {
    const sf_figures *f = s->figures;
    fprintf(out, "Drop of %.4g kg at %.4g m/s on %.4g mm (CFC %.0f%s%s)\n", s->results->missile_mass, f->v0,
            s->results->thickness * 1e3, f->cfc, f->kinematic ? ", kinematic acceleration" : "",
            f->turns ? ", free missile: a_max, HIC and all that follows of the resultant" : "");
    if (f->passed[0])
        fprintf(out, "  of the %s%s\n", f->acceleration, f->passed);
    print_figures(out, s, drop_keys);
    if (!f->turns)
        return;
    fprintf(out, "  %s\n", s->verdict->rows[SF_CHECK_edge].text);
    print_figures(out, s, rotation_keys);
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
    if (s->figures->driven) {
        fprintf(out, "Prescribed motion of the missile on %.4g mm: no drop, so no injury figures\n",
                s->results->thickness * 1e3);
        print_figures(out, s, compression_keys);
    } else {
        print_drop(out, s);
    }
    print_figures(out, s, common_keys);
    if (s->figures->layers)
        sf_rows_text_table(out, sf_layer_figure_rows(), layers_of(s));
    if (s->comparison)
        print_comparison(out, s->reference_path, s->comparison);
    fprintf(out, "These figures are %s.\n", caution);
}
