/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A pad of layers: one conforming mesh, parted at the interfaces. Each layer gets nodes of its own, so that
 * no shape function reaches across, and ties join the nodes that stand at one place (docs/adr/0017). */
#pragma once
#include "case/case.h"
#include "pre/cloud/dual.h"

/* Two nodes of the parted mesh at one place, whose layers share a face there. */
typedef struct sf_layer_tie {
    int32_t node, other; /* ascending */
    uint8_t mask;        /* SF_FIX_* bits: components of u_h that are the same on both sides */
} sf_layer_tie;

/* Two layers that share faces, or that the case names. */
typedef struct sf_interface {
    int layer[2];    /* ascending */
    int kind;        /* SF_INTERFACE_* */
    double friction; /* -, of a loose one */
    int64_t faces;   /* of the mesh, that they share; 0: separate bodies */
} sf_interface;

enum { SF_INTERFACES_LISTED = 64 };
typedef struct sf_interfaces {
    int count; /* of all; the first SF_INTERFACES_LISTED are listed */
    sf_interface at[SF_INTERFACES_LISTED];
} sf_interfaces;

/* Nodes of the parted mesh stand layer by layer, in each in the order of the whole mesh. */
typedef struct sf_layers {
    int count;
    int64_t *first;    /* [count + 1] node where a layer begins; the last is their number */
    int32_t *origin;   /* [first[count]] the node of the whole mesh */
    int64_t *copy_ptr; /* [nodes of the whole mesh + 1] */
    int32_t *copy;     /* [first[count]] the nodes at a node of the whole mesh, ascending */
    int64_t tie_count; /* ascending by node and other; some may follow from others */
    sf_layer_tie *tie;
    int64_t *together; /* [first[count]] the same for nodes that are tied in all components */
    sf_interfaces interfaces;
} sf_layers;

/* `mesh`, whole, with its dual; the case's layers and interfaces. SF_ERR_INPUT with the place: an interface
 * that is not tied and not normal to an axis, or layers of the case's interfaces that do not touch. On
 * failure `*layers` is empty. */
sf_status sf_layers_build(const sf_case *c, const sf_mesh *mesh, const sf_dual *dual, sf_layers *layers,
                          sf_error *err);
void sf_layers_free(sf_layers *layers);

/* The node of a layer at a node of the whole mesh, which it has. */
int32_t sf_layers_copy(const sf_layers *layers, int32_t node, int layer);

/* The heaviest of the nodes at one place that are tied altogether: it stands for all of them as the contact
 * point (solver/point_rows.h). Needs the model's masses. */
int32_t sf_layers_heaviest(const sf_layers *layers, const sf_model *model, int32_t node);

/* The cells and nodes of a layer with numbers of their own; sets are left out. On failure `*part` is empty.
 */
sf_status sf_layers_part(const sf_mesh *mesh, const sf_layers *layers, int layer, sf_mesh *part,
                         sf_error *err);

/* Adds to area [first[count]], m2, the share of each node in the faces of a set. */
sf_status sf_layers_area(const sf_mesh *mesh, const sf_dual *dual, const sf_layers *layers,
                         const sf_node_set *set, double *area, sf_error *err);

/* Parts the whole mesh at its interfaces. A set keeps the nodes of those layers that have a face in it. */
sf_status sf_layers_split(sf_mesh *mesh, const sf_dual *dual, const sf_layers *layers, sf_error *err);

/* Carries what is held over the ties (`mask` and `base`, [first[count]], as of sf_model.fixed_mask and
 * fixed_base), and writes to the model the ties that follow neither from that nor from each other. */
sf_status sf_layers_hold(const sf_layers *layers, uint8_t *mask, uint8_t *base, sf_model *model,
                         sf_error *err);
/* Removes the ties of loose interfaces, after they have told what holds the layers: from there on the layers
 * only touch (the model's skin). */
void sf_layers_loosen(const sf_case *c, sf_model *model);
