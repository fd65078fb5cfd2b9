/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run_fixture.h"

#include "io/h5_data.h"
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>
#include <cmocka.h>

/* A dataset of numbers, whatever its type and rank; its size in bytes, or 0: a text. */
static size_t read_any(const sf_h5 *file, const char *path, void **data) {
    static const struct {
        sf_h5_type type;
        size_t size;
    } types[] = {{SF_H5_F64, 8}, {SF_H5_I64, 8}};
    for (int t = 0; t < 2; t++)
        for (int rank = 0; rank < 3; rank++) {
            sf_error err = SF_ERROR_INIT;
            int64_t dims[2] = {-1, -1};
            size_t size = types[t].size;
            if (sf_h5_read(file, path, types[t].type, rank, dims, data, &err) != SF_OK)
                continue;
            for (int k = 0; k < rank; k++)
                size *= (size_t)dims[k];
            return size;
        }
    return 0;
}

static void assert_same_dataset(const sf_h5 *a, const sf_h5 *b, const char *path) {
    void *x = NULL, *y = NULL;
    size_t size = read_any(a, path, &x), other = read_any(b, path, &y);
    if (size == 0) {
        sf_error err = SF_ERROR_INIT;
        char *text[2] = {NULL, NULL};
        sf_h5_read_text(a, path, &text[0], &err);
        sf_h5_read_text(b, path, &text[1], &err);
        if (err.status != SF_OK || strcmp(text[0], text[1]) != 0)
            fail_msg("%s: %s and %s", path, text[0], text[1]);
        free(text[0]);
        free(text[1]);
    } else if (size != other || memcmp(x, y, size) != 0) {
        fail_msg("%s differs (%zu and %zu bytes)", path, size, other);
    }
    free(x);
    free(y);
}

/* What a run takes is its own. */
void run_assert_same_group(const sf_h5 *a, const sf_h5 *b, const char *path) {
    static const char *const own[] = {"/summary/wall_time", "/summary/threads", "/summary/restarts"};
    int64_t count = sf_h5_group_size(a, path);
    for (size_t k = 0; k < sizeof own / sizeof own[0]; k++)
        if (strcmp(path, own[k]) == 0)
            return;
    if (count < 0) {
        assert_same_dataset(a, b, path);
        return;
    }
    if (count != sf_h5_group_size(b, path))
        fail_msg("%s has %lld and %lld members", path, (long long)count,
                 (long long)sf_h5_group_size(b, path));
    for (int64_t k = 0; k < count; k++) {
        sf_error err = SF_ERROR_INIT;
        char name[128], member[300];
        assert_int_equal(sf_h5_group_member(a, path, k, name, sizeof name, &err), SF_OK);
        snprintf(member, sizeof member, "%s/%s", path, name);
        run_assert_same_group(a, b, member);
    }
}

void run_assert_same(const program_place *p, const char *first, const char *second) {
    static const char *const groups[] = {"/history", "/frames", "/peak", "/summary"};
    sf_error err = SF_ERROR_INIT;
    sf_h5 *a = program_open_h5(p, first), *b = program_open_h5(p, second);
    assert_true(sf_h5_group_size(a, "/frames") > 1);
    for (size_t k = 0; k < sizeof groups / sizeof groups[0]; k++)
        run_assert_same_group(a, b, groups[k]);
    sf_h5_close(&a, &err);
    sf_h5_close(&b, &err);
}

bool run_is_there(const program_place *p, const char *name) {
    return access(program_path(p, name), F_OK) == 0;
}

void run_sleep(double seconds) {
    nanosleep(&(struct timespec){(time_t)seconds, (long)(1e9 * (seconds - (double)(time_t)seconds))}, NULL);
}

pid_t run_start(const program_place *p, const char *const *words) {
    char program[1024];
    const char *list[16] = {program};
    snprintf(program, sizeof program, "%s/softfall-solve", getenv("SF_BIN_DIR"));
    for (int k = 0; k < 15 && words[k]; k++)
        list[k + 1] = words[k];
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        if (chdir(p->folder) != 0 || !freopen("log", "w", stdout) || !freopen("errors", "w", stderr))
            _exit(99);
        execv(program, (char *const *)list);
        _exit(99);
    }
    return child;
}

int64_t run_restarts(const program_place *p, const char *name) {
    sf_error err = SF_ERROR_INIT;
    void *data = NULL;
    sf_h5 *file = program_open_h5(p, name);
    assert_int_equal(sf_h5_read(file, "/summary/restarts", SF_H5_I64, 0, NULL, &data, &err), SF_OK);
    int64_t restarts = *(int64_t *)data;
    free(data);
    sf_h5_close(&file, &err);
    return restarts;
}

struct timespec run_written_at(const char *folder, const char *name) {
    struct stat info;
    char path[2048];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return stat(path, &info) == 0 ? info.st_mtim : (struct timespec){0, 0};
}

bool run_is_other(struct timespec a, struct timespec b) {
    return b.tv_sec != 0 && (a.tv_sec != b.tv_sec || a.tv_nsec != b.tv_nsec);
}
