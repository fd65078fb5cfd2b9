/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Batches of drops: the manifest, its groups, drops that failed, and the engines. */
#include "check.h"
#include "program_fixture.h"

#include "study/batch.h"
#include "study/runner.h"
#include "io/folder.h"
#include "io/process.h"

#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include <cmocka.h>

enum { DROPS = 3 };
static const char *const COARSE = "geometry.parameters.spacing=25", *const SHORT = "solver.end_time=0.2 ms";
static const char *const DENSITY[DROPS] = {"material.density=40 kg/m3", "material.density=50 kg/m3",
                                           "material.density=60 kg/m3"};
static char bin[512], case_path[1024]; /* the programs themselves; the case */

/* A cube whose .geo merges a file, and programs that count their calls; the file fail makes softfall-solve
 * fail, the file crash end as by a signal of that number, the file wait makes it wait. */
static int set_up(void **state) {
    const program_place *p = program_group_set_up(state);
    snprintf(bin, sizeof bin, "%s", getenv("SF_BIN_DIR"));
    snprintf(case_path, sizeof case_path, "%s", program_path(p, "examples/compression/case.cfg"));
    int code = program_shell(
                   p,
                   "cp -r '%s/examples' '%s/geo' . && echo 'Merge \"size.geo\";' >> geo/cube.geo && "
                   "echo '// nothing' > geo/size.geo && mkdir -p tree/bin tree/share && cd tree/bin && "
                   "ln -s '%s/share' ../share/softfall && ln -s '%s'/softfall-batch '%s'/softfall-mesh . && "
                   "printf '#!/bin/sh\\necho pre >> \"%s/calls\"\\nexec \"%s/softfall-pre\" \"$@\"\\n' > "
                   "softfall-pre && printf '#!/bin/sh\\necho solve >> \"%s/calls\"\\n"
                   "test ! -e \"%s/fail\" || { echo \"softfall-solve: collapsed\"; exit 5; }\\n"
                   "test ! -e \"%s/crash\" || exit $((128 + $(cat \"%s/crash\")))\n"
                   "while test -e \"%s/wait\"; do sleep 0.05; done\\n"
                   "exec \"%s/softfall-solve\" \"$@\"\\n' > softfall-solve && chmod +x softfall-*",
                   getenv("SF_SOURCE_DIR"), getenv("SF_SOURCE_DIR"), getenv("SF_SOURCE_DIR"), bin, bin,
                   p->folder, bin, p->folder, p->folder, p->folder, p->folder, p->folder, bin)
                   .code;
    setenv("SF_BIN_DIR", program_path(p, "tree/bin"), 1);
    return code;
}

static void list_drops(sf_runner_drop *drop) {
    static const char *const label[DROPS] = {"first", "second", "third"};
    for (int k = 0; k < DROPS; k++)
        drop[k] = (sf_runner_drop){.label = label[k],
                                   .case_path = case_path,
                                   .override_count = 3,
                                   .overrides = {COARSE, SHORT, DENSITY[k]}};
}

/* Calls of a program since the last look. */
static int calls(const program_place *p, const char *name) {
    return atoi(program_shell(p, "grep -c '^%s$' calls", name).out);
}

static void forget_calls(const program_place *p) {
    program_shell(p, "rm -f calls; touch calls");
}

static void run(const char *folder, const sf_runner_engine *engine, int count, const sf_runner_drop *drop,
                sf_error *failure) {
    sf_error err = SF_ERROR_INIT;
    sf_runner runner = {.folder = folder, .threads = 2, .engine = *engine};
    if (sf_runner_run_each(&runner, count, drop, NULL, failure, &err) != SF_OK)
        fail_msg("%s", err.text);
}

/* A drop that failed is not simulated again, unless that is asked for or a file of its geometry has changed.
 */
static void a_failed_drop_is_skipped_until_it_is_asked_for(void **state) {
    const program_place *p = *state;
    sf_runner_drop drop[DROPS];
    sf_error failure[DROPS];
    char folder[600];
    const sf_runner_engine skip = {0}, again = {.retry = true};
    snprintf(folder, sizeof folder, "%s/failed", p->folder);
    list_drops(drop);
    program_shell(p, "touch fail");
    for (int k = 0; k < 2; k++) {
        forget_calls(p);
        run(folder, &skip, 1, drop, failure);
        assert_int_equal(failure[0].status, SF_ERR_NUMERIC);
        assert_non_null(strstr(failure[0].text, "softfall-solve: collapsed (exit code 5"));
        assert_int_equal(calls(p, "solve"), k == 0);
        assert_int_equal(calls(p, "pre"), k == 0);
    }
    program_shell(p, "echo '// other' > geo/size.geo");
    run(folder, &skip, 1, drop, failure);
    assert_int_equal(calls(p, "solve"), 1);
    forget_calls(p);
    program_shell(p, "rm fail");
    run(folder, &skip, 1, drop, failure);
    assert_int_equal(failure[0].status, SF_ERR_NUMERIC);
    assert_int_equal(calls(p, "solve"), 0);
    run(folder, &again, 1, drop, failure);
    assert_int_equal(failure[0].status, SF_OK);
    assert_int_equal(calls(p, "solve"), 1);
    run(folder, &skip, 1, drop, failure);
    assert_int_equal(failure[0].status, SF_OK);
    assert_int_equal(calls(p, "solve"), 1);
}

static void a_drop_that_is_twice_in_a_batch_fails_twice(void **state) {
    const program_place *p = *state;
    sf_runner_drop drop[DROPS];
    sf_error failure[2];
    char folder[600];
    snprintf(folder, sizeof folder, "%s/twice", p->folder);
    list_drops(drop);
    const sf_runner_drop twice[2] = {drop[0], drop[0]};
    forget_calls(p);
    program_shell(p, "touch fail");
    run(folder, &(sf_runner_engine){0}, 2, twice, failure);
    program_shell(p, "rm fail");
    assert_int_equal(failure[0].status, SF_ERR_NUMERIC);
    assert_int_equal(failure[1].status, SF_ERR_NUMERIC);
    assert_int_equal(calls(p, "solve"), 1);
}

/* Two groups of three drops; their keys. */
static void write_manifest(const char *path, const char *folder, sf_manifest *m) {
    sf_runner_drop drop[DROPS];
    uint64_t key[DROPS];
    const int index[DROPS] = {0, 1, 2};
    const sf_runner runner = {.folder = folder};
    sf_error err = SF_ERROR_INIT;
    list_drops(drop);
    for (int k = 0; k < DROPS; k++)
        sf_runner_key(&runner, &drop[k], &key[k], &err);
    if (err.status != SF_OK || sf_manifest_write(path, folder, DROPS, index, drop, key, 2, &err) != SF_OK ||
        sf_manifest_read(path, m, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_int_equal(m->count, DROPS);
    for (int k = 0; k < DROPS; k++) {
        assert_true(m->run[k].key == key[k]);
        assert_string_equal(m->run[k].drop.label, drop[k].label);
        assert_string_equal(m->run[k].drop.case_path, case_path);
        assert_null(m->run[k].drop.material);
        assert_int_equal(m->run[k].drop.override_count, 3);
        assert_string_equal(m->run[k].drop.overrides[2], DENSITY[k]);
    }
    assert_string_equal(m->run[0].group, m->run[1].group);
    assert_string_not_equal(m->run[0].group, m->run[2].group);
}

static void a_group_is_run_by_its_name_and_only_once(void **state) {
    const program_place *p = *state;
    sf_manifest m;
    char folder[600], path[700];
    snprintf(folder, sizeof folder, "%s/grouped", p->folder);
    snprintf(path, sizeof path, "%s/manifest.tsv", folder);
    program_shell(p, "mkdir grouped && touch grouped/.softfall-own");
    write_manifest(path, folder, &m);
    for (int again = 0; again < 2; again++) {
        forget_calls(p);
        program_succeed(p, "batch", "grouped/manifest.tsv --group %s", m.run[0].group);
        assert_int_equal(calls(p, "solve"), again ? 0 : 2);
        assert_int_equal(program_shell(p, "test -e grouped/%s.done", m.run[0].group).code, 0);
    }
    program_result list = program_succeed(p, "batch", "grouped/manifest.tsv");
    assert_non_null(strstr(list.out, "1 open, 0 running, 2 done, 0 failed\n"));

    program_shell(p, "touch fail");
    program_succeed(p, "batch", "grouped/manifest.tsv --group %s", m.run[2].group);
    program_shell(p, "rm fail");
    list = program_succeed(p, "batch", "grouped/manifest.tsv");
    assert_non_null(strstr(list.out, "0 open, 0 running, 2 done, 1 failed\n"));
    assert_non_null(strstr(list.out, "failed\tthird\tsoftfall-solve: collapsed"));

    program_result none = program_run(p, "batch", "grouped/manifest.tsv --group 00009-0");
    assert_int_equal(none.code, SF_ERR_INPUT);
    assert_non_null(strstr(none.err, "has no group 00009-0"));
    program_shell(p, "cp geo/cube.geo kept && echo '// otherwise' >> geo/cube.geo");
    none = program_run(p, "batch", "grouped/manifest.tsv --group %s", m.run[0].group);
    program_shell(p, "mv kept geo/cube.geo");
    assert_int_equal(none.code, SF_ERR_INPUT);
    assert_non_null(strstr(none.err, "the drop first is not the one of the manifest"));
    sf_manifest_free(&m);
}

/* A crash of softfall-solve comes again: its group is done. A process that somebody killed is no outcome, nor
 * is a program that does not start (127, that of the loader), as another machine may have its libraries. */
static void a_drop_that_crashes_is_done_and_one_that_is_killed_is_not(void **state) {
    const program_place *p = *state;
    static const struct {
        int above; /* 128, is the exit code of softfall-solve */
        sf_status expected;
    } crashes[] = {{SIGKILL, SF_ERR_LIBRARY}, {-1, SF_ERR_IO}, {SIGSEGV, SF_OK}};
    sf_manifest m;
    char folder[600], path[700];
    snprintf(folder, sizeof folder, "%s/crashed", p->folder);
    snprintf(path, sizeof path, "%s/manifest.tsv", folder);
    program_shell(p, "mkdir crashed && touch crashed/.softfall-own");
    write_manifest(path, folder, &m);
    for (int k = 0; k < 3; k++) {
        program_shell(p, "echo %d > crash", crashes[k].above);
        program_result r = program_run(p, "batch", "crashed/manifest.tsv --group %s", m.run[2].group);
        if (r.code != (int)crashes[k].expected)
            fail_msg("%d: exit code %d: %s%s", 128 + crashes[k].above, r.code, r.out, r.err);
        assert_int_equal(program_shell(p, "test -e crashed/%s.done", m.run[2].group).code,
                         crashes[k].expected == SF_OK ? 0 : 1);
    }
    program_shell(p, "rm crash");
    sf_error failure[1] = {SF_ERROR_INIT};
    sf_manifest_outcome_path(path, m.run[2].group, folder, sizeof folder);
    assert_true(sf_manifest_read_outcome(folder, 1, &m.run[2], failure) >= 0);
    assert_int_equal(failure[0].status, SF_ERR_LIBRARY);
    assert_non_null(strstr(failure[0].text, "(exit code 139"));
    sf_manifest_free(&m);
}

static void what_is_no_manifest_is_refused(void **state) {
    const program_place *p = *state;
    static const struct {
        const char *text, *part;
    } cases[] = {
        {"", "is not the manifest of a batch"},
        {"softfall-manifest 1\nfolder\t/\nruns\truns\ncount\t2\nabc\n",
         "bad.tsv:5: this is not the line of a run"},
        {"softfall-manifest 1\nfolder\t/\nruns\truns\ncount\t1000000000\n", "is not the manifest of a batch"},
        {"softfall-manifest 1\nfolder\t/\nruns\truns\ncount\t1\n0123456789abcdef\tg\t../up\tcase\t\n",
         "bad.tsv:5: this is not the line of a run"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        sf_error err = SF_ERROR_INIT;
        sf_manifest m;
        sf_manifest_read(program_write_text(p, "bad.tsv", cases[k].text), &m, &err);
        sf_manifest_free(&m);
        assert_int_equal(err.status, SF_ERR_INPUT);
        if (!strstr(err.text, cases[k].part))
            fail_msg("%zu: %s", k, err.text);
    }
    const sf_runner_drop tab = {.label = "a", .case_path = "case\t.cfg"};
    sf_error err = SF_ERROR_INIT;
    sf_manifest_write(program_path(p, "new.tsv"), "runs", 1, &(int){0}, &tab, &(uint64_t){1}, 1, &err);
    assert_int_equal(err.status, SF_ERR_INPUT);
    assert_int_not_equal(access(program_path(p, "new.tsv"), F_OK), 0);
}

static void an_engine_that_is_missing_is_named_with_its_package(void **state) {
    const program_place *p = *state;
    char *path = strdup(getenv("PATH"));
    static const struct {
        sf_runner_engine engine;
        const char *part;
    } cases[] = {
        {{.name = "snakemake"}, "Snakemake is not installed (package snakemake of Debian)"},
        {{.name = "make"}, "the engines are local and snakemake"},
        {{.profile = "slurm"}, "add --engine snakemake"},
        {{.per_job = 3}, "--per-job 3: jobs are Snakemake's: add --engine snakemake"},
    };
    setenv("PATH", program_path(p, "tree/bin"), 1);
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        sf_error err = SF_ERROR_INIT;
        sf_engine_check(&cases[k].engine, &err);
        if (!strstr(err.text, cases[k].part))
            fail_msg("%s", err.text);
    }
    setenv("PATH", path, 1);
    free(path);
}

static void assert_profile(const char *profile, sf_status status, const char *part) {
    const sf_runner_engine engine = {.name = "snakemake", .profile = profile};
    sf_error err = SF_ERROR_INIT;
    if (sf_engine_check(&engine, &err) != status || !strstr(err.text, part))
        fail_msg("--profile %s: status %d: %s", profile, (int)err.status, err.text);
}

/* With a Snakemake that only lies there, and then with such an sbatch. */
static void a_profile_is_looked_for_before_anything_is_started(void **state) {
    const program_place *p = *state;
    char *path = strdup(getenv("PATH"));
    program_shell(
        p, "mkdir -p only config/snakemake/known copy folder && touch config/snakemake/known/config.yaml "
           "'copy/config.v8+.yaml' && ln -s /bin/true only/snakemake");
    setenv("PATH", program_path(p, "only"), 1);
    setenv("XDG_CONFIG_HOME", program_path(p, "config"), 1);
    assert_profile("slurm", SF_ERR_IO, "(package slurm-client of Debian)");
    assert_profile("none", SF_ERR_INPUT, "--profile none: there is no such profile of Snakemake");
    assert_profile(program_path(p, "folder"), SF_ERR_INPUT, "no such profile");
    assert_profile(program_path(p, "copy"), SF_OK, "");
    assert_profile("known", SF_OK, "");
    unsetenv("XDG_CONFIG_HOME");
    assert_profile("known", SF_ERR_INPUT, "no such profile");
    setenv("PATH", path, 1);
    program_shell(p, "ln -s /bin/true only/sbatch");
    setenv("PATH", program_path(p, "only"), 1);
    assert_profile("slurm", SF_OK, "");
    setenv("PATH", path, 1);
    free(path);
}

/* What status.sh of the profile makes of the words of squeue. */
static void the_state_of_a_job_of_slurm_is_understood(void **state) {
    const program_place *p = *state;
    static const struct {
        const char *squeue, *says;
    } cases[] = {
        {"echo COMPLETED", "success\n"},
        {"echo RUNNING", "running\n"},
        {"echo PENDING", "running\n"},
        {"echo COMPLETING", "running\n"},
        {"echo REQUEUED", "running\n"},
        {"echo SUSPENDED", "running\n"},
        {"echo CANCELLED", "failed\n"},
        {"echo FAILED", "failed\n"},
        {"echo TIMEOUT", "failed\n"},
        {"echo NODE_FAIL", "failed\n"},
        {"echo OUT_OF_MEMORY", "failed\n"},
        {"echo PREEMPTED", "failed\n"},
        {"true", "failed\n"},
        {"echo slurm_load_jobs error: Invalid job id specified >&2; exit 1", "failed\n"},
        {"echo slurm_load_jobs error: Unable to contact slurm controller >&2; exit 1", "running\n"},
    };
    for (size_t k = 0; k < sizeof cases / sizeof *cases; k++) {
        program_result r = program_shell(p,
                                         "mkdir -p fake && printf '#!/bin/sh\n%s\n' > fake/squeue && "
                                         "chmod +x fake/squeue && "
                                         "PATH=\"$PWD/fake:$PATH\" '%s/share/slurm/status.sh' 7",
                                         cases[k].squeue, getenv("SF_SOURCE_DIR"));
        if (r.code != 0 || strcmp(r.out, cases[k].says) != 0)
            fail_msg("%s: %d, %s%s", cases[k].squeue, r.code, r.out, r.err);
    }
}

/* The history of each drop, byte by byte. */
static void assert_same_curves(const program_place *p, const char *one, const char *other) {
    program_result r = program_shell(p,
                                     "for d in '%s'/*-*/; do n=$(basename \"$d\"); "
                                     "'%s/softfall-post' '%s'/$n/results.h5 -o one --force >/dev/null && "
                                     "'%s/softfall-post' '%s'/$n/results.h5 -o other --force >/dev/null && "
                                     "cmp one/history.csv other/history.csv || exit 1; done",
                                     one, bin, one, bin, other);
    if (r.code != 0)
        fail_msg("%s %s", r.out, r.err);
}

/* A batch begun here is finished by Snakemake, with the same bits; what fails there is told here. */
static void snakemake_finishes_what_was_begun_here(void **state) {
    const program_place *p = *state;
    sf_runner_drop drop[DROPS];
    sf_error failure[DROPS];
    char here[600], there[600];
    const sf_runner_engine local = {0}, snakemake = {.name = "snakemake", .per_job = 2};
    check_programs("snakemake");
    snprintf(here, sizeof here, "%s/here", p->folder);
    snprintf(there, sizeof there, "%s/a: b {x}/there", p->folder); /* Snakemake's own syntax */
    program_shell(p, "mkdir 'a: b {x}'");
    list_drops(drop);
    run(here, &local, DROPS, drop, failure);
    run(there, &local, 1, drop, failure);
    program_shell(p, "touch fail");
    forget_calls(p);
    run(there, &snakemake, DROPS, drop, failure);
    program_shell(p, "rm fail");
    assert_int_equal(calls(p, "solve"), 2);
    assert_int_equal(failure[0].status, SF_OK);
    assert_int_equal(failure[2].status, SF_ERR_NUMERIC);
    assert_non_null(strstr(failure[2].text, "softfall-solve: collapsed"));
    forget_calls(p);
    const sf_runner_engine again = {.name = "snakemake", .per_job = 1, .retry = true};
    run(there, &again, DROPS, drop, failure);
    assert_int_equal(calls(p, "solve"), 2);
    for (int k = 0; k < DROPS; k++)
        assert_int_equal(failure[k].status, SF_OK);
    assert_same_curves(p, "here", "a: b {x}/there");
}

static void pause_briefly(void) {
    nanosleep(&(struct timespec){0, 50000000}, NULL);
}

/* Two drops that wait, by Snakemake from a process of its own with a lock of the folder; returns when one of
 * them is at work. */
static pid_t begin_elsewhere(const program_place *p, const char *folder) {
    sf_runner_drop drop[DROPS];
    sf_error failure[2], err = SF_ERROR_INIT;
    int lock = -1;
    forget_calls(p);
    program_shell(p, "touch wait; mkdir -p '%s'; touch '%s/.softfall-own'", folder, folder);
    pid_t child = fork();
    if (child == 0) {
        sf_runner runner = {
            .folder = folder, .threads = 2, .engine = {.name = "snakemake", .per_job = 1, .lock = &lock}};
        list_drops(drop);
        sf_process_handle_signals();
        if (sf_folder_lock(folder, &lock, &err) == SF_OK)
            sf_runner_run_each(&runner, 2, drop, NULL, failure, &err);
        _exit((int)err.status);
    }
    for (int k = 0; child > 0 && calls(p, "solve") == 0 && k < 2400; k++)
        pause_briefly();
    assert_int_not_equal(calls(p, "solve"), 0);
    return child;
}

/* Nobody else has the folder, at the latest in two minutes. */
static void wait_for_folder(const char *folder) {
    int lock = -1;
    for (int k = 0; lock < 0 && k < 120; k++) {
        sf_error err = SF_ERROR_INIT;
        sf_folder_lock(folder, &lock, &err);
    }
    assert_true(lock >= 0);
    close(lock);
}

/* A Snakemake whose campaign was killed goes on and holds its folder; what it did is found. One that is
 * interrupted with its campaign ends at once. */
static void snakemake_holds_the_folder_until_it_ends(void **state) {
    const program_place *p = *state;
    sf_runner_drop drop[DROPS];
    sf_error failure[DROPS], err = SF_ERROR_INIT;
    char folder[600];
    int lock = -1, status;
    check_programs("snakemake");
    snprintf(folder, sizeof folder, "%s/interrupted", p->folder);
    pid_t child = begin_elsewhere(p, folder);
    kill(child, SIGTERM);
    assert_true(waitpid(child, &status, 0) == child);
    assert_int_equal(WEXITSTATUS(status), SF_INTERRUPTED);
    wait_for_folder(folder);

    snprintf(folder, sizeof folder, "%s/orphaned", p->folder);
    child = begin_elsewhere(p, folder);
    kill(child, SIGKILL);
    assert_true(waitpid(child, &status, 0) == child);
    assert_int_equal(sf_folder_lock(folder, &lock, &err), SF_ERR_INPUT);
    assert_non_null(strstr(err.text, "another campaign is at work in"));
    program_shell(p, "rm wait");
    wait_for_folder(folder);
    forget_calls(p);
    list_drops(drop);
    run(folder, &(sf_runner_engine){0}, 2, drop, failure);
    assert_int_equal(calls(p, "solve"), 0);
    assert_int_equal(failure[0].status, SF_OK);
    assert_int_equal(failure[1].status, SF_OK);
}

/* As when a scheduler starts a job again before its first process has ended. */
static void two_processes_of_one_group_simulate_it_once(void **state) {
    const program_place *p = *state;
    sf_manifest m;
    char folder[600], path[700];
    snprintf(folder, sizeof folder, "%s/doubled", p->folder);
    snprintf(path, sizeof path, "%s/manifest.tsv", folder);
    program_shell(p, "mkdir doubled && touch doubled/.softfall-own");
    write_manifest(path, folder, &m);
    for (int turn = 0; turn < 4; turn += 2) { /* both begin at once, or one while the other simulates */
        forget_calls(p);
        program_result r = program_shell(
            p,
            "rm -rf doubled/first-* doubled/second-* doubled/shared; "
            "'%s/softfall-batch' doubled/manifest.tsv --group %s > first.log 2>&1 & sleep 0.%d; "
            "'%s/softfall-batch' doubled/manifest.tsv --group %s > second.log 2>&1; code=$?; "
            "wait $! || code=$?; cat first.log second.log; exit $code",
            getenv("SF_BIN_DIR"), m.run[0].group, turn, getenv("SF_BIN_DIR"), m.run[0].group);
        if (r.code != 0 || strstr(r.out, " failed: "))
            fail_msg("exit code %d: %s", r.code, r.out);
        assert_int_equal(calls(p, "solve"), 2);
        assert_int_equal(calls(p, "pre"), 2);
    }
    sf_manifest_free(&m);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_failed_drop_is_skipped_until_it_is_asked_for),
        cmocka_unit_test(a_drop_that_is_twice_in_a_batch_fails_twice),
        cmocka_unit_test(a_group_is_run_by_its_name_and_only_once),
        cmocka_unit_test(a_drop_that_crashes_is_done_and_one_that_is_killed_is_not),
        cmocka_unit_test(what_is_no_manifest_is_refused),
        cmocka_unit_test(an_engine_that_is_missing_is_named_with_its_package),
        cmocka_unit_test(a_profile_is_looked_for_before_anything_is_started),
        cmocka_unit_test(the_state_of_a_job_of_slurm_is_understood),
        cmocka_unit_test(two_processes_of_one_group_simulate_it_once),
        cmocka_unit_test(snakemake_holds_the_folder_until_it_ends),
        cmocka_unit_test(snakemake_finishes_what_was_begun_here),
    };
    return cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
