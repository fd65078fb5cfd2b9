/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>

/* Status codes and the error record that every fallible softfall function fills.
 *
 * A function that can fail returns sf_status and takes an `sf_error *err` as its last argument. The first
 * failure is kept (later calls on the same record do not overwrite it) with a sentence that names the entity,
 * the value and the bound, and with the source line that raised it. `err` may not be NULL. A failing function
 * leaves its outputs released or NULL unless its header says otherwise. Only main() functions turn a status
 * into an exit code. */

typedef enum sf_status {
    SF_OK = 0,
    SF_ERR_INPUT = 2,     /* case file, geometry, curve or command line is wrong: the user can mend it */
    SF_ERR_IO = 3,        /* a file could not be opened, read, written or renamed */
    SF_ERR_MODEL = 4,     /* the discretisation breaks one of its invariants */
    SF_ERR_NUMERIC = 5,   /* the solution failed: collapsed domain, non-finite value, energy growth */
    SF_ERR_MEMORY = 6,    /* an allocation failed */
    SF_ERR_LIBRARY = 7,   /* a library reported an error that is none of the above */
    SF_INTERRUPTED = 130, /* ended early on SIGINT or SIGTERM; what was written is readable */
} sf_status;

typedef struct sf_error {
    sf_status status;  /* SF_OK until the first failure */
    const char *where; /* source file of the first failure, static storage */
    int line;          /* source line of the first failure */
    char text[1024];   /* one sentence, no trailing newline */
} sf_error;

#define SF_ERROR_INIT                                                                                        \
    { SF_OK, "", 0, "" }

/* In place of `err`: nobody reads the failure. */
#define SF_IGNORED (&(sf_error)SF_ERROR_INIT)

/* Records a failure (unless one is recorded already) and returns the recorded status. */
#define SF_FAIL(err, status, ...) sf_error_set((err), (status), __FILE__, __LINE__, __VA_ARGS__)

/* Refuses what the user gave. */
#define SF_REFUSE(err, ...) SF_FAIL(err, SF_ERR_INPUT, __VA_ARGS__)

/* Records that there is no memory for what the format names: SF_NO_MEMORY(err, "the path %s", path). */
#define SF_NO_MEMORY(err, ...) SF_FAIL(err, SF_ERR_MEMORY, "out of memory for " __VA_ARGS__)

/* The wording of the commonest faults, beside what is at fault: "a window of -1 s is not above 0", "PATH: 2
 * points; at least 3 are needed". The parameters are conversions or literals: SF_OUTSIDE("%g", "0", "%d"). */
#define SF_NOT_ABOVE_0 " is not above 0"
#define SF_OUTSIDE(value, low, high) " is " value ", outside " low " to " high
#define SF_AT_LEAST(count) "; at least " count " are needed"
#define SF_AT_MOST(count) "; at most " count " are allowed"
#define SF_NOT_WRITTEN "%s cannot be written (disk full?)"

/* Leaves the function with the status of `call` unless that is SF_OK. Where something must be released, let
 * its variable be SF_OWNED, chain the calls in one condition, or use `goto done`. */
#define SF_TRY(call)                                                                                         \
    do {                                                                                                     \
        sf_status sf_try_status = (call);                                                                    \
        if (sf_try_status != SF_OK)                                                                          \
            return sf_try_status;                                                                            \
    } while (0)

sf_status sf_error_set(sf_error *err, sf_status status, const char *where, int line, const char *format, ...)
    __attribute__((format(printf, 5, 6)));

/* Replaces control characters by blanks: texts of files stand in sentences, and their line ends and escapes
 * must not reach the terminal. */
void sf_error_clean(char *sentence);

/* Releases a variable at the end of its block, by free() or by the named function. The variable needs an
 * initial value; code that takes the pointer away sets the variable to NULL. */
#define SF_OWNED SF_OWNED_BY(sf_release)
#define SF_OWNED_BY(function) __attribute__((cleanup(function)))

/* Calls free() with the pointer at this address, which becomes NULL. */
void sf_release(void *pointer);

/* Returns the block (from malloc); frees it and returns NULL after a failure. */
void *sf_keep(void *block, const sf_error *err);

/* Calls free() with each of several pointers; the variables keep their values. */
#define SF_FREE(...) sf_free_all(sizeof((void *[]){__VA_ARGS__}) / sizeof(void *), (void *[]){__VA_ARGS__})

/* The same with an array of pointers, which become NULL; NULL: there is none. */
void sf_free_all(size_t count, void *pointers);

/* Calls free() with pointers of a record, and fills the record with zeros: SF_CLEAR(curve, curve->strain); */
#define SF_CLEAR(record, ...)                                                                                \
    sf_clear(record, sizeof *(record), sizeof((void *[]){__VA_ARGS__}) / sizeof(void *),                     \
             (void *[]){__VA_ARGS__})
void sf_clear(void *record, size_t size, size_t count, void *pointers);

/* malloc/calloc/realloc that record SF_ERR_MEMORY. Blocks of sf_alloc are zeroed and 64-byte aligned; release
 * them with free(). The count may be of any integer type; `count * size` is checked for overflow; zero bytes
 * give a valid block. */
void *sf_allocate(sf_error *err, unsigned long count, unsigned long size, const char *what);
#define sf_alloc(err, count, size, what) sf_allocate(err, (unsigned long)(count), size, what)

/* Declares an array that the block owns; leaves the function where there is no memory for it, or after an
 * earlier failure: SF_OWN(double, mass, node_count, "masses", err); */
#define SF_OWN(type, name, count, what, err)                                                                 \
    SF_OWNED type *name = sf_alloc(err, count, sizeof *name, what);                                          \
    SF_TRY((err)->status)

/* Several blocks of one name: SF_ALLOC_ALL(err, "curve", SF_ROOM(c->strain, n), SF_ROOM(c->stress, n)).
 * Returns the status of `err`; a pointer without a block is NULL. */
typedef struct sf_room {
    void *pointer; /* its address */
    unsigned long count, size;
} sf_room;
sf_status sf_alloc_all(sf_error *err, const char *what, size_t rooms, const sf_room *room);
#define SF_ROOM(pointer, count) ((sf_room){&(pointer), (unsigned long)(count), sizeof *(pointer)})
#define SF_ALLOC_ALL(err, what, ...)                                                                         \
    sf_alloc_all(err, what, sizeof((sf_room[]){__VA_ARGS__}) / sizeof(sf_room), (sf_room[]){__VA_ARGS__})

/* Makes room for one more element behind `count` elements of `size` bytes. `array` is the address of a
 * pointer that is NULL at first and that only this function changes. False: out of memory, and nothing has
 * changed. */
bool sf_grow(void *array, size_t count, size_t size);

/* Declares an array of characters and prints into it: SF_PRINTED(path, 64, "%s/%d", folder, k); */
#define SF_PRINTED(name, size, ...)                                                                          \
    char name[size];                                                                                         \
    snprintf(name, sizeof(name), __VA_ARGS__)

/* Declares `text` and `size`, and `stream`, which writes them; NULL: no memory. sf_text_close (text.h) ends
 * it. */
#define SF_TEXT_STREAM(stream, text, size)                                                                   \
    char *text = NULL;                                                                                       \
    size_t size = 0;                                                                                         \
    FILE *stream = open_memstream(&text, &size)

/* In a function with the parameters `format, ...`: prints them into the array `text`. */
#define SF_PRINT_INTO(text, format)                                                                          \
    do {                                                                                                     \
        va_list sf_arguments;                                                                                \
        va_start(sf_arguments, format);                                                                      \
        vsnprintf(text, sizeof(text), format, sf_arguments);                                                 \
        va_end(sf_arguments);                                                                                \
    } while (0)

/* A sink receives warnings and notes: a function that may produce some takes a sink from its caller. Only
 * the programs print. */

typedef enum sf_severity {
    SF_FACT,    /* how an input was read, for a program that reports it */
    SF_NOTE,    /* a choice that was made for the user */
    SF_WARNING, /* the input is legal but probably not intended */
} sf_severity;

/* `sentence` has no line end and is valid during the call only. */
typedef struct sf_sink {
    void (*tell)(void *user, sf_severity severity, const char *sentence);
    void *user; /* borrowed */
} sf_sink;

/* Prints to a log, at once; NULL: there is none. */
void sf_log_print(FILE *log, const char *format, ...) __attribute__((format(printf, 2, 3)));

/* Gives the sink a sentence of at most 1023 bytes; control characters become blanks. NULL: the sentence is
 * dropped. */
void sf_sink_tell(const sf_sink *sink, sf_severity severity, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
