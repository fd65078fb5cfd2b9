/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gui/gmsh/window.h"

#include "base/mat3.h"
#include "io/plain_file.h"
#include "report/row.h"

#include <dlfcn.h>
#include <gmshc.h>
#include <string.h>

static int unasked; /* gmsh's error code where a failure is ignored */

/* ---- window ---- */

/* The first error among gmsh's lines since gmshLoggerStart, which this ends. */
static sf_status take_error(const char *path, sf_error *err) {
    char **line = NULL;
    size_t count = 0;
    gmshLoggerGet(&line, &count, &unasked);
    for (size_t k = 0; k < count; k++) {
        if (strncmp(line[k], "Error", 5) == 0) /* as softfall-pre says it */
            SF_REFUSE(err, "%s: gmsh, reading: %s", path, line[k] + 5 + strspn(line[k] + 5, " :"));
        gmshFree(line[k]);
    }
    gmshFree(line);
    gmshLoggerStop(&unasked);
    return err->status;
}

sf_status sf_geometry_show(const char *path, const char *opened, sf_error *err) {
    int ierr = 0, failed = 0;
    SF_TRY(sf_plain_check(path, "geometry", err));
    gmshLoggerStart(&ierr);
    gmshOpen(*opened ? opened : path, &failed);
    take_error(path, err);
    if (err->status == SF_OK && failed != 0)
        SF_REFUSE(err, "the geometry %s cannot be read by gmsh", path);
    return err->status;
}

void sf_geometry_box(double low[3], double high[3]) {
    gmshModelGetBoundingBox(-1, -1, &low[0], &low[1], &low[2], &high[0], &high[1], &high[2], &unasked);
}

/* The triangles (element type 2) of the model's surfaces. */
static sf_status take_triangles(sf_triangles *out, sf_error *err) {
    size_t *element = NULL, *node = NULL, *corner = NULL, elements = 0, nodes = 0, corners = 0,
           parameters = 0, positions = 0;
    size_t largest = 0;
    double *position = NULL, *parameter = NULL;
    gmshModelMeshGetElementsByType(2, &element, &elements, &corner, &corners, -1, 0, 1, &unasked);
    gmshModelMeshGetNodes(&node, &nodes, &position, &positions, &parameter, &parameters, -1, -1, 0, 0,
                          &unasked);
    for (size_t k = 0; k < nodes; k++)
        largest = node[k] > largest ? node[k] : largest;
    SF_OWNED double *place = sf_alloc(err, 3 * (largest + 1), sizeof *place, "the missile's picture");
    out->corner = sf_alloc(err, 3 * corners, sizeof *out->corner, "the missile's picture");
    for (size_t k = 0; k < nodes && err->status == SF_OK; k++)
        memcpy(&place[3 * node[k]], &position[3 * k], 3 * sizeof *place);
    for (size_t k = 0; k < corners && err->status == SF_OK; k++)
        if (corner[k] <= largest)
            memcpy(&out->corner[3 * k], &place[3 * corner[k]], 3 * sizeof *place);
    out->count = err->status == SF_OK ? (int64_t)(corners / 3) : 0;
    gmshFree(element);
    gmshFree(corner);
    gmshFree(node);
    gmshFree(position);
    gmshFree(parameter);
    sf_box3(3 * out->count, out->corner, out->low, out->high);
    return err->status;
}

sf_status sf_geometry_read_surface(const char *path, sf_triangles *surface, sf_error *err) {
    int ierr = 0;
    *surface = (sf_triangles){0};
    SF_TRY(sf_geometry_show(path, "", err));
    gmshModelMeshGenerate(2, &ierr);
    if (ierr == 0)
        take_triangles(surface, err);
    gmshModelRemove(&ierr);
    return err->status;
}

void sf_geometry_clear(void) {
    gmshClear(&unasked);
}

#define ACTION "ONELAB/Action"

/* An option of gmsh. */
static void set_gmsh_option(const char *name, double value) {
    gmshOptionSetNumber(name, value, &unasked);
}

static int initialize(void) {
    static char name[] = "softfall-gui"; /* gmsh reads it again when it opens its window */
    static char *argv[] = {name, NULL};
    int ierr = 0;
#if GMSH_API_VERSION_MAJOR > 4 || GMSH_API_VERSION_MINOR >= 9
    gmshInitialize(1, argv, 1, 0, &ierr);
#else
    gmshInitialize(1, argv, 1, &ierr);
#endif
    return ierr;
}

/* gmsh by itself would leave options in the home folder, and a mesh and a database beside the geometry; the
 * view is that from the side, z upwards: a quarter turn about x. */
static const struct {
    const char *name;
    double value;
} options[] = {{"General.SaveOptions", 0},
               {"General.SaveSession", 0},
               {"Solver.AutoSaveDatabase", 0},
               {"Solver.AutoLoadDatabase", 0},
               {"Solver.AutoArchiveOutputFiles", 0},
               {"Solver.AutoMesh", 0},
               {"General.AbortOnError", 0},
               {"General.ExpertMode", 0},
               {"Mesh.SaveAll", 0},
               {"Solver.AutoCheck", 1},
               {"General.Trackball", 1},
               {"General.TrackballQuaternion0", 0.70710678},
               {"General.TrackballQuaternion1", 0},
               {"General.TrackballQuaternion2", 0},
               {"General.TrackballQuaternion3", 0.70710678},
               {"General.Orthographic", 1},
               {"General.Terminal", 0},
               {"General.MenuWidth", 420},
               {"General.GraphicsWidth", 1240},
               {"General.GraphicsHeight", 900},
               {"Geometry.PointSize", 0}};

sf_status sf_window_start(sf_error *err) {
    if (initialize() != 0)
        return SF_FAIL(err, SF_ERR_LIBRARY, "gmsh cannot be started");
    for (size_t k = 0; k < sizeof options / sizeof options[0]; k++)
        set_gmsh_option(options[k].name, options[k].value);
    gmshOptionSetString("General.GraphicsFontEngine", "StringTexture",
                        &unasked); /* the other one drops blanks */
    return SF_OK;
}

/* gmsh's window is made of FLTK, which handles clicks and keys wherever gmsh says or draws something: also
 * while it rebuilds the tree that they are meant for, and then it crashes. So those that come while we call
 * gmsh are kept, and go back to the head of the queue of X11 before the window waits for events again;
 * repeats of a key that is held down are lost. Keys that nothing has taken are commands of gmsh: digits mesh
 * in this window, for minutes perhaps, and with a menu open any of them may crash it. gmsh has no interface
 * for that; in one without these names of FLTK all is as gmsh does it, and without those of X11 they are
 * lost. */
enum { PUSH = 1, RELEASE = 2, KEY_DOWN = 8, KEY_UP = 9, CLOSE = 10, MOVE = 11, SHORTCUT = 12, WHEEL = 19 };
enum { KEPT = 64 };

typedef struct x_event {
    long bytes[24]; /* an XEvent has this size */
} x_event;

static struct {
    int (*handle)(int event, void *window);
    void **menu; /* the open one, which waits for a choice */
    const int *key;
    int (*put_back)(void *display, x_event *event); /* NULL: nothing is kept */
    void **display;
    const x_event **now; /* the event that FLTK handles */
    int *clicked;        /* the button of a click that another one may make a double click */
    bool is_waiting;     /* the window waits for events */
    x_event kept[KEPT];
    int count;
} events;

/* Returns false if there is no room. The second half of the list is for releases alone: a button that is
 * never released would drag. */
static bool keep(int event) {
    int room = event == RELEASE || event == KEY_UP ? KEPT : KEPT / 2;
    if (!events.put_back || !*events.now || events.count >= room)
        return false;
    events.kept[events.count++] = **events.now;
    if (event == PUSH)
        *events.clicked = 0; /* or this click would be a double click when it comes back */
    return true;
}

/* A motion is told anew by the next one; before a release that is kept it would drag. */
static int dispatch(int event, void *window) {
    if (events.is_waiting)
        return events.handle(event, window);
    switch (event) {
    case RELEASE:
    case KEY_UP:
        return keep(event) ? 1 : events.handle(event, window);
    case PUSH:
    case KEY_DOWN:
    case CLOSE:
    case WHEEL:
        keep(event);
        return 1;
    case SHORTCUT: /* of a key */
        return 1;
    default:
        return event == MOVE && events.count > 0 ? 1 : events.handle(event, window);
    }
}

static void put_back_kept(void) {
    while (events.count > 0)
        events.put_back(*events.display, &events.kept[--events.count]);
}

static int take_shortcut(int event) {
    return event == SHORTCUT && (*events.menu || (*events.key >= '0' && *events.key <= '9'));
}

/* A function or a variable; C has no pointer that can hold either. */
static bool find_name(const char *name, void *place) {
    void *found = dlsym(RTLD_DEFAULT, name);
    memcpy(place, &found, sizeof found);
    return found != NULL;
}

static void guard_events(void) {
    void (*set_dispatch)(int (*)(int, void *)), (*add_handler)(int (*)(int));
    int (*put_back)(void *, x_event *);
    if (find_name("fl_xevent", &events.now) && find_name("fl_display", &events.display) &&
        find_name("_ZN2Fl10e_is_clickE", &events.clicked) && find_name("XPutBackEvent", &put_back))
        events.put_back = put_back;
    if (find_name("_ZN2Fl7handle_EiP9Fl_Window", &events.handle) &&
        find_name("_ZN2Fl5grab_E", &events.menu) && find_name("_ZN2Fl8e_keysymE", &events.key) &&
        find_name("_ZN2Fl14event_dispatchEPFiiP9Fl_WindowE", &set_dispatch) &&
        find_name("_ZN2Fl11add_handlerEPFiiE", &add_handler)) {
        set_dispatch(dispatch);
        add_handler(take_shortcut); /* the last one is asked first */
    }
}

sf_status sf_window_open(sf_error *err) {
    int ierr = 0;
    const char *display = getenv("DISPLAY"), *wayland = getenv("WAYLAND_DISPLAY");
    if ((!display || !*display) && (!wayland || !*wayland))
        return SF_FAIL(err, SF_ERR_IO,
                       "there is no display to open a window on (DISPLAY is not set); softfall-pre, "
                       "softfall-solve and softfall-post need none");
    gmshOnelabSet(
        "[{\"type\":\"string\",\"name\":\"ONELAB/Button\",\"values\":[\"Run\",\"run\"],\"visible\":false},"
        "{\"type\":\"string\",\"name\":\"" ACTION "\",\"values\":[\"\"],\"visible\":false}]",
        "json", &ierr);
    gmshFltkInitialize(&ierr);
    guard_events();
    if (ierr != 0)
        return SF_FAIL(err, SF_ERR_LIBRARY, "gmsh cannot open its window");
    return SF_OK;
}

bool sf_window_wait(double seconds) {
    if (gmshFltkIsAvailable(&unasked) != 1)
        return false;
    put_back_kept();
    events.is_waiting = true;
    gmshFltkWait(seconds, &unasked);
    events.is_waiting = false;
    return gmshFltkIsAvailable(&unasked) == 1;
}

void sf_window_end(void) {
    gmshFinalize(&unasked);
}

void sf_window_say(const char *text) {
    gmshFltkSetStatusMessage(text, 0, &unasked);
}

void sf_window_refresh(void) {
    gmshFltkUpdate(&unasked);
    gmshGraphicsDraw(&unasked);
}

void sf_window_close_branch(const char *name) {
    gmshFltkCloseTreeItem(name, &unasked);
}

/* ---- entries ---- */

bool sf_window_text(const char *name, char *text, size_t size) {
    char **value = NULL;
    size_t count = 0;
    int ierr = 0;
    gmshOnelabGetString(name, &value, &count, &ierr);
    snprintf(text, size, "%s", count > 0 ? value[0] : "");
    for (size_t k = 0; k < count; k++)
        gmshFree(value[k]);
    gmshFree(value);
    return ierr == 0 && count > 0;
}

bool sf_window_number(const char *name, double *number) {
    double *value = NULL;
    size_t count = 0;
    int ierr = 0;
    gmshOnelabGetNumber(name, &value, &count, &ierr);
    if (count > 0)
        *number = value[0];
    gmshFree(value);
    return ierr == 0 && count > 0;
}

static void set_entry(const char *name, const char *text) {
    SF_OWNED char *copy = strdup(text);
    void *const list = &copy; /* char ** in gmsh 4.8, const char *const * in 4.13 */
    if (copy)
        gmshOnelabSetString(name, list, 1, &unasked);
}

void sf_window_set_number(const char *name, double number) {
    gmshOnelabSetNumber(name, &number, 1, &unasked);
}

bool sf_window_take_action(char *action, size_t size) {
    sf_window_text(ACTION, action, size);
    if (!*action)
        return false;
    set_entry(ACTION, "");
    return true;
}

/* The words of "a|b" with their places. */
static void put_words(sf_json *json, const char *words, bool labels) {
    int place = 0;
    for (const char *at = words; *at; place++) {
        size_t length = strcspn(at, "|");
        SF_PRINTED(word, 64, "%.*s", (int)length, at);
        sf_json_integer(json, labels ? word : NULL, place);
        at += length + (at[length] == '|');
    }
}

static void put_number(sf_json *json, const sf_entry *e) {
    sf_json_open(json, "values", '[');
    sf_json_number(json, NULL, e->number);
    sf_json_close(json);
    if (e->kind == SF_ENTRY_NUMBER && e->high > e->low) {
        sf_json_number(json, "min", e->low);
        sf_json_number(json, "max", e->high);
        sf_json_number(json, "step", e->step);
    }
    if (e->kind == SF_ENTRY_NUMBER)
        return;
    sf_json_open(json, "choices", '[');
    put_words(json, e->kind == SF_ENTRY_WORD ? e->words : "0|1", false);
    sf_json_close(json);
    if (e->kind == SF_ENTRY_WORD) {
        SF_JSON_OBJECT(json, "valueLabels");
        put_words(json, e->words, true);
    }
}

static void put_attributes(sf_json *json, const sf_entry *e) {
    SF_JSON_OBJECT(json, "attributes");
    if (e->colour)
        sf_json_text(json, "Highlight", e->colour);
    if (e->closed)
        sf_json_text(json, "Closed", "1");
    if (e->kind == SF_ENTRY_BUTTON)
        SF_JSON_TEXTS(json, {"Macro", "Action"}, {"Aspect", "MiddleButton"});
}

static void send(const char *json) {
    gmshOnelabSet(json, "json", &unasked);
}

void sf_window_put(const sf_entry *e) {
    bool number = e->kind == SF_ENTRY_WORD || e->kind == SF_ENTRY_FLAG || e->kind == SF_ENTRY_NUMBER;
    SF_OWNED SF_TEXT_STREAM(file, text, size);
    sf_json json = {.file = file};
    if (!file)
        return;
    sf_json_open(&json, NULL, '{');
    SF_JSON_TEXTS(&json, {"type", number ? "number" : "string"}, {"name", e->name});
    if (e->help)
        sf_json_text(&json, "help", e->help);
    sf_json_bool(&json, "readOnly", e->kind == SF_ENTRY_SHOWN);
    if (e->kind == SF_ENTRY_FILE)
        sf_json_text(&json, "kind", "file");
    if (number) {
        put_number(&json, e);
    } else {
        SF_JSON_ARRAY(&json, "values");
        sf_json_text(&json, NULL, e->text ? e->text : "");
    }
    put_attributes(&json, e);
    sf_json_close(&json);
    fclose(json.file);
    send(text);
}

void sf_window_remove(const char *name) {
    gmshOnelabClear(name, &unasked);
}

/* Sends an entry of a geometry again, with `addition` at its end: of two of one name the last counts. */
static void change(const char *name, const char *addition) {
    char *json = NULL;
    SF_OWNED char *changed = NULL;
    int ierr = 0;
    gmshOnelabGet(&json, name, "json", &ierr);
    char *end = json ? strrchr(json, '}') : NULL;
    if (ierr == 0 && end && asprintf(&changed, "%.*s, %s }", (int)(end - json), json, addition) >= 0)
        send(changed);
    gmshFree(json);
}

void sf_window_colour_number(const char *name, const char *colour) {
    SF_PRINTED(attributes, 96, "\"attributes\":{\"Highlight\":\"%s\"}", colour ? colour : "");
    change(name, attributes);
}

void sf_window_lock_number(const char *name) {
    change(name, "\"readOnly\":true");
}

void sf_window_visit_numbers(void (*visit)(void *user, const char *name), void *user) {
    char **names = NULL;
    size_t count = 0;
    gmshOnelabGetNames(&names, &count, "", &unasked);
    for (size_t k = 0; k < count; k++) {
        double value;
        if (sf_window_number(names[k], &value))
            visit(user, names[k]);
        gmshFree(names[k]);
    }
    gmshFree(names);
}

/* gmsh fits the largest extent of the model's box around its middle. */
void sf_window_fit(const double low[3], const double high[3], double left, double right, double top) {
    double own = fmax(high[0] - low[0], fmax(high[1] - low[1], high[2] - low[2])),
           whole = fmax(right - left, top - low[2]), scale = own / whole;
    const char *const scales[] = {"General.ScaleX", "General.ScaleY", "General.ScaleZ"};
    for (int k = 0; k < 3 && scale > 0; k++)
        set_gmsh_option(scales[k], fmin(scale, 1));
    set_gmsh_option("General.TranslationX", 0.5 * (low[0] + high[0] - left - right));
    set_gmsh_option("General.TranslationY", 0.5 * (high[2] - top));
}

sf_status sf_window_write_picture(const char *path, sf_error *err) {
    int ierr = 0;
    gmshWrite(path, &ierr);
    return ierr == 0 ? SF_OK : SF_FAIL(err, SF_ERR_IO, "the picture %s cannot be written by gmsh", path);
}
