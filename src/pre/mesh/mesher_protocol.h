/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The messages between softfall-pre (the parent, pre/mesh/mesher.h) and softfall-mesh (the child,
 * pre/mesher). The child runs gmsh on a file that may be hostile: the parent checks everything that it
 * receives. */
#pragma once
#include <limits.h>
#include <stdbool.h>
#include <stdint.h>
#include <string.h>
#include <strings.h>

/* The child's open files: 0 is /dev/null, 1 and 2 are the pipe of what gmsh prints. */
enum {
    SF_MESHER_CONTROL = 3,    /* socket (SOCK_SEQPACKET) of the messages below */
    SF_MESHER_DATA = 4,       /* pipe of the mesh stream */
    SF_MESHER_PARAMETERS = 5, /* a .geo text that sets the parameters */
    SF_MESHER_SPARE = 6,      /* socket (SOCK_SEQPACKET) of a spare, closed before the request is read */
};

/* On SF_MESHER_SPARE the spare, a fork that has read nothing, tells its own number of process (int32_t). For
 * each further job it receives a byte with the files control, data, parameters and print, and answers with
 * the number of the child that it has forked for it, or one below 0 if it could not. */
enum { SF_MESHER_JOB = 4 };

/* The confined child opens the parameters by this name, which the parent knows. */
#define SF_MESHER_PARAMETERS_NAME "softfall-parameters.geo"

/* The parent's first message. */
typedef struct sf_mesher_request {
    uint64_t version;  /* SF_MESHER_VERSION */
    uint64_t confined; /* 0: no filter of system calls */
    uint64_t bytes;    /* of memory; 0: no limit */
    uint64_t seconds;  /* of processor time */
    char path[PATH_MAX];
} sf_mesher_request;

/* A message of the child; only SF_ASK_OPEN has an answer. */
typedef enum sf_mesher_ask_kind {
    SF_ASK_READY = 1, /* gmsh is started: from now on files are those of the geometry */
    SF_ASK_PARSED,    /* the geometry is read, meshing begins */
    SF_ASK_OPEN,      /* `detail`: flags of open; `text`: the path */
    SF_ASK_PROGRAM,   /* it tried to start a program */
    SF_ASK_MEMORY,    /* an allocation failed */
    SF_ASK_NO_FILTER, /* `detail`: errno value; the kernel has no filter of system calls */
} sf_mesher_ask_kind;

typedef struct sf_mesher_ask {
    uint32_t kind;
    int32_t detail;
    char text[PATH_MAX]; /* only as long as it is, with its zero */
} sf_mesher_ask;

/* The answer: 0 with a file descriptor, or an errno value. */
typedef struct sf_mesher_answer {
    int32_t error;
} sf_mesher_answer;

/* The mesh stream: words of 64 bits of this machine.
 * - SF_MESH_STREAM_BEGIN, version of gmsh (text), error (text; if not empty, only SF_MESH_STREAM_END follows)
 * - node count, tags [count], positions [count][3]
 * - group count, per group: dimension, tag, name (text), entity count, entities
 * - block count, per block: dimension, entity, type of gmsh, its name (text), node count, tags
 * - SF_MESH_STREAM_END
 *
 * A text is its length in bytes and the bytes, filled with zeros to whole words. The blocks ascend by
 * dimension and entity: they are the elements of all volumes and of the surfaces in named groups, where there
 * are no volumes of the curves in named groups, too; an entity without elements has no block. */
#define SF_MESHER_VERSION UINT64_C(1)
#define SF_MESH_STREAM_BEGIN UINT64_C(0x31306873656d6673)
#define SF_MESH_STREAM_END UINT64_C(0x646e656873656d00)

/* True if the path ends in `suffix`, in letters of either case: gmsh tells formats apart in this way. */
static inline bool sf_mesher_has_suffix(const char *path, const char *suffix) {
    size_t n = strlen(path), m = strlen(suffix);
    return n > m && strcasecmp(path + n - m, suffix) == 0;
}
