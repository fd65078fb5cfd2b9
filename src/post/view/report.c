/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/view/report.h"

#include "build_info.h"
#include "base/text.h"
#include "model/model.h"
#include "post/results/origin.h"
#include "post/view/plot.h"
#include "post/view/report_picture.h"
#include "report/chart.h"

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

void sf_origin_put_keys(sf_html_table *table, const char *parameters, const sf_named_text *list) {
    for (sf_origin_key key; (*list)[0]; list++) {
        if (!sf_origin_find(parameters, (*list)[0], &key) || strcmp(key.value, "(absent)") == 0)
            continue;
        tidy(key.value);
        if (*key.value)
            sf_html_fact(table, (*list)[1], "%s", key.value);
    }
}

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

void sf_origin_put_material(FILE *page, const char *case_text, const char *parameters) {
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

static const char caution[] =
    "Indicative, not a certification: figures of one simulated impact, not the test of EN 1177 or ASTM F1292.";

/* The page, and what its parts need. */
typedef struct page {
    FILE *file;
    const sf_summary *summary;
    const sf_results *results;
    const sf_figures *figures;
    const sf_verdict *verdict;
    const sf_report_pictures *pictures;
    char *case_text, *parameters; /* of the model; owned */
} page;

const char *sf_report_kind(sf_grade grade) {
    static const char *const kinds[] = {"good", "fair", "bad"};
    return kinds[grade];
}

/* ---- the top ---- */

const char *sf_report_findings(const sf_verdict *verdict, char *line, size_t size) {
    sf_verdict_line(verdict, line, size);
    const char *findings = strstr(line, ": ");
    return findings ? findings + 2 : "Every check of the run is within its bounds";
}

static void put_limit_tile(const page *p, const sf_limit *limit) {
    char value[48] = "–", remark[96];
    const char *unit = strcmp(limit->unit, "1") == 0 ? "" : limit->unit, *blank = *unit ? " " : "";
    if (isfinite(limit->value))
        snprintf(value, sizeof value, "%.1f%s%s", limit->value, blank, unit);
    snprintf(remark, sizeof remark, "limit %g%s%s: %s", limit->bound, blank, unit, sf_limit_phrase(limit));
    sf_html_tile(p->file,
                 !limit->judged  ? "plain"
                 : limit->passed ? "good"
                                 : "bad",
                 limit->title, value, remark);
}

static void put_tile(const page *p, const char *title, double value, int digits, const char *unit,
                     const char *format, double remark) {
    char text[48] = "–", below[96] = "";
    if (isfinite(value))
        snprintf(text, sizeof text, "%.*f %s", digits, value, unit);
    if (isfinite(remark))
        snprintf(below, sizeof below, format, remark);
    sf_html_tile(p->file, "plain", title, text, below);
}

static void put_tiles(const page *p) {
    const sf_figures *f = p->figures;
    SF_HTML_DIVISION(p->file, "tiles");
    for (int k = 0; k < p->verdict->limit_count; k++)
        put_limit_tile(p, &p->verdict->limits[k]);
    if (f->driven) {
        put_tile(p, "largest force", f->peak_force, 1, "N", "at %.2f ms", f->peak_force_time * 1e3);
        put_tile(p, "largest stress", f->peak_stress * 1e-3, 1, "kPa", "over %.4g cm² at rest",
                 f->area * 1e4);
    }
    put_tile(p, "largest indentation", f->max_indentation * 1e3, 1, "mm", "%.0f %% of the thickness",
             100 * f->max_mean_strain);
    if (f->driven)
        put_tile(p, "work", f->work, 3, "J", "%.0f %% given back", 100 * f->returned_energy_fraction);
    else
        put_tile(p, "rebound", f->v_rebound, 2, "m/s", "%.0f %% of the energy absorbed",
                 100 * f->absorbed_energy_fraction);
}

/* ---- what was dropped on what ---- */

static void put_missile(const page *p) {
    const sf_results *r = p->results;
    SF_HTML_BLOCK(p->file, "Missile");
    SF_HTML_TABLE table = sf_html_table_begin(p->file, NULL);
    if (r->driven) {
        SF_ORIGIN_PUT(&table, p->parameters, {"missile.motion", "prescribed motion"});
    } else {
        double height = r->missile_speed * r->missile_speed / (2 * SF_STANDARD_GRAVITY);
        sf_html_fact(&table, "mass", "%.4g kg, of the whole missile", r->missile_mass);
        sf_html_fact(&table, "speed at contact", "%.4g m/s (free fall from %.3f m)", r->missile_speed,
                     height);
        sf_html_fact(&table, "kinetic energy", "%.4g J",
                     r->missile_mass * r->missile_speed * r->missile_speed / 2);
    }
    SF_ORIGIN_PUT(&table, p->parameters, {"geometry.missile_file", "shape"},
                  {"geometry.missile_parameters", "its parameters"});
    if (isfinite(r->impact_x) && isfinite(r->impact_y))
        sf_html_fact(&table, "impact point", "x = %.4g mm, y = %.4g mm", r->impact_x * 1e3,
                     r->impact_y * 1e3);
    SF_ORIGIN_PUT(&table, p->parameters, {"missile.friction", "friction on the pad"});
}

static void put_interfaces(const page *p, sf_html_table *table) {
    sf_origin_key between, kind, friction;
    char name[64];
    for (int k = 1; snprintf(name, sizeof name, "interfaces.%d.between", k) > 0 &&
                    sf_origin_find(p->parameters, name, &between);
         k++) {
        snprintf(name, sizeof name, "interfaces.%d.kind", k);
        bool told = sf_origin_find(p->parameters, name, &kind);
        snprintf(name, sizeof name, "interfaces.%d.friction", k);
        bool rough = sf_origin_find(p->parameters, name, &friction) && friction.given;
        tidy(between.value);
        sf_html_fact(table, "interface", "%s: %s%s%s", between.value, told ? kind.value : "",
                     rough ? ", friction " : "", rough ? friction.value : "");
    }
}

static void put_pad(const page *p) {
    const sf_results *r = p->results;
    SF_HTML_BLOCK(p->file, "Pad");
    SF_HTML_TABLE table = sf_html_table_begin(p->file, NULL);
    sf_html_fact(&table, "thickness", "%.4g mm", r->thickness * 1e3);
    if (isfinite(r->set_largest))
        sf_html_fact(&table, "permanent set",
                     "%.3g mm deep at the impact point before this drop, at most %.3g mm", 1e3 * r->set,
                     1e3 * r->set_largest);
    sf_html_fact(&table, "mean cross-section", "%.4g cm²: volume of the whole pad over its extent along z",
                 p->figures->area * 1e4);
    sf_html_fact(&table, "density", "%.4g kg/m³, undeformed%s", r->density,
                 r->layer_count > 0 ? ", mean of the layers" : "");
    SF_ORIGIN_PUT(&table, p->parameters, {"geometry.file", "shape"},
                  {"geometry.parameters", "its parameters"}, {"geometry.length_unit", "their unit"},
                  {"geometry.missile_length_unit", "unit of the missile's geometry"},
                  {"pad.fixed", "surfaces of the base"}, {"pad.sliding", "sliding surfaces"},
                  {"pad.base", "base"});
    if (r->history.anvil_nodes[0] > 0) {
        SF_ORIGIN_PUT(&table, p->parameters, {"pad.friction", "friction on the anvil"},
                      {"pad.gravity", "gravity on the pad"});
    }
    SF_ORIGIN_PUT(&table, p->parameters, {"pad.sliding_interfaces", "sliding layers"},
                  {"pad.loose_interfaces", "loose layers"});
    put_interfaces(p, &table);
}

/* Words of the case about the test. */
static void put_test(const page *p) {
    sf_origin_key key;
    int count = 0;
    for (int k = 0; k < SF_ORIGIN_REPORT_KEYS; k++)
        count += sf_origin_find_report(p->parameters, sf_origin_report_keys[k], &key);
    if (count == 0)
        return;
    SF_HTML_TABLE table = sf_html_table_begin(p->file, NULL);
    for (int k = 0; k < SF_ORIGIN_REPORT_KEYS; k++)
        if (sf_origin_find_report(p->parameters, sf_origin_report_keys[k], &key))
            sf_html_fact(&table, sf_origin_report_keys[k], "%s", key.value);
}

static void put_bodies(const page *p) {
    SF_HTML_DIVISION(p->file, "columns ");
    put_missile(p);
    put_pad(p);
}

/* ---- pictures ---- */

static void put_curve(const page *p, const sf_staging *output) {
    char warning[320];
    const sf_figures *f = p->figures;
    SF_OWNED char *svg = sf_chart_svg(output, sf_plot_name(f), "softfall-post", warning, sizeof warning);
    if (!svg)
        sf_html_figure(p->file, NULL, "%s.", warning);
    else if (f->driven)
        sf_html_figure(p->file, svg, "Nominal stress over strain (indentation over thickness).");
    else if (f->injury.hic.value > 0)
        sf_html_figure(p->file, svg, "Missile: %s%s, filtered (CFC %.0f); shaded: the HIC window.",
                       f->acceleration, f->passed, f->cfc);
    else
        sf_html_figure(p->file, svg, "Missile: %s%s, filtered with CFC %.0f, over time.", f->acceleration,
                       f->passed, f->cfc);
}

/* The picture that came with the film. */
static void put_scene(const page *p, const sf_staging *output) {
    SF_OWNED char *scene = sf_html_png(output, "pad.png");
    if (scene)
        sf_html_figure(p->file, scene,
                       "The same in ParaView (pad_paraview.py), all of the pad behind the missile's axis.");
}

/* The page that came before this one; a report that is moved alone has a link to nothing. */
static void put_link(const page *p, const sf_staging *output) {
    if (sf_staging_has(output, "view.html"))
        fputs(
            "<p class=\"note\">All frames, to turn and to cut in a browser: <a href=\"view.html\">view.html</a>, "
            "beside this page.</p>\n",
            p->file);
}

/* A block with a picture of the drop, and with what came with the film if `output` is given. */
static void put_picture(const page *p, const char *heading, const sf_report_picture *picture,
                        const sf_staging *output) {
    SF_HTML_BLOCK(p->file, heading);
    sf_html_figure(p->file, picture->svg, "%s", picture->text);
    if (!output)
        return;
    put_scene(p, output);
    put_link(p, output);
}

static void put_pictures(const page *p, const sf_staging *output) {
    const sf_report_pictures *q = p->pictures;
    if (q->before.svg)
        put_picture(p, "The pad before the drop", &q->before, NULL);
    put_picture(p, "The pad at the peak", &q->pad, output);
    put_picture(p, "Mid-section", &q->instants, NULL);
    SF_HTML_BLOCK(p->file, p->figures->driven ? "Stress and strain"
                                              : "Acceleration, and stress through the thickness");
    SF_HTML_DIVISION(p->file, "columns wide");
    put_curve(p, output);
    sf_html_figure(p->file, q->profile.svg, "%s", q->profile.text);
}

/* ---- tables ---- */

static void put_number(sf_html_table *table, double value) {
    if (isfinite(value))
        sf_html_cell(table, fabs(value) >= 1e4 ? "%.6g" : "%.4g", value);
    else
        sf_html_cell(table, "–");
}

static void put_check(sf_html_table *table, const sf_check *c) {
    sf_html_row(table);
    sf_html_hint(table, c->why);
    sf_html_cell(table, "%s", c->title);
    if (sf_check_is_flag(c)) {
        sf_html_cell(table, "%s", isnan(c->value) ? "–" : c->value > 0 ? "yes" : "no");
        sf_html_cell(table, "no");
        sf_html_cell(table, "–");
    } else {
        put_number(table, c->value);
        put_number(table, c->bound);
        put_number(table, c->use_bound);
    }
    sf_html_cell(table, "%s", isnan(c->value) ? "not judged" : sf_verdict_phrase(c->grade));
}

static void put_checks(const page *p) {
    SF_HTML_BLOCK(p->file, "Checks of the run");
    sf_html_table table = sf_html_table_begin(p->file, "check|>value|>good up to|>usable up to|finding");
    for (int k = 0; k < p->verdict->count; k++)
        put_check(&table, &p->verdict->rows[k]);
    sf_html_table_end(&table);
    if (p->results->turns)
        sf_html_note(p->file, "Note: %s", p->verdict->rows[SF_CHECK_edge].text);
    for (int k = 0; k < p->results->note_count; k++)
        sf_html_note(p->file, "Note: %s", p->results->notes[k]);
}

/* The checks, and the force beside them. */
static void put_verdict(const page *p) {
    SF_HTML_DIVISION(p->file, "columns wide");
    put_checks(p);
    put_picture(p, "Force and indentation", &p->pictures->force, NULL);
}

static bool is_defined(const page *p, const sf_figure *figure) {
    return figure->row.type == SF_ROW_TEXT ||
           sf_row_is_defined(&figure->row, sf_figure_record(figure, p->results, p->figures));
}

static void put_figure(const page *p, sf_html_table *table, const sf_figure *figure) {
    const void *record = sf_figure_record(figure, p->results, p->figures);
    char text[64];
    sf_html_row(table);
    sf_html_hint(table, figure->row.meaning);
    sf_html_cell(table, "%s", figure->row.key);
    if (figure->row.type == SF_ROW_NUMBER)
        put_number(table, sf_row_number(&figure->row, record));
    else
        sf_html_cell(table, "%.32s", sf_row_shown(&figure->row, record, "–", text, sizeof text));
}

/* Puts the figures that the run defines, down each of three columns. */
static void put_columns(const page *p, const sf_figure *figure, size_t count, size_t defined) {
    enum { COLUMNS = 3 };
    size_t next = 0;
    SF_HTML_DIVISION(p->file, "columns ");
    for (size_t c = 0; c < COLUMNS; c++) {
        SF_HTML_TABLE table = sf_html_table_begin(p->file, "figure|>value");
        for (size_t put = 0; next < count && put < (defined + COLUMNS - 1) / COLUMNS; next++)
            if (is_defined(p, &figure[next])) {
                put_figure(p, &table, &figure[next]);
                put++;
            }
    }
}

static void put_figures(const page *p) {
    size_t defined = 0;
    for (size_t k = 0; k < SF_FIGURE_TOTAL; k++)
        defined += is_defined(p, &sf_figure_at[k]) ? 1 : 0;
    SF_HTML_BLOCK(p->file, "Figures");
    put_columns(p, sf_figure_at, SF_FIGURE_TOTAL, defined);
    sf_html_note(p->file,
                 "Values of summary.json, units at the end of the names (docs/formats.md). Not defined by "
                 "this run: %zu.",
                 SF_FIGURE_TOTAL - defined);
}

static void put_comparison(const page *p) {
    const sf_comparison *c = p->summary->comparison;
    if (!c)
        return;
    SF_HTML_BLOCK(p->file, "Comparison with a measured curve");
    sf_html_paragraph(
        p->file, "%s: a_max %.1f g (model %+.1f %%), HIC %.1f. Model time = measured time %+.3f ms (%s).",
        p->summary->reference_path, c->injury.a_max_g, 100 * c->peak_error, c->injury.hic.value,
        c->shift * 1e3, c->shift_given ? "as given" : "contact of both curves");
    char line[SF_VERDICT_LINE_SIZE];
    sf_record_line(&c->measured.record, line, sizeof line);
    sf_html_banner(p->file, sf_report_kind(c->measured.record.grade),
                   c->measured.record.grade == SF_GRADE_DO_NOT_USE ? "comparison not usable" : "record",
                   "%s.", line);
    sf_rows_html_table(p->file, sf_fit_rows(), (sf_records){c->fits, sizeof *c->fits, c->fit_count});
}

/* "864 hexahedra, 744 pyramids" */
static void count_cells(const sf_results *r, char *text, size_t size) {
    static const char *const names[] = {"tetrahedra", "pyramids", "prisms", "hexahedra"};
    int64_t count[4] = {0};
    for (int64_t c = 0; c < r->cell_count; c++)
        if (r->cell_type[c] >= SF_CELL_TETRAHEDRON && r->cell_type[c] <= SF_CELL_HEXAHEDRON)
            count[r->cell_type[c] - SF_CELL_TETRAHEDRON]++;
    *text = '\0';
    for (int k = 3; k >= 0; k--)
        if (count[k])
            sf_text_add(text, size, "%s%lld %s", *text ? ", " : "", (long long)count[k], names[k]);
}

static void put_text_fact(const page *p, sf_html_table *table, const char *title, const char *path) {
    SF_OWNED char *text = sf_origin_text(p->results, path);
    sf_html_fact(table, title, "%s", text && *text ? text : "not recorded in this file");
}

static void put_mesh(const page *p, sf_html_table *table) {
    const sf_results *r = p->results;
    char cells[160];
    double smallest = INFINITY, largest = 0;
    for (int64_t i = 0; i < r->node_count; i++) {
        smallest = fmin(smallest, cbrt(r->volume[i]));
        largest = fmax(largest, cbrt(r->volume[i]));
    }
    count_cells(r, cells, sizeof cells);
    if (r->axisymmetric)
        sf_html_fact(table, "nodes",
                     "%lld, in the section of an axisymmetric model; shown is a quarter of its body",
                     (long long)r->revolution.section_nodes);
    else
        sf_html_fact(table, "nodes", "%lld, modelled: 1/%lld of the whole", (long long)r->node_count,
                     (long long)r->symmetry_factor);
    sf_html_fact(table, r->axisymmetric ? "cells shown" : "cells", "%s", cells);
    sf_html_fact(table, "nodal spacing", "%.1f to %.1f mm (cube root of the volumes)", smallest * 1e3,
                 largest * 1e3);
    put_text_fact(p, table, "hash of the mesh", "/provenance/model/mesh_hash");
    put_text_fact(p, table, "hash of the model", "/provenance/model_hash");
}

static void put_version(const page *p, sf_html_table *table, const char *title, const char *group) {
    char path[96];
    char *text[3];
    static const char *const items[3] = {"version", "git_revision", "created"};
    for (int k = 0; k < 3; k++) {
        snprintf(path, sizeof path, "%s/%s", group, items[k]);
        text[k] = sf_origin_text(p->results, path);
    }
    if (text[0] && text[1] && text[2] && *text[0])
        sf_html_fact(table, title, "%s (%s), %s", text[0], text[1], text[2]);
    else
        sf_html_fact(table, title, "not recorded in this file");
    sf_free_all(3, text);
}

static void put_command(const page *p) {
    SF_OWNED char *pre = sf_origin_text(p->results, "/provenance/model/command_line");
    SF_OWNED char *solve = sf_origin_text(p->results, "/provenance/command_line");
    SF_OWNED char *all = NULL;
    if (pre && solve &&
        asprintf(&all, "%s\n%s\n%s", *pre ? pre : "(softfall-pre: not recorded)",
                 *solve ? solve : "(softfall-solve: not recorded)", p->summary->command_line) >= 0) {
        SF_HTML_BLOCK(p->file, "The commands that repeat this report, in the folder of the original run");
        sf_html_pre(p->file, all);
    }
}

static void put_versions(const page *p) {
    SF_HTML_BLOCK(p->file, "Mesh and versions");
    SF_HTML_TABLE table = sf_html_table_begin(p->file, NULL);
    put_mesh(p, &table);
    put_version(p, &table, "softfall-pre", "/provenance/model");
    put_version(p, &table, "softfall-solve", "/provenance");
    sf_html_fact(&table, "softfall-post", "%s (%s)", SF_VERSION, SF_GIT_REVISION);
    put_text_fact(p, &table, "compiler", "/provenance/compiler");
    put_text_fact(p, &table, "libraries", "/provenance/libraries");
}

/* Mesh and versions, and the energies beside them. */
static void put_provenance(const page *p) {
    SF_HTML_DIVISION(p->file, "columns ");
    put_versions(p);
    put_picture(p, "Energies", &p->pictures->energies, NULL);
}

/* A pad of several materials, layer by layer. */
static void put_layers(const page *p) {
    const sf_layer_figures *layers = p->figures->layers;
    if (!layers)
        return;
    SF_HTML_BLOCK(p->file, "Layers");
    sf_rows_html_table(p->file, sf_layer_figure_rows(),
                       (sf_records){layers, sizeof *layers, p->results->layer_count});
    sf_html_note(p->file,
                 "Absorbed: stored, lost and viscous energy in the last frame. Beyond its data: in nodes "
                 "compressed beyond the strain up to which the data of the layer's material inform it.");
}

/* ---- the page ---- */

void sf_report_title(const sf_results *r, char *title, size_t size) {
    if (r->driven)
        snprintf(title, size, "Compression of a foam specimen of %.4g mm", r->thickness * 1e3);
    else
        snprintf(title, size, "Drop of %.4g kg at %.4g m/s on a foam pad of %.4g mm", r->missile_mass,
                 r->missile_speed, r->thickness * 1e3);
}

/* Says how much of the drop is modelled. */
static const char *model_of(const sf_results *r) {
    if (r->axisymmetric)
        return "section of a body of revolution";
    if (r->symmetry_factor == 1)
        return "whole model";
    return r->symmetry_factor == 4 ? "quarter model" : "half model";
}

static const char *way_of(const sf_results *r) {
    if (r->driven)
        return "moved as given";
    return r->turns ? "free to turn" : "guided along a line";
}

/* Writes what was dropped on what, by the values of the run, as comments of the case may be older. */
static void put_subtitle(const page *p, char *text, size_t size) {
    sf_origin_key file, base;
    const char *name = "missile";
    char layers[48] = "";
    if (sf_origin_find(p->parameters, "geometry.missile_file", &file) && *file.value)
        name = strrchr(file.value, '/') ? strrchr(file.value, '/') + 1 : file.value;
    if (p->results->layer_count > 0)
        snprintf(layers, sizeof layers, " in %d layers", p->results->layer_count);
    bool told = sf_origin_find(p->parameters, "pad.base", &base);
    snprintf(text, size, "%s, %s, on foam of %.4g kg/m³%s, base %s; %s.", name, way_of(p->results),
             p->results->density, layers, told ? base.value : "held", model_of(p->results));
}

static sf_status begin_page(page *p, const sf_staging *output, sf_error *err) {
    char title[SF_REPORT_TITLE_SIZE], subtitle[1280];
    sf_report_title(p->results, title, sizeof title);
    put_subtitle(p, subtitle, sizeof subtitle);
    p->file = sf_html_begin(output, title, subtitle, err);
    return err->status;
}

static sf_status write_page(page *p, const sf_staging *output, sf_error *err) {
    char foot[512], line[SF_VERDICT_LINE_SIZE];
    SF_TRY(begin_page(p, output, err));
    sf_html_banner(p->file, sf_report_kind(p->verdict->grade), sf_verdict_phrase(p->verdict->grade), "%s. %s",
                   sf_report_findings(p->verdict, line, sizeof line), caution);
    put_tiles(p);
    put_test(p);
    put_bodies(p);
    put_layers(p);
    put_pictures(p, output);
    put_comparison(p);
    put_provenance(p);
    put_verdict(p);
    sf_origin_put_material(p->file, p->case_text, p->parameters);
    put_figures(p);
    put_command(p);
    snprintf(foot, sizeof foot, "softfall-post %s (%s), from %.300s", SF_VERSION, SF_GIT_REVISION,
             p->summary->results_path);
    return sf_html_end(p->file, NULL, foot, err);
}

sf_status sf_report_write(const sf_staging *output, const sf_summary *s, sf_error *err) {
    SF_OWNED_BY(sf_report_pictures_free) sf_report_pictures pictures = {0};
    page p = {.summary = s,
              .results = s->results,
              .figures = s->figures,
              .verdict = s->verdict,
              .pictures = &pictures,
              .case_text = sf_origin_text(s->results, "/provenance/model/case_text"),
              .parameters = sf_origin_text(s->results, "/provenance/model/parameters")};
    if (!p.case_text || !p.parameters)
        SF_NO_MEMORY(err, "report.html");
    else if (sf_report_pictures_make(output, s->results, s->figures, &pictures, err) == SF_OK)
        write_page(&p, output, err);
    SF_FREE(p.case_text, p.parameters);
    return err->status;
}
