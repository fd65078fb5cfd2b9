/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesher/confine.h"

#include "pre/mesh/mesher_protocol.h"
#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <seccomp.h>
#include <signal.h>
#include <stdatomic.h>
#include <stddef.h>
#include <stdio.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <ucontext.h>
#include <unistd.h>

enum { OPEN_FILES = 64 };

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define UNLIMITED_ADDRESSES
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define UNLIMITED_ADDRESSES
#endif
#endif

static void limit(__rlimit_resource_t resource, uint64_t soft, uint64_t hard) {
    const struct rlimit value = {(rlim_t)soft, (rlim_t)hard};
    setrlimit(resource, &value);
}

/* Bytes of addresses that are mapped now. */
static uint64_t mapped(void) {
    unsigned long long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file && fscanf(file, "%llu", &pages) != 1)
        pages = 0;
    if (file)
        fclose(file);
    return (uint64_t)pages * (uint64_t)sysconf(_SC_PAGESIZE);
}

/* When the memory of the machine runs out, this process is ended and no other. */
static void be_first_victim(void) {
    FILE *file = fopen("/proc/self/oom_score_adj", "w");
    if (file) {
        fputs("1000", file);
        fclose(file);
    }
}

void sf_confine_resources(uint64_t bytes, uint64_t seconds) {
    be_first_victim();
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    signal(SIGXFSZ, SIG_IGN); /* writing then fails */
    limit(RLIMIT_CORE, 0, 0);
    limit(RLIMIT_FSIZE, 0, 0);
    limit(RLIMIT_NOFILE, OPEN_FILES, OPEN_FILES);
    if (seconds > 0)
        limit(RLIMIT_CPU, seconds, seconds + 5);
#ifdef UNLIMITED_ADDRESSES
    bytes = 0;
#endif
    if (bytes > 0)
        limit(RLIMIT_AS, bytes + mapped(), bytes + mapped());
}

/* ---- the handler of trapped calls: async-signal-safe ---- */

#if defined(__x86_64__)
#define ARGUMENT(context, n) ((context)->uc_mcontext.gregs[argument_register[n]])
#define RESULT(context) ((context)->uc_mcontext.gregs[REG_RAX])
static const int argument_register[] = {REG_RDI, REG_RSI, REG_RDX};
#elif defined(__aarch64__)
#define ARGUMENT(context, n) ((context)->uc_mcontext.regs[n])
#define RESULT(context) ((context)->uc_mcontext.regs[0])
#else
#define NO_HANDLER
#endif

#ifndef NO_HANDLER

static atomic_flag busy = ATOMIC_FLAG_INIT; /* one conversation at a time, for `ask` and the socket */
static sf_mesher_ask ask;

static void send_ask(sf_mesher_ask_kind kind, int detail, const char *text) {
    size_t length = strlen(text); /* less than there is room */
    ask.kind = (uint32_t)kind;
    ask.detail = detail;
    memcpy(ask.text, text, length);
    ask.text[length] = '\0';
    while (write(SF_MESHER_CONTROL, &ask, offsetof(sf_mesher_ask, text) + length + 1) < 0 && errno == EINTR)
        ;
}

/* The file that the parent sends, or -errno. */
static int receive_file(void) {
    sf_mesher_answer answer = {EIO};
    union {
        struct cmsghdr header;
        char space[CMSG_SPACE(sizeof(int))];
    } control;
    struct iovec part = {&answer, sizeof answer};
    struct msghdr message = {
        .msg_iov = &part, .msg_iovlen = 1, .msg_control = &control, .msg_controllen = sizeof control};
    ssize_t got;
    do
        got = recvmsg(SF_MESHER_CONTROL, &message, MSG_CMSG_CLOEXEC);
    while (got < 0 && errno == EINTR);
    if (got != (ssize_t)sizeof answer)
        return -EIO;
    if (answer.error != 0)
        return -answer.error;
    const struct cmsghdr *header = CMSG_FIRSTHDR(&message);
    int file = -1;
    if ((message.msg_flags & MSG_CTRUNC) || !header || header->cmsg_type != SCM_RIGHTS)
        return -EMFILE;
    memcpy(&file, CMSG_DATA(header), sizeof file);
    return file;
}

static int ask_for_file(const char *path, int flags) {
    if (strnlen(path, sizeof ask.text) == sizeof ask.text)
        return -ENAMETOOLONG;
    while (atomic_flag_test_and_set(&busy))
        sched_yield();
    send_ask(SF_ASK_OPEN, flags, path);
    int file = receive_file();
    atomic_flag_clear(&busy);
    return file;
}

static int tell_of_program(void) {
    while (atomic_flag_test_and_set(&busy))
        sched_yield();
    send_ask(SF_ASK_PROGRAM, 0, "");
    atomic_flag_clear(&busy);
    return -EPERM;
}

/* In place of the system call; its result is that of the call. */
static void trapped(int number, siginfo_t *info, void *place) {
    ucontext_t *context = place;
    int kept = errno, result;
    (void)number;
    switch (info->si_syscall) {
#ifdef SYS_open
    case SYS_open:
        result = ask_for_file((const char *)ARGUMENT(context, 0), (int)ARGUMENT(context, 1));
        break;
#endif
#ifdef SYS_creat
    case SYS_creat:
        result = ask_for_file((const char *)ARGUMENT(context, 0), O_WRONLY | O_CREAT);
        break;
#endif
    case SYS_openat: {
        const char *path = (const char *)ARGUMENT(context, 1);
        bool elsewhere = (int)ARGUMENT(context, 0) != AT_FDCWD && *path != '/';
        result = elsewhere ? -EACCES : ask_for_file(path, (int)ARGUMENT(context, 2));
        break;
    }
    default:
        result = tell_of_program();
    }
    errno = kept;
    RESULT(context) = result;
}

/* ---- the list ---- */

/* Without these gmsh and the C library do not run. What takes the name of a file only looks at it. */
/* clang-format off */
static const char *const allowed[] = {
    "read", "write", "readv", "writev", "pread64", "lseek", "close", "fstat", "newfstatat", "stat", "lstat",
    "statx", "access", "faccessat", "faccessat2", "readlink", "readlinkat", "getcwd", "munmap", "mremap",
    "madvise", "brk", "futex", "sched_yield", "sched_getaffinity", "sched_getparam", "sched_getscheduler",
    "getcpu", "getpid", "gettid", "getppid", "getuid", "geteuid", "getgid", "getegid", "getrusage", "times",
    "clock_gettime", "clock_getres", "gettimeofday", "time", "sysinfo", "uname", "rt_sigprocmask",
    "rt_sigreturn", "sigaltstack", "exit", "exit_group", "set_robust_list", "get_robust_list",
    "set_tid_address", "rseq", "membarrier", "getrandom", "getrlimit", "poll", "ppoll", "restart_syscall"};
/* clang-format on */

static int allow_list(scmp_filter_ctx filter) {
    int code = 0;
    for (size_t k = 0; k < sizeof allowed / sizeof allowed[0] && code == 0; k++) {
        int number = seccomp_syscall_resolve_name(allowed[k]);
        if (number >= 0)
            code = seccomp_rule_add(filter, SCMP_ACT_ALLOW, number, 0);
    }
    return code;
}

/* No memory becomes executable, no flag of a file changes, no signal goes elsewhere, no limit changes. */
static int allow_some_arguments(scmp_filter_ctx filter) {
    const struct {
        int number;
        struct scmp_arg_cmp argument;
    } rule[] = {
        {SCMP_SYS(mmap), SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0)},
        {SCMP_SYS(mprotect), SCMP_A2(SCMP_CMP_MASKED_EQ, PROT_EXEC, 0)},
        {SCMP_SYS(fcntl), SCMP_A1(SCMP_CMP_EQ, F_GETFL, 0)},
        {SCMP_SYS(fcntl), SCMP_A1(SCMP_CMP_EQ, F_GETFD, 0)},
        {SCMP_SYS(fcntl), SCMP_A1(SCMP_CMP_EQ, F_SETFD, 0)},
        {SCMP_SYS(recvmsg), SCMP_A0(SCMP_CMP_EQ, SF_MESHER_CONTROL, 0)},
        {SCMP_SYS(rt_sigaction), SCMP_A0(SCMP_CMP_NE, SIGSYS, 0)},
        {SCMP_SYS(tgkill), SCMP_A0(SCMP_CMP_EQ, (scmp_datum_t)getpid(), 0)},
        {SCMP_SYS(prlimit64), SCMP_A2(SCMP_CMP_EQ, 0, 0)},
        {SCMP_SYS(clone), SCMP_A0(SCMP_CMP_MASKED_EQ, CLONE_THREAD, CLONE_THREAD)},
    };
    int code = 0;
    for (size_t k = 0; k < sizeof rule / sizeof rule[0] && code == 0; k++)
        code = seccomp_rule_add_array(filter, SCMP_ACT_ALLOW, rule[k].number, 1, &rule[k].argument);
    return code;
}

static int answer_others(scmp_filter_ctx filter) {
    static const int trapped[] = {SCMP_SYS(open),   SCMP_SYS(openat),   SCMP_SYS(creat),
                                  SCMP_SYS(execve), SCMP_SYS(execveat), SCMP_SYS(fork),
                                  SCMP_SYS(vfork),  SCMP_SYS(pipe),     SCMP_SYS(pipe2)};
    int code = 0;
    for (size_t k = 0; k < sizeof trapped / sizeof trapped[0] && code == 0; k++)
        code = seccomp_rule_add(filter, SCMP_ACT_TRAP, trapped[k], 0);
    if (code == 0)
        code = seccomp_rule_add(filter, SCMP_ACT_TRAP, SCMP_SYS(clone), 1,
                                SCMP_A0(SCMP_CMP_MASKED_EQ, CLONE_THREAD, 0));
    if (code == 0) /* the C library then uses clone, whose flags a filter can see */
        code = seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOSYS), SCMP_SYS(clone3), 0);
    if (code == 0)
        code = seccomp_rule_add(filter, SCMP_ACT_ERRNO(ENOTTY), SCMP_SYS(ioctl), 0);
    return code;
}

int sf_confine_calls(void) {
    struct sigaction action = {.sa_sigaction = trapped, .sa_flags = SA_SIGINFO | SA_NODEFER};
    scmp_filter_ctx filter = seccomp_init(SCMP_ACT_ERRNO(EPERM));
    if (!filter)
        return ENOSYS;
    int code = seccomp_attr_set(filter, SCMP_FLTATR_ACT_BADARCH, SCMP_ACT_KILL_PROCESS);
    if (code == 0 && sigaction(SIGSYS, &action, NULL) != 0)
        code = -errno;
    if (code == 0)
        code = allow_list(filter);
    if (code == 0)
        code = allow_some_arguments(filter);
    if (code == 0)
        code = answer_others(filter);
    if (code == 0)
        code = seccomp_load(filter);
    seccomp_release(filter);
    return -code;
}

#else

int sf_confine_calls(void) {
    return ENOSYS;
}

#endif
