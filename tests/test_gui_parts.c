/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The parts of the window that need no window: activities, names of a geometry's parameters, programs that
 * run beside it, files that change, what is read from the programs' words, and the skin of a mesh. The window
 * itself: test_gui. */
#include "case/read.h"
#include "program_fixture.h"

#include "gui/session.h"
#include "io/process.h"
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>

/* ---- activities ---- */

static sf_activity follow(int count, const sf_event *events) {
    sf_activity a = SF_IDLE;
    for (int k = 0; k < count; k++)
        a = sf_activity_next(a, events[k]);
    return a;
}
#define FOLLOW(...)                                                                                          \
    follow((int)(sizeof((sf_event[]){__VA_ARGS__}) / sizeof(sf_event)), (sf_event[]){__VA_ARGS__})

static void run_goes_through_its_programs(void **state) {
    (void)state;
    assert_int_equal(FOLLOW(SF_PRESS_RUN), SF_PREPARING);
    assert_int_equal(FOLLOW(SF_PRESS_RUN, SF_CHILD_DONE), SF_RUNNING);
    assert_int_equal(FOLLOW(SF_PRESS_RUN, SF_CHILD_DONE, SF_CHILD_DONE), SF_REPORTING);
    assert_int_equal(FOLLOW(SF_PRESS_RUN, SF_CHILD_DONE, SF_CHILD_DONE, SF_CHILD_DONE), SF_DONE);
    assert_int_equal(FOLLOW(SF_PRESS_RUN, SF_CHILD_DONE, SF_CHILD_DONE, SF_CHILD_DONE, SF_PRESS_RUN),
                     SF_REPORTING);
    assert_int_equal(FOLLOW(SF_PRESS_MESH, SF_CHILD_DONE), SF_MESHED);
    assert_int_equal(FOLLOW(SF_PRESS_MESH, SF_CHILD_FAILED), SF_FAILED);
}

static void stop_leaves_what_can_be_resumed(void **state) {
    (void)state;
    assert_int_equal(FOLLOW(SF_PRESS_RUN, SF_CHILD_DONE, SF_PRESS_STOP), SF_STOPPING);
    assert_int_equal(FOLLOW(SF_PRESS_RUN, SF_CHILD_DONE, SF_PRESS_STOP, SF_CHILD_INTERRUPTED), SF_STOPPED);
    assert_int_equal(FOLLOW(SF_PRESS_RUN, SF_CHILD_DONE, SF_PRESS_STOP, SF_CHILD_INTERRUPTED, SF_PRESS_RUN),
                     SF_PREPARING);
    assert_int_equal(FOLLOW(SF_PRESS_STOP), SF_IDLE);
}

/* What had ended well by itself before it was asked to counts all the same, but only a run has results. */
static void stop_of_a_mesh_or_of_save_leaves_no_results(void **state) {
    (void)state;
    static const sf_event ends[] = {SF_CHILD_DONE, SF_CHILD_INTERRUPTED, SF_CHILD_FAILED};
    for (size_t k = 0; k < sizeof ends / sizeof ends[0]; k++) {
        assert_int_equal(FOLLOW(SF_PRESS_MESH, SF_PRESS_STOP, ends[k]), SF_STOPPED);
        assert_int_equal(FOLLOW(SF_PRESS_RUN, SF_PRESS_STOP, SF_PRESS_STOP, ends[k]), SF_STOPPED);
        assert_int_equal(FOLLOW(SF_PRESS_SAVE, SF_PRESS_STOP, ends[k]), SF_STOPPED);
    }
    assert_int_equal(FOLLOW(SF_PRESS_RUN, SF_CHILD_DONE, SF_PRESS_STOP, SF_PRESS_STOP, SF_CHILD_DONE),
                     SF_DONE);
}

static void a_busy_window_begins_nothing_else(void **state) {
    (void)state;
    for (int a = 0; a < SF_ACTIVITY_COUNT; a++)
        for (int k = 0; k < 2 && sf_activity_is_busy((sf_activity)a); k++)
            assert_int_equal(sf_activity_next((sf_activity)a, k ? SF_PRESS_MESH : SF_PRESS_RUN), a);
    assert_int_equal(FOLLOW(SF_PRESS_RUN, SF_EDIT), SF_PREPARING);
    assert_int_equal(FOLLOW(SF_PRESS_MESH, SF_CHILD_DONE, SF_EDIT), SF_IDLE);
}

/* ---- names ---- */

static const char *name_of(const sf_geo_names *names, const char *variable) {
    for (int k = 0; k < names->count; k++)
        if (strcmp(names->name[k].variable, variable) == 0)
            return names->name[k].name;
    return "";
}

static void parameters_are_found_in_the_text(void **state) {
    sf_geo_names *names = calloc(1, sizeof *names);
    (void)state;
    sf_geo_names_scan("// a = {1, Name \"no\"};\n/* b = {1, Name \"no\"} */\n"
                      "DefineConstant[ thick_1 = {50, Min 10, Max 200, Name \"Pad/2 Thickness [mm]\"},\n"
                      "  silent = 3, half = {0, Choices{0, 1=\"one\"}, Name \"Pad/half\"} ];\n"
                      "r = DefineNumber[ 4, Name \"Missile/radius\" ];\nPrintf(\"Name\");\n",
                      names);
    assert_int_equal(names->count, 3);
    assert_string_equal(name_of(names, "thick_1"), "Pad/2 Thickness [mm]");
    assert_string_equal(name_of(names, "half"), "Pad/half");
    assert_string_equal(name_of(names, "r"), "Missile/radius");
    free(names);
}

static void included_files_count_too(void **state) {
    const program_place *p = *state;
    sf_geo_names *names = calloc(1, sizeof *names);
    sf_error err = SF_ERROR_INIT;
    program_write_text(p, "part.geo", "DefineConstant[ w = {1, Name \"Part/width\"} ];\n");
    assert_int_equal(
        sf_geo_names_read(program_write_text(p, "whole.geo", "Include \"part.geo\";\n"), names, &err), SF_OK);
    assert_string_equal(name_of(names, "w"), "Part/width");
    free(names);
}

/* ---- programs ---- */

static int await(sf_child *child) {
    int code = -1;
    for (int k = 0; k < 500 && !sf_child_poll(child, &code); k++)
        usleep(20000);
    return code;
}

static sf_child begin(const program_place *p, const char *command, FILE **log) {
    char line[1024];
    const char *const arguments[] = {"sh", "-c", line, NULL};
    sf_child child = {0};
    sf_error err = SF_ERROR_INIT;
    snprintf(line, sizeof line, "cd '%s' && { %s; }", p->folder, command);
    *log = fopen(program_path(p, "log"), "w");
    assert_int_equal(sf_child_start(&child, arguments, *log, &err), SF_OK);
    return child;
}

static void a_child_runs_beside(void **state) {
    const program_place *p = *state;
    FILE *log;
    sf_child child = begin(p, "cat; echo said; exit 3", &log);
    assert_int_equal(await(&child), 3);
    fclose(log);
    assert_string_equal(program_shell(p, "cat log").out, "said\n");
}

static void a_program_that_is_not_there_has_its_reason(void **state) {
    (void)state;
    const char *const none[] = {"softfall-no-such-program", NULL};
    sf_child child = {0};
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_child_start(&child, none, stderr, &err), SF_ERR_IO);
    assert_non_null(strstr(err.text, "softfall-no-such-program"));
    assert_non_null(strstr(err.text, strerror(ENOENT)));
    assert_int_equal(child.process, 0);
}

static void await_file(const program_place *p, const char *name) {
    for (int k = 0; k < 200 && program_shell(p, "test -s %s", name).code != 0; k++)
        usleep(50000);
}

/* A process that nobody has waited for yet counts as gone. */
static bool is_gone(const program_place *p, const char *name) {
    for (int k = 0; k < 100; k++, usleep(50000))
        if (program_shell(p, "grep -qs '^State:.[^ZX]' /proc/$(cat %s)/status", name).code != 0)
            return true;
    return false;
}

static void the_end_reaches_what_a_child_has_started(void **state) {
    const program_place *p = *state;
    FILE *log;
    sf_child child = begin(p, "sleep 31.25 & echo $! > grandchild; trap '' TERM; wait; sleep 31.5", &log);
    await_file(p, "grandchild");
    sf_child_end(&child, 0.3);
    fclose(log);
    assert_int_equal(child.process, 0);
    assert_true(is_gone(p, "grandchild"));
}

static void a_child_ends_with_its_parent(void **state) {
    const program_place *p = *state;
    pid_t parent = fork();
    if (parent == 0) {
        FILE *log;
        begin(p, "echo $$ > orphan; exec sleep 31.75", &log);
        pause();
    }
    await_file(p, "orphan");
    kill(parent, SIGKILL);
    waitpid(parent, NULL, 0);
    assert_true(is_gone(p, "orphan"));
}

/* ---- words and files ---- */

static void the_sentence_of_a_program_is_its_last(void **state) {
    char text[200];
    (void)state;
    sf_checks_sentence("softfall-pre: warning: one\nnodes 5\nsoftfall-pre: case.cfg:3: it is wrong\n\n", text,
                       sizeof text);
    assert_string_equal(text, "case.cfg:3: it is wrong");
    sf_checks_progress("1 node\nt   0.1 / 40 ms  step      1\nt   3.5 / 40 ms  step    12\nended\n", text,
                       sizeof text);
    assert_string_equal(text, "t 3.5 / 40 ms step 12");
}

/* Every entry of the branch Checks is the line of the printed table with the same name. */
static void the_checks_are_those_that_softfall_pre_printed(void **state) {
    const program_place *p = *state;
    static const char *const names[SF_CHECK_ENTRIES] = {"nodes",
                                                        "cells",
                                                        "missile",
                                                        "equivalent drop height",
                                                        "impact point",
                                                        "spacing under missile",
                                                        "expected mesh error",
                                                        "first time step, at least",
                                                        "memory of the solver",
                                                        "typical run time"};
    sf_check_entries checks;
    sf_error err = SF_ERROR_INIT;
    const char *example = getenv("SF_SOURCE_DIR");
    program_result r = program_succeed(p, "pre", "%s/examples/eva50-v4.5/case.cfg -o checks.h5 %s", example,
                                       program_coarse(12));
    assert_int_equal(sf_checks_read(program_path(p, "checks.h5"), &checks, &err), SF_OK);
    assert_int_equal(checks.count, SF_CHECK_ENTRIES);
    for (int k = 0; k < checks.count; k++) {
        char line[400], entry[SF_CHECK_NAME];
        snprintf(line, sizeof line, "%-26s%s\n", names[k], checks.entry[k].value);
        snprintf(entry, sizeof entry, "3Checks/%02d%s", k, names[k]);
        assert_string_equal(checks.entry[k].name, entry);
        assert_non_null(strstr(r.out, line));
        assert_true(strlen(checks.entry[k].value) > 2);
    }
    assert_int_equal(sf_checks_read(program_path(p, "none.h5"), &checks, &err), SF_ERR_IO);
}

static void a_file_that_changes_is_noticed_once(void **state) {
    const program_place *p = *state;
    sf_watch *watch = calloc(1, sizeof *watch);
    const char *path = program_write_text(p, "watched", "one");
    snprintf(watch->file[0].path, sizeof watch->file[0].path, "%s", path);
    watch->file[0].stamp = sf_watch_stamp_of(path);
    watch->count = 1;
    assert_null(sf_watch_changed(watch));
    program_write_text(p, "watched", "longer");
    assert_non_null(sf_watch_changed(watch));
    assert_null(sf_watch_changed(watch));
    remove(path); /* as editors do for a moment */
    assert_null(sf_watch_changed(watch));
    free(watch);
}

typedef struct heard {
    int count;
    char velocity[64], position[64];
} heard;

static void hear(void *user, const sf_case_value *value) {
    heard *h = user;
    h->count++;
    if (strcmp(value->name, "velocity") == 0)
        snprintf(h->velocity, sizeof h->velocity, "%s", value->text);
    if (strcmp(value->name, "position") == 0)
        snprintf(h->position, sizeof h->position, "%s%s", value->text, value->given ? " given" : " default");
}

static void every_value_of_a_case_is_told_as_it_can_be_set(void **state) {
    char path[1024];
    heard h = {0};
    const sf_case_listener listener = {hear, &h};
    const char *const overrides[] = {"missile.position=[\"0 mm\", \"0 mm\"]"};
    sf_case c;
    sf_error err = SF_ERROR_INIT;
    (void)state;
    snprintf(path, sizeof path, "%s/examples/eva50-v4.5/case.cfg", getenv("SF_SOURCE_DIR"));
    assert_int_equal(sf_case_read_values(&(sf_case_input){path, 1, 1, overrides}, NULL, &listener, &c, &err),
                     SF_OK);
    sf_case_free(&c);
    assert_in_range(h.count, 30, 200);
    assert_string_equal(h.velocity, "4.5 m/s");
    assert_string_equal(h.position, "[\"0 mm\", \"0 mm\"] given");
}

/* Neither a relative nor a root folder takes the place of one that is not there. */
static void without_a_place_for_runs_there_is_no_path(void **state) {
    const program_place *p = *state;
    char path[PATH_MAX] = "before";
    sf_error err = SF_ERROR_INIT;
    unsetenv("XDG_CACHE_HOME");
    setenv("HOME", "", 1);
    assert_int_equal(sf_cache_find(path, sizeof path, &err), SF_ERR_IO);
    assert_string_equal(path, "");
    assert_int_equal(program_shell(p, "mkdir -p taken/softfall && echo mine >taken/softfall/file").code, 0);
    setenv("XDG_CACHE_HOME", program_path(p, "taken"), 1);
    err = (sf_error)SF_ERROR_INIT;
    assert_int_equal(sf_cache_find(path, sizeof path, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "taken/softfall holds files and was not made by softfall"));
    assert_string_equal(path, "");
    setenv("XDG_CACHE_HOME", program_path(p, "free"), 1);
    err = (sf_error)SF_ERROR_INIT;
    assert_int_equal(sf_cache_find(path, sizeof path, &err), SF_OK);
    assert_string_equal(path + strlen(path) - strlen("/free/softfall"), "/free/softfall");
}

/* ---- the skin ---- */

/* Two cubes, one on the other: ten faces, and every node. */
static void the_skin_has_the_faces_of_one_cell_only(void **state) {
    double position[36];
    int32_t node[16];
    uint8_t type[2] = {SF_CELL_HEXAHEDRON, SF_CELL_HEXAHEDRON};
    int64_t ptr[3] = {0, 8, 16};
    sf_results r = {.node_count = 12,
                    .cell_count = 2,
                    .position = position,
                    .cell_type = type,
                    .cell_ptr = ptr,
                    .cell_node = node};
    sf_shape s;
    sf_error err = SF_ERROR_INIT;
    (void)state;
    for (int k = 0; k < 12; k++) {
        position[3 * k] = 1e-3 * (k % 4 == 1 || k % 4 == 2);
        position[3 * k + 1] = 1e-3 * (k % 4 >= 2);
        position[3 * k + 2] = 1e-3 * (k / 4);
    }
    for (int k = 0; k < 16; k++)
        node[k] = k < 8 ? k : k - 4;
    assert_int_equal(sf_shape_of_results(&r, 1e-3, &s, &err), SF_OK);
    assert_int_equal(s.pad.face_count, 10);
    assert_int_equal(s.pad.node_count, 12);
    assert_float_equal(s.pad.position[35], 2, 1e-12);
    sf_shape_free(&s);
}

/* The area of the missile's triangles that lie in the plane normal to an axis. */
static double area_in_plane(const sf_body *b, int axis) {
    double area = 0;
    for (int64_t t = 0; t < b->face_count; t++) {
        const double *p = &b->position[9 * t];
        double u[2], v[2];
        if (!(fabs(p[axis]) < 1e-9 && fabs(p[3 + axis]) < 1e-9 && fabs(p[6 + axis]) < 1e-9))
            continue;
        for (int k = 0; k < 2; k++) {
            int d = k == 0 ? 1 - axis : 2;
            u[k] = p[3 + d] - p[d];
            v[k] = p[6 + d] - p[d];
        }
        area += 0.5 * fabs(u[0] * v[1] - u[1] * v[0]);
    }
    return area;
}

/* A quarter of a hemisphere of one triangle: the section that the symmetry planes show is a quarter of a
 * circle. */
static void the_missile_is_closed_in_the_symmetry_planes(void **state) {
    double corner[] = {0.1, 0, 0, 0, 0.1, 0, 0, 0, -0.1};
    int32_t triangle[] = {0, 1, 2};
    sf_results r = {.surface_triangle_count = 1,
                    .surface_position = corner,
                    .surface_triangle = triangle,
                    .sphere_radius = 0.1};
    sf_shape s;
    sf_error err = SF_ERROR_INIT;
    (void)state;
    for (int planes = 0; planes < 2; planes++) {
        r.symmetry_place[0] = r.symmetry_place[1] = planes ? 0 : NAN;
        assert_int_equal(sf_shape_of_results(&r, 1e-3, &s, &err), SF_OK);
        assert_int_equal(s.missile.face_count, planes ? 16 + 8 : 16);
        for (int axis = 0; axis < 2; axis++)
            assert_true(fabs(area_in_plane(&s.missile, axis) - (planes ? 7854 : 0)) < 250);
        sf_shape_free(&s);
    }
}

/* A support of one triangle stands behind the missile's picture; a plane, larger than the pad, is left out.
 */
static void supports_are_shown_but_planes(void **state) {
    double corner[] = {0.1, 0, 0, 0, 0.1, 0, 0, 0, -0.1},
           support[] = {0, 0, -0.2, 0.1, 0, -0.2, 0, 0.1, -0.2, 9, 0, -0.3, -9, 0, -0.3, 0, 9, -0.3};
    int32_t triangle[] = {0, 1, 2, 3, 4, 5};
    sf_results r = {.node_count = 3,
                    .position = corner,
                    .surface_triangle_count = 1,
                    .surface_position = corner,
                    .surface_triangle = triangle,
                    .symmetry_place = {NAN, NAN},
                    .support_triangle_count = 2,
                    .support_position = support,
                    .support_triangle = triangle};
    int32_t node[] = {0, 1, 2, 2};
    uint8_t type = SF_CELL_TETRAHEDRON;
    int64_t ptr[2] = {0, 4};
    sf_shape s;
    sf_error err = SF_ERROR_INIT;
    (void)state;
    r.cell_count = 1;
    r.cell_type = &type;
    r.cell_ptr = ptr;
    r.cell_node = node;
    assert_int_equal(sf_shape_of_results(&r, 1e-3, &s, &err), SF_OK);
    assert_int_equal(s.missile_nodes, 3);
    assert_int_equal(s.missile.face_count, 2);
    for (int k = 0; k < 9; k++)
        assert_true(fabs(s.missile.position[9 + k] - 1e3 * support[k]) < 1e-9);
    sf_shape_free(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(run_goes_through_its_programs),
        cmocka_unit_test(stop_leaves_what_can_be_resumed),
        cmocka_unit_test(stop_of_a_mesh_or_of_save_leaves_no_results),
        cmocka_unit_test(a_busy_window_begins_nothing_else),
        cmocka_unit_test(parameters_are_found_in_the_text),
        cmocka_unit_test(included_files_count_too),
        cmocka_unit_test(a_child_runs_beside),
        cmocka_unit_test(a_program_that_is_not_there_has_its_reason),
        cmocka_unit_test(the_end_reaches_what_a_child_has_started),
        cmocka_unit_test(a_child_ends_with_its_parent),
        cmocka_unit_test(the_sentence_of_a_program_is_its_last),
        cmocka_unit_test(the_checks_are_those_that_softfall_pre_printed),
        cmocka_unit_test(a_file_that_changes_is_noticed_once),
        cmocka_unit_test(every_value_of_a_case_is_told_as_it_can_be_set),
        cmocka_unit_test(without_a_place_for_runs_there_is_no_path),
        cmocka_unit_test(the_skin_has_the_faces_of_one_cell_only),
        cmocka_unit_test(the_missile_is_closed_in_the_symmetry_planes),
        cmocka_unit_test(supports_are_shown_but_planes),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
