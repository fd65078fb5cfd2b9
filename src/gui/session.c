/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gui/session.h"

#include "case/read.h"
#include "io/folder.h"
#include "io/plain_file.h"
#include "io/replace.h"
#include <unistd.h>

static const char STATUS[] = "1Drop/81status", FOLDER[] = "1Drop/82run folder",
                  TARGET[] = "1Drop/7save to folder";
static const char BAD[] = "LightCoral";
enum { PRODUCT = SF_RUN_PATH_SIZE + 64 }; /* size of the path of a file of the report */

/* ---- what is told ---- */

static void tell(sf_session *s, bool failed, const char *sentence) {
    sf_fields_mark(&s->fields, failed ? sentence : NULL); /* they may have been read anew */
    if (strcmp(s->sentence, sentence) == 0 && s->failed == failed)
        return;
    snprintf(s->sentence, sizeof s->sentence, "%.1099s", sentence);
    s->failed = failed;
    sf_window_put(&(sf_entry){.name = STATUS,
                              .kind = SF_ENTRY_SHOWN,
                              .text = s->sentence,
                              .help = s->sentence,
                              .colour = failed ? BAD : NULL});
    sf_window_say(s->sentence);
    sf_window_refresh();
}

static void show_buttons(void) {
    static const char *const button[][3] = {
        {"1Drop/1Mesh", "mesh", "mesh the geometry and check the model (softfall-pre)"},
        {"1Drop/2Run", "run", "simulate the drop; one that was stopped goes on"},
        {"1Drop/3Stop", "stop", "end the run after the present step; Run goes on from there"},
        {"1Drop/4Report", "report", "open report.html and view.html"},
        {"1Drop/5ParaView", "paraview", "open the frames in ParaView"},
        {"1Drop/6Save case", "save",
         "write the case with its geometry and material into a new folder of its own"},
    };
    for (size_t k = 0; k < sizeof button / sizeof button[0]; k++)
        sf_window_put(&(sf_entry){
            .name = button[k][0], .kind = SF_ENTRY_BUTTON, .text = button[k][1], .help = button[k][2]});
    sf_window_close_branch("0Modules"); /* its list of pictures would grow above the buttons */
}

/* The case's folder tells more than its own name. */
static void name_label(const sf_session *s, char *label, size_t size) {
    char absolute[PATH_MAX] = "";
    snprintf(label, size, "case");
    char *last = realpath(s->case_path, absolute) ? strrchr(absolute, '/') : NULL;
    if (!last)
        return;
    *last = '\0';
    if (strrchr(absolute, '/') && strrchr(absolute, '/')[1])
        snprintf(label, size, "%.40s", strrchr(absolute, '/') + 1);
}

/* Shows the target folder: beside the present one, with the name of the case. */
static void show_target(const sf_session *s) {
    char label[64], target[PATH_MAX];
    name_label(s, label, sizeof label);
    snprintf(target, sizeof target, "%s-saved", label);
    sf_window_put(&(sf_entry){
        .name = TARGET,
        .kind = SF_ENTRY_TEXT,
        .text = target,
        .help = "the folder that Save case makes, from the folder in which the window was started"});
}

static void show_folder(const sf_session *s) {
    sf_window_put(
        &(sf_entry){.name = FOLDER,
                    .kind = SF_ENTRY_SHOWN,
                    .text = *s->at.path ? s->at.path : s->cache,
                    .help = "runs are kept here; nothing is written beside the case and its geometry"});
}

/* ---- the case and its geometry ---- */

static sf_status add_geometry(const char *path, const char *group, const sf_geo_source *source,
                              const sf_fields *before, sf_fields *fields, sf_error *err) {
    SF_OWNED sf_geo_names *names = sf_alloc(err, 1, sizeof *names, "names of parameters");
    if (names && sf_geo_names_read(path, names, err) == SF_OK)
        sf_fields_add_geometry(group, names, source, before, fields);
    return err->status;
}

/* Reads the case anew. */
static sf_status read_case(sf_session *s, sf_error *err) {
    sf_case fresh;
    SF_OWN(sf_fields, before, 1, "fields", err);
    *before = s->fields;
    if (sf_fields_read(s->case_path, before, &s->fields, &fresh, err) == SF_OK) {
        sf_case_free(&s->case_file);
        s->case_file = fresh;
        if (add_geometry(fresh.pad.path, "geometry.parameters", &fresh.pad, before, &s->fields, err) ==
                SF_OK &&
            (!fresh.missile.path || add_geometry(fresh.missile.path, "geometry.missile_parameters",
                                                 &fresh.missile, before, &s->fields, err) == SF_OK) &&
            fresh.support_alone && fresh.support[0].source.path)
            add_geometry(fresh.support[0].source.path, "support.parameters", &fresh.support[0].source, before,
                         &s->fields, err);
    }
    if (err->status != SF_OK)
        s->fields = *before; /* with what the user has changed */
    return err->status;
}

/* The sentence of the case with the values of the window, as the programs would say it. */
static sf_status check_values(sf_session *s, sf_error *err) {
    SF_OWNED_BY(sf_overrides_free) sf_overrides o = {0};
    sf_case c;
    if (sf_fields_overrides(&s->fields, &o, err) == SF_OK &&
        sf_case_read(s->case_path, o.count, (const char *const *)o.text, NULL, &c, err) == SF_OK) {
        s->place = (sf_pictures_place){
            c.position_given, {c.missile_position[0], c.missile_position[1]}, c.missile_card.gap};
        sf_case_free(&c);
    }
    return err->status;
}

static void show_finished(sf_session *s);

/* gmsh's menus act on the file that is open: it is one of ours, and is written again when they have changed
 * it. */
static void wrap_geometry(sf_session *s, bool reread) {
    char *wrap = s->pictures.opened;
    if (s->case_file.pad.path && (reread || !sf_replace_exists(wrap)) &&
        sf_cache_find(s->cache, sizeof s->cache, SF_IGNORED) == SF_OK)
        sf_cache_wrap(s->cache, s->case_file.pad.path, wrap, sizeof s->pictures.opened);
    if (*wrap)
        sf_watch_add(&s->watch, wrap);
}

/* After an edit of the window, or of the files if `reread`: gmsh reads the geometry again, even if the values
 * of the case are wrong. */
static void begin_anew(sf_session *s, bool reread) {
    sf_error err = SF_ERROR_INIT, geometry = SF_ERROR_INIT;
    s->activity = sf_activity_next(s->activity, SF_EDIT);
    s->at.path[0] = '\0';
    sf_checks_clear(&s->checks);
    sf_plain_clear();
    if (reread) {
        sf_fields_mark(&s->fields, NULL); /* in the tree, before the fields are others */
        s->watch.count = 0;
    }
    if (reread && read_case(s, &err) == SF_OK)
        sf_fields_show(&s->fields);
    if (err.status == SF_OK)
        check_values(s, &err);
    sf_watch_register(&s->watch, 0); /* with the files that the values of the window name */
    wrap_geometry(s, reread);
    if (s->case_file.pad.path)
        sf_pictures_show_geometry(&s->pictures, &s->case_file, &s->place, &s->fields, &geometry);
    if (err.status == SF_OK && geometry.status != SF_OK)
        err = geometry;
    show_folder(s);
    if (err.status != SF_OK)
        tell(s, true, err.text);
    else
        tell(s, false, "ready: Mesh checks the model, Run simulates the drop");
    if (err.status == SF_OK)
        show_finished(s);
    sf_window_refresh();
}

void sf_session_begin(sf_session *s) {
    sf_error err = SF_ERROR_INIT;
    sf_cache_find(s->cache, sizeof s->cache, &err);
    show_buttons();
    show_target(s);
    begin_anew(s, true);
    if (err.status != SF_OK)
        tell(s, true, err.text);
}

/* ---- programs ---- */

/* The folder of the present values; nothing is made. */
static sf_status name_run(sf_session *s, sf_overrides *o, sf_error *err) {
    char label[64];
    name_label(s, label, sizeof label);
    if ((!*s->cache && sf_cache_find(s->cache, sizeof s->cache, err) != SF_OK) ||
        sf_fields_overrides(&s->fields, o, err) != SF_OK ||
        sf_run_folder_name(s->cache, label, s->case_path, o->count, (const char *const *)o->text, &s->at,
                           err) != SF_OK ||
        (s->at.drops > 1 && SF_REFUSE(err, "series.drops = %d: the window shows single drops", s->at.drops)))
        s->at.path[0] = '\0';
    return err->status;
}

static void unlock(sf_session *s) {
    if (s->lock > 0)
        close(s->lock);
    s->lock = 0;
}

/* Makes that folder, and locks it against another window of the case until the last program has ended. */
static sf_status locate(sf_session *s, sf_overrides *o, sf_error *err) {
    unlock(s);
    if (sf_cache_find(s->cache, sizeof s->cache, err) != SF_OK || /* it may have been removed */
        name_run(s, o, err) != SF_OK || sf_folder_own(s->at.path, err) != SF_OK ||
        sf_folder_lock(s->at.path, &s->lock, err) != SF_OK)
        s->at.path[0] = '\0';
    show_folder(s);
    return err->status;
}

static void close_log(sf_session *s) {
    if (s->log)
        fclose(s->log);
    s->log = NULL;
}

/* A new log of the program `name` in the run's folder. */
static sf_status open_log(sf_session *s, sf_error *err) {
    close_log(s);
    sf_folder_remove_file(s->at.log);
    s->log = sf_replace_create(s->at.log, err);
    return err->status;
}

static void read_log(const sf_session *s, char **text) {
    *text = NULL;
    sf_plain_clear();
    sf_plain_read(s->at.log, NULL, SF_PLAIN_TEXT, text, NULL, SF_IGNORED);
}

static sf_status start_pre(sf_session *s, sf_error *err) {
    SF_OWNED_BY(sf_overrides_free) sf_overrides o = {0};
    if (locate(s, &o, err) == SF_OK && open_log(s, err) == SF_OK)
        sf_programs_pre(&s->child, s->case_path, &s->at, s->cache, o.count, (const char *const *)o.text,
                        s->log, err);
    return err->status;
}

static sf_status start_save(sf_session *s, sf_error *err) {
    SF_OWNED_BY(sf_overrides_free) sf_overrides o = {0};
    char folder[PATH_MAX];
    sf_window_text(TARGET, folder, sizeof folder);
    if (locate(s, &o, err) == SF_OK && open_log(s, err) == SF_OK)
        sf_programs_save(&s->child, s->case_path, folder, o.count, (const char *const *)o.text, s->log, err);
    return err->status;
}

static void show_model(sf_session *s) {
    sf_pictures_show_model(&s->pictures, s->at.model, s->case_file.length_unit);
}

static void show_results(sf_session *s, bool whole) {
    if (*s->at.path)
        sf_pictures_show_results(&s->pictures, s->at.results, s->case_file.length_unit, whole);
}

/* Removes the results of an earlier run from the folder, so that they do not stand beside those of the new
 * run. */
static void remove_results(sf_session *s) {
    static const char *const products[] = {"report.html", "view.html", "pad.xdmf"};
    char path[PRODUCT];
    sf_folder_remove_file(s->at.figures);
    sf_folder_remove_file(s->at.results);
    for (size_t k = 0; k < sizeof products / sizeof products[0]; k++) {
        snprintf(path, sizeof path, "%s/report/%s", s->at.path, products[k]);
        sf_folder_remove_file(path);
    }
    s->pictures.seen = (sf_watch_stamp){0};
    if (s->pictures.frames > 0)
        show_model(s);
}

/* A run that was stopped goes on if its model is the same: softfall-solve refuses another one. */
static sf_status start_solve(sf_session *s, bool resume, sf_error *err) {
    s->resuming = resume;
    s->told = false;
    if (!resume)
        remove_results(s);
    return open_log(s, err) == SF_OK ? sf_programs_solve(&s->child, &s->at, resume, s->threads, s->log, err)
                                     : err->status;
}

static bool is_there(const char *path) {
    return sf_watch_stamp_of(path).inode != 0;
}

static void tell_not_started(sf_session *s, const char *sentence) {
    s->activity = SF_FAILED;
    unlock(s);
    tell(s, true, sentence);
}

/* Starts the program of the activity that begins. */
static void start(sf_session *s) {
    sf_error err = SF_ERROR_INIT;
    switch (s->activity) {
    case SF_MESHING:
    case SF_PREPARING:
        start_pre(s, &err);
        break;
    case SF_RUNNING:
        start_solve(s, is_there(s->at.checkpoint) && is_there(s->at.results), &err);
        break;
    case SF_REPORTING:
        if ((s->lock > 0 || sf_folder_lock(s->at.path, &s->lock, &err) == SF_OK) &&
            open_log(s, &err) == SF_OK)
            sf_programs_post(&s->child, &s->at, s->log, &err);
        break;
    case SF_SAVING:
        start_save(s, &err);
        break;
    default:
        return;
    }
    SF_PRINTED(text, 160, "%s ...%s", sf_activity_name(s->activity),
               s->activity == SF_RUNNING && s->resuming ? " (from the checkpoint)" : "");
    if (err.status == SF_OK)
        tell(s, false, text);
    else
        tell_not_started(s, err.text);
}

/* A finished run of the same values is shown at once. */
static void show_finished(sf_session *s) {
    SF_OWNED_BY(sf_overrides_free) sf_overrides o = {0};
    bool finished = name_run(s, &o, SF_IGNORED) == SF_OK && sf_run_folder_is_finished(&s->at);
    if (!finished) {
        s->at.path[0] = '\0';
        return;
    }
    s->activity = SF_DONE;
    show_folder(s);
    show_results(s, true);
    tell(s, false, "done earlier with the same values");
}

/* ---- the end of a program ---- */

static void tell_done(sf_session *s) {
    char text[PATH_MAX + 64];
    switch (s->activity) {
    case SF_MESHED:
        tell(s, false, "meshed: see Checks");
        break;
    case SF_STOPPED:
        snprintf(text, sizeof text, "stopped%s",
                 is_there(s->at.checkpoint) ? ": Run goes on from the checkpoint" : "");
        tell(s, false, text);
        break;
    case SF_SAVED:
        tell(s, false, "saved: softfall-pre and softfall-gui take the case.cfg of that folder");
        break;
    case SF_DONE:
        tell(s, false, "done");
        break;
    default:
        break;
    }
}

static void fail(sf_session *s, const char *log, int code) {
    char sentence[1024] = "";
    if (code < 128) /* a program that a signal has ended did not say so: its last words are a warning */
        sf_checks_sentence(log ? log : "", sentence, sizeof sentence);
    if (!*sentence)
        snprintf(sentence, sizeof sentence, "the program ended with exit code %d; see %.900s", code,
                 s->at.log);
    tell(s, true, sentence);
}

static void show_checks(sf_session *s) {
    sf_error err = SF_ERROR_INIT;
    sf_checks_clear(&s->checks);
    if (sf_checks_read(s->at.model, &s->checks, &err) == SF_OK)
        sf_checks_show(&s->checks);
    else
        tell(s, true, err.text);
}

/* Shows the results of the program that has ended. */
static void take_end(sf_session *s, sf_activity before) {
    if ((before == SF_MESHING || before == SF_PREPARING) && s->activity != SF_FAILED) {
        show_checks(s);
        show_model(s);
    }
    if (before == SF_RUNNING || before == SF_STOPPING || before == SF_REPORTING)
        show_results(s, true);
}

static void check_edits(sf_session *s);

static void end_program(sf_session *s, int code) {
    sf_activity before = s->activity;
    sf_event event = code == 0 ? SF_CHILD_DONE
                     : code == SF_INTERRUPTED || before == SF_STOPPING || before == SF_CANCELLING
                         ? SF_CHILD_INTERRUPTED
                         : SF_CHILD_FAILED;
    SF_OWNED char *log = NULL;
    close_log(s);
    read_log(s, &log);
    if (before == SF_RUNNING && event == SF_CHILD_FAILED && s->resuming &&
        !s->told) { /* it cannot be resumed */
        sf_error err = SF_ERROR_INIT;
        if (start_solve(s, false, &err) != SF_OK)
            tell_not_started(s, err.text);
        return;
    }
    if (event == SF_CHILD_DONE && (before == SF_RUNNING || before == SF_STOPPING))
        sf_folder_remove_file(s->at.checkpoint); /* a run that has ended does not go on */
    s->activity = sf_activity_next(before, event);
    take_end(s, before);
    if (s->activity == SF_FAILED)
        fail(s, log, code);
    else if (sf_activity_is_busy(s->activity))
        start(s);
    else
        tell_done(s);
    if (sf_activity_is_busy(s->activity))
        return;
    unlock(s);
    check_edits(s); /* of the time of the run: its results are not those of the present values */
}

static void tell_progress(sf_session *s) {
    SF_OWNED char *log = NULL;
    char line[400], text[480];
    read_log(s, &log);
    sf_checks_progress(log ? log : "", line, sizeof line);
    s->told = s->told || *line;
    snprintf(text, sizeof text, "%s: %s", sf_activity_name(s->activity), line);
    if (*line)
        tell(s, false, text);
}

void sf_session_refresh(sf_session *s) {
    static const double INTERVAL = 0.25; /* s */
    int code;
    if (sf_process_now() < s->next_look)
        return;
    s->next_look = sf_process_now() + INTERVAL;
    if (s->activity == SF_RUNNING) {
        tell_progress(s);
        show_results(s, false);
    }
    if (sf_child_poll(&s->child, &code))
        end_program(s, code);
    const char *changed = sf_activity_is_busy(s->activity) ? NULL : sf_watch_changed(&s->watch);
    if (changed)
        begin_anew(s, true);
}

/* ---- buttons ---- */

static void check_edits(sf_session *s) {
    bool of_case, of_geometry;
    sf_pictures_take_frame(&s->pictures);
    if (sf_activity_is_busy(s->activity))
        return; /* the values of the next run */
    sf_fields_take(&s->fields, &of_case, &of_geometry);
    if (of_case || of_geometry)
        begin_anew(s, false);
}

/* Writes the path of a file of the report; returns false if it does not exist. */
static bool has_product(const sf_session *s, const char *name, char path[PRODUCT]) {
    snprintf(path, PRODUCT, "%s/report/%s", s->at.path, name);
    return *s->at.path && is_there(path);
}

/* Writes that path, and tells the user if the file does not exist. */
static bool find_product(sf_session *s, const char *name, char path[PRODUCT]) {
    bool found = has_product(s, name, path);
    SF_PRINTED(text, 160, "there is no %s yet: Run makes it", name);
    if (!found)
        tell(s, true, text);
    return found;
}

static void leave(sf_session *s, const char *program, const char *argument) {
    sf_error err = SF_ERROR_INIT;
    if (sf_child_leave((const char *const[]){program, argument, NULL}, &err) != SF_OK)
        tell(s, true, err.text);
}

static void open_report(sf_session *s) {
    char path[PRODUCT];
    if (!find_product(s, "report.html", path))
        return;
    leave(s, "xdg-open", path);
    if (has_product(s, "view.html", path)) /* a large model may have none */
        leave(s, "xdg-open", path);
}

/* By the state that softfall-post writes, if there is one. */
static void open_paraview(sf_session *s) {
    static const char script[] = "--script=";
    char path[PRODUCT], argument[sizeof path + sizeof script];
    if (!find_product(s, "pad.xdmf", path))
        return;
    snprintf(argument, sizeof argument, "%s%s/report/pad_paraview.py", script, s->at.path);
    leave(s, "paraview", is_there(argument + strlen(script)) ? argument : path);
}

/* The run that is shown is that of the values, of the files that they name, and of what its geometry has
 * read, as they are now. */
static bool is_shown(sf_session *s) {
    SF_OWNED_BY(sf_overrides_free) sf_overrides o = {0};
    SF_PRINTED(shown, PATH_MAX, "%s", s->at.path);
    sf_plain_clear();
    return name_run(s, &o, SF_IGNORED) == SF_OK && strcmp(s->at.path, shown) == 0 &&
           sf_run_folder_is_finished(&s->at);
}

static void press(sf_session *s, sf_event event) {
    check_edits(s);
    bool run = event == SF_PRESS_RUN && !sf_activity_is_busy(s->activity);
    if (run && s->activity == SF_DONE && !is_shown(s))
        begin_anew(s, true);
    else if (run && s->activity != SF_DONE) {
        sf_plain_clear();
        show_finished(s); /* Mesh, Save case or Stop of the report came after it */
    }
    sf_activity before = s->activity;
    char path[PRODUCT];
    if (run && before == SF_DONE && has_product(s, "report.html", path))
        return; /* the run of these values is what is shown */
    s->activity = sf_activity_next(s->activity, event);
    if (s->activity == before && event != SF_PRESS_STOP && sf_activity_is_busy(before))
        return;
    if (event == SF_PRESS_STOP)
        sf_child_ask_to_end(&s->child);
    else
        start(s);
}

void sf_session_act(sf_session *s, const char *action) {
    if (strcmp(action, "mesh") == 0)
        press(s, SF_PRESS_MESH);
    else if (strcmp(action, "run") == 0 || strcmp(action, "compute") == 0)
        press(s, SF_PRESS_RUN);
    else if (strcmp(action, "stop") == 0)
        press(s, SF_PRESS_STOP);
    else if (strcmp(action, "save") == 0)
        press(s, SF_PRESS_SAVE);
    else if (strcmp(action, "report") == 0)
        open_report(s);
    else if (strcmp(action, "paraview") == 0)
        open_paraview(s);
    else
        check_edits(s);
}

void sf_session_end(sf_session *s) {
    sf_child_end(&s->child, 20);
    close_log(s);
    unlock(s);
    sf_shape_free(&s->pictures.shape);
    sf_case_free(&s->case_file);
}
