/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/program.h"

#include "base/text.h"
#include "build_info.h"

#include <argp.h>
#include <errno.h>
#include <pthread.h>
#include <signal.h>
#include <stdint.h>
#include <string.h>
#include <sys/resource.h>
#include <unistd.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

/* ---- OpenMP's environment ---- */

/* The OpenMP runtime reads its variables of the environment before main and prints lines of its own about
 * values that it does not know; some values end the program later by a signal. Therefore a program that links
 * this file looks at them first: it keeps a known variable with a possible value, leaves one with another
 * value out and warns, and takes away all other OMP_ and GOMP_ variables without a word, as their defaults
 * are right for softfall (stacks are small, loops are not nested). */

static const struct {
    const char *name;
    const char
        *words; /* possible values, "|" between them; NULL: numbers from 1 to `most`, "," between them */
    long most;
    bool needed; /* an impossible value is refused, not left out */
} variables[] = {
    {"OMP_NUM_THREADS", NULL, SF_MOST_THREADS, true},
    {"OMP_THREAD_LIMIT", NULL, 1000000000, true},
    {"OMP_WAIT_POLICY", "active|passive", 0, false},
    {"OMP_PROC_BIND", "true|false|master|primary|close|spread", 0, false},
    {"OMP_PLACES", "threads|cores|sockets", 0, false},
    {"OMP_DYNAMIC", "true|false", 0, false},
    {"GOMP_SPINCOUNT", NULL, 1000000000, false},
    {"GOMP_CPU_AFFINITY", "none", 0, false}, /* OMP_PLACES and taskset do the same */
};
enum { VARIABLES = sizeof variables / sizeof *variables };

/* Written before main, by one thread. */
static struct {
    int which; /* 1 + index of the variable; 0: all is well */
    char value[40];
} first_fault;

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
    if (first_fault.which > 0 && variables[first_fault.which - 1].needed)
        return;
    first_fault.which = which + 1;
    for (; value[k] && k + 1 < sizeof first_fault.value; k++)
        first_fault.value[k] = value[k];
    first_fault.value[k] = '\0';
}

/* True if the variable stays in the environment. */
FIRST static bool stays(const char *entry) {
    for (int k = 0; k < VARIABLES; k++) {
        const char *value = after(entry, variables[k].name);
        if (!value || *value++ != '=')
            continue;
        if (*value == '\0')
            return false;
        if (variables[k].words ? is_word(value, variables[k].words) : are_numbers(value, variables[k].most))
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

/* SF_ERR_INPUT if a number of threads was impossible; tells `sink` of another variable that was left out. */
static sf_status check_environment(const sf_sink *sink, sf_error *err) {
    if (first_fault.which == 0)
        return SF_OK;
    int k = first_fault.which - 1;
    if (!variables[k].needed) {
        sf_sink_tell(sink, SF_WARNING, "%s=\"%s\" of the environment has no effect; softfall takes %s",
                     variables[k].name, first_fault.value,
                     variables[k].words ? variables[k].words : "a number above 0");
        return SF_OK;
    }
    return SF_REFUSE(err, "the environment has %s=\"%s\"; a number from 1 to %ld is possible",
                     variables[k].name, first_fault.value, variables[k].most);
}

enum { LEAST_STACK = 1 << 20, USUAL_STACK = 1 << 23 /* bytes */ };

/* The stack of the main thread, and OpenMP's of its threads. */
static sf_status check_stack(char **argv, sf_error *err) {
    struct rlimit stack;
    if (getrlimit(RLIMIT_STACK, &stack) != 0 || stack.rlim_cur >= LEAST_STACK)
        return SF_OK;
    rlim_t given = stack.rlim_cur;
    if (stack.rlim_max >= LEAST_STACK) {
        stack.rlim_cur = stack.rlim_max < USUAL_STACK ? stack.rlim_max : USUAL_STACK;
        if (setrlimit(RLIMIT_STACK, &stack) == 0)
            execv("/proc/self/exe", argv); /* threads take the limit of the start */
    }
    return SF_FAIL(err, SF_ERR_MEMORY, "the stack is limited to %llu kB" SF_AT_LEAST("%d kB") " (ulimit -s)",
                   (unsigned long long)given / 1024, LEAST_STACK / 1024);
}

/* Keeps freed memory: glibc gives the end of its heap back to the kernel after every small file that is read,
 * which took half of the time of softfall-post on a small model. Arrays of 4 MiB and more are mapped on their
 * own, as before. */
static void keep_freed_memory(void) {
#ifdef __GLIBC__
    mallopt(M_MMAP_THRESHOLD, 4 << 20);
    mallopt(M_TOP_PAD, 4 << 20);
    mallopt(M_TRIM_THRESHOLD, 64 << 20);
#endif
}

sf_status sf_program_begin(char **argv, sf_error *err) {
    keep_freed_memory();
    signal(SIGPIPE, SIG_IGN);
    signal(SIGXFSZ, SIG_IGN);
    sf_sink sink = sf_program_sink(program_invocation_short_name);
    SF_TRY(check_environment(&sink, err));
    return check_stack(argv, err);
}

/* Until the gate opens. */
static void *wait_for_all(void *gate) {
    pthread_mutex_lock(gate);
    pthread_mutex_unlock(gate);
    return NULL;
}

sf_status sf_program_try_threads(int threads, sf_error *err) {
    pthread_mutex_t gate = PTHREAD_MUTEX_INITIALIZER;
    SF_OWNED pthread_t *thread = sf_alloc(err, threads, sizeof *thread, "the threads");
    int count = 0, failed = 0;
    SF_TRY(err->status);
    pthread_mutex_lock(&gate);
    while (count < threads - 1 && failed == 0) {
        failed = pthread_create(&thread[count], NULL, wait_for_all, &gate);
        count += failed == 0;
    }
    pthread_mutex_unlock(&gate);
    for (int k = 0; k < count; k++)
        pthread_join(thread[k], NULL);
    if (failed != 0)
        return SF_FAIL(err, SF_ERR_MEMORY,
                       "%d threads cannot be started, only %d: %s; ask for fewer (--threads, "
                       "OMP_NUM_THREADS), or raise the limit of processes or of memory",
                       threads, count + 1, strerror(failed));
    return SF_OK;
}

/* ---- the command line ---- */

enum { FIRST_KEY = 0x1000, LIST_KEYS = 0x100, LISTS = 3, OPTIONS = 40 };

typedef struct parser {
    const sf_command *command;
    sf_error *err;
    const char *given[LISTS][OPTIONS]; /* the argument of each option; NULL: not given yet */
} parser;

/* An option has one argument, unless its reader takes several. */
static void check_once(const sf_option *o, const char **given, const char *text, struct argp_state *state) {
    if (*given && text && o->argument && !o->repeats && strcmp(*given, text) != 0)
        argp_error(state, "--%s is given twice: %s and %s", o->name, *given, text);
    *given = text;
}

static int key_of(const sf_option *option, int list, int index) {
    return option->letter ? option->letter : FIRST_KEY + LIST_KEYS * list + index;
}

/* Reads an option into its member. */
static void take_option(const sf_option *o, char *values, const char *text, sf_error *err) {
    SF_PRINTED(name, 64, "--%s", o->name);
    if (o->noted)
        *(bool *)(values + o->noted) = true;
    if (o->read)
        o->read(name, text, values + o->member, err);
    else if (o->high > 0 && !sf_whole_is(text, o->low, o->high, (int *)(values + o->member)))
        SF_REFUSE(err, "%s %s: expected a whole number from %d to %d", name, text, o->low, o->high);
    else if (o->high > 0)
        return;
    else if (o->argument)
        *(const char **)(values + o->member) = text;
    else
        *(bool *)(values + o->member) = true;
}

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wformat-nonliteral" /* the format is that of the command */
static void take_operand(const sf_command *c, char *text, struct argp_state *state) {
    const char **operand = (const char **)((char *)c->list[0].values + c->operand);
    if (*operand)
        argp_error(state, c->second, text);
    *operand = text;
}
#pragma GCC diagnostic pop

static error_t take(int key, char *text, struct argp_state *state) {
    parser *p = state->input;
    const sf_command *c = p->command;
    const char *fault = key == ARGP_KEY_END && c->fault ? c->fault(c) : NULL;
    if (fault)
        argp_error(state, "%s", fault);
    if (key == ARGP_KEY_ARG)
        take_operand(c, text, state);
    if (key == ARGP_KEY_ARG || key == ARGP_KEY_END)
        return 0;
    for (int l = 0; l < LISTS; l++)
        for (int k = 0; c->list[l].option && c->list[l].option[k].name; k++) {
            if (key_of(&c->list[l].option[k], l, k) != key)
                continue;
            check_once(&c->list[l].option[k], &p->given[l][k], text, state);
            take_option(&c->list[l].option[k], c->list[l].values, text, p->err);
            if (p->err->status == SF_ERR_INPUT && c->is_usage)
                argp_error(state, "%s", p->err->text);
            return 0;
        }
    return ARGP_ERR_UNKNOWN;
}

sf_status sf_command_parse(const sf_command *c, int argc, char **argv, sf_error *err) {
    static char version[128];
    struct argp_option list[OPTIONS] = {0};
    parser p = {.command = c, .err = err};
    int count = 0;
    for (int l = 0; l < LISTS; l++)
        for (int k = 0; c->list[l].option && c->list[l].option[k].name && count < OPTIONS - 1; k++) {
            const sf_option *o = &c->list[l].option[k];
            list[count++] = (struct argp_option){o->name,     key_of(o, l, k),
                                                 o->argument, o->is_optional ? OPTION_ARG_OPTIONAL : 0,
                                                 o->meaning,  o->group};
        }
    snprintf(version, sizeof version, "%s " SF_VERSION " (" SF_GIT_REVISION ")", c->program);
    argp_program_version = version;
    const struct argp known = {.options = list, .parser = take, .args_doc = c->operands, .doc = c->meaning};
    if (argp_parse(&known, argc, argv, 0, NULL, &p) != 0)
        return SF_REFUSE(err, "the command line cannot be read");
    return err->status;
}

sf_status sf_program_read_limit(const char *option, const char *text, void *limit, sf_error *err) {
    if (!sf_decimal_is(text, limit) || !(*(double *)limit > 0))
        return SF_REFUSE(err, "%s %s: not a positive number", option, text);
    return SF_OK;
}

/* Tells of an option KEY=VALUE that a later one of the same key replaces. */
static void compare_texts(const char *option, const char *before, const char *text) {
    sf_sink sink = sf_program_sink(program_invocation_short_name);
    if (sf_text_contradicts(before, text))
        sf_sink_tell(&sink, SF_WARNING, "%s %s is replaced by the later %s %s", option, before, option, text);
}

sf_status sf_program_read_texts(const char *option, const char *text, void *texts, sf_error *err) {
    enum { MOST = sizeof((sf_option_texts *)0)->text / sizeof(char *) };
    sf_option_texts *all = texts;
    if (all->count == MOST)
        return SF_REFUSE(err, "%d %s options" SF_AT_MOST("%d"), MOST + 1, option, MOST);
    for (int k = 0; k < all->count; k++)
        compare_texts(option, all->text[k], text);
    all->text[all->count++] = text;
    return SF_OK;
}

int sf_error_report(const sf_error *err, const char *program) {
    sf_error last = *err;
    errno = 0;
    if (fflush(stdout) != 0 || ferror(stdout))
        SF_FAIL(&last, SF_ERR_IO, "the standard output cannot be written%s%s", errno ? ": " : "",
                errno ? strerror(errno) : "");
    if (last.status == SF_OK)
        return 0;
    if (getenv("SOFTFALL_DEBUG"))
        fprintf(stderr, "%s: [%s:%d] %s\n", program, last.where, last.line, last.text);
    else
        fprintf(stderr, "%s: %s\n", program, last.text);
    return (int)last.status;
}

static void print(void *user, sf_severity severity, const char *sentence) {
    const char *program = user;
    if (severity != SF_FACT)
        fprintf(stderr, "%s: %s: %s\n", program, severity == SF_WARNING ? "warning" : "note", sentence);
}

sf_sink sf_program_sink(const char *program) {
    return (sf_sink){print, (void *)(uintptr_t)program};
}
