/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "case/keys.h"

#include "model/motion.h"
#include <assert.h>

#define AT(member) .offset = offsetof(sf_case, member)
#define OF_SUPPORT(member) .list = SF_LIST_SUPPORTS, .offset = offsetof(sf_case_support, member)
#define OF_INTERFACE(member) .list = SF_LIST_INTERFACES, .offset = offsetof(sf_interface_entry, member)
#define POSITIVE .low = 0.0, .low_open = true
/* Frame fields as words and as the default, "[\"displacement\", ...]". */
#define WORD(constant, name, ...) #name
#define QUOTED(constant, name, ...) "\"" #name "\""
#define FIELD_WORDS SF_FRAME_FIELD_LIST(WORD, "|")
#define ALL_FIELDS "[" SF_FRAME_FIELD_LIST(QUOTED, ", ") "]"

/* The bounds are those of sf_model_check, so that the sentence about a value names its place in the case. */
/* clang-format off */
static const sf_key keys[] = {
    /* geometry */
    {"geometry", "file", SF_KEY_PATH, NULL, AT(pad.path),
     "geometry of the pad: .geo, .msh with cells, or what gmsh can open and mesh; relative to the file that names it"},
    {"geometry", "model", SF_KEY_CHOICE, "\"solid\"", AT(axisymmetric),
     "\"axisymmetric\": the plane section of a plate that a body of revolution hits straight (docs/case.md); `file` draws the section or the quarter of the plate",
     .words = "solid|axisymmetric"},
    {"geometry", "missile_file", SF_KEY_PATH, "", AT(missile.path),
     "geometry of the missile; absent: it is in `file`"},
    {"geometry", "length_unit", SF_KEY_UNIT, NULL, AT(length_unit),
     "unit of length of the geometries, for example \"mm\""},
    {"geometry", "missile_length_unit", SF_KEY_UNIT, "", AT(missile.unit),
     "that of `missile_file`, where it is another one"},
    {"geometry", "parameters", SF_KEY_PARAMETERS, "", AT(pad),
     "values for the DefineConstant parameters of `file`, in its own units"},
    {"geometry", "spacing_factor", SF_KEY_NUMBER, "1", AT(pad.spacing_factor),
     "multiplies all DefineConstant parameters of `file` with \"spacing\" in their names: 2 for a mesh twice as coarse", .low = 0.1, .high = 10},
    {"geometry", "missile_parameters", SF_KEY_PARAMETERS, "", AT(missile),
     "the same for `missile_file`"},
    {"geometry", "time_limit", SF_KEY_QUANTITY, "\"600 s\"", AT(mesh_time_limit),
     "processor time that gmsh may take for each geometry", .quantity = SF_TIME, .low = 1.0, .high = 1e7, .idle = true},
    /* pad */
    {"pad", "group", SF_KEY_NAME, "\"pad\"", AT(pad_group), "physical volume of a pad of one material"},
    {"pad", "contact", SF_KEY_NAME, "\"top\"", AT(contact_group), "physical surface that the missile meets first, which places it and measures the pad; it may touch every free face"},
    {"pad", "up", SF_KEY_VECTOR, "[0.0, 0.0, 1.0]", AT(up),
     "out of the pad's face, in the geometry's axes: of a pad that stands upright or hangs; the model turns it along z (docs/missiles.md)"},
    {"pad", "fixed", SF_KEY_NAMES, "[\"base\"]", AT(fixed_group),
     "physical surfaces of the base, glued to the anvil or as `base` says", .count_offset = offsetof(sf_case, fixed_count)},
    {"pad", "base", SF_KEY_CHOICE, "\"glued\"", AT(base_rule),
     "`glued` to the anvil; `smooth`: held along the normal; `resting`: the anvil only presses the surfaces of `fixed`, and the pad has weight",
     .words = "glued|smooth|resting"},
    {"pad", "friction", SF_KEY_NUMBER, "0.5", AT(anvil_card.friction),
     "Coulomb coefficient of a resting pad against the anvil; the default is an assumption for foam on a dry floor", .high = 10.0},
    {"pad", "gravity", SF_KEY_QUANTITY, "\"" SF_STANDARD_GRAVITY_TEXT "\"", AT(pad_gravity),
     "along -z, on a resting pad", .quantity = SF_ACCELERATION, .high = 1e4},
    {"pad", "sliding", SF_KEY_NAMES, "[]", AT(sliding_group),
     "plane physical surfaces that lie on a smooth anvil, normal to x, y or z: held along their normal only",
     .count_offset = offsetof(sf_case, sliding_count)},
    {"pad", "symmetry", SF_KEY_NAMES, "[\"symmetry_x\", \"symmetry_y\"]", AT(symmetry_group),
     "physical surfaces that are symmetry planes; those of the default may be absent from the geometry",
     .count_offset = offsetof(sf_case, symmetry_count)},
    {"pad", "sliding_interfaces", SF_KEY_NAMES, "[]", AT(sliding_pair),
     "pairs of layers that slide on each other, [\"NAME/NAME\"]; older than `interfaces`, which comes first",
     .count_offset = offsetof(sf_case, sliding_pair_count)},
    {"pad", "loose_interfaces", SF_KEY_NAMES, "[]", AT(loose_pair),
     "pairs of layers that only touch, [\"NAME/NAME\"], with `self_friction`; likewise",
     .count_offset = offsetof(sf_case, loose_pair_count)},
    {"pad", "separate", SF_KEY_BOOL, "false", AT(separate),
     "the pad may be of several bodies, which touch each other as its faces do; each is at rest until something touches it"},
    {"pad", "self_contact", SF_KEY_CHOICE, "\"auto\"", AT(self_contact),
     "contact of the pad's free faces with each other and with the anvil: `auto` where they lie before each other within the pad's thickness",
     .words = "auto|on|off"},
    {"pad", "self_friction", SF_KEY_NUMBER, "0.0", AT(self_friction),
     "Coulomb coefficient of that contact; on the anvil of a resting pad it is `friction`", .high = 10.0},
    {"pad", "triangle_centroids", SF_KEY_BOOL, "false", AT(triangle_centroids),
     "points of that contact also at the centroids of triangles, for faces of prisms or tetrahedra that do not match; several times the time"},
    {"pad", "mesh_error_limit", SF_KEY_NUMBER, "0.1", AT(mesh_error_limit),
     "expected relative error of a_max from the spacing above which the case is refused; a larger value allows a coarser mesh",
     .high = 1e6},
    {"pad", "thickness_tolerance", SF_KEY_QUANTITY, "\"1 mm\"", AT(run.thickness_tolerance),
     "standard deviation of the thickness from pad to pad: it makes `a_max_scatter` and `hic_scatter` of the report, and changes no drop",
     .quantity = SF_LENGTH, .high = 1.0},
    {"pad", "temperature", SF_KEY_QUANTITY, "", AT(run.temperature),
     "of the pad, for curves at several temperatures (`material.curves`) or a shift of the rates (`material.shift`)",
     .quantity = SF_TEMPERATURE, .low = 100.0, .high = 600.0},
    {"pad", "stress_factor", SF_KEY_NUMBER, "1.0", AT(stress_factor),
     "multiplies the stresses of the compression curves of the pad's materials: the same foam, stiffer or softer; moduli and viscosities stay",
     .low = 0.1, .high = 10.0},
    /* material: the law; its parameters follow (solver/material) */
    {"material", "law", SF_KEY_LAW, "", AT(material.law), "material law; its parameters follow"},
    /* missile */
    {"missile", "mass", SF_KEY_QUANTITY, "", AT(missile_card.mass),
     "of the whole missile, also in a quarter model; required without `motion`", .quantity = SF_MASS, .low = 1e-9, .high = 1e9},
    {"missile", "velocity", SF_KEY_QUANTITY, "", AT(missile_card.speed),
     "speed when it first touches the pad, whatever the gap; required without `motion`", .quantity = SF_SPEED, .low = 1e-9, .high = SF_MOTION_MAX_SPEED},
    {"missile", "speed_scatter", SF_KEY_NUMBER, "0.01", AT(run.speed_scatter),
     "standard deviation of the speed from drop to drop, over the speed: as `pad.thickness_tolerance`", .high = 0.5},
    {"missile", "motion", SF_KEY_MOTION, "", AT(motion_count),
     "displacement over time of a missile that a machine drives, a CSV file (see above), instead of `mass` and `velocity`; relative to the file that names it"},
    {"missile", "direction", SF_KEY_VECTOR, "[0.0, 0.0, -1.0]", AT(missile_card.direction),
     "of its motion when it first touches the pad; made a unit vector; must point to the pad, against `pad.up`, by 85 degrees at most"},
    {"missile", "position", SF_KEY_PLACE, "", AT(missile_position),
     "x and y of the impact point, where the missile's lowest point arrives at the pad's top; absent: where the geometry puts it",
     .quantity = SF_LENGTH, .low = -1e3, .high = 1e3},
    {"missile", "friction", SF_KEY_NUMBER, "0.0", AT(missile_card.friction),
     "Coulomb coefficient against the pad", .high = 10.0},
    {"missile", "group", SF_KEY_NAME, "\"missile_surface\"", AT(surface_group),
     "physical surface of the missile that touches"},
    {"missile", "shape", SF_KEY_CHOICE, "\"auto\"", AT(shape_rule),
     "contact with an exact sphere, with the surface's triangles, or (auto) a sphere if the surface is one and covers its leading point",
     .words = "auto|sphere|surface"},
    {"missile", "gravity", SF_KEY_QUANTITY, "\"" SF_STANDARD_GRAVITY_TEXT "\"", AT(missile_card.gravity),
     "on the missile", .quantity = SF_ACCELERATION, .high = 1e4},
    {"missile", "gravity_direction", SF_KEY_VECTOR, "[0.0, 0.0, -1.0]", AT(missile_card.down),
     "of gravity, in the geometry's axes; made a unit vector"},
    {"missile", "gap", SF_KEY_QUANTITY, "\"0 mm\"", AT(missile_card.gap),
     "distance to the pad at the start, along `direction`; it changes when the missile arrives, not how (see above)", .quantity = SF_LENGTH, .high = 1e3},
    {"missile", "freedom", SF_KEY_CHOICE, "\"guided\"", AT(freedom),
     "`guided`: it moves along `direction` and does not turn; `free`: a rigid body with six degrees of freedom, in a model of the whole pad",
     .words = "guided|free"},
    {"missile", "inertia", SF_KEY_QUANTITIES, "", AT(inertia),
     "of a free missile: tensor about its centre of mass, xx, yy, zz and, if not zero, xy, yz, xz (xy = - integral of x y dm), in the geometry's axes; absent: of its solid with uniform density",
     .quantity = SF_INERTIA, .low = -1e6, .high = 1e6, .count_offset = offsetof(sf_case, inertia_count), .lengths = {3, 6}},
    {"missile", "centre", SF_KEY_QUANTITIES, "", AT(centre),
     "of mass, of a free missile, in the coordinates of its geometry; with `inertia`; absent: of its solid",
     .quantity = SF_LENGTH, .low = -1e3, .high = 1e3, .count_offset = offsetof(sf_case, centre_count), .lengths = {3}},
    {"missile", "angular_velocity", SF_KEY_QUANTITIES, "", AT(angular_velocity),
     "of a free missile when it first touches the pad, in the pose of its geometry, about x, y and z; absent: none",
     .quantity = SF_ANGULAR_VELOCITY, .low = -1e3, .high = 1e3, .count_offset = offsetof(sf_case, angular_velocity_count), .lengths = {3}},
    /* support, or each of `supports` */
    {"support", "file", SF_KEY_PATH, "", OF_SUPPORT(source.path),
     "geometry of a rigid fixed body that the pad may touch, in the coordinates of `geometry.file`; several: `supports = ( { file = ...; }, ... )`"},
    {"support", "parameters", SF_KEY_PARAMETERS, "", OF_SUPPORT(source),
     "values for its DefineConstant parameters"},
    {"support", "length_unit", SF_KEY_UNIT, "", OF_SUPPORT(source.unit),
     "unit of length of `file`; absent: that of `geometry`"},
    {"support", "group", SF_KEY_NAME, "\"support\"", OF_SUPPORT(group),
     "physical surface of `file` that the pad touches; it may have several parts"},
    {"support", "plane", SF_KEY_VECTOR, "", OF_SUPPORT(normal),
     "in place of `file`: a plane, by its normal towards the pad, in the geometry's axes"},
    {"support", "place", SF_KEY_QUANTITY, "\"0 mm\"", OF_SUPPORT(place),
     "of the plane, along its normal from the origin", .quantity = SF_LENGTH, .low = -1e3, .high = 1e3},
    {"support", "friction", SF_KEY_NUMBER, "0.5", OF_SUPPORT(friction),
     "Coulomb coefficient of the pad against it; the default is an assumption, as that of `pad.friction`", .high = 10.0},
    /* interfaces: a list of groups with these keys */
    {"interfaces", "between", SF_KEY_NAMES, NULL, OF_INTERFACE(between),
     "two layers, the names of their groups in `materials`, in either order",
     .count_offset = offsetof(sf_interface_entry, between_count)},
    {"interfaces", "kind", SF_KEY_CHOICE, NULL, OF_INTERFACE(kind),
     "`tied`: glued; `sliding`: without friction, held along the normal; `loose`: they only touch, slide, open and close",
     .words = "tied|sliding|loose"},
    {"interfaces", "friction", SF_KEY_NUMBER, "", OF_INTERFACE(friction),
     "Coulomb coefficient of a loose interface; absent: `pad.self_friction`", .high = 10.0},
    /* membrane */
    {"membrane", "faces", SF_KEY_NAMES, "[]", AT(membrane_group),
     "physical surfaces of the pad to which a thin elastic cover without cells is glued",
     .count_offset = offsetof(sf_case, membrane_count)},
    {"membrane", "E", SF_KEY_QUANTITY, "", AT(membrane_card.modulus),
     "Young's modulus of the cover", .quantity = SF_PRESSURE, POSITIVE, .high = 1e12},
    {"membrane", "nu", SF_KEY_NUMBER, "0.4", AT(membrane_card.poisson), "Poisson's ratio of it", .high = 0.5},
    {"membrane", "thickness", SF_KEY_QUANTITY, "", AT(membrane_card.thickness),
     "of it: it resists tension and shear, not bending", .quantity = SF_LENGTH, POSITIVE, .high = 1.0},
    {"membrane", "density", SF_KEY_QUANTITY, "", AT(membrane_card.density), "of it", .quantity = SF_DENSITY, .low = 4, .high = 2e4},
    {"membrane", "fabric", SF_KEY_BOOL, "false", AT(membrane_card.fabric),
     "the cover folds: it carries no compression"},
    /* kernel */
    {"kernel", "support_ratio", SF_KEY_NUMBER, "1.4", AT(support_ratio),
     "kernel radius over spacing, R/h; 2 or more makes the constraint matrix nearly singular",
     .low = 1.0, .low_open = true, .high = 4.0},
    {"kernel", "condition_limit", SF_KEY_NUMBER, "1e4", AT(condition_limit),
     "condition number of the moment matrix above which the support is enlarged", .low = 10.0, .high = 1e12},
    {"kernel", "stabilisation", SF_KEY_NUMBER, "0.1", AT(run.stabilisation),
     "coefficient of the stabilisation stiffness; of a pad that touches itself (`pad.self_contact`) 0.3 unless it is given", .high = 10.0},
    /* solver */
    {"solver", "end_time", SF_KEY_QUANTITY, NULL, AT(run.end_time),
     "latest end of the run, at least 3 step_limit", .quantity = SF_TIME, .low = 1e-9, .high = 1e3},
    {"solver", "step_safety", SF_KEY_NUMBER, "0.97", AT(run.step_safety),
     "time step as a fraction of the stability limit", .low = 1e-3, .high = 1.0},
    {"solver", "step_limit", SF_KEY_QUANTITY, "\"50 us\"", AT(run.step_limit),
     "largest time step; every step is recorded, at 20 kHz or more, twice what CFC 1000 needs", .quantity = SF_TIME, .low = 1e-12, .high = 50e-6},
    {"solver", "energy_limit", SF_KEY_NUMBER, "0.05", AT(run.energy_limit),
     "the run stops at this relative energy error, or when contact or stabilisation has given the pad this part of the impact energy", .low = 1e-9, .high = 1.0},
    {"solver", "stop_after_rebound", SF_KEY_BOOL, "true", AT(run.stop_after_rebound),
     "end when the missile has left the pad upwards"},
    /* series */
    {"series", "drops", SF_KEY_DROPS, "1.0", AT(drops),
     "number of drops on the same pad, one after the other, each with a results file of its own; or a list of them, each a group of the `interval` before it and keys of the group `missile`, which hold for it instead of those there: ( { }, { interval = \"90 s\"; velocity = \"5 m/s\"; } )",
     .low = 1.0, .high = SF_SERIES_MOST},
    {"series", "interval", SF_KEY_QUANTITY, "", AT(interval),
     "from one drop to the next, in which the pad recovers (`material.memory`); required for drops without an `interval` of their own",
     .quantity = SF_TIME, .low = 0.1, .high = 1e7},
    {"series", "counted", SF_KEY_COUNTED, "", AT(counted),
     "drops by whose mean `softfall sweep` and `softfall cfh` judge a series, for example [2, 3]; the last drop is one of them; absent: all but the first",
     .idle = true},
    /* output */
    {"output", "acceleration", SF_KEY_CHOICE, "\"accelerometer\"", AT(kinematic),
     "acceleration of the curves, of a_max and HIC: the specific force that an accelerometer in the missile reads (0 in free fall), or the kinematic one (-1 g in free fall)",
     .words = "accelerometer|kinematic"},
    {"output", "frame_interval", SF_KEY_QUANTITY, "\"1 ms\"", AT(run.frame_interval),
     "time between frames; there are also frames at the start and at the end; at most 100000 of them", .quantity = SF_TIME, .low = 1e-9, .high = 1e3},
    {"output", "times", SF_KEY_TIMES, "[]", AT(frame_time),
     "times of further frames", .quantity = SF_TIME, .count_offset = offsetof(sf_case, frame_time_count)},
    {"output", "fields", SF_KEY_FIELDS, ALL_FIELDS, AT(run.output_fields),
     "fields of a frame (default: all)", .words = FIELD_WORDS},
    /* report: words for report.html and summary.json */
    {"report", "sample", SF_KEY_NAME, "", AT(about[0]), "what is tested, in words: batch, age, supplier", .idle = true},
    {"report", "laboratory", SF_KEY_NAME, "", AT(about[1]), "who tests it, and where", .idle = true},
    {"report", "conditions", SF_KEY_NAME, "", AT(about[2]), "temperature, humidity, storage before the test; they are not used", .idle = true},
};
/* clang-format on */

static sf_key key_of(const sf_parameter *p) {
    static const sf_key_kind kind[] = {[SF_PARAMETER_NUMBER] = SF_KEY_NUMBER,
                                       [SF_PARAMETER_QUANTITY] = SF_KEY_QUANTITY,
                                       [SF_PARAMETER_CHOICE] = SF_KEY_CHOICE,
                                       [SF_PARAMETER_CURVE] = SF_KEY_CURVE,
                                       [SF_PARAMETER_CURVES] = SF_KEY_CURVES};
    return (sf_key){.group = p->group,
                    .name = p->key,
                    .kind = kind[p->kind],
                    .fallback = p->fallback,
                    .offset = p->offset,
                    .in_card = true,
                    .description = p->meaning,
                    .quantity = p->quantity,
                    .low = p->low,
                    .high = p->high,
                    .low_open = p->low_open,
                    .words = p->words,
                    .word_value = p->word_value};
}

void sf_case_list_keys(const sf_law *law, sf_key_list *out) {
    out->count = 0;
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
        out->key[out->count++] = keys[k];
        for (int p = 0; keys[k].kind == SF_KEY_LAW && p < law->parameter_count; p++) {
            assert(out->count + sizeof keys / sizeof *keys - k < SF_KEY_MAX);
            out->key[out->count++] = key_of(&law->parameter[p]);
        }
    }
}

void sf_case_material_path(const char *group, const char *path, char *out, size_t size) {
    static const char name[] = "material";
    bool below = strncmp(path, name, sizeof name - 1) == 0;
    snprintf(out, size, "%s%s", below ? group : "", below ? path + sizeof name - 1 : path);
}

/* The list's own copy of the name of a layer's group. */
static const char *layer_group(sf_key_list *list, const char *group, const char *path) {
    char name[SF_KEY_GROUP_SIZE];
    int k = 0;
    sf_case_material_path(group, path, name, sizeof name);
    while (k < SF_KEY_LAYER_GROUPS - 1 && *list->layer_group[k] && strcmp(list->layer_group[k], name) != 0)
        k++;
    memcpy(list->layer_group[k], name, sizeof name);
    return list->layer_group[k];
}

void sf_case_list_layer_keys(const sf_law *law, const char *group, sf_key_list *out) {
    size_t kept = 0;
    memset(out->layer_group, 0, sizeof out->layer_group);
    sf_case_list_keys(law, out);
    for (size_t k = 0; k < out->count; k++)
        if (out->key[k].in_card || out->key[k].kind == SF_KEY_LAW) {
            out->key[kept] = out->key[k];
            out->key[kept].group = layer_group(out, group, out->key[k].group);
            kept++;
        }
    out->count = kept;
}

const sf_key *sf_case_find_key(const sf_key_list *list, const char *group, const char *name) {
    for (size_t k = 0; k < list->count; k++)
        if (strcmp(list->key[k].group, group) == 0 && strcmp(list->key[k].name, name) == 0)
            return &list->key[k];
    return NULL;
}

/* If `inner` lies below `outer` ("" holds everything), the length of its next component, else 0; *component
 * is set to where it begins. */
static size_t next_component(const char *outer, const char *inner, const char **component) {
    size_t skip = strlen(outer);
    if (skip > 0) {
        if (strncmp(inner, outer, skip) != 0 || inner[skip] != '.')
            return 0;
        skip++;
    }
    *component = inner + skip;
    return strcspn(inner + skip, ".");
}

bool sf_case_is_group(const sf_key_list *list, const char *group) {
    size_t length = strlen(group);
    for (size_t k = 0; k < list->count; k++)
        if (strncmp(list->key[k].group, group, length) == 0 &&
            (list->key[k].group[length] == '\0' || list->key[k].group[length] == '.'))
            return true;
    return false;
}

/* Calls `visit` once for each key and sub-group directly in `group`. */
static void visit_names(const sf_key_list *list, const char *group,
                        void (*visit)(void *, const char *, size_t), void *data) {
    const char *last = NULL;
    size_t last_length = 0;
    for (size_t k = 0; k < list->count; k++) {
        const char *name = list->key[k].name;
        size_t length = strlen(name);
        if (strcmp(list->key[k].group, group) != 0)
            length = next_component(group, list->key[k].group, &name);
        if (length == 0 || (last && length == last_length && strncmp(last, name, length) == 0))
            continue;
        visit(data, name, length);
        last = name;
        last_length = length;
    }
}

typedef struct text_list {
    char *out;
    size_t size, used;
} text_list;

static void add_name(void *data, const char *name, size_t length) {
    text_list *list = data;
    if (list->used + length + 3 > list->size)
        return;
    list->used += (size_t)snprintf(list->out + list->used, list->size - list->used, "%s%.*s",
                                   list->used ? ", " : "", (int)length, name);
}

void sf_case_list_names(const sf_key_list *keys_of, const char *group, char *out, size_t size) {
    text_list list = {out, size, 0};
    out[0] = '\0';
    visit_names(keys_of, group, add_name, &list);
}

static void offer_name(void *data, const char *name, size_t length) {
    sf_near_offer(data, name, length);
}

const char *sf_case_near_hint(const sf_key_list *list, const char *group, const char *name,
                              char out[SF_NEAR_HINT]) {
    sf_near near = sf_near_begin(name);
    visit_names(list, group, offer_name, &near);
    return sf_near_hint(&near, out);
}
