/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/cfh/spread_report.h"

#include <math.h>

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

/* ---- report.html ---- */

static void put_share(sf_html_table *table, double share) {
    if (isnan(share))
        sf_html_cell(table, "–");
    else
        sf_html_cell(table, "%.0f", 100 * share);
}

/* The line of the interval that a single pad and drop have. */
static const char *single_drop_text(const sf_cfh_spread *s) {
    return isnan(s->scatter[SF_CFH_A_MAX][0])
               ? "of a single pad and drop: not known, as above"
               : "of a single pad and drop, with the scatter of speed and thickness; not in the whole interval";
}

static void put_parts(FILE *page, const sf_cfh_spread *s, const sf_cfh_rig *rig) {
    static const char *const words[SF_CFH_PARTS] = {
        "foam alone (the draws: parameters and curve)", "and the errors of the responses",
        "and the error of the mesh", "and the points about their fit", "and the columns' own error"};
    char text[64];
    sf_html_table table = sf_html_table_begin(
        page, "dense", "95 % interval with|>median (m)|>critical height|>share (%)|>a_max|>HIC");
    for (int part = 0; part < SF_CFH_PARTS; part++) {
        sf_html_row(&table);
        sf_html_cell(&table, "%s%s", words[part],
                     part == SF_CFH_PART_RESPONSE && !s->with_response ? ": not known, not in it" : "");
        sf_html_number(&table, 3, s->part[part][SF_CFH_FIRST].median);
        sf_html_cell(&table, "%s", sf_cfh_interval_text(&s->part[part][SF_CFH_FIRST], text, sizeof text));
        put_share(&table, sf_cfh_spread_share(s, (sf_cfh_part)part, SF_CFH_FIRST));
        for (int c = 0; c < SF_CFH_CRITERIA; c++)
            sf_html_cell(&table, "%s", sf_cfh_interval_text(&s->part[part][c], text, sizeof text));
    }
    const sf_cfh_interval *drop = s->part[SF_CFH_PARTS];
    sf_html_row(&table);
    sf_html_cell(&table, "%s", single_drop_text(s));
    sf_html_number(&table, 3, drop[SF_CFH_FIRST].median);
    sf_html_cell(&table, "%s", sf_cfh_interval_text(&drop[SF_CFH_FIRST], text, sizeof text));
    sf_html_cell(&table, "–");
    for (int c = 0; c < SF_CFH_CRITERIA; c++)
        sf_html_cell(&table, "%s", sf_cfh_interval_text(&drop[c], text, sizeof text));
    if (rig->pairs > 0) {
        sf_html_row(&table);
        sf_html_cell(&table, "without that, and g_eff: on the rig");
        sf_html_number(&table, 3, s->rig.median);
        sf_html_cell(&table, "%s", sf_cfh_interval_text(&s->rig, text, sizeof text));
        for (int k = 0; k < 1 + SF_CFH_CRITERIA; k++)
            sf_html_cell(&table, "–");
    }
    sf_html_table_end(&table);
    sf_html_note(page,
                 "Share: what the line adds to the squared length of the interval of ln(height). Below 0, "
                 "the trend of the simulated draws makes it narrower.");
}

/* Describes the correction of a criterion's height by the checks. */
static const char *trend_text(const sf_cfh_trend *t, char *text, size_t size) {
    if (t->checks == 0)
        snprintf(text, size, "not known");
    else if (t->sum > 0)
        snprintf(
            text, size,
            "%+.2g %% at the lowest and %+.2g %% at the highest of %d simulated draws by their trend, which the "
            "heights follow, ±%.2g %% about it (Student's t, %d degrees of freedom)",
            100 * (t->shift + t->slope * (t->range[0] - t->centre)),
            100 * (t->shift + t->slope * (t->range[1] - t->centre)), t->checks, 100 * t->scatter, t->freedom);
    else
        snprintf(text, size,
                 "±%.2g %%, the root mean square of %d simulated draws (Student's t, %d degrees of freedom)",
                 100 * t->scatter, t->checks, t->freedom);
    return text;
}

/* "0.12 %" */
static const char *percent_text(double value, char text[24]) {
    if (isnan(value))
        snprintf(text, 24, "not known");
    else
        snprintf(text, 24, "%.2g %%", 100 * value);
    return text;
}

static void put_errors(FILE *page, const sf_cfh_spread *s) {
    char columns[SF_CFH_CRITERIA][240], fit[SF_CFH_CRITERIA][24], mesh[24];
    for (int c = 0; c < SF_CFH_CRITERIA; c++) {
        trend_text(&s->trend[c], columns[c], sizeof columns[c]);
        percent_text(s->fit_scatter[c], fit[c]);
    }
    sf_html_note(
        page,
        "%d draws of the foam, each as columns below the missile, corrected by the drops simulated with the "
        "case's own material between %.3f and %.3f m. Error of the mesh (expected of a_max: %s): assumed is that the "
        "draws were identified by drops of the same spacing, whose error of the mesh is in them. How much it differs at this "
        "height is not known: a scatter of %.2g times that of a_max, and %.1f times as much of HIC, to both sides. Points about "
        "their fit: %s of a_max, %s of HIC. Errors of the responses: one of each draw, and one drawn for each of its %d repeats "
        "(response_error). The columns' own error of the height at a_max: %s; at HIC: %s. What is not known "
        "is not in the interval.",
        s->draws, s->simulated[0], s->simulated[1], percent_text(s->mesh_error, mesh), SF_CFH_MESH_SIZE,
        SF_CFH_MESH_HIC, fit[SF_CFH_A_MAX], fit[SF_CFH_HIC], SF_CFH_REPEATS, columns[SF_CFH_A_MAX],
        columns[SF_CFH_HIC]);
}

static void put_checks(FILE *page, const sf_cfh_spread *s) {
    if (s->checks == 0) {
        sf_html_paragraph(
            page, "No draw was simulated: how well the columns stand for the draws is not known, and the "
                  "interval does not hold their error.");
        return;
    }
    sf_html_table table = sf_html_table_begin(
        page, "dense",
        "simulated draw|>draws below (%)|>height (m)|limit|>a_max, columns (g)|>simulated (g)|>its height moves by "
        "(%)|>HIC, columns|>simulated|>its height moves by (%)");
    for (int k = 0; k < s->checks; k++) {
        const sf_cfh_check *check = &s->check[k];
        sf_html_row(&table);
        sf_html_cell(&table, "%d", check->draw + 1);
        sf_html_number(&table, 0, 100 * check->share);
        sf_html_number(&table, 3, check->height);
        sf_html_cell(&table, "%s", sf_cfh_name(check->first));
        for (int c = 0; c < SF_CFH_CRITERIA; c++) {
            sf_html_number(&table, c == SF_CFH_A_MAX, check->columns[c]);
            sf_html_number(&table, c == SF_CFH_A_MAX, check->failed ? NAN : check->simulated[c]);
            sf_html_number(&table, 2, check->failed ? NAN : 100 * check->shift[c]);
        }
    }
    sf_html_table_end(&table);
    for (int k = 0; k < s->checks; k++)
        if (s->check[k].note[0])
            sf_html_paragraph(page, "Draw %d: %s.", s->check[k].draw + 1, s->check[k].note);
}

void sf_cfh_put_spread(FILE *page, const sf_cfh_spread *s, const sf_cfh_rig *rig) {
    char text[SF_CFH_NOTE_SIZE];
    sf_html_heading(page, "Interval of the critical height");
    put_parts(page, s, rig);
    sf_cfh_draws_text(s, text, sizeof text);
    if (text[0])
        sf_html_paragraph(page, "%s", text);
    if (!s->with_response)
        sf_html_paragraph(page, "%s", sf_cfh_response_text(s));
    put_checks(page, s);
    put_errors(page, s);
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

void sf_cfh_put_spread_json(sf_json *json, const sf_cfh_spread *s) {
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

/* ---- tables ---- */

static void put_cell(FILE *file, double value, char after) {
    if (isfinite(value))
        fprintf(file, "%.9g", value);
    fputc(after, file);
}

sf_status sf_cfh_write_band(const sf_staging *output, const sf_cfh_spread *s, sf_error *err) {
    FILE *file = sf_staging_open(output, "cfh_band.csv", err);
    if (!file)
        return err->status;
    fputs(
        "height_m,a_max_low_g,a_max_median_g,a_max_high_g,hic_low_1,hic_median_1,hic_high_1,a_max_correction_1,"
        "hic_correction_1\n",
        file);
    for (int k = 0; k < s->grid; k++) {
        put_cell(file, s->height[k], ',');
        for (int c = 0; c < SF_CFH_CRITERIA; c++) {
            const sf_cfh_band *band = &s->band[c][k];
            put_cell(file, band->low, ',');
            put_cell(file, band->median, ',');
            put_cell(file, band->high, ',');
        }
        put_cell(file, exp(s->correction[SF_CFH_A_MAX][k]), ',');
        put_cell(file, exp(s->correction[SF_CFH_HIC][k]), '\n');
    }
    return sf_staging_close(file, "cfh_band.csv", err);
}

sf_status sf_cfh_write_crossings(const sf_staging *output, const sf_cfh_spread *s, sf_error *err) {
    FILE *file = sf_staging_open(output, "cfh_draws.csv", err);
    if (!file)
        return err->status;
    fputs("draw_1,height_m,a_max_height_m,hic_height_m\n", file);
    for (int d = 0; d < s->draws; d++) {
        const double *crossing = &s->crossing[(size_t)d * (SF_CFH_FIRST + 1)];
        fprintf(file, "%d,", d + 1);
        for (int k = 0; k <= SF_CFH_FIRST; k++) { /* the first of them in front */
            double height = crossing[k == 0 ? SF_CFH_FIRST : k - 1];
            put_cell(file, height > 0 ? height : NAN, k == SF_CFH_FIRST ? '\n' : ',');
        }
    }
    return sf_staging_close(file, "cfh_draws.csv", err);
}
