/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Geometries that mean harm: none starts a program, none makes or changes a file, none hangs or takes the
 * memory, and each ends as a mesh or as one sentence. And a softfall-mesh that does anything, in place of the
 * real one. */
#include "check.h"
#include "program_fixture.h"

#include "pre/mesh/gmsh_session.h"
#include "pre/mesh/mesh_store.h"

#include <errno.h>
#include <seccomp.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>

#define BOX "SetFactory(\"OpenCASCADE\"); Box(1) = {0, 0, 0, 1, 1, 1};\nPhysical Volume(\"pad\") = {1};\n"
#define HARM "SystemCall \"touch harm\";\n"
#define NO_PROGRAM "tried to start a program"

enum { SECONDS = 3 }; /* of processor time, of which gmsh's start takes a part */

/* HOME and the present folder are the test's own. */
static int set_up(void **state) {
    const program_place *p = program_group_set_up(state);
    program_shell(p, "mkdir home work && mkfifo work/pipe");
    setenv("HOME", program_path(p, "home"), 1);
    return chdir(program_path(p, "work"));
}

static int tear_down(void **state) {
    return chdir("/") + program_group_tear_down(state);
}

/* Status of meshing the file in the present folder; `*nodes` of its pad. */
static sf_status mesh_file(const char *path, double seconds, int64_t *nodes, sf_error *err) {
    char copy[512];
    sf_gmsh *session = NULL;
    sf_mesh mesh = {0};
    snprintf(copy, sizeof copy, "%s", path);
    const sf_geo_source source = {.path = copy};
    if (sf_gmsh_begin(&session, err) == SF_OK) {
        session->limits.seconds = seconds;
        if (sf_gmsh_load(session, &source, err) == SF_OK)
            sf_gmsh_read_mesh(session, "pad", 1e-3, &mesh, err);
    }
    *nodes = mesh.node_count;
    sf_mesh_free(&mesh);
    sf_gmsh_end(&session);
    return err->status;
}

static void write_text(const char *name, const char *text) {
    FILE *file = fopen(name, "w");
    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
}

typedef struct attack {
    const char *text; /* of attack.geo */
    const char *says; /* part of the sentence that refuses it; NULL: it gives a mesh; behind '?': either,
                         as versions of gmsh differ */
} attack;

enum { CORNERS = 8 }; /* of the box: the fewest nodes of its mesh */

static void check(const program_place *p, const attack *a) {
    sf_error err = SF_ERROR_INIT;
    int64_t nodes = 0;
    bool or_mesh = a->says && *a->says == '?';
    const char *says = a->says ? a->says + or_mesh : NULL;
    write_text("attack.geo", a->text);
    char *before = program_list_files(p);
    sf_status status = mesh_file("attack.geo", SECONDS, &nodes, &err);
    char *after = program_list_files(p);
    assert_string_equal(before, after);
    free(before);
    free(after);
    if (status == SF_OK) {
        if (says && !or_mesh)
            fail_msg("%s\ngives a mesh and lacks '%s'", a->text, says);
        assert_true(nodes >= CORNERS);
        return;
    }
    if (!says)
        fail_msg("%s\nis refused: %s", a->text, err.text);
    if (!strstr(err.text, says))
        fail_msg("%s\ngives '%s' and lacks '%s'", a->text, err.text, says);
    if (strncmp(err.text, "attack.geo: ", 12) != 0 || strchr(err.text, '\n'))
        fail_msg("no sentence about attack.geo: %s", err.text);
    assert_int_equal(nodes, 0);
}

static void check_all(const program_place *p, const attack *list, size_t count) {
    for (size_t k = 0; k < count; k++)
        check(p, &list[k]);
}

#define CHECK_ALL(p, list) check_all(p, list, sizeof(list) / sizeof(list)[0])

static void programs_are_not_started(void **state) {
    static const attack list[] = {
        {HARM BOX, NO_PROGRAM},
        {"System \"touch harm\";\n" BOX, NO_PROGRAM},
        {"NonBlockingSystemCall \"touch harm\";\n" BOX, NO_PROGRAM},
        {BOX "MergeWithBoundingBox \"evil.txt\";\n", NO_PROGRAM},
        {BOX "Merge \"evil.Stl\";\n", NO_PROGRAM},
        {BOX "Merge \"evil.inp\";\n", NO_PROGRAM},
        {BOX "Include StrCat(\"evil\", \".txt\");\n", NO_PROGRAM},
        {BOX "Field[1] = ExternalProcess; Field[1].CommandLine = \"touch harm\"; Background Field = 1;\n",
         NO_PROGRAM},
        {BOX "OnelabRun(\"x\", \"touch harm\");\n", "?gmsh, reading: "},
        {BOX
         "General.TextEditor = \"touch harm\"; Solver.Executable0 = \"touch harm\"; Solver.AlwaysListen = 1;\n",
         "?gmsh"},
    };
    write_text("evil.txt", HARM);
    write_text("evil.Stl", HARM);
    write_text("evil.inp", HARM);
    CHECK_ALL(*state, list);
}

static void files_are_not_written(void **state) {
    static const attack list[] = {
        {BOX "Save \"harm.msh\";\n", "it tried to write harm.msh"},
        {BOX "Mesh 3; Save \"evil.stl\";\n", "it tried to write evil.stl"},
        {BOX "Printf(\"x\") > \"harm\";\n", "it tried to write harm"},
        {BOX "Printf(\"x\") >> \"evil.txt\";\n", "it tried to write evil.txt"},
        {BOX "Print \"harm.png\";\n", "attack.geo"},
        {BOX "CreateDir \"harm\";\n", "?gmsh"},
        {BOX "Plugin(NewView).Run; Save View[0] \"harm.pos\";\n", "attack.geo"},
        {BOX "General.Verbosity = 99; Mesh.Algorithm = 9;\n", "?it tried to write "},
        {BOX "Mesh.Recombine3DAll = 1;\n", "?gmsh"},
        {BOX "General.SaveOptions = 2; General.SaveSession = 1; General.OptionsFileName = \"harm\";\n",
         "?gmsh"},
        {BOX "General.ErrorFileName = \"harm\"; General.LogFileName = \"harm\"; Error(\"x\");\n",
         "attack.geo"},
        {BOX "Mesh.SaveAll = 1; Geometry.AutoCoherence = 2; Geometry.ExactExtrusion = 0;\n", NULL},
    };
    CHECK_ALL(*state, list);
}

static void only_plain_files_are_read(void **state) {
    static const attack list[] = {
        {BOX "Include \"/dev/zero\";\n", "/dev/zero"},
        {BOX "Merge \"/dev/stdin\";\n", "/dev/stdin"},
        {BOX "Merge \"pipe\";\n", "pipe is not a plain file"},
        {BOX "Include \"/proc/kmsg\";\n", "/proc/kmsg"},
        {BOX "Merge \"/proc/self/mem\";\n", "/proc/self/mem"},
        {BOX "Include \"absent.geo\";\n", "absent.geo"},
        {BOX "Include \"attack.geo\";\n", "?gmsh"}, /* without end */
    };
    CHECK_ALL(*state, list);
}

/* Processor time (s) of the programs that have ended. */
static double processor_time(void) {
    struct rusage usage;
    assert_int_equal(getrusage(RUSAGE_CHILDREN, &usage), 0);
    return (double)(usage.ru_utime.tv_sec + usage.ru_stime.tv_sec);
}

static void work_has_an_end(void **state) {
    static const attack list[] = {
        {BOX "For i In {1:1e12}\nx = i;\nEndFor\n", "more than 3 s of processor time"},
        {BOX "a() = {};\nFor i In {1:1e9}\na() += {i:i+1000000};\nEndFor\n", "attack.geo"},
        {BOX "a() = {1:1e12};\n", "attack.geo"},
        {BOX "Macro again\nCall again;\nReturn\nCall again;\n", "?gmsh"},
        {BOX "Sleep 100000;\n", "?gmsh"},
        {BOX "Mesh.MeshSizeMax = 1e-4;\n", "attack.geo"},
        {BOX "Mesh.MeshSizeMax = 1e-300;\n", "?gmsh"},
        {BOX "Transfinite Curve {:} = 2000000000;\n", "attack.geo"},
        {"SetFactory(\"OpenCASCADE\"); Box(1) = {0, 0, 0, 1e300, 1e300, 1e300}; Physical Volume(\"pad\") = {1};\n",
         "?gmsh"},
        {"Exit;\n", "gmsh ended without a mesh"},
        {"Abort;\n", "it holds no mesh"},
    };
    double begin = processor_time();
    setenv("SOFTFALL_MEMORY_MB", "1500", 1);
    CHECK_ALL(*state, list);
    unsetenv("SOFTFALL_MEMORY_MB");
    assert_true(processor_time() - begin < 300);
}

/* gmsh's own language, all of it: what is confined need not be forbidden. */
static void everything_else_may_be_used(void **state) {
    static const attack list[] = {
        {BOX "Solver.AutoCheck = 0; Printf(\"a note\");\n", NULL},
        {BOX "Physical Volume(\"other\") = {1}; x = 1; Delete Physicals; Physical Volume(\"pad\") = {1};",
         NULL},
        {"SetFactory(\"OpenCASCADE\"); Box(1) = {0, 0, 0, 1, 1, 1};\nx = 1; Physical Volume(\"pad\") = {1};",
         NULL},
        {BOX "General.NumThreads = 4; Mesh.MaxNumThreads3D = 4; Mesh.Algorithm3D = 10;\n", NULL},
    };
    CHECK_ALL(*state, list);
}

/* ---- in place of softfall-mesh ---- */

static void check_mesher(const program_place *p, const char *script, const char *says) {
    sf_error err = SF_ERROR_INIT;
    int64_t nodes;
    const char *kept = getenv("SF_BIN_DIR");
    char bin[600];
    snprintf(bin, sizeof bin, "%s", kept ? kept : "");
    program_shell(
        p,
        "mkdir -p fake && rm -f fake/softfall-mesh && cat > fake/softfall-mesh <<'E'\n#!/bin/bash\n"
        "head -c 1 <&3 >/dev/null # the request, which softfall-pre could not send any more afterwards\n%s\nE\n"
        "chmod +x fake/softfall-mesh",
        script);
    setenv("SF_BIN_DIR", program_path(p, "fake"), 1);
    sf_status status = mesh_file("attack.geo", SECONDS, &nodes, &err);
    if (kept)
        setenv("SF_BIN_DIR", bin, 1);
    else
        unsetenv("SF_BIN_DIR");
    if (status == SF_OK || !strstr(err.text, says))
        fail_msg("%s\ngives '%s' and lacks '%s'", script, err.text, says);
}

static void a_process_that_fails_is_told(void **state) {
    static const char *const list[][2] = {
        {"kill -9 $$", "gmsh crashed (Killed)"},
        {"kill -SEGV $$", "gmsh crashed (Segmentation fault)"},
        {"kill -XCPU $$", "more than 3 s of processor time"},
        {"echo 'Error   : it is broken' >&2; kill -ABRT $$", "gmsh crashed (Aborted): it is broken"},
        {"exit 3", "gmsh ended without a mesh"},
        {"exit 0", "gmsh ended without a mesh"},
        {"printf 'sfmesh01' >&4; sleep 0.2; kill -9 $$", "gmsh crashed (Killed)"},
        {"printf 'sfmesh01' >&4", "cut or damaged"},
        {"head -c 100000 /dev/urandom >&4", "cut or damaged"},
        {"head -c 100000 /dev/zero >&4", "cut or damaged"},
        {"head -c 100000 /dev/urandom >&3; sleep 0.1", "gmsh ended without a mesh"},
        {"exec 0<&- 1>&- 2>&- 3>&- 4>&- 5>&-; exec sleep 1000", "gmsh closed its pipes, but did not end"},
        {"while printf '\\3\\0\\0\\0\\0\\0\\0\\0/absent\\0' >&3; do :; done", "without reading the answers"},
        {"exec sleep 1000", "gmsh waits without working"},
        {"while :; do :; done", "more than 3 s of processor time"},
        /* the number of the host as that of a spare, which would be killed in the end */
        {"printf \"$(printf '\\\\x%02x' $((PPID & 255)) $((PPID >> 8 & 255)) $((PPID >> 16)) 0)\" >&6; exit 3",
         "gmsh ended without a mesh"},
        {"kill -HUP $$", "interrupted (Hangup) while gmsh was at work"},
        {"yes 0123456789 | head -c 3000000 >&2; echo; echo last >&2", "gmsh ended without a mesh: last"},
    };
    write_text("attack.geo", BOX);
    for (size_t k = 0; k < sizeof list / sizeof list[0]; k++)
        check_mesher(*state, list[k][0], list[k][1]);
    setenv("SOFTFALL_MEMORY_MB", "100", 1);
    check_mesher(*state, "cat /dev/zero >&4", "does not fit into 0.1 GB");
    unsetenv("SOFTFALL_MEMORY_MB");
}

/* As nohup starts softfall-pre. */
static void an_ignored_signal_stays_ignored(void **state) {
    void (*before)(int) = signal(SIGHUP, SIG_IGN);
    check_mesher(*state, "kill -HUP $$; echo later >&2", "gmsh ended without a mesh: later");
    signal(SIGHUP, before);
}

/* In a process where the kernel knows no filters. */
static int mesh_without_filters(void) {
    scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ALLOW);
    sf_error err = SF_ERROR_INIT;
    int64_t nodes;
    if (seccomp_rule_add(filter, SCMP_ACT_ERRNO(EINVAL), SCMP_SYS(seccomp), 0) != 0 ||
        seccomp_rule_add(filter, SCMP_ACT_ERRNO(EINVAL), SCMP_SYS(prctl), 1,
                         SCMP_A0(SCMP_CMP_EQ, PR_SET_SECCOMP, 0)) != 0 ||
        seccomp_load(filter) != 0)
        return 2;
    if (mesh_file("attack.geo", SECONDS, &nodes, &err) != SF_ERR_IO ||
        !strstr(err.text, "SOFTFALL_UNCONFINED=1"))
        return 3;
    sf_error second = SF_ERROR_INIT;
    setenv("SOFTFALL_UNCONFINED", "1", 1);
    return mesh_file("attack.geo", SECONDS, &nodes, &second) == SF_OK && nodes > 0 ? 0 : 4;
}

static void without_filters_it_is_refused_unless_asked_for(void **state) {
    int status = 0;
    (void)state;
    write_text("attack.geo", BOX);
    pid_t child = fork();
    if (child == 0)
        _exit(mesh_without_filters());
    assert_int_equal(waitpid(child, &status, 0), child);
    assert_true(WIFEXITED(status));
    assert_int_equal(WEXITSTATUS(status), 0);
}

/* The model's file says what was read, and by what. */
static void what_was_read_is_listed(void **state) {
    const sf_geo_source source = {
        .path = (char[]){"outer.geo"}, .parameter_count = 1, .parameter = {{"size", 0.5}}};
    sf_error err = SF_ERROR_INIT;
    sf_gmsh *session = NULL;
    (void)state;
    write_text("outer.geo", BOX "Include \"inner.geo\";\nMesh.MeshSizeMax = size;\n");
    write_text("inner.geo", "DefineConstant[ size = 1 ];");
    sf_gmsh_begin(&session, &err);
    if (sf_gmsh_load(session, &source, &err) != SF_OK)
        fail_msg("%s", err.text);
    const char *files = session->files, *second = strchr(files, '\n');
    assert_non_null(second);
    assert_int_equal(strncmp(files, SF_GMSH_FILES_OF "\n", strlen(SF_GMSH_FILES_OF) + 1), 0);
    assert_non_null(strstr(files, " outer.geo\n"));
    assert_non_null(strstr(second, " inner.geo\n"));
    assert_null(strstr(files, SF_GMSH_UNKNOWN_FILES));
    assert_null(strstr(session->version, "unconfined"));
    setenv("SOFTFALL_UNCONFINED", "1", 1);
    const sf_geo_source plain = {.path = (char[]){"outer.geo"}};
    if (sf_gmsh_load(session, &plain, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_non_null(strstr(session->files, SF_GMSH_UNKNOWN_FILES "\n"));
    assert_non_null(strstr(session->version, "unconfined"));
    unsetenv("SOFTFALL_UNCONFINED");
    sf_gmsh_end(&session);
}

/* The first child process that there is, and their number. */
static int first_child(pid_t *first) {
    char path[64];
    int count = 0;
    long process;
    snprintf(path, sizeof path, "/proc/self/task/%d/children", (int)getpid());
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    while (fscanf(file, "%ld", &process) == 1)
        if (count++ == 0)
            *first = (pid_t)process;
    fclose(file);
    return count;
}

static int64_t load(sf_gmsh *session, const char *text) {
    const sf_geo_source source = {.path = (char[]){"attack.geo"}};
    sf_error err = SF_ERROR_INIT;
    sf_mesh mesh = {0};
    write_text("attack.geo", text);
    if (sf_gmsh_load(session, &source, &err) != SF_OK ||
        sf_gmsh_read_mesh(session, "pad", 1e-3, &mesh, &err) != SF_OK)
        fail_msg("%s", err.text);
    int64_t count = mesh.node_count;
    sf_mesh_free(&mesh);
    return count;
}

/* The spare softfall-mesh of a session has read none of the geometries before; one that was killed is
 * replaced; nothing is left of it. */
static void geometries_of_a_session_see_nothing_of_each_other(void **state) {
    static const char *const before = BOX "left = 1; Mesh.MeshSizeMax = 0.1;\n";
    static const char *const after = "If (Exists(left))\nAbort;\nEndIf\n" BOX;
    sf_error err = SF_ERROR_INIT;
    sf_gmsh *session = NULL;
    pid_t spare = 0, later = 0;
    (void)state;
    assert_int_equal(first_child(&spare), 0);
    assert_int_equal(sf_gmsh_begin(&session, &err), SF_OK);
    session->limits.spare = &session->spare;
    const int64_t alone = load(session, after);
    assert_int_equal(first_child(&spare), 1);
    for (int k = 0; k < 3; k++) {
        assert_true(alone > 0 && load(session, before) > alone);
        assert_int_equal(load(session, after), alone);
        assert_int_equal(first_child(&later), 1);
        assert_true(k == 1 ? later != spare : later == spare);
        spare = later;
        if (k == 0)
            kill(spare, SIGKILL);
    }
    sf_gmsh_end(&session);
    assert_int_equal(first_child(&spare), 0);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(programs_are_not_started),
        cmocka_unit_test(files_are_not_written),
        cmocka_unit_test(only_plain_files_are_read),
        cmocka_unit_test(everything_else_may_be_used),
        cmocka_unit_test(a_process_that_fails_is_told),
        cmocka_unit_test(an_ignored_signal_stays_ignored),
        cmocka_unit_test(without_filters_it_is_refused_unless_asked_for),
        cmocka_unit_test(what_was_read_is_listed),
        cmocka_unit_test(geometries_of_a_session_see_nothing_of_each_other),
    };
    const struct CMUnitTest slow[] = {
        cmocka_unit_test(work_has_an_end),
    };
    return check_slow() ? cmocka_run_group_tests(slow, set_up, tear_down)
                        : cmocka_run_group_tests(tests, set_up, tear_down);
}
