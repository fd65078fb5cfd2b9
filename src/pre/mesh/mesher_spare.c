/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "pre/mesh/mesher_spare.h"

#include <errno.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "io/process.h"

enum { PATIENCE = 20 }; /* s, for a fork on a busy machine */

int sf_mesher_spare_prepare(sf_mesher_spare *spare) {
    int side[2];
    sf_mesher_spare_end(spare);
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, side) != 0)
        return -1;
    *spare = (sf_mesher_spare){.is_open = true, .socket = side[0]};
    return side[1];
}

/* The number of a child of this process that the spare tells; 0: it tells none in time, or has ended. */
static pid_t hear(const sf_mesher_spare *spare) {
    struct pollfd channel = {spare->socket, POLLIN, 0};
    int32_t process = 0;
    siginfo_t info;
    double end = sf_process_now() + PATIENCE;
    int ready;
    do
        ready = poll(&channel, 1, 1000);
    while (ready <= 0 && sf_process_now() < end);
    return ready == 1 && recv(spare->socket, &process, sizeof process, MSG_DONTWAIT) == sizeof process &&
                   process > 0 && waitid(P_PID, (id_t)process, &info, WEXITED | WNOHANG | WNOWAIT) == 0
               ? (pid_t)process
               : 0;
}

/* It tells its number before the first child reads its geometry. */
static void meet(sf_mesher_spare *spare) {
    if (spare->is_open && spare->process == 0)
        spare->process = hear(spare);
}

void sf_mesher_spare_end(sf_mesher_spare *spare) {
    meet(spare);
    if (spare->is_open)
        close(spare->socket);
    if (spare->process > 0) {
        kill(spare->process, SIGKILL);
        while (waitpid(spare->process, NULL, 0) < 0 && errno == EINTR)
            ;
    }
    *spare = (sf_mesher_spare){0};
}

static bool send_files(int socket, const int file[SF_MESHER_JOB]) {
    char text = 0;
    union {
        struct cmsghdr header;
        char space[CMSG_SPACE(sizeof(int[SF_MESHER_JOB]))];
    } control = {0};
    struct iovec part = {&text, 1};
    const struct msghdr message = {
        .msg_iov = &part, .msg_iovlen = 1, .msg_control = &control, .msg_controllen = sizeof control};
    control.header =
        (struct cmsghdr){.cmsg_len = CMSG_LEN(sizeof(int[SF_MESHER_JOB])), SOL_SOCKET, SCM_RIGHTS};
    memcpy(CMSG_DATA(&control.header), file, sizeof(int[SF_MESHER_JOB]));
    return sendmsg(socket, &message, MSG_NOSIGNAL | MSG_DONTWAIT) == 1;
}

pid_t sf_mesher_spare_fork(sf_mesher_spare *spare, const int file[SF_MESHER_JOB]) {
    meet(spare);
    pid_t child = spare->process > 0 && send_files(spare->socket, file) ? hear(spare) : 0;
    if (child == 0)
        sf_mesher_spare_end(spare);
    return child;
}
