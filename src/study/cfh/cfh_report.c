/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/cfh/cfh_report.h"

#include "base/text.h"
#include "build_info.h"

/* ---- texts ---- */

const char *sf_cfh_interval_text(const sf_cfh_interval *i, char *text, size_t size) {
    if (isnan(i->median))
        snprintf(text, size, "–");
    else if (isinf(i->low))
        snprintf(text, size, "above %#.3g m", i->end[1]);
    else if (i->high <= 0)
        snprintf(text, size, "below %#.3g m", i->end[0]);
    else if (i->low <= 0 && isinf(i->high))
        snprintf(text, size, "open at both ends");
    else if (i->low <= 0)
        snprintf(text, size, "up to %#.3g m, open below", i->high);
    else if (isinf(i->high))
        snprintf(text, size, "from %#.3g m, open above", i->low);
    else
        snprintf(text, size, "%#.3g to %#.3g m", i->low, i->high);
    return text;
}

/* True if the case's own material is none that the draws describe. */
static bool is_aside(const sf_cfh_spread *s) {
    const sf_cfh_interval *foam = &s->part[SF_CFH_PART_FOAM][SF_CFH_FIRST];
    return s->own_height < 0.99 * foam->low || s->own_height > 1.01 * foam->high;
}

void sf_cfh_draws_text(const sf_cfh_spread *s, char *text, size_t size) {
    const struct {
        int count;
        const char *words;
    } kinds[] = {
        {s->above, "reach no limit up to the greatest height looked at"},
        {s->below, "exceed a limit at the lowest height looked at"},
        {s->collapsed,
         "have columns that collapse before they reach a limit, and count as reaching it there"},
        {s->beyond,
         "reach a limit outside of the simulated heights, where the correction of the columns is that "
         "of the nearest one"}};
    int failed = 0;
    text[0] = '\0';
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0]; k++)
        if (kinds[k].count > 0)
            sf_text_add(text, size, "%s%d of the %d draws %s.", *text ? " " : "", kinds[k].count, s->draws,
                        kinds[k].words);
    for (int k = 0; k < s->checks; k++)
        failed += s->check[k].failed;
    if (failed > 0)
        sf_text_add(text, size, "%s%d of the %d simulated draws failed: there the columns are not confirmed.",
                    *text ? " " : "", failed, s->checks);
    if (is_aside(s))
        sf_text_add(text, size,
                    "%sThe height of the case's own material, %.3g m, lies outside of 95 %% of the draws: "
                    "it is not the foam that they describe.",
                    *text ? " " : "", s->own_height);
}

const char *sf_cfh_response_text(const sf_cfh_spread *s) {
    return s->with_response
               ? ""
               : "The draws have no response_error: errors of the responses are not in the interval, "
                 "which is too narrow where the law misses more than the curve.";
}

const char sf_cfh_caution[] = "Indicative, not a certification: a computed height from one simulated impact "
                              "site, not the test of ASTM F1292 or EN 1177.";

const char *sf_cfh_bound(const sf_cfh_report *r, double *height) {
    static const char *const words[] = {
        [SF_CFH_FOUND] = "", [SF_CFH_ABOVE] = "above ", [SF_CFH_BELOW] = "below ", [SF_CFH_UNKNOWN] = NULL};
    const sf_cfh_result *v = r->result;
    *height = v->verdict == SF_CFH_FOUND   ? v->crossing[v->deciding].height
              : v->verdict == SF_CFH_ABOVE ? v->highest
              : v->verdict == SF_CFH_BELOW ? (isnan(v->lowest) ? v->exceeding->height : v->lowest)
                                           : NAN;
    return words[v->verdict];
}

/* Writes the statement of the verdict about the uncertainty: a sentence after a blank. */
static void uncertainty_text(const sf_cfh_report *r, char *text, size_t size) {
    char interval[64];
    if (!r->spread) {
        snprintf(text, size, " The uncertainty of the foam is not included%s%s.",
                 r->no_interval[0] ? ": " : "", r->no_interval);
        return;
    }
    const sf_cfh_interval *whole = sf_cfh_spread_whole(r->spread, SF_CFH_FIRST);
    const char *of = r->spread->with_response ? "foam, responses and mesh" : "foam and mesh";
    sf_cfh_interval_text(whole, interval, sizeof interval);
    if (whole->median > 0 && isfinite(whole->median))
        snprintf(text, size, " With the uncertainty of %s: %#.3g m (95 %% interval %s).", of, whole->median,
                 interval);
    else
        snprintf(text, size, " 95 %% interval with the uncertainty of %s: %s.", of, interval);
}

/* "the missile reaches the anvil", or what is sure of a drop that is not to be used. */
static void exceeding_text(const sf_cfh_report *r, char *text, size_t size) {
    const sf_cfh_point *p = r->result->exceeding;
    sf_cfh_criterion c = p->least[SF_CFH_A_MAX] >= r->plan->limit[SF_CFH_A_MAX] ? SF_CFH_A_MAX : SF_CFH_HIC;
    if (p->on_anvil)
        sf_text_add(text, size, "from %.3f m the missile reaches the anvil.", p->height);
    else
        sf_text_add(text, size,
                    "%s is at least %.0f%s at %.3f m, in a drop that is not to be used otherwise.",
                    sf_cfh_name(c), p->least[c], sf_cfh_unit(c), p->height);
}

/* The height as simulated; plain text that ends in a full stop. */
static void simulated_text(const sf_cfh_report *r, char *text, size_t size) {
    const sf_cfh_result *v = r->result;
    const char *name = sf_cfh_name(v->deciding), *unit = sf_cfh_unit(v->deciding);
    double limit = r->plan->limit[v->deciding], height;
    const char *side = sf_cfh_bound(r, &height);
    if (!side) {
        snprintf(text, size, "Critical fall height not determined: %s.", v->problem.text);
        return;
    }
    bool between = v->verdict == SF_CFH_ABOVE && v->exceeding;
    snprintf(text, size, "Critical fall height %s%.3f m", side, height);
    if (between)
        sf_text_add(text, size, " and below %.3f m", v->exceeding->height);
    sf_text_add(text, size,
                " of free fall%s%s%s: ", v->verdict == SF_CFH_FOUND && r->spread ? " as simulated" : "",
                *r->counted ? ", by " : "", r->counted);
    const sf_cfh_crossing *crossing = &v->crossing[v->deciding];
    if (v->verdict == SF_CFH_FOUND && crossing->bracketed)
        sf_text_add(text, size, "%s reaches %g%s first, between drops at %.3f and %.3f m.", name, limit, unit,
                    crossing->low, crossing->high);
    else if (v->verdict == SF_CFH_FOUND)
        sf_text_add(text, size, "%s reaches %g%s first.", name, limit, unit);
    else if (v->verdict == SF_CFH_ABOVE)
        sf_text_add(text, size, "neither a_max %g g nor HIC %g is reached", r->plan->limit[SF_CFH_A_MAX],
                    r->plan->limit[SF_CFH_HIC]);
    else if (isnan(v->lowest))
        exceeding_text(r, text, size);
    else
        sf_text_add(text, size, "%s exceeds %g%s at the lowest height.", name, limit, unit);
    if (v->verdict == SF_CFH_ABOVE)
        sf_text_add(text, size, between ? ", but " : ".");
    if (between)
        exceeding_text(r, text, size);
}

void sf_cfh_verdict_text(const sf_cfh_report *r, char *text, size_t size) {
    char uncertainty[SF_CFH_NOTE_SIZE + 100];
    simulated_text(r, text, size);
    if (r->result->verdict == SF_CFH_UNKNOWN && !r->spread)
        return;
    uncertainty_text(r, uncertainty, sizeof uncertainty);
    sf_text_add(text, size, "%s", uncertainty);
}

/* The same on the rig; "" without a rig or a height. */
void sf_cfh_rig_text(const sf_cfh_report *r, char *text, size_t size) {
    double height;
    char interval[64], uncertainty[160] = "", below[32] = "";
    const char *side = sf_cfh_bound(r, &height);
    text[0] = '\0';
    if (r->rig->pairs == 0 || isnan(height))
        return;
    if (r->spread)
        snprintf(uncertainty, sizeof uncertainty,
                 "; with these uncertainties and that of g_eff: 95 %% interval %s",
                 sf_cfh_interval_text(&r->spread->rig, interval, sizeof interval));
    if (r->result->verdict == SF_CFH_ABOVE && r->result->exceeding)
        snprintf(below, sizeof below, " and below %.3f m",
                 sf_cfh_rig_height(r->rig, r->result->exceeding->height));
    snprintf(text, size, "On the rig: %s%.3f m%s%s%s; g_eff = %.3f ± %.3f m/s2 from %d pairs.", side,
             sf_cfh_rig_height(r->rig, height), below, r->spread ? " as simulated" : "", uncertainty,
             r->rig->gravity, r->rig->standard_error, r->rig->pairs);
}

/* Value of the fit at a point; NaN for one that is not in the fit. */
static double fitted(const sf_cfh_report *r, sf_cfh_criterion c, const sf_cfh_point *p) {
    const sf_cfh_fit *fit = &r->result->crossing[c].fit;
    bool inside = !p->failed && p->height >= fit->low && p->height <= fit->high;
    return inside ? sf_cfh_fit_at(fit, p->height) : NAN;
}

const char *sf_cfh_side_word(const sf_cfh_crossing *crossing) {
    static const char *const words[] = {"crossed", "not reached", "exceeded at the lowest height"};
    return crossing->side == SF_CFH_CROSSED && isnan(crossing->height) ? "not determined"
                                                                       : words[crossing->side];
}

/* ---- rows ---- */

#define AT(member) SF_ROW_OF(NUMBER, sf_cfh_point_row, member)

sf_rows sf_cfh_point_rows(const sf_cfh_report *r) {
    static const sf_row rows[] = {
        {"height_m", "height", "m", "%.3f", AT(p.height)},
        {"speed_m_s", "speed", "m/s", "%.3f", AT(p.speed)},
        {"a_max_g", "a_max", "g", "%.1f", AT(p.value[SF_CFH_A_MAX])},
        {"a_max_residual", "residual", "%", "%.2f", .shown = 100, AT(residual[SF_CFH_A_MAX])},
        {"hic", "HIC", NULL, "%.0f", AT(p.value[SF_CFH_HIC])},
        {"hic_residual", "residual", "%", "%.2f", .shown = 100, AT(residual[SF_CFH_HIC])},
        {"v_rebound_m_s", "rebound", "m/s", "%.2f", AT(p.v_rebound)},
        {"max_indentation_mm", .factor = 1e3, AT(p.max_indentation)},
        {"max_local_strain", "largest local strain", NULL, "%.3f", AT(p.max_local_strain)},
        {"energy_error", AT(p.energy_error)},
        {"failed", SF_ROW_OF(FLAG, sf_cfh_point_row, p.failed)},
        {"grade", SF_ROW_OF(STRING, sf_cfh_point_row, grade)},
        {NULL, "verdict", SF_ROW_OF(STRING, sf_cfh_point_row, verdict)},
        {"note", SF_ROW_OF(TEXT, sf_cfh_point_row, p.note)},
        {"rig_height_m", "on the rig", "m", "%.3f", AT(rig_height)}, /* with a rig */
    };
    sf_rows list = SF_ROWS(rows);
    list.count -= r->rig->pairs == 0;
    return list;
}

sf_records sf_cfh_point_records(const sf_cfh_report *r, sf_cfh_point_row list[SF_CFH_MAX_POINTS]) {
    for (int k = 0; k < r->points->count; k++) {
        const sf_cfh_point *p = &r->points->point[k];
        const char *grade = sf_verdict_phrase(p->grade);
        list[k] = (sf_cfh_point_row){.p = *p,
                                     .rig_height = sf_cfh_rig_height(r->rig, p->height),
                                     .grade = grade,
                                     .verdict = p->failed ? "failed" : grade};
        for (sf_cfh_criterion c = SF_CFH_A_MAX; c < SF_CFH_CRITERIA; c++) {
            list[k].fit[c] = fitted(r, c, p);
            list[k].residual[c] = log(p->value[c] / list[k].fit[c]);
        }
    }
    return (sf_records){list, sizeof list[0], r->points->count};
}

static sf_value draw_number(const void *record) {
    return sf_value_integer(((const sf_cfh_check *)record)->draw + 1);
}

static sf_value criterion_name(const void *record) {
    return sf_value_text(sf_cfh_name(((const sf_cfh_check *)record)->first));
}

#undef AT
#define AT(member) SF_ROW_OF(NUMBER, sf_cfh_check, member)

sf_rows sf_cfh_check_rows(void) {
    static const sf_row rows[] = {
        {"draw", "simulated draw", .value = draw_number},
        {"share_below", "draws below", "%", "%.0f", .shown = 100, AT(share)},
        {"height_m", "height", "m", "%.3f", AT(height)},
        {"criterion", "limit", .value = criterion_name, .type = SF_ROW_STRING},
        {"a_max_columns_g", "a_max, columns", "g", "%.1f", AT(columns[SF_CFH_A_MAX])},
        {"a_max_g", "simulated", "g", "%.1f", AT(simulated[SF_CFH_A_MAX])},
        {"a_max_error", "more than that", "%", "%.2f", .shown = 100, AT(error[SF_CFH_A_MAX])},
        {"hic_columns", "HIC, columns", NULL, "%.0f", AT(columns[SF_CFH_HIC])},
        {"hic", "simulated", NULL, "%.0f", AT(simulated[SF_CFH_HIC])},
        {"hic_error", "more than that", "%", "%.2f", .shown = 100, AT(error[SF_CFH_HIC])},
        {"failed", SF_ROW_OF(FLAG, sf_cfh_check, failed)},
        {"note", SF_ROW_OF(TEXT, sf_cfh_check, note)},
    };
    return SF_ROWS(rows);
}

#undef AT

/* ---- cfh.json ---- */

/* To which side is the interval open? NULL: there is none. */
static const char *open_side(const sf_cfh_interval *i) {
    if (!i || isnan(i->median))
        return NULL;
    return i->low <= 0 ? isinf(i->high) ? "both" : "below" : isinf(i->high) ? "above" : "no";
}

void sf_cfh_put_interval_json(sf_json *json, const char *name, const sf_cfh_interval *i) {
    static const sf_cfh_interval none = {NAN, NAN, NAN, {NAN, NAN}};
    const char *open = open_side(i);
    i = i ? i : &none;
    SF_PRINTED(key, 64, "%s_low_m", name);
    sf_json_number(json, key, isinf(i->low) ? i->end[1] : i->low > 0 ? i->low : NAN);
    snprintf(key, sizeof key, "%s_median_m", name);
    sf_json_number(json, key, i->median > 0 ? i->median : NAN);
    snprintf(key, sizeof key, "%s_high_m", name);
    sf_json_number(json, key, i->high > 0 ? i->high : i->end[0]);
    snprintf(key, sizeof key, "%s_open", name);
    sf_json_text(json, key, open);
}

/* The members of the object `posterior` of cfh.json. */
static void put_spread_json(sf_json *json, const sf_cfh_spread *s) {
    static const char *const names[SF_CFH_PARTS] = {"foam", "foam_response", "foam_response_mesh",
                                                    "foam_response_mesh_fit",
                                                    "foam_response_mesh_fit_columns"};
    static const char *const shares[SF_CFH_PARTS] = {"foam", "response", "mesh", "fit", "columns"};
    SF_JSON_NUMBERS(json, {"draws", s->draws}, {"draws_above", s->above}, {"draws_below", s->below},
                    {"draws_collapsed", s->collapsed}, {"draws_beyond_simulated", s->beyond},
                    {"repeats", SF_CFH_REPEATS}, {"expected_mesh_error", s->mesh_error},
                    {"mesh_error_factor", SF_CFH_MESH_SIZE}, {"mesh_error_hic_factor", SF_CFH_MESH_HIC},
                    {"fit_scatter_a_max", s->fit_scatter[SF_CFH_A_MAX]},
                    {"fit_scatter_hic", s->fit_scatter[SF_CFH_HIC]});
    for (int part = 0; part < SF_CFH_PARTS; part++)
        sf_cfh_put_interval_json(json, names[part], &s->part[part][SF_CFH_FIRST]);
    sf_cfh_put_interval_json(json, "single_drop", &s->part[SF_CFH_PARTS][SF_CFH_FIRST]);
    sf_json_bool(json, "response_errors", s->with_response);
    sf_json_open(json, "shares", '{');
    for (int part = 0; part < SF_CFH_PARTS; part++)
        sf_json_number(json, shares[part], sf_cfh_spread_share(s, (sf_cfh_part)part));
    sf_json_close(json);
    sf_json_open(json, "columns_error", '{');
    SF_JSON_NUMBERS(json, {"degrees_of_freedom", s->freedom},
                    {"a_max", sf_cfh_columns_error(s, SF_CFH_A_MAX)},
                    {"hic", sf_cfh_columns_error(s, SF_CFH_HIC)});
    sf_json_close(json);
    sf_rows_json_array(json, "checks", sf_cfh_check_rows(),
                       (sf_records){s->check, sizeof s->check[0], s->checks});
}

/* Height of free fall and, if there is a rig, on the rig; `part` SF_CFH_FIRST or a criterion. */
static void put_heights(sf_json *json, const sf_cfh_report *r, double height, int part) {
    sf_json_number(json, "height_m", height);
    sf_cfh_put_interval_json(json, "height", r->spread ? sf_cfh_spread_whole(r->spread, part) : NULL);
    if (r->rig->pairs == 0)
        return;
    sf_json_number(json, "rig_height_m", sf_cfh_rig_height(r->rig, height));
    if (part == SF_CFH_FIRST)
        sf_cfh_put_interval_json(json, "rig_height", r->spread ? &r->spread->rig : NULL);
}

static void put_verdict(sf_json *json, const sf_cfh_report *r) {
    static const char *const words[] = {"found", "above the highest point", "below the lowest point",
                                        "not determined"};
    const sf_cfh_result *v = r->result;
    bool found = v->verdict == SF_CFH_FOUND, decided = found || v->verdict == SF_CFH_BELOW;
    SF_JSON_OBJECT(json, "critical_fall_height");
    SF_JSON_TEXTS(json, {"verdict", words[v->verdict]},
                  {"problem", v->verdict == SF_CFH_UNKNOWN ? v->problem.text : NULL},
                  {"deciding", !decided                                     ? NULL
                               : isnan(v->lowest) && v->exceeding->on_anvil ? "anvil"
                                                                            : sf_cfh_name(v->deciding)});
    double height = found ? v->crossing[v->deciding].height : NAN;
    put_heights(json, r, height, SF_CFH_FIRST);
    SF_JSON_NUMBERS(json, {"speed_m_s", sf_cfh_speed(height)}, {"confidence", 0.95},
                    {"lowest_simulated_m", v->lowest}, {"highest_simulated_m", v->highest},
                    {"exceeded_at_m", v->exceeding ? v->exceeding->height : NAN},
                    {"reaches_anvil_m", v->exceeding && v->exceeding->on_anvil ? v->exceeding->height : NAN});
    sf_json_text(json, "search_ended", sf_cfh_step_text(r->ending));
}

/* The interval of the fit says how well a quadratic fits, not how well the height is known. */
static void put_fit(sf_json *json, const sf_cfh_report *r, const sf_cfh_crossing *crossing) {
    const sf_cfh_fit *fit = &crossing->fit;
    double margin = sf_cfh_rig_margin(r->rig, crossing->margin), none = fit->count ? 0 : NAN,
           on_rig = sf_cfh_rig_height(r->rig, crossing->height);
    SF_JSON_OBJECT(json, "fit");
    sf_json_text(json, "form", "ln(value) = c0 + c1 d + c2 d^2, d = ln(height_m) - centre");
    SF_JSON_NUMBERS(json, {"centre", fit->centre + none}, {"c0", fit->c[0] + none}, {"c1", fit->c[1] + none},
                    {"c2", fit->c[2] + none}, {"points", fit->count}, {"rms_residual", fit->rms + none});
    sf_json_bool(json, "bracketed", crossing->bracketed);
    SF_JSON_NUMBERS(json, {"fit_low_m", crossing->low}, {"fit_high_m", crossing->high});
    if (r->rig->pairs > 0)
        SF_JSON_NUMBERS(json, {"fit_rig_low_m", on_rig * exp(-margin)},
                        {"fit_rig_high_m", on_rig * exp(margin)});
}

static void put_criteria(sf_json *json, const sf_cfh_report *r) {
    SF_JSON_ARRAY(json, "criteria");
    for (sf_cfh_criterion c = SF_CFH_A_MAX; c < SF_CFH_CRITERIA; c++) {
        const sf_cfh_crossing *crossing = &r->result->crossing[c];
        SF_JSON_OBJECT(json, NULL);
        sf_json_text(json, "criterion", sf_cfh_name(c));
        sf_json_number(json, c == SF_CFH_A_MAX ? "limit_g" : "limit", r->plan->limit[c]);
        sf_json_text(json, "state", sf_cfh_side_word(crossing));
        put_heights(json, r, crossing->height, (int)c);
        put_fit(json, r, crossing);
    }
}

static void put_posterior(sf_json *json, const sf_cfh_report *r) {
    SF_JSON_OBJECT(json, "posterior");
    SF_JSON_TEXTS(json, {"folder", r->posterior}, {"no_interval", r->no_interval[0] ? r->no_interval : NULL});
    if (r->spread)
        put_spread_json(json, r->spread);
}

static double least_end(const sf_cfh_foams *foams) {
    double least = INFINITY;
    for (int k = 0; k < foams->count; k++)
        least = fmin(least, foams->foam[k].end);
    return least;
}

sf_status sf_cfh_write_json(const sf_staging *output, const sf_cfh_report *r, sf_error *err) {
    sf_cfh_point_row points[SF_CFH_MAX_POINTS];
    SF_JSON_FILE(json, output, "cfh.json", err);
    SF_JSON_TEXTS(&json, {"program", "softfall-cfh " SF_VERSION}, {"command_line", r->command_line},
                  {"caution", sf_cfh_caution}, {"case", r->case_path}, {"material", r->material});
    sf_json_number(&json, "missile_mass_kg", r->mass);
    sf_json_text(&json, "judged_by", *r->counted ? r->counted : NULL);
    sf_json_number(&json, "compression_table_end", least_end(r->foams));
    put_verdict(&json, r);
    sf_json_open(&json, "rig", '{');
    sf_json_text(&json, "file", r->rig_path);
    sf_json_integer(&json, "pairs", r->rig->pairs);
    sf_json_number(&json, "g_eff_m_s2", r->rig->gravity);
    sf_json_number(&json, "standard_error_m_s2", r->rig->pairs ? r->rig->standard_error : NAN);
    sf_json_close(&json);
    put_posterior(&json, r);
    put_criteria(&json, r);
    sf_rows_json_array(&json, "points", sf_cfh_point_rows(r), sf_cfh_point_records(r, points));
    sf_json_close(&json);
    return sf_staging_close(json.file, "cfh.json", err);
}

/* ---- cfh.csv ---- */

#define AT(member) SF_ROW_OF(NUMBER, sf_cfh_point_row, member)

sf_status sf_cfh_write_csv(const sf_staging *output, const sf_cfh_report *r, sf_error *err) {
    static const sf_row rows[] = {
        {"height_m", AT(p.height)},
        {"speed_m_s", AT(p.speed)},
        {"a_max_g", AT(p.value[SF_CFH_A_MAX])},
        {"hic_1", AT(p.value[SF_CFH_HIC])},
        {"a_max_fit_g", AT(fit[SF_CFH_A_MAX])},
        {"hic_fit_1", AT(fit[SF_CFH_HIC])},
        {"v_rebound_m_s", AT(p.v_rebound)},
        {"max_indentation_mm", .factor = 1e3, AT(p.max_indentation)},
        {"max_local_strain_1", AT(p.max_local_strain)},
        {"energy_error_1", AT(p.energy_error)},
        {"failed_1", SF_ROW_OF(FLAG, sf_cfh_point_row, p.failed)},
        {"rig_height_m", AT(rig_height)}, /* with a rig */
    };
    sf_cfh_point_row points[SF_CFH_MAX_POINTS];
    sf_rows list = SF_ROWS(rows);
    SF_CSV_FILE(csv, output, "cfh.csv", err);
    list.count -= r->rig->pairs == 0;
    sf_rows_csv(&csv, list, sf_cfh_point_records(r, points));
    return sf_csv_close(&csv, err);
}

#undef AT

static sf_status write_band(const sf_staging *output, const sf_cfh_spread *s, sf_error *err) {
    SF_CSV_FILE(csv, output, "cfh_band.csv", err);
    SF_CSV_PRINT_LINE(&csv,
                      "height_m,a_max_low_g,a_max_median_g,a_max_high_g,hic_low_1,hic_median_1,hic_high_1,"
                      "a_max_scatter_1,hic_scatter_1");
    for (int k = 0; k < s->grid; k++) {
        SF_CSV_NUMBERS(&csv, s->height[k]);
        for (int c = 0; c < SF_CFH_CRITERIA; c++)
            SF_CSV_NUMBERS(&csv, s->band[c][k].low, s->band[c][k].median, s->band[c][k].high);
        SF_CSV_LINE(&csv, s->scatter[SF_CFH_A_MAX][k], s->scatter[SF_CFH_HIC][k]);
    }
    return sf_csv_close(&csv, err);
}

static sf_status write_crossings(const sf_staging *output, const sf_cfh_spread *s, sf_error *err) {
    SF_CSV_FILE(csv, output, "cfh_draws.csv", err);
    SF_CSV_PRINT_LINE(&csv,
                      "draw_1,height_m,a_max_height_m,hic_height_m,a_max_shared_1,hic_shared_1,a_max_sd_1,"
                      "hic_sd_1,a_max_columns_sd_1,hic_columns_sd_1");
    for (int d = 0; d < s->draws; d++) {
        const sf_cfh_curve *draw = &s->draw[d];
        sf_csv_print(&csv, "%d", d + 1);
        for (int k = 0; k <= SF_CFH_FIRST; k++) { /* the first of them in front */
            double height = draw->crossing[k == 0 ? SF_CFH_FIRST : k - 1];
            SF_CSV_NUMBERS(&csv, height > 0 ? height : NAN);
        }
        static const double none[SF_CFH_CRITERIA] = {NAN, NAN};
        sf_csv_numbers(&csv, SF_CFH_CRITERIA, s->with_response ? draw->shared : none);
        sf_csv_numbers(&csv, SF_CFH_CRITERIA, s->with_response ? draw->own_sd : none);
        sf_csv_numbers(&csv, SF_CFH_CRITERIA, s->freedom > 0 ? draw->columns_sd : none);
        sf_csv_end(&csv);
    }
    return sf_csv_close(&csv, err);
}

/* The corrected columns of each draw over the height, as far as they do not collapse. */
static sf_status write_curves(const sf_staging *output, const sf_cfh_spread *s, sf_error *err) {
    SF_CSV_FILE(csv, output, "cfh_curves.csv", err);
    SF_CSV_PRINT_LINE(&csv, "draw_1,height_m,a_max_g,hic_1,a_max_columns_g,hic_columns_1");
    for (int d = 0; d < s->draws; d++)
        for (int k = 0; k < s->draw[d].reach; k++) {
            const sf_cfh_curve *draw = &s->draw[d];
            sf_csv_print(&csv, "%d", d + 1);
            SF_CSV_LINE(&csv, s->height[k], exp(draw->value[SF_CFH_A_MAX][k]),
                        exp(draw->value[SF_CFH_HIC][k]), exp(draw->column[SF_CFH_A_MAX][k]),
                        exp(draw->column[SF_CFH_HIC][k]));
        }
    return sf_csv_close(&csv, err);
}

sf_status sf_cfh_write_draws(const sf_staging *output, const sf_cfh_report *r, sf_error *err) {
    if (r->spread && write_band(output, r->spread, err) == SF_OK &&
        write_crossings(output, r->spread, err) == SF_OK)
        write_curves(output, r->spread, err);
    return err->status;
}

/* ---- terminal ---- */

static void put_checks(FILE *out, const sf_cfh_spread *s) {
    for (int k = 0; k < s->checks; k++) {
        const sf_cfh_check *check = &s->check[k];
        if (!check->failed)
            fprintf(out, "  draw %d at %.3f m: a_max %.1f g by columns, %.1f g simulated; HIC %.0f, %.0f\n",
                    check->draw + 1, check->height, check->columns[SF_CFH_A_MAX],
                    check->simulated[SF_CFH_A_MAX], check->columns[SF_CFH_HIC], check->simulated[SF_CFH_HIC]);
    }
}

/* Puts the shares of the sources of uncertainty, where the interval is closed. */
static void put_shares(FILE *out, const sf_cfh_spread *s) {
    double share[SF_CFH_PARTS];
    for (int part = 0; part < SF_CFH_PARTS; part++)
        share[part] = 100 * sf_cfh_spread_share(s, (sf_cfh_part)part);
    if (isnan(share[SF_CFH_PART_FOAM]))
        return;
    fprintf(out, "  of the interval (its squared length): foam %.0f %%, ", share[SF_CFH_PART_FOAM]);
    if (s->with_response)
        fprintf(out, "errors of the responses %.0f %%, ", share[SF_CFH_PART_RESPONSE]);
    fprintf(out, "mesh %.0f %%, fit and columns %.0f %%\n", share[SF_CFH_PART_MESH],
            share[SF_CFH_PART_FIT] + share[SF_CFH_PART_COLUMNS]);
}

void sf_cfh_print(FILE *out, const sf_cfh_report *r) {
    char text[SF_CFH_VERDICT_SIZE];
    for (sf_cfh_criterion c = SF_CFH_A_MAX; c < SF_CFH_CRITERIA; c++) {
        const sf_cfh_crossing *crossing = &r->result->crossing[c];
        fprintf(out, "  %-5s %6g%-2s  ", sf_cfh_name(c), r->plan->limit[c], sf_cfh_unit(c));
        if (crossing->bracketed)
            fprintf(
                out,
                "between drops at %.3f and %.3f m, which a quadratic does not describe (rms residual %.2f %%)\n",
                crossing->low, crossing->high, 100 * crossing->fit.rms);
        else if (isfinite(crossing->height))
            fprintf(out, "at %.3f m, fit of %d points, rms residual %.2f %%\n", crossing->height,
                    crossing->fit.count, 100 * crossing->fit.rms);
        else
            fprintf(out, "%s\n", sf_cfh_side_word(crossing));
    }
    if (r->spread) {
        put_checks(out, r->spread);
        put_shares(out, r->spread);
    }
    sf_cfh_verdict_text(r, text, sizeof text);
    fprintf(out, "%s\n", text);
    sf_cfh_rig_text(r, text, sizeof text);
    if (text[0])
        fprintf(out, "%s\n", text);
    fprintf(out, "%s\n", sf_cfh_caution);
}
