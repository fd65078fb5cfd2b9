/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "base/error.h"
#include <stdint.h>

/* A user's own geometry in gmsh's window, as in gmsh itself: its language may do there what it may do in
 * gmsh. A run never uses what is made here: softfall-pre reads the file anew, confined. */

/* Triangles of a surface, in the geometry's length unit. */
typedef struct sf_triangles {
    int64_t count;
    double *corner; /* [count][3][3] owned: free */
    double low[3], high[3];
} sf_triangles;

/* Opens the file, or `opened` in its place unless that is "", as the one model that is shown, with its
 * parameters in the tree at the values that the tree has. SF_ERR_INPUT: the first error that gmsh reports,
 * with its file and line. */
sf_status sf_geometry_show(const char *path, const char *opened, sf_error *err);
/* Box of the model that is shown. */
void sf_geometry_box(double low[3], double high[3]);
/* Opens the file, meshes its surfaces and forgets it; its parameters stay in the tree. */
sf_status sf_geometry_read_surface(const char *path, sf_triangles *surface, sf_error *err);
/* Forgets all models and pictures. */
void sf_geometry_clear(void);

/* gmsh's window and its tree of parameters (ONELAB), by gmsh's C API. The folder src/gui/gmsh is the only
 * part of the window that calls gmsh; nothing in it knows of cases and runs. One thread. */

/* The kinds of entry in the tree. */
typedef enum sf_entry_kind {
    SF_ENTRY_TEXT,   /* a text that can be changed */
    SF_ENTRY_FILE,   /* the same, with a chooser of files */
    SF_ENTRY_WORD,   /* one of `words` */
    SF_ENTRY_FLAG,   /* a check box: number 0 or 1 */
    SF_ENTRY_NUMBER, /* a number within low and high, by steps */
    SF_ENTRY_SHOWN,  /* a text that cannot be changed */
    SF_ENTRY_BUTTON, /* a click puts `text` into the action */
} sf_entry_kind;

/* An entry of the tree. Strings are borrowed during the call. */
typedef struct sf_entry {
    const char *name; /* "/" separates branches; digits in front of a word sort and are not shown */
    sf_entry_kind kind;
    const char *text;
    double number, low, high, step;
    const char *words;  /* of SF_ENTRY_WORD: "a|b" */
    const char *help;   /* shown beside the pointer; NULL: none */
    const char *colour; /* of the field, "LightGreen"; NULL: none */
    bool closed;        /* its branch begins closed */
} sf_entry;

/* Starts gmsh with the user's options, so set that it writes no file by itself; no window yet. */
sf_status sf_window_start(sf_error *err);
/* Opens the window. SF_ERR_IO without a display. */
sf_status sf_window_open(sf_error *err);
/* Handles what happens within so many seconds; false once the user has closed the window. */
bool sf_window_wait(double seconds);
/* Releases gmsh. */
void sf_window_end(void);

/* The button or the event ("check": a value has changed) since the last call; false: none. */
bool sf_window_take_action(char *action, size_t size);
/* The line below the picture. */
void sf_window_say(const char *text);
/* Shows the entries and the picture as they now are. */
void sf_window_refresh(void);
/* Closes a branch of the tree. */
void sf_window_close_branch(const char *name);

/* Makes the entry, or replaces it with its value. */
void sf_window_put(const sf_entry *entry);
void sf_window_remove(const char *name);
/* Values as they stand in the tree; false: there is no such entry. */
bool sf_window_text(const char *name, char *text, size_t size);
bool sf_window_number(const char *name, double *number);
void sf_window_set_number(const char *name, double number);
/* Colours an entry that a geometry has made; NULL: no colour. */
void sf_window_colour_number(const char *name, const char *colour);
/* Shows a value of a geometry as one that cannot be changed. */
void sf_window_lock_number(const char *name);
/* Calls `visit` with the name of each number of the tree. */
void sf_window_visit_numbers(void (*visit)(void *user, const char *name), void *user);

/* Moves and scales the picture from the model's box (side view, x and z) so that a larger box of height and
 * width fits. */
void sf_window_fit(const double low[3], const double high[3], double left, double right, double top);
/* The picture (without the tree) as a PNG file. */
sf_status sf_window_write_picture(const char *path, sf_error *err);

/* Bodies of triangles and quadrangles that move from frame to frame, and curves, shown beside the
 * geometry. */

/* A body: its nodes and faces. */
typedef struct sf_body {
    int64_t node_count;
    double *position; /* [node_count][3], in the geometry's length unit */
    int64_t face_count;
    int32_t *face; /* [face_count][4], -1 in the fourth place of a triangle */
} sf_body;

/* The pictures. Each has its fixed place: one that is made again replaces the one before. */
typedef enum sf_picture {
    SF_PICTURE_MISSILE, /* grey */
    SF_PICTURE_PAD,     /* coloured by a value */
    SF_PICTURE_CURVE,   /* a graph */
    SF_PICTURES
} sf_picture;

/* Makes a body the picture `which` (not the graph), without frames. */
sf_status sf_view_begin(sf_picture which, const char *title, const sf_body *body, sf_error *err);
/* The next frame: displacement [node_count][3] in the geometry's unit, value [node_count] (NULL: none). */
void sf_view_add(sf_picture which, int frame, double time, const sf_body *body, const double *displacement,
                 const double *value);
/* Shows a frame of all bodies. */
void sf_view_show_frame(int frame);
/* A graph of y over x. */
void sf_view_plot(const char *title, const char *x_label, int64_t count, const double *x, const double *y);
void sf_view_remove(sf_picture which);
