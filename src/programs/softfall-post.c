/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-post RESULTS -o DIR: injury figures, curves and ParaView files from a results.h5. */
#include "base/program.h"
#include "base/text.h"
#include "base/units.h"
#include "io/provenance.h"
#include "post/view/browser.h"
#include "post/view/csv.h"
#include "post/view/overlay.h"
#include "post/view/paraview.h"

#include <assert.h>
#include <string.h>

typedef struct options {
    const char *results_path;
    const char *directory;
    bool force;
    bool full;        /* doubles for ParaView */
    const char *film; /* name of the file; NULL: none is asked for */
    double view;      /* MB that view.html may have; 0: none */
    bool strict;      /* the exit status shows the verdict */
    sf_limits limits;
    double cfc;
    sf_signal_chain chain;
    bool comparing; /* --reference was given */
    bool tuned;     /* an option that needs --reference was given */
    sf_compare_options compare;
} options;

/* All resources of the program, released together. */
typedef struct job {
    sf_results results;
    sf_figures figures;
    sf_verdict verdict;
    sf_comparison comparison;
    sf_staging output;
    const char *names[20];        /* of every file that may be written */
    char data[SF_XDMF_NAME_SIZE]; /* of the data of pad.xdmf */
    char *command_line;
    sf_xdmf xdmf;
    char state_warning[512], view_warning[512];
} job;

/* ---- the command line ---- */

static sf_status read_filter(const char *option, const char *text, void *cfc, sf_error *err) {
    static const double classes[] = {60, 180, 600, 1000};
    bool number = sf_decimal_is(text, cfc);
    for (size_t k = 0; k < sizeof classes / sizeof classes[0]; k++)
        if (number && *(double *)cfc == classes[k])
            return SF_OK;
    return SF_REFUSE(err, "%s %s: the channel frequency classes are 60, 180, 600 and 1000%s", option, text,
                     strcmp(option, "--filter") == 0 ? "" : " (none: not filtered)");
}

static sf_status read_reference_filter(const char *option, const char *text, void *cfc, sf_error *err) {
    *(double *)cfc = 0;
    return strcmp(text, "none") == 0 ? SF_OK : read_filter(option, text, cfc, err);
}

static sf_status read_ms(const char *option, const char *text, void *time, sf_error *err) {
    double ms = NAN;
    if (!sf_decimal_is(text, &ms))
        return SF_REFUSE(err, "%s %s: expected a time in ms", option, text);
    *(double *)time = ms * 1e-3;
    return SF_OK;
}

static sf_status read_impact(const char *option, const char *text, void *impact, sf_error *err) {
    return sf_reference_parse_impact(option, text, impact, err);
}

static sf_status read_view(const char *option, const char *text, void *view, sf_error *err) {
    double *size = view;
    if (!sf_decimal_is(text, size) || !(*size >= 0 && *size <= SF_BROWSER_MOST_MB))
        return SF_REFUSE(err, "%s %s: expected a size from 0 to %d MB", option, text, SF_BROWSER_MOST_MB);
    return SF_OK;
}

static sf_status read_regions(const char *option, const char *text, void *values, sf_error *err) {
    sf_compare_options *compare = values;
    (void)option;
    free(compare->regions);
    compare->regions = NULL;
    return sf_regions_parse(text, &compare->regions, &compare->region_count, err);
}

/* A reader that calls a function of the library, whose sentences need no name of the option. */
#define READER(name, parse)                                                                                  \
    static sf_status name(const char *option, const char *text, void *member, sf_error *err) {               \
        (void)option;                                                                                        \
        return parse(text, member, err);                                                                     \
    }
READER(read_film, sf_paraview_check_film)
READER(read_mount, sf_signal_parse_mount)
READER(read_coupling, sf_signal_parse_coupling)
READER(read_range, sf_reference_parse_range)
READER(read_region, sf_region_parse)

#define AT(member) offsetof(options, member)
#define TUNES .group = 1, .noted = AT(tuned) /* in the group of --reference, which it needs */

static const sf_option list[] = {
    {"output", 'o', "DIR", "write everything there (required)", .member = AT(directory)},
    {"force", 0, NULL, "replace the output of an earlier run in DIR", .member = AT(force)},
    {"full", 0, NULL,
     "data of pad.xdmf as doubles, as in results.h5 (default: as floats, a third of the bytes)",
     .member = AT(full)},
    {"film", 0, "mp4|gif",
     "a film of the drop too, pad.mp4 or pad.gif, and pad.png, the picture at the peak, which the report then "
     "shows; by pvbatch (ParaView) and ffmpeg",
     .member = AT(film), .read = read_film, .is_optional = true},
    {"view", 0, "MB",
     "size that view.html may have (default 5; 0: do not write it); a larger model shows fewer frames, or its surface only",
     .member = AT(view), .read = read_view},
    {"filter", 0, "CFC", "channel frequency class: 60, 180, 600 or 1000 (default)", .member = AT(cfc),
     .read = read_filter},
    {"mount", 0, "F, DAMPING",
     "pass the model's acceleration through the mount of an accelerometer, a second-order system, before the filter: "
     "\"f = 420 Hz, damping = 0.05\" (default: rigid)",
     .member = AT(chain), .read = read_mount},
    {"coupling", 0, "TIME",
     "pass it through the high pass of a piezo chain with this time constant, such as \"0.2 s\" (default: none)",
     .member = AT(chain), .read = read_coupling},
    {"strict", 0, NULL,
     "exit status 8 if the verdict is \"valid with remarks\", 9 if it is \"do not use\"; it says nothing about limits that "
     "are exceeded",
     .member = AT(strict)},
    {"limit-g", 0, "G", "limit of a_max in g (default " SF_UNITS_QUOTE(SF_DEFAULT_LIMIT_G) ")",
     .member = AT(limits.a_max_g), .read = sf_program_read_limit},
    {"limit-hic", 0, "HIC", "limit of HIC (default " SF_UNITS_QUOTE(SF_DEFAULT_LIMIT_HIC) ")",
     .member = AT(limits.hic), .read = sf_program_read_limit},
    {"reference", 0, "CSV",
     "compare with a measured curve: columns such as time_ms and acceleration_g; `softfall read' makes such a file of any "
     "laboratory's",
     .member = AT(compare.reference.path), .group = 1, .noted = AT(comparing)},
    {"reference-filter", 0, "CFC",
     "filter of the measured curve: none if the file is filtered already (default: that of --filter)",
     .member = AT(compare.reference.cfc), .read = read_reference_filter, TUNES},
    {"reference-column", 0, "NAME", "heading of its acceleration, if several columns could be",
     .member = AT(compare.reference.column), TUNES},
    {"reference-columns", 0, "X,Y,Z",
     "headings of two or three axes: their resultant, each filtered, is the acceleration",
     .member = AT(compare.reference.columns), TUNES},
    {"reference-range", 0, "RANGE", "range of its channel, such as \"200 g\": a peak at its end is marked",
     .member = AT(compare.reference.range), .read = read_range, TUNES},
    {"reference-invert", 0, NULL,
     "its channel is inverted: positive must mean that the missile is slowed down",
     .member = AT(compare.reference.invert), TUNES},
    {"from", 0, "MS", "use the measured curve from there on, in ms of its time",
     .member = AT(compare.reference.from), .read = read_ms, TUNES},
    {"to", 0, "MS", "use it up to there", .member = AT(compare.reference.to), .read = read_ms, TUNES},
    {"impact", 0, "N", "use impact N of a record that has several", .member = AT(compare.reference.impact),
     .read = read_impact, TUNES},
    {"reference-zero", 0, NULL, "take the median before contact, an offset of the channel, away from it",
     .member = AT(compare.reference.zero), TUNES},
    {"window", 0, "A,B",
     "compare over A to B ms of the measured time (default: its HIC window); within the data",
     .member = AT(compare.window), .read = read_region, TUNES},
    {"regions", 0, "A-B,C-D,...", "compare over these regions too, in ms of the measured time",
     .member = AT(compare), .read = read_regions, TUNES},
    {"shift", 0, "MS", "model time = measured time + MS (default: align the contacts)",
     .member = AT(compare.shift), .read = read_ms, TUNES},
    {0},
};

static const char *find_fault(const sf_command *command) {
    const options *o = command->list[0].values;
    return o->results_path && o->directory ? NULL : "give a results file, and the output directory with -o";
}

static sf_status parse_command(int argc, char **argv, options *o, sf_error *err) {
    *o = (options){.cfc = 1000,
                   .view = 5,
                   .limits = SF_DEFAULT_LIMITS,
                   .compare = {.reference = {.cfc = NAN,
                                             .from = -INFINITY,
                                             .to = INFINITY,
                                             .column_option = "--reference-column",
                                             .filter_option = "--reference-filter ",
                                             .invert_option = "--reference-invert",
                                             .zero_option = "--reference-zero"},
                               .shift = NAN,
                               .window = {NAN, NAN}}};
    const sf_command command = {
        .program = "softfall-post",
        .operands = "RESULTS.h5 -o DIR\ncompare RESULTS RESULTS ... -o DIR\nseries RESULTS -o DIR",
        .meaning =
            "Injury figures, curves and ParaView files of a softfall drop.\vWrites view.html, summary.json, "
            "acceleration.csv, history.csv, section.csv, pad.xdmf and its data pad-....h5. Of a prescribed motion "
            "compression.csv instead of acceleration.csv. `softfall report DIR' makes a page of them. Open the drop in ParaView with paraview "
            "--script=pad_paraview.py, in that directory. The "
            "figures are indicative, not a certification.",
        .second = "expected one results file, found \"%s\" as well",
        .operand = AT(results_path),
        .fault = find_fault,
        .list = {{list, o}}};
    sf_command_parse(&command, argc, argv, err);
    if (!(o->compare.reference.from < o->compare.reference.to))
        SF_REFUSE(err, "--from %g and --to %g: the part of the measured curve has no length",
                  1e3 * o->compare.reference.from, 1e3 * o->compare.reference.to);
    if (isnan(o->compare.reference.cfc))
        o->compare.reference.cfc = o->cfc;
    if (o->tuned && !o->comparing)
        return SF_REFUSE(err, "--window, --regions, --shift and --reference-... need --reference");
    return err->status;
}

/* ---- the output ---- */

/* Every file that this program may write, and those that `softfall report' and earlier versions make of
 * them, which do not outlive what they show. The data of pad.xdmf are moved before it, and earlier ones
 * (pad.h5 of earlier versions) removed after it. Without a name of the data yet, pad.xdmf stands for them. */
static void name_output(job *j) {
    /* clang-format off */
    const char *const names[] = {
        j->data, "pad.xdmf", "pad_paraview.py", "pad.mp4", "pad.gif", "pad.png", "history.csv", "section.csv",
        "reference.csv", "compression.csv", "compression.gp", "compression.png", "acceleration.csv",
        "acceleration.gp", "acceleration.png", "view.html", "report.html", "summary.json", "pad.h5", NULL};
    /* clang-format on */
    static_assert(sizeof names == sizeof j->names, "as many as the job holds");
    memcpy(j->names, names, sizeof names);
    snprintf(j->data, sizeof j->data, "pad.xdmf");
}

static sf_status write_output(const options *o, job *j, sf_error *err) {
    bool section = false;
    const sf_comparison *comparison = o->comparing ? &j->comparison : NULL;
    const sf_xdmf_options xdmf = {j->command_line, o->full};
    const sf_summary summary = {
        o->results_path, o->compare.reference.path, j->command_line, &j->results, &j->figures, comparison,
        &j->verdict};
    name_output(j);
    if (sf_staging_begin(o->directory, j->names, o->force, &j->output, err) != SF_OK ||
        sf_csv_write_history(&j->output, &j->results, &j->figures, err) != SF_OK ||
        (j->figures.driven && sf_csv_write_compression(&j->output, &j->results, &j->figures, err) != SF_OK) ||
        (!j->figures.driven && sf_csv_write_acceleration(&j->output, &j->figures, err) != SF_OK) ||
        (comparison && sf_csv_write_reference(&j->output, comparison, &j->figures, err) != SF_OK) ||
        sf_section_write(&j->output, &j->results, &section, err) != SF_OK ||
        sf_xdmf_write(&j->output, &j->results, &xdmf, j->data, &j->xdmf, err) != SF_OK ||
        sf_paraview_write(&j->output, &j->results, &j->xdmf, j->state_warning, sizeof j->state_warning,
                          err) != SF_OK ||
        (o->film && sf_paraview_film(&j->output, o->film, err) != SF_OK))
        return err->status;
    if (!section)
        fprintf(stderr,
                "softfall-post: warning: no frame holds the von Mises stress at the peak: no section.csv\n");
    SF_TRY(sf_browser_write(&j->output, &summary, &j->xdmf, o->view, j->view_warning, sizeof j->view_warning,
                            err));
    SF_TRY(sf_summary_write(&j->output, &summary, err));
    SF_TRY(sf_staging_commit(&j->output, err));
    sf_xdmf_remove_old(o->directory, j->data);
    sf_summary_print(stdout, &summary);
    return SF_OK;
}

static void print_warnings(const job *j) {
    const char *const warnings[] = {j->state_warning, j->view_warning};
    const sf_sink sink = sf_program_sink("softfall-post");
    fflush(stdout);
    for (int k = 0; k < j->results.note_count; k++)
        sf_sink_tell(&sink, SF_WARNING, "%s", j->results.notes[k]);
    if (!j->figures.touched)
        sf_sink_tell(&sink, SF_WARNING, "the missile never touched the pad: there are no injury figures");
    else if (!j->figures.rebounded && !j->figures.driven)
        sf_sink_tell(&sink, SF_WARNING, "the run ended in contact: no rebound speed, the peak may lie ahead");
    for (int k = 0; k < 2; k++)
        if (*warnings[k])
            sf_sink_tell(&sink, SF_WARNING, "%s", warnings[k]);
}

static void print_files(const job *j) {
    static const struct {
        const char *name, *meaning;
    } files[] = {
        {"view.html", "the drop to turn, cut and play in a browser"},
        {"summary.json", "the figures"},
        {"acceleration.csv", "the filtered curve of a_max and HIC, from 5 ms before contact"},
        {"history.csv", "acceleration, speed, indentation, forces, energies over time"},
        {"compression.csv", "strain and nominal stress over time"},
        {"section.csv", "mid-section and profile under the axis at the peak"},
        {"reference.csv", "the measured curve, aligned"},
        {"pad.xdmf", "pad and missile for ParaView (with pad-....h5)"},
        {"pad_paraview.py", "opens them: paraview --script=pad_paraview.py"},
        {"pad.mp4", "film of the drop"},
        {"pad.gif", "film of the drop"},
        {"pad.png", "picture at the peak"},
    };
    printf("Files\n");
    for (size_t k = 0; k < sizeof files / sizeof files[0]; k++)
        if (sf_staging_has(&j->output, files[k].name))
            printf("  %s/%-18s %s\n", j->output.directory, files[k].name, files[k].meaning);
    printf("A page of them, to read or print: softfall report %s\n", j->output.directory);
}

static sf_status run(const options *o, job *j, sf_error *err) {
    if (!j->command_line)
        return SF_NO_MEMORY(err, "the command line");
    static const char *const known[] = {"pad.xdmf", "history.csv", "report.html", "summary.json", NULL};
    if (sf_staging_check(o->directory, known, o->force, err) != SF_OK || /* the rest when it is known */
        sf_results_open(o->results_path, &j->results, err) != SF_OK ||
        sf_layers_note_slip(&j->results, err) != SF_OK ||
        sf_figures_compute_through(&j->results, o->cfc, &o->chain, &j->figures, err) != SF_OK)
        return err->status;
    if (o->comparing && j->figures.driven)
        return SF_REFUSE(err, "%s cannot be compared: the missile's motion was prescribed", o->results_path);
    if (o->comparing && !j->figures.touched)
        return SF_REFUSE(err, "%s cannot be compared: the missile never touched the pad", o->results_path);
    sf_compare_options compare = o->compare;
    compare.left = j->figures.rebounded;
    compare.flight = j->figures.free_flight;
    bool glances =
        j->figures.turns && j->results.missile_direction[2] > -0.9; /* and keeps most of its speed */
    compare.reference.speed = glances ? 0 : j->figures.v0;
    if (o->comparing && sf_compare_run(&compare, &j->figures.filtered, &j->comparison, err) != SF_OK)
        return err->status;
    sf_verdict_compute(&j->results, &j->figures, &o->limits, &j->verdict);
    if (o->comparing)
        sf_comparison_judge(&j->comparison, j->figures.injury.hic.value, j->verdict.grade);
    SF_TRY(write_output(o, j, err));
    print_files(j);
    print_warnings(j);
    return SF_OK;
}

/* Exit status with --strict, by grade; no sf_status has these numbers. */
static const int strict_codes[] = {[SF_GRADE_VALID] = 0, [SF_GRADE_REMARKS] = 8, [SF_GRADE_DO_NOT_USE] = 9};

int main(int argc, char **argv) {
    if (argc > 1 && (strcmp(argv[1], "compare") == 0 || strcmp(argv[1], "series") == 0))
        return sf_overlay_main(argc, argv);
    options o;
    job j = {0};
    sf_error err = SF_ERROR_INIT;
    if (sf_program_begin(argv, &err) != SF_OK)
        return sf_error_report(&err, "softfall-post");
    if (parse_command(argc, argv, &o, &err) == SF_OK) {
        j.command_line = sf_command_line(argc, argv);
        run(&o, &j, &err);
    }
    sf_staging_end(&j.output);
    sf_comparison_free(&j.comparison);
    sf_figures_free(&j.figures);
    sf_results_close(&j.results);
    SF_FREE(j.command_line, o.compare.regions);
    int code = sf_error_report(&err, "softfall-post");
    return code == 0 && o.strict ? strict_codes[j.verdict.grade] : code;
}
