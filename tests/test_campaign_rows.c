/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Finished drops that are found again, their records, and the hashes of files that are kept. */
#include "model_fixture.h"
#include "program_fixture.h"

#include "study/runner.h"
#include "base/units.h"
#include "io/plain_file.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>
#include <cmocka.h>

#include "post_check.h"

enum { ROWS = 5 };

static sf_runner_drop drop[ROWS];
static char mass[ROWS][64], case_path[1024], folder[1024];

static int set_up(void **state) {
    int result = program_group_folder(state);
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    if (sf_units_hold(&err) != SF_OK)
        return 1;
    snprintf(case_path, sizeof case_path, "%s", fixture_source("examples/eva50-v4.5/case.cfg"));
    snprintf(folder, sizeof folder, "%s", program_path(p, "runs"));
    for (int k = 0; k < ROWS; k++) {
        snprintf(mass[k], sizeof mass[k], "missile.mass=%.3f kg", 4 + 1e-3 * k);
        drop[k] = (sf_runner_drop){.label = "drop",
                                   .case_path = case_path,
                                   .override_count = 5,
                                   .overrides = {"geometry.parameters.fine_spacing=20",
                                                 "geometry.parameters.outer_spacing=40",
                                                 "pad.mesh_error_limit=1", "solver.end_time=4 ms", mass[k]}};
    }
    return result;
}

static sf_runner runner_of(void) {
    return (sf_runner){.folder = folder, .threads = 1};
}

static void path_of(int row, const char *name, char *path, size_t size) {
    const sf_runner runner = runner_of();
    sf_error err = SF_ERROR_INIT;
    uint64_t key = 0;
    if (sf_runner_key(&runner, &drop[row], &key, &err) != SF_OK)
        fail_msg("%s", err.text);
    snprintf(path, size, "%s/drop-%016llx%s%s", folder, (unsigned long long)key, *name ? "/" : "", name);
}

/* The figures of the rows from `first` on; `reused` of them were there. */
static void collect(int first, int count, sf_runner_result *result, int64_t *reused) {
    sf_runner runner = runner_of();
    sf_error err = SF_ERROR_INIT, *failure = calloc((size_t)count, sizeof *failure);
    assert_non_null(failure);
    if (sf_runner_run_each(&runner, count, &drop[first], result, failure, &err) != SF_OK)
        fail_msg("%s", err.text);
    for (int k = 0; k < count; k++)
        if (failure[k].status != SF_OK)
            fail_msg("row %d: %s", first + k, failure[k].text);
    *reused = runner.reused;
    free(failure);
}

static double collect_one(int row) {
    sf_runner_result result;
    int64_t reused = 0;
    collect(row, 1, &result, &reused);
    assert_int_equal(reused, 1);
    double value = result.a_max_g;
    sf_runner_result_free(&result);
    return value;
}

static long reads(void) {
    char line[256];
    long count = -1;
    FILE *file = fopen("/proc/self/io", "r");
    while (file && fgets(line, sizeof line, file))
        sscanf(line, "syscr: %ld", &count);
    if (file)
        fclose(file);
    return count;
}

/* One real drop; the others have its files. */
static void finished_drops_are_collected(void **state) {
    (void)state;
    static const char *const files[] = {"results.h5", "figures.txt"};
    static sf_runner_result result[ROWS];
    int64_t reused = 0;
    collect(0, 1, result, &reused);
    assert_int_equal(reused, 0);
    double a_max = result[0].a_max_g;
    sf_runner_result_free(&result[0]);
    for (int k = 1; k < ROWS; k++) {
        char from[1200], to[1200];
        path_of(k, "", to, sizeof to);
        assert_int_equal(mkdir(to, 0777), 0);
        for (int f = 0; f < 2; f++) {
            path_of(0, files[f], from, sizeof from);
            path_of(k, files[f], to, sizeof to);
            assert_int_equal(link(from, to), 0);
        }
    }
    collect(0, ROWS, result, &reused);
    assert_int_equal(reused, ROWS);
    for (int k = 0; k < ROWS; k++) {
        assert_true(result[k].a_max_g == a_max && result[k].figure != NULL);
        assert_string_equal(result[k].status, "finished");
        sf_runner_result_free(&result[k]);
    }
}

/* A record that is missing, damaged or of other results is not believed, and is made again. */
static void a_record_that_cannot_be_is_made_again(void **state) {
    const program_place *p = *state;
    static const char *const spoil[] = {
        "rm figures.txt", "head -c 300 figures.txt > new && rm figures.txt && mv new figures.txt",
        "sed 's/^a_max_g .*/a_max_g 0x1p+0/' figures.txt > new && rm figures.txt && mv new figures.txt",
        "cp results.h5 new && rm results.h5 && mv new results.h5", /* of another time */
    };
    for (int k = 0; k < 4; k++) {
        char path[1200];
        struct stat info;
        path_of(k + 1, "", path, sizeof path);
        assert_int_equal(program_shell(p, "cd '%s' && %s", path, spoil[k]).code, 0);
        double a_max = collect_one(k + 1);
        assert_true(a_max == collect_one(0));
        path_of(k + 1, "figures.txt", path, sizeof path);
        assert_int_equal(stat(path, &info), 0);
        assert_true(a_max == collect_one(k + 1));
    }
}

/* Of two files whose paths have the same place in the list neither drives the other one out. */
static void hashes_of_many_files_are_kept(void **state) {
    const program_place *p = *state;
    enum { FILES = 60 }; /* of 256 places: some have the same with a probability of 0.999 */
    uint64_t hash[FILES];
    long count[2];
    sf_error err = SF_ERROR_INIT;
    program_shell(
        p, "for k in $(seq 0 59); do echo $k > kept-$k; done; sleep 2.1"); /* their times must have settled */
    for (int round = 0; round < 2; round++) {
        count[round] = reads();
        for (int k = 0; k < FILES; k++) {
            char name[32];
            uint64_t again = 0;
            snprintf(name, sizeof name, "kept-%d", k);
            assert_int_equal(sf_plain_hash_kept(program_path(p, name), &again, &err), SF_OK);
            assert_true(round == 0 || again == hash[k]);
            hash[k] = again;
        }
    }
    if (count[0] >= 0) /* the second round reads nothing but the counter itself */
        assert_true(reads() - count[1] < 5 && count[1] - count[0] >= FILES);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(finished_drops_are_collected),
        cmocka_unit_test(a_record_that_cannot_be_is_made_again),
        cmocka_unit_test(hashes_of_many_files_are_kept),
    };
    return cmocka_run_group_tests(tests, set_up, program_group_tear_down);
}
