/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/cfh/cfh_report.h"

#include "build_info.h"
#include "report/row.h"

#include <math.h>
#include <string.h>

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
    size_t used = 0;
    int failed = 0;
    text[0] = '\0';
    for (size_t k = 0; k < sizeof kinds / sizeof kinds[0] && used < size; k++)
        if (kinds[k].count > 0)
            used += (size_t)snprintf(text + used, size - used, "%s%d of the %d draws %s.", used ? " " : "",
                                     kinds[k].count, s->draws, kinds[k].words);
    for (int k = 0; k < s->checks; k++)
        failed += s->check[k].failed;
    if (failed > 0 && used < size)
        used +=
            (size_t)snprintf(text + used, size - used,
                             "%s%d of the %d simulated draws failed: there the columns are not confirmed.",
                             used ? " " : "", failed, s->checks);
    if (is_aside(s) && used < size)
        snprintf(
            text + used, size - used,
            "%sThe height of the case's own material, %.3g m, lies outside of 95 %% of the draws: it is not the foam "
            "that they describe.",
            used ? " " : "", s->own_height);
}

const char *sf_cfh_response_text(const sf_cfh_spread *s) {
    return s->with_response
               ? ""
               : "The draws have no response_error: errors of the responses are not in the interval, "
                 "which is too narrow where the law misses more than the curve.";
}

const char sf_cfh_caution[] = "Indicative, not a certification: a computed height from one simulated impact "
                              "site, not the test of ASTM F1292 or EN 1177.";

const sf_cfh_crossing *sf_cfh_deciding(const sf_cfh_report *r) {
    return &r->result->crossing[r->result->deciding];
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

/* The height as simulated; plain text that ends in a full stop. */
static void simulated_text(const sf_cfh_report *r, char *text, size_t size) {
    const sf_cfh_result *v = r->result;
    const char *name = sf_cfh_name(v->deciding), *unit = sf_cfh_unit(v->deciding);
    double limit = r->plan->limit[v->deciding];
    switch (v->verdict) {
    case SF_CFH_FOUND:
        snprintf(text, size, "Critical fall height %.3f m of free fall%s: %s reaches %g%s first.",
                 sf_cfh_deciding(r)->height, r->spread ? " as simulated" : "", name, limit, unit);
        break;
    case SF_CFH_ABOVE:
        if (!isnan(v->anvil)) {
            snprintf(
                text, size,
                "Critical fall height above %.3f m and below %.3f m of free fall: neither a_max %g g nor HIC %g is "
                "reached, but from %.3f m the missile reaches the anvil.",
                v->highest, v->anvil, r->plan->limit[SF_CFH_A_MAX], r->plan->limit[SF_CFH_HIC], v->anvil);
            break;
        }
        snprintf(text, size,
                 "Critical fall height above %.3f m of free fall: neither a_max %g g nor HIC %g is reached.",
                 v->highest, r->plan->limit[SF_CFH_A_MAX], r->plan->limit[SF_CFH_HIC]);
        break;
    case SF_CFH_BELOW:
        if (isnan(v->lowest)) {
            snprintf(
                text, size,
                "Critical fall height below %.3f m of free fall: from there the missile reaches the anvil.",
                v->anvil);
            break;
        }
        snprintf(text, size,
                 "Critical fall height below %.3f m of free fall: %s exceeds %g%s at the lowest height.",
                 v->lowest, name, limit, unit);
        break;
    case SF_CFH_UNKNOWN:
        snprintf(text, size, "Critical fall height not determined: %s.", v->problem.text);
        break;
    }
}

void sf_cfh_verdict_text(const sf_cfh_report *r, char *text, size_t size) {
    char uncertainty[SF_CFH_NOTE_SIZE + 100];
    simulated_text(r, text, size);
    size_t used = strlen(text);
    if (r->result->verdict == SF_CFH_UNKNOWN && !r->spread)
        return;
    uncertainty_text(r, uncertainty, sizeof uncertainty);
    snprintf(text + used, size - used, "%s", uncertainty);
}

/* Returns the upper bound of the height for the verdict SF_CFH_BELOW. */
double sf_cfh_upper_bound(const sf_cfh_result *v) {
    return isnan(v->lowest) ? v->anvil : v->lowest;
}

/* The same on the rig; "" without a rig or a height. */
void sf_cfh_rig_text(const sf_cfh_report *r, char *text, size_t size) {
    double height = NAN;
    char interval[64], uncertainty[160] = "";
    const char *side = "";
    text[0] = '\0';
    if (r->result->verdict == SF_CFH_FOUND) {
        height = sf_cfh_deciding(r)->height;
    } else if (r->result->verdict == SF_CFH_ABOVE) {
        height = r->result->highest;
        side = "above ";
    } else if (r->result->verdict == SF_CFH_BELOW) {
        height = sf_cfh_upper_bound(r->result);
        side = "below ";
    }
    if (r->rig->pairs == 0 || isnan(height))
        return;
    if (r->spread)
        snprintf(uncertainty, sizeof uncertainty,
                 "; with these uncertainties and that of g_eff: 95 %% interval %s",
                 sf_cfh_interval_text(&r->spread->rig, interval, sizeof interval));
    snprintf(text, size, "On the rig: %s%.3f m%s%s; g_eff = %.3f ± %.3f m/s2 from %d pairs.", side,
             sf_cfh_rig_height(r->rig, height), r->spread ? " as simulated" : "", uncertainty,
             r->rig->gravity, r->rig->standard_error, r->rig->pairs);
}

static bool is_fitted(const sf_cfh_report *r, sf_cfh_criterion c, const sf_cfh_point *p) {
    const sf_cfh_fit *fit = &r->result->crossing[c].fit;
    int k = 0; /* index among the successes */
    for (const sf_cfh_point *q = r->points->point; q < p; q++)
        k += !q->failed;
    return !p->failed && fit->count > 0 && k >= fit->first && k < fit->first + fit->count;
}

/* ln(value / fit), NaN for a point that is not in the fit. */
double sf_cfh_residual(const sf_cfh_report *r, sf_cfh_criterion c, const sf_cfh_point *p) {
    return is_fitted(r, c, p) ? log(p->value[c] / sf_cfh_fit_at(&r->result->crossing[c].fit, p->height))
                              : NAN;
}

const char *sf_cfh_side_word(const sf_cfh_crossing *crossing) {
    static const char *const words[] = {"crossed", "not reached", "exceeded at the lowest height"};
    return crossing->side == SF_CFH_CROSSED && isnan(crossing->height) ? "not determined"
                                                                       : words[crossing->side];
}

/* ---- cfh.json ---- */

/* To which side is the interval open? NULL: there is none. */
static const char *open_side(const sf_cfh_interval *i) {
    if (!i || isnan(i->median))
        return NULL;
    return i->low <= 0 ? isinf(i->high) ? "both" : "below" : isinf(i->high) ? "above" : "no";
}

void sf_cfh_put_interval_json(sf_json *json, const char *name, const sf_cfh_interval *i) {
    char key[64];
    static const sf_cfh_interval none = {NAN, NAN, NAN, {NAN, NAN}};
    const char *open = open_side(i);
    i = i ? i : &none;
    snprintf(key, sizeof key, "%s_low_m", name);
    sf_json_number(json, key, isinf(i->low) ? i->end[1] : i->low > 0 ? i->low : NAN);
    snprintf(key, sizeof key, "%s_median_m", name);
    sf_json_number(json, key, i->median > 0 ? i->median : NAN);
    snprintf(key, sizeof key, "%s_high_m", name);
    sf_json_number(json, key, i->high > 0 ? i->high : i->end[0]);
    snprintf(key, sizeof key, "%s_open", name);
    sf_json_text(json, key, open);
}

static void put_trends_json(sf_json *json, const sf_cfh_spread *s) {
    sf_json_open(json, "columns_error", '[');
    for (int c = 0; c < SF_CFH_CRITERIA; c++) {
        const sf_cfh_trend *t = &s->trend[c];
        bool trend = t->sum > 0;
        sf_json_open(json, NULL, '{');
        sf_json_text(json, "criterion", sf_cfh_name((sf_cfh_criterion)c));
        sf_json_integer(json, "checks", t->checks);
        sf_json_number(json, "centre_m", trend ? exp(t->centre) : NAN);
        sf_json_number(json, "shift", trend ? t->shift : NAN);
        sf_json_number(json, "slope", trend ? t->slope : NAN);
        sf_json_number(json, "scatter", t->scatter);
        sf_json_integer(json, "degrees_of_freedom", t->freedom);
        sf_json_close(json, '}');
    }
    sf_json_close(json, ']');
}

static void put_checks_json(sf_json *json, const sf_cfh_spread *s) {
    sf_json_open(json, "checks", '[');
    for (int k = 0; k < s->checks; k++) {
        const sf_cfh_check *check = &s->check[k];
        sf_json_open(json, NULL, '{');
        sf_json_integer(json, "draw", check->draw + 1);
        sf_json_number(json, "share_below", check->share);
        sf_json_number(json, "height_m", check->height);
        sf_json_text(json, "criterion", sf_cfh_name(check->first));
        sf_json_number(json, "a_max_columns_g", check->columns[SF_CFH_A_MAX]);
        sf_json_number(json, "a_max_g", check->failed ? NAN : check->simulated[SF_CFH_A_MAX]);
        sf_json_number(json, "hic_columns", check->columns[SF_CFH_HIC]);
        sf_json_number(json, "hic", check->failed ? NAN : check->simulated[SF_CFH_HIC]);
        sf_json_number(json, "height_shift", check->failed ? NAN : check->shift[check->first]);
        sf_json_number(json, "a_max_height_shift", check->failed ? NAN : check->shift[SF_CFH_A_MAX]);
        sf_json_number(json, "hic_height_shift", check->failed ? NAN : check->shift[SF_CFH_HIC]);
        sf_json_bool(json, "failed", check->failed);
        sf_json_text(json, "note", check->note[0] ? check->note : NULL);
        sf_json_close(json, '}');
    }
    sf_json_close(json, ']');
}

/* The members of the object `posterior` of cfh.json. */
static void put_spread_json(sf_json *json, const sf_cfh_spread *s) {
    static const char *const names[SF_CFH_PARTS] = {"foam", "foam_response", "foam_response_mesh",
                                                    "foam_response_mesh_fit",
                                                    "foam_response_mesh_fit_columns"};
    static const char *const shares[SF_CFH_PARTS] = {"foam", "response", "mesh", "fit", "columns"};
    sf_json_integer(json, "draws", s->draws);
    sf_json_integer(json, "draws_above", s->above);
    sf_json_integer(json, "draws_below", s->below);
    sf_json_integer(json, "draws_collapsed", s->collapsed);
    sf_json_integer(json, "draws_beyond_simulated", s->beyond);
    sf_json_integer(json, "repeats", SF_CFH_REPEATS);
    sf_json_number(json, "expected_mesh_error", s->mesh_error);
    sf_json_number(json, "fit_scatter_a_max", s->fit_scatter[SF_CFH_A_MAX]);
    sf_json_number(json, "fit_scatter_hic", s->fit_scatter[SF_CFH_HIC]);
    for (int part = 0; part < SF_CFH_PARTS; part++)
        sf_cfh_put_interval_json(json, names[part], &s->part[part][SF_CFH_FIRST]);
    sf_cfh_put_interval_json(json, "single_drop", &s->part[SF_CFH_PARTS][SF_CFH_FIRST]);
    sf_json_bool(json, "response_errors", s->with_response);
    sf_json_open(json, "shares", '{');
    for (int part = 0; part < SF_CFH_PARTS; part++)
        sf_json_number(json, shares[part], sf_cfh_spread_share(s, (sf_cfh_part)part, SF_CFH_FIRST));
    sf_json_close(json, '}');
    put_trends_json(json, s);
    put_checks_json(json, s);
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
    sf_json_open(json, "critical_fall_height", '{');
    sf_json_text(json, "verdict", words[v->verdict]);
    sf_json_text(json, "problem", v->verdict == SF_CFH_UNKNOWN ? v->problem.text : NULL);
    sf_json_text(json, "deciding", !decided ? NULL : isnan(v->lowest) ? "anvil" : sf_cfh_name(v->deciding));
    put_heights(json, r, found ? sf_cfh_deciding(r)->height : NAN, SF_CFH_FIRST);
    sf_json_number(json, "speed_m_s", found ? sf_cfh_speed(sf_cfh_deciding(r)->height) : NAN);
    sf_json_number(json, "confidence", 0.95);
    sf_json_number(json, "lowest_simulated_m", v->lowest);
    sf_json_number(json, "highest_simulated_m", v->highest);
    sf_json_number(json, "reaches_anvil_m", v->anvil);
    sf_json_text(json, "search_ended", sf_cfh_step_text(r->ending));
    sf_json_close(json, '}');
}

/* The interval of the fit says how well a quadratic fits, not how well the height is known. */
static void put_fit(sf_json *json, const sf_cfh_report *r, const sf_cfh_crossing *crossing) {
    const sf_cfh_fit *fit = &crossing->fit;
    double margin = sf_cfh_rig_margin(r->rig, crossing->margin),
           on_rig = sf_cfh_rig_height(r->rig, crossing->height);
    sf_json_open(json, "fit", '{');
    sf_json_text(json, "form", "ln(value) = c0 + c1 d + c2 d^2, d = ln(height_m) - centre");
    sf_json_number(json, "centre", fit->count ? fit->centre : NAN);
    sf_json_number(json, "c0", fit->count ? fit->c[0] : NAN);
    sf_json_number(json, "c1", fit->count ? fit->c[1] : NAN);
    sf_json_number(json, "c2", fit->count ? fit->c[2] : NAN);
    sf_json_integer(json, "points", fit->count);
    sf_json_number(json, "rms_residual", fit->count ? fit->rms : NAN);
    sf_json_bool(json, "bracketed", crossing->bracketed);
    sf_json_number(json, "fit_low_m", crossing->low);
    sf_json_number(json, "fit_high_m", crossing->high);
    if (r->rig->pairs > 0) {
        sf_json_number(json, "fit_rig_low_m", on_rig * exp(-margin));
        sf_json_number(json, "fit_rig_high_m", on_rig * exp(margin));
    }
    sf_json_close(json, '}');
}

static void put_criteria(sf_json *json, const sf_cfh_report *r) {
    sf_json_open(json, "criteria", '[');
    for (sf_cfh_criterion c = SF_CFH_A_MAX; c < SF_CFH_CRITERIA; c++) {
        const sf_cfh_crossing *crossing = &r->result->crossing[c];
        sf_json_open(json, NULL, '{');
        sf_json_text(json, "criterion", sf_cfh_name(c));
        sf_json_number(json, c == SF_CFH_A_MAX ? "limit_g" : "limit", r->plan->limit[c]);
        sf_json_text(json, "state", sf_cfh_side_word(crossing));
        put_heights(json, r, crossing->height, (int)c);
        put_fit(json, r, crossing);
        sf_json_close(json, '}');
    }
    sf_json_close(json, ']');
}

static void put_points(sf_json *json, const sf_cfh_report *r) {
    sf_json_open(json, "points", '[');
    for (int k = 0; k < r->points->count; k++) {
        const sf_cfh_point *p = &r->points->point[k];
        sf_json_open(json, NULL, '{');
        sf_json_number(json, "height_m", p->height);
        if (r->rig->pairs > 0)
            sf_json_number(json, "rig_height_m", sf_cfh_rig_height(r->rig, p->height));
        sf_json_number(json, "speed_m_s", p->speed);
        sf_json_bool(json, "failed", p->failed);
        sf_json_text(json, "grade", sf_verdict_phrase(p->grade));
        sf_json_number(json, "a_max_g", p->failed ? NAN : p->value[SF_CFH_A_MAX]);
        sf_json_number(json, "hic", p->failed ? NAN : p->value[SF_CFH_HIC]);
        sf_json_number(json, "a_max_residual", sf_cfh_residual(r, SF_CFH_A_MAX, p));
        sf_json_number(json, "hic_residual", sf_cfh_residual(r, SF_CFH_HIC, p));
        sf_json_number(json, "v_rebound_m_s", p->failed ? NAN : p->v_rebound);
        sf_json_number(json, "max_indentation_mm", p->failed ? NAN : p->max_indentation * 1e3);
        sf_json_number(json, "max_local_strain", p->failed ? NAN : p->max_local_strain);
        sf_json_number(json, "energy_error", p->failed ? NAN : p->energy_error);
        sf_json_text(json, "note", p->note[0] ? p->note : NULL);
        sf_json_close(json, '}');
    }
    sf_json_close(json, ']');
}

static void put_posterior(sf_json *json, const sf_cfh_report *r) {
    sf_json_open(json, "posterior", '{');
    sf_json_text(json, "folder", r->posterior);
    sf_json_text(json, "no_interval", r->no_interval[0] ? r->no_interval : NULL);
    if (r->spread)
        put_spread_json(json, r->spread);
    sf_json_close(json, '}');
}

static double least_end(const sf_cfh_foams *foams) {
    double least = INFINITY;
    for (int k = 0; k < foams->count; k++)
        least = fmin(least, foams->foam[k].end);
    return least;
}

sf_status sf_cfh_write_json(const sf_staging *output, const sf_cfh_report *r, sf_error *err) {
    FILE *file = sf_staging_open(output, "cfh.json", err);
    if (!file)
        return err->status;
    sf_json json = {.file = file};
    sf_json_open(&json, NULL, '{');
    sf_json_text(&json, "program", "softfall-cfh " SF_VERSION);
    sf_json_text(&json, "command_line", r->command_line);
    sf_json_text(&json, "caution", sf_cfh_caution);
    sf_json_text(&json, "case", r->case_path);
    sf_json_text(&json, "material", r->material);
    sf_json_number(&json, "missile_mass_kg", r->mass);
    sf_json_number(&json, "compression_table_end", least_end(r->foams));
    put_verdict(&json, r);
    sf_json_open(&json, "rig", '{');
    sf_json_text(&json, "file", r->rig_path);
    sf_json_integer(&json, "pairs", r->rig->pairs);
    sf_json_number(&json, "g_eff_m_s2", r->rig->gravity);
    sf_json_number(&json, "standard_error_m_s2", r->rig->pairs ? r->rig->standard_error : NAN);
    sf_json_close(&json, '}');
    put_posterior(&json, r);
    put_criteria(&json, r);
    put_points(&json, r);
    sf_json_close(&json, '}');
    return sf_staging_close(file, "cfh.json", err);
}

/* ---- cfh.csv ---- */

static void put_cell(FILE *file, double value) {
    if (isfinite(value))
        fprintf(file, ",%.9g", value);
    else
        fputc(',', file);
}

sf_status sf_cfh_write_csv(const sf_staging *output, const sf_cfh_report *r, sf_error *err) {
    FILE *file = sf_staging_open(output, "cfh.csv", err);
    if (!file)
        return err->status;
    fputs("height_m,speed_m_s,a_max_g,hic_1,a_max_fit_g,hic_fit_1,v_rebound_m_s,max_indentation_mm,max_local_"
          "strain_1,energy_error_1,failed_1",
          file);
    fputs(r->rig->pairs > 0 ? ",rig_height_m\n" : "\n", file);
    for (int k = 0; k < r->points->count; k++) {
        const sf_cfh_point *p = &r->points->point[k];
        fprintf(file, "%.9g,%.9g", p->height, p->speed);
        for (int c = 0; c < SF_CFH_CRITERIA; c++)
            put_cell(file, p->failed ? NAN : p->value[c]);
        for (sf_cfh_criterion c = SF_CFH_A_MAX; c < SF_CFH_CRITERIA; c++)
            put_cell(file, is_fitted(r, c, p) ? sf_cfh_fit_at(&r->result->crossing[c].fit, p->height) : NAN);
        put_cell(file, p->failed ? NAN : p->v_rebound);
        put_cell(file, p->failed ? NAN : p->max_indentation * 1e3);
        put_cell(file, p->failed ? NAN : p->max_local_strain);
        put_cell(file, p->failed ? NAN : p->energy_error);
        fprintf(file, ",%d", p->failed);
        if (r->rig->pairs > 0)
            put_cell(file, sf_cfh_rig_height(r->rig, p->height));
        fputc('\n', file);
    }
    return sf_staging_close(file, "cfh.csv", err);
}

static sf_status write_band(const sf_staging *output, const sf_cfh_spread *s, sf_error *err) {
    FILE *file = sf_staging_open(output, "cfh_band.csv", err);
    if (!file)
        return err->status;
    fputs(
        "height_m,a_max_low_g,a_max_median_g,a_max_high_g,hic_low_1,hic_median_1,hic_high_1,a_max_correction_1,"
        "hic_correction_1,a_max_scatter_1,hic_scatter_1\n",
        file);
    for (int k = 0; k < s->grid; k++) {
        fprintf(file, "%.9g", s->height[k]);
        for (int c = 0; c < SF_CFH_CRITERIA; c++) {
            const sf_cfh_band *band = &s->band[c][k];
            put_cell(file, band->low);
            put_cell(file, band->median);
            put_cell(file, band->high);
        }
        put_cell(file, exp(s->correction[SF_CFH_A_MAX][k]));
        put_cell(file, exp(s->correction[SF_CFH_HIC][k]));
        put_cell(file, s->scatter[SF_CFH_A_MAX][k]);
        put_cell(file, s->scatter[SF_CFH_HIC][k]);
        fputc('\n', file);
    }
    return sf_staging_close(file, "cfh_band.csv", err);
}

static sf_status write_crossings(const sf_staging *output, const sf_cfh_spread *s, sf_error *err) {
    FILE *file = sf_staging_open(output, "cfh_draws.csv", err);
    if (!file)
        return err->status;
    fputs("draw_1,height_m,a_max_height_m,hic_height_m,a_max_shared_1,hic_shared_1,a_max_sd_1,hic_sd_1\n",
          file);
    for (int d = 0; d < s->draws; d++) {
        const double *crossing = &s->crossing[(size_t)d * (SF_CFH_FIRST + 1)];
        const sf_cfh_response *error = &s->response[d];
        fprintf(file, "%d", d + 1);
        for (int k = 0; k <= SF_CFH_FIRST; k++) { /* the first of them in front */
            double height = crossing[k == 0 ? SF_CFH_FIRST : k - 1];
            put_cell(file, height > 0 ? height : NAN);
        }
        for (int c = 0; c < SF_CFH_CRITERIA; c++)
            put_cell(file, s->with_response ? error->shared[c] : NAN);
        for (int c = 0; c < SF_CFH_CRITERIA; c++)
            put_cell(file, s->with_response ? error->own_sd[c] : NAN);
        fputc('\n', file);
    }
    return sf_staging_close(file, "cfh_draws.csv", err);
}

/* The corrected columns of each draw over the height, as far as they do not collapse. */
static sf_status write_curves(const sf_staging *output, const sf_cfh_spread *s, sf_error *err) {
    FILE *file = sf_staging_open(output, "cfh_curves.csv", err);
    if (!file)
        return err->status;
    fputs("draw_1,height_m,a_max_g,hic_1\n", file);
    for (int d = 0; d < s->draws; d++)
        for (int k = 0; k < s->reach[d]; k++) {
            const double *value = &s->value[(size_t)d * SF_CFH_CRITERIA * SF_CFH_GRID + (size_t)k];
            fprintf(file, "%d,%.9g,%.9g,%.9g\n", d + 1, s->height[k], exp(value[SF_CFH_A_MAX * SF_CFH_GRID]),
                    exp(value[SF_CFH_HIC * SF_CFH_GRID]));
        }
    return sf_staging_close(file, "cfh_curves.csv", err);
}

sf_status sf_cfh_write_draws(const sf_staging *output, const sf_cfh_report *r, sf_error *err) {
    if (r->spread && write_band(output, r->spread, err) == SF_OK &&
        write_crossings(output, r->spread, err) == SF_OK)
        write_curves(output, r->spread, err);
    return err->status;
}

/* ---- terminal ---- */

static void put_checks(FILE *out, const sf_cfh_report *r) {
    if (!r->spread)
        return;
    for (int k = 0; k < r->spread->checks; k++) {
        const sf_cfh_check *check = &r->spread->check[k];
        if (!check->failed)
            fprintf(
                out,
                "  draw %d at %.3f m: a_max %.1f g by columns, %.1f g simulated; HIC %.0f, %.0f; the height by %s "
                "moves by %.2f %%\n",
                check->draw + 1, check->height, check->columns[SF_CFH_A_MAX], check->simulated[SF_CFH_A_MAX],
                check->columns[SF_CFH_HIC], check->simulated[SF_CFH_HIC], sf_cfh_name(check->first),
                100 * check->shift[check->first]);
    }
}

/* Puts the shares of the sources of uncertainty, where the interval is closed. */
static void put_shares(FILE *out, const sf_cfh_report *r) {
    double share[SF_CFH_PARTS];
    for (int part = 0; part < SF_CFH_PARTS && r->spread; part++)
        share[part] = 100 * sf_cfh_spread_share(r->spread, (sf_cfh_part)part, SF_CFH_FIRST);
    if (!r->spread || isnan(share[SF_CFH_PART_FOAM]))
        return;
    fprintf(out, "  of the interval (its squared length): foam %.0f %%, ", share[SF_CFH_PART_FOAM]);
    if (r->spread->with_response)
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
    put_checks(out, r);
    put_shares(out, r);
    sf_cfh_verdict_text(r, text, sizeof text);
    fprintf(out, "%s\n", text);
    sf_cfh_rig_text(r, text, sizeof text);
    if (text[0])
        fprintf(out, "%s\n", text);
    fprintf(out, "%s\n", sf_cfh_caution);
}
