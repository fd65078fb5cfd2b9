/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The text of a CSV table: encodings, ISO-MME channels, lines and groups of thousands. Internal to
 * table_csv.c. */
#pragma once
#include "base/error.h"

/* Reads a file (io/plain_file.h) as zero-terminated text for the caller to free: UTF-16 with a byte order
 * mark becomes UTF-8, a channel in ISO-MME a table of two columns whose lines are those of the file. `what`:
 * the file in messages. */
sf_status sf_table_text_read(const char *path, const char *what, char **text, sf_error *err);

/* True if the line is empty or a comment. */
bool sf_table_line_is_empty(const char *line);
/* A copy of the line at *rest, which is moved behind it, or of the next line from `rest` on that is neither
 * empty nor a comment; from malloc, NULL at the end. The text stays as it is. */
char *sf_table_line_copy(const char **rest);
char *sf_table_content_copy(const char *rest);
/* A copy in UTF-8, from malloc: what is not is taken for Latin-1. NULL of NULL, and without memory. */
char *sf_table_utf8_copy(const char *text);

/* "1,017.76" or "1.017,76": groups of three digits and another decimal mark; `quoted`: "1,017" is of
 * thousands too, as in a file with decimal points whose commas separate columns. Writes it without the
 * groups. */
bool sf_table_has_thousands(const char *text, bool quoted, char *plain, size_t size);
