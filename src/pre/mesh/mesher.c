/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/mesher.h"

#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <locale.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "build_info.h"
#include "io/plain_file.h"
#include "io/process.h"
#include "pre/mesh/geo_parameters.h"
#include "pre/mesh/mesher_spare.h"

double sf_memory_available(void) {
    const char *given = getenv("SOFTFALL_MEMORY_MB");
    char *end = NULL, line[128];
    double megabytes = given ? strtod(given, &end) : 0;
    if (given && end != given && *end == '\0' && megabytes > 0)
        return 1e6 * megabytes;
    long long kilobytes = -1;
    FILE *file = fopen("/proc/meminfo", "r");
    while (file && kilobytes < 0 && fgets(line, sizeof line, file))
        if (sscanf(line, "MemAvailable: %lld kB", &kilobytes) != 1)
            kilobytes = -1;
    if (file)
        fclose(file);
    return kilobytes < 0 ? INFINITY : 1024.0 * (double)kilobytes;
}

#define NAME "softfall-mesh"

static bool is_there(char *path, size_t size, const char *folder, const char *below) {
    return snprintf(path, size, "%s%s/%s", folder, below, NAME) < (int)size && access(path, X_OK) == 0;
}

/* Finds the program beside `file`, or in its neighbourhood. */
static bool find_near(const char *file, char *path, size_t size) {
    static const char *const below[] = {"", "/../libexec/softfall", "/../../libexec/softfall", "/../bin"};
    char folder[PATH_MAX];
    if (!realpath(file, folder))
        return false;
    *strrchr(folder, '/') = '\0';
    for (size_t k = 0; k < sizeof below / sizeof below[0]; k++)
        if (is_there(path, size, folder, below[k]))
            return true;
    return false;
}

sf_status sf_mesher_find(char *path, size_t size, sf_error *err) {
    const char *given = getenv("SF_BIN_DIR");
    Dl_info here;
    if (given && *given && is_there(path, size, given, ""))
        return SF_OK;
    if (find_near("/proc/self/exe", path, size) ||
        (dladdr((const void *)(uintptr_t)sf_mesher_find, &here) != 0 &&
         find_near(here.dli_fname, path, size)) ||
        is_there(path, size, SF_LIBEXEC_DIR, ""))
        return SF_OK;
    return SF_FAIL(err, SF_ERR_IO,
                   "the program " NAME
                   ", which reads geometries, is missing: it belongs into libexec/softfall beside the folder "
                   "of this program (%s)",
                   SF_LIBEXEC_DIR);
}

typedef struct mesher_child {
    pid_t process;
    int control, data, print; /* this side of the child's files (mesher_protocol.h) */
} mesher_child;

/* The child's ends, out of the way of the numbers that they get there. */
typedef struct ends {
    int control, data, print, parameters, spare;
} ends;

static int lift(int file) {
    int lifted = file >= 0 ? fcntl(file, F_DUPFD_CLOEXEC, 10) : -1;
    if (file >= 0)
        close(file);
    return lifted;
}

static void close_ends(const ends *e) {
    const int file[] = {e->control, e->data, e->print, e->parameters, e->spare};
    for (size_t k = 0; k < sizeof file / sizeof file[0]; k++)
        if (file[k] >= 0)
            close(file[k]);
}

static void close_all(const mesher_child *child, const ends *e) {
    close_ends(e);
    close_ends(&(ends){child->control, child->data, child->print, -1, -1});
}

static bool make_ends(const char *parameters, mesher_child *child, ends *e) {
    int control[2] = {-1, -1}, data[2] = {-1, -1}, print[2] = {-1, -1};
    bool made = socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, control) == 0 &&
                pipe2(data, O_CLOEXEC) == 0 && pipe2(print, O_CLOEXEC) == 0;
    child->control = control[0];
    child->data = data[0];
    child->print = print[0];
    *e = (ends){lift(control[1]), lift(data[1]), lift(print[1]),
                lift(sf_broker_memory(parameters, strlen(parameters))), -1};
    return made && e->control >= 0 && e->data >= 0 && e->print >= 0 && e->parameters >= 0;
}

static int prepare(posix_spawn_file_actions_t *actions, const ends *e) {
    const int pairs[][2] = {{e->print, 1},
                            {e->print, 2},
                            {e->control, SF_MESHER_CONTROL},
                            {e->data, SF_MESHER_DATA},
                            {e->parameters, SF_MESHER_PARAMETERS},
                            {e->spare, SF_MESHER_SPARE}};
    const int count = (int)(sizeof pairs / sizeof pairs[0]) - (e->spare < 0);
    int result = posix_spawn_file_actions_addopen(actions, 0, "/dev/null", O_RDONLY, 0);
    for (int k = 0; k < count && result == 0; k++)
        result = posix_spawn_file_actions_adddup2(actions, pairs[k][0], pairs[k][1]);
    return result == 0 ? posix_spawn_file_actions_addclosefrom_np(actions, pairs[count - 1][1] + 1) : result;
}

/* The child inherits only the places of libraries from the user's environment. The options are for the
 * sanitizers of a test build: gmsh crashes, and keeps memory. */
static int spawn(const char *path, const posix_spawn_file_actions_t *actions,
                 const posix_spawnattr_t *attributes, pid_t *process) {
    static const char sanitizers[] =
        "detect_leaks=0:handle_segv=0:handle_abort=0:handle_sigbus=0:handle_sigfpe=0:handle_sigill="
        "0";
    char name[] = NAME, home[] = "HOME=/dev/null", locale[] = "LC_ALL=C", threads[] = "OMP_NUM_THREADS=1",
         libraries[PATH_MAX + 32] = "LD_LIBRARY_PATH=", asan[256], ubsan[256];
    const char *given = getenv("LD_LIBRARY_PATH");
    snprintf(asan, sizeof asan, "ASAN_OPTIONS=%s", sanitizers);
    snprintf(ubsan, sizeof ubsan, "UBSAN_OPTIONS=%s", sanitizers);
    char *const arguments[] = {name, NULL};
    char *environment[] = {home, locale, threads, asan, ubsan, NULL, NULL};
    if (given && *given) {
        snprintf(libraries, sizeof libraries, "LD_LIBRARY_PATH=%s", given);
        environment[5] = libraries;
    }
    return posix_spawn(process, path, actions, attributes, arguments, environment);
}

/* Signals as in a fresh program; those that users send stay ignored if they are (nohup). */
static int prepare_signals(posix_spawnattr_t *attributes) {
    static const int sent[] = {SIGHUP, SIGINT, SIGQUIT, SIGTERM};
    sigset_t all, none;
    sigfillset(&all);
    for (size_t k = 0; k < sizeof sent / sizeof sent[0]; k++)
        sigdelset(&all, sent[k]);
    sigemptyset(&none);
    int result = posix_spawnattr_setflags(attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK);
    if (result == 0)
        result = posix_spawnattr_setsigdefault(attributes, &all);
    return result == 0 ? posix_spawnattr_setsigmask(attributes, &none) : result;
}

/* Starts the program; returns an errno value. */
static int start_program(const char *path, sf_mesher_spare *spare, ends *e, pid_t *process) {
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    e->spare = spare ? lift(sf_mesher_spare_prepare(spare)) : -1;
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    int result = prepare(&actions, e);
    if (result == 0)
        result = prepare_signals(&attributes);
    if (result == 0)
        result = spawn(path, &actions, &attributes, process);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    return result;
}

/* The child, of the spare or of the program, gets `parameters` as a file, a small environment and no other
 * open files. */
static sf_status start(const char *parameters, sf_mesher_spare *spare, mesher_child *child, sf_error *err) {
    char path[PATH_MAX];
    ends e;
    SF_TRY(sf_mesher_find(path, sizeof path, err));
    int result = make_ends(parameters, child, &e) ? 0 : errno;
    if (result == 0 && spare && spare->is_open) {
        child->process = sf_mesher_spare_fork(spare, (int[]){e.control, e.data, e.parameters, e.print});
        if (child->process == 0) { /* it may have handed on the files: the program gets others */
            close_all(child, &e);
            result = make_ends(parameters, child, &e) ? 0 : errno;
        }
    }
    if (result == 0 && child->process == 0)
        result = start_program(path, spare, &e, &child->process);
    if (result != 0) {
        close_all(child, &e);
        return SF_FAIL(err, SF_ERR_IO, "%s cannot be started: %s", path, strerror(result));
    }
    close_ends(&e);
    return SF_OK;
}

enum { LINE_SIZE = 400, REPORT_SECONDS = 10, MOST_MESSAGES = 100000 };

/* A child at work, and what it has said. */
typedef struct conversation {
    const sf_geo_source *source;
    const sf_mesher_limits *limits;
    double seconds, bytes; /* limits of processor time and memory */
    bool confined;
    mesher_child child;
    sf_broker broker;
    char *stream;
    size_t size, capacity;
    char line[LINE_SIZE], last_line[LINE_SIZE], error_line[LINE_SIZE]; /* of what gmsh prints */
    size_t line_length;
    bool program, memory, late, stopped; /* it tried to start one; lacked it; took too long; was ended here */
    bool lingers, waits;                 /* it closed everything and did not end; it did nothing for long */
    double worked, idle; /* seconds of processor time; of waiting, less a hundred times those of work since */
    int no_filter, messages, status; /* errno value of the filter; count; of wait */
} conversation;

/* Units in which gmsh can hand out STEP and IGES files, which know their own; without a target it is mm. */
static const struct {
    const char *name;
    double size; /* m */
} targets[] = {{"CM", 1e-2}, {"M", 1}, {"INCH", 0.0254}, {"FT", 0.3048}};

/* The .geo text that sets the parameters, and the unit; from malloc. The decimal point is a point in any
 * locale. */
static char *parameter_text(const sf_geo_source *source) {
    char *text = NULL;
    size_t size = 0;
    locale_t c = newlocale(LC_ALL_MASK, "C", (locale_t)0), before = c ? uselocale(c) : (locale_t)0;
    FILE *out = c ? open_memstream(&text, &size) : NULL;
    if (out)
        fputs("Delete Variables;\n", out);
    for (size_t k = 0; out && k < sizeof targets / sizeof *targets; k++)
        if (fabs(source->unit / targets[k].size - 1) < 1e-9)
            fprintf(out, "Geometry.OCCTargetUnit = \"%s\";\n", targets[k].name);
    for (int k = 0; out && k < source->parameter_count; k++)
        fprintf(out, "%s = %.17g;\n", source->parameter[k].name, source->parameter[k].value);
    if (out)
        fclose(out);
    if (c) {
        uselocale(before);
        freelocale(c);
    }
    return text;
}

/* ---- what the child says ---- */

static void stop(conversation *c) {
    kill(c->child.process, SIGKILL);
    c->stopped = true;
}

/* Never waits for the child to read. */
static void answer(conversation *c, int error, int file, sf_error *err) {
    sf_mesher_answer text = {error};
    union {
        struct cmsghdr header;
        char space[CMSG_SPACE(sizeof(int))];
    } control = {0};
    struct iovec part = {&text, sizeof text};
    struct msghdr message = {.msg_iov = &part, .msg_iovlen = 1};
    if (error == 0) {
        message.msg_control = &control;
        message.msg_controllen = sizeof control;
        control.header = (struct cmsghdr){.cmsg_len = CMSG_LEN(sizeof(int)), SOL_SOCKET, SCM_RIGHTS};
        memcpy(CMSG_DATA(&control.header), &file, sizeof file);
    }
    ssize_t sent;
    do
        sent = sendmsg(c->child.control, &message, MSG_NOSIGNAL | MSG_DONTWAIT);
    while (sent < 0 && errno == EINTR);
    if (sent >= 0 || errno == EPIPE || errno == ECONNRESET) /* it has ended: what it printed is still read */
        return;
    SF_REFUSE(err, "%s: gmsh asks for files without reading the answers (%s)", c->source->path,
              strerror(errno));
    stop(c);
}

/* False: the conversation is over. */
static bool hear_message(conversation *c, sf_error *err) {
    static const sf_mesher_ask none;
    sf_mesher_ask ask = none;
    ssize_t size = recv(c->child.control, &ask, sizeof ask, MSG_DONTWAIT);
    if (size < 0)
        return errno == EINTR || errno == EAGAIN;
    if (size == 0)
        return false;
    ask.text[sizeof ask.text - 1] = '\0';
    if (++c->messages > MOST_MESSAGES) {
        SF_REFUSE(err, "%s: the geometry opens files without end", c->source->path);
        stop(c);
        return true;
    }
    switch ((sf_mesher_ask_kind)ask.kind) {
    case SF_ASK_READY:
        c->broker.ready = true;
        break;
    case SF_ASK_PARSED:
        if (sf_geo_parameters_check(c->source, &c->broker, c->confined, err) != SF_OK)
            stop(c);
        break;
    case SF_ASK_OPEN: {
        int file = -1, error = sf_broker_open(&c->broker, ask.text, ask.detail, &file);
        answer(c, error, file, err);
        if (file >= 0)
            close(file);
        break;
    }
    case SF_ASK_PROGRAM:
        c->program = true;
        stop(c);
        break;
    case SF_ASK_MEMORY:
        c->memory = true;
        break;
    case SF_ASK_NO_FILTER:
        c->no_filter = ask.detail > 0 ? ask.detail : EINVAL;
        break;
    }
    return true;
}

/* More of the mesh stream. False: it is over. */
static bool hear_data(conversation *c, sf_error *err) {
    if (c->capacity - c->size < 65536) {
        size_t capacity = c->capacity ? 2 * c->capacity : (size_t)1 << 20;
        char *grown = (double)capacity > c->bytes ? NULL : realloc(c->stream, capacity);
        if (!grown) {
            SF_REFUSE(err, "%s: its mesh does not fit into %.3g GB of memory", c->source->path,
                      1e-9 * c->bytes);
            stop(c);
            return false;
        }
        c->stream = grown;
        c->capacity = capacity;
    }
    ssize_t size = read(c->child.data, c->stream + c->size, c->capacity - c->size);
    c->size += size > 0 ? (size_t)size : 0;
    return size > 0 || (size < 0 && errno == EINTR);
}

static void end_line(conversation *c) {
    c->line[c->line_length] = '\0';
    c->line_length = 0;
    if (c->line[strspn(c->line, " ")] == '\0')
        return;
    snprintf(c->last_line, sizeof c->last_line, "%s", c->line);
    if (*c->error_line == '\0' && strncmp(c->line, "Error", 5) == 0)
        snprintf(c->error_line, sizeof c->error_line, "%s", c->line + 5 + strspn(c->line + 5, " :"));
}

/* Receives a line that gmsh prints: only its last line and its first error are kept. */
static bool hear_print(conversation *c) {
    char text[4096];
    ssize_t size = read(c->child.print, text, sizeof text);
    for (ssize_t k = 0; k < size; k++)
        if (text[k] == '\n' || text[k] == '\r')
            end_line(c);
        else if (c->line_length < sizeof c->line - 1)
            c->line[c->line_length++] = text[k];
    return size > 0 || (size < 0 && errno == EINTR);
}

static void tell_progress(const conversation *c, double elapsed) {
    const char *what = strchr(c->last_line, ':');
    sf_sink_tell(c->limits->sink, SF_NOTE,
                 "%s: gmsh has worked for %.0f s (it may take %g s of processor time)%s%s", c->source->path,
                 elapsed, c->seconds, what ? ":" : "", what ? what + 1 : "");
}

/* Seconds of processor time that the child has taken. */
static double processor_time(const conversation *c) {
    clockid_t clock;
    struct timespec t;
    if (clock_getcpuclockid(c->child.process, &clock) != 0 || clock_gettime(clock, &t) != 0)
        return c->worked;
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Ends a child that did not limit its own processor time, and one that uses less than a hundredth of a
 * processor for long. `step`: seconds since the last look, of which few count: both processes may have been
 * stopped meanwhile. */
static void watch(conversation *c, double step) {
    double worked = processor_time(c), patience = fmin(fmax(c->seconds, 5), 60);
    c->idle = fmax(0, c->idle + fmin(step, 2) - 100 * (worked - c->worked));
    c->worked = worked;
    c->late = worked > c->seconds + 2;
    c->waits = c->idle > patience;
    if (c->late || c->waits)
        stop(c);
}

/* Until the child has closed everything, or was stopped. */
static void converse(conversation *c, sf_error *err) {
    struct pollfd channel[] = {
        {c->child.control, POLLIN, 0}, {c->child.data, POLLIN, 0}, {c->child.print, POLLIN, 0}};
    double begin = sf_process_now(), told = 0, seen = 0;
    while (!c->stopped && (channel[0].fd >= 0 || channel[1].fd >= 0 || channel[2].fd >= 0)) {
        int ready = poll(channel, 3, 1000);
        double elapsed = sf_process_now() - begin;
        if (elapsed > told + REPORT_SECONDS) {
            told = elapsed;
            tell_progress(c, elapsed);
        }
        if (elapsed > seen + 0.9) {
            watch(c, elapsed - seen);
            seen = elapsed;
        }
        if (ready <= 0)
            continue;
        if (channel[0].revents && !hear_message(c, err))
            channel[0].fd = -1;
        if (channel[1].revents && !hear_data(c, err))
            channel[1].fd = -1;
        if (channel[2].revents && !hear_print(c))
            channel[2].fd = -1;
    }
    end_line(c);
}

/* ---- what became of it ---- */

/* Adds the forbidden actions of the geometry to the message when gmsh fails. */
__attribute__((format(printf, 3, 4))) static sf_status fail(const conversation *c, sf_error *err,
                                                            const char *format, ...) {
    char what[sizeof err->text], more[700] = "";
    SF_PRINT_INTO(what, format);
    if (*c->broker.written)
        snprintf(more, sizeof more, "; it tried to write %s, which a geometry may not", c->broker.written);
    else if (*c->broker.refused)
        snprintf(more, sizeof more, "; %s", c->broker.refused);
    return SF_REFUSE(err, "%s: %s%s", c->source->path, what, more);
}

static sf_status judge_ending(const conversation *c, sf_error *err) {
    int signal_number = WIFSIGNALED(c->status) ? WTERMSIG(c->status) : 0;
    const char *line = strncmp(c->last_line, "Info", 4) == 0 ? "" : c->last_line;
    if (*c->error_line)
        line = c->error_line;
    if (c->no_filter)
        return SF_FAIL(err, SF_ERR_IO,
                       "%s: this kernel cannot keep gmsh from harm (seccomp: %s); SOFTFALL_UNCONFINED=1 in "
                       "the environment runs it nevertheless, for geometries that you trust",
                       c->source->path, strerror(c->no_filter));
    if (c->program || signal_number == SIGSYS) /* where signals are blocked, the trap kills */
        return SF_REFUSE(err, "%s: the geometry tried to start a program, which it may not", c->source->path);
    if (signal_number == SIGHUP || signal_number == SIGINT || signal_number == SIGQUIT ||
        signal_number == SIGTERM)
        return SF_FAIL(err, SF_INTERRUPTED, "%s: interrupted (%s) while gmsh was at work", c->source->path,
                       strsignal(signal_number));
    if (c->memory || strstr(c->last_line, "bad_alloc"))
        return fail(c, err,
                    "gmsh asked for more than the %.3g GB of memory that are available: take a coarser mesh, "
                    "or set SOFTFALL_MEMORY_MB",
                    1e-9 * c->bytes);
    if (c->late || signal_number == SIGXCPU)
        return fail(
            c, err,
            "gmsh took more than %g s of processor time: raise geometry.time_limit, or take a coarser "
            "mesh",
            c->seconds);
    if (c->waits || c->lingers)
        return fail(c, err,
                    c->waits ? "gmsh waits without working" : "gmsh closed its pipes, but did not end");
    if (signal_number)
        return fail(c, err, "gmsh crashed (%s)%s%s", strsignal(signal_number), *line ? ": " : "", line);
    return fail(c, err, "gmsh ended without a mesh%s%s", *line ? ": " : "", line);
}

static sf_status judge(conversation *c, sf_meshed *out, sf_error *err) {
    bool ended = WIFEXITED(c->status) && WEXITSTATUS(c->status) == 0;
    SF_TRY(err->status);
    if (!ended || c->program || c->memory || c->late || c->waits || c->no_filter || c->size == 0)
        return judge_ending(c, err);
    SF_TRY(sf_geo_data_read(c->stream, c->size, c->source->path, &out->data, err));
    const char *said = out->data.error;
    if (!*said)
        return SF_OK;
    return fail(c, err, strncmp(said, "it holds ", 9) == 0 ? "%s" : "gmsh, %s", said);
}

static void send_request(const conversation *c, sf_error *err) {
    sf_mesher_request request = {.version = SF_MESHER_VERSION,
                                 .confined = c->confined,
                                 .bytes = c->bytes < 1e15 ? (uint64_t)c->bytes : 0,
                                 .seconds = (uint64_t)ceil(c->seconds)};
    if (sf_path_print(request.path, sizeof request.path, err, "%s", c->source->path) == SF_OK &&
        send(c->child.control, &request, sizeof request, MSG_NOSIGNAL) != (ssize_t)sizeof request)
        SF_FAIL(err, SF_ERR_IO, "softfall-mesh does not listen: %s", strerror(errno));
}

/* The child has closed everything and has a moment to end. False: it was still there, and was killed. */
static bool end_soon(conversation *c) {
    const struct timespec pause = {0, 1000000};
    for (int k = 0; k < 2000 && !c->stopped; k++) {
        siginfo_t info = {0};
        if (waitid(P_PID, (id_t)c->child.process, &info, WEXITED | WNOHANG | WNOWAIT) != 0 ||
            info.si_pid != 0)
            return true;
        nanosleep(&pause, NULL);
    }
    kill(c->child.process, SIGKILL);
    return c->stopped;
}

static void end(conversation *c) {
    close(c->child.control);
    close(c->child.data);
    close(c->child.print);
    c->lingers = !end_soon(c);
    while (waitpid(c->child.process, &c->status, 0) < 0)
        if (errno != EINTR) {
            c->status = 0; /* the host takes the ends of children itself: the stream tells */
            break;
        }
}

/* Refuses what gmsh would take for a geometry in its own language, with a sentence of its own: nothing, and a
 * deck of Abaqus or CalculiX. */
static sf_status check_content(const char *path, sf_error *err) {
    char begin[512];
    int handle;
    uint64_t size = 0;
    SF_TRY(sf_plain_open(path, "geometry", &handle, &size, err));
    ssize_t count = pread(handle, begin, sizeof begin - 1, 0);
    close(handle);
    begin[count > 0 ? count : 0] = '\0';
    if (size == 0)
        return SF_REFUSE(err, "the geometry %s is empty", path);
    if (begin[strspn(begin, " \t\r\n")] == '*')
        return SF_REFUSE(
            err,
            "the geometry %s is a deck of Abaqus or CalculiX (.inp), which gmsh does not read: save its "
            "mesh as .msh, .unv or .vtk",
            path);
    return SF_OK;
}

sf_status sf_mesher_run(const sf_geo_source *source, const sf_mesher_limits *limits, sf_meshed *out,
                        sf_error *err) {
    const char *unconfined = getenv("SOFTFALL_UNCONFINED");
    sf_geo_source scaled;
    conversation c = {.source = source,
                      .limits = limits,
                      .seconds = limits->seconds > 0 ? limits->seconds : SF_MESHER_SECONDS,
                      .bytes = sf_memory_available(),
                      .confined = !unconfined || strcmp(unconfined, "1") != 0};
    memset(out, 0, sizeof *out);
    SF_TRY(sf_geo_parameters_scale(source, &scaled, err));
    SF_OWNED char *parameters = parameter_text(&scaled);
    if (!parameters)
        SF_NO_MEMORY(err, "the parameters of %s", source->path);
    c.broker.parameters = parameters;
    c.broker.most = c.bytes < 0x1p34 ? (uint64_t)(c.bytes / 4) : (uint64_t)1 << 32;
    if (err->status == SF_OK && check_content(source->path, err) == SF_OK &&
        start(parameters, limits->spare, &c.child, err) == SF_OK) {
        send_request(&c, err);
        if (err->status != SF_OK)
            stop(&c);
        converse(&c, err);
        end(&c);
        judge(&c, out, err);
    }
    c.broker.parameters = NULL;
    out->stream = c.stream;
    out->size = c.size;
    out->broker = c.broker;
    out->confined = c.confined;
    if (err->status != SF_OK)
        sf_meshed_free(out);
    return err->status;
}

void sf_meshed_free(sf_meshed *meshed) {
    sf_geo_data_free(&meshed->data);
    sf_broker_free(&meshed->broker);
    SF_CLEAR(meshed, meshed->stream);
}
