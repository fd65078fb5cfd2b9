/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gui/gmsh/window.h"

#include <gmshc.h>
#include <math.h>
#include <string.h>

static int unasked; /* gmsh's error code where a failure is ignored */

/* The views of gmsh have fixed tags: a body has one of displacements and one of the values that colour it. */
enum { MOVES = 101, VALUES = 201 };
/* gmsh's numbers of kinds of elements, of views, of ranges and of colours. */
enum {
    TRIANGLE = 2,
    QUADRANGLE = 3,
    DISPLACEMENT = 5,
    GRAPH = 4,
    TOP_RIGHT = 3,
    OWN_RANGE = 2,
    GREY = 9,
    LOGARITHMIC = 2
};

/* A model of gmsh that is not shown holds the mesh of a body. It stays when its picture goes, until the
 * geometry is read anew: gmsh's window may still point to what it held. */
static char models[SF_PICTURES][48];
static double largest_value; /* of the pad, in all frames so far */

static bool has_view(int tag) {
    int ierr = 0, *tags = NULL;
    size_t count = 0;
    bool found = false;
    gmshViewGetTags(&tags, &count, &ierr);
    for (size_t k = 0; k < count; k++)
        found = found || tags[k] == tag;
    gmshFree(tags);
    return found;
}

/* Writes the name of an option of a view; returns false if there is no such view. */
static bool name_option(int tag, const char *option, char name[64]) {
    int ierr = 0, index = has_view(tag) ? gmshViewGetIndex(tag, &ierr) : -1;
    snprintf(name, 64, "View[%d].%s", index, option);
    return ierr == 0 && index >= 0;
}

static void set_option(int tag, const char *option, double value) {
    char name[64];
    if (name_option(tag, option, name))
        gmshOptionSetNumber(name, value, &unasked);
}

static void remove_view(int tag) {
    if (has_view(tag))
        gmshViewRemove(tag, &unasked);
}

/* The faces of so many corners as elements of the model's one entity. */
static sf_status add_faces(const sf_body *b, int corners, size_t *first, sf_error *err) {
    size_t count = 0;
    SF_OWNED size_t *tag = sf_alloc(err, b->face_count, sizeof *tag, "a picture"),
                    *node = sf_alloc(err, b->face_count, 4 * sizeof *node, "a picture");
    for (int64_t k = 0; k < b->face_count && err->status == SF_OK; k++) {
        if ((b->face[4 * k + 3] < 0 ? 3 : 4) != corners)
            continue;
        for (int c = 0; c < corners; c++)
            node[count * (size_t)corners + (size_t)c] = (size_t)b->face[4 * k + c] + 1;
        tag[count++] = (*first)++;
    }
    if (count > 0 && err->status == SF_OK)
        gmshModelMeshAddElementsByType(1, corners == 3 ? TRIANGLE : QUADRANGLE, tag, count, node,
                                       count * (size_t)corners, &unasked);
    return err->status;
}

/* Returns the tags of the nodes, from 1 on; the caller frees them. */
static size_t *number_nodes(const sf_body *b, sf_error *err) {
    size_t *tag = sf_alloc(err, b->node_count, sizeof *tag, "a picture");
    for (int64_t k = 0; k < b->node_count && tag; k++)
        tag[k] = (size_t)k + 1;
    return tag;
}

static sf_status add_mesh(const sf_body *b, sf_error *err) {
    size_t first = 1;
    SF_OWNED size_t *tag = number_nodes(b, err);
    gmshModelAddDiscreteEntity(2, 1, NULL, 0, &unasked);
    if (tag)
        gmshModelMeshAddNodes(2, 1, tag, (size_t)b->node_count, b->position, 3 * (size_t)b->node_count, NULL,
                              0, &unasked);
    if (err->status == SF_OK && add_faces(b, 3, &first, err) == SF_OK)
        add_faces(b, 4, &first, err);
    return err->status;
}

void sf_view_remove(sf_picture which) {
    set_option(MOVES + (int)which, "ExternalView", -1);
    remove_view(MOVES + (int)which);
    remove_view(VALUES + (int)which);
}

/* gmsh forgets the options of a view with it. */
static void dress(sf_picture which, double largest) {
    int ierr = 0, moves = MOVES + (int)which, values = VALUES + (int)which;
    bool grey = which == SF_PICTURE_MISSILE;
    set_option(moves, "VectorType", DISPLACEMENT);
    set_option(moves, "DisplacementFactor", 1);
    set_option(moves, "ExternalView", grey ? -1 : gmshViewGetIndex(values, &ierr));
    set_option(moves, "ShowScale", !grey);
    set_option(moves, "Light", 1);
    set_option(moves, "ShowElement", !grey);
    set_option(moves, "ShowTime", grey ? 0 : 1);
    if (!grey) {
        set_option(moves, "ScaleType", LOGARITHMIC);
        set_option(moves, "RangeType", OWN_RANGE);
        set_option(moves, "CustomMin", largest / 300);
        set_option(moves, "CustomMax", largest);
        set_option(moves, "SaturateValues", 1);
        set_option(values, "Visible", 0);
        return;
    }
    set_option(moves, "ColormapNumber", GREY);
    set_option(moves, "RangeType", OWN_RANGE); /* so wide that every value has the colour of its middle */
    set_option(moves, "CustomMin", -1e12);
    set_option(moves, "CustomMax", 1e12);
}

sf_status sf_view_begin(sf_picture which, const char *title, const sf_body *body, sf_error *err) {
    static int serial;
    char *shown = NULL;
    sf_view_remove(which);
    snprintf(models[which], sizeof models[which], "softfall %s %d",
             which == SF_PICTURE_PAD ? "pad" : "missile", ++serial);
    gmshModelGetCurrent(&shown, &unasked);
    gmshModelAdd(models[which], &unasked);
    add_mesh(body, err);
    if (shown)
        gmshModelSetCurrent(shown, &unasked);
    gmshFree(shown);
    if (which == SF_PICTURE_PAD)
        gmshViewAdd("von Mises stress [kPa]", VALUES + (int)which, &unasked);
    gmshViewAdd(title, MOVES + (int)which, &unasked);
    largest_value = 0;
    dress(which, 1);
    return err->status;
}

void sf_view_add(sf_picture which, int frame, double time, const sf_body *body, const double *displacement,
                 const double *value) {
    size_t count = (size_t)body->node_count;
    SF_OWNED size_t *tag = number_nodes(body, SF_IGNORED);
    if (tag && value)
        gmshViewAddHomogeneousModelData(VALUES + (int)which, frame, models[which], "NodeData", tag, count,
                                        (double *)value, count, time, 1, 0, &unasked);
    if (tag)
        gmshViewAddHomogeneousModelData(MOVES + (int)which, frame, models[which], "NodeData", tag, count,
                                        (double *)displacement, 3 * count, time, 3, 0, &unasked);
    for (size_t k = 0; k < count && value; k++)
        largest_value = fmax(largest_value, value[k]);
    dress(which, largest_value > 0 ? largest_value : 1);
}

void sf_view_show_frame(int frame) {
    for (int which = 0; which < SF_PICTURE_CURVE; which++) {
        set_option(VALUES + which, "TimeStep", frame);
        set_option(MOVES + which, "TimeStep", frame);
    }
}

void sf_view_plot(const char *title, const char *x_label, int64_t count, const double *x, const double *y) {
    enum { TAG = MOVES + SF_PICTURE_CURVE };
    char name[64];
    SF_OWNED double *data = malloc(4 * (size_t)count * sizeof *data + 1);
    remove_view(TAG);
    for (int64_t k = 0; data && k < count; k++)
        memcpy(&data[4 * k], (double[]){x[k], 0, 0, y[k]}, 4 * sizeof *data);
    if (data && count > 1) {
        gmshViewAdd(title, TAG, &unasked);
        gmshViewAddListData(TAG, "SP", (int)count, data, 4 * (size_t)count, &unasked);
        set_option(TAG, "Type", GRAPH);
        set_option(TAG, "AutoPosition", TOP_RIGHT);
        if (name_option(TAG, "AxesLabelX", name))
            gmshOptionSetString(name, x_label, &unasked);
        set_option(TAG, "Axes", 3);
        set_option(TAG, "PointSize", 1);
        set_option(TAG, "LineWidth", 2);
        set_option(TAG, "ShowScale", 1);
        set_option(TAG, "NbIso", 5);
        set_option(TAG, "IntervalsType", 2);
    }
}
