/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gui/script.h"

#include "io/plain_file.h"
#include <stdlib.h>
#include <string.h>
#include <time.h>

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

sf_status sf_script_open(const char *path, sf_script *s, sf_error *err) {
    *s = (sf_script){0};
    sf_plain_read(path, "script", SF_PLAIN_TEXT, &s->text, NULL, err);
    s->rest = s->text;
    return err->status;
}

void sf_script_close(sf_script *s) {
    free(s->text);
    *s = (sf_script){0};
}

/* "wait NAME [SECONDS]", NAME of an activity, or "wait N frames while running". */
static sf_status begin_wait(sf_script *s, char *rest, sf_error *err) {
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
            s->deadline = now() + (patience > 0 ? patience : 60);
            return SF_OK;
        }
    return SF_FAIL(err, SF_ERR_INPUT, "line %d: \"%s\" is no activity", s->line, rest);
}

static sf_status look_wait(sf_script *s, const sf_session *session, sf_error *err) {
    if (session->activity == s->awaited && session->pictures.frames >= s->frames)
        s->deadline = 0;
    else if (now() > s->deadline)
        return SF_FAIL(err, SF_ERR_INPUT, "line %d: it is \"%s\" with %d frames, not \"%s\": %s", s->line,
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

static sf_status enter(sf_script *s, sf_session *session, char *rest, sf_error *err) {
    char *equals = strchr(rest, '=');
    if (!equals)
        return SF_FAIL(err, SF_ERR_INPUT, "line %d: set KEY=VALUE", s->line);
    *equals = '\0';
    if (!sf_fields_enter(&session->fields, rest, equals + 1))
        return SF_FAIL(err, SF_ERR_INPUT, "line %d: there is no field \"%s\"", s->line, rest);
    sf_session_act(session, "check");
    return SF_OK;
}

static sf_status act(sf_script *s, sf_session *session, char *word, char *rest, FILE *out, sf_error *err) {
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
        return SF_FAIL(err, SF_ERR_INPUT, "line %d: there is no word \"%s\"", s->line, word);
    fflush(out);
    return SF_OK;
}

sf_status sf_script_step(sf_script *s, sf_session *session, FILE *out, sf_error *err) {
    if (s->deadline > 0)
        return look_wait(s, session, err);
    char *line = s->rest ? strsep(&s->rest, "\n") : NULL;
    if (!line)
        return SF_OK; /* from here on the window is the user's */
    s->line++;
    char *rest = line, *word = strsep(&rest, " ");
    return *word == '\0' || *word == '#' ? SF_OK : act(s, session, word, rest ? rest : "", out, err);
}
