/* SPDX-License-Identifier: GPL-3.0-or-later */
#pragma once
#include "material/foam_card.h"
#include "model/columns.h"
#include "io/provenance.h"

/* sf_model: everything about a drop that does not change while it is solved. softfall-pre builds it, model.h5
 * stores it, softfall-solve reads it and never writes to it.
 *
 * Units are SI throughout. Frame: the geometry's Cartesian axes, the pad's top surface facing +z. Reference
 * configuration = the mesh as read. Arrays are row-major with the shape given in brackets, from sf_alloc,
 * owned by the model. Lists are CSR: the entries of row i are [ptr[i], ptr[i+1]). Nodes are the particles of
 * the cloud. */

enum {
    SF_FIX_X = 1, /* bits of fix_mask: which components of u_h are held at zero */
    SF_FIX_Y = 2,
    SF_FIX_Z = 4,
};

/* Cell types: values are XDMF's topology codes, so that they can be written as they are. */
enum {
    SF_CELL_TRIANGLE = 4, /* of the plane section of an axisymmetric pad, as the next one */
    SF_CELL_QUADRANGLE = 5,
    SF_CELL_TETRAHEDRON = 6,
    SF_CELL_PYRAMID = 7,
    SF_CELL_PRISM = 8,
    SF_CELL_HEXAHEDRON = 9
};

enum {
    SF_SHAPE_SPHERE = 0,
    SF_SHAPE_SURFACE = 1
}; /* contact with an exact sphere cap, or with the triangles */

/* Degrees of freedom of a missile that is not driven: along its direction, or six. */
enum { SF_MISSILE_GUIDED = 0, SF_MISSILE_FREE = 1 };

enum { SF_MATERIAL_MAX = 256 };
/* Frames at equal intervals in one run. */
enum { SF_MOST_FRAMES = 100000 };
#define SF_SMALLEST_STEP 1e-9 /* of the end time: a run whose stable step falls below it stops */

typedef struct sf_missile_card {
    double mass;             /* kg, of the whole missile, whatever the symmetry; 0 with a prescribed motion */
    double speed;            /* m s-1, at first contact; 0 with a prescribed motion */
    double direction[3];     /* -, unit vector of motion at first contact; of a guided missile for good */
    double friction;         /* -, Coulomb coefficient against the pad */
    double gravity;          /* m s-2, acts on the missile; 0 with a prescribed motion */
    double down[3];          /* -, its direction, a unit vector; all 0, as in older models: -z */
    double gap;              /* m, distance still to travel along `direction` at t = 0; sf_flight_time */
    double clearance;        /* m, height of its lowest point above the top of the undeformed pad, its highest
                                point, at t = 0; negative over a hole */
    int64_t impact_known;    /* 1: the next line holds; models of older versions do not say */
    double impact[2];        /* m, x and y of the impact point (pre/missile_body.h) */
    int64_t shape;           /* SF_SHAPE_* */
    double sphere_centre[3]; /* m, at t = 0 (SF_SHAPE_SPHERE) */
    double sphere_radius;    /* m */
    double sphere_cap_cosine; /* -, smallest cosine between `direction` and a point of the cap, seen from the
                                 centre */
    int64_t freedom;          /* SF_MISSILE_GUIDED or SF_MISSILE_FREE; 0 in all that follows if guided */
    double centre[3];         /* m, centre of mass at t = 0 */
    double inertia[6]; /* kg m2, about it, of the whole missile; (xx, yy, zz, xy, yz, xz) of the tensor,
                          base/mat3.h, in the geometry's axes at t = 0 */
    double angular_velocity[3]; /* rad s-1, at first contact */
} sf_missile_card;

typedef struct sf_anvil_card {
    double
        depth; /* m, of the anvil's plane below the top of the undeformed pad, its highest point; 0: none */
    double friction; /* -, Coulomb coefficient against a resting pad */
} sf_anvil_card;

/* Most rigid supports of a pad; each has a column of the history. */
enum { SF_SUPPORTS = 4 };
enum { SF_SERIES_MOST = 20 /* drops of a series */ };

/* Deepest place, of the spacing, from which a node begins to touch a face from outside. */
#define SF_CONTACT_ENTRY 0.01

/* Least stabilisation of foam that folds: with less it does so from node to node. */
#define SF_FOLD_STABILISATION 0.3

/* A thin elastic cover without cells. */
typedef struct sf_membrane_card {
    double modulus;   /* Pa, Young's */
    double poisson;   /* - */
    double thickness; /* m */
    double density;   /* kg m-3 */
    int64_t fabric;   /* 1: it carries no compression */
} sf_membrane_card;

typedef struct sf_run_options {
    double end_time;            /* s */
    double step_safety;         /* -, fraction of the stability limit */
    double step_limit;          /* s, largest time step: keeps the history at 20 kHz or more */
    double stabilisation;       /* -, coefficient of the stabilisation stiffness */
    double energy_limit;        /* -, |E/E0 - 1| at which the run stops */
    double frame_interval;      /* s, between frames; frames also at 0 and at the end */
    int64_t output_fields;      /* SF_FIELD_* bits */
    int64_t stop_after_rebound; /* 1: end when the missile has left the pad upwards */
    int64_t kinematic;          /* 0: figures as an accelerometer reads, 1: of the kinematic acceleration */
    double speed_scatter;       /* -, standard deviation of the missile's speed over it, for figures only */
    double thickness_tolerance; /* m, standard deviation of the pad's thickness, for figures only */
    double temperature;         /* K, of the pad, to which its materials are taken; 0: not given */
} sf_run_options;

/* X(member, unit, meaning): the axisymmetric drop of a plate that a body of revolution hits straight
 * (accuracy/section_drop.h). */
/* clang-format off */
#define SF_SECTION_DROP(X) \
    X(a_max_g, "9.80665 m s-2", "a_max of the drop's section for ever finer meshes, CFC 1000; 0: it was not simulated") \
    X(hic, "1", "HIC of it") \
    X(indentation, "m", "largest indentation of it") \
    X(a_max_error, "1", "uncertainty of that a_max, over it") \
    X(hic_error, "1", "of that HIC") \
    X(indentation_error, "1", "of that indentation") \
    X(a_max_by_speed, "1", "relative change of a_max in a drop 1 % faster; 0: it is not known") \
    X(hic_by_speed, "1", "of HIC") \
    X(a_max_by_thickness, "1", "relative change of a_max on a pad 1 mm thinner; 0: it is not known") \
    X(hic_by_thickness, "1", "of HIC")
/* clang-format on */
#define SF_SECTION_DROP_THINNER 1e-3 /* m, of the pad for `..._by_thickness` */
#define SF_SECTION_DROP_MEMBER(member, ...) double member;
typedef struct sf_section_drop {
    SF_SECTION_DROP(SF_SECTION_DROP_MEMBER)
} sf_section_drop;
#undef SF_SECTION_DROP_MEMBER

typedef struct sf_model {
    /* Cloud: nodes of the background mesh, those of a material together, in a locality-preserving order. */
    int64_t node_count;
    double *position;       /* [node_count][3] m, X */
    double *volume;         /* [node_count] m3, V of the smoothing domain */
    double *mass;           /* [node_count] kg, rho V, smoothed near light nodes (theory eq. 9) */
    double *spacing;        /* [node_count] m, h */
    double *support;        /* [node_count] m, R */
    uint8_t *node_material; /* [node_count] index in `material`, ascending */

    /* Smoothed gradient: B_J^I for the nodes J that the domain of node I sees (theory eq. 4). Rows hold node
     * I itself, and are sorted by node. */
    int64_t domain_nnz;
    int64_t *domain_ptr;  /* [node_count + 1] */
    int32_t *domain_node; /* [domain_nnz] J */
    double *domain_b;     /* [domain_nnz][3] m-1 */

    /* Shape functions at the nodes: phi_J(X_I), rows sorted by node. */
    int64_t phi_nnz;
    int64_t *phi_ptr;  /* [node_count + 1] */
    int32_t *phi_node; /* [phi_nnz] */
    double *phi_value; /* [phi_nnz] - */

    /* Edges of the background mesh as a symmetric adjacency, rows sorted by node: stabilisation pairs. */
    int64_t edge_nnz;
    int64_t *edge_ptr;  /* [node_count + 1] */
    int32_t *edge_node; /* [edge_nnz] */
    int64_t edge_pairs; /* of the lists that the solver made of them, when the edges have been dropped */

    /* Background mesh, for pictures and integrals over the pad. */
    int64_t cell_count;
    int64_t cell_nnz;
    uint8_t *cell_type; /* [cell_count] SF_CELL_* */
    int64_t *cell_ptr;  /* [cell_count + 1] */
    int32_t *cell_node; /* [cell_nnz] gmsh/VTK vertex order */

    /* Essential boundary conditions and contact candidates. */
    int64_t fixed_count;
    int32_t *fixed_node; /* [fixed_count] ascending */
    uint8_t *fixed_mask; /* [fixed_count] SF_FIX_* bits */
    uint8_t *fixed_base; /* [fixed_count] 1 = carries the base reaction, 0 = symmetry plane only */
    int64_t contact_count;
    int32_t *contact_node; /* [contact_count] ascending */
    double *contact_area;  /* [contact_count] m2, of the undeformed surface that belongs to the node */
    /* The open faces between these nodes, which the vertices and edges of the missile may press; none if the
     * missile is an exact sphere. Of the copies of a node in tied layers it has the one in contact_node. */
    int64_t contact_face_count;
    int32_t *contact_face; /* [contact_face_count][3] nodes, turned outwards; of a section's side two,
                              counter-clockwise, and the first one again */

    /* Ties between the layers of the pad: two nodes at one place, of two clouds, with the same components of
     * u_h. No tie follows from the others and from what is held. */
    int64_t tie_count;
    int32_t *tie_node;  /* [tie_count] ascending */
    int32_t *tie_other; /* [tie_count] the node tied to it, of a later layer */
    uint8_t *tie_mask;  /* [tie_count] SF_FIX_* bits: the components that are tied */

    /* The underside of a resting pad, which the anvil can only press; none of a pad that is held. At t = 0
     * the pad has settled: rest_load carries its weight. */
    int64_t rest_count;
    int32_t *rest_node; /* [rest_count] ascending, on one plane z = constant */
    double *rest_load;  /* [rest_count] N, of the anvil on the pad at t = 0; their sum is the pad's weight */

    /* The faces of the pad that may touch the pad itself or the anvil, turned outwards; or none. */
    int64_t skin_count;
    int32_t *skin_triangle; /* [skin_count][3] nodes */
    uint8_t *skin_half;     /* [skin_count] 1, 2: halves of a quadrangle, one after the other, with its nodes
                               0, 1, 2 and 0, 2, 3; 0: a triangle */
    double skin_friction;   /* -, Coulomb coefficient between them */
    int64_t pair_count;     /* pairs of materials between whose faces the friction is another */
    uint8_t *pair_layer;    /* [pair_count][2] numbers of the materials, ascending */
    double *pair_friction;  /* [pair_count] - */
    int64_t skin_alone;     /* 1: they touch the supports only */
    int64_t skin_centroids; /* 1: those of its triangles that are no halves are points of contact, too */
    int64_t skin_watched;   /* 1: they pass through each other, which ends the run */

    /* Rigid fixed bodies that the skin may touch; triangles turned outwards, of one support after the other.
     * Nodes at sharp edges are there once for each side. */
    int64_t support_count;    /* 0 to SF_SUPPORTS */
    double *support_friction; /* [support_count] -, Coulomb coefficient of the pad against each */
    int64_t support_node_count;
    int64_t support_triangle_count; /* 0: there are none */
    double *support_position;       /* [support_node_count][3] m */
    int32_t *support_triangle;      /* [support_triangle_count][3] */
    uint8_t *support_part;          /* [support_triangle_count] the support that each belongs to */
    double support_travel; /* m, of the missile along its direction until it touches them; 0: it never does */

    /* The membrane on faces of the pad; its mass is among those of the nodes. A quadrangle is there by both
     * of its diagonals. */
    int64_t membrane_count;
    int32_t *membrane_triangle; /* [membrane_count][3] nodes */
    double *membrane_share; /* [membrane_count] -, of the thickness: 1, or 0.5 where two triangles overlap */
    sf_membrane_card membrane;

    /* The missile's surface in the pose of first contact, `gap` away along its direction; triangles turned
     * outwards. */
    int64_t surface_node_count;
    int64_t surface_triangle_count;
    double *surface_position;  /* [surface_node_count][3] m */
    int32_t *surface_triangle; /* [surface_triangle_count][3] */

    /* Prescribed motion of the missile along its direction, piecewise linear (model/motion.h): both columns
     * begin with 0, the times ascend to run.end_time or beyond. */
    int64_t motion_count;        /* 0 = the missile is free; else 2 or more */
    double *motion_time;         /* [motion_count] s */
    double *motion_displacement; /* [motion_count] m */

    /* Times of further frames, beside run.frame_interval. */
    int64_t frame_time_count;
    double *frame_time; /* [frame_time_count] s, ascending */

    /* A series of drops on this pad, of which this model is that of the first. */
    int64_t series_count;    /* drops; 0: a single one */
    double *series_interval; /* [series_count] s, from the drop before to each; 0 of the first */
    int64_t *series_model;   /* [series_count] hash of a model of its own, 0: it is this one */

    /* 1: the pad is the plane section of a body of revolution: nodes lie in y = 0, x is the radius; domains
     * are rings, and domain_b is (b_R, b_theta, b_Z), F_theta theta = 1 + sum b_theta u_R; 0: it is solid. */
    int64_t axisymmetric;
    int64_t symmetry_factor; /* 1, 2 or 4: how many times the modelled part makes the whole */
    double thickness; /* m, of the foam under the contact, along the missile's path, its vertical part */
    double air;       /* m, on the same way: gaps of a pad with a skin, which close first */
    double expected_mesh_error; /* fraction of a_max, see pre/drop_check.h; 0 = not estimated */
    double slit_fraction;       /* of the nodes: those at a slit, hole or gap narrower than their supports */
    sf_section_drop section;
    int64_t material_count; /* 1 to SF_MATERIAL_MAX; of several, each is a layer with its own cloud */
    sf_material *material;  /* [material_count] owned */
    sf_missile_card missile;
    sf_anvil_card anvil;
    sf_run_options run;

    /* The permanent set of earlier drops (solver/set.h), not in model.h5; NULL: none. `position`, `volume`
     * and `domain_b` are then those of the pad with it. */
    double *set; /* [node_count][3] m, coefficients of its field; then [node_count] -, parts that rests have
                    taken back; then [node_count][3] m, coefficients of the field of places; then m, z of the
                    anvil's plane below the undeformed pad; owned */
} sf_model;

/* Part of a drop's largest displacement that is left as permanent set; 0: none. */
static inline double sf_model_set(const sf_model *model) {
    return model->material_count > 0 ? sf_foam_memory(model->material)->set : 0;
}
/* z of the anvil's plane (m), with the highest place of the pad's nodes. */
static inline double sf_model_anvil_plane(const sf_model *model, double top) {
    return model->set ? model->set[7 * model->node_count] : top - model->anvil.depth;
}
/* Coefficients of the field of places [node_count][3], m. */
static inline const double *sf_model_coefficients(const sf_model *model) {
    return model->set ? model->set + 4 * model->node_count : model->position;
}

/* The results file, or the model of its own, of a drop of a series, from 1: that of the first is `first`, the
 * second of "a.h5" is "a-2.h5". */
void sf_model_series_file(const char *first, int64_t drop, char *path, size_t size);

/* Modelled parts that make the whole pad and missile: what a force, an energy, a mass or an area of the
 * modelled part is multiplied by for that of the whole, and divided by for the way back. A power of two:
 * exact. */
double sf_model_whole(const sf_model *model);

/* The points that can touch: those of the contact group, which the missile may press, and after them those of
 * a resting pad's underside on the anvil. A node may be in both lists. */
static inline int64_t sf_model_points(const sf_model *model) {
    return model->contact_count + model->rest_count;
}
static inline bool sf_model_point_rests(const sf_model *model, int64_t point) {
    return point >= model->contact_count;
}
static inline int64_t sf_model_point_node(const sf_model *model, int64_t point) {
    return point < model->contact_count ? model->contact_node[point]
                                        : model->rest_node[point - model->contact_count];
}

/* True if the missile has a prescribed motion; otherwise the drop decides. */
bool sf_missile_is_driven(const sf_model *model);
/* True if the missile has six degrees of freedom. */
bool sf_missile_turns(const sf_model *model);
/* Can a body have this tensor of inertia: are its principal moments positive, and none larger than the sum of
 * the other two? `principal` [3] (kg m2), ascending. */
bool sf_missile_inertia_is_possible(const double inertia[6], double principal[3]);
/* The indentation, in this one place: depth (m) of the missile's lowest point below the plane of the
 * undeformed pad's top, from which the thickness is measured, after the missile's displacement (m) along its
 * direction; negative above the plane. */
double sf_missile_card_depth(const sf_missile_card *card, double displacement);

/* The material of a node; borrowed. */
static inline const sf_material *sf_model_material(const sf_model *model, int64_t node) {
    return &model->material[model->node_material[node]];
}

/* Least, over the materials, of the strain up to which their data inform (sf_material_informed); INFINITY:
 * they do not say. */
double sf_model_informed_strain(const sf_model *model);
/* Strain at which the pad's only foam locks up, the pole of its stress below 1, and from which this pole
 * bends its stress; NaN: there is none. */
double sf_model_lock_up(const sf_model *model, double *begin);
/* Mean density of the undeformed pad, kg m-3. */
double sf_model_density(const sf_model *model);

/* Moves `count` materials into the list. node_material is allocated and, if there is one material only, stays
 * zero; node_count is known. */
sf_status sf_model_take_materials(sf_model *model, sf_material *material, int count, sf_error *err);

/* A copy with arrays and materials of its own; of a model without a permanent set. */
sf_status sf_model_copy(const sf_model *from, sf_model *out, sf_error *err);

/* Releases every array and zeroes the model. Safe on a zeroed model. */
void sf_model_free(sf_model *model);

/* Releases the background mesh: the solver no longer needs it once it is in the results. */
void sf_model_drop_mesh(sf_model *model);

/* Releases domain_node and support: the solver's groups have local numbers for the nodes of their domains. */
void sf_model_drop_domain_nodes(sf_model *model);

/* Releases the edges, once the solver has made its pairs. */
void sf_model_drop_edges(sf_model *model);

/* One array or scalar of the model, but for its materials. The table drives reading, writing, checking and
 * release. */
typedef struct sf_model_field {
    size_t offset;      /* of the member in sf_model: a pointer (arrays) or the value itself (scalars) */
    sf_h5_type type;    /* of one item; scalars are F64 or I64 */
    size_t rows_offset; /* of the int64_t member that counts the rows; SIZE_MAX for a scalar */
    int rows_extra;     /* 1 for CSR pointers */
    int columns;        /* 1 or more */
    const char *path;   /* in model.h5 */
    const char *units;
    const char *description;
    bool later; /* models of release 1.0.0 lack it: left out of the hash where it is 0 */
} sf_model_field;

/* The table, and its length. Counts come before the arrays that need them. */
const sf_model_field *sf_model_fields(size_t *count);

/* The symmetry planes of a model. */

/* True if a plane normal to the axis (0 x, 1 y) is a symmetry plane of the model, which has its sets;
 * *place (m) is then its position on that axis, else 0. */
bool sf_symmetry_plane(const sf_model *model, int axis, double *place);

/* True if triangles k - 1 and k of the skin are halves of one quadrangle; a half whose other one cannot touch
 * is a triangle. k > 0. */
bool sf_model_skin_is_quadrangle(const sf_model *model, int64_t k);

/* Coulomb coefficient between the faces of two materials of the pad, by their numbers. */
double sf_model_friction(const sf_model *model, int one, int other);

/* The skin's triangles that are no halves; those of them whose centroids may touch the pad, none without
 * skin_centroids or where the skin touches the supports only. */
int64_t sf_model_skin_triangles(const sf_model *model);
int64_t sf_model_skin_centroids(const sf_model *model);
