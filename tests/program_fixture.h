/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The three programs as a user runs them, in a folder of their own. The programs are those of SF_BIN_DIR; any
 * failure of the machinery ends the running test. */
#ifndef SF_TESTS_PROGRAM_FIXTURE_H
#define SF_TESTS_PROGRAM_FIXTURE_H

#include "io/h5.h"
#include <stddef.h>

/* A build with a sanitizer takes address space and stack of its own: its programs bear no limits of them. */
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
enum { SANITIZED = 1 };
#else
enum { SANITIZED = 0 };
#endif

typedef struct program_place {
    char folder[512]; /* absolute, removed by program_tear_down */
} program_place;

typedef struct program_result {
    int code;        /* exit code; 128 + signal if a signal ended the program */
    char out[16384]; /* stdout, cut */
    char err[8192];  /* stderr, cut */
} program_result;

/* A copy of a file. */
typedef struct program_bytes {
    char *data; /* owned: free; a zero follows */
    size_t size;
} program_bytes;

void program_set_up(program_place *place);
void program_tear_down(const program_place *place);

/* A place of a whole group of tests, in *state; each ends with program_group_tear_down. */
program_place *program_group_set_up(void **state);
int program_group_folder(void **state); /* empty */
int program_group_case(void **state);   /* with good.cfg: the example, geo and materials beside it */
/* With these, model.h5, results.h5 of 1 ms and out/. */
int program_group_example(void **state);
int program_group_tear_down(void **state);

/* folder/name, valid until the eighth call after this one. */
const char *program_path(const program_place *place, const char *name);

/* Runs a shell command in the folder. */
program_result program_shell(const program_place *place, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
/* Runs softfall-`name` in the folder with the words of `format`. */
program_result program_run(const program_place *place, const char *name, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* The same, and fails the test with the program's words unless it exits with 0. */
program_result program_succeed(const program_place *place, const char *name, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* Succeeds with softfall-post without view.html, which takes most of its time. */
program_result program_figures(const program_place *place, const char *format, ...)
    __attribute__((format(printf, 2, 3)));

/* --set options that make the example case coarse, and allow it: `spacing` mm in the zone, 20 mm outside, or
 * 40 from a spacing of 25 mm on; valid until the next call. */
const char *program_coarse(double spacing);

/* folder/name of HDF5, open for reading. */
sf_h5 *program_open_h5(const program_place *place, const char *name);
program_bytes program_read_file(const char *path);
/* Everything in the folder but what the shell printed: names, modes, targets of links and hashes of contents,
 * a line each. Owned: free. */
char *program_list_files(const program_place *place);
void program_write_file(const char *path, const void *data, size_t size);
/* Writes folder/name and returns its path, as program_path does. */
const char *program_write_text(const program_place *place, const char *name, const char *text);
/* The number behind "key": in a JSON text, from the first place of the text `after` on (NULL: anywhere). NaN
 * if no number follows; fails the test if the key is missing. */
double program_json_number(const char *json, const char *after, const char *key);
/* The same of the file folder/name. */
double program_file_number(const program_place *place, const char *name, const char *key);
/* The largest magnitude of a column of folder/out/history.csv. */
double program_history_largest(const program_place *place, const char *column);
/* Fails if the file at `path` is not byte by byte what `before` is; releases `before`. */
void program_assert_unchanged(const char *path, program_bytes *before);

#endif
