/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The same slow indentation of the same mesh in softfall and in CalculiX: force against depth. */
#ifndef SF_VERIFY_INDENTATION_H
#define SF_VERIFY_INDENTATION_H

#include "calculix/deck.h"
#include "calculix/ogden.h"
#include "base/error.h"

enum { SF_INDENTATION_POINTS = 64, SF_INDENTATION_FRAMES = 64 };

typedef struct sf_indentation {
    char folder[512]; /* temporary; holds case and curve */
    sf_ogden law;
    bool hyperfoam; /* softfall has the law itself, not its table */
} sf_indentation;

typedef struct sf_indentation_case {
    int layers;      /* of cells through the 50 mm; twice as many along the 100 mm of the quarter's side */
    double depth;    /* m */
    double interval; /* m, between two points of the curve */
    double speed;    /* m s-1, of softfall's missile */
    double modulus;  /* softfall's modulus in tension over that of the law */
    bool nodes;      /* CalculiX: contact node to surface */
    double penalty;  /* CalculiX: N mm-3 */
    double facet;    /* mm, size of the triangles that are CalculiX's missile */
} sf_indentation_case;

typedef struct sf_indentation_curve {
    int count;                             /* points reached: depth (k + 1) interval */
    double force[SF_INDENTATION_POINTS];   /* N, of the whole pad; softfall: mean over +- 0.25 mm */
    double depth_reached;                  /* m */
    double cpu;                            /* s, of all programs */
    char ending[256];                      /* CalculiX: its error, "" if none */
    int frames;                            /* softfall: one at every point */
    double stretch[SF_INDENTATION_FRAMES]; /* softfall: largest principal stretch */
    double beyond[SF_INDENTATION_FRAMES];  /* softfall: part of the volume where it exceeds 1.3 */
} sf_indentation_curve;

/* Makes the folder with the case and the law's table; SF_SOURCE_DIR must be set. End with sf_indentation_end.
 */
sf_status sf_indentation_begin(sf_indentation *in, sf_error *err);
/* The same with softfall's hyperfoam, of the law's numbers with this nu in every term. */
sf_status sf_indentation_begin_hyperfoam(sf_indentation *in, double nu, sf_error *err);
void sf_indentation_end(sf_indentation *in);

sf_status sf_indentation_softfall(const sf_indentation *in, const sf_indentation_case *c,
                                  sf_indentation_curve *out, sf_error *err);
sf_status sf_indentation_calculix(const sf_indentation *in, const sf_indentation_case *c,
                                  sf_indentation_curve *out, sf_error *err);

#endif
