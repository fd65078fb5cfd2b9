/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Work in copies of the process: side by side, failures with their sentences, signals, and the end of the
 * parent. */
#include "io/process.h"

#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#include <cmocka.h>

enum { COUNT = 7 };

/* Of all processes. */
typedef struct board {
    volatile int begun, together, most;
    volatile pid_t worker;
} board;

static board *common(void) {
    board *b = mmap(NULL, sizeof *b, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    assert_true(b != MAP_FAILED);
    return b;
}

static void doze(long ms) {
    const struct timespec pause = {ms / 1000, ms % 1000 * 1000000};
    nanosleep(&pause, NULL);
}

static sf_status count_and_fail(void *context, int index, sf_error *err) {
    board *b = context;
    __atomic_add_fetch(&b->begun, 1, __ATOMIC_SEQ_CST);
    int now = __atomic_add_fetch(&b->together, 1, __ATOMIC_SEQ_CST);
    if (now > b->most)
        b->most = now;
    doze(300);
    __atomic_sub_fetch(&b->together, 1, __ATOMIC_SEQ_CST);
    if (index == 3)
        return SF_FAIL(err, SF_ERR_NUMERIC, "the drop %d collapsed", index);
    if (index == 5)
        raise(SIGKILL);
    return SF_OK;
}

static void failures_come_back(void **state) {
    (void)state;
    sf_error result[COUNT], err = SF_ERROR_INIT;
    board *b = common();
    assert_int_equal(sf_process_pool(COUNT, 3, count_and_fail, NULL, b, result, &err), SF_OK);
    assert_true(b->begun == COUNT && b->most > 1 && b->most <= 3);
    for (int k = 0; k < COUNT; k++)
        assert_int_equal(result[k].status, k == 3 ? SF_ERR_NUMERIC : k == 5 ? SF_ERR_LIBRARY : SF_OK);
    assert_string_equal(result[3].text, "the drop 3 collapsed");
    assert_non_null(strstr(result[5].text, "signal 9"));
    assert_int_equal(sf_process_pool(0, 3, count_and_fail, NULL, b, result, &err), SF_OK);
    munmap(b, sizeof *b);
}

/* Runs a program that a signal ends. */
static sf_status run_long(void *context, int index, sf_error *err) {
    static const char *const sleep[] = {"sleep", "20", NULL};
    const sf_process process = {.arguments = sleep, .stoppable = true};
    board *b = context;
    int code = 0;
    b->worker = getpid();
    __atomic_add_fetch(&b->begun, 1, __ATOMIC_SEQ_CST);
    sf_process_run(&process, &code);
    return sf_process_stopped() ? SF_FAIL(err, SF_INTERRUPTED, "stopped %d", index) : SF_OK;
}

/* A campaign in a process of its own; its exit code: how many of its drops were interrupted. */
static pid_t begin_campaign(board *b) {
    pid_t campaign = fork();
    if (campaign == 0) {
        sf_error result[COUNT], err = SF_ERROR_INIT;
        int interrupted = 0;
        sf_process_handle_signals();
        sf_process_pool(COUNT, 2, run_long, NULL, b, result, &err);
        for (int k = 0; k < COUNT; k++)
            interrupted += result[k].status == SF_INTERRUPTED;
        _exit(interrupted);
    }
    for (int k = 0; k < 1000 && b->begun < 2; k++)
        doze(10);
    assert_int_equal(b->begun, 2);
    doze(50);
    return campaign;
}

static void signal_ends_all(void **state) {
    (void)state;
    board *b = common();
    int status = 0;
    pid_t campaign = begin_campaign(b);
    time_t begin = time(NULL);
    kill(campaign, SIGTERM); /* to it alone */
    assert_int_equal(waitpid(campaign, &status, 0), campaign);
    assert_true(WIFEXITED(status) && WEXITSTATUS(status) == COUNT);
    assert_true(b->begun == 2 && time(NULL) - begin < 10);
    munmap(b, sizeof *b);
}

static void copies_end_with_their_parent(void **state) {
    (void)state;
    board *b = common();
    int status = 0;
    pid_t campaign = begin_campaign(b);
    kill(campaign, SIGKILL);
    assert_int_equal(waitpid(campaign, &status, 0), campaign);
    int k = 0;
    while (k++ < 500 && kill(b->worker, 0) == 0) { /* a zombie, where nobody reaps it, has state Z */
        char path[64], text[256] = "";
        snprintf(path, sizeof path, "/proc/%d/stat", (int)b->worker);
        FILE *file = fopen(path, "r");
        size_t length = file ? fread(text, 1, sizeof text - 1, file) : 0;
        if (file)
            fclose(file);
        if (length == 0 || strstr(text, ") Z "))
            break;
        doze(10);
    }
    assert_true(k < 500);
    munmap(b, sizeof *b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(failures_come_back),
        cmocka_unit_test(signal_ends_all),
        cmocka_unit_test(copies_end_with_their_parent),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
