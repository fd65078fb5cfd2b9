/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Opens files for softfall-mesh, which can open none: it gets a sealed copy of the content that was read and
 * hashed here, once per file. */
#pragma once
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A file that the geometry reads. */
typedef struct sf_broker_file {
    char *path;   /* as it asked for it */
    char *text;   /* content, a zero follows; a text ends with a line end, which gmsh needs; owned; NULL: that
                     of an earlier file */
    size_t size;  /* of `text` */
    int memory;   /* sealed copy of `text`, to be opened anew for each reader; owned by the file with the text
                   */
    bool is_text; /* there is a text, and no zero byte in it */
    uint64_t hash; /* of the file's own content (io/plain_file.h) */
} sf_broker_file;

typedef struct sf_broker {
    const char *parameters; /* what SF_MESHER_PARAMETERS_NAME holds; borrowed */
    bool ready;             /* gmsh is started: what it opens is the geometry's */
    uint64_t bytes, most;   /* of all contents and their copies so far, and the most that they may be */
    size_t count;
    sf_broker_file *file; /* [count] */
    char refused[600];    /* sentence about the first file that is there and is not handed over; "" */
    char written[300];    /* the first file that it tried to open for writing; "" */
} sf_broker;

void sf_broker_free(sf_broker *broker);

/* The answer to open(path, flags): 0 and a file descriptor for reading, which the caller closes, or an errno
 * value. */
int sf_broker_open(sf_broker *broker, const char *path, int flags, int *file);

/* A sealed copy of a text in memory, at its beginning; -1 and errno (EFBIG: larger than files may be). */
int sf_broker_memory(const char *text, size_t size);
