/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/threads.h"

#include <stdbool.h>
#include <stddef.h>

static const struct {
    const char *name;
    const char
        *words; /* possible values, "|" between them; NULL: numbers from 1 to `most`, "," between them */
    long most;
    bool needed; /* an impossible value is refused, not left out */
} known[] = {
    {"OMP_NUM_THREADS", NULL, SF_MOST_THREADS, true},
    {"OMP_THREAD_LIMIT", NULL, 1000000000, true},
    {"OMP_WAIT_POLICY", "active|passive", 0, false},
    {"OMP_PROC_BIND", "true|false|master|primary|close|spread", 0, false},
    {"OMP_PLACES", "threads|cores|sockets", 0, false},
    {"OMP_DYNAMIC", "true|false", 0, false},
    {"GOMP_SPINCOUNT", NULL, 1000000000, false},
    {"GOMP_CPU_AFFINITY", "none", 0, false}, /* OMP_PLACES and taskset do the same */
};
enum { KNOWN = sizeof known / sizeof *known };

/* Written before main, by one thread. */
static struct {
    int which; /* 1 + index of the variable; 0: all is well */
    char value[40];
} fault;

/* No memory is initialised yet: no function of a library and no sanitizer may be called after this line. */
#ifdef __clang__
#define FIRST __attribute__((no_sanitize("address", "thread", "undefined"), no_builtin))
#else
#define FIRST                                                                                                \
    __attribute__((no_sanitize("address", "thread", "undefined"),                                            \
                   optimize("no-tree-loop-distribute-patterns")))
#endif

/* Returns the rest of the text behind the prefix; NULL if the text begins otherwise. */
FIRST static const char *after(const char *text, const char *prefix) {
    for (; *prefix; text++, prefix++)
        if (*text != *prefix)
            return NULL;
    return text;
}

FIRST static const char *skip_blanks(const char *text) {
    while (*text == ' ' || *text == '\t')
        text++;
    return text;
}

/* One number; NULL if it is not from 1 to `most`. */
FIRST static const char *read_number(const char *text, long most) {
    long value = 0;
    const char *first = text;
    for (; *text >= '0' && *text <= '9' && value <= most; text++)
        value = 10 * value + (*text - '0');
    return text > first && value >= 1 && value <= most ? skip_blanks(text) : NULL;
}

FIRST static bool are_numbers(const char *text, long most) {
    for (;;) {
        text = read_number(skip_blanks(text), most);
        if (!text || *text != ',')
            return text && *text == '\0';
        text++;
    }
}

/* The words without regard to case. */
FIRST static bool is_word(const char *text, const char *words) {
    text = skip_blanks(text);
    while (*words) {
        const char *at = text;
        for (; *words && *words != '|' && (*at | 0x20) == *words; at++)
            words++;
        if ((*words == '|' || *words == '\0') && at > text && *skip_blanks(at) == '\0')
            return true;
        while (*words && *words != '|')
            words++;
        words += *words == '|';
    }
    return false;
}

FIRST static void keep_fault(int which, const char *value) {
    size_t k = 0;
    if (fault.which > 0 && known[fault.which - 1].needed)
        return;
    fault.which = which + 1;
    for (; value[k] && k + 1 < sizeof fault.value; k++)
        fault.value[k] = value[k];
    fault.value[k] = '\0';
}

/* True if the variable stays in the environment. */
FIRST static bool stays(const char *entry) {
    for (int k = 0; k < KNOWN; k++) {
        const char *value = after(entry, known[k].name);
        if (!value || *value++ != '=')
            continue;
        if (*value == '\0')
            return false;
        if (known[k].words ? is_word(value, known[k].words) : are_numbers(value, known[k].most))
            return true;
        keep_fault(k, value);
        return false;
    }
#ifdef __SANITIZE_THREAD__
    if (after(entry, "OMP_TOOL_LIBRARIES="))
        return true; /* libarcher, without which the sanitizer does not see what barriers order */
#endif
    return !after(entry, "OMP_") && !after(entry, "GOMP_");
}

FIRST static void clean(int argc, char **argv, char **environment) {
    char **to = environment;
    (void)argc;
    (void)argv;
    for (char **from = environment; *from; from++)
        if (stays(*from))
            *to++ = *from;
    *to = NULL;
}

/* The only place before the constructors of the libraries. */
__attribute__((section(".preinit_array"), used)) static void (*const at_start)(int, char **, char **) = clean;

sf_status sf_openmp_environment_check(const sf_sink *sink, sf_error *err) {
    if (fault.which == 0)
        return SF_OK;
    int k = fault.which - 1;
    if (!known[k].needed) {
        sf_sink_tell(sink, SF_WARNING, "%s=\"%s\" of the environment has no effect; softfall takes %s",
                     known[k].name, fault.value, known[k].words ? known[k].words : "a number above 0");
        return SF_OK;
    }
    return SF_FAIL(err, SF_ERR_INPUT, "the environment has %s=\"%s\"; a number from 1 to %ld is possible",
                   known[k].name, fault.value, known[k].most);
}
