/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Status and messages of the library, and its version (softfall/softfall.h has the rules of all). */
#pragma once
#include <stdint.h>

#if defined(__GNUC__)
#define SOFTFALL_VISIBLE __attribute__((visibility("default")))
#else
#define SOFTFALL_VISIBLE
#endif
#ifdef __cplusplus
#define SOFTFALL_API extern "C" SOFTFALL_VISIBLE
#else
#define SOFTFALL_API SOFTFALL_VISIBLE
#endif

/* The numbers are the exit codes of the programs. */
typedef enum softfall_status {
    SOFTFALL_OK = 0,
    SOFTFALL_INPUT = 2,   /* an argument, the case, the geometry or a curve is wrong: the user can mend it */
    SOFTFALL_FILE = 3,    /* a file could not be opened, read, written or renamed */
    SOFTFALL_MODEL = 4,   /* the model breaks one of its invariants */
    SOFTFALL_NUMERIC = 5, /* the solution failed: collapsed domain, non-finite value, energy growth */
    SOFTFALL_MEMORY = 6,  /* an allocation failed */
    SOFTFALL_LIBRARY = 7  /* gmsh, HDF5 or another library reported an error that is none of the above */
} softfall_status;

typedef struct softfall_error {
    softfall_status status;
    char text[1024]; /* one sentence, no line end */
} softfall_error;

typedef enum softfall_severity {
    SOFTFALL_NOTE = 0,   /* a choice that was made for the user */
    SOFTFALL_WARNING = 1 /* legal, but probably not intended */
} softfall_severity;

/* A sink receives warnings and notes. `sentence` is valid during the call only. A sink of NULL drops them. */
typedef struct softfall_sink {
    void (*tell)(void *user, softfall_severity severity, const char *sentence);
    void *user; /* passed to `tell` */
} softfall_sink;

/* The version, such as "1.2.0", and the git revision; static storage. */
SOFTFALL_API const char *softfall_version(void);
SOFTFALL_API const char *softfall_revision(void);

/* A column of the history, a field over the nodes, or a figure; static storage. */
typedef struct softfall_quantity {
    const char *name, *units, *description;
    int components; /* 1, 3 or 9 (row-major) */
} softfall_quantity;
