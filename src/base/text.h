/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* Numbers, words and lines of texts. Numbers of the user are decimal ones alone. */

/* The number at `text`, [+-] digits [. digits] [e [+-] digits] with at least one digit, and what follows it;
 * NULL if there is none (hexadecimal). "nan" and "inf", and numbers that are too large, give a value that is
 * not finite. `value` may be NULL. */
const char *sf_decimal_read(const char *text, double *value);

/* True if the whole text is one finite number. */
bool sf_decimal_is(const char *text, double *value);

/* True if the whole text is one whole number from `low` to `high`. */
bool sf_whole_is(const char *text, long low, long high, int *value);

/* True if both texts are KEY=VALUE of one key, with other values. */
bool sf_text_contradicts(const char *one, const char *other);

/* Place of the word in the list "one|two|three"; -1 if it is not there. */
int sf_word_find(const char *list, const char *word);

/* The word at the place (the last one if there are fewer) and its length. */
const char *sf_word_at(const char *list, int place, int *length);

/* Takes the next line from `rest`: what follows `name` and separator in it; NULL: it begins otherwise. */
char *sf_line_take(char **rest, const char *name, char separator);

/* Returns what follows the blanks and the comments of C++ at `text`; with `hash`, those after "#" as well. */
const char *sf_blanks_pass(const char *text, bool hash);

/* Length of the well-formed UTF-8 sequence at `s`, 0 if there is none (RFC 3629). */
int sf_utf8_length(const unsigned char *s);

/* Appends to the text in a buffer of `size` bytes, as far as there is room. */
void sf_text_add(char *text, size_t size, const char *format, ...) __attribute__((format(printf, 3, 4)));

/* Closes a stream of open_memstream, NULL if there was no memory for it; returns its text, owned by the
 * caller, or NULL. */
char *sf_text_close(FILE *stream, char **text);

/* Length of `text`, or at most `size`, cut before a sequence that does not end there. */
int sf_utf8_cut(const char *text, int size);
