/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Drops of a campaign that is interrupted or killed: they go on where they were, with the bits of one run. */
#include "model_fixture.h"
#include "program_fixture.h"
#include "run_fixture.h"

#include "study/runner.h"
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>

#define SMALL_STEP "solver.step_safety=0.1" /* there is time to interrupt */
static const char *step_of_drops = SMALL_STEP;

static void run_drop(const program_place *p, const char *folder, sf_runner_result *result, sf_error *err) {
    char path[1024], source[1024];
    snprintf(path, sizeof path, "%s", program_path(p, folder));
    snprintf(source, sizeof source, "%s", fixture_source("examples/eva50-v4.5/case.cfg"));
    sf_runner runner = {.folder = path, .threads = 1};
    sf_runner_drop drop = {.case_path = source,
                           .label = "drop",
                           .override_count = 5,
                           .overrides = {"geometry.parameters.fine_spacing=20.0",
                                         "geometry.parameters.outer_spacing=20.0",
                                         "geometry.missile_parameters.element_size=20.0", step_of_drops,
                                         "pad.mesh_error_limit=1"}};
    sf_runner_run(&runner, &drop, result, err);
}

static void campaign_goes_on_with_an_interrupted_drop(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    sf_runner_result one, two;
    run_drop(p, "campaign_one", &one, &err);
    assert_int_equal(err.status, SF_OK);
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        setpgid(0, 0);
        signal(SIGTERM, SIG_IGN); /* the solver sets its own handler */
        run_drop(p, "campaign_two", &two, &err);
        _exit(err.status == SF_INTERRUPTED ? 0 : 1);
    }
    while (program_shell(p, "ls campaign_two/*/results.h5").code != 0)
        run_sleep(0.01);
    int status = 0;
    kill(-child, SIGTERM);
    waitpid(child, &status, 0);
    assert_int_equal(status, 0);
    assert_int_equal(program_shell(p, "ls campaign_two/*/results.h5.restart").code, 0);

    run_drop(p, "campaign_two", &two, &err);
    assert_int_equal(err.status, SF_OK);
    assert_false(two.reused);
    assert_memory_equal(&one.a_max_g, &two.a_max_g, sizeof one.a_max_g);
    assert_int_equal(sf_runner_figure(&one, "steps"), sf_runner_figure(&two, "steps"));
    const char *name = two.path + strlen(p->folder) + 1;
    assert_int_equal(run_restarts(p, name), 1);
    assert_int_equal(program_shell(p, "ls campaign_two/*").code, 0);
    assert_null(strstr(program_shell(p, "ls campaign_two/*").out, "restart"));
    assert_null(strstr(program_shell(p, "ls campaign_two/*").out, "model"));
    sf_runner_result_free(&one);
    sf_runner_result_free(&two);
}

/* A drop of a campaign that is killed with its programs (or alone) as soon as it has a new model or
 * checkpoint: each life goes on where the one before was killed, and none begins anew. */
static int count_lives(const program_place *p, const char *parent, const char *folder, bool alone) {
    for (int life = 1; life <= 150; life++) {
        struct timespec model = run_written_at(folder, "model.h5"),
                        checkpoint = run_written_at(folder, "results.h5.restart");
        int status = 0;
        pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0) {
            sf_error err = SF_ERROR_INIT;
            sf_runner_result result;
            setpgid(0, 0);
            run_drop(p, parent, &result, &err);
            _exit(err.status == SF_OK ? 0 : 1);
        }
        setpgid(child, child);
        while (waitpid(child, &status, WNOHANG) == 0)
            if (run_is_other(model, run_written_at(folder, "model.h5")) ||
                run_is_other(checkpoint, run_written_at(folder, "results.h5.restart")))
                kill(alone ? child : -child, SIGKILL);
            else
                run_sleep(0.001);
        if (WIFEXITED(status)) {
            assert_int_equal(WEXITSTATUS(status), 0);
            return life;
        }
        assert_false(life > 1 &&
                     run_is_other(model, run_written_at(folder, "model.h5"))); /* not made again */
    }
    return 0;
}

static void killed_campaign_makes_progress_in_every_life(void **state) {
    const program_place *p = *state;
    static const char *const parents[] = {"campaign_killed", "campaign_left"};
    sf_error err = SF_ERROR_INIT;
    sf_runner_result one, two;
    step_of_drops = "solver.step_safety=0.9"; /* each life has 0.1 s of wall time, on a busy machine little */
    run_drop(p, "campaign_one", &one, &err);
    assert_int_equal(err.status, SF_OK);
    char leaf[512], folder[1024];
    snprintf(leaf, sizeof leaf, "%s", strstr(one.path, "campaign_one/") + strlen("campaign_one/"));
    *strchr(leaf, '/') = '\0';
    for (int alone = 0; alone < 2; alone++) {
        snprintf(folder, sizeof folder, "%s/%s", program_path(p, parents[alone]), leaf);
        int lives = count_lives(p, parents[alone], folder, alone);
        print_message("%d lives\n", lives);
        assert_true(lives > 1);
        run_drop(p, parents[alone], &two, &err);
        assert_int_equal(err.status, SF_OK);
        assert_true(two.reused);
        assert_memory_equal(&one.a_max_g, &two.a_max_g, sizeof one.a_max_g);
        assert_int_equal(sf_runner_figure(&one, "steps"), sf_runner_figure(&two, "steps"));
        sf_runner_result_free(&two);
    }
    sf_runner_result_free(&one);
    step_of_drops = SMALL_STEP;
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(killed_campaign_makes_progress_in_every_life),
        cmocka_unit_test(campaign_goes_on_with_an_interrupted_drop),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
