/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "pre/cloud/domains.h"
#include "pre/cloud/layers.h"
#include "pre/drop_check.h"
#include "pre/hold.h"
#include "pre/missile_body.h"

/* Builds the model from a case, a mesh and a missile surface: cloud, supports, smoothing domains, masses,
 * constraints, contact points, missile. */

/* Results of the build, for the table that softfall-pre prints. */
typedef struct sf_build_report {
    char mesh_hash[17];
    int64_t cells[10]; /* by SF_CELL_* */
    int64_t orphan_count;
    double mesh_volume;        /* m3 */
    sf_domain_figures domains; /* of all layers */
    double unheld[3];          /* m, a face that will pass through another one or the anvil; NaN: none */
    double first_step;         /* s, before any safety factor */
    double slowdown;           /* -, first step over the mean one of a compression (model/stability.h) */
    bool contact_held;         /* every contact point is held along z: nothing to drop on */
    sf_hold hold;
    sf_contact_zone zone;
    sf_missile_body body; /* of the missile */
    sf_error between;     /* a part of the missile passes between the contact nodes */
    sf_invariants invariants;
    sf_interfaces interfaces; /* of the layers, as the materials of the model */
} sf_build_report;

/* A layer of the pad, or all of it. */
typedef struct sf_model_layer {
    const sf_mesh *mesh;
    sf_dual *dual; /* its edges move to the model */
    const sf_material *material;
    int64_t first; /* number of its first node in the model */
} sf_model_layer;

/* Spacing, supports, domains and masses of a layer. The case gives the kernel. */
sf_status sf_model_build_layer(const sf_case *c, const sf_model_layer *layer, sf_model *model,
                               sf_build_report *report, sf_error *err);

/* Builds the model. The mesh is reordered and its cells move into the model; the case's curves, motion and
 * the surface's arrays move as well (the sources stay valid for their free functions). On failure `*model` is
 * empty. Warnings go to `sink`. */
sf_status sf_model_build(sf_case *c, sf_mesh *mesh, sf_surface *surface, sf_model *model,
                         sf_build_report *report, const sf_sink *sink, sf_error *err);
