/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Makes the model of a case: the geometry through gmsh, then the build. */
#pragma once
#include "pre/build.h"

enum { SF_LIBRARIES_SIZE = 96 };

/* Sections of a drop, for drops beside its own: with the spacing of the model and with half of it. Where the
 * drop is not axisymmetric, its quarter is not modelled or ends too near, they are those of one that is like
 * it (pre/alike.h). The first is empty where the model is that section; both are where there is none, or it
 * has more than SF_SECTIONS_MOST nodes (pre/alike.h). */
enum { SF_SECTION_EQUAL, SF_SECTION_FINE, SF_SECTIONS };
typedef struct sf_sections {
    sf_mesh mesh[SF_SECTIONS];
    sf_surface missile[SF_SECTIONS];
    bool alike;        /* of another drop than the model's */
    const char *store; /* for their domains and figures (io/folder.h); borrowed from the case; NULL: none */
} sf_sections;

void sf_sections_free(sf_sections *sections);
/* The model of one of them, which it uses up. `c`: the case of the drop, read once more; it is used up, too.
 */
sf_status sf_sections_build(sf_sections *sections, int which, sf_case *c, sf_model *model, sf_error *err);

/* `libraries` receives the versions of the libraries that took part, `sections` (NULL: not wanted) the
 * sections of an axisymmetric drop; release with sf_sections_free. The curves and the motion of the case
 * move into the model (sf_model_build). Warnings go to `sink`. SF_ERR_INPUT, too, if every contact point is
 * held, or if the pad is not held (hold.h). On failure `*model` is empty. */
sf_status sf_model_make(sf_case *c, sf_model *model, sf_build_report *report,
                        char libraries[SF_LIBRARIES_SIZE], sf_sections *sections, const sf_sink *sink,
                        sf_error *err);
