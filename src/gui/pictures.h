/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The window shows a drop: its bodies, the checks of softfall-pre, the figures, the frames. */
#pragma once
#include "gui/activity.h"
#include "gui/fields.h"
#include "gui/gmsh/window.h"
#include "post/results/results.h"
#include <limits.h>
#include <stddef.h>

/* Bodies that can be shown: the skin of the pad, and the missile with the supports behind it. */
typedef struct sf_shape {
    double unit; /* m per unit of the pictures */
    sf_body pad;
    int64_t *pad_node; /* [pad.node_count] node of the model that each node of the skin is; owned */
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
