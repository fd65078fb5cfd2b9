/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/view/overlay.h"

#include "io/h5_data.h"
#include "post/view/report_picture.h"
#include "post/view/report.h"

#include "build_info.h"
#include "base/program.h"
#include "model/model.h"
#include "io/plain_file.h"
#include "report/chart.h"
#include "post/view/cut.h"
#include <argp.h>
#include <sys/stat.h>

enum { MOST_RUNS = 12, CURVE_POINTS = 2000 };

/* A run, evaluated as softfall-post does by default. */
typedef struct overlay_run {
    const char *name;    /* as given */
    char path[PATH_MAX]; /* of its results.h5 */
    int64_t drop;        /* of a series, from 1 */
    double pause;        /* s, of the pad before it */
    double place[2];     /* m, x and y of the missile's axis */
    sf_results results;
    sf_figures figures;
    sf_verdict verdict;
} overlay_run;

typedef struct overlay {
    const char *directory;
    bool force;
    bool series;
    int mean[2];                     /* first and last drop of the mean; 0: from the second on */
    char files[MOST_RUNS][PATH_MAX]; /* names of a series' drops */
    int count;
    overlay_run run[MOST_RUNS];
    sf_staging output;
    char *command;
} overlay;

static const char *const names[] = {"compare.csv", "compare.gp", "compare.png",
                                    "report.html", "series.csv", NULL};
static const char *const colours[MOST_RUNS] = {"#08519c", "#cb181d", "#238b45", "#6a51a3",
                                               "#d94801", "#17becf", "#8c6d31", "#525252",
                                               "#e7298a", "#66c2a4", "#fdae6b", "#9e9ac8"};
/* In the page; compare.csv has every figure. */
/* clang-format off */
static const char *const listed[] = {
    "a_max_g", "a_max_time_ms", "hic", "hic_t1_ms", "hic_t2_ms", "v0_m_s", "v_rebound_m_s",
    "absorbed_energy_fraction", "max_indentation_mm", "max_local_strain", "energy_error", "nodes", "steps"};
/* clang-format on */

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
    case 'm':
        if (sscanf(text, "%d-%d", &o->mean[0], &o->mean[1]) != 2 || o->mean[0] < 1 || o->mean[1] < o->mean[0])
            argp_error(state, "--mean %s: expected the first and the last drop, such as 2-3", text);
        return 0;
    case ARGP_KEY_END:
        if (o->count < (o->series ? 1 : 2) || !o->directory)
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
    return sf_path_print(r->path, sizeof r->path, err, "%s%s", r->name, folder ? "/results.h5" : "");
}

static sf_status read_run(overlay_run *r, sf_error *err) {
    const sf_limits limits = SF_DEFAULT_LIMITS;
    if (name_results(r, err) != SF_OK || sf_results_open(r->path, &r->results, err) != SF_OK)
        return err->status;
    SF_TRY(sf_figures_compute(&r->results, 1000, &r->figures, err));
    if (r->figures.driven || !r->figures.touched)
        return SF_REFUSE(err, "%s cannot be compared: %s", r->path,
                         r->figures.driven ? "the missile's motion was prescribed"
                                           : "the missile never touched the pad");
    sf_verdict_compute(&r->results, &r->figures, &limits, &r->verdict);
    return SF_OK;
}

/* ---- series ---- */

/* A whole number of the summary; 0: the file does not say. */
static sf_status read_count(const sf_h5 *file, const char *path, int64_t *value, sf_error *err) {
    *value = 0;
    return sf_h5_exists(file, path) ? sf_h5_read_one(file, path, SF_H5_I64, value, err) : err->status;
}

/* The files of a series whose first is given alone. */
static sf_status name_drops(overlay *o, sf_error *err) {
    int64_t drops = 0;
    SF_TRY(read_count(o->run[0].results.file, "/summary/drops", &drops, err));
    if (drops < 2 || drops > MOST_RUNS)
        return SF_REFUSE(err,
                         "%s is no series of 2 to %d drops (series.drops); name the files of drops that were "
                         "run one by one",
                         o->run[0].path, MOST_RUNS);
    for (o->count = 1; o->count < drops; o->count++) {
        sf_model_series_file(o->run[0].path, o->count + 1, o->files[o->count], PATH_MAX);
        o->run[o->count].name = o->files[o->count];
    }
    return SF_OK;
}

/* Each file must be the drop after the one before. */
static sf_status read_drop(overlay_run *r, int64_t number, sf_error *err) {
    int64_t before = 0, after = 0;
    if (number > 1 && read_run(r, err) != SF_OK)
        return err->status;
    SF_TRY(read_count(r->results.file, "/summary/drop", &r->drop, err));
    r->drop = r->drop > 0 ? r->drop : 1;
    if (r->drop != number)
        return SF_REFUSE(err, "%s is drop %lld on its pad, not drop %lld of this series", r->path,
                         (long long)r->drop, (long long)number);
    sf_axis_find(&r->results, r->place);
    if (number > 1 && read_count(r->results.file, "/summary/pad_before", &before, err) == SF_OK &&
        read_count(r[-1].results.file, "/summary/pad_after", &after, err) == SF_OK && before != after)
        return SF_REFUSE(
            err,
            "%s did not begin with the pad as %s left it: it is of another run, or one of the two "
            "was solved anew",
            r->path, r[-1].path);
    SF_TRY(err->status);
    return number > 1 ? sf_h5_read_scalar(r->results.file, "/summary/pause", &r->pause, err) : SF_OK;
}

static sf_status read_series(overlay *o, sf_error *err) {
    SF_TRY(read_run(&o->run[0], err));
    if (o->count == 1)
        SF_TRY(name_drops(o, err));
    for (int k = 0; k < o->count; k++)
        SF_TRY(read_drop(&o->run[k], k + 1, err));
    if (o->mean[0] == 0) {
        o->mean[0] = 2;
        o->mean[1] = o->count;
    }
    return o->mean[1] <= o->count
               ? SF_OK
               : SF_REFUSE(err, "--mean %d-%d: the series has %d drops", o->mean[0], o->mean[1], o->count);
}

static const char *const of_series[] = {"a_max_g", "hic", "v_rebound_m_s", "max_indentation_mm",
                                        "max_local_strain"};
enum { OF_SERIES = sizeof of_series / sizeof *of_series };

static double series_number(const overlay *o, int k, int figure) {
    return sf_figure_number(sf_figure_find(of_series[figure]), &o->run[k].results, &o->run[k].figures);
}

static double series_mean(const overlay *o, int figure) {
    double sum = 0;
    for (int k = o->mean[0] - 1; k < o->mean[1]; k++)
        sum += series_number(o, k, figure);
    return sum / (o->mean[1] - o->mean[0] + 1);
}

/* A row for each drop and one of the mean; growth is that over the first drop. */
static sf_status write_series(const overlay *o, sf_error *err) {
    SF_CSV_FILE(csv, &o->output, "series.csv", err);
    sf_csv_print(&csv, "drop,pause_s");
    for (int f = 0; f < OF_SERIES; f++)
        sf_csv_print(&csv, "%s,%s_growth", of_series[f], of_series[f]);
    SF_CSV_PRINT_LINE(&csv, "grade,v0_m_s,x_mm,y_mm");
    for (int k = 0; k <= o->count; k++) {
        bool mean = k == o->count;
        if (mean)
            sf_csv_print(&csv, "mean %d-%d,", o->mean[0], o->mean[1]);
        else
            sf_csv_print(&csv, "%d,%.9g", k + 1, o->run[k].pause);
        for (int f = 0; f < OF_SERIES; f++) {
            double value = mean ? series_mean(o, f) : series_number(o, k, f);
            sf_csv_print(&csv, "%.9g,%.6g", value, value / series_number(o, 0, f) - 1);
        }
        if (mean)
            SF_CSV_PRINT_LINE(&csv, ",,,");
        else
            SF_CSV_PRINT_LINE(&csv, "%s,%.9g,%.9g,%.9g", sf_verdict_phrase(o->run[k].verdict.grade),
                              o->run[k].figures.v0, 1e3 * o->run[k].place[0], 1e3 * o->run[k].place[1]);
    }
    return sf_csv_close(&csv, err);
}

/* The pad before each later drop. */
static void put_pads(FILE *page, const overlay *o) {
    for (int k = 1; k < o->count; k++) {
        sf_report_picture p = {0};
        sf_report_picture_before(&o->run[k].results, &p, SF_IGNORED);
        sf_html_figure(page, p.svg, "Drop %d. %s", k + 1, p.text);
        free(p.svg);
    }
}

static void put_series(FILE *page, const overlay *o) {
    sf_html_heading(page, "Drops of the series");
    sf_html_table t = sf_html_table_begin(page, NULL);
    sf_html_line(&t, "drop", "speed (m/s), place (mm)|a_max (g)|over the first|HIC|over the first");
    bool differ = false; /* in speed, mass or place */
    for (int k = 0; k <= o->count; k++) {
        sf_html_row(&t);
        const overlay_run *r = &o->run[k < o->count ? k : 0];
        differ = differ || r->figures.v0 != o->run->figures.v0 ||
                 r->results.missile_mass != o->run->results.missile_mass ||
                 memcmp(r->place, o->run->place, sizeof r->place) != 0;
        if (k == o->count) {
            sf_html_cell(&t, "mean of %d to %d", o->mean[0], o->mean[1]);
            sf_html_cell(&t, "–");
        } else {
            sf_html_cell(&t, "%d", k + 1);
            sf_html_cell(&t, "%.4g at (%.4g, %.4g)", r->figures.v0, 1e3 * r->place[0], 1e3 * r->place[1]);
        }
        for (int f = 0; f < 2; f++) {
            double value = k == o->count ? series_mean(o, f) : series_number(o, k, f);
            sf_html_cell(&t, "%.5g", value);
            sf_html_cell(&t, "%+.1f %%", 100 * (value / series_number(o, 0, f) - 1));
        }
    }
    sf_html_table_end(&t);
    sf_html_note(
        page,
        "series.csv has them too. What a material remembers is as good as its data: see "
        "material.memory.%s",
        differ ? " The drops differ in speed, mass or place: what grows over the first is not the foam's "
                 "softening alone."
               : "");
    put_pads(page, o);
}

static void print_series(const overlay *o) {
    for (int k = 0; k < o->count; k++)
        printf("drop %d: a_max %.1f g (%+.1f %%), HIC %.0f (%+.1f %%)\n", k + 1, series_number(o, k, 0),
               100 * (series_number(o, k, 0) / series_number(o, 0, 0) - 1), series_number(o, k, 1),
               100 * (series_number(o, k, 1) / series_number(o, 0, 1) - 1));
    printf("mean of drops %d to %d: a_max %.1f g, HIC %.0f\n", o->mean[0], o->mean[1], series_mean(o, 0),
           series_mean(o, 1));
}

/* ---- output ---- */

static void put_csv_row(sf_csv *csv, const overlay *o, const sf_figure *figure) {
    sf_csv_print(csv, "%s", figure->row.key);
    for (int k = 0; k < o->count; k++) {
        const overlay_run *r = &o->run[k];
        if (figure->row.type == SF_ROW_TEXT)
            sf_csv_quoted(
                csv, sf_row_value(&figure->row, sf_figure_record(figure, &r->results, &r->figures)).text);
        else
            SF_CSV_NUMBERS(csv, sf_figure_number(figure, &r->results, &r->figures));
    }
    sf_csv_end(csv);
}

/* A row for each figure, a column for each run. */
static sf_status write_csv(const overlay *o, sf_error *err) {
    SF_CSV_FILE(csv, &o->output, "compare.csv", err);
    sf_csv_print(&csv, "figure");
    for (int k = 0; k < o->count; k++)
        sf_csv_quoted(&csv, o->run[k].name);
    sf_csv_end(&csv);
    sf_csv_print(&csv, "grade");
    for (int k = 0; k < o->count; k++)
        sf_csv_print(&csv, "%s", sf_verdict_phrase(o->run[k].verdict.grade));
    sf_csv_end(&csv);
    for (size_t k = 0; k < SF_FIGURE_TOTAL; k++)
        put_csv_row(&csv, o, &sf_figure_at[k]);
    return sf_csv_close(&csv, err);
}

/* The filtered curves, their time from first contact. */
static sf_status write_picture(const overlay *o, char *warning, size_t size, sf_error *err) {
    sf_chart *chart = sf_chart_new("compare", 1600, 900, err);
    sf_panel *panel = sf_chart_panel(chart);
    sf_axis_label(&panel->x, "time from first contact (ms)");
    sf_axis_label(&panel->y, "deceleration (g)");
    panel->key = SF_KEY_TOP_RIGHT;
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
    return sf_chart_write(chart, &o->output, warning, size, err);
}

static void put_table(FILE *page, const overlay *o) {
    SF_HTML_TABLE t = sf_html_table_begin(page, NULL);
    SF_HTML_ROW(&t, "run");
    for (int k = 0; k < o->count; k++)
        sf_html_cell(&t, "%s", o->run[k].name);
    SF_HTML_ROW(&t, "verdict");
    for (int k = 0; k < o->count; k++)
        sf_html_cell(&t, "%s", sf_verdict_phrase(o->run[k].verdict.grade));
    for (size_t f = 0; f < sizeof listed / sizeof listed[0]; f++) {
        SF_HTML_ROW(&t, "%s", listed[f]);
        for (int k = 0; k < o->count; k++) {
            double value =
                sf_figure_number(sf_figure_find(listed[f]), &o->run[k].results, &o->run[k].figures);
            sf_html_cell(&t, isnan(value) ? "–" : "%.5g", value);
        }
    }
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
    sf_grade worst = SF_GRADE_VALID;
    FILE *page = sf_html_begin(&o->output, "Comparison of runs", NULL, err);
    SF_TRY(err->status);
    for (int k = 0; k < o->count; k++)
        worst = o->run[k].verdict.grade > worst ? o->run[k].verdict.grade : worst;
    sf_html_banner(page, sf_report_kind(worst), sf_verdict_phrase(worst),
                   "The worst verdict of %d runs. Indicative, not a certification.", o->count);
    sf_chart_figure(page, &o->output, "compare", "softfall-post",
                    "Deceleration from first contact on, filtered with CFC 1000");
    if (o->series)
        put_series(page, o);
    sf_html_heading(page, "Figures");
    put_table(page, o);
    sf_html_note(page, "compare.csv has every figure of summary.json.");
    put_remarks(page, o);
    return sf_html_end(page, o->command, "softfall-post " SF_VERSION " (" SF_GIT_REVISION ")", err);
}

static sf_status run(overlay *o, sf_error *err) {
    char warning[320] = "";
    SF_TRY(sf_staging_check(o->directory, names, o->force, err));
    for (int k = 0; k < o->count && !o->series; k++)
        SF_TRY(read_run(&o->run[k], err));
    if (o->series)
        SF_TRY(read_series(o, err));
    if (sf_staging_begin(o->directory, names, o->force, &o->output, err) != SF_OK ||
        write_csv(o, err) != SF_OK || (o->series && write_series(o, err) != SF_OK) ||
        write_picture(o, warning, sizeof warning, err) != SF_OK || write_page(o, err) != SF_OK ||
        sf_staging_commit(&o->output, err) != SF_OK)
        return err->status;
    if (o->series)
        print_series(o);
    sf_log_print(stdout, "Written: %s/report.html, compare.csv%s\n", o->directory,
                 *warning ? "" : ", compare.png (compare.gp)");
    const sf_sink sink = sf_program_sink("softfall-post");
    if (*warning)
        sf_sink_tell(&sink, SF_WARNING, "%s", warning);
    return SF_OK;
}

static void release(overlay *o) {
    sf_staging_end(&o->output);
    for (int k = 0; k < o->count; k++) {
        sf_figures_free(&o->run[k].figures);
        sf_results_close(&o->run[k].results);
    }
    free(o->command);
}

int sf_overlay_main(int argc, char **argv) {
    static const struct argp_option known[] = {
        {"output", 'o', "DIR", 0, "write everything there (required)", 0},
        {"force", 'f', NULL, 0, "replace an earlier comparison in DIR", 0},
        {"mean", 'm', "A-B", 0,
         "of a series: the drops whose mean counts (default: from the second to the last)", 0},
        {0}};
    static const struct argp parser = {
        .options = known,
        .parser = parse,
        .args_doc = "RESULTS RESULTS ... -o DIR",
        .doc = "Overlays runs: files results.h5, or folders that hold one. `series`: "
               "the drops on one pad, of which the first file names them all."};
    static char name[] = "softfall-post compare", name_of_series[] = "softfall-post series";
    sf_error err = SF_ERROR_INIT;
    SF_OWNED overlay *o = sf_alloc(&err, 1, sizeof *o, "the runs");
    if (o && sf_program_begin(argv, &err) == SF_OK) {
        o->command = sf_command_line(argc, argv);
        o->series = strcmp(argv[1], "series") == 0;
        argv[1] = o->series ? name_of_series : name;
        if (argp_parse(&parser, argc - 1, argv + 1, 0, NULL, o) != 0)
            SF_REFUSE(&err, "the command line cannot be read");
        else if (!o->command)
            SF_NO_MEMORY(&err, "the command line");
        else
            run(o, &err);
    }
    if (o)
        release(o);
    return sf_error_report(&err, "softfall-post");
}
