/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The pictures of the window: the geometry of a case, the model that softfall-pre has made, or the frames of
 * a run. Each replaces the one before. */
#ifndef SF_GUI_PICTURES_H
#define SF_GUI_PICTURES_H

#include "gui/children.h"
#include "gui/fields.h"
#include "gui/shape.h"

/* The missile's place by the case alone, until softfall-pre has computed the exact one. */
typedef struct sf_pictures_place {
    bool given;
    double position[2], gap; /* m */
} sf_pictures_place;

typedef struct sf_pictures {
    sf_shape shape;      /* that is shown; pad.node_count 0: none */
    sf_watch_stamp seen; /* of the results.h5 that is shown */
    int frames;          /* of it that are shown */
    int frame;           /* shown, as the tree has it */
    bool fitted;         /* the picture shows pad and missile */
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
/* Removes the results from the window, and releases their shape. */
void sf_pictures_forget(sf_pictures *pictures);

#endif
