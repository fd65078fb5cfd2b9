/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libFuzzer's entry for the reader named FUZZ_READER (tests/CMakeLists.txt). */
#include "fuzz_readers.h"

#include "base/units.h"

#include <gsl/gsl_errno.h>
#include <stdio.h>
#include <stdlib.h>

int LLVMFuzzerInitialize(int *argc, char ***argv);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

static const fuzz_reader *reader;

int LLVMFuzzerInitialize(int *argc, char ***argv) {
    (void)argc;
    (void)argv;
    reader = fuzz_reader_find(FUZZ_READER);
    gsl_set_error_handler_off();
    setenv("UDUNITS2_XML_PATH", FUZZ_UNITS, 1);
    sf_units *units = NULL; /* without them every input would be refused at once */
    sf_error err = SF_ERROR_INIT;
    if (sf_units_open(&units, &err) != SF_OK) {
        fprintf(stderr, "fuzz: %s\n", err.text);
        abort();
    }
    sf_units_close(&units);
    fuzz_begin();
    atexit(fuzz_end);
    return reader == NULL;
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
    fuzz_read(reader, data, size);
    return 0;
}
