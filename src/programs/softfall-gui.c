/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-gui [CASE]: a case in gmsh's window. */
#include "base/program.h"
#include "gui/session.h"
#include "io/plain_file.h"

/* ---- scripts ---- */

/* A text that does in the window what a user does, for tests and pictures: docs/window.md lists its words. */

typedef struct script_state {
    char *rest; /* what is left of its text */
    int line;
    double deadline; /* s, of `wait`; 0: none */
    sf_activity awaited;
    int frames; /* awaited too */
    bool ended; /* by `quit`, or by an error */
} script_state;

/* "wait NAME [SECONDS]", NAME of an activity, or "wait N frames while running". */
static sf_status begin_wait(script_state *s, char *rest, sf_error *err) {
    s->frames = (int)strtol(rest, &rest, 10);
    if (s->frames > 0 && strncmp(rest, " frames while ", 14) == 0)
        rest += 14;
    char *seconds = strrchr(rest, ' ');
    double patience = seconds ? strtod(seconds, NULL) : 0;
    if (patience > 0)
        *seconds = '\0';
    for (int k = 0; k < SF_ACTIVITY_COUNT; k++)
        if (strcmp(rest, sf_activity_name((sf_activity)k)) == 0) {
            s->awaited = (sf_activity)k;
            s->deadline = sf_process_now() + (patience > 0 ? patience : 60);
            return SF_OK;
        }
    return SF_REFUSE(err, "line %d: unknown activity \"%s\"", s->line, rest);
}

static sf_status look_wait(script_state *s, const sf_session *session, sf_error *err) {
    if (session->activity == s->awaited && session->pictures.frames >= s->frames)
        s->deadline = 0;
    else if (sf_process_now() > s->deadline)
        return SF_REFUSE(err, "line %d: it is \"%s\" with %d frames, not \"%s\": %s", s->line,
                         sf_activity_name(session->activity), session->pictures.frames,
                         sf_activity_name(s->awaited), session->sentence);
    return SF_OK;
}

/* The value of a field by its key, or of an entry of the tree by its name. */
static void print_value(const sf_session *session, const char *name, FILE *out) {
    char text[1200];
    double number;
    const sf_field *f = sf_fields_find(&session->fields, name);
    if (f)
        fprintf(out, "%s = %s%s\n", name, f->now, f->wrong ? " (marked)" : "");
    else if (sf_window_text(name, text, sizeof text))
        fprintf(out, "%s = %s\n", name, text);
    else if (sf_window_number(name, &number))
        fprintf(out, "%s = %.12g\n", name, number);
    else
        fprintf(out, "%s: there is no such entry\n", name);
    fflush(out);
}

static sf_status enter(script_state *s, sf_session *session, char *rest, sf_error *err) {
    char *equals = strchr(rest, '=');
    if (!equals)
        return SF_REFUSE(err, "line %d: set KEY=VALUE", s->line);
    *equals = '\0';
    if (!sf_fields_enter(&session->fields, rest, equals + 1))
        return SF_REFUSE(err, "line %d: unknown field \"%s\"", s->line, rest);
    sf_session_act(session, "check");
    return SF_OK;
}

static sf_status act(script_state *s, sf_session *session, char *word, char *rest, FILE *out, sf_error *err) {
    if (strcmp(word, "set") == 0)
        return enter(s, session, rest, err);
    if (strcmp(word, "press") == 0)
        sf_session_act(session, rest);
    else if (strcmp(word, "wait") == 0)
        return begin_wait(s, rest, err);
    else if (strcmp(word, "frames") == 0)
        fprintf(out, "frames = %d\n", session->pictures.frames);
    else if (strcmp(word, "activity") == 0)
        fprintf(out, "activity = %s\n", sf_activity_name(session->activity));
    else if (strcmp(word, "status") == 0)
        fprintf(out, "%s%s\n", session->failed ? "error: " : "", session->sentence);
    else if (strcmp(word, "print") == 0)
        print_value(session, rest, out);
    else if (strcmp(word, "picture") == 0)
        return sf_window_write_picture(rest, err);
    else if (strcmp(word, "quit") == 0)
        s->ended = true;
    else
        return SF_REFUSE(err, "line %d: unknown word \"%s\"", s->line, word);
    fflush(out);
    return SF_OK;
}

/* Runs the next line if it need not wait; its output goes to `out`. Errors name the line. */
static sf_status step_script(script_state *s, sf_session *session, FILE *out, sf_error *err) {
    if (s->deadline > 0)
        return look_wait(s, session, err);
    char *line = s->rest ? strsep(&s->rest, "\n") : NULL;
    if (!line)
        return SF_OK; /* from here on the window is the user's */
    s->line++;
    char *rest = line, *word = strsep(&rest, " ");
    return *word == '\0' || *word == '#' ? SF_OK : act(s, session, word, rest ? rest : "", out, err);
}

/* ---- the program ---- */

typedef struct options {
    const char *case_path, *script;
    int threads;
} options;

static const sf_option list[] = {
    {"threads", 't', "N", "OpenMP threads of softfall-solve (default: all processors, or OMP_NUM_THREADS)",
     .member = offsetof(options, threads), .low = 1, .high = SF_MOST_THREADS},
    {"script", 0, "FILE", "do what the lines of FILE say, as a user would (docs/window.md)",
     .member = offsetof(options, script)},
    {0},
};

/* Until the window is closed, the script quits or a signal comes. */
static void live(sf_session *session, script_state *script, sf_error *err) {
    char action[64];
    while (!sf_process_stopped() && !script->ended && err->status == SF_OK && sf_window_wait(0.05)) {
        if (sf_window_take_action(action, sizeof action))
            sf_session_act(session, action);
        sf_session_refresh(session);
        step_script(script, session, stdout, err);
    }
}

static sf_status run(const options *o, sf_error *err) {
    script_state script = {0};
    SF_OWNED char *text = NULL;
    SF_OWN(sf_session, session, 1, "the window", err);
    if (o->script)
        SF_TRY(sf_plain_read(o->script, "script", SF_PLAIN_TEXT, &text, NULL, err));
    script.rest = text;
    session->case_path = o->case_path ? o->case_path : "case.cfg";
    session->threads = o->threads;
    if (sf_window_start(err) == SF_OK) {
        if (sf_window_open(err) == SF_OK) {
            sf_session_begin(session);
            live(session, &script, err);
        }
        sf_session_end(session);
        sf_window_end();
    }
    return err->status;
}

int main(int argc, char **argv) {
    options o = {0};
    sf_error err = SF_ERROR_INIT;
    const sf_command line = {
        .program = "softfall-gui",
        .operands = "[CASE]",
        .meaning =
            "Opens a case in gmsh's window: change its values and its geometry, mesh it, run it, and see the drop. "
            "Without CASE it is case.cfg in the present folder.",
        .second = "one case at a time: \"%s\" is one too many",
        .operand = offsetof(options, case_path),
        .is_usage = true,
        .list = {{list, &o}}};
    struct sigaction action;
    if (sf_program_begin(argv, &err) != SF_OK || sf_command_parse(&line, argc, argv, &err) != SF_OK)
        return sf_error_report(&err, "softfall-gui");
    sf_process_handle_signals();
    sigaction(SIGTERM, NULL, &action);
    sigaction(SIGHUP, &action, NULL); /* as the others */
    run(&o, &err);
    return sf_error_report(&err, "softfall-gui");
}
