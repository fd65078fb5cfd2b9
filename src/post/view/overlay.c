/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/view/overlay.h"

#include "build_info.h"
#include "base/program.h"
#include "report/chart.h"
#include "report/html.h"
#include "io/provenance.h"
#include "post/figures/figures.h"
#include "post/figures/verdict.h"
#include <argp.h>
#include <limits.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

enum { MOST_RUNS = 12, CURVE_POINTS = 2000 };

/* A run, evaluated as softfall-post does by default. */
typedef struct overlay_run {
    const char *name;    /* as given */
    char path[PATH_MAX]; /* of its results.h5 */
    bool open;           /* the members below are to be released */
    sf_results results;
    sf_figures figures;
    sf_verdict verdict;
} overlay_run;

typedef struct overlay {
    const char *directory;
    bool force;
    int count;
    overlay_run run[MOST_RUNS];
    sf_staging output;
    char *command;
} overlay;

static const char *const names[] = {"compare.csv", "compare.gp", "compare.png", "report.html", NULL};
static const char *const colours[MOST_RUNS] = {"#08519c", "#cb181d", "#238b45", "#6a51a3",
                                               "#d94801", "#17becf", "#8c6d31", "#525252",
                                               "#e7298a", "#66c2a4", "#fdae6b", "#9e9ac8"};
/* In the page; compare.csv has every figure. */
static const char *const listed[] = {"a_max_g",
                                     "a_max_time_ms",
                                     "hic",
                                     "hic_t1_ms",
                                     "hic_t2_ms",
                                     "v0_m_s",
                                     "v_rebound_m_s",
                                     "absorbed_energy_fraction",
                                     "max_indentation_mm",
                                     "max_local_strain",
                                     "energy_error",
                                     "nodes",
                                     "steps"};

static error_t parse(int key, char *text, struct argp_state *state) {
    overlay *o = state->input;
    switch (key) {
    case 'o':
        o->directory = text;
        return 0;
    case 'f':
        o->force = true;
        return 0;
    case ARGP_KEY_ARG:
        if (o->count == MOST_RUNS)
            argp_error(state, "at most %d runs in one picture: \"%s\" is one too many", MOST_RUNS, text);
        o->run[o->count++].name = text;
        return 0;
    case ARGP_KEY_END:
        if (o->count < 2 || !o->directory)
            argp_error(state, "give two runs or more, and the output directory with -o");
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* A folder stands for the results.h5 in it. */
static sf_status name_results(overlay_run *r, sf_error *err) {
    struct stat info;
    bool folder = stat(r->name, &info) == 0 && S_ISDIR(info.st_mode);
    if ((size_t)snprintf(r->path, sizeof r->path, "%s%s", r->name, folder ? "/results.h5" : "") >=
        sizeof r->path)
        return SF_FAIL(err, SF_ERR_INPUT, "the name %.100s... is too long", r->name);
    return SF_OK;
}

static sf_status read_run(overlay_run *r, sf_error *err) {
    const sf_limits limits = SF_DEFAULT_LIMITS;
    if (name_results(r, err) != SF_OK || sf_results_open(r->path, &r->results, err) != SF_OK)
        return err->status;
    r->open = true;
    if (sf_figures_compute(&r->results, 1000, &r->figures, err) != SF_OK)
        return err->status;
    if (r->figures.driven || !r->figures.touched)
        return SF_FAIL(err, SF_ERR_INPUT, "%s cannot be compared: %s", r->path,
                       r->figures.driven ? "the missile's motion was prescribed"
                                         : "the missile never touched the pad");
    sf_verdict_compute(&r->results, &r->figures, &limits, &r->verdict);
    return SF_OK;
}

/* ---- output ---- */

static void put_quoted(FILE *out, const char *text) {
    fputc('"', out);
    for (; *text; text++) {
        if (*text == '"')
            fputc('"', out);
        fputc(*text == '\n' ? ' ' : *text, out);
    }
    fputc('"', out);
}

static void put_csv_row(FILE *csv, const overlay *o, const sf_figure *figure) {
    fprintf(csv, "%s", figure->row.key);
    for (int k = 0; k < o->count; k++) {
        const overlay_run *r = &o->run[k];
        double value = sf_figure_number(figure, &r->results, &r->figures);
        fputc(',', csv);
        if (figure->row.type == SF_ROW_TEXT)
            put_quoted(csv,
                       sf_row_value(&figure->row, sf_figure_record(figure, &r->results, &r->figures)).text);
        else if (!isnan(value))
            fprintf(csv, "%.9g", value);
    }
    fputc('\n', csv);
}

/* A row for each figure, a column for each run. */
static sf_status write_csv(const overlay *o, sf_error *err) {
    size_t count;
    const sf_figure *list = sf_figure_list(&count);
    FILE *csv = sf_staging_open(&o->output, "compare.csv", err);
    if (!csv)
        return err->status;
    fputs("figure", csv);
    for (int k = 0; k < o->count; k++) {
        fputc(',', csv);
        put_quoted(csv, o->run[k].name);
    }
    fputs("\ngrade", csv);
    for (int k = 0; k < o->count; k++)
        fprintf(csv, ",%s", sf_verdict_phrase(o->run[k].verdict.grade));
    fputc('\n', csv);
    for (size_t k = 0; k < count; k++)
        put_csv_row(csv, o, &list[k]);
    return sf_staging_close(csv, "compare.csv", err);
}

/* The filtered curves, their time from first contact. */
static sf_status write_picture(const overlay *o, char *warning, size_t size, sf_error *err) {
    sf_chart *chart = sf_chart_new("compare", 1600, 900, err);
    sf_panel *panel = sf_chart_panel(chart);
    if (panel) {
        sf_axis_label(&panel->x, "time from first contact (ms)");
        sf_axis_label(&panel->y, "deceleration (g)");
        panel->key = SF_KEY_TOP_RIGHT;
    }
    for (int k = 0; k < o->count; k++) {
        const sf_series *s = &o->run[k].figures.filtered;
        double contact = o->run[k].results.contact_time;
        sf_series_data *line = sf_chart_series(
            chart, (sf_series_style){.kind = SF_SERIES_LINE, .colour = colours[k], .width = 2}, "%s",
            o->run[k].name);
        for (int64_t i = 0; i < s->count; i += s->count / CURVE_POINTS + 1)
            if (s->time[i] >= contact - 2e-3)
                sf_series_point(line, 1e3 * (s->time[i] - contact), s->value[i]);
    }
    sf_chart_write(chart, &o->output, warning, size, err);
    sf_chart_free(chart);
    return err->status;
}

static void put_table(FILE *page, const overlay *o) {
    sf_html_table t = sf_html_table_begin(page, "dense", NULL);
    sf_html_row(&t);
    sf_html_cell(&t, "run");
    for (int k = 0; k < o->count; k++)
        sf_html_cell(&t, "%s", o->run[k].name);
    sf_html_row(&t);
    sf_html_cell(&t, "verdict");
    for (int k = 0; k < o->count; k++)
        sf_html_cell(&t, "%s", sf_verdict_phrase(o->run[k].verdict.grade));
    for (size_t f = 0; f < sizeof listed / sizeof listed[0]; f++) {
        sf_html_row(&t);
        sf_html_cell(&t, "%s", listed[f]);
        for (int k = 0; k < o->count; k++) {
            double value =
                sf_figure_number(sf_figure_find(listed[f]), &o->run[k].results, &o->run[k].figures);
            sf_html_cell(&t, isnan(value) ? "–" : "%.5g", value);
        }
    }
    sf_html_table_end(&t);
}

static void put_remarks(FILE *page, const overlay *o) {
    char line[SF_VERDICT_LINE_SIZE];
    for (int k = 0; k < o->count; k++) {
        if (o->run[k].verdict.grade == SF_GRADE_VALID)
            continue;
        sf_verdict_line(&o->run[k].verdict, line, sizeof line);
        sf_html_paragraph(page, "%s: %s.", o->run[k].name, line);
    }
}

static sf_status write_page(const overlay *o, sf_error *err) {
    char warning[320];
    sf_grade worst = SF_GRADE_VALID;
    FILE *page = sf_html_begin(&o->output, "Comparison of runs", NULL, err);
    if (!page)
        return err->status;
    for (int k = 0; k < o->count; k++)
        worst = o->run[k].verdict.grade > worst ? o->run[k].verdict.grade : worst;
    sf_html_banner(page,
                   worst == SF_GRADE_VALID     ? "good"
                   : worst == SF_GRADE_REMARKS ? "fair"
                                               : "bad",
                   sf_verdict_phrase(worst), "The worst verdict of %d runs. Indicative, not a certification.",
                   o->count);
    char *svg = sf_chart_svg(&o->output, "compare", "softfall-post", warning, sizeof warning);
    sf_html_figure(page, svg, "%s.",
                   svg ? "Deceleration from first contact on, filtered with CFC 1000" : warning);
    free(svg);
    sf_html_heading(page, "Figures");
    put_table(page, o);
    sf_html_note(page, "compare.csv has every figure of summary.json.");
    put_remarks(page, o);
    sf_html_heading(page, "The command that repeats this report");
    sf_html_pre(page, o->command);
    return sf_html_end(page, "softfall-post " SF_VERSION " (" SF_GIT_REVISION ")", err);
}

static sf_status run(overlay *o, sf_error *err) {
    char warning[320] = "";
    if (sf_staging_check(o->directory, names, o->force, err) != SF_OK)
        return err->status;
    for (int k = 0; k < o->count; k++)
        SF_TRY(read_run(&o->run[k], err));
    if (sf_staging_begin(o->directory, names, o->force, &o->output, err) != SF_OK ||
        write_csv(o, err) != SF_OK || write_picture(o, warning, sizeof warning, err) != SF_OK ||
        write_page(o, err) != SF_OK || sf_staging_commit(&o->output, err) != SF_OK)
        return err->status;
    printf("Written: %s/report.html, compare.csv%s\n", o->directory,
           *warning ? "" : ", compare.png (compare.gp)");
    fflush(stdout);
    const sf_sink sink = sf_program_sink("softfall-post");
    if (*warning)
        sf_sink_tell(&sink, SF_WARNING, "%s", warning);
    return SF_OK;
}

static void release(overlay *o) {
    sf_staging_end(&o->output);
    for (int k = 0; k < o->count; k++)
        if (o->run[k].open) {
            sf_figures_free(&o->run[k].figures);
            sf_results_close(&o->run[k].results);
        }
    free(o->command);
}

int sf_overlay_main(int argc, char **argv) {
    static const struct argp_option known[] = {
        {"output", 'o', "DIR", 0, "write everything there (required)", 0},
        {"force", 'f', NULL, 0, "replace an earlier comparison in DIR", 0},
        {0}};
    static const struct argp parser = {.options = known,
                                       .parser = parse,
                                       .args_doc = "RESULTS RESULTS ... -o DIR",
                                       .doc = "Overlays runs: files results.h5, or folders that hold one."};
    static char name[] = "softfall-post compare";
    sf_error err = SF_ERROR_INIT;
    overlay *o = sf_alloc(&err, 1, sizeof *o, "the runs");
    if (o && sf_program_begin(argv, &err) == SF_OK) {
        o->command = sf_command_line(argc, argv);
        argv[1] = name;
        if (argp_parse(&parser, argc - 1, argv + 1, 0, NULL, o) != 0)
            SF_FAIL(&err, SF_ERR_INPUT, "the command line cannot be read");
        else if (!o->command)
            SF_FAIL(&err, SF_ERR_MEMORY, "out of memory for the command line");
        else
            run(o, &err);
    }
    if (o)
        release(o);
    free(o);
    return sf_error_report(&err, "softfall-post");
}
