/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pictures of the deformed pad and the missile in the cut of post/view/cut.h, side by side, as one SVG
 * element with one scale of colours: bands of a field that is linear in each tetrahedron. */
#ifndef SF_POST_PICTURE_H
#define SF_POST_PICTURE_H

#include "post/view/cut.h"

/* The colours of the scale, red, green and blue, from its low to its high end; those between are linear. */
enum { SF_PICTURE_COLOURS = 8 };
extern const unsigned char sf_picture_colours[SF_PICTURE_COLOURS][3];
extern const double sf_picture_decades; /* of the logarithmic scale */

/* One instant. */
typedef struct sf_picture {
    const char *title;
    const sf_frame_head *head;
    const sf_frame *frame; /* holds the displacement, and the field */
} sf_picture;

typedef struct sf_picture_style {
    sf_frame_field field; /* of one component */
    double factor;        /* from its unit to that of the scale */
    const char *label;    /* of the scale, with its unit */
    bool logarithmic;     /* from the largest value over 300; else from 0 */
    bool lines;           /* the cells' outlines */
    double half_width;    /* m, of what is shown, to both sides of the axis; INFINITY: the whole pad */
} sf_picture_style;

/* Returns the picture from malloc, owned by the caller; NULL on failure. */
char *sf_picture_draw(const sf_cut *cut, const sf_picture *pictures, int count, const sf_picture_style *style,
                      sf_error *err);

/* A polygon of a linear field. */
enum { SF_CORNERS = 8 };
typedef struct sf_corner {
    double x, y, value;
} sf_corner;
/* The part of a convex polygon of at most 6 corners where low <= value <= high, into `part`; returns its
 * corners, 0 if there is none. */
int sf_picture_band(int count, const sf_corner *corner, double low, double high, sf_corner part[SF_CORNERS]);

#endif
