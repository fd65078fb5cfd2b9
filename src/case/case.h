/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The case file: libconfig syntax, every dimensional value a string with its unit ("4.6 kg"), read with
 * base/units.h. docs/case.md lists groups and keys.
 */
#pragma once
#include "model/drop_kind.h"
#include "model/model.h"

enum {
    SF_CASE_NAME_SIZE = 128,
    SF_CASE_MAX_GROUPS = 16,
    SF_CASE_MAX_PARAMETERS = 64,
    SF_CASE_MAX_TIMES = 256,
    SF_CASE_MAX_LAYERS = 32,
    SF_CASE_MAX_INTERFACES = 64,
    SF_GEOMETRIES = 2 + SF_SUPPORTS /* of pad, missile and supports */
};

/* A variable of a .geo file set by the case; plain numbers, in the geometry's own length unit. */
typedef struct sf_geo_parameter {
    char name[SF_CASE_NAME_SIZE];
    double value;
} sf_geo_parameter;

/* A geometry file and what to set in it. `path` is resolved against the case file's folder; owned by the
 * case. */
typedef struct sf_geo_source {
    char *path; /* NULL: the missile is in the pad's file */
    int parameter_count;
    sf_geo_parameter parameter[SF_CASE_MAX_PARAMETERS];
    double spacing_factor; /* -, for the parameters with "spacing" in their names; 0: none */
    double unit;           /* m per unit that it has or is to have; 0: not known */
} sf_geo_source;

/* A rigid fixed body that the pad may touch: a surface of a geometry, or a plane. */
typedef struct sf_case_support {
    sf_geo_source source;          /* path NULL: a plane */
    char group[SF_CASE_NAME_SIZE]; /* physical surface group of the geometry */
    double normal[3];              /* -, unit, of a plane, into the free half-space, in the geometry's axes */
    double place;                  /* m, of a plane along its normal from the origin */
    double friction;               /* -, Coulomb coefficient of the pad against it */
} sf_case_support;

/* The kinds of interface between layers, in the order of their words: all components of the displacement are
 * tied, that along the normal, or none. */
enum { SF_INTERFACE_TIED, SF_INTERFACE_SLIDING, SF_INTERFACE_LOOSE };

/* Says how two layers meet. */
typedef struct sf_case_interface {
    const char *key; /* of the case that says so; static */
    int layer[2];    /* their places in `layer`, different */
    int kind;        /* SF_INTERFACE_* */
    double friction; /* -, Coulomb coefficient of loose layers; else 0 */
} sf_case_interface;

enum { SF_BASE_GLUED, SF_BASE_SMOOTH, SF_BASE_RESTING }; /* pad.base, in the order of its words */
enum { SF_SELF_CONTACT_AUTO, SF_SELF_CONTACT_ON, SF_SELF_CONTACT_OFF }; /* pad.self_contact, likewise */

/* A drop of a series. */
typedef struct sf_case_drop {
    double interval; /* s, from the drop before */
    bool own;        /* its missile is not that of the first drop, or falls another way */
} sf_case_drop;

typedef struct sf_case {
    char *path;       /* as given */
    char *text;       /* the case file with its includes in place, --set lines appended as comments; owned */
    char *parameters; /* one line per key that exists: name, value, SI value, given|default; owned */
    uint64_t values;  /* hash of the values of all keys that can change a drop, but those that name files */
    sf_geo_source pad;
    sf_geo_source missile;
    int axisymmetric;   /* 1: the model is a plane section (pre/mesh/section.h) */
    double length_unit; /* m per unit of the geometry */
    double up[3];       /* -, unit vector out of the pad's face, in the geometry; the model has it along z */
    double mesh_time_limit; /* s of processor time for gmsh, per geometry */
    const char *store; /* folder in which meshes and domains are kept for other drops (io/folder.h), when it
                          is read that of SOFTFALL_SHARE; NULL: they are not; borrowed */
    char *geometry_files; /* what the geometries read (sf_gmsh.files), set when they are meshed; owned */
    char pad_group[SF_CASE_NAME_SIZE]; /* physical volume group of the pad; of layers, for sentences: all */
    char contact_group[SF_CASE_NAME_SIZE]; /* physical surface group that the missile may touch */
    int base_rule;                         /* SF_BASE_*: how the fixed groups stand on the anvil */
    sf_anvil_card anvil_card;              /* depth is left zero: it comes from the geometry */
    double pad_gravity;                    /* m s-2, along -z, on a resting pad */
    int fixed_count;                       /* physical surface groups of the base */
    char fixed_group[SF_CASE_MAX_GROUPS][SF_CASE_NAME_SIZE];
    int sliding_count; /* plane physical surface groups held along their normal */
    char sliding_group[SF_CASE_MAX_GROUPS][SF_CASE_NAME_SIZE];
    int symmetry_count; /* physical surface groups that are symmetry planes; planes absent from the geometry
                           are allowed only if the key was not given */
    bool symmetry_given;
    char symmetry_group[SF_CASE_MAX_GROUPS][SF_CASE_NAME_SIZE];
    char surface_group[SF_CASE_NAME_SIZE]; /* physical surface group of the missile that touches */
    bool temperature_acts;                 /* a material depends on the pad's temperature */
    double stress_factor;                  /* -, on the stresses of the curves; 0: of a material alone, 1 */
    bool has_curves;                       /* a material has compression curves */
    int self_contact;                      /* SF_SELF_CONTACT_* */
    int64_t separate;                      /* 1: the pad may be of several bodies */
    int64_t triangle_centroids;            /* 1: points of contact at them, too (solver/contact/skin.h) */
    bool stabilised;                       /* kernel.stabilisation is given */
    double self_friction;                  /* -, Coulomb coefficient of the pad against itself */
    double mesh_error_limit;               /* -, expected error of a_max above which the case is refused */
    int kinematic;          /* 0: figures as an accelerometer reads, 1: of the kinematic acceleration */
    int shape_rule;         /* 0 "auto": sphere if the surface is one, 1 "sphere", 2 "surface" */
    double support_ratio;   /* R/h */
    double condition_limit; /* of the moment matrix */
    sf_material material;   /* owned by the case until moved into a model; none in a case of layers */
    sf_response_error response_error; /* of the material's file; none in a case of layers */
    int layer_count;                  /* groups of `materials`; 0: one material */
    sf_material *layer;     /* [layer_count] with the names of their volume groups; owned likewise */
    int sliding_pair_count; /* pad.sliding_interfaces and pad.loose_interfaces, "NAME/NAME" each */
    char sliding_pair[SF_CASE_MAX_GROUPS][SF_CASE_NAME_SIZE];
    int loose_pair_count;
    char loose_pair[SF_CASE_MAX_GROUPS][SF_CASE_NAME_SIZE];
    int interface_count; /* of these and of `interfaces`, each pair once; pairs that are absent are tied */
    sf_case_interface interface[SF_CASE_MAX_INTERFACES];
    bool position_given;
    double missile_position[2];   /* m, x and y of the impact point, if given */
    int freedom;                  /* SF_MISSILE_GUIDED or SF_MISSILE_FREE */
    int inertia_count;            /* 0: from the geometry, else 3 or 6 */
    double inertia[6];            /* kg m2, as in sf_missile_card */
    int centre_count;             /* 0: from the geometry, else 3 */
    double centre[3];             /* m, in the missile's geometry as it is */
    int angular_velocity_count;   /* 0 or 3 */
    double angular_velocity[3];   /* rad s-1 */
    sf_missile_card missile_card; /* sphere_* and what a free missile needs are left zero */
    int64_t motion_count;         /* points of the missile's prescribed motion; 0 = it is free */
    double *motion_time;          /* [motion_count] s; owned until moved into a model, like the next */
    double *motion_displacement;  /* [motion_count] m, along the direction */
    sf_run_options run;
    int frame_time_count;                 /* further frames, beside run.frame_interval */
    double frame_time[SF_CASE_MAX_TIMES]; /* s, ascending */
    char about[3]
              [SF_CASE_NAME_SIZE]; /* sample, laboratory, conditions: words for the report; "": not given */

    int support_count;
    bool support_alone; /* the only one is the group `support`, not one of the list `supports` */
    sf_case_support support[SF_SUPPORTS];
    int membrane_count; /* surface groups with a cover without cells */
    char membrane_group[SF_CASE_MAX_GROUPS][SF_CASE_NAME_SIZE];
    sf_membrane_card membrane_card;
    double drops;                      /* -, of a series on one pad, a whole number; 1: a single drop */
    double interval;                   /* s, from one of them to the next; 0: not given */
    sf_case_drop drop[SF_SERIES_MOST]; /* of a series; interval of each from the second on */
    int64_t counted;                   /* drops by which a series is judged: bit k for drop k + 1; 0: none */
} sf_case;

/* Releases what a case owns. */
void sf_case_free(sf_case *c);

/* The interface of two layers, in either order; NULL: the case does not name it, and it is tied. */
const sf_case_interface *sf_case_interface_find(const sf_case *c, int layer, int other);

/* True if a list of groups has the name. */
bool sf_case_has_name(int count, const char (*list)[SF_CASE_NAME_SIZE], const char *name);

/* Geometry k of SF_GEOMETRIES: the pad's, the missile's, each support's; without a path there is none. */
const sf_geo_source *sf_case_geometry(const sf_case *c, int k);

/* Returns a hash of the values of every key and of the points of curves and motion, without those of the
 * geometry files. */
uint64_t sf_case_hash(const sf_case *c);

/* SF_ERR_INPUT: a series of drops on a foam that remembers nothing, whose later drops are no property of it:
 * a study would take them for one. */
sf_status sf_case_check_memory(const sf_case *c, sf_error *err);
