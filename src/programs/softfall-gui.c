/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-gui [CASE]: a case in gmsh's window. */
#include "build_info.h"
#include "base/program.h"
#include "gui/script.h"

#include <argp.h>
#include <signal.h>
#include <stdlib.h>

enum { KEY_SCRIPT = 1 };

typedef struct options {
    const char *case_path;
    const char *script;
    int threads;
} options;

static volatile sig_atomic_t stop_requested; /* the one global: a signal handler can reach nothing else */

static void request_stop(int signal_number) {
    (void)signal_number;
    stop_requested = 1;
}

static error_t parse(int key, char *arg, struct argp_state *state) {
    options *o = state->input;
    sf_error err = SF_ERROR_INIT;
    switch (key) {
    case 't':
        if (sf_program_read_threads(arg, &o->threads, &err) != SF_OK)
            argp_error(state, "%s", err.text);
        return 0;
    case KEY_SCRIPT:
        o->script = arg;
        return 0;
    case ARGP_KEY_ARG:
        if (o->case_path)
            argp_error(state, "one case at a time: \"%s\" is one too many", arg);
        o->case_path = arg;
        return 0;
    case ARGP_KEY_END:
        if (!o->case_path)
            o->case_path = "case.cfg";
        return 0;
    default:
        return ARGP_ERR_UNKNOWN;
    }
}

/* Until the window is closed, the script quits or a signal comes. */
static void live(sf_session *session, sf_script *script, sf_error *err) {
    char action[64];
    while (!stop_requested && !script->ended && err->status == SF_OK && sf_window_wait(0.05)) {
        if (sf_window_take_action(action, sizeof action))
            sf_session_act(session, action);
        sf_session_refresh(session);
        sf_script_step(script, session, stdout, err);
    }
}

static sf_status run(const options *o, sf_error *err) {
    sf_script script = {0};
    sf_session *session = sf_alloc(err, 1, sizeof *session, "the window");
    if (!session || (o->script && sf_script_open(o->script, &script, err) != SF_OK)) {
        free(session);
        return err->status;
    }
    session->case_path = o->case_path;
    session->threads = o->threads;
    if (sf_window_start(err) == SF_OK) {
        if (sf_window_open(err) == SF_OK) {
            sf_session_begin(session);
            live(session, &script, err);
        }
        sf_session_end(session);
        sf_window_end();
    }
    sf_script_close(&script);
    free(session);
    return err->status;
}

int main(int argc, char **argv) {
    static const struct argp_option list[] = {
        {"threads", 't', "N", 0,
         "OpenMP threads of softfall-solve (default: all processors, or OMP_NUM_THREADS)", 0},
        {"script", KEY_SCRIPT, "FILE", 0, "do what the lines of FILE say, as a user would (docs/window.md)",
         0},
        {0},
    };
    argp_program_version = "softfall-gui " SF_VERSION " (" SF_GIT_REVISION ")";
    static const struct argp argp = {
        .options = list,
        .parser = parse,
        .args_doc = "[CASE]",
        .doc =
            "Opens a case in gmsh's window: change its values and its geometry, mesh it, run it, and see the drop. "
            "Without CASE it is case.cfg in the present folder."};
    options o = {0};
    sf_error err = SF_ERROR_INIT;
    const struct sigaction action = {.sa_handler = request_stop};
    if (sf_program_begin(argv, &err) != SF_OK)
        return sf_error_report(&err, "softfall-gui");
    argp_parse(&argp, argc, argv, 0, NULL, &o);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGHUP, &action, NULL);
    run(&o, &err);
    return sf_error_report(&err, "softfall-gui");
}
