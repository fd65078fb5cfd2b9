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

/* Cut anywhere and with single bits changed: a small fuzzer for builds without clang. The damage is the same
 * on every machine, so that a reader that stops to check what it reads falls below its bounds. */
static void cut_and_changed_seeds_are_read_or_refused(void **state) {
    enum { CUTS = 20, CHANGES = 40 };
    static const struct {
        const char *reader, *file;
        int cuts,
            changes; /* at least refused: 20 of 20 cuts where each is a loss, else 3/4 of those measured */
    } seeds[] = {{"case", "drop.cfg", CUTS, 27},
                 {"curve", "foam.csv", CUTS, 23},
                 {"motion", "press.csv", 11, 26},
                 {"reference", "measured.csv", 12, 25},
                 {"compression", "fit.cfg", 14, 28},
                 {"pressing", "slow.csv", 6, 20},
                 {"geo", "cube.geo", 3, 0}, /* only the names of parameters are read */
                 {"model", "cube.h5", CUTS, 6},
                 {"results", "cube.h5", CUTS, 2},
                 {"stream", "tetrahedron.stream", CUTS, 8}};
    (void)state;
    for (size_t k = 0; k < sizeof seeds / sizeof seeds[0]; k++) {
        char name[128];
        uint64_t seed = 5;       /* the damage of a file does not depend on those before it */
        int refused[2] = {0, 0}; /* cuts, changes */
        snprintf(name, sizeof name, "tests/fuzz/corpus/%s/%s", seeds[k].reader, seeds[k].file);
        program_bytes bytes = program_read_file(fixture_source(name));
        const fuzz_reader *reader = fuzz_reader_find(seeds[k].reader);
        for (int trial = 0; trial < CUTS + CHANGES; trial++) {
            size_t at = (size_t)(0.5 * (fixture_random(&seed) + 1) * (double)(bytes.size - 1));
            char kept = bytes.data[at];
            bytes.data[at] = (char)(kept ^ (1 << (trial % 8)));
            size_t size = trial % 3 ? bytes.size : at;
            refused[size != at] += fuzz_read(reader, (const uint8_t *)bytes.data, size) != SF_OK;
            bytes.data[at] = kept;
        }
        free(bytes.data);
        print_message("%s/%s: %d of %d cuts and %d of %d changes are refused\n", seeds[k].reader,
                      seeds[k].file, refused[0], CUTS, refused[1], CHANGES);
        assert_true(refused[0] >= seeds[k].cuts);
        assert_true(refused[1] >= seeds[k].changes);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_file_of_the_corpus_is_read_or_refused),
        cmocka_unit_test(cut_and_changed_seeds_are_read_or_refused),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
