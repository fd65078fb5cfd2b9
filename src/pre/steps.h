/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The steps of a build, in their order in build.c and make.c; internal to src/pre. */
#pragma once
#include "pre/cloud/cloud.h"

/* Covers without cells: the membrane on faces of the pad (theory, section "Membranes"). */

/* Sets the model's membrane to the faces of the case's groups on the surface of the whole mesh. SF_ERR_INPUT:
 * a group has no face there, or two of them share one. */
sf_status sf_membrane_take(const sf_case *c, const sf_mesh *mesh, const sf_dual *dual,
                           const sf_layers *layers, sf_model *model, sf_error *err);
/* Adds its mass to those of the nodes. */
void sf_membrane_weigh(sf_model *model);

/* Finds the rigid-body modes of the pad, and of its connected parts against each other, that base, anvil,
 * symmetry planes and ties leave free. */

#define SF_HOLD_MOST 0.5 /* of the underside's nodes, held along z: mostly held */

typedef struct sf_hold {
    int64_t rows[3];         /* nodes held along x, y and z; those that rest are held along z */
    bool lifts;              /* some rigid motion with a vertical part is free */
    int64_t lifted;          /* the layer of a part that it moves */
    double lifted_middle[3]; /* m, of the part */
    bool lifted_whole;       /* the part is the whole layer */
    bool slides[2];          /* along x, y */
    bool turns;              /* about a vertical axis */
    double underside;        /* share of the nodes of the pad's underside that are held along z or rest */
    double underside_low;    /* m, its z */
} sf_hold;

/* Needs positions and constraints of the model. */
sf_status sf_hold_find(const sf_model *model, sf_hold *hold, sf_error *err);

/* SF_ERR_INPUT if the pad or a layer can be moved vertically or tilted without being deformed; a pad on a
 * rigid support may, and so may `separate` bodies, which lie where they are until they are hit. Also of foam
 * with a permanent set that may move at all without being deformed, and of several sets. */
sf_status sf_hold_check(const sf_hold *hold, bool separate, const sf_model *model, sf_error *err);
/* Tells `sink` of a mostly free underside, and of a missile that pushes the pad along a free motion. */
void sf_hold_warn(const sf_hold *hold, const sf_model *model, const sf_sink *sink);
/* Tells `sink` of bodies of a pad that neither the missile on its way nor a body that it may move comes near.
 */
sf_status sf_hold_warn_apart(const sf_model *model, const sf_sink *sink, sf_error *err);

/* The surface groups that a case names. */

/* The group that the case names under `key`; NULL: SF_ERR_INPUT with the groups that exist. */
const sf_node_set *sf_group_need(const sf_mesh *mesh, const char *key, const char *name, sf_error *err);

/* True if the group is a plane normal to the axis, at `place` (m). */
bool sf_group_is_plane(const sf_model *model, const sf_node_set *set, int axis, double *place);
/* The axis (0 x, 1 y, 2 z) that a plane group is normal to, or -1. Needs positions and thickness. */
int sf_group_plane_axis(const sf_model *model, const sf_node_set *set);

/* The support of the pad: pad.base, the groups of pad.fixed and pad.sliding, and the anvil's plane. */

/* By node [node_count]: held components (SF_FIX_*), 1 if they count for the base reaction, 1 if it rests. */
typedef struct sf_base_marks {
    uint8_t *mask, *base, *rest; /* borrowed */
} sf_base_marks;

/* Marks the groups of pad.fixed by pad.base, and those of pad.sliding. Symmetry planes are marked already. */
sf_status sf_base_mark(const sf_case *c, const sf_mesh *mesh, const sf_model *model,
                       const sf_base_marks *marks, sf_error *err);

/* The resting nodes of the model with the loads that carry its weight. Needs the masses. */
sf_status sf_base_rest(const sf_case *c, const sf_base_marks *marks, sf_model *model, sf_error *err);

/* The anvil below the pad: the plane of its underside if most of that is held or rests; or none. */
void sf_base_place_anvil(const sf_case *c, const sf_hold *hold, sf_model *model);

/* The impact point: where on the pad's top the missile's lowest point arrives. */

/* The missile's lowest point (m): of its sphere, or of its surface's nodes; where several are lowest the
 * centroid of the flat faces there, or, without such faces, the middle of the box around these nodes. */
void sf_impact_lowest(const sf_surface *surface, const sf_missile_card *card, double point[3]);

/* Height (m) of the pad's highest point. */
double sf_impact_top(const sf_model *model);

/* Moves the surface, and the card's sphere, in x and y so that the lowest point, on its way along
 * the direction, comes to missile.position at the height of the pad's highest point. Normal to a symmetry
 * plane nothing moves. Does nothing without missile.position. The card's shape is set, its body not yet;
 * the model has its cloud and its sets. SF_ERR_INPUT: the position lies off a
 * symmetry plane, or outside the convex outline of the contact nodes. */
sf_status sf_impact_place(const sf_case *c, const sf_model *model, sf_surface *surface, sf_missile_card *card,
                          sf_error *err);

/* The impact point (m) of a complete model, by the same rule; on its symmetry planes. */
void sf_impact_point(const sf_model *model, double point[3]);

/* Volume, centroid and inertia of the solid inside a closed surface of triangles, for unit density. */

typedef struct sf_solid {
    double volume;      /* m3 */
    double centroid[3]; /* m */
    double inertia[6];  /* m5, the tensor about the centroid: xx = integral of y^2 + z^2, xy = -integral of x
                           y;  stored (xx, yy, zz, xy, yz, xz) like base/mat3.h */
} sf_solid;

/* Exact for the polyhedron that the triangles bound. `position` [node_count][3] m, `triangle`
 * [triangle_count][3] turned outwards. SF_ERR_MODEL unless each edge belongs to exactly two triangles that
 * run through it in opposite directions (open, branching or wrongly turned surfaces; nodes that coincide are
 * not joined), and the volume is positive. The surface may have several parts and hollows; it is not checked
 * for intersections. */
sf_status sf_solid_measure(int64_t node_count, const double *position, int64_t triangle_count,
                           const int32_t *triangle, sf_solid *solid, sf_error *err);

/* Centre of mass and inertia of a missile with six degrees of freedom. */

/* Sets the card's freedom, centre, inertia and angular velocity by the case; what it does not give comes from
 * the solid: the missile's cells, or its closed surface, with uniform density; where its surface is a sphere,
 * with what lies between the triangles and the sphere. The card has mass and shape; the surface is not placed
 * yet, the centre lies by it. SF_ERR_INPUT: there is no solid, or no body can have this inertia. */
sf_status sf_missile_take_body(const sf_case *c, const sf_surface *surface, sf_missile_card *card,
                               sf_error *err);

/* The expected error of a_max from the spacing under the missile, by which the mesh is judged. */

/* The law: C (h/t)^2 + D (h/w)^2 with the thickness t and the half width w of the contact zone; C and D are
 * calibrated in docs/theory.md, section 11. */
#define SF_MESH_ERROR_THICKNESS 0.5
#define SF_MESH_ERROR_WIDTH 0.35

/* The part of the pad that the missile touches when it stands half a thickness deep in it. */
typedef struct sf_contact_zone {
    double area;       /* m2, of the whole pad's surface */
    double half_width; /* m, across its narrow direction: the radius of a round zone; of a part that leads,
                          its own as it grows to that depth */
    double spacing;    /* m, root mean square of the pad below it */
} sf_contact_zone;

/* The model has its cloud, its sets and its missile. */
void sf_contact_zone_measure(const sf_model *model, sf_contact_zone *zone);

/* Expected relative error of a_max, or 0 with a prescribed motion, which has no a_max. */
double sf_mesh_error_expect(const sf_model *model, const sf_contact_zone *zone);

/* Checks whether a model makes sense as a drop: those checks that need the case and the group names of the
 * geometry, which sf_model_check does not have. */

/* SF_ERR_INPUT, naming the key, the value and the bound: the pad's thickness is not one of a pad; the
 * missile starts inside the pad; it is not symmetric to a symmetry plane, or cut open where there is none.
 * The model has its nodes, its sets and its missile; the mesh still has its sets. */
sf_status sf_drop_check(const sf_case *c, const sf_mesh *mesh, const sf_model *m, sf_error *err);
/* The same, of all that the missile may touch: the mesh is too coarse for pad.mesh_error_limit; its share in
 * the model is lighter than a node; it turns into the pad before it arrives. */
sf_status sf_drop_check_contact(const sf_case *c, const sf_model *m, const sf_contact_zone *zone,
                                sf_error *err);

/* Warns of a symmetry group of the geometry that the case does not hold, of a material where the solver is
 * known to be weak (sf_law.caution), and of a coarse mesh. */
void sf_drop_warn(const sf_case *c, const sf_mesh *mesh, const sf_model *m, const sf_contact_zone *zone,
                  const sf_sink *sink);

/* The thickness of the pad where the missile hits it: the length of foam on the missile's path. */

/* Sets model->thickness, which is the extent along z until then. A ray from each face that the missile may
 * touch goes along its direction through the foam, also through holes and layers, to the first face that is
 * held or rests, or to the end of the foam. The thickness is the vertical part of the shortest of these
 * lengths over the contact zone, the faces that the missile reaches on its first half of the length under the
 * first touch. model->air is the vertical part of the air on that way, between parts of foam and below them
 * to the anvil, which the foam must cross before it is pressed altogether. `between` fails if a part of the
 * missile passes between the contact nodes. Needs cells, constraints and the placed missile. */
sf_status sf_foam_path_measure(sf_model *model, sf_error *between, sf_error *err);

/* The surface of the pad, and the part of it that may touch the pad itself or the anvil. */

/* Sets the model's skin by pad.self_contact: "off" none; "on" the surface but for faces that are tied to
 * another layer or held along their normal; "auto" the same if the foam can touch itself or the anvil, that
 * is, if a ray from a face outwards meets another face of it, its mirror image, or the anvil, within the
 * pad's thickness, or layers are loose. With a rigid support it is there in any case, `skin_alone` if it
 * touches that only. `unheld` (m): the middle of such a face of a pad without skin; NaN: there is none. Needs
 * cells, constraints, ties, thickness and the anvil's depth. */
sf_status sf_skin_find(const sf_case *c, sf_model *model, double unheld[3], sf_error *err);

/* Adds the nodes of the other free faces that are neither held altogether nor part of the base to the contact
 * points, with their areas, and to those of pad.contact the area of such faces that look at the missile;
 * where there are some, the zone and the expected mesh error count them. What places the missile and measures
 * the pad goes by the points of pad.contact and comes before. Needs cells, constraints, ties and masses. */
sf_status sf_contact_add_free(const sf_layers *layers, sf_model *model, sf_contact_zone *zone, sf_error *err);

/* The supports: rigid fixed bodies of any shape that the pad may touch (theory, section "Contact of the pad
 * with itself"). */

/* The surface of a support that is a plane: two triangles, far wider than the pad. */
sf_status sf_support_plane(const sf_case_support *plane, const sf_mesh *mesh, sf_surface *out, sf_error *err);

/* Takes the surfaces of the mesh into the model: turned outwards (open parts of files against the missile's
 * direction), with the nodes of sharp edges once for each side. Needs the pad's cells. SF_ERR_INPUT: a part
 * lies inside the pad at the start, or no face of it has a support before it within the pad's thickness. */
sf_status sf_support_take(const sf_case *c, const sf_mesh *mesh, sf_model *model, sf_error *err);

/* Warns of sharp edges of supports with fewer nodes than the pad beside them: between them is no contact. */
void sf_support_warn(const sf_model *model, const sf_sink *sink, sf_error *err);

/* Sets the missile's way to the supports; the missile is in its place. SF_ERR_INPUT: it meets one
 * before the pad. */
sf_status sf_support_find_travel(sf_model *model, sf_error *err);

/* Distance (m) from x along the unit vector `direction` to the supports; infinity: none is there. */
double sf_support_distance(const sf_model *model, const double x[3], const double direction[3]);
