/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where warnings and notes go: a function that may produce some takes a sink from its caller. Only the
 * programs print. */
#ifndef SF_CORE_SINK_H
#define SF_CORE_SINK_H

typedef enum sf_severity {
    SF_NOTE,    /* a choice that was made for the user */
    SF_WARNING, /* the input is legal but probably not intended */
} sf_severity;

/* `sentence` has no line end and is valid during the call only. */
typedef struct sf_sink {
    void (*tell)(void *user, sf_severity severity, const char *sentence);
    void *user; /* borrowed */
} sf_sink;

/* Gives the sink a sentence of at most 1023 bytes; control characters become blanks. NULL: the sentence is
 * dropped. */
void sf_sink_tell(const sf_sink *sink, sf_severity severity, const char *format, ...)
    __attribute__((format(printf, 3, 4)));

#endif
