/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesher/serve.h"

#include "pre/mesh/mesher_protocol.h"
#include <errno.h>
#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <stdio.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

/* A fork of a process of one thread, whose parent is the host, which waits for it: not by fork(), of which
 * the parent is this process. */
static pid_t fork_sibling(void) {
    return (pid_t)syscall(SYS_clone, (long)(CLONE_PARENT | SIGCHLD), 0L, 0L, 0L, 0L);
}

static bool has_one_thread(void) {
    char line[128];
    long threads = 0;
    FILE *file = fopen("/proc/self/status", "r");
    while (file && threads == 0 && fgets(line, sizeof line, file))
        if (sscanf(line, "Threads: %ld", &threads) != 1)
            threads = 0;
    if (file)
        fclose(file);
    return threads == 1;
}

static bool say(pid_t process) {
    const int32_t number = process;
    return send(SF_MESHER_SPARE, &number, sizeof number, MSG_NOSIGNAL) == sizeof number;
}

/* False: the host has ended or asks no more. */
static bool receive(int file[SF_MESHER_JOB]) {
    char text;
    union {
        struct cmsghdr header;
        char space[CMSG_SPACE(sizeof(int[SF_MESHER_JOB]))];
    } control = {0};
    struct iovec part = {&text, 1};
    struct msghdr message = {
        .msg_iov = &part, .msg_iovlen = 1, .msg_control = &control, .msg_controllen = sizeof control};
    ssize_t size;
    do
        size = recvmsg(SF_MESHER_SPARE, &message, 0);
    while (size < 0 && errno == EINTR);
    if (size != 1 || control.header.cmsg_type != SCM_RIGHTS ||
        control.header.cmsg_len != CMSG_LEN(sizeof(int[SF_MESHER_JOB])))
        return false;
    memcpy(file, CMSG_DATA(&control.header), sizeof(int[SF_MESHER_JOB]));
    return true;
}

/* Gives the files of a job their numbers; the child has no others. */
static void take(const int file[SF_MESHER_JOB]) {
    static const int number[SF_MESHER_JOB] = {SF_MESHER_CONTROL, SF_MESHER_DATA, SF_MESHER_PARAMETERS, 1};
    int lifted[SF_MESHER_JOB];
    bool taken = close(SF_MESHER_SPARE) == 0;
    for (int k = 0; k < SF_MESHER_JOB; k++) {
        lifted[k] = fcntl(file[k], F_DUPFD, 20);
        taken = taken && lifted[k] >= 0 && close(file[k]) == 0;
    }
    for (int k = 0; k < SF_MESHER_JOB; k++)
        taken = taken && dup2(lifted[k], number[k]) >= 0 && close(lifted[k]) == 0;
    if (!taken || dup2(1, 2) < 0)
        _exit(1);
}

/* The spare: forks a child for each job until the host asks no more. Returns in each child. */
static void wait_for_jobs(void) {
    int file[SF_MESHER_JOB];
    dup2(0, 1);
    dup2(0, 2);
    close(SF_MESHER_CONTROL);
    close(SF_MESHER_DATA);
    close(SF_MESHER_PARAMETERS);
    bool goes_on = say(getpid());
    while (goes_on && receive(file)) {
        pid_t child = fork_sibling();
        if (child == 0) {
            take(file);
            return;
        }
        for (int k = 0; k < SF_MESHER_JOB; k++)
            close(file[k]);
        goes_on = say(child);
    }
    _exit(0);
}

void sf_serve(void) {
    int type = 0;
    socklen_t size = sizeof type;
    if (getsockopt(SF_MESHER_SPARE, SOL_SOCKET, SO_TYPE, &type, &size) != 0 || type != SOCK_SEQPACKET)
        return;
    if (has_one_thread() && fork_sibling() == 0)
        wait_for_jobs();
    else if (close(SF_MESHER_SPARE) != 0) /* no geometry may reach the spare */
        _exit(1);
}
