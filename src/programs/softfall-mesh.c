/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-mesh: runs gmsh on a geometry that may be hostile, confined, for softfall-pre and
 * libsoftfall-build (pre/mesh/mesher.h), which start it. It is of no use by hand. */
#include "pre/mesh/mesher_protocol.h"
#include "pre/mesher/confine.h"
#include "pre/mesher/serve.h"
#include "pre/mesher/work.h"

#include <dlfcn.h>
#include <stddef.h>
#include <stdio.h>
#include <sys/socket.h>
#include <unistd.h>

static void tell(sf_mesher_ask_kind kind, int detail) {
    const sf_mesher_ask ask = {.kind = (uint32_t)kind, .detail = detail};
    if (write(SF_MESHER_CONTROL, &ask, offsetof(sf_mesher_ask, text) + 1) < 0)
        _exit(1);
}

static void no_memory(void) {
    tell(SF_ASK_MEMORY, 0);
    _exit(1);
}

/* By std::set_new_handler of the C++ library, which gmsh has loaded; nothing else needs C++. */
static void tell_of_no_memory(void) {
    void (*(*set_new_handler)(void (*)(void)))(void) = NULL;
    void *found = dlsym(RTLD_DEFAULT, "_ZSt15set_new_handlerPFvvE");
    memcpy(&set_new_handler, &found, sizeof found);
    if (set_new_handler)
        set_new_handler(no_memory);
}

/* The destructors of gmsh and its libraries do not run: nothing of them matters any more. */
int main(void) {
    static sf_mesher_request request;
    sf_serve();
    if (recv(SF_MESHER_CONTROL, &request, sizeof request, 0) != (ssize_t)sizeof request ||
        request.version != SF_MESHER_VERSION) {
        fputs("softfall-mesh is started by softfall-pre\n", stderr);
        return 2;
    }
    tell_of_no_memory();
    sf_confine_resources(request.bytes, request.seconds);
    int error = request.confined ? sf_confine_calls() : 0;
    if (error != 0) {
        tell(SF_ASK_NO_FILTER, error);
        _exit(1);
    }
    if (sf_work_begin() != 0)
        _exit(1);
    tell(SF_ASK_READY, 0);
    char handed[32];
    snprintf(handed, sizeof handed, "/proc/self/fd/%d", SF_MESHER_PARAMETERS);
    if (sf_work_parse(request.confined ? SF_MESHER_PARAMETERS_NAME : handed, request.path)) {
        tell(SF_ASK_PARSED, 0);
        sf_work_mesh(request.path);
    }
    _exit(0);
}
