/* SPDX-License-Identifier: GPL-3.0-or-later */
/* include/softfall/softfall.h as a host sees it, against what the programs compute. */
#include "check.h"
#include "io/h5_data.h"
#include "program_fixture.h"

#include "model_fixture.h"
#include "softfall/softfall.h"
#include <fcntl.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include <cmocka.h>

static const char *const EXAMPLE = "examples/eva50-v4.5/case.cfg";
static const char *const coarse[] = {"geometry.parameters.fine_spacing=20.0",
                                     "geometry.parameters.outer_spacing=20.0",
                                     "geometry.missile_parameters.element_size=20.0",
                                     "pad.mesh_error_limit=1",
                                     "kernel.support_ratio=2.0",
                                     "material.HU=0.05",
                                     "material.memory.reload=0.4",
                                     "material.memory.set=0.05",
                                     "output.frame_interval=\"30 ms\""};
enum { COARSE = sizeof coarse / sizeof coarse[0] };

typedef struct place {
    program_place folder;
    softfall_model *model;
    softfall_drop *drop;
    int warnings;
} place;

static void count_warnings(void *user, softfall_severity severity, const char *sentence) {
    int *count = user;
    assert_int_equal(severity, SOFTFALL_WARNING);
    assert_true(strstr(sentence, "kernel.support_ratio") || strstr(sentence, "expected error of a_max"));
    ++*count;
}

/* One model and one drop, solved to its end, for all tests. */
static int set_up(void **state) {
    place *p = calloc(1, sizeof *p);
    softfall_error error;
    softfall_case *c = NULL;
    softfall_model *second = NULL;
    softfall_ending ending = SOFTFALL_RUNNING;
    assert_non_null(p);
    const softfall_sink sink = {count_warnings, &p->warnings};
    const softfall_drop_options options = {.threads = 2};
    program_set_up(&p->folder);
    *state = p;
    if (softfall_case_read(fixture_source(EXAMPLE), coarse, COARSE, &sink, &c, &error) != SOFTFALL_OK ||
        softfall_model_build(c, &sink, &p->model, &error) != SOFTFALL_OK ||
        softfall_drop_create(p->model, &options, &p->drop, &error) != SOFTFALL_OK ||
        softfall_drop_run(p->drop, NULL, NULL, &ending, &error) != SOFTFALL_OK)
        fail_msg("%s", error.text);
    assert_int_equal(ending, SOFTFALL_REBOUND);
    assert_int_equal(softfall_model_build(c, NULL, &second, &error), SOFTFALL_INPUT);
    assert_null(second);
    softfall_case_free(c);
    return 0;
}

static int tear_down(void **state) {
    place *p = *state;
    softfall_drop_free(p->drop);
    softfall_model_free(p->model);
    program_tear_down(&p->folder);
    free(p);
    return 0;
}

static void warnings_go_to_the_sink_and_errors_to_the_caller(void **state) {
    place *p = *state;
    softfall_case *c = NULL;
    softfall_model *m = NULL;
    softfall_error error;
    assert_int_equal(p->warnings, 2);
    assert_int_equal(softfall_case_read("absent.cfg", NULL, 0, NULL, &c, &error), SOFTFALL_INPUT);
    assert_null(c);
    assert_int_equal(error.status, SOFTFALL_INPUT);
    assert_non_null(strstr(error.text, "absent.cfg"));
    assert_int_equal(softfall_case_read("absent.cfg", NULL, 0, NULL, &c, NULL), SOFTFALL_INPUT);
    assert_int_equal(softfall_model_read("absent.h5", &m, &error), SOFTFALL_FILE);
    assert_null(m);
    softfall_case_free(NULL);
    softfall_model_free(NULL);
    softfall_drop_free(NULL);
}

static double figure(const softfall_figures *figures, const char *key) {
    softfall_error error;
    double value = 0;
    if (softfall_figure(figures, key, &value, &error) != SOFTFALL_OK)
        fail_msg("%s", error.text);
    return value;
}

static void the_programs_compute_the_same_figures_bit_for_bit(void **state) {
    const place *p = *state;
    softfall_error error;
    softfall_figures *ours, *theirs, *none;
    int count, same;
    assert_int_equal(softfall_model_write(p->model, program_path(&p->folder, "model.h5"), &error),
                     SOFTFALL_OK);
    program_succeed(&p->folder, "solve", "model.h5 -o results.h5 --threads 1");
    assert_int_equal(softfall_drop_figures(p->drop, 1000, &ours, &error), SOFTFALL_OK);
    assert_int_equal(softfall_results_figures(program_path(&p->folder, "results.h5"), 1000, &theirs, &error),
                     SOFTFALL_OK);
    const softfall_quantity *list = softfall_figures_list(ours, &count);
    softfall_figures_list(theirs, &same);
    assert_true(count > 40 && same == count);
    for (int k = 0; k < count; k++) {
        double a = figure(ours, list[k].name), b = figure(theirs, list[k].name);
        if (strcmp(list[k].name, "wall_s") != 0 && strcmp(list[k].name, "threads") != 0 &&
            memcmp(&a, &b, sizeof a) != 0)
            fail_msg("%s: %.17g, not %.17g", list[k].name, a, b);
    }
    assert_true(figure(ours, "local_collapse") > 0 && figure(ours, "cells") > 100);
    assert_int_equal(softfall_figures_grade(ours), softfall_figures_grade(theirs));
    assert_string_equal(softfall_figures_verdict(ours), softfall_figures_verdict(theirs));
    assert_true(softfall_figures_sure(ours) == softfall_figures_sure(theirs));
    assert_string_equal(softfall_figures_status(ours), "rebound");
    assert_string_equal(softfall_figures_status(theirs), "rebound");
    program_succeed(&p->folder, "post", "results.h5 -o out"); /* in the units of summary.json */
    for (int k = 0; k < count; k++) {
        double a = figure(theirs, list[k].name),
               b = program_file_number(&p->folder, "out/summary.json", list[k].name);
        if (isfinite(a) && isfinite(b) && !(fabs(a - b) <= 1e-8 * fabs(b)))
            fail_msg("%s is %.12g in the library and %.12g in summary.json", list[k].name, a, b);
    }
    assert_true(figure(ours, "hic") > 0 && figure(ours, "a_max_g") > 0);
    assert_true(figure(ours, "rebounded") == 1);
    double value = 1;
    assert_int_equal(softfall_figure(ours, "node", &value, &error), SOFTFALL_INPUT);
    assert_true(value == 1 && strstr(error.text, "unknown figure \"node\""));
    assert_int_equal(softfall_drop_figures(p->drop, 100, &none, &error), SOFTFALL_INPUT);
    assert_null(none);
    softfall_figures_free(ours);
    softfall_figures_free(theirs);
    softfall_figures_free(NULL);
}

/* A half sine of 100 g over 20 ms at 10 kHz: the long window takes the part above 3/5 of its mean. */
static void curves_of_the_host_are_evaluated_and_filtered(void **state) {
    (void)state;
    enum { COUNT = 201 };
    softfall_error error;
    double time[COUNT], value[COUNT], filtered[COUNT], hic[3], brief[3];
    for (int i = 0; i < COUNT; i++) {
        time[i] = 1e-4 * i;
        value[i] = 100 * sin(M_PI * i / (COUNT - 1));
    }
    assert_int_equal(softfall_hic(time, value, COUNT, INFINITY, hic, &error), SOFTFALL_OK);
    /* Closed form: 0.4146 T a^2.5 with (t2 - t1) = 0.6 T, about. */
    assert_true(fabs(hic[0] / (0.02 * pow(100, 2.5)) - 0.4146) < 1e-3 && fabs(hic[1] + hic[2] - 0.02) < 1e-6);
    assert_int_equal(softfall_hic(time, value, COUNT, 5e-3, brief, &error), SOFTFALL_OK);
    assert_true(brief[0] < hic[0]);
    assert_int_equal(softfall_cfc(time, value, COUNT, 60, filtered, &error), SOFTFALL_OK);
    assert_true(filtered[100] < 100 && filtered[100] > 90);
    assert_int_equal(softfall_cfc(time, value, COUNT, 100, filtered, &error), SOFTFALL_INPUT);
    assert_int_equal(softfall_cfc(time, value, 1, 60, filtered, &error), SOFTFALL_INPUT);
    assert_int_equal(softfall_hic(time, value, COUNT, 0, hic, &error), SOFTFALL_INPUT);
    time[7] = time[6];
    assert_int_equal(softfall_hic(time, value, COUNT, 1, hic, &error), SOFTFALL_INPUT);
    assert_true(isnan(hic[0]) && strlen(error.text) > 10);
}

/* The record of a half sine has the figures of its curve; one that is cut in the pulse is not to be used. */
static void a_measured_record_is_read_and_judged(void **state) {
    (void)state;
    static const char *const options[] = {"filter=none", "zero"}, *const wrong[] = {"fillter=600"};
    softfall_record *record;
    softfall_error error;
    double hic, peak;
    const double *time, *value;
    char path[] = "/tmp/softfall-record-XXXXXX";
    for (int cut = 0; cut < 2; cut++) {
        int handle = cut ? open(path, O_WRONLY | O_TRUNC) : mkstemp(path);
        FILE *file = fdopen(handle, "w");
        fputs("time [s],acceleration [g]\n", file);
        for (int i = -100; i < (cut ? 120 : 400); i++)
            fprintf(file, "%.6f,%.9g\n", 1e-4 * i, i > 0 && i < 200 ? 100 * sin(M_PI * i / 200) : 0.);
        fclose(file);
        assert_int_equal(softfall_record_read(path, options, 2, &record, &error), SOFTFALL_OK);
        assert_int_equal(softfall_record_grade(record), cut ? 2 : 0);
        assert_non_null(strstr(softfall_record_verdict(record), cut ? "cut in the pulse" : "valid"));
        assert_int_equal(softfall_record_curve(record, &time, &value), cut ? 220 : 500);
        assert_int_equal(softfall_record_figure(record, "hic", &hic, &error), SOFTFALL_OK);
        assert_int_equal(softfall_record_figure(record, "a_max_g", &peak, &error), SOFTFALL_OK);
        if (!cut) /* closed form as above */
            assert_true(fabs(hic / (0.02 * pow(100, 2.5)) - 0.4146) < 1e-3 && fabs(peak - 100) < 1e-9);
        assert_int_equal(softfall_record_figure(record, "hicc", &hic, &error), SOFTFALL_INPUT);
        softfall_record_free(record);
    }
    assert_int_equal(softfall_record_read(path, wrong, 1, &record, &error), SOFTFALL_INPUT);
    assert_true(record == NULL && strstr(error.text, "no option \"fillter\""));
    unlink(path);
    assert_int_equal(softfall_record_read(path, NULL, 0, &record, &error), SOFTFALL_INPUT);
}

/* Steps taken one by one, from a model that was written and read, are those of the run. */
static void a_drop_can_be_stepped_observed_and_stopped(void **state) {
    const place *p = *state;
    softfall_model *model = NULL;
    softfall_drop *drop = NULL;
    softfall_error error;
    softfall_figures *figures;
    softfall_ending ending;
    const softfall_drop_options options = {.threads = 1, .end_time = 1e-3};
    const double *time, *velocity;
    const char *path = program_path(&p->folder, "again.h5");
    assert_int_equal(softfall_model_write(p->model, path, &error), SOFTFALL_OK);
    assert_int_equal(softfall_model_read(path, &model, &error), SOFTFALL_OK);
    assert_int_equal(softfall_drop_create(model, &options, &drop, &error), SOFTFALL_OK);
    assert_int_equal(softfall_drop_steps(drop), 0);
    assert_true(isnan(softfall_drop_latest(drop, "time")));
    assert_int_equal(softfall_drop_figures(drop, 1000, &figures, &error), SOFTFALL_INPUT);
    do {
        assert_int_equal(softfall_drop_step(drop, &ending, &error), SOFTFALL_OK);
    } while (ending == SOFTFALL_RUNNING);
    const int64_t last = softfall_drop_steps(drop) - 1;
    const double end = softfall_drop_latest(drop, "time"), speed = softfall_drop_latest(drop, "velocity");
    assert_int_equal(ending, SOFTFALL_FINISHED);
    assert_true(end >= 1e-3 && end < 1.1e-3);
    assert_int_equal(softfall_drop_step(drop, NULL, &error), SOFTFALL_OK);
    assert_int_equal(softfall_drop_steps(drop), last + 1);
    assert_true(softfall_drop_history(p->drop, "time", &time) > last + 1);
    assert_true(softfall_drop_history(p->drop, "velocity", &velocity) > last + 1);
    assert_true(time[last] == end && velocity[last] == speed);
    assert_int_equal(softfall_drop_history(p->drop, "speed", &velocity), -1);
    softfall_drop_free(drop);
    softfall_model_free(model);
}

static int stop_at_third(void *user, const softfall_drop *drop) {
    (void)user;
    return softfall_drop_steps(drop) == 3;
}

static void an_observer_can_stop_a_run(void **state) {
    const place *p = *state;
    softfall_drop *drop = NULL;
    softfall_ending ending;
    assert_int_equal(softfall_drop_create(p->model, NULL, &drop, NULL), SOFTFALL_OK);
    assert_int_equal(softfall_drop_run(drop, stop_at_third, NULL, &ending, NULL), SOFTFALL_OK);
    assert_int_equal(ending, SOFTFALL_RUNNING);
    assert_int_equal(softfall_drop_steps(drop), 3);
    softfall_drop_free(drop);
}

/* At the end the fields are those of the last frame of softfall-solve. */
static void fields_are_those_of_the_frames(void **state) {
    const place *p = *state;
    softfall_error error;
    sf_error err = SF_ERROR_INIT;
    int count;
    const int64_t nodes = softfall_model_describe(p->model).node_count;
    const softfall_quantity *field = softfall_drop_fields(p->drop, &count);
    sf_h5 *file = program_open_h5(&p->folder, "results.h5");
    char last[32];
    assert_int_equal(
        sf_h5_group_member(file, "/frames", sf_h5_group_size(file, "/frames") - 1, last, sizeof last, &err),
        SF_OK);
    for (int k = 0; k < count; k++) {
        char path[128];
        void *expected = NULL;
        int64_t dims[2] = {nodes, field[k].components}, size = nodes * field[k].components;
        double *values = malloc((size_t)size * sizeof *values);
        snprintf(path, sizeof path, "/frames/%s/%s", last, field[k].name);
        assert_non_null(values);
        assert_int_equal(softfall_drop_field(p->drop, field[k].name, values, size, &error), SOFTFALL_OK);
        if (strcmp(field[k].name, "softening") == 0) { /* of later drops only */
            free(values);
            continue;
        }
        assert_int_equal(softfall_drop_field(p->drop, field[k].name, values, size - 1, &error),
                         SOFTFALL_INPUT);
        if (sf_h5_read(file, path, SF_H5_F64, dims[1] > 1 ? 2 : 1, dims, &expected, &err) != SF_OK)
            fail_msg("%s", err.text);
        assert_memory_equal(values, expected, (size_t)size * sizeof *values);
        free(expected);
        free(values);
    }
    assert_int_equal(count, SF_FRAME_FIELDS);
    assert_int_equal(softfall_drop_field(p->drop, "colour", NULL, 0, &error), SOFTFALL_INPUT);
    sf_h5_close(&file, &err);
}

/* The next drop on the pad that a drop has left is that of softfall-solve --start-from. */
static void the_next_drop_is_that_of_a_series(void **state) {
    const place *p = *state;
    softfall_drop *next = NULL, *none = NULL;
    softfall_error error;
    softfall_figures *first, *ours, *theirs;
    softfall_ending ending;
    int count;
    assert_int_equal(softfall_drop_next(p->drop, 0, &none, &error), SOFTFALL_INPUT);
    assert_non_null(strstr(error.text, "pause: 0 s is not above 0"));
    if (softfall_drop_next(p->drop, 90, &next, &error) != SOFTFALL_OK)
        fail_msg("%s", error.text);
    assert_int_equal(softfall_drop_next(next, 90, &none, &error), SOFTFALL_INPUT);
    assert_true(!none && strstr(error.text, "the drop before has not ended"));
    assert_int_equal(softfall_drop_run(next, NULL, NULL, &ending, &error), SOFTFALL_OK);
    assert_int_equal(ending, SOFTFALL_REBOUND);
    program_succeed(&p->folder, "solve",
                    "model.h5 -o second.h5 --start-from results.h5 --pause '90 s' --threads 1");
    assert_int_equal(softfall_drop_figures(p->drop, 1000, &first, &error), SOFTFALL_OK);
    assert_int_equal(softfall_drop_figures(next, 1000, &ours, &error), SOFTFALL_OK);
    assert_int_equal(softfall_results_figures(program_path(&p->folder, "second.h5"), 1000, &theirs, &error),
                     SOFTFALL_OK);
    const softfall_quantity *list = softfall_figures_list(ours, &count);
    for (int k = 0; k < count; k++) {
        double a = figure(ours, list[k].name), b = figure(theirs, list[k].name);
        if (isfinite(a) && strcmp(list[k].name, "wall_s") != 0 && strcmp(list[k].name, "threads") != 0)
            if (memcmp(&a, &b, sizeof a) != 0)
                fail_msg("%s: %.17g, not %.17g", list[k].name, a, b);
    }
    assert_true(figure(ours, "a_max_g") > 1.02 * figure(first, "a_max_g"));
    softfall_figures_free(first);
    softfall_figures_free(ours);
    softfall_figures_free(theirs);
    softfall_drop_free(next);
}

/* Two cases of one geometry mesh it once, and the drop of the second is that of its own mesh. */
static void meshes_are_shared(void **state) {
    const place *p = *state;
    softfall_case *c;
    softfall_model *model;
    softfall_error error;
    char folder[4096];
    snprintf(folder, sizeof folder, "%s", program_path(&p->folder, "shared"));
    unsetenv("SOFTFALL_SHARE"); /* which would stand before it */
    for (int k = 0; k < 2; k++) {
        assert_int_equal(softfall_case_read(fixture_source(EXAMPLE), coarse, COARSE, NULL, &c, &error),
                         SOFTFALL_OK);
        assert_int_equal(softfall_case_set_build(c, folder, 0, &error), SOFTFALL_OK);
        if (softfall_model_build(c, NULL, &model, &error) != SOFTFALL_OK)
            fail_msg("%s", error.text);
        const size_t nodes = (size_t)softfall_model_describe(model).node_count;
        assert_int_equal(nodes, softfall_model_describe(p->model).node_count);
        assert_memory_equal(softfall_model_positions(model), softfall_model_positions(p->model),
                            3 * nodes * sizeof(double));
        softfall_model_free(model);
        softfall_case_free(c);
        assert_int_equal(access(folder, R_OK), 0);
    }
}

/* The models of two programs differ in the last digits where their GSL calls another BLAS. */
static void assert_near(double a, double b) {
    if (!(fabs(a - b) <= 1e-9 * fabs(b)))
        fail_msg("%.17g, not %.17g", a, b);
}

/* A series whose second drop has a missile of its own: the figures of both are those of softfall-solve. */
static void a_series_has_missiles_of_its_own(void **state) {
    const place *p = *state;
    static const char *const set[] = {
        "geometry.parameters.fine_spacing=20.0", "geometry.parameters.outer_spacing=40.0",
        "pad.mesh_error_limit=1", "series.drops=( { }, { velocity = \"3.5 m/s\"; } )", "series.counted=[2]"};
    enum { SET = sizeof set / sizeof set[0] };
    char words[1024] = "";
    softfall_case *c = NULL, *later = NULL, *whole = NULL;
    softfall_model *model, *other;
    softfall_drop *first, *second;
    softfall_figures *ours, *theirs;
    softfall_error error;
    if (softfall_case_read(fixture_source("examples/series/case.cfg"), set, SET, NULL, &whole, &error) !=
            SOFTFALL_OK ||
        softfall_case_check(whole, &error) != SOFTFALL_OK ||
        softfall_case_read_drop(fixture_source("examples/series/case.cfg"), 1, set, SET, NULL, &c, &error) !=
            SOFTFALL_OK ||
        softfall_case_read_drop(fixture_source("examples/series/case.cfg"), 2, set, SET, NULL, &later,
                                &error) != SOFTFALL_OK)
        fail_msg("%s", error.text);
    const softfall_case_drop one = softfall_case_drop_get(whole, 1), two = softfall_case_drop_get(whole, 2);
    assert_true(softfall_case_data_end(whole, 0) > 0.5 && softfall_case_data_end(whole, 0) < 1);
    assert_true(isnan(softfall_case_data_end(whole, 1))); /* it has one foam */
    assert_true(one.drops == 2 && !one.counted && !one.own && two.counted && two.own && two.interval > 0);
    assert_int_equal(softfall_model_build(c, NULL, &model, &error), SOFTFALL_OK);
    assert_int_equal(softfall_model_build(later, NULL, &other, &error), SOFTFALL_OK);
    if (softfall_drop_create(model, NULL, &first, &error) != SOFTFALL_OK ||
        softfall_drop_run(first, NULL, NULL, NULL, &error) != SOFTFALL_OK ||
        softfall_drop_next_of(first, other, two.interval, &second, &error) != SOFTFALL_OK ||
        softfall_drop_run(second, NULL, NULL, NULL, &error) != SOFTFALL_OK)
        fail_msg("%s", error.text);
    for (int k = 0; k < SET; k++)
        snprintf(words + strlen(words), sizeof words - strlen(words), " --set '%s'", set[k]);
    program_succeed(&p->folder, "pre", "%s -o series.h5%s", fixture_source("examples/series/case.cfg"),
                    words);
    program_succeed(&p->folder, "solve", "series.h5 -o s.h5");
    assert_int_equal(softfall_drop_figures(second, 1000, &ours, &error), SOFTFALL_OK);
    assert_int_equal(softfall_results_figures(program_path(&p->folder, "s-2.h5"), 1000, &theirs, &error),
                     SOFTFALL_OK);
    assert_true(figure(ours, "v0_m_s") == 3.5);
    assert_near(figure(ours, "a_max_g"), figure(theirs, "a_max_g"));
    assert_near(figure(ours, "hic"), figure(theirs, "hic"));
    assert_string_equal(softfall_figures_verdict(ours), softfall_figures_verdict(theirs));
    softfall_figures_free(ours);
    softfall_figures_free(theirs);
    softfall_drop_free(second);
    assert_int_equal(softfall_drop_next_of(first, p->model, 90, &second, &error), SOFTFALL_INPUT);
    assert_non_null(strstr(error.text, "the pad of the model is not that of the drop before"));
    softfall_drop_free(first);
    softfall_model_free(model);
    softfall_model_free(other);
    softfall_case_free(c);
    softfall_case_free(later);
    softfall_case_free(whole);
}

/* Settings have their places. */
static void settings_are_read(void **state) {
    const place *p = *state;
    char *json;
    softfall_error error;
    const char *path = program_path(&p->folder, "plan.cfg");
    FILE *file = fopen(path, "w");
    fputs("case = \"a.cfg\";\nfactors = ( { count = 2; share = 0.1; } );\nflag = true;\n", file);
    fclose(file);
    assert_int_equal(softfall_settings_read(path, &json, &error), SOFTFALL_OK);
    assert_true(strstr(json, "\"a.cfg\"") && strstr(json, "plan.cfg:2") &&
                strstr(json, "0.10000000000000001"));
    softfall_text_free(json);
    assert_int_equal(softfall_settings_read("absent.cfg", &json, &error), SOFTFALL_INPUT);
    assert_null(json);
}

/* An axisymmetric drop in memory has the figures of its results file, those of its section's drops too. */
static void an_axisymmetric_drop_has_all_figures(void **state) {
    const place *p = *state;
    static const char *const set[] = {"geometry.parameters.fine_spacing=15.0", "pad.mesh_error_limit=1",
                                      "geometry.model=\"axisymmetric\"", "output.frame_interval=1000 s"};
    enum { SET = sizeof set / sizeof set[0] };
    softfall_case *c;
    softfall_model *model;
    softfall_drop *drop;
    softfall_figures *ours, *theirs;
    softfall_error error;
    int count = 0;
    char words[512] = "";
    if (softfall_case_read(fixture_source(EXAMPLE), set, SET, NULL, &c, &error) != SOFTFALL_OK ||
        softfall_case_set_build(c, NULL, 1, &error) != SOFTFALL_OK ||
        softfall_model_build(c, NULL, &model, &error) != SOFTFALL_OK ||
        softfall_drop_create(model, NULL, &drop, &error) != SOFTFALL_OK ||
        softfall_drop_run(drop, NULL, NULL, NULL, &error) != SOFTFALL_OK ||
        softfall_drop_figures(drop, 1000, &ours, &error) != SOFTFALL_OK)
        fail_msg("%s", error.text);
    for (int k = 0; k < SET; k++)
        snprintf(words + strlen(words), sizeof words - strlen(words), " --set '%s'", set[k]);
    program_succeed(&p->folder, "pre", "%s -o axi.h5%s", fixture_source(EXAMPLE), words);
    program_succeed(&p->folder, "solve", "axi.h5 -o a.h5");
    assert_int_equal(softfall_results_figures(program_path(&p->folder, "a.h5"), 1000, &theirs, &error),
                     SOFTFALL_OK);
    const softfall_quantity *list = softfall_figures_list(ours, &count);
    for (int k = 0; k < count; k++) {
        const char *key = list[k].name;
        const bool exact = strstr(key, "error") == NULL && strstr(key, "residual") == NULL;
        double a = figure(ours, key), b = figure(theirs, key);
        assert_int_equal(isfinite(a), isfinite(b));
        const double slack =
            strcmp(key, "rim_depth_mm") == 0 ? 0.05 : 1e-6; /* rounding chooses among equally near faces */
        if (isfinite(a) && exact && strcmp(key, "wall_s") != 0 && strcmp(key, "threads") != 0 &&
            fabs(a - b) > slack * fabs(b) + 1e-9)
            fail_msg("%s: %.17g, not %.17g", key, a, b);
    }
    assert_true(figure(ours, "a_max_mesh_error") > 0 && figure(ours, "hic_mesh_error") > 0);
    assert_int_equal(softfall_figures_grade(ours), softfall_figures_grade(theirs));
    softfall_figures_free(ours);
    softfall_figures_free(theirs);
    softfall_drop_free(drop);
    softfall_model_free(model);
    softfall_case_free(c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(meshes_are_shared),
        cmocka_unit_test(settings_are_read),
        cmocka_unit_test(an_axisymmetric_drop_has_all_figures),
        cmocka_unit_test(warnings_go_to_the_sink_and_errors_to_the_caller),
        cmocka_unit_test(the_programs_compute_the_same_figures_bit_for_bit),
        cmocka_unit_test(curves_of_the_host_are_evaluated_and_filtered),
        cmocka_unit_test(a_measured_record_is_read_and_judged),
        cmocka_unit_test(a_drop_can_be_stepped_observed_and_stopped),
        cmocka_unit_test(an_observer_can_stop_a_run),
        cmocka_unit_test(fields_are_those_of_the_frames),
        cmocka_unit_test(the_next_drop_is_that_of_a_series),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(a_series_has_missiles_of_its_own),
    };
    return check_slow() ? cmocka_run_group_tests(slow, set_up, tear_down)
                        : cmocka_run_group_tests(tests, set_up, tear_down);
}
