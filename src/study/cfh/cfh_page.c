/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The picture and the page of a critical fall height. */
#include "study/cfh/cfh_report.h"

#include "base/text.h"
#include "build_info.h"
#include "post/results/origin.h"
#include "report/html.h"
#include "report/chart.h"

/* ---- the material ---- */

/* Without the brackets and quotes of the case's syntax. */
static void tidy(char *value) {
    char *to = value, *end;
    for (const char *from = value; *from; from++)
        if (!strchr("{}[]\"", *from) && (to > value || *from != ' '))
            *to++ = *from;
    for (end = to; end > value && strchr(" ;", end[-1]); end--)
        ;
    *end = '\0';
}

/* Rows with the values of keys, each given as key and title, until a key is NULL. */
static void put_keys(sf_html_table *table, const char *parameters, const sf_named_text *list) {
    for (sf_origin_key key; (*list)[0]; list++) {
        if (!sf_origin_find(parameters, (*list)[0], &key) || strcmp(key.value, "(absent)") == 0)
            continue;
        tidy(key.value);
        if (*key.value)
            sf_html_fact(table, (*list)[1], "%s", key.value);
    }
}
#define SF_ORIGIN_PUT(table, parameters, ...)                                                                \
    put_keys(table, parameters, (const sf_named_text[]){__VA_ARGS__, {0}})

/* The keys of the material that the case gives, and whether it says what its data inform. `group`: with its
 * point at the end. */
static void put_given(FILE *page, const char *parameters, const char *group) {
    sf_origin_key key;
    SF_HTML_TABLE table = sf_html_table_begin(page, NULL);
    SF_PRINTED(informed, SF_ORIGIN_NAME_SIZE + 32, "%sinformed_strain", group);
    if (sf_origin_find(parameters, informed, &key) && !key.given)
        sf_html_fact(&table, "informed_strain", "not given: the end of the curve is taken for it");
    while (sf_origin_next(&parameters, &key))
        if (key.given && strncmp(key.name, group, strlen(group)) == 0)
            sf_html_fact(&table, key.name + strlen(group), "%s", key.value);
}

/* `layer` NULL: of a pad of one material. */
static void put_material(FILE *page, const char *case_text, const char *parameters, const char *layer) {
    SF_OWNED char *origin = sf_origin_material(case_text, layer);
    SF_PRINTED(heading, SF_ORIGIN_NAME_SIZE + 32, "Material%s%s", layer ? " of the layer " : "",
               layer ? layer : "");
    SF_PRINTED(group, SF_ORIGIN_NAME_SIZE + 16, "material%s%s.", layer ? "s." : "", layer ? layer : "");
    SF_HTML_BLOCK(page, heading);
    SF_HTML_DIVISION(page, "columns narrow");
    put_given(page, parameters, group);
    SF_HTML_DIVISION(page, "block");
    sf_html_note(
        page, "Origin, and the range that its data inform, as its file says. Keys not listed have defaults.");
    sf_html_prose(page,
                  origin && *origin ? origin : "The case says nothing about the origin of the material.");
}

static void put_materials(FILE *page, const char *case_text, const char *parameters) {
    static const char group[] = "materials.";
    char last[SF_ORIGIN_NAME_SIZE] = "";
    const char *rest = parameters;
    sf_origin_key key;
    while (sf_origin_next(&rest, &key)) {
        if (strncmp(key.name, group, strlen(group)) != 0)
            continue;
        char *name = key.name + strlen(group);
        name[strcspn(name, ".")] = '\0';
        if (strcmp(name, last) == 0)
            continue;
        snprintf(last, sizeof last, "%.*s", (int)sizeof last - 1, name);
        put_material(page, case_text, parameters, name);
    }
    if (!*last)
        put_material(page, case_text, parameters, NULL);
}

/* ---- the picture ---- */

/* Heights (m) of the picture: the successes, the failures not far above them, and a margin. */
static void height_range(const sf_cfh_report *r, double range[2]) {
    const sf_cfh_points *points = r->points;
    double low = points->point[0].height, high = points->point[points->count - 1].height;
    if (r->result->highest > 0)
        high = fmin(high, 1.3 * r->result->highest);
    double margin = fmax(0.06 * (high - low), 0.02 * high);
    range[0] = fmax(low - margin, 0);
    range[1] = high + margin;
}

/* Returns the end of the axis, a bit above the limit and the largest value. */
static double value_top(const sf_cfh_report *r, sf_cfh_criterion c) {
    double top = r->plan->limit[c];
    for (int k = 0; k < r->points->count; k++)
        if (!r->points->point[k].failed)
            top = fmax(top, r->points->point[k].value[c]);
    return 1.12 * top;
}

/* Both panels stand above each other; the x axis is below the lower one, the rig's above the upper one. */
static void put_axes(sf_panel *panel, const sf_cfh_report *r, sf_cfh_criterion c) {
    bool upper = c == SF_CFH_A_MAX, rig = r->rig->pairs > 0;
    double range[2], top = rig ? 0.855 : 0.93, middle = 0.5 * (0.155 + top);
    height_range(r, range);
    const double area[4] = {0.11, 0.97, upper ? middle + 0.025 : 0.155, upper ? top : middle - 0.025};
    memcpy(panel->area, area, sizeof area);
    sf_axis_label(&panel->x, "drop height, free fall (m)");
    sf_axis_range(&panel->x, range[0], range[1]);
    panel->x.hidden = upper;
    sf_axis_label(&panel->y, "%s", upper ? "a_max (g)" : "HIC");
    sf_axis_range(&panel->y, 0, value_top(r, c));
    if (upper && rig) {
        sf_axis_label(&panel->x2, "drop height on the rig (m)");
        sf_axis_range(&panel->x2, sf_cfh_rig_height(r->rig, range[0]), sf_cfh_rig_height(r->rig, range[1]));
    }
    panel->key = upper ? SF_KEY_NONE : SF_KEY_BELOW; /* one key, below both */
    panel->key_columns = 5;
}

/* 95 % of the draws at each height. */
static void put_band(sf_chart *chart, const sf_cfh_report *r, sf_cfh_criterion c) {
    if (!r->spread)
        return;
    sf_series_data *range = sf_chart_series(
        chart, (sf_series_style){.kind = SF_SERIES_RANGE, .colour = "#6baed6", .opacity = 0.4},
        "95 %% of the draws");
    for (int k = 0; k < r->spread->grid; k++) {
        const sf_cfh_interval *band = &r->spread->band[c][k];
        if (isfinite(band->low) && isfinite(band->high))
            sf_series_add(range, r->spread->height[k], band->median, band->low, band->high);
    }
}

/* The interval of the crossing as a band, where the draws give one, and the crossing as a line with its
 * height. */
static void put_crossing(sf_chart *chart, const sf_cfh_report *r, sf_cfh_criterion c) {
    const sf_cfh_crossing *crossing = &r->result->crossing[c];
    bool decides = r->result->verdict == SF_CFH_FOUND && r->result->deciding == c;
    const char *colour = decides ? "#cb181d" : "#606060";
    double limit = r->plan->limit[c], range[2];
    height_range(r, range);
    sf_chart_level(chart, limit, "#cb181d", "limit %g%s", limit, sf_cfh_unit(c));
    if (r->spread) {
        const sf_cfh_interval *interval = sf_cfh_spread_whole(r->spread, (int)c);
        const double x[2] = {fmax(interval->low, range[0]), fmin(interval->high, range[1])};
        if (x[0] < x[1])
            sf_chart_band(chart, x, (const double[2]){-INFINITY, limit}, colour, 0.25);
    }
    if (!isnan(crossing->height))
        sf_chart_drop(chart, crossing->height, limit, colour, "%.3f m%s", crossing->height,
                      decides ? ", decides" : "");
}

/* The fit between the lowest and the highest of its points. */
static void put_fit(sf_chart *chart, const sf_cfh_report *r, sf_cfh_criterion c) {
    enum { STEPS = 200 };
    const sf_cfh_fit *fit = &r->result->crossing[c].fit;
    if (fit->count == 0)
        return;
    sf_series_data *line = sf_chart_series(
        chart, (sf_series_style){.kind = SF_SERIES_LINE, .colour = "#08519c", .width = 3.5}, "fit");
    for (int k = 0; k <= STEPS; k++) {
        double height = fit->low + (fit->high - fit->low) * k / STEPS;
        sf_series_point(line, height, sf_cfh_fit_at(fit, height));
    }
}

static void put_points(sf_chart *chart, const sf_cfh_report *r, sf_cfh_criterion c) {
    sf_series_data *simulated = sf_chart_series(
        chart, (sf_series_style){.kind = SF_SERIES_POINTS, .colour = "#08519c", .size = 1.8}, "simulated");
    sf_series_data *failed = sf_chart_series(
        chart,
        (sf_series_style){
            .kind = SF_SERIES_POINTS, .colour = "#606060", .shape = SF_POINT_CROSS, .size = 2.2, .width = 3},
        "failed");
    for (int k = 0; k < r->points->count; k++) {
        const sf_cfh_point *p = &r->points->point[k];
        sf_series_point(p->failed ? failed : simulated, p->height, p->failed ? 0 : p->value[c]);
    }
}

/* The verdict in a few words. */
static void put_title(sf_chart *chart, const sf_cfh_report *r) {
    char words[96] = "not determined", rig[48] = "", interval[64], spread[96] = "";
    double height;
    const char *side = sf_cfh_bound(r, &height);
    if (side)
        snprintf(words, sizeof words, "%s%.3f m of free fall", side, height);
    if (side && !*side && r->rig->pairs > 0)
        snprintf(rig, sizeof rig, ", %.3f m on the rig", sf_cfh_rig_height(r->rig, height));
    if (r->spread)
        snprintf(
            spread, sizeof spread, "; 95 %% interval %s",
            sf_cfh_interval_text(sf_cfh_spread_whole(r->spread, SF_CFH_FIRST), interval, sizeof interval));
    sf_chart_title(chart, "Critical fall height %s%s%s (indicative%s%s)", words, rig, spread,
                   *r->counted ? ", by " : "", r->counted);
}

sf_status sf_cfh_plot(const sf_staging *output, const sf_cfh_report *r, char *warning, size_t size,
                      sf_error *err) {
    sf_chart *chart = sf_chart_new("cfh", 1600, 1300, err);
    put_title(chart, r);
    for (sf_cfh_criterion c = SF_CFH_A_MAX; c < SF_CFH_CRITERIA; c++) {
        put_axes(sf_chart_panel(chart), r, c);
        put_band(chart, r, c);
        put_crossing(chart, r, c);
        put_fit(chart, r, c);
        put_points(chart, r, c);
    }
    return sf_chart_write(chart, output, warning, size, err);
}

/* ---- the section about the interval ---- */

/* A line of the table: `i` of the first criterion that is met, and, unless NULL, of each. */
static void put_part(sf_html_table *table, const sf_cfh_interval *i, const sf_cfh_interval *each,
                     double share, const char *words, const char *more) {
    char text[64];
    SF_HTML_ROW(table, "%s%s", words, more);
    sf_html_line(table, NULL, "%.3f|%s|%.0f", i->median, sf_cfh_interval_text(i, text, sizeof text),
                 100 * share);
    for (int c = 0; c < SF_CFH_CRITERIA; c++)
        sf_html_cell(table, "%s", each ? sf_cfh_interval_text(&each[c], text, sizeof text) : "–");
}

static void put_parts(FILE *page, const sf_cfh_spread *s, const sf_cfh_rig *rig) {
    static const char *const words[SF_CFH_PARTS] = {
        "foam alone (the draws: parameters and curve)", "and the errors of the responses",
        "and the error of the mesh", "and the points about their fit", "and the columns' own error"};
    sf_html_table table =
        sf_html_table_begin(page, "95 % interval with|>median (m)|>critical height|>share (%)|>a_max|>HIC");
    for (int part = 0; part < SF_CFH_PARTS; part++)
        put_part(&table, &s->part[part][SF_CFH_FIRST], s->part[part],
                 sf_cfh_spread_share(s, (sf_cfh_part)part), words[part],
                 part == SF_CFH_PART_RESPONSE && !s->with_response ? ": not known, not in it" : "");
    const sf_cfh_interval *drop = s->part[SF_CFH_PARTS];
    put_part(
        &table, &drop[SF_CFH_FIRST], drop, NAN,
        isnan(s->scatter[SF_CFH_A_MAX][0])
            ? "of a single pad and drop: not known, as above"
            : "of a single pad and drop, with the scatter of speed and thickness; not in the whole interval",
        "");
    if (rig->pairs > 0)
        put_part(&table, &s->rig, NULL, NAN, "without that, and g_eff: on the rig", "");
    sf_html_table_end(&table);
    sf_html_note(page, "Share: what the line adds to the squared length of the interval of ln(height).");
}

/* "0.12 %" */
static const char *percent_text(double value, char text[24]) {
    snprintf(text, 24, isnan(value) ? "not known" : "%.2g %%", 100 * value);
    return text;
}

static void put_errors(FILE *page, const sf_cfh_spread *s) {
    char columns[SF_CFH_CRITERIA][24], fit[SF_CFH_CRITERIA][24], mesh[24];
    for (int c = 0; c < SF_CFH_CRITERIA; c++) {
        percent_text(sf_cfh_columns_error(s, c), columns[c]);
        percent_text(s->fit_scatter[c], fit[c]);
    }
    sf_html_note(
        page,
        "%d draws of the foam, each as columns below the missile, corrected by the drops simulated with the "
        "case's own material between %.3f and %.3f m, and by the simulated draws. Error of the mesh (expected of a_max: %s): "
        "assumed is that the draws were identified by drops of the same spacing, whose error of the mesh is in them. How much it "
        "differs at this height is not known: a scatter of %.2g times that of a_max, and %.1f times as much of HIC, to both sides. "
        "Points about their fit: %s of a_max, %s of HIC. Errors of the responses: one of each draw, and one drawn for each of its %d "
        "repeats (response_error). The columns' own error, by how far a draw is from the simulated drops: %s of a_max, %s of HIC "
        "(root mean square of the draws; Student's t, %d degrees of freedom). What is not known is not in the interval.",
        s->draws, s->simulated[0], s->simulated[1], percent_text(s->mesh_error, mesh), SF_CFH_MESH_SIZE,
        SF_CFH_MESH_HIC, fit[SF_CFH_A_MAX], fit[SF_CFH_HIC], SF_CFH_REPEATS, columns[SF_CFH_A_MAX],
        columns[SF_CFH_HIC], s->freedom);
}

static void put_checks(FILE *page, const sf_cfh_spread *s) {
    if (s->checks == 0) {
        sf_html_paragraph(
            page, "No draw was simulated: how well the columns stand for the draws is not known, and the "
                  "interval does not hold their error.");
        return;
    }
    sf_rows_html_table(page, sf_cfh_check_rows(), (sf_records){s->check, sizeof s->check[0], s->checks});
    for (int k = 0; k < s->checks; k++)
        if (s->check[k].note[0])
            sf_html_paragraph(page, "Draw %d: %s.", s->check[k].draw + 1, s->check[k].note);
}

/* The section of report.html about the interval. */
static void put_spread(FILE *page, const sf_cfh_spread *s, const sf_cfh_rig *rig) {
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

/* ---- the page ---- */

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
    static const char *const signs[] = {[SF_CFH_FOUND] = "", [SF_CFH_ABOVE] = "> ", [SF_CFH_BELOW] = "< "};
    const sf_cfh_result *v = r->result;
    double height;
    if (!sf_cfh_bound(r, &height))
        snprintf(text, size, "–");
    else if (v->verdict == SF_CFH_ABOVE && v->exceeding)
        snprintf(text, size, "%.3f to %.3f m", scale * height, scale * v->exceeding->height);
    else
        snprintf(text, size, "%s%.3f m", signs[v->verdict], scale * height);
}

static void put_limit_tile(FILE *page, const sf_cfh_report *r, sf_cfh_criterion c) {
    const sf_cfh_crossing *crossing = &r->result->crossing[c];
    SF_PRINTED(title, 48, "%s %g%s", sf_cfh_name(c), r->plan->limit[c], sf_cfh_unit(c));
    SF_PRINTED(value, 48, isfinite(crossing->height) ? "at %.3f m" : "–", crossing->height);
    sf_html_tile(page, "plain", title, value, sf_cfh_side_word(crossing));
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
    SF_HTML_DIVISION(page, "tiles");
    height_text(r, 1, value, sizeof value);
    tile_remark(r, r->spread ? sf_cfh_spread_whole(r->spread, SF_CFH_FIRST) : NULL, remark, sizeof remark);
    sf_html_tile(page, banner_kind(r), "critical fall height, free fall", value, remark);
    if (r->rig->pairs > 0) {
        height_text(r, sf_cfh_rig_height(r->rig, 1), value, sizeof value);
        tile_remark(r, r->spread ? &r->spread->rig : NULL, remark, sizeof remark);
        sf_text_add(remark, sizeof remark, "%sg_eff = %.3f ± %.3f m/s²", *remark ? "; " : "", r->rig->gravity,
                    r->rig->standard_error);
        sf_html_tile(page, banner_kind(r), "on the rig", value, remark);
    }
    for (sf_cfh_criterion c = SF_CFH_A_MAX; c < SF_CFH_CRITERIA; c++)
        put_limit_tile(page, r, c);
}

static void put_criteria_table(FILE *page, const sf_cfh_report *r) {
    bool rig = r->rig->pairs > 0;
    SF_HTML_TABLE table =
        sf_html_table_begin(page, rig ? "limit|state|>height (m)|>95 % interval|>on the rig (m)"
                                      : "limit|state|>height (m)|>95 % interval");
    for (sf_cfh_criterion c = SF_CFH_A_MAX; c < SF_CFH_CRITERIA; c++) {
        const sf_cfh_crossing *crossing = &r->result->crossing[c];
        char text[64] = "not known";
        SF_HTML_ROW(&table, "%s %g%s", sf_cfh_name(c), r->plan->limit[c], sf_cfh_unit(c));
        if (r->spread)
            sf_cfh_interval_text(sf_cfh_spread_whole(r->spread, (int)c), text, sizeof text);
        sf_html_line(&table, NULL, "%s|%.3f|%s", sf_cfh_side_word(crossing), crossing->height, text);
        if (rig)
            sf_html_number(&table, 3, sf_cfh_rig_height(r->rig, crossing->height));
    }
}

/* The residuals say how well the quadratics fit, not how well the heights are known. */
static void put_fit_table(FILE *page, const sf_cfh_report *r) {
    bool rig = r->rig->pairs > 0;
    sf_html_heading(page, "Fit of the simulated points");
    sf_html_table table = sf_html_table_begin(
        page, rig ? "limit|>points|>rms residual (%)|>interval of the fit (m)|>on the rig, with g_eff (m)"
                  : "limit|>points|>rms residual (%)|>interval of the fit (m)");
    for (sf_cfh_criterion c = SF_CFH_A_MAX; c < SF_CFH_CRITERIA; c++) {
        const sf_cfh_crossing *crossing = &r->result->crossing[c];
        double margin = sf_cfh_rig_margin(r->rig, crossing->margin);
        double height = sf_cfh_rig_height(r->rig, crossing->height);
        SF_HTML_ROW(&table, "%s %g%s", sf_cfh_name(c), r->plan->limit[c], sf_cfh_unit(c));
        sf_html_line(&table, NULL, "%d|%.2f|%.3f to %.3f%s", crossing->fit.count,
                     crossing->fit.count ? 100 * crossing->fit.rms : NAN, crossing->low, crossing->high,
                     crossing->bracketed ? ", the drops on both sides" : "");
        if (rig)
            sf_html_line(&table, NULL, "%.3f to %.3f", height * exp(-margin), height * exp(margin));
    }
    sf_html_table_end(&table);
    sf_html_note(page,
                 "Where a quadratic misses the points by 3 %% or more, as of a foam that locks up, the "
                 "interval is that of the drops on both sides of the limit. The interval of the fit (95 %%, "
                 "Student's t) says how well a quadratic describes the simulated points, and on the rig how "
                 "well g_eff is known. It is no uncertainty of the height: foam, mesh and model are not in "
                 "it.");
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
    SF_HTML_BLOCK(page, "What falls on what");
    SF_HTML_TABLE table = sf_html_table_begin(page, NULL);
    sf_html_fact(&table, "case", "%s", r->case_path);
    sf_html_fact(&table, "material", "%s", r->material ? r->material : "of the case");
    sf_html_fact(&table, "missile", "%g kg", r->mass);
    if (*r->counted)
        sf_html_fact(&table, "series on one pad", "each height is judged by %s", r->counted);
    SF_ORIGIN_PUT(&table, r->parameters, {"geometry.missile_file", "its shape"},
                  {"geometry.missile_parameters", "its parameters"}, {"geometry.file", "pad"},
                  {"geometry.parameters", "its parameters"});
    if (r->posterior)
        sf_html_fact(&table, "draws of the foam", "%s", r->posterior);
    if (r->rig_path)
        sf_html_fact(&table, "rig", "%s, %d pairs", r->rig_path, r->rig->pairs);
}

/* Writes the end of the data of each foam. */
static void describe_foams(const sf_cfh_foams *foams, char *text, size_t size) {
    text[0] = '\0';
    for (int k = 0; k < foams->count; k++) {
        const sf_cfh_foam *foam = &foams->foam[k];
        bool many = foams->count > 1;
        sf_text_add(text, size, "%s%s%s%s %.3f", k ? "; " : "", many ? foam->name : "", many ? ": " : "",
                    foam->words, foam->end);
    }
}

static void put_drops(FILE *page, const sf_cfh_report *r) {
    char foams[SF_CASE_MAX_LAYERS * (SF_MATERIAL_NAME_SIZE + 64)];
    sf_cfh_point_row points[SF_CFH_MAX_POINTS];
    describe_foams(r->foams, foams, sizeof foams);
    sf_html_heading(page, "Crossings of the limits");
    put_criteria_table(page, r);
    if (r->spread)
        put_spread(page, r->spread, r->rig);
    sf_html_heading(page, "Simulated drops");
    sf_rows_html_table(page, sf_cfh_point_rows(r), sf_cfh_point_records(r, points));
    sf_html_note(page,
                 "Heights are those of free fall, v² = 2 g h, unless they say otherwise. Residuals: "
                 "simulated value against the fit, ln(value) quadratic in ln(height); a dash: not in the "
                 "fit, or no value. The curve of a foam is extrapolated beyond the strain to which its data "
                 "reach: %s. The search ended because %s.",
                 foams, sf_cfh_step_text(r->ending));
    put_notes(page, r);
    put_fit_table(page, r);
}

/* The picture, and what falls beside it. */
static void put_top(FILE *page, const sf_staging *output, const sf_cfh_report *r) {
    SF_HTML_DIVISION(page, "columns wide");
    sf_chart_figure(page, output, "cfh", "softfall-cfh",
                    r->spread
                        ? "a_max and HIC over the drop height; bands: 95 % of the draws of the foam, and "
                          "the intervals of the crossings"
                        : "a_max and HIC over the drop height");
    put_bodies(page, r);
}

sf_status sf_cfh_write_page(const sf_staging *output, const sf_cfh_report *r, sf_error *err) {
    char verdict[SF_CFH_VERDICT_SIZE], rig[400], *title = sf_origin_title(r->case_text);
    FILE *page = sf_html_begin(output, "Critical fall height", title && *title ? title : NULL, err);
    free(title);
    SF_TRY(err->status);
    sf_cfh_verdict_text(r, verdict, sizeof verdict);
    sf_cfh_rig_text(r, rig, sizeof rig);
    sf_html_banner(page, banner_kind(r),
                   r->result->verdict == SF_CFH_UNKNOWN ? "not determined" : "indicative", "%s%s%s %s",
                   verdict, rig[0] ? " " : "", rig, sf_cfh_caution);
    put_tiles(page, r);
    put_top(page, output, r);
    put_drops(page, r);
    put_materials(page, r->case_text, r->parameters);
    return sf_html_end(page, r->command_line, "softfall-cfh " SF_VERSION " (" SF_GIT_REVISION ")", err);
}
