/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/view/overlay.h"

#include "io/h5_data.h"
#include "post/figures/verdict.h"
#include "post/view/axis.h"

#include "build_info.h"
#include "base/program.h"
#include "model/model.h"
#include "io/plain_file.h"
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

/* The last are of `softfall report' and of earlier versions: they do not outlive what they show. */
static const char *const names[] = {"compare.csv", "compare.json", "compare_curves.csv", "series.csv",
                                    "report.html", "compare.png",  "compare.gp",         NULL};

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
static sf_status write_curves(const overlay *o, sf_error *err) {
    SF_CSV_FILE(csv, &o->output, "compare_curves.csv", err);
    SF_CSV_PRINT_LINE(&csv, "run,time_ms,acceleration_cfc1000_g");
    for (int k = 0; k < o->count; k++) {
        const sf_series *s = &o->run[k].figures.filtered;
        double contact = o->run[k].results.contact_time;
        for (int64_t i = 0; i < s->count; i += s->count / CURVE_POINTS + 1)
            if (s->time[i] >= contact - 2e-3)
                SF_CSV_LINE(&csv, k + 1, 1e3 * (s->time[i] - contact), s->value[i]);
    }
    return sf_csv_close(&csv, err);
}

/* The runs, and their verdicts. */
static sf_status write_json(const overlay *o, sf_error *err) {
    char line[SF_VERDICT_LINE_SIZE];
    SF_JSON_FILE(json, &o->output, "compare.json", err);
    SF_JSON_TEXTS(&json, {"program", "softfall-post " SF_VERSION}, {"git_revision", SF_GIT_REVISION},
                  {"command_line", o->command});
    sf_json_open(&json, "runs", '[');
    for (int k = 0; k < o->count; k++) {
        SF_JSON_OBJECT(&json, NULL);
        sf_verdict_line(&o->run[k].verdict, line, sizeof line);
        SF_JSON_TEXTS(&json, {"name", o->run[k].name}, {"results", o->run[k].path},
                      {"grade", sf_verdict_phrase(o->run[k].verdict.grade)}, {"verdict", line});
    }
    sf_json_close(&json);
    sf_json_close(&json);
    return sf_staging_close(json.file, "compare.json", err);
}

static sf_status run(overlay *o, sf_error *err) {
    SF_TRY(sf_staging_check(o->directory, names, o->force, err));
    for (int k = 0; k < o->count && !o->series; k++)
        SF_TRY(read_run(&o->run[k], err));
    if (o->series)
        SF_TRY(read_series(o, err));
    if (sf_staging_begin(o->directory, names, o->force, &o->output, err) != SF_OK ||
        write_csv(o, err) != SF_OK || (o->series && write_series(o, err) != SF_OK) ||
        write_curves(o, err) != SF_OK || write_json(o, err) != SF_OK ||
        sf_staging_commit(&o->output, err) != SF_OK)
        return err->status;
    if (o->series)
        print_series(o);
    sf_log_print(stdout, "Written: %s/compare.csv, compare.json, compare_curves.csv%s\n", o->directory,
                 o->series ? ", series.csv" : "");
    printf("A page of them, to read or print: softfall report %s\n", o->directory);
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
