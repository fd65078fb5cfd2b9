/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Every reader of a file that may come from a stranger, called as the programs call it. Used by the fuzzers
 * (tests/fuzz/fuzz.c) and by test_fuzz_regression, which needs no clang. */
#ifndef SF_TESTS_FUZZ_READERS_H
#define SF_TESTS_FUZZ_READERS_H

#include "base/error.h"
#include <stddef.h>
#include <stdint.h>

typedef struct fuzz_reader {
    const char *name; /* also the folder below tests/fuzz/corpus */
    const char *file; /* the input's name in the scratch folder */
    /* Reads the file and, if it is accepted, what the program does with it next; everything is released. */
    sf_status (*read)(const char *path, sf_error *err);
} fuzz_reader;

/* NULL if there is no such reader; `index` from 0 lists them. */
const fuzz_reader *fuzz_reader_find(const char *name);
const fuzz_reader *fuzz_reader_at(int index);

/* Makes the scratch folder with what inputs refer to: pad.geo, foam.csv, motion.csv, measured.csv,
 * material.cfg, good.cfg. Ends the process if that fails. fuzz_end removes it. */
void fuzz_begin(void);
void fuzz_end(void);

/* Writes the bytes as the reader's file in the scratch folder and reads it. Ends the process by abort() if
 * the reader breaks its promise: a failure has a sentence on one line, and nothing stays open. */
sf_status fuzz_read(const fuzz_reader *reader, const uint8_t *data, size_t size);

#endif
