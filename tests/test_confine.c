/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The confinement itself, without gmsh: a process that entered it tries everything. */
#include "pre/mesh/broker.h"
#include "pre/mesh/mesher_protocol.h"
#include "pre/mesher/confine.h"

#include <errno.h>
#include <fcntl.h>
#include <pthread.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>
#include <cmocka.h>

static char folder[] = "/tmp/softfall-confine-XXXXXX";
static char inside[64]; /* a file in it */

/* Each returns what the call returns; anything but -1 has broken out. */
static long try_execve(void) {
    return execl("/bin/true", "true", (char *)NULL);
}
static long try_execveat(void) {
    char *const words[] = {"true", NULL};
    return syscall(SYS_execveat, AT_FDCWD, "/bin/true", words, environ, 0);
}
static long try_fork(void) {
    return syscall(SYS_clone, SIGCHLD, 0, 0, 0, 0);
}
static long try_clone3(void) {
    uint64_t arguments[11] = {0};
    return syscall(SYS_clone3, arguments, sizeof arguments);
}
static long try_write(void) {
    return open(inside, O_WRONLY);
}
static long try_create(void) {
    return open("new", O_WRONLY | O_CREAT, 0600);
}
static long try_append(void) {
    return open(inside, O_RDWR | O_APPEND);
}
static long try_device(void) {
    return open("/dev/zero", O_RDONLY);
}
static long try_folder(void) {
    return open(".", O_RDONLY | O_DIRECTORY);
}
static long try_path(void) {
    return open(inside, O_PATH);
}
static long try_temporary(void) {
    return open(folder, O_TMPFILE | O_RDWR, 0600);
}
static long try_openat2(void) {
    uint64_t how[3] = {O_RDONLY, 0, 0};
    return syscall(SYS_openat2, AT_FDCWD, inside, how, sizeof how);
}
static long try_socket(void) {
    return socket(AF_INET, SOCK_STREAM, 0);
}
static long try_socketpair(void) {
    int two[2];
    return socketpair(AF_UNIX, SOCK_STREAM, 0, two);
}
static long try_ptrace(void) {
    return ptrace(PTRACE_TRACEME, 0, NULL, NULL);
}
static long try_attach(void) {
    return ptrace(PTRACE_SEIZE, getppid(), NULL, NULL);
}
static long try_memory_of_parent(void) {
    char byte;
    struct iovec here = {&byte, 1}, there = {&byte, 1};
    return process_vm_readv(getppid(), &here, 1, &there, 1, 0);
}
static long try_kill(void) {
    return kill(getppid(), SIGTERM);
}
static long try_tgkill(void) {
    return syscall(SYS_tgkill, getppid(), getppid(), SIGTERM);
}
static long try_pidfd(void) {
    return syscall(SYS_pidfd_open, getppid(), 0);
}
static long try_memfd(void) {
    return memfd_create("x", 0);
}
static long try_executable(void) {
    return mmap(NULL, 4096, PROT_READ | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) == MAP_FAILED ? -1 : 0;
}
static long try_mprotect(void) {
    static _Alignas(4096) char page[4096];
    return mprotect(page, sizeof page, PROT_READ | PROT_EXEC);
}
static long try_prctl(void) {
    return prctl(PR_SET_PDEATHSIG, 0);
}
static long try_mount(void) {
    return mount("none", folder, "tmpfs", 0, NULL);
}
static long try_unlink(void) {
    return unlink(inside);
}
static long try_rename(void) {
    return rename(inside, "moved");
}
static long try_mkdir(void) {
    return mkdir("made", 0700);
}
static long try_rmdir(void) {
    return rmdir(folder);
}
static long try_truncate(void) {
    return truncate(inside, 0);
}
static long try_chmod(void) {
    return chmod(inside, 0777);
}
static long try_chown(void) {
    return chown(inside, 1, 1);
}
static long try_link(void) {
    return link(inside, "link");
}
static long try_symlink(void) {
    return symlink(inside, "symlink");
}
static long try_mkfifo(void) {
    return mkfifo("fifo", 0600);
}
static long try_utime(void) {
    return utimensat(AT_FDCWD, inside, NULL, 0);
}
static long try_chdir(void) {
    return chdir("/");
}
static long try_chroot(void) {
    return chroot("/");
}
static long try_setuid(void) {
    return setuid(1);
}
static long try_limit(void) {
    const struct rlimit more = {1000, 1000};
    return setrlimit(RLIMIT_NOFILE, &more);
}
static long try_sigsys(void) {
    struct sigaction action = {.sa_handler = SIG_IGN};
    return sigaction(SIGSYS, &action, NULL);
}
static long try_ioctl(void) {
    return syscall(SYS_ioctl, 1, 0x5412, "x"); /* TIOCSTI */
}
static long try_duplicate(void) {
    return dup(1);
}
static long try_nonblocking(void) {
    return fcntl(1, F_SETFL, O_NONBLOCK);
}
static long try_bpf(void) {
    return syscall(SYS_bpf, 0, NULL, 0);
}
static long try_io_uring(void) {
    char parameters[120] = {0};
    return syscall(SYS_io_uring_setup, 1, parameters);
}
static long try_userfaultfd(void) {
    return syscall(SYS_userfaultfd, 0);
}
static long try_keyring(void) {
    return syscall(SYS_add_key, "user", "x", "x", 1, -3);
}
static long try_unshare(void) {
    return syscall(SYS_unshare, CLONE_NEWUSER);
}
static long try_pipe(void) {
    int two[2];
    return pipe(two);
}

#define TRIALS(X)                                                                                            \
    X(execve)                                                                                                \
    X(execveat)                                                                                              \
    X(fork)                                                                                                  \
    X(clone3)                                                                                                \
    X(write)                                                                                                 \
    X(create)                                                                                                \
    X(append)                                                                                                \
    X(device) X(folder) X(path) X(temporary) X(openat2) X(socket) X(socketpair) X(ptrace) X(attach)          \
        X(memory_of_parent) X(kill) X(tgkill) X(pidfd) X(memfd) X(executable) X(mprotect) X(prctl) X(mount)  \
            X(unlink) X(rename) X(mkdir) X(rmdir) X(truncate) X(chmod) X(chown) X(link) X(symlink) X(mkfifo) \
                X(utime) X(chdir) X(chroot) X(setuid) X(limit) X(sigsys) X(ioctl) X(duplicate)               \
                    X(nonblocking) X(bpf) X(io_uring) X(userfaultfd) X(keyring) X(unshare) X(pipe)
#define ROW(name) {#name, try_##name},
static const struct {
    const char *name;
    long (*call)(void);
} trials[] = {TRIALS(ROW)};

enum { COUNT = sizeof trials / sizeof trials[0] };

/* What the process found out. */
typedef struct findings {
    int filter;                /* errno value of sf_confine_calls */
    unsigned char open[COUNT]; /* 1: the call succeeded */
    char read[16];             /* of the file that it may read */
    int written;               /* errno value of writing to that file's descriptor */
    int too_long;              /* errno value of opening a path that is too long */
    int thread;                /* 1: a thread could read the file too */
} findings;

static void *read_in_thread(void *result) {
    int file = open(inside, O_RDONLY);
    char text[4] = "";
    *(int *)result = file >= 0 && read(file, text, 3) == 3 && strcmp(text, "con") == 0;
    close(file);
    return NULL;
}

/* In the child: nothing of cmocka. */
static void be_confined(int control, int data) {
    findings f = {0};
    pthread_t thread;
    dup2(control, SF_MESHER_CONTROL);
    dup2(data, SF_MESHER_DATA);
    sf_confine_resources(0, 20);
    f.filter = sf_confine_calls();
    for (int k = 0; k < COUNT && f.filter == 0; k++)
        f.open[k] = trials[k].call() != -1;
    int file = open(inside, O_RDONLY);
    f.written = file >= 0 && read(file, f.read, sizeof f.read - 1) > 0 && write(file, "x", 1) < 0 ? errno : 0;
    close(file);
    static char longest[5000];
    memset(longest, '/', sizeof longest - 1);
    f.too_long = open(longest, O_RDONLY) < 0 ? errno : 0;
    if (pthread_create(&thread, NULL, read_in_thread, &f.thread) == 0)
        pthread_join(thread, NULL);
    _exit(write(SF_MESHER_DATA, &f, sizeof f) != (ssize_t)sizeof f);
}

static void answer(int control, int error, int file) {
    sf_mesher_answer text = {error};
    union {
        struct cmsghdr header;
        char space[CMSG_SPACE(sizeof(int))];
    } space = {0};
    struct iovec part = {&text, sizeof text};
    struct msghdr message = {.msg_iov = &part, .msg_iovlen = 1};
    if (error == 0) {
        message.msg_control = &space;
        message.msg_controllen = sizeof space;
        space.header = (struct cmsghdr){.cmsg_len = CMSG_LEN(sizeof(int)), SOL_SOCKET, SCM_RIGHTS};
        memcpy(CMSG_DATA(&space.header), &file, sizeof file);
    }
    assert_true(sendmsg(control, &message, MSG_NOSIGNAL) >= 0);
}

/* Answers as the parent does; returns how often the child tried to start a program. */
static int serve(int control, sf_broker *broker) {
    static sf_mesher_ask ask;
    int programs = 0;
    while (recv(control, &ask, sizeof ask, 0) > 0) {
        int file = -1, error;
        programs += ask.kind == SF_ASK_PROGRAM;
        if (ask.kind != SF_ASK_OPEN)
            continue;
        error = sf_broker_open(broker, ask.text, ask.detail, &file);
        answer(control, error, file);
        if (file >= 0)
            close(file);
    }
    return programs;
}

static void nothing_leads_out(void **state) {
    int control[2], data[2], status = 0;
    findings f;
    sf_broker broker = {.parameters = "", .ready = true, .most = 1000};
    (void)state;
    assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, control), 0);
    assert_int_equal(pipe2(data, O_CLOEXEC), 0);
    for (int k = 0; k < 2; k++) { /* away from the numbers that the child gives them */
        control[k] = fcntl(control[k], F_DUPFD_CLOEXEC, 20);
        data[k] = fcntl(data[k], F_DUPFD_CLOEXEC, 20);
    }
    for (int k = 3; k < 20; k++)
        close(k);
    pid_t child = fork();
    if (child == 0) {
        close(control[0]);
        be_confined(control[1], data[1]);
    }
    close(control[1]);
    close(data[1]);
    int programs = serve(control[0], &broker);
    ssize_t size = read(data[0], &f, sizeof f);
    assert_int_equal(waitpid(child, &status, 0), child);
    if (size != (ssize_t)sizeof f)
        fail_msg("the process ended early (status %x)", (unsigned)status);
    assert_int_equal(f.filter, 0);
    for (int k = 0; k < COUNT; k++)
        if (f.open[k])
            fail_msg("%s is not refused", trials[k].name);
    assert_string_equal(f.read, "content\n"); /* the line end is the broker's */
    assert_int_not_equal(f.written, 0);
    assert_int_equal(f.too_long, ENAMETOOLONG);
    assert_int_equal(f.thread, 1);
    assert_int_equal(programs, 4); /* execve, execveat, fork, pipe */
    assert_int_equal(broker.count, 1);
    assert_string_equal(broker.written, inside);
    sf_broker_free(&broker);
    close(control[0]);
    close(data[0]);
}

static sf_broker_file *open_in(sf_broker *broker, const char *path, struct stat *info) {
    char byte = 0;
    int file = -1;
    assert_int_equal(sf_broker_open(broker, path, O_RDONLY, &file), 0);
    assert_int_equal(fstat(file, info), 0);
    assert_int_equal(read(file, &byte, 1), 1); /* from the beginning: each reader has its own place */
    assert_int_equal(byte, 'c');
    close(file);
    return &broker->file[broker->count - 1];
}

/* A file that includes itself a thousand times is in memory once. */
static void one_copy_serves_all_readers(void **state) {
    sf_broker broker = {.parameters = "", .ready = true, .most = 1000};
    struct stat first, again, other_name;
    (void)state;
    uint64_t hash = open_in(&broker, inside, &first)->hash;
    open_in(&broker, inside, &again);
    assert_int_equal(broker.count, 1);
    assert_int_equal(open_in(&broker, "./file", &other_name)->hash, hash);
    assert_int_equal(broker.count, 2);
    assert_int_equal(first.st_ino, again.st_ino);
    assert_int_equal(first.st_ino, other_name.st_ino);
    assert_int_equal(broker.bytes, 2 * strlen("content\n")); /* text and copy */
    sf_broker_free(&broker);
}

static void a_limit_of_file_sizes_is_named(void **state) {
    sf_broker broker = {.parameters = "", .ready = true, .most = 1000};
    struct rlimit limit, small = {4, 0};
    int file = -1;
    (void)state;
    getrlimit(RLIMIT_FSIZE, &limit);
    small.rlim_max = limit.rlim_max;
    setrlimit(RLIMIT_FSIZE, &small);
    int error = sf_broker_open(&broker, inside, O_RDONLY, &file);
    setrlimit(RLIMIT_FSIZE, &limit);
    assert_int_equal(error, EACCES);
    assert_non_null(strstr(broker.refused, "ulimit -f"));
    sf_broker_free(&broker);
}

static int set_up(void **state) {
    (void)state;
    if (!mkdtemp(folder) || chdir(folder) != 0)
        return 1;
    snprintf(inside, sizeof inside, "%s/file", folder);
    FILE *file = fopen(inside, "w");
    return !file || fputs("content", file) < 0 || fclose(file) != 0;
}

static int tear_down(void **state) {
    (void)state;
    return remove(inside) + remove(folder);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(nothing_leads_out),
                                       cmocka_unit_test(one_copy_serves_all_readers),
                                       cmocka_unit_test(a_limit_of_file_sizes_is_named)};
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
