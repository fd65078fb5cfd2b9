/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/cfh/cfh_report.h"

#include "build_info.h"
#include "study/cfh/series.h"
#include "report/chart.h"
#include "report/html.h"
#include "report/row.h"
#include "post/results/origin.h"
#include "post/view/report.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const char caution[] = "Indicative, not a certification: a computed height from one simulated impact "
                              "site, not the test of ASTM F1292 or EN 1177.";

static const sf_cfh_crossing *deciding(const sf_cfh_report *r) {
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
                 deciding(r)->height, r->spread ? " as simulated" : "", name, limit, unit);
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
static double upper_bound(const sf_cfh_result *v) {
    return isnan(v->lowest) ? v->anvil : v->lowest;
}

/* The same on the rig; "" without a rig or a height. */
static void rig_text(const sf_cfh_report *r, char *text, size_t size) {
    double height = NAN;
    char interval[64], uncertainty[160] = "";
    const char *side = "";
    text[0] = '\0';
    if (r->result->verdict == SF_CFH_FOUND) {
        height = deciding(r)->height;
    } else if (r->result->verdict == SF_CFH_ABOVE) {
        height = r->result->highest;
        side = "above ";
    } else if (r->result->verdict == SF_CFH_BELOW) {
        height = upper_bound(r->result);
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
static double residual(const sf_cfh_report *r, sf_cfh_criterion c, const sf_cfh_point *p) {
    return is_fitted(r, c, p) ? log(p->value[c] / sf_cfh_fit_at(&r->result->crossing[c].fit, p->height))
                              : NAN;
}

/* ---- cfh.json ---- */

static const char *side_word(const sf_cfh_crossing *crossing) {
    static const char *const words[] = {"crossed", "not reached", "exceeded at the lowest height"};
    return crossing->side == SF_CFH_CROSSED && isnan(crossing->height) ? "not determined"
                                                                       : words[crossing->side];
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
    put_heights(json, r, found ? deciding(r)->height : NAN, SF_CFH_FIRST);
    sf_json_number(json, "speed_m_s", found ? sf_cfh_speed(deciding(r)->height) : NAN);
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
        sf_json_text(json, "state", side_word(crossing));
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
        sf_json_number(json, "a_max_residual", residual(r, SF_CFH_A_MAX, p));
        sf_json_number(json, "hic_residual", residual(r, SF_CFH_HIC, p));
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
        sf_cfh_put_spread_json(json, r->spread);
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
    sf_json_text(&json, "caution", caution);
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

sf_status sf_cfh_write_draws(const sf_staging *output, const sf_cfh_report *r, sf_error *err) {
    if (r->spread && sf_cfh_write_band(output, r->spread, err) == SF_OK)
        sf_cfh_write_crossings(output, r->spread, err);
    return err->status;
}

/* ---- report.html ---- */

static const char *banner_kind(const sf_cfh_report *r) {
    char text[SF_CFH_NOTE_SIZE] = "";
    if (r->result->verdict == SF_CFH_UNKNOWN)
        return "bad";
    if (r->spread)
        sf_cfh_draws_text(r->spread, text, sizeof text);
    if (text[0] || r->no_interval[0] || (r->spread && !r->spread->with_response))
        return "fair";
    for (int k = 0; k < r->points->count; k++)
        if (r->points->point[k].note[0])
            return "fair";
    return "good";
}

/* "1.661 m", or a bound. */
static void height_text(const sf_cfh_report *r, double scale, char *text, size_t size) {
    const sf_cfh_result *v = r->result;
    switch (v->verdict) {
    case SF_CFH_FOUND:
        snprintf(text, size, "%.3f m", scale * deciding(r)->height);
        break;
    case SF_CFH_ABOVE:
        if (isnan(v->anvil))
            snprintf(text, size, "> %.3f m", scale * v->highest);
        else
            snprintf(text, size, "%.3f to %.3f m", scale * v->highest, scale * v->anvil);
        break;
    case SF_CFH_BELOW:
        snprintf(text, size, "< %.3f m", scale * upper_bound(v));
        break;
    case SF_CFH_UNKNOWN:
        snprintf(text, size, "–");
        break;
    }
}

static void put_limit_tile(FILE *page, const sf_cfh_report *r, sf_cfh_criterion c) {
    char title[48], value[48];
    const sf_cfh_crossing *crossing = &r->result->crossing[c];
    snprintf(title, sizeof title, "%s %g%s", sf_cfh_name(c), r->plan->limit[c], sf_cfh_unit(c));
    if (isfinite(crossing->height))
        snprintf(value, sizeof value, "at %.3f m", crossing->height);
    else
        snprintf(value, sizeof value, "–");
    sf_html_tile(page, "plain", title, value, side_word(crossing));
}

/* The interval below a height; "" if there is neither. */
static void tile_remark(const sf_cfh_report *r, const sf_cfh_interval *interval, char *text, size_t size) {
    char words[64];
    text[0] = '\0';
    if (r->spread)
        snprintf(text, size, "95 %% interval %s", sf_cfh_interval_text(interval, words, sizeof words));
    else if (r->result->verdict == SF_CFH_FOUND)
        snprintf(text, size, "uncertainty of the foam not included");
}

static void put_tiles(FILE *page, const sf_cfh_report *r) {
    char value[48], remark[160];
    sf_html_tiles_begin(page);
    height_text(r, 1, value, sizeof value);
    tile_remark(r, r->spread ? sf_cfh_spread_whole(r->spread, SF_CFH_FIRST) : NULL, remark, sizeof remark);
    sf_html_tile(page, banner_kind(r), "critical fall height, free fall", value, remark);
    if (r->rig->pairs > 0) {
        height_text(r, sf_cfh_rig_height(r->rig, 1), value, sizeof value);
        tile_remark(r, r->spread ? &r->spread->rig : NULL, remark, sizeof remark);
        size_t used = strlen(remark);
        snprintf(remark + used, sizeof remark - used, "%sg_eff = %.3f ± %.3f m/s²", used ? "; " : "",
                 r->rig->gravity, r->rig->standard_error);
        sf_html_tile(page, banner_kind(r), "on the rig", value, remark);
    }
    for (sf_cfh_criterion c = SF_CFH_A_MAX; c < SF_CFH_CRITERIA; c++)
        put_limit_tile(page, r, c);
    sf_html_tiles_end(page);
}

static void put_criteria_table(FILE *page, const sf_cfh_report *r) {
    bool rig = r->rig->pairs > 0;
    sf_html_table table = sf_html_table_begin(page, "dense",
                                              rig ? "limit|state|>height (m)|>95 % interval|>on the rig (m)"
                                                  : "limit|state|>height (m)|>95 % interval");
    for (sf_cfh_criterion c = SF_CFH_A_MAX; c < SF_CFH_CRITERIA; c++) {
        const sf_cfh_crossing *crossing = &r->result->crossing[c];
        char text[64] = "not known";
        sf_html_row(&table);
        sf_html_cell(&table, "%s %g%s", sf_cfh_name(c), r->plan->limit[c], sf_cfh_unit(c));
        sf_html_cell(&table, "%s", side_word(crossing));
        sf_html_number(&table, 3, crossing->height);
        if (r->spread)
            sf_cfh_interval_text(sf_cfh_spread_whole(r->spread, (int)c), text, sizeof text);
        sf_html_cell(&table, "%s", text);
        if (rig)
            sf_html_number(&table, 3, sf_cfh_rig_height(r->rig, crossing->height));
    }
    sf_html_table_end(&table);
}

/* The residuals say how well the quadratics fit, not how well the heights are known. */
static void put_fit_table(FILE *page, const sf_cfh_report *r) {
    bool rig = r->rig->pairs > 0;
    sf_html_heading(page, "Fit of the simulated points");
    sf_html_table table = sf_html_table_begin(
        page, "dense",
        rig ? "limit|>points|>rms residual (%)|>interval of the fit (m)|>on the rig, with g_eff (m)"
            : "limit|>points|>rms residual (%)|>interval of the fit (m)");
    for (sf_cfh_criterion c = SF_CFH_A_MAX; c < SF_CFH_CRITERIA; c++) {
        const sf_cfh_crossing *crossing = &r->result->crossing[c];
        double margin = sf_cfh_rig_margin(r->rig, crossing->margin);
        double height = sf_cfh_rig_height(r->rig, crossing->height);
        sf_html_row(&table);
        sf_html_cell(&table, "%s %g%s", sf_cfh_name(c), r->plan->limit[c], sf_cfh_unit(c));
        sf_html_cell(&table, "%d", crossing->fit.count);
        sf_html_number(&table, 2, crossing->fit.count ? 100 * crossing->fit.rms : NAN);
        if (isfinite(crossing->low))
            sf_html_cell(&table, "%.3f to %.3f%s", crossing->low, crossing->high,
                         crossing->bracketed ? ", the drops on both sides" : "");
        else
            sf_html_cell(&table, "–");
        if (rig && isfinite(margin))
            sf_html_cell(&table, "%.3f to %.3f", height * exp(-margin), height * exp(margin));
        else if (rig)
            sf_html_cell(&table, "–");
    }
    sf_html_table_end(&table);
    sf_html_note(
        page,
        "Where a quadratic misses the points by 3 %% or more, as of a foam that locks up, the interval is that of "
        "the drops on both sides of the limit. "
        "The interval of the fit (95 %%, Student's t) says how well a quadratic describes the simulated "
        "points, and on the rig how well g_eff is known. It is no uncertainty of the height: foam, mesh "
        "and model are not in it.");
}

static void put_point_table(FILE *page, const sf_cfh_report *r) {
    bool rig = r->rig->pairs > 0;
    sf_html_table table = sf_html_table_begin(
        page, "dense",
        rig ? ">height (m)|>speed (m/s)|>a_max (g)|>residual (%)|>HIC|>residual (%)|>rebound (m/s)|>largest local "
              "strain|>on the rig (m)|verdict"
            : ">height (m)|>speed (m/s)|>a_max (g)|>residual (%)|>HIC|>residual (%)|>rebound (m/s)|>largest local "
              "strain|verdict");
    for (int k = 0; k < r->points->count; k++) {
        const sf_cfh_point *p = &r->points->point[k];
        sf_html_row(&table);
        sf_html_number(&table, 3, p->height);
        sf_html_number(&table, 3, p->speed);
        sf_html_number(&table, 1, p->failed ? NAN : p->value[SF_CFH_A_MAX]);
        sf_html_number(&table, 2, 100 * residual(r, SF_CFH_A_MAX, p));
        sf_html_number(&table, 0, p->failed ? NAN : p->value[SF_CFH_HIC]);
        sf_html_number(&table, 2, 100 * residual(r, SF_CFH_HIC, p));
        sf_html_number(&table, 2, p->failed ? NAN : p->v_rebound);
        sf_html_number(&table, 3, p->failed ? NAN : p->max_local_strain);
        if (rig)
            sf_html_number(&table, 3, sf_cfh_rig_height(r->rig, p->height));
        sf_html_cell(&table, "%s", p->failed ? "failed" : sf_verdict_phrase(p->grade));
    }
    sf_html_table_end(&table);
}

static void put_notes(FILE *page, const sf_cfh_report *r) {
    bool any = false;
    for (int k = 0; k < r->points->count; k++) {
        const sf_cfh_point *p = &r->points->point[k];
        if (!p->note[0])
            continue;
        if (!any)
            sf_html_heading(page, "Warnings");
        sf_html_paragraph(page, "%.3f m: %s.", p->height, p->note);
        any = true;
    }
}

static void put_bodies(FILE *page, const sf_cfh_report *r) {
    sf_html_heading(page, "What falls on what");
    sf_html_table table = sf_html_table_begin(page, "dense", NULL);
    sf_html_fact(&table, "case", "%s", r->case_path);
    sf_html_fact(&table, "material", "%s", r->material ? r->material : "of the case");
    sf_html_fact(&table, "missile", "%g kg", r->mass);
    sf_origin_put_key(&table, r->parameters, "geometry.missile_file", "its shape");
    sf_origin_put_key(&table, r->parameters, "geometry.missile_parameters", "its parameters");
    sf_origin_put_key(&table, r->parameters, "geometry.file", "pad");
    sf_origin_put_key(&table, r->parameters, "geometry.parameters", "its parameters");
    if (r->posterior)
        sf_html_fact(&table, "draws of the foam", "%s", r->posterior);
    if (r->rig_path)
        sf_html_fact(&table, "rig", "%s, %d pairs", r->rig_path, r->rig->pairs);
    sf_html_table_end(&table);
}

static void put_picture(FILE *page, const sf_staging *output, const sf_cfh_report *r) {
    char warning[320];
    char *svg = sf_chart_svg(output, "cfh", "softfall-cfh", warning, sizeof warning);
    if (svg)
        sf_html_figure(
            page, svg, "a_max and HIC over the drop height%s.",
            r->spread ? "; bands: 95 % of the draws of the foam, and the intervals of the crossings" : "");
    else
        sf_html_figure(page, NULL, "%s.", warning);
    free(svg);
}

/* Writes the end of the data of each foam. */
static void describe_foams(const sf_cfh_foams *foams, char *text, size_t size) {
    size_t used = 0;
    for (int k = 0; k < foams->count && used < size; k++) {
        const sf_cfh_foam *foam = &foams->foam[k];
        used += (size_t)snprintf(text + used, size - used, "%s%s%s%s %.3f", k ? "; " : "",
                                 foams->count > 1 ? foam->name : "", foams->count > 1 ? ": " : "",
                                 foam->words, foam->end);
    }
}

static void put_drops(FILE *page, const sf_cfh_report *r) {
    char foams[SF_CASE_MAX_LAYERS * (SF_MATERIAL_NAME_SIZE + 64)];
    describe_foams(r->foams, foams, sizeof foams);
    sf_html_heading(page, "Crossings of the limits");
    put_criteria_table(page, r);
    if (r->spread)
        sf_cfh_put_spread(page, r->spread, r->rig);
    sf_html_heading(page, "Simulated drops");
    put_point_table(page, r);
    sf_html_note(
        page,
        "Heights are those of free fall, v² = 2 g h, unless they say otherwise. Residuals: simulated value "
        "against the fit, ln(value) quadratic in ln(height); a dash: not in the fit, or no value. The "
        "curve of a foam is extrapolated beyond the strain to which its data reach: %s. The search "
        "ended because %s.",
        foams, sf_cfh_step_text(r->ending));
    put_notes(page, r);
    put_fit_table(page, r);
}

sf_status sf_cfh_write_page(const sf_staging *output, const sf_cfh_report *r, sf_error *err) {
    char verdict[SF_CFH_VERDICT_SIZE], rig[400], *title = sf_origin_title(r->case_text);
    FILE *page = sf_html_begin(output, "Critical fall height", title && *title ? title : NULL, err);
    free(title);
    if (!page)
        return err->status;
    sf_cfh_verdict_text(r, verdict, sizeof verdict);
    rig_text(r, rig, sizeof rig);
    sf_html_banner(page, banner_kind(r),
                   r->result->verdict == SF_CFH_UNKNOWN ? "not determined" : "indicative", "%s%s%s %s",
                   verdict, rig[0] ? " " : "", rig, caution);
    put_tiles(page, r);
    sf_html_columns_begin(page, "wide");
    put_picture(page, output, r);
    sf_html_block_begin(page);
    put_bodies(page, r);
    sf_html_block_end(page);
    sf_html_columns_end(page);
    put_drops(page, r);
    sf_origin_put_material(page, r->case_text, r->parameters);
    sf_html_heading(page, "The command that repeats this report");
    sf_html_pre(page, r->command_line);
    return sf_html_end(page, "softfall-cfh " SF_VERSION " (" SF_GIT_REVISION ")", err);
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
            fprintf(out, "%s\n", side_word(crossing));
    }
    put_checks(out, r);
    put_shares(out, r);
    sf_cfh_verdict_text(r, text, sizeof text);
    fprintf(out, "%s\n", text);
    rig_text(r, text, sizeof text);
    if (text[0])
        fprintf(out, "%s\n", text);
    fprintf(out, "%s\n", caution);
}
