/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The provenance of a file: the texts under /provenance (docs/formats.md). */
#pragma once
#include "io/h5.h"

enum { SF_FORMAT_VERSION = 7 };

/* A case's text holds the files that it includes, each below the line "# from NAME:". */
#define SF_INCLUDED_BEGIN "# from "
#define SF_INCLUDED_END ":"

/* Borrowed strings; NULL members are not written. Version, revision, compiler, flags and date are added. */
typedef struct sf_provenance {
    const char *program;
    const char *command_line;
    const char *libraries;
    const char *case_text;
    const char *parameters;
    const char *mesh_hash;
    const char *report;         /* of softfall-pre, a line each: key, name, value (docs/formats.md) */
    const char *geometry_files; /* a line each: hash, path (docs/formats.md) */
    const char *model_path;     /* of the solver */
    const char *model_hash;     /* sf_model_hash, 16 hex digits */
} sf_provenance;

/* Writes /provenance and the root attributes format and format_version. */
sf_status sf_provenance_write(sf_h5 *file, const char *format, const sf_provenance *provenance,
                              sf_error *err);

/* Writes the two attributes of format and version alone. */
sf_status sf_provenance_mark(sf_h5 *file, const char *format, sf_error *err);

/* Refuses a file that is not of `format`, or is of a newer or an older version; `path` is for the sentence.
 * Results and checkpoints of version 6 are those of 7: of models the contact points changed. */
sf_status sf_provenance_check(const sf_h5 *file, const char *path, const char *format, sf_error *err);

/* Copies every text of `from`:/provenance to `to`:/provenance/model. */
sf_status sf_provenance_copy(const sf_h5 *from, sf_h5 *to, sf_error *err);

/* The words of a command joined by blanks, quoted where a shell would need it; from malloc, owned by the
 * caller. */
char *sf_command_line(int argc, char *const *argv);
