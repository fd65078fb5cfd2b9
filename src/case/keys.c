/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "case/keys.h"

#include "core/motion.h"
#include <string.h>

#define AT(member) .offset = offsetof(sf_case, member)
#define POSITIVE .low = 0.0, .low_open = true
/* Frame fields as words and as the default, "[\"displacement\", ...]". */
#define WORD(constant, name, ...) #name
#define QUOTED(constant, name, ...) "\"" #name "\""
#define FIELD_WORDS SF_FRAME_FIELD_LIST(WORD, "|")
#define ALL_FIELDS "[" SF_FRAME_FIELD_LIST(QUOTED, ", ") "]"

/* A tensile strength that no foam reaches: finite, so that it can be stored and compared. */
#define NO_CUTOFF 1e30

/* The bounds are those of sf_model_check, so that the sentence about a value names its place in the case. */
/* clang-format off */
static const sf_key keys[] = {
    /* geometry */
    {"geometry", "file", SF_KEY_PATH, NULL, AT(pad.path),
     "geometry of the pad: .geo, .msh with cells, or what gmsh can open and mesh; relative to the file that names it"},
    {"geometry", "missile_file", SF_KEY_PATH, "", AT(missile.path),
     "geometry of the missile; absent: it is in `file`"},
    {"geometry", "length_unit", SF_KEY_UNIT, NULL, AT(length_unit),
     "unit of length of both geometries, for example \"mm\""},
    {"geometry", "parameters", SF_KEY_PARAMETERS, "", AT(pad),
     "values for the DefineConstant parameters of `file`, in its own units"},
    {"geometry", "missile_parameters", SF_KEY_PARAMETERS, "", AT(missile),
     "the same for `missile_file`"},
    /* pad */
    {"pad", "group", SF_KEY_NAME, "\"pad\"", AT(pad_group), "physical volume of the pad"},
    {"pad", "contact", SF_KEY_NAME, "\"top\"", AT(contact_group), "physical surface that the missile may touch"},
    {"pad", "fixed", SF_KEY_NAMES, "[\"base\"]", AT(fixed_group),
     "physical surfaces glued to the anvil", .count_offset = offsetof(sf_case, fixed_count)},
    {"pad", "sliding", SF_KEY_NAMES, "[]", AT(sliding_group),
     "plane physical surfaces that lie on a smooth anvil: held along their normal only",
     .count_offset = offsetof(sf_case, sliding_count)},
    {"pad", "symmetry", SF_KEY_NAMES, "[\"symmetry_x\", \"symmetry_y\"]", AT(symmetry_group),
     "physical surfaces that are symmetry planes; those of the default may be absent from the geometry",
     .count_offset = offsetof(sf_case, symmetry_count)},
    /* material */
    {"material", "density", SF_KEY_QUANTITY, NULL, AT(foam.density),
     "of the undeformed foam", .quantity = SF_DENSITY, .low = 1e-3, .high = 1e5},
    {"material", "E", SF_KEY_QUANTITY, NULL, AT(foam.modulus),
     "modulus in tension, and the least stiffness of the stabilisation", .quantity = SF_PRESSURE, .low = 1.0, .high = 1e12},
    {"material", "curve", SF_KEY_CURVE, "", AT(foam),
     "compression curve, a CSV file (see below); relative to the file that names it"},
    {"material", "curves", SF_KEY_CURVES, "", AT(foam),
     "instead of `curve`: curves at several strain rates, ascending: ( { rate = \"0.0017 1/s\"; file = \"slow.csv\"; }, ... )"},
    {"material", "HU", SF_KEY_NUMBER, "1.0", AT(foam.hysteresis_hu),
     "hysteretic unloading factor; 1 = no hysteresis", .low = 1e-6, .high = 1.0},
    {"material", "SHAPE", SF_KEY_NUMBER, "1.0", AT(foam.hysteresis_shape),
     "shape of unloading", .low = 1e-3, .high = 100.0},
    {"material", "DAMP", SF_KEY_NUMBER, "0.0", AT(foam.damp),
     "viscous coefficient: stress DAMP x density x wave speed x length x strain rate", .high = 10.0},
    {"material", "damp_length", SF_KEY_QUANTITY, "\"spacing\"", AT(foam.damp_length),
     "the length in DAMP: \"spacing\" (of each node) or a fixed length", .quantity = SF_LENGTH, POSITIVE, .high = 1e3,
     .words = "spacing", .word_value = 0.0},
    {"material", "ED", SF_KEY_QUANTITY, "\"0 Pa\"", AT(foam.maxwell_modulus),
     "modulus of the Maxwell branch; 0 = none", .quantity = SF_PRESSURE, .high = 1e12},
    {"material", "BETA1", SF_KEY_QUANTITY, "\"5000 1/s\"", AT(foam.maxwell_rate),
     "decay rate of the Maxwell branch; must be given when ED is", .quantity = SF_RATE, .low = 1e-6, .high = 1e12},
    {"material", "eta", SF_KEY_QUANTITY, "\"0 Pa s\"", AT(foam.kelvin_viscosity),
     "Kelvin viscosity; bounds the time step", .quantity = SF_VISCOSITY, .high = 1e9},
    {"material", "tension_cutoff", SF_KEY_QUANTITY, "\"none\"", AT(foam.tension_cutoff),
     "largest tensile nominal stress, or \"none\"", .quantity = SF_PRESSURE, POSITIVE, .high = 1e12,
     .words = "none", .word_value = NO_CUTOFF},
    {"material", "rate_filter_time", SF_KEY_QUANTITY, "\"0.1 ms\"", AT(foam.rate_filter_time),
     "time constant of the strain rate that chooses among `curves`", .quantity = SF_TIME, .low = 1e-9, .high = 1e3},
    {"material.densification", "rule", SF_KEY_CHOICE, "\"H1\"", AT(densification_rule),
     "law beyond the table: H1: A + B/(1 - strain)^n; H2: A + B/(limit - strain)^m; value and slope continuous",
     .words = "H1|H2"},
    {"material.densification", "start", SF_KEY_NUMBER, "0.0", AT(foam.densification_start),
     "strain from which the law replaces the table; 0 = the table's end", .high = 0.999},
    {"material.densification", "exponent", SF_KEY_NUMBER, "0.0", AT(foam.densification_exponent),
     "n of H1 (0 = the one that makes A vanish) or m of H2 (required)", .high = 100.0},
    {"material.densification", "limit", SF_KEY_NUMBER, "1.0", AT(foam.densification_limit),
     "strain at which the stress of H2 becomes infinite (required); 1 for H1", .low = 0.01, .high = 1.0},
    /* missile */
    {"missile", "mass", SF_KEY_QUANTITY, "", AT(missile_card.mass),
     "of the whole missile, also in a quarter model; required without `motion`", .quantity = SF_MASS, .low = 1e-9, .high = 1e9},
    {"missile", "velocity", SF_KEY_QUANTITY, "", AT(missile_card.speed),
     "speed when it touches the pad; required without `motion`", .quantity = SF_SPEED, .low = 1e-9, .high = SF_MOTION_MAX_SPEED},
    {"missile", "motion", SF_KEY_MOTION, "", AT(motion_count),
     "displacement over time of a missile that a machine drives, a CSV file (see above), instead of `mass` and `velocity`; relative to the file that names it"},
    {"missile", "direction", SF_KEY_VECTOR, "[0.0, 0.0, -1.0]", AT(missile_card.direction),
     "of its motion; made a unit vector; must point down (z < 0)"},
    {"missile", "friction", SF_KEY_NUMBER, "0.0", AT(missile_card.friction),
     "Coulomb coefficient against the pad", .high = 10.0},
    {"missile", "group", SF_KEY_NAME, "\"missile_surface\"", AT(surface_group),
     "physical surface of the missile that touches"},
    {"missile", "shape", SF_KEY_CHOICE, "\"auto\"", AT(shape_rule),
     "contact with an exact sphere, with the surface's triangles, or (auto) a sphere if the surface is one",
     .words = "auto|sphere|surface"},
    {"missile", "gravity", SF_KEY_QUANTITY, "\"" SF_STANDARD_GRAVITY_TEXT "\"", AT(missile_card.gravity),
     "along -z, on the missile", .quantity = SF_ACCELERATION, .high = 1e4},
    {"missile", "gap", SF_KEY_QUANTITY, "\"0 mm\"", AT(missile_card.gap),
     "distance to the pad at the start", .quantity = SF_LENGTH, .high = 1e3},
    /* kernel */
    {"kernel", "support_ratio", SF_KEY_NUMBER, "1.4", AT(support_ratio),
     "kernel radius over spacing, R/h; 2 or more makes the constraint matrix nearly singular",
     .low = 1.0, .low_open = true, .high = 4.0},
    {"kernel", "condition_limit", SF_KEY_NUMBER, "1e4", AT(condition_limit),
     "condition number of the moment matrix above which the support is enlarged", .low = 10.0, .high = 1e12},
    {"kernel", "stabilisation", SF_KEY_NUMBER, "0.1", AT(run.stabilisation),
     "coefficient of the stabilisation stiffness", .high = 10.0},
    /* solver */
    {"solver", "end_time", SF_KEY_QUANTITY, NULL, AT(run.end_time),
     "latest end of the run, at least 3 step_limit", .quantity = SF_TIME, .low = 1e-9, .high = 1e3},
    {"solver", "step_safety", SF_KEY_NUMBER, "0.95", AT(run.step_safety),
     "time step as a fraction of the stability limit", .low = 1e-3, .high = 1.0},
    {"solver", "step_limit", SF_KEY_QUANTITY, "\"20 us\"", AT(run.step_limit),
     "largest time step; 20 us records the history at 50 kHz", .quantity = SF_TIME, .low = 1e-12, .high = 20e-6},
    {"solver", "energy_limit", SF_KEY_NUMBER, "0.05", AT(run.energy_limit),
     "relative energy error at which the run stops", .low = 1e-9, .high = 1.0},
    {"solver", "stop_after_rebound", SF_KEY_BOOL, "true", AT(run.stop_after_rebound),
     "end when the missile has left the pad upwards"},
    /* output */
    {"output", "frame_interval", SF_KEY_QUANTITY, "\"1 ms\"", AT(run.frame_interval),
     "time between frames; there are also frames at the start and at the end; at most 100000 of them", .quantity = SF_TIME, .low = 1e-9, .high = 1e3},
    {"output", "times", SF_KEY_TIMES, "[]", AT(frame_time),
     "times of further frames", .quantity = SF_TIME, .count_offset = offsetof(sf_case, frame_time_count)},
    {"output", "fields", SF_KEY_FIELDS, ALL_FIELDS, AT(run.output_fields),
     "fields of a frame (default: all)", .words = FIELD_WORDS},
};
/* clang-format on */

_Static_assert(sizeof keys / sizeof *keys <= SF_KEY_MAX, "sf_case_reader.given is too short");

const sf_key *sf_case_keys(size_t *count) {
    *count = sizeof keys / sizeof *keys;
    return keys;
}

const sf_key *sf_case_find_key(const char *group, const char *name) {
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
        if (strcmp(keys[k].group, group) == 0 && strcmp(keys[k].name, name) == 0)
            return &keys[k];
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

bool sf_case_is_group(const char *group) {
    size_t length = strlen(group);
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++)
        if (strncmp(keys[k].group, group, length) == 0 &&
            (keys[k].group[length] == '\0' || keys[k].group[length] == '.'))
            return true;
    return false;
}

/* Calls `visit` once for each key and sub-group directly in `group`. */
static void visit_names(const char *group, void (*visit)(void *, const char *, size_t), void *data) {
    const char *last = NULL;
    size_t last_length = 0;
    for (size_t k = 0; k < sizeof keys / sizeof *keys; k++) {
        const char *name = keys[k].name;
        size_t length = strlen(name);
        if (strcmp(keys[k].group, group) != 0)
            length = next_component(group, keys[k].group, &name);
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

void sf_case_list_names(const char *group, char *out, size_t size) {
    text_list list = {out, size, 0};
    out[0] = '\0';
    visit_names(group, add_name, &list);
}

enum { NEAR_MAX = 40, NEAR_EDITS = 2 };

/* Levenshtein distance, ignoring case: velocity and Velocity are one edit of zero apart. */
static size_t edit_distance(const char *a, size_t na, const char *b, size_t nb) {
    size_t row[NEAR_MAX + 1];
    if (na > NEAR_MAX || nb > NEAR_MAX)
        return NEAR_MAX;
    for (size_t j = 0; j <= nb; j++)
        row[j] = j;
    for (size_t i = 1; i <= na; i++) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= nb; j++) {
            size_t above = row[j];
            size_t best = diagonal + (strncasecmp(a + i - 1, b + j - 1, 1) != 0);
            best = above + 1 < best ? above + 1 : best;
            best = row[j - 1] + 1 < best ? row[j - 1] + 1 : best;
            diagonal = above;
            row[j] = best;
        }
    }
    return row[nb];
}

typedef struct nearest {
    const char *wanted;
    const char *name;
    size_t length, distance;
} nearest;

static void compare_name(void *data, const char *name, size_t length) {
    nearest *best = data;
    size_t distance = edit_distance(best->wanted, strlen(best->wanted), name, length);
    if (distance < best->distance && distance < length)
        *best = (nearest){best->wanted, name, length, distance};
}

const char *sf_case_near_name(const char *group, const char *name, char *out, size_t size) {
    nearest best = {name, NULL, 0, NEAR_EDITS + 1};
    visit_names(group, compare_name, &best);
    if (!best.name)
        return NULL;
    snprintf(out, size, "%.*s", (int)best.length, best.name);
    return out;
}
