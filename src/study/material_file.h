/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Writes a foam card as a material file: the keys of the group `material` of a case (docs/case.md) with units
 * and comments, and its compression curves as CSV files beside it. A case includes the file, or softfall-pre
 * takes it with
 * --set material=@FILE. */
#pragma once
#include "material/card.h"
#include "model/drop_kind.h"

/* The sentence by which a page of a fit offers the material to other solvers (docs/cards.md). */
#define SF_MATERIAL_ELSEWHERE                                                                                \
    "For another solver: softfall foam export material.cfg --format=dyna (or abaqus, radioss) "              \
    "--units=mm-ms-kg-GPa -o FILE writes the card, and lists what it cannot say."

typedef struct sf_material_text {
    const char *title;      /* first line of both files: a description of the material */
    const char *provenance; /* lines, each ended by '\n': where the numbers come from, their intervals */
    bool temperatures;      /* the curves have a temperature (K) in place of the rate */
    const sf_response_error *response_error; /* of a draw of a posterior; NULL: none */
} sf_material_text;

/* Writes <folder>/<name>.cfg, and <name>.csv or, for several curves, <name>-1.csv and so on; files that are
 * there are replaced. Numbers are written so that reading them gives the card back to 12 digits. SF_ERR_MODEL
 * with the reason, and no <name>.cfg, if softfall-pre would refuse it. */
sf_status sf_material_write_checked(const char *folder, const char *name, const sf_material *material,
                                    const sf_material_text *text, sf_error *err);
