/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "gui/gmsh/window.h"
#include "io/process.h"
#include "study/run_folder.h"

/* The parameters of a .geo file: gmsh's tree knows them by their Name, a case by their variable. gmsh tells
 * no one which belongs to which, so the text of the file (and of what it includes) is looked through:
 * DefineConstant and DefineNumber with a Name that is written out. */

enum { SF_GEO_LABEL_SIZE = 256, SF_GEO_NAMES = 128 };

typedef struct sf_geo_name {
    char variable[SF_CASE_NAME_SIZE]; /* "thickness" */
    char name[SF_GEO_LABEL_SIZE];     /* "Pad/2 Thickness [mm]" */
} sf_geo_name;

typedef struct sf_geo_names {
    int count;
    sf_geo_name name[SF_GEO_NAMES];
} sf_geo_names;

/* Reads the names that a geometry defines; a file that is no text of gmsh's language has none. Errors: the
 * file cannot be read. */
sf_status sf_geo_names_read(const char *path, sf_geo_names *names, sf_error *err);
/* Adds the names that a text defines. */
void sf_geo_names_scan(const char *text, sf_geo_names *names);

/* The fields of the tree: the keys of the case, from the table of keys, and the parameters of its geometries.
 * A field that differs from the case is an override, as --set takes it; nothing else of the tree reaches a
 * run. */

enum {
    SF_FIELDS = 160,
    SF_FIELD_KEY_SIZE = 192,
    SF_FIELD_NAME_SIZE = 288,
    SF_FIELD_TEXT_SIZE = 512,
    SF_FIELD_OVERRIDES = 56 /* softfall-pre takes 64 */
};

typedef struct sf_field {
    char key[SF_FIELD_KEY_SIZE];    /* "missile.velocity", "geometry.parameters.thickness", "material" */
    char name[SF_FIELD_NAME_SIZE];  /* of its entry in the tree */
    char given[SF_FIELD_TEXT_SIZE]; /* as the case (or the default of the key or the geometry) has it */
    char now[SF_FIELD_TEXT_SIZE];   /* as the tree has it */
    sf_entry_kind kind;
    const char *words, *help; /* static */
    bool of_geometry;         /* an entry that the geometry makes */
    bool in_case;             /* of a geometry: the case gives it */
    bool wrong;               /* it is marked */
} sf_field;

typedef struct sf_fields {
    int count;
    sf_field field[SF_FIELDS];
} sf_fields;

/* An override as a text. */
typedef struct sf_overrides {
    int count;
    char *text[SF_FIELD_OVERRIDES]; /* owned */
} sf_overrides;

/* Reads the keys of the case without overrides; `now` is kept of the fields that differed from their case
 * `before`. Parameters of geometries are gone: sf_fields_add_geometry. The case is the caller's. On failure
 * the fields mean nothing. */
sf_status sf_fields_read(const char *case_path, const sf_fields *before, sf_fields *fields, sf_case *out,
                         sf_error *err);
/* Adds the parameters `names` of a geometry, key "group.VARIABLE", with what the case gives; others are known
 * once the geometry was read: sf_fields_take_defaults. `before`: the fields as they were, for what was
 * changed. */
void sf_fields_add_geometry(const char *group, const sf_geo_names *names, const sf_geo_source *source,
                            const sf_fields *before, sf_fields *fields);

/* Puts the fields into the tree: those of the case, and the values of the geometries' parameters that are
 * known. */
void sf_fields_show(const sf_fields *fields);
/* After a geometry was read: what the case does not give is as the tree has it. */
void sf_fields_take_defaults(sf_fields *fields);
/* Takes the values that the tree has. *case_changed, *geometry_changed: a field has another value than
 * before. */
void sf_fields_take(sf_fields *fields, bool *case_changed, bool *geometry_changed);
/* Puts `text` into the entry of that key, as a user does; false: there is none. */
bool sf_fields_enter(const sf_fields *fields, const char *key, const char *text);
sf_field *sf_fields_find(const sf_fields *fields, const char *key);

/* The overrides; release with sf_overrides_free, also on failure. SF_ERR_INPUT: too many, or
 * parameters of both geometries in one entry of the tree. */
sf_status sf_fields_overrides(const sf_fields *fields, sf_overrides *out, sf_error *err);
void sf_overrides_free(sf_overrides *overrides);

/* Parameters of geometries whose variables are not known can be seen, not changed: no run would have them. */
void sf_fields_lock_unknown(sf_fields *fields);

/* Marks the fields that the sentence of an error names (NULL: none), in the tree too. */
void sf_fields_mark(sf_fields *fields, const char *sentence);

/* The activity of the window, and the next one that a button or the end of a program leads to. */

/* Lists each activity with its shown name and the activities that follow the success of its program and Stop.
 * An activity that success does not change is not busy. Only a run leaves results. */
#define SF_ACTIVITIES(X)                                                                                     \
    X(IDLE, "ready", IDLE, IDLE)                                                                             \
    X(MESHING, "meshing", MESHED, CANCELLING) /* softfall-pre for the checks */                              \
    X(MESHED, "meshed", MESHED, MESHED)                                                                      \
    X(PREPARING, "meshing before the run", RUNNING, CANCELLING) /* softfall-pre for a run */                 \
    X(RUNNING, "running", REPORTING, STOPPING)                  /* softfall-solve */                         \
    X(STOPPING, "stopping", DONE, STOPPING)                     /* a run was asked to end */                 \
    X(CANCELLING, "cancelling", STOPPED, CANCELLING)   /* softfall-pre or Save case was asked to end */      \
    X(STOPPED, "stopped", STOPPED, STOPPED)            /* a run can be resumed */                            \
    X(REPORTING, "writing the report", DONE, STOPPING) /* softfall-post */                                   \
    X(SAVING, "saving the case", SAVED, CANCELLING)                                                          \
    X(SAVED, "saved", SAVED, SAVED)                                                                          \
    X(DONE, "done", DONE, DONE)                                                                              \
    X(FAILED, "failed", FAILED, FAILED)

#define SF_ACTIVITY_CONSTANT(constant, ...) SF_##constant,
typedef enum sf_activity { SF_ACTIVITIES(SF_ACTIVITY_CONSTANT) SF_ACTIVITY_COUNT } sf_activity;
#undef SF_ACTIVITY_CONSTANT

typedef enum sf_event {
    SF_PRESS_MESH,
    SF_PRESS_RUN, /* of what is done: its report */
    SF_PRESS_STOP,
    SF_PRESS_SAVE,
    SF_CHILD_DONE,        /* the program ended well */
    SF_CHILD_INTERRUPTED, /* it ended because it was asked to */
    SF_CHILD_FAILED,
    SF_EDIT, /* a value or a file has changed */
    SF_EVENT_COUNT
} sf_event;

/* "ready", ...; static. */
const char *sf_activity_name(sf_activity activity);
/* A program is at work. */
bool sf_activity_is_busy(sf_activity activity);
/* The activity after the event; the same one where the event means nothing. */
sf_activity sf_activity_next(sf_activity activity, sf_event event);

/* Notices that files change. */

enum { SF_WATCHED = 64 };

/* Two stamps of a file that is as it was are equal. */
typedef struct sf_watch_stamp {
    int64_t seconds, nanoseconds, size;
    uint64_t inode; /* 0: there is no file */
} sf_watch_stamp;

typedef struct sf_watch {
    int count;
    struct {
        char path[PATH_MAX];
        sf_watch_stamp stamp;
    } file[SF_WATCHED];
} sf_watch;

sf_watch_stamp sf_watch_stamp_of(const char *path);
bool sf_watch_same(const sf_watch_stamp *a, const sf_watch_stamp *b);

/* Watches what this process has read from entry `first` of the register on (io/plain_file.h), as it is. */
void sf_watch_register(sf_watch *watch, size_t first);
void sf_watch_add(sf_watch *watch, const char *path);
/* The first file that is not as it was; NULL: none. From now on it is watched as it is now. */
const char *sf_watch_changed(sf_watch *watch);

/* The command lines of softfall-pre, softfall-solve, softfall-post and softfall-new, begun as children
 * (io/process.h). */

/* The case with its overrides -> at->model; meshes are shared among the runs in `cache`. */
sf_status sf_programs_pre(sf_child *child, const char *case_path, const sf_run_folder *at, const char *cache,
                          int count, const char *const *overrides, FILE *log, sf_error *err);
/* at->model -> at->results, or on from at->checkpoint. `threads` 0: as the program chooses. */
sf_status sf_programs_solve(sf_child *child, const sf_run_folder *at, bool resume, int threads, FILE *log,
                            sf_error *err);
/* at->results -> at->path/report. */
sf_status sf_programs_post(sf_child *child, const sf_run_folder *at, FILE *log, sf_error *err);
/* The case with its overrides -> a folder of its own, by softfall-new. */
sf_status sf_programs_save(sf_child *child, const char *case_path, const char *folder, int count,
                           const char *const *overrides, FILE *log, sf_error *err);

/* The folder in which the window keeps its runs: $XDG_CACHE_HOME/softfall, or ~/.cache/softfall. Nothing is
 * written anywhere else but by Save case. */

/* Makes it if need be. SF_ERR_IO: there is no home folder, or it cannot be made; SF_ERR_INPUT: it is not
 * softfall's own (io/folder.h). On failure the path is "". */
sf_status sf_cache_find(char *path, size_t size, sf_error *err);

/* Writes the file that gmsh opens in place of a geometry, into that folder: it merges the geometry. What
 * gmsh's menus rename, delete or append to is that file. `wrap` is "" if it cannot be written. */
void sf_cache_wrap(const char *cache, const char *geometry, char *wrap, size_t size);

/* The window shows a drop: its bodies, the checks of softfall-pre, the figures, the frames. */

/* Bodies that can be shown: the skin of the pad, and the missile with the supports behind it. */
typedef struct sf_shape {
    double unit; /* m per unit of the pictures */
    sf_body pad;
    int32_t *pad_node; /* [pad.node_count] node of the model that each node of the skin is; owned */
    sf_body missile;
    int64_t missile_nodes;    /* the first of its nodes, which move */
    double *missile_position; /* [missile.node_count][3] m, at t = 0; owned */
} sf_shape;

sf_status sf_shape_of_results(const sf_results *results, double unit, sf_shape *shape, sf_error *err);
void sf_shape_free(sf_shape *shape);

/* One frame: displacement of pad and missile in units, and the pad's von Mises stress (kPa), for the nodes of
 * the bodies. Arrays from sf_alloc, owned by the caller; `stress` NULL if the frame has none. */
typedef struct sf_shape_frame {
    double *pad, *stress, *missile;
} sf_shape_frame;

/* Shows the checks of softfall-pre, and the sentences of programs, from their output. */

enum { SF_CHECK_ENTRIES = 10, SF_CHECK_NAME = 80, SF_CHECK_VALUE = 200 };

typedef struct sf_check_entry {
    char name[SF_CHECK_NAME]; /* in the tree: "3Checks/00nodes" */
    char value[SF_CHECK_VALUE];
} sf_check_entry;

typedef struct sf_check_entries {
    int count;
    sf_check_entry entry[SF_CHECK_ENTRIES];
} sf_check_entries;

/* Reads the checks that softfall-pre left in model.h5 (/provenance/report). */
sf_status sf_checks_read(const char *model, sf_check_entries *checks, sf_error *err);
/* Puts them into the branch Checks of the tree, and removes them from it. */
void sf_checks_show(const sf_check_entries *checks);
void sf_checks_clear(const sf_check_entries *checks);

/* The last sentence of a program's output, without the program's name. */
void sf_checks_sentence(const char *text, char *out, size_t size);
/* The solver's last line of progress, without double blanks; "" if there is none. */
void sf_checks_progress(const char *text, char *out, size_t size);

/* The figures of a run in the tree, by the functions of softfall-post. */

/* The pictures of the window: the geometry of a case, the model that softfall-pre has made, or the frames of
 * a run. Each replaces the one before. */

/* The missile's place by the case alone, until softfall-pre has computed the exact one. */
typedef struct sf_pictures_place {
    bool given;
    double position[2], gap; /* m */
} sf_pictures_place;

typedef struct sf_pictures {
    sf_shape shape;        /* that is shown; pad.node_count 0: none */
    sf_watch_stamp seen;   /* of the results.h5 that is shown */
    int frames;            /* of it that are shown */
    int frame;             /* shown, as the tree has it */
    bool fitted;           /* the picture shows pad and missile */
    char opened[PATH_MAX]; /* what gmsh opens in place of the pad's geometry; "": that itself */
} sf_pictures;

/* Shows the geometries with the parameters of the tree: gmsh's own defaults are taken into `fields`. gmsh
 * shows one model only, and the missile is a picture. */
sf_status sf_pictures_show_geometry(sf_pictures *pictures, const sf_case *c, const sf_pictures_place *place,
                                    sf_fields *fields, sf_error *err);
/* Shows pad and missile of a model.h5. `length_unit` in m. */
void sf_pictures_show_model(sf_pictures *pictures, const char *path, double length_unit);
/* Shows the new frames and the curve of a results.h5, and of a run that has ended (`whole`) its figures and
 * the frame of the largest acceleration. The file is complete at any instant; if it is replaced while it is
 * read, the next call shows the newer one. */
void sf_pictures_show_results(sf_pictures *pictures, const char *path, double length_unit, bool whole);
/* Shows the frame that the user has chosen in the tree. */
void sf_pictures_take_frame(sf_pictures *pictures);

/* One case in the window: its fields, its geometry, its run, and what is shown of them. */

typedef struct sf_session {
    const char *case_path; /* borrowed */
    int threads;           /* of softfall-solve; 0: as it chooses */
    char cache[PATH_MAX];  /* its runs are there; "": there is no place for them */
    sf_case case_file;     /* without the changes of the window */
    sf_fields fields;
    sf_watch watch; /* what was read of the case and its geometries */
    sf_activity activity;
    sf_check_entries checks; /* in the tree */
    char sentence[1100];     /* the last one told */
    bool failed;             /* it is an error */
    sf_pictures pictures;
    sf_pictures_place place;
    double next_look; /* s, at the program that runs and the files */

    sf_run_folder at; /* of the present values; path "" until Mesh or Run */
    sf_child child;
    int lock;      /* on the folder of the run while a program is at work; 0: none */
    FILE *log;     /* its output */
    bool resuming; /* softfall-solve goes on from a checkpoint */
    bool told;     /* softfall-solve has told its progress */
} sf_session;

/* Reads the case and shows it in the window. Failures are told there. Release with sf_session_end. */
void sf_session_begin(sf_session *session);
/* Ends the program that runs, so that its results can be resumed; releases. */
void sf_session_end(sf_session *session);

/* A button ("mesh", "run", "stop", "report", "paraview", "save") or "check". */
void sf_session_act(sf_session *session, const char *action);
/* Looks after the program that runs, its results and the files that were read. */
void sf_session_refresh(sf_session *session);
