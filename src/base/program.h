/* SPDX-License-Identifier: GPL-3.0-or-later */
/* For the programs alone: command lines, printing, and exit codes from status codes. */
#pragma once
#include "base/error.h"

enum { SF_MOST_THREADS = 1024 };

/* main calls it first. Ignores SIGPIPE and SIGXFSZ, so that a closed standard output (`softfall-pre ... |
 * head -1`) and a limit of file sizes become failed writes with their sentences, and do not end the program
 * in the middle of its files. SF_ERR_INPUT if the environment has an impossible value for OpenMP,
 * SF_ERR_MEMORY if the stack is limited to less than 1 MB; if only the soft limit is, the program starts
 * itself again with more. */
sf_status sf_program_begin(char **argv, sf_error *err);

/* Can `threads` threads run at once? SF_ERR_MEMORY if not: OpenMP would end the program without a sentence of
 * ours. */
sf_status sf_program_try_threads(int threads, sf_error *err);

/* Reads the text of an option into a member of the program's values; `text` is NULL where the option has
 * none. The sentence of a failure names `option`, "--limit-g". */
typedef sf_status sf_option_reader(const char *option, const char *text, void *member, sf_error *err);

/* An option of the command line. Static storage; a list of them ends with {0}. */
typedef struct sf_option {
    const char *name;       /* "limit-g" */
    int letter;             /* 'o'; 0: none */
    const char *argument;   /* as --help shows it; NULL: a flag */
    const char *meaning;    /* for --help */
    size_t member;          /* offset of the member in the values */
    sf_option_reader *read; /* NULL: a flag is set (bool), a text is borrowed (const char *) */
    int low, high;          /* of a whole number (int), which has no reader; high 0: it is none */
    int group;              /* of --help */
    size_t noted;           /* offset of a bool that is set if the option is given; 0: none */
    bool is_optional;       /* the argument may be missing */
    bool repeats;           /* it may be given several times, each with another argument */
} sf_option;

/* The command line of a program. */
typedef struct sf_command {
    const char *program;  /* in --version and messages */
    const char *operands; /* for --help: "CASE" */
    const char *meaning;  /* for --help, as in struct argp */
    const char *second;   /* format of the sentence that refuses a second operand (%s) */
    size_t operand;       /* offset of the operand (const char *) in the values of the first list */
    /* Returns a sentence if the whole command line is not enough, else NULL; NULL: it always is. */
    const char *(*fault)(const struct sf_command *command);
    bool is_usage; /* a wrong option ends the program like an unknown one, and is no failure in `err` */
    struct {
        const sf_option *option; /* NULL: no further list */
        void *values;
    } list[3];
} sf_command;

/* Reads the command line into the values, which hold the defaults. An unknown option, and what `second` and
 * `fault` refuse, end the program with a sentence, as --help and --version do. */
sf_status sf_command_parse(const sf_command *command, int argc, char **argv, sf_error *err);

/* Texts of an option that may be repeated, borrowed. */
typedef struct sf_option_texts {
    int count;
    const char *text[64];
} sf_option_texts;

/* Readers. A limit (double), a finite number above 0; a text behind those before it (sf_option_texts). */
sf_option_reader sf_program_read_limit, sf_program_read_texts;

/* Prints "program: sentence" (and the source line when SOFTFALL_DEBUG is set in the environment) to stderr. A
 * standard output that could not be written counts as a failure. Returns the process exit code that belongs
 * to the status. */
int sf_error_report(const sf_error *err, const char *program);

/* A sink that prints "program: warning: sentence" (or "note:") to stderr; `program` is borrowed. */
sf_sink sf_program_sink(const char *program);
