/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every file of tests/fuzz/corpus, which holds the fuzzers' seeds and each input that once broke a reader:
 * the reader accepts it or refuses it with a sentence, and does not crash, hang or leak. */
#include "fuzz_readers.h"
#include "model_fixture.h"
#include "program_fixture.h"

#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <cmocka.h>

static int set_up(void **state) {
    (void)state;
    fuzz_begin();
    return 0;
}

static int tear_down(void **state) {
    (void)state;
    fuzz_end();
    return 0;
}

/* Feeds every file of the folder to the reader; how many it accepted, and how many there are. */
static int feed(const fuzz_reader *reader, int *files) {
    char path[1024], name[1300];
    int accepted = 0;
    snprintf(path, sizeof path, "%s/%s", fixture_source("tests/fuzz/corpus"), reader->name);
    DIR *listing = opendir(path);
    struct dirent *entry;
    if (!listing)
        fail_msg("there is no folder %s", path);
    while ((entry = readdir(listing)) != NULL) {
        if (entry->d_name[0] == '.')
            continue;
        snprintf(name, sizeof name, "%s/%s", path, entry->d_name);
        program_bytes bytes = program_read_file(name);
        accepted += fuzz_read(reader, (const uint8_t *)bytes.data, bytes.size) == SF_OK;
        free(bytes.data);
        ++*files;
    }
    closedir(listing);
    return accepted;
}

static void every_file_of_the_corpus_is_read_or_refused(void **state) {
    (void)state;
    for (int k = 0; fuzz_reader_at(k); k++) {
        int files = 0, accepted = feed(fuzz_reader_at(k), &files);
        print_message("%-10s %d files, %d accepted\n", fuzz_reader_at(k)->name, files, accepted);
        assert_true(accepted > 0); /* the seeds are sound, so that the fuzzers start from there */
    }
}

/* Cut anywhere and with single bytes changed: a small fuzzer for builds without clang. */
static void cut_and_changed_seeds_are_read_or_refused(void **state) {
    (void)state;
    static const char *const seeds[][2] = {
        {"case", "drop.cfg"},          {"curve", "foam.csv"},    {"motion", "press.csv"},
        {"reference", "measured.csv"}, {"rig", "pairs.csv"},     {"fit", "drops.cfg"},
        {"compression", "fit.cfg"},    {"pressing", "slow.csv"}, {"geo", "cube.geo"},
        {"model", "cube.h5"},          {"results", "cube.h5"},   {"stream", "tetrahedron.stream"},
        {"plan", "zip.cfg"},           {"plan", "sample.cfg"},   {"manifest", "three.tsv"}};
    uint64_t seed = 5;
    for (size_t k = 0; k < sizeof seeds / sizeof seeds[0]; k++) {
        char name[128];
        int refused = 0;
        snprintf(name, sizeof name, "tests/fuzz/corpus/%s/%s", seeds[k][0], seeds[k][1]);
        program_bytes bytes = program_read_file(fixture_source(name));
        const fuzz_reader *reader = fuzz_reader_find(seeds[k][0]);
        for (int trial = 0; trial < 60; trial++) {
            size_t at = (size_t)(0.5 * (fixture_random(&seed) + 1) * (double)(bytes.size - 1));
            char kept = bytes.data[at];
            bytes.data[at] = (char)(kept ^ (1 << (trial % 8)));
            refused += fuzz_read(reader, (const uint8_t *)bytes.data, trial % 3 ? bytes.size : at) != SF_OK;
            bytes.data[at] = kept;
        }
        free(bytes.data);
        assert_true(refused > 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_file_of_the_corpus_is_read_or_refused),
        cmocka_unit_test(cut_and_changed_seeds_are_read_or_refused),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
