/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Fits to drops whose processes are killed again and again end with the same products. */
#include "post_check.h"
#include "extreme.h"
#include "fit_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include <cmocka.h>

/* s of processor time of a process and of the children that it has waited for; 0: it has ended. */
static double time_of(pid_t process) {
    char path[64], text[1024] = "";
    unsigned long own[2] = {0}, children[2] = {0};
    snprintf(path, sizeof path, "/proc/%d/stat", (int)process);
    FILE *file = fopen(path, "r");
    if (!file)
        return 0;
    size_t length = fread(text, 1, sizeof text - 1, file);
    fclose(file);
    text[length] = '\0';
    if (length > 0)
        sscanf(strrchr(text, ')'), ") %*c %*d %*d %*d %*d %*d %*u %*u %*u %*u %*u %lu %lu %lu %lu", &own[0],
               &own[1], &children[0], &children[1]);
    return (double)(own[0] + own[1] + children[0] + children[1]) / (double)sysconf(_SC_CLK_TCK);
}

/* The same with its children at work, and theirs. */
static double time_of_all(pid_t process) {
    char path[64];
    int child;
    double sum = time_of(process);
    snprintf(path, sizeof path, "/proc/%d/task/%d/children", (int)process, (int)process);
    FILE *file = fopen(path, "r");
    if (!file)
        return sum;
    while (fscanf(file, "%d", &child) == 1)
        sum += time_of_all(child);
    fclose(file);
    return sum;
}

/* Who is killed: the fit with all its programs, the fit alone, or one of its programs alone. */
typedef enum victim { EVERYONE, THE_FIT, A_DROP, VICTIMS } victim;

/* False: nobody of that kind is there now. */
static bool kill_victim(pid_t fit, victim who) {
    char path[64];
    int child = 0;
    if (who != A_DROP)
        return kill(who == EVERYONE ? -fit : fit, SIGKILL) == 0;
    snprintf(path, sizeof path, "/proc/%d/task/%d/children", (int)fit, (int)fit);
    FILE *file = fopen(path, "r");
    if (!file)
        return false;
    bool found = fscanf(file, "%d", &child) == 1;
    fclose(file);
    return found && kill(child, SIGKILL) == 0;
}

/* A fit of `fit.cfg` in a process group of its own, where `who` is killed once all have had `life` seconds of
 * processor time. The wait status. */
static int run_fit_for(const program_place *place, const char *jobs, double life, victim who, double *used) {
    const struct timespec pause = {0, 2000000};
    char program[1024];
    snprintf(program, sizeof program, "%s/softfall-fit", getenv("SF_BIN_DIR"));
    int status = 0;
    bool killed = false;
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        setpgid(0, 0);
        if (chdir(place->folder) == 0 && freopen("log", "w", stdout))
            execl(program, "softfall-fit", "drop", "fit.cfg", "-o", "killed", "-t", "1", "-j", jobs,
                  "--force", NULL);
        _exit(1);
    }
    setpgid(child, child);
    while (waitpid(child, &status, WNOHANG) == 0) {
        double now = time_of_all(child);
        *used = larger(*used, now);
        if (now >= life && !killed)
            killed = kill_victim(child, who);
        nanosleep(&pause, NULL);
    }
    return status;
}

/* A fit that was killed, and at last ended, has the bits of `whole`, a fit that was left alone, in each of
 * the products, a list of the shell. */
static void assert_same_products(const program_place *place, const char *products) {
    program_result same = program_shell(
        place,
        "for product in %s; do diff -r -x '*.partial-*' whole/$product killed/$product || exit 1; done",
        products);
    if (same.code != 0)
        fail_msg("%s", same.out);
    assert_int_equal(program_shell(place, "test ! -e killed/runs/columns.bin").code, 0);
}

#define PRODUCTS "material.cfg material.csv fit.json fit-drops.csv fit-curve.csv"

/* A fit, with its drops side by side, that is killed over and over (with its programs, alone, or one of its
 * programs alone, which it survives with a sentence) after a share of its processor time in which it could
 * not even repeat what it computes between the drops: it ends, and with the same bits. */
static void killed_fit_ends_with_the_same_material(void **state) {
    (void)state;
    enum { SHARES = 5, MOST = 6 * SHARES };
    program_place place;
    double whole = 0, used = 0;
    int lives = 0, status;
    program_set_up(&place);
    fit_fixture_put_case(&place);
    program_write_text(
        &place, "fit.cfg",
        "posterior = false;\nmaterial = \"start.cfg\";\nunknown = ( { name = \"p0\"; }, { name = \"B\"; }, { name = \"ED\"; "
        "}, { name = \"E\"; }, { name = \"HU\"; } );\n"
        "start: { m = 2.8; s0 = \"7.4 kPa\"; };\n"
        "drops = ( { name = \"slow\"; case = \"case.cfg\"; a_max_g = 50.0; HIC = 180.0; }, "
        "{ name = \"fast\"; case = \"fast.cfg\"; a_max_g = 66.0; } );\n");
    program_shell(&place, "sed 's/4.5 m/5.2 m/' case.cfg > fast.cfg");
    assert_int_equal(run_fit_for(&place, "1", INFINITY, EVERYONE, &whole), 0);
    assert_int_equal(program_shell(&place, "mv killed whole").code, 0);
    do
        status = run_fit_for(&place, "2", whole / SHARES, (victim)(lives % VICTIMS), &used);
    while (++lives < MOST && (WIFSIGNALED(status) || WEXITSTATUS(status) != 0));
    print_message("%d lives of %.2g s, %.2g s without kills\n", lives, whole / SHARES, whole);
    if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
        fail_msg("wait status %d in life %d: %s", status, lives, program_shell(&place, "cat log").out);
    assert_true(lives > 2); /* the machine may be quicker now */
    assert_same_products(&place, PRODUCTS);
    program_tear_down(&place);
}

/* The same with two models, their chains and weights and the draws from both. Chains begin anew after a kill,
 * so each life is longer than the one before. */
static void killed_fit_of_two_models_ends_with_the_same_draws(void **state) {
    (void)state;
    static const double share[] = {0.1, 0.2, 0.4, 0.6, 0.8};
    enum { LIVES = sizeof share / sizeof share[0] };
    program_place place;
    double whole = 0, used = 0;
    int killed = 0;
    program_set_up(&place);
    fit_fixture_put_case(&place);
    program_write_text(
        &place, "fit.cfg",
        "material = \"start.cfg\";\nforms = ( { curve = \"gas\"; }, { curve = \"rusch\"; } );\n"
        "drops = ( { name = \"slow\"; case = \"case.cfg\"; a_max_g = 69.0; HIC = 250.0; } );\n"
        "predict = ( { name = \"fast\"; case = \"fast.cfg\"; } );\n");
    program_shell(&place, "sed 's/4.5 m/5.2 m/' case.cfg > fast.cfg");
    if (run_fit_for(&place, "1", INFINITY, EVERYONE, &whole) != 0)
        fail_msg("%s", program_shell(&place, "cat log").out);
    assert_int_equal(program_shell(&place, "mv killed whole").code, 0);
    for (int life = 0; life < LIVES; life++)
        killed += WIFSIGNALED(run_fit_for(&place, "2", share[life] * whole, (victim)(life % 2), &used));
    print_message("%d of %d lives ended by a kill, %.2g s without kills\n", killed, LIVES, whole);
    assert_true(killed > 2);
    assert_int_equal(run_fit_for(&place, "2", INFINITY, EVERYONE, &used), 0);
    assert_same_products(&place, PRODUCTS " posterior.csv posterior");
    program_tear_down(&place);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(killed_fit_ends_with_the_same_material),
        cmocka_unit_test(killed_fit_of_two_models_ends_with_the_same_draws),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
