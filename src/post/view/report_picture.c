/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/view/report_picture.h"

#include "post/view/csv.h"
#include "post/view/plot.h"
#include "base/text.h"
#include "report/chart.h"
#include "post/view/cut.h"
#include <string.h>

/* An instant: a third of the way to the peak, the peak, half its force after it. */
typedef struct instant {
    const sf_frame_head *head; /* NULL: there is no frame near it */
    sf_frame frame;
    double wanted;  /* s */
    char title[96]; /* "t = 5.0 ms: 23 g, ..." */
} instant;

static const char *const moments[SF_INSTANTS] = {"a third of the way", "peak", "half the peak force"};

/* ---- which frames ---- */

/* Times (s) of the instants; false if the history has no peak within it. */
static bool find_instants(const sf_results *r, const sf_series *raw, instant list[SF_INSTANTS]) {
    const sf_history *h = &r->history;
    const double *load = r->driven ? h->contact_force : raw->value;
    int64_t peak = sf_history_row_of_sustained(h, load), first = 0, half = peak;
    while (first < peak && !(h->contact_nodes[first] > 0))
        first++;
    while (half + 1 < h->rows && load[half] > 0.5 * load[peak])
        half++;
    list[1].wanted = h->time[peak];
    list[0].wanted = h->time[first] + (h->time[peak] - h->time[first]) / 3;
    list[2].wanted = load[half] > 0.5 * load[peak] ? NAN : h->time[half];
    return load[peak] > 0 && peak > first;
}

static const sf_frame_head *nearest(const sf_results *r, double time, double reach) {
    const sf_frame_head *best = NULL;
    for (int64_t k = 0; k < r->frame_count; k++)
        if (fabs(r->frames[k].time - time) <= reach &&
            (!best || fabs(r->frames[k].time - time) < fabs(best->time - time)))
            best = &r->frames[k];
    return best;
}

static bool has_fields(const sf_frame *frame) {
    return frame->field[SF_FRAME_DISPLACEMENT] && frame->field[SF_FRAME_VON_MISES];
}

static double force_at(const sf_history *h, double time) {
    int64_t k = 0;
    while (k + 1 < h->rows && h->time[k] < time)
        k++;
    return h->contact_force[k];
}

static void name_instant(const sf_results *r, const sf_series *raw, instant *i, const char *moment) {
    if (r->driven)
        snprintf(i->title, sizeof i->title, "%.1f ms: %.3g N, %s", i->head->time * 1e3,
                 force_at(&r->history, i->head->time), moment);
    else
        snprintf(i->title, sizeof i->title, "%.1f ms: %.0f g, %s", i->head->time * 1e3,
                 sf_series_at(raw, i->head->time), moment);
}

/* Reads the frames nearest to the instants, within a fifth of the time to the peak, or what there is. */
static void read_instants(const sf_results *r, const sf_series *raw, instant list[SF_INSTANTS]) {
    if (!find_instants(r, raw, list))
        return;
    double reach = 0.3 * (list[1].wanted - list[0].wanted);
    for (int k = 0; k < SF_INSTANTS; k++) {
        const sf_frame_head *head = isnan(list[k].wanted) ? NULL : nearest(r, list[k].wanted, reach);
        if (k == 1 && r->has_peak)
            head = &r->peak;
        if (!head || sf_frame_read(r, head, SF_FIELD_ALL, &list[k].frame, SF_IGNORED) != SF_OK ||
            !has_fields(&list[k].frame))
            continue;
        list[k].head = head;
        name_instant(r, raw, &list[k], moments[k]);
    }
}

/* "a third of the way (4.1 ms) and half the peak force (14.2 ms)": those without a frame. */
static int name_missing(const instant list[SF_INSTANTS], char *text, size_t size) {
    int count = 0;
    *text = '\0';
    for (int k = 0; k < SF_INSTANTS; k++) {
        if (list[k].head)
            continue;
        sf_text_add(text, size, "%s%s", count++ ? ", " : "", moments[k]);
        if (list[k].wanted > 0)
            sf_text_add(text, size, " (%.1f ms)", list[k].wanted * 1e3);
    }
    return count;
}

/* ---- pictures of the cut ---- */

static void draw_pad(const sf_cut *cut, const instant *peak, sf_report_picture *p, sf_error *err) {
    if (!peak->head || cut->polygon_count == 0) {
        snprintf(p->text, sizeof p->text,
                 "No picture of the deformed pad: results.h5 holds no displacement and von Mises stress at "
                 "the peak.");
        return;
    }
    bool strain = peak->frame.field[SF_FRAME_LARGEST_COMPRESSION] != NULL;
    const sf_picture_style style = {.field = strain ? SF_FRAME_LARGEST_COMPRESSION : SF_FRAME_VON_MISES,
                                    .factor = strain ? 1 : 1e-3,
                                    .label =
                                        strain ? "largest compression (strain)" : "von Mises stress (kPa)",
                                    .lines = true,
                                    .half_width = INFINITY};
    const sf_picture picture = {peak->title, peak->head, &peak->frame};
    snprintf(
        p->text, sizeof p->text,
        "The deformed pad, cut through the axis of the missile%s, with the cells of the background mesh.",
        cut->mirrored ? " and mirrored there" : "");
    p->svg = sf_picture_draw(cut, &picture, 1, &style, err);
}

void sf_report_picture_before(const sf_results *r, sf_report_picture *p, sf_error *err) {
    SF_OWNED_BY(sf_frame_free) sf_frame frame = {0};
    SF_OWNED_BY(sf_cut_free) sf_cut cut = {0};
    if (r->frame_count == 0 || r->frames[0].time > 0 || !sf_h5_exists(r->file, "/frames/000000/softening") ||
        sf_frame_read(r, &r->frames[0], SF_FIELD_ALL, &frame, err) != SF_OK ||
        !frame.field[SF_FRAME_DISPLACEMENT] || sf_cut_make(r, &cut, err) != SF_OK || cut.polygon_count == 0) {
        snprintf(p->text, sizeof p->text,
                 "No picture: results.h5 holds no displacement and softening at the start.");
    } else {
        const sf_picture_style style = {.field = SF_FRAME_SOFTENING,
                                        .factor = 1e-3,
                                        .label = "softening (kJ/m³)",
                                        .half_width = INFINITY};
        const sf_picture picture = {"before the drop", &r->frames[0], &frame};
        snprintf(p->text, sizeof p->text,
                 "The pad before the drop: the energy by which loading, up to the largest so far, takes up "
                 "less than that of new foam.");
        if (isfinite(r->set))
            sf_text_add(p->text, sizeof p->text, " Its permanent set is %.3g mm deep at the impact point.",
                        1e3 * r->set);
        p->svg = sf_picture_draw(&cut, &picture, 1, &style, err);
    }
}

static void draw_instants(const sf_cut *cut, const instant list[SF_INSTANTS], sf_report_picture *p,
                          sf_error *err) {
    sf_picture picture[SF_INSTANTS];
    char missing[160];
    int count = 0, lost = name_missing(list, missing, sizeof missing);
    for (int k = 0; k < SF_INSTANTS && cut->polygon_count > 0; k++)
        if (list[k].head)
            picture[count++] = (sf_picture){list[k].title, list[k].head, &list[k].frame};
    if (count == 0) {
        snprintf(p->text, sizeof p->text,
                 "No picture of the mid-section: results.h5 holds no frames with displacement and von Mises "
                 "stress near the peak.");
        return;
    }
    double half = 1.25 * fmax(cut->missile[1] - cut->axis, cut->axis - cut->missile[0]);
    const sf_picture_style style = {.field = SF_FRAME_VON_MISES,
                                    .factor = 1e-3,
                                    .label = "von Mises stress (kPa), logarithmic",
                                    .logarithmic = true,
                                    .half_width = half > 0 ? half : INFINITY};
    snprintf(p->text, sizeof p->text, "Von Mises stress in the mid-section at %s.%s%s%s",
             count == 3 ? "three instants" : "the instants that have a frame", lost ? " No frame near: " : "",
             missing, lost ? " (shorten output.frame_interval)." : "");
    p->svg = sf_picture_draw(cut, picture, count, &style, err);
}

/* ---- curves ---- */

/* Draws a chart for the page, and frees it. */
static sf_status take_curve(sf_chart *chart, const sf_staging *output, sf_report_picture *p, sf_error *err) {
    char warning[320];
    p->svg = sf_chart_page(chart, output, "softfall-post", warning, sizeof warning, err);
    if (!p->svg)
        snprintf(p->text, sizeof p->text, "%s.", warning);
    sf_chart_free(chart);
    return err->status;
}

static sf_series_style line_of(const char *colour, double width) {
    return (sf_series_style){.kind = SF_SERIES_LINE, .colour = colour, .width = width};
}

/* A step of 1, 2 or 5 times a power of ten that divides the axis into five parts or a few less. */
static double tic_step(double top) {
    double power = pow(10, floor(log10(top / 5))), part = top / 5 / power;
    return power * (part <= 1 ? 1 : part <= 2 ? 2 : part <= 5 ? 5 : 10);
}

enum { SMALL_WIDTH = 790, SMALL_HEIGHT = 720, HALF_WIDTH = 1130, FORCE_HEIGHT = 570, HALF_HEIGHT = 460 };

static sf_status draw_profile(const sf_staging *output, const sf_results *r, const instant list[SF_INSTANTS],
                              sf_report_picture *p, sf_error *err) {
    static const char *const colour[SF_INSTANTS] = {"#6baed6", "#cb181d", "#41ab5d"};
    sf_section_point station[SF_SECTION_STATIONS];
    int count = 0;
    snprintf(p->text, sizeof p->text, "No frames for the von Mises stress through the thickness.");
    for (int k = 0; k < SF_INSTANTS; k++)
        count += list[k].head != NULL;
    if (count == 0)
        return SF_OK;
    double top = sf_section_stations(r, station);
    sf_chart *chart = sf_chart_new("profile", SMALL_WIDTH, SMALL_HEIGHT, err);
    sf_panel *panel = sf_chart_panel(chart);
    sf_axis_label(&panel->x, "von Mises stress (kPa)");
    sf_axis_label(&panel->y, "undeformed depth (mm)");
    sf_axis_range(&panel->y, r->thickness * 1e3, 0);
    panel->x.logarithmic = true;
    panel->key = SF_KEY_BELOW;
    for (int k = 0; k < SF_INSTANTS; k++) {
        if (!list[k].head)
            continue;
        sf_series_data *line =
            sf_chart_series(chart, line_of(colour[k], 4), "%.1f ms", list[k].head->time * 1e3);
        for (int s = 0; s < SF_SECTION_STATIONS; s++)
            if (sf_section_inside(&station[s]))
                sf_series_point(
                    line, 1e-3 * sf_section_mean(list[k].frame.field[SF_FRAME_VON_MISES], 1, 0, &station[s]),
                    1e3 * (top - sf_section_mean(r->position, 3, 2, &station[s])));
    }
    snprintf(p->text, sizeof p->text,
             "Von Mises stress through the thickness, under the axis of the missile.");
    return take_curve(chart, output, p, err);
}

static sf_status draw_force(const sf_staging *output, const sf_history *h, sf_report_picture *p,
                            sf_error *err) {
    sf_chart *chart = sf_chart_new("force", HALF_WIDTH, FORCE_HEIGHT, err);
    sf_panel *panel = sf_chart_panel(chart);
    sf_axis_label(&panel->x, "indentation (mm)");
    sf_axis_range(&panel->x, 0, NAN);
    sf_axis_label(&panel->y, "contact force (kN)");
    sf_axis_range(&panel->y, 0, NAN);
    panel->y.step = tic_step(fmax(1e-3 * sf_history_largest(h, h->contact_force), 1e-9));
    sf_series_points(sf_chart_series(chart, line_of("#08519c", 3.5), NULL), h->rows, h->indentation,
                     h->contact_force, 1e3, 1e-3, 0);
    snprintf(p->text, sizeof p->text, "Force on the missile over its indentation.");
    return take_curve(chart, output, p, err);
}

/* The energies that are seen beside the largest. */
static void put_energies(sf_chart *chart, const sf_history *h, double top) {
    static const struct {
        const char *name, *title, *colour;
    } list[] = {
        {"energy_kinetic_missile", "missile", "#303030"},     {"energy_stored", "stored", "#08519c"},
        {"energy_hysteresis", "hysteresis", "#cb181d"},       {"energy_viscous", "viscous", "#f08030"},
        {"energy_kinetic_pad", "pad in motion", "#a6761d"},   {"energy_friction", "friction", "#e7298a"},
        {"energy_stabilisation", "stabilisation", "#8856a7"}, {"energy_contact", "contact", "#41ab5d"}};
    for (size_t k = 0; k < sizeof list / sizeof list[0]; k++)
        for (int c = 0; c < SF_HISTORY_COUNT; c++)
            if (strcmp(sf_history_column_get(c)->name, list[k].name) == 0 &&
                sf_history_largest(h, h->column[c]) >= 0.01 * top)
                sf_series_points(sf_chart_series(chart, line_of(list[k].colour, 3), "%s", list[k].title),
                                 h->rows, h->time, h->column[c], 1e3, 1, 0);
}

static sf_status draw_energies(const sf_staging *output, const sf_history *h, const sf_figures *f,
                               sf_report_picture *p, sf_error *err) {
    double range[2];
    double top =
        fmax(sf_history_largest(h, h->energy_kinetic_missile), sf_history_largest(h, h->energy_stored));
    sf_chart *chart = sf_chart_new("energies", HALF_WIDTH, HALF_HEIGHT, err);
    sf_panel *panel = sf_chart_panel(chart);
    sf_plot_time_range(f, NULL, range);
    sf_axis_label(&panel->x, "time (ms)");
    sf_axis_range(&panel->x, range[0] * 1e3, range[1] * 1e3);
    sf_axis_label(&panel->y, "energy (J)");
    sf_axis_range(&panel->y, 0, NAN);
    panel->y.step = tic_step(fmax(top, 1e-9));
    panel->key = SF_KEY_RIGHT;
    put_energies(chart, h, top);
    snprintf(p->text, sizeof p->text,
             "Energies of the whole pad and missile; those below 1 %% are left out.");
    return take_curve(chart, output, p, err);
}

/* ---- all ---- */

sf_status sf_report_pictures_make(const sf_staging *output, const sf_results *results,
                                  const sf_figures *figures, sf_report_pictures *p, sf_error *err) {
    instant list[SF_INSTANTS] = {0};
    SF_OWNED_BY(sf_cut_free) sf_cut cut = {0};
    *p = (sf_report_pictures){0};
    read_instants(results, &figures->raw, list);
    sf_report_picture_before(results, &p->before, err);
    if (err->status == SF_OK && sf_cut_make(results, &cut, err) == SF_OK) {
        draw_pad(&cut, &list[1], &p->pad, err);
        draw_instants(&cut, list, &p->instants, err);
    }
    if (err->status == SF_OK && draw_profile(output, results, list, &p->profile, err) == SF_OK &&
        draw_force(output, &results->history, &p->force, err) == SF_OK)
        draw_energies(output, &results->history, figures, &p->energies, err);
    for (int k = 0; k < SF_INSTANTS; k++)
        sf_frame_free(&list[k].frame);
    return err->status;
}

void sf_report_pictures_free(sf_report_pictures *p) {
    SF_CLEAR(p, p->before.svg, p->pad.svg, p->instants.svg, p->profile.svg, p->force.svg, p->energies.svg);
}
