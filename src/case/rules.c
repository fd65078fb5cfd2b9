/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "case/rules.h"

#include "base/mat3.h"
#include "material/laws.h"
#include "model/flight.h"
#include "model/motion.h"

#define AT(path) sf_case_setting(reader, path)
#define REFUSE_AT(path, ...) SF_REFUSE_AT(reader, AT(path), err, __VA_ARGS__)
#define REFUSE(path, ...) REFUSE_AT(path, path ": " __VA_ARGS__)

/* Refuses the first of these keys, "one|two", that the case gives; `why`: behind its name. */
static sf_status refuse_given(const sf_case_reader *reader, const char *group, const char *keys,
                              const char *why, sf_error *err) {
    char path[64];
    for (int length; *keys; keys += length + (keys[length] == '|')) {
        length = (int)strcspn(keys, "|");
        snprintf(path, sizeof path, "%s.%.*s", group, length, keys);
        if (sf_case_is_given(reader, group, path + strlen(group) + 1))
            return REFUSE_AT(path, "%s%s", path, why);
    }
    return SF_OK;
}

static sf_status check_inertia(const sf_case_reader *reader, sf_error *err) {
    const sf_case *c = reader->out;
    double p[3];
    if (c->inertia_count == 0 || sf_missile_inertia_is_possible(c->inertia, p))
        return SF_OK;
    return REFUSE("missile.inertia",
                  "no body has the principal moments %.4g, %.4g and %.4g kg m2: they must be "
                  "positive, and none larger than the sum of the others",
                  p[0], p[1], p[2]);
}

static sf_status check_freedom(const sf_case_reader *reader, sf_error *err) {
    const sf_case *c = reader->out;
    if (c->freedom == SF_MISSILE_GUIDED)
        return refuse_given(reader, "missile", "inertia|centre|angular_velocity",
                            " has no meaning for a guided missile, which does not turn: leave it out, or set "
                            "missile.freedom = \"free\"",
                            err);
    if (c->motion_count > 0)
        return REFUSE("missile.freedom",
                      "a missile whose displacement missile.motion prescribes cannot be free");
    if (c->centre_count > 0 && c->inertia_count == 0)
        return REFUSE_AT(
            "missile.centre",
            "missile.centre needs missile.inertia: a solid of uniform density has its centre already");
    return check_inertia(reader, err);
}

static sf_status check_motion(const sf_case_reader *reader, sf_error *err) {
    static const char *const needed[] = {"mass", "velocity"};
    const sf_case *c = reader->out;
    if (c->motion_count == 0) {
        for (int k = 0; k < 2; k++)
            if (!sf_case_is_given(reader, "missile", needed[k]))
                return sf_case_missing_key(reader, sf_case_find_key(&reader->keys, "missile", needed[k]),
                                           err);
        return SF_OK;
    }
    SF_TRY(refuse_given(reader, "missile", "mass|velocity|gravity",
                        " has no meaning when missile.motion prescribes the displacement: leave it out",
                        err));
    double end = c->motion_time[c->motion_count - 1];
    if (!(c->run.end_time <= end * (1 + SF_MOTION_SLACK)))
        return REFUSE("solver.end_time", "%g s lies beyond the end of missile.motion (%g s)", c->run.end_time,
                      end);
    return SF_OK;
}

enum { LEAST_STEPS = 3 };

static bool key_is_given(const void *reader, const char *group, const char *key) {
    return sf_case_is_given(reader, group, key);
}

/* Checks the law itself as the solver will build it: it may refuse the curves. */
static sf_status check_law(const sf_case_reader *reader, sf_error *err) {
    char where[SF_CASE_WHERE_SIZE];
    const sf_material *m = reader->material;
    const char *place = "material", *file = NULL;
    char path[SF_CASE_GROUP_SIZE];
    sf_material_law law;
    sf_error inner = SF_ERROR_INIT;
    if (sf_material_law_build(m, &law, &inner) == SF_OK) {
        sf_material_law_free(&law);
        return SF_OK;
    }
    if (m->law->curves != SIZE_MAX)
        place = sf_case_is_given(reader, "material", "curve") ? "material.curve" : "material.curves";
    sf_case_material_path(reader->material_group, place, path, sizeof path);
    config_lookup_string(&reader->config, path, &file);
    return SF_FAIL(err, inner.status, "%s: %s: %s%s%s", sf_case_where(reader, AT(place), where), path,
                   file ? file : "", file ? ": " : "", inner.text);
}

/* Shifts the rates of the material to the pad's temperature. */
static sf_status shift_rates(const sf_case_reader *reader, sf_error *err) {
    const sf_material *m = reader->material;
    double at = reader->out->run.temperature,
           shift = at > 0 && m->law->shift ? m->law->shift(m->card, sf_material_curves(m), at) : 0;
    if (shift == 0)
        return SF_OK;
    reader->out->temperature_acts = true;
    if (reader->thermal)
        return REFUSE("material.shift", "the curves have temperatures, too: the pad's would act twice");
    if (isnan(shift))
        return REFUSE("material.shift",
                      "at pad.temperature, %g degC, the rates are shifted by more than 6 decades or, below "
                      "T_ref - C2, not at all: such a shift says nothing",
                      at - SF_CELSIUS);
    sf_sink_tell(reader->sink, SF_NOTE,
                 "%s: a rate at %g degC acts as %.4g times that rate does in the material's data; the curves "
                 "themselves, E, unloading and memory are the same at any temperature",
                 reader->material_group, at - SF_CELSIUS, shift);
    return SF_OK;
}

/* The law's rules. */
sf_status sf_case_check_card(const sf_case_reader *reader, sf_error *err) {
    char where[SF_CASE_WHERE_SIZE];
    char text[sizeof((sf_error *)NULL)->text];
    const sf_material *m = reader->material;
    const sf_given given = {key_is_given, reader};
    const char *place = "material";
    sf_error inner = SF_ERROR_INIT;
    if (!m->law->check_keys || m->law->check_keys(m->card, &given, &place, &inner) == SF_OK)
        return shift_rates(reader, err) == SF_OK ? check_law(reader, err) : err->status;
    sf_case_material_path(reader->material_group, inner.text, text, sizeof text);
    return SF_FAIL(err, inner.status, "%s: %s", sf_case_where(reader, AT(place), where), text);
}

/* All of a membrane's keys, or none. */
static sf_status check_membrane(const sf_case_reader *reader, sf_error *err) {
    static const char *const needed[] = {"E", "thickness", "density"};
    if (reader->out->membrane_count == 0)
        return refuse_given(reader, "membrane", "E|thickness|density|nu|fabric",
                            " has no meaning without membrane.faces", err);
    for (int k = 0; k < 3; k++)
        if (!sf_case_is_given(reader, "membrane", needed[k]))
            return sf_case_missing_key(reader, sf_case_find_key(&reader->keys, "membrane", needed[k]), err);
    return SF_OK;
}

static const double FLATTEST = 0.0871557; /* cosine of 85 degrees */

static sf_status check_direction(const sf_case_reader *reader, sf_error *err) {
    const sf_case *c = reader->out;
    const double *d = c->missile_card.direction, *up = c->up, *down = c->missile_card.down;
    double square = sf_dot3(d, d), length = sqrt(sf_dot3(up, up)), towards = -sf_dot3(d, up) / length;
    if (!(length > 0) || !isfinite(length) || !(sf_dot3(down, down) > 0) || !isfinite(sf_dot3(down, down)))
        return REFUSE_AT("pad.up", "pad.up and missile.gravity_direction must have a length");
    if (c->base_rule == SF_BASE_RESTING && up[2] < (1 - 1e-9) * length)
        return REFUSE("pad.up", "a resting pad lies on the ground, its face upwards; hold this one "
                                "(pad.base = \"glued\" or \"smooth\")");
    if (!(square > 0.0) || !(towards > 0.0) || !isfinite(square))
        return REFUSE("missile.direction",
                      "[%g, %g, %g] does not point to the pad, whose face looks along "
                      "[%g, %g, %g]; give that by pad.up, for example [-1.0, 0.0, 0.0] of a wall that is "
                      "hit along x",
                      d[0], d[1], d[2], up[0], up[1], up[2]);
    if (towards < FLATTEST * sqrt(square))
        return REFUSE("missile.direction",
                      "[%g, %g, %g] is %.1f degrees from the normal of the pad's face (pad.up) and "
                      "grazes it; at most %.0f degrees are allowed",
                      d[0], d[1], d[2], acos(towards / sqrt(square)) * 180 / M_PI,
                      acos(FLATTEST) * 180 / M_PI);
    return SF_OK;
}

/* The speed is that of first contact: the missile must have been slower at the start of its fall. */
static sf_status check_flight(const sf_case_reader *reader, sf_error *err) {
    const sf_missile_card *card = &reader->out->missile_card;
    if (isfinite(sf_flight_time(card)))
        return SF_OK;
    return REFUSE("missile.gap",
                  "in a fall over %g m from rest the missile gets faster (%.4g m/s) than "
                  "missile.velocity, %g m/s, which is its speed at first contact",
                  card->gap, sqrt(2 * sf_flight_pull(card) * card->gap), card->speed);
}

/* The free missile falls while it travels along its direction. */
static sf_status check_reach(const sf_case_reader *reader, sf_error *err) {
    const sf_case *c = reader->out;
    SF_TRY(check_flight(reader, err));
    const sf_missile_card *card = &c->missile_card;
    double time = c->run.end_time, reach = 0;
    for (int64_t k = 0; k < c->motion_count; k++)
        reach = fmax(reach, c->motion_displacement[k]);
    if (c->motion_count == 0)
        reach = sf_flight_start_speed(card) * time + 0.5 * sf_flight_pull(card) * time * time;
    if (reach > card->gap)
        return SF_OK;
    return REFUSE("missile.gap",
                  "the missile travels %g m until solver.end_time (%g s) and never reaches "
                  "the pad, which is %g m away",
                  reach, time, card->gap);
}

/* A curve needs 3 rows of the history, one per step; frames are files' worth of fields. */
static sf_status check_times(const sf_case_reader *reader, sf_error *err) {
    char where[SF_CASE_WHERE_SIZE];
    const sf_case *c = reader->out;
    const sf_run_options *run = &c->run;
    if (run->end_time < LEAST_STEPS * run->step_limit)
        return REFUSE("solver.end_time",
                      "%g s is less than %d times solver.step_limit (%g s): there "
                      "would be no curve",
                      run->end_time, LEAST_STEPS, run->step_limit);
    if (run->step_limit < SF_SMALLEST_STEP * run->end_time)
        return REFUSE("solver.step_limit", "%g s is below %g of solver.end_time (%g s), where a run stops",
                      run->step_limit, SF_SMALLEST_STEP, run->end_time);
    if (run->end_time / run->frame_interval > SF_MOST_FRAMES)
        return REFUSE("output.frame_interval",
                      "%g s up to solver.end_time (%g s) means %.3g frames; at "
                      "most %d are written",
                      run->frame_interval, run->end_time, run->end_time / run->frame_interval,
                      SF_MOST_FRAMES);
    for (int k = 0; k < c->frame_time_count; k++)
        if (c->frame_time[k] > run->end_time)
            sf_sink_tell(reader->sink, SF_WARNING,
                         "%s: output.times: %g s lies beyond solver.end_time (%g s): there "
                         "will be no such frame",
                         sf_case_where(reader, AT("output.times"), where), c->frame_time[k], run->end_time);
    return SF_OK;
}

/* The layer with this name of `length` characters; -1: none. */
static int find_layer(const sf_case *c, const char *name, size_t length) {
    for (int k = 0; k < c->layer_count; k++)
        if (strlen(c->layer[k].name) == length && strncmp(c->layer[k].name, name, length) == 0)
            return k;
    return -1;
}

sf_status sf_case_add_interface(const sf_case_reader *reader, const config_setting_t *group, sf_error *err) {
    static const char *const kind[] = {"tied", "sliding", "loose"};
    const sf_interface_entry *entry = &reader->entry;
    sf_case *c = reader->out;
    sf_case_interface own = {.key = "interfaces", .kind = entry->kind};
    if (c->layer_count == 0)
        return SF_REFUSE_AT(reader, group, err,
                            "interfaces: the pad has one material; layers are the groups of materials");
    for (int k = 0; k < entry->between_count && k < 2; k++)
        if ((own.layer[k] = find_layer(c, entry->between[k], strlen(entry->between[k]))) < 0)
            return SF_REFUSE_AT(reader, group, err, "interfaces.between: unknown layer \"%s\" of materials",
                                entry->between[k]);
    if (entry->between_count != 2)
        return SF_REFUSE_AT(reader, group, err,
                            "interfaces.between must name two layers, for example [\"upper\", \"cover\"]");
    if (sf_case_interface_find(c, own.layer[0], own.layer[1]))
        return SF_REFUSE_AT(reader, group, err, "interfaces: \"%s\" and \"%s\" are given twice",
                            entry->between[0], entry->between[1]);
    if (own.kind != SF_INTERFACE_LOOSE && !isnan(entry->friction))
        return SF_REFUSE_AT(reader, group, err,
                            "interfaces.friction: the interface of \"%s\" and \"%s\" is %s; only one that is "
                            "loose has friction",
                            entry->between[0], entry->between[1], kind[own.kind]);
    if (own.kind == SF_INTERFACE_LOOSE)
        own.friction = isnan(entry->friction) ? c->self_friction : entry->friction;
    c->interface[c->interface_count++] = own;
    return SF_OK;
}

/* Adds an interface "NAME/NAME" of one of the older keys, unless the list `interfaces` has the pair. */
static sf_status add_pair(const sf_case_reader *reader, const char *key, const char *name, int kind,
                          sf_error *err) {
    sf_case *c = reader->out;
    const char *slash = strchr(name, '/');
    sf_case_interface own = {.key = key,
                             .layer = {slash ? find_layer(c, name, (size_t)(slash - name)) : -1,
                                       slash ? find_layer(c, slash + 1, strlen(slash + 1)) : -1},
                             .kind = kind,
                             .friction = kind == SF_INTERFACE_LOOSE ? c->self_friction : 0};
    if (c->layer_count == 0)
        return REFUSE_AT(key, "%s: the pad has one material; layers are the groups of materials", key);
    if (own.layer[0] < 0 || own.layer[1] < 0 || own.layer[0] == own.layer[1])
        return REFUSE_AT(key, "%s: \"%s\" does not name two layers of materials, for example \"cover/core\"",
                         key, name);
    const sf_case_interface *other = sf_case_interface_find(c, own.layer[0], own.layer[1]);
    if (other && strcmp(other->key, "interfaces") != 0)
        return REFUSE_AT(key, "%s: \"%s/%s\" and \"%s\" are the same interface", key,
                         c->layer[other->layer[0]].name, c->layer[other->layer[1]].name, name);
    if (!other)
        c->interface[c->interface_count++] = own;
    return SF_OK;
}

static sf_status check_interfaces(const sf_case_reader *reader, sf_error *err) {
    sf_case *c = reader->out;
    for (int k = 0; k < c->sliding_pair_count; k++)
        SF_TRY(add_pair(reader, "pad.sliding_interfaces", c->sliding_pair[k], SF_INTERFACE_SLIDING, err));
    for (int k = 0; k < c->loose_pair_count; k++)
        SF_TRY(add_pair(reader, "pad.loose_interfaces", c->loose_pair[k], SF_INTERFACE_LOOSE, err));
    for (int k = 0; k < c->interface_count && c->self_contact == SF_SELF_CONTACT_OFF; k++)
        if (c->interface[k].kind == SF_INTERFACE_LOOSE)
            return REFUSE_AT(c->interface[k].key, "%s: loose layers need pad.self_contact, which is \"off\"",
                             c->interface[k].key);
    if (c->separate && c->self_contact == SF_SELF_CONTACT_OFF)
        return REFUSE_AT("pad.separate",
                         "pad.separate: bodies touch each other by pad.self_contact, which is \"off\"");
    return SF_OK;
}

/* Rules on the layers; their names, for sentences, as the pad's group. */
static sf_status check_layers(const sf_case_reader *reader, sf_error *err) {
    sf_case *c = reader->out;
    SF_TRY(check_interfaces(reader, err));
    if (reader->layers && sf_case_is_given(reader, "pad", "group"))
        return REFUSE("pad.group", "the groups of materials name the pad's volumes; only one of the two may "
                                   "be given");
    for (int k = 0; k < c->layer_count; k++) {
        size_t used = k ? strlen(c->pad_group) : 0;
        snprintf(c->pad_group + used, sizeof c->pad_group - used, "%s%s", k ? "\", \"" : "",
                 c->layer[k].name);
    }
    return SF_OK;
}

/* Friction and weight belong to a pad that rests. */
static sf_status check_resting(const sf_case_reader *reader, sf_error *err) {
    const sf_case *c = reader->out;
    if (c->base_rule != SF_BASE_RESTING)
        return refuse_given(reader, "pad", "friction|gravity",
                            ": it acts on a resting pad only, and pad.base is not \"resting\"", err);
    if (!(c->pad_gravity > 0))
        return REFUSE("pad.gravity", "a resting pad without weight is not held by anything");
    return SF_OK;
}

/* The base: surfaces that no other key holds or moves. */
static sf_status check_base(const sf_case_reader *reader, sf_error *err) {
    const sf_case *c = reader->out;
    if (c->fixed_count + c->sliding_count + c->support_count == 0)
        return REFUSE(
            "pad.fixed",
            "at least one surface must hold the pad, here or in pad.sliding, or a support (support.file)");
    if (sf_case_is_given(reader, "pad", "base") && c->fixed_count == 0)
        return REFUSE("pad.base", "pad.fixed names no surface that it could apply to");
    for (int g = 0; g < c->fixed_count && sf_case_is_given(reader, "pad", "base"); g++) {
        const char *name = c->fixed_group[g], *other = NULL;
        if (strcmp(name, c->contact_group) == 0)
            other = "contact";
        else if (sf_case_has_name(c->sliding_count, c->sliding_group, name))
            other = "sliding";
        else if (sf_case_has_name(c->symmetry_count, c->symmetry_group, name))
            other = "symmetry";
        if (other)
            return REFUSE("pad.base", "the surface group \"%s\" is in pad.fixed and in pad.%s", name, other);
    }
    return check_resting(reader, err);
}

/* Rules that join several keys, on the values as they are given. */
sf_status sf_case_check_given(const sf_case_reader *reader, sf_error *err) {
    const sf_case *c = reader->out;
    reader->out->stabilised = sf_case_is_given(reader, "kernel", "stabilisation");
    if (!reader->layers && sf_case_check_card(reader, err) != SF_OK)
        return err->status;
    SF_TRY(check_layers(reader, err));
    if (!c->missile.path && c->missile.parameter_count > 0)
        return REFUSE_AT(
            "geometry.missile_parameters",
            "geometry.missile_parameters are given but no geometry.missile_file that they belong to");
    if (!c->missile.path && sf_case_is_given(reader, "geometry", "missile_length_unit"))
        return REFUSE_AT(
            "geometry.missile_length_unit",
            "geometry.missile_length_unit is given but no geometry.missile_file that it belongs to");
    if (check_membrane(reader, err) != SF_OK || check_base(reader, err) != SF_OK ||
        check_direction(reader, err) != SF_OK || check_freedom(reader, err) != SF_OK)
        return err->status;
    return check_motion(reader, err);
}

/* A free missile's first step adds the speed g dt, and the energy balance of the run sees it. */
static sf_status check_speed(const sf_case_reader *reader, sf_error *err) {
    static const double SHARE = 0.5; /* of the energy limit: the rest of the run needs some, too */
    const sf_case *c = reader->out;
    double gain = fabs(sf_flight_pull(&c->missile_card)) * c->run.step_limit,
           most = SHARE * c->run.energy_limit;
    if (c->motion_count > 0 || 0.5 * gain <= most * c->missile_card.speed)
        return SF_OK;
    return REFUSE("missile.velocity",
                  "%g m/s is too slow to resolve: in one solver.step_limit (%g s) "
                  "gravity adds %g m/s, an energy error of %.3g %%, more than half of solver.energy_limit "
                  "(%g %%)",
                  c->missile_card.speed, c->run.step_limit, gain, 50 * gain / c->missile_card.speed,
                  100 * c->run.energy_limit);
}

/* The drops of a series, with the interval before each, and those by which it is judged. */
static sf_status check_series(const sf_case_reader *reader, sf_error *err) {
    sf_case *c = reader->out;
    bool series = c->drops > 1, single = !series && sf_case_is_given(reader, "series", "drops"),
         has_interval = sf_case_is_given(reader, "series", "interval");
    const char *wrong = NULL;
    if (c->drops != floor(c->drops))
        wrong = "the number of drops is a whole number";
    else if (!series && !single && has_interval)
        wrong = "an interval belongs to a series: give series.drops, from 2 on";
    else if (c->drop[0].interval > 0)
        wrong = "nothing was before the first drop: it has no interval";
    else if (series && c->motion_count > 0)
        wrong = "a prescribed motion is no series of drops: put its cycles into missile.motion";
    else if (series && !c->run.stop_after_rebound)
        wrong = "a series needs solver.stop_after_rebound: each drop ends when the missile has left";
    for (int k = 1; k < c->drops && !wrong; k++) {
        c->drop[k].interval = c->drop[k].interval > 0 ? c->drop[k].interval : c->interval;
        if (!(c->drop[k].interval > 0))
            wrong = "each drop from the second on needs an interval: its own, or series.interval";
    }
    if (wrong)
        return REFUSE_AT("series.drops", "series.drops = %g: %s", c->drops, wrong);
    c->counted = single ? 1 : c->counted; /* what the case says of later drops has no effect */
    if (c->counted && c->counted >> ((int)c->drops - 1) != 1)
        return REFUSE_AT("series.counted",
                         "series.counted: the last drop that it names is not the last of the series "
                         "(series.drops = %g)",
                         c->drops);
    if (!c->counted)
        c->counted = ((int64_t)1 << (int)c->drops) - (series ? 2 : 1);
    return SF_OK;
}

/* A temperature that changes nothing would look as if it did. */
static sf_status check_temperature(const sf_case_reader *reader, sf_error *err) {
    const sf_case *c = reader->out;
    if (c->run.temperature == 0 || c->temperature_acts)
        return SF_OK;
    return REFUSE_AT(
        "pad.temperature",
        "pad.temperature is given, but the material has no curves at several temperatures and no "
        "material.shift: material.curves = ( { temperature = \"5 degC\"; file = \"cold.csv\"; }, ... )");
}

/* A factor on curves that are not there would look as if it acted. */
static sf_status check_stress_factor(const sf_case_reader *reader, sf_error *err) {
    if (reader->out->stress_factor == 1 || reader->out->has_curves)
        return SF_OK;
    return REFUSE_AT("pad.stress_factor",
                     "pad.stress_factor = %g, but the pad's material has no compression curve that it could "
                     "multiply: leave it out, and change the moduli of the material",
                     reader->out->stress_factor);
}

/* Rules on the complete case. */
sf_status sf_case_check_complete(const sf_case_reader *reader, sf_error *err) {
    char where[SF_CASE_WHERE_SIZE];
    const sf_case *c = reader->out;
    if (check_times(reader, err) != SF_OK || check_reach(reader, err) != SF_OK ||
        check_speed(reader, err) != SF_OK || check_series(reader, err) != SF_OK ||
        check_temperature(reader, err) != SF_OK || check_stress_factor(reader, err) != SF_OK)
        return err->status;
    if (c->support_ratio >= 2.0)
        sf_sink_tell(reader->sink, SF_WARNING,
                     "%s: kernel.support_ratio = %g: from 2 on the constraint matrix is "
                     "nearly singular",
                     sf_case_where(reader, AT("kernel.support_ratio"), where), c->support_ratio);
    return SF_OK;
}
