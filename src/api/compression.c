/* SPDX-License-Identifier: GPL-3.0-or-later */
/* libsoftfall-build: compression tests, and the fit of a free curve to them. */
#include "api/api.h"

#include "study/fit/compression/compression_command.h"

typedef struct test_handle {
    softfall_compression_test view; /* its first member: the caller's pointer */
    sf_compression_test test;
} test_handle;

softfall_status softfall_compression_read(const softfall_compression_source *source,
                                          softfall_compression_test **out, softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    test_handle *h = sf_alloc(&err, 1, sizeof *h, "a compression test");
    const sf_compression_source s = {.path = source->path,
                                     .rate = source->rate,
                                     .area = source->area,
                                     .thickness = source->thickness,
                                     .toe = source->correct_toe,
                                     .invert = (sf_inversion)source->invert,
                                     .contact_force = source->contact_force,
                                     .cycle = source->cycle};
    *out = NULL;
    if (h && sf_compression_test_read(&s, &h->test, &err) == SF_OK) {
        h->view = (softfall_compression_test){.count = h->test.count,
                                              .loading = h->test.loading,
                                              .strain = h->test.strain,
                                              .stress = h->test.stress,
                                              .largest_strain = h->test.largest_strain,
                                              .largest_stress = h->test.largest_stress,
                                              .cycles = h->test.cycles,
                                              .dwell = h->test.dwell,
                                              .interpretation = h->test.interpretation};
        *out = &h->view;
    } else {
        free(h);
    }
    return softfall_return(&err, error);
}

void softfall_compression_free(softfall_compression_test *test) {
    test_handle *h = (test_handle *)test;
    if (h)
        sf_compression_test_free(&h->test);
    free(h);
}

softfall_status softfall_fit_compression(const char *path, const char *folder, int replace,
                                         softfall_error *error) {
    sf_error err = SF_ERROR_INIT;
    sf_compression_command(path, folder, replace != 0, NULL, NULL, &err);
    return softfall_return(&err, error);
}
