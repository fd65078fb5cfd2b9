/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "case/curves.h"

#include "model/motion.h"
#include <gsl/gsl_sort.h>

sf_table_layout sf_case_curve_layout(const char *what, sf_table_check *check) {
    return (sf_table_layout){.what = what,
                             .kind = "compression",
                             .column = {&sf_column_strain, &sf_column_stress},
                             .means = "nominal stress over nominal strain in compression",
                             .check = check};
}

void sf_case_curve_free(sf_case_curve *curve) {
    SF_CLEAR(curve, curve->strain, curve->stress);
}

static sf_status check_point(const sf_table_point *p, sf_error *err) {
    if (p->value[0] < 0.0)
        return SF_REFUSE(err, "%s:%d: strain %s is negative; compression is positive", p->path, p->line,
                         p->text[0]);
    if (p->value[0] >= 1.0)
        return SF_REFUSE(err, "%s:%d: strain %s means a compression to nothing; it must be below 1 (100 %%)",
                         p->path, p->line, p->text[0]);
    if (p->value[1] < 0.0)
        return SF_REFUSE(err, "%s:%d: stress %s is negative; compression is positive", p->path, p->line,
                         p->text[1]);
    if (p->index == 0)
        return p->value[0] == 0.0 && p->value[1] != 0.0
                   ? SF_REFUSE(err, "%s:%d: stress %s at zero strain; the curve must start at (0, 0)",
                               p->path, p->line, p->text[1])
                   : SF_OK;
    if (p->value[0] <= p->before[0])
        return SF_REFUSE(err, "%s:%d: strain %s is not above the one before it (%g)", p->path, p->line,
                         p->text[0], p->last[0]);
    if (p->value[1] < p->before[1])
        return SF_REFUSE(err, "%s:%d: stress %s is below the one before it (%g); it must not fall", p->path,
                         p->line, p->text[1], p->last[1]);
    return SF_OK;
}

/* The table's points, after (0, 0) if they begin above it. */
static sf_status take_points(const sf_table *table, sf_case_curve *curve, sf_error *err) {
    size_t points = (size_t)table->count, before = table->value[0][0] > 0.0;
    curve->extended = before > 0;
    curve->count = (int64_t)(points + before);
    SF_TRY(SF_ALLOC_ALL(err, "the curve", SF_ROOM(curve->strain, points + before),
                        SF_ROOM(curve->stress, points + before)));
    memcpy(curve->strain + before, table->value[0], points * sizeof *curve->strain);
    memcpy(curve->stress + before, table->value[1], points * sizeof *curve->stress);
    return SF_OK;
}

sf_status sf_case_curve_read(const char *path, sf_case_curve *curve, sf_error *err) {
    const sf_table_layout layout = sf_case_curve_layout("curve", check_point);
    SF_OWNED_BY(sf_table_free) sf_table table = {0};
    memset(curve, 0, sizeof *curve);
    SF_TRY(sf_table_read(path, &layout, &table, err));
    if (table.count < SF_CURVE_MIN_POINTS)
        SF_REFUSE(err, "%s: %lld points" SF_AT_LEAST("%d"), path, (long long)table.count,
                  SF_CURVE_MIN_POINTS);
    else if (!(table.value[1][table.count - 1] > 0.0))
        SF_REFUSE(err, "%s: the stress is zero everywhere", path);
    else if (!(table.value[0][table.count - 1] >= SF_CURVE_MIN_END))
        SF_REFUSE(err, "%s: the curve stops at the strain %g; it must reach at least %g", path,
                  table.value[0][table.count - 1], SF_CURVE_MIN_END);
    else
        take_points(&table, curve, err);
    memcpy(curve->interpretation, table.interpretation, sizeof curve->interpretation);
    if (err->status != SF_OK)
        sf_case_curve_free(curve);
    return err->status;
}

/* The keys material.curve and material.curves: compression curves into the card. */

enum { MOST_CURVES = 64 };

/* Appends a curve to the card's lists. */
static sf_status add_curve(sf_law_curves *card, double rate, const sf_case_curve *curve, sf_error *err) {
    size_t k = (size_t)card->curve_count;
    bool room = sf_grow(&card->curve_rate, k, sizeof rate) &&
                (k > 0 || sf_grow(&card->curve_ptr, 0, sizeof *card->curve_ptr)) &&
                sf_grow(&card->curve_ptr, k + 1, sizeof *card->curve_ptr);
    for (int64_t i = 0; room && i < curve->count; i++) {
        size_t at = (size_t)card->curve_points;
        room = sf_grow(&card->curve_strain, at, sizeof rate) && sf_grow(&card->curve_stress, at, sizeof rate);
        if (room) {
            card->curve_strain[at] = curve->strain[i];
            card->curve_stress[at] = curve->stress[i];
            card->curve_points++;
        }
    }
    if (!room)
        return SF_NO_MEMORY(err, "the curves of a material");
    card->curve_rate[k] = rate;
    card->curve_ptr[0] = 0;
    card->curve_ptr[++card->curve_count] = card->curve_points;
    return SF_OK;
}

static const double STEEPEST = 1e12; /* Pa, as the bound on a modulus */

/* Stiffer than any solid: 1e300 MPa, or two points at one place. */
static sf_status check_slopes(const char *path, const sf_case_curve *curve, sf_error *err) {
    for (int64_t k = 1; k < curve->count; k++) {
        double slope = (curve->stress[k] - curve->stress[k - 1]) / (curve->strain[k] - curve->strain[k - 1]);
        if (!(slope <= STEEPEST))
            return SF_REFUSE(err,
                             "%s: from the strain %g to %g the stress rises from %g to %g Pa, with a modulus "
                             "of %.3g Pa; at most %g Pa are allowed",
                             path, curve->strain[k - 1], curve->strain[k], curve->stress[k - 1],
                             curve->stress[k], slope, STEEPEST);
    }
    return SF_OK;
}

static sf_status read_file(sf_case_reader *reader, const config_setting_t *setting, double rate,
                           sf_error *err) {
    char where[SF_CASE_WHERE_SIZE];
    const char *text = config_setting_get_string(setting);
    if (!text || !*text)
        return SF_REFUSE_AT(reader, setting, err, "%s: expected the name of a curve's CSV file",
                            reader->material_group);
    SF_OWNED char *path = sf_case_resolve(reader, setting, text, err);
    SF_TRY(err->status);
    SF_OWNED_BY(sf_case_curve_free) sf_case_curve curve = {0};
    sf_error inner = SF_ERROR_INIT;
    if (sf_case_curve_read(path, &curve, &inner) != SF_OK || check_slopes(path, &curve, &inner) != SF_OK)
        return SF_FAIL(err, inner.status, "%s (named at %s)", inner.text,
                       sf_case_where(reader, setting, where));
    sf_sink_tell(reader->sink, SF_FACT, "%s: %s", path, curve.interpretation);
    if (curve.extended)
        sf_sink_tell(reader->sink, SF_NOTE, "%s begins at strain %g; the point (0, 0) was put before it",
                     path, curve.strain[1]);
    return add_curve(sf_material_curves(reader->material), rate, &curve, err);
}

/* The quantity in which the curves of a list differ. */
typedef struct curve_order {
    const char *key, *example, *unit;
    sf_quantity quantity;
} curve_order;
static const curve_order RATES = {"rate", "0.0017 1/s", "s-1", SF_RATE},
                         TEMPERATURES = {"temperature", "5 degC", "K", SF_TEMPERATURE};

/* One { rate = "..."; file = "..."; } of material.curves, or with a temperature. */
static sf_status read_entry(sf_case_reader *reader, const config_setting_t *entry, const curve_order *order,
                            sf_error *err) {
    const sf_law_curves *card = sf_material_curves(reader->material);
    const config_setting_t *rate = config_setting_get_member(entry, order->key); /* NULL: not in a group */
    const config_setting_t *file = config_setting_get_member(entry, "file");
    if (!rate || !file || config_setting_length(entry) != 2)
        return SF_REFUSE_AT(reader, entry, err,
                            "%s.curves: each entry must be { %s = \"%s\"; file = \"name.csv\"; }",
                            reader->material_group, order->key, order->example);
    const char *text = config_setting_get_string(rate);
    sf_error inner = SF_ERROR_INIT;
    double value = 0.0;
    if (!text)
        return SF_REFUSE_AT(reader, rate, err, "%s.curves: the %s must be a text such as \"%s\"",
                            reader->material_group, order->key, order->example);
    if (sf_units_parse(reader->units, text, order->quantity, &value, &inner) != SF_OK)
        return SF_REFUSE_AT(reader, rate, err, "%s.curves: %s", reader->material_group, inner.text);
    double last = card->curve_count > 0 ? card->curve_rate[card->curve_count - 1] : 0.0;
    if (!(value > last))
        return SF_REFUSE_AT(reader, rate, err,
                            "%s.curves: the %s %g %s is not above %g %s before it; %ss must be "
                            "positive and ascend",
                            reader->material_group, order->key, value, order->unit, last, order->unit,
                            order->key);
    return read_file(reader, file, value, err);
}

/* A stress that falls with the rate would create energy. */
static sf_status check_order(const sf_case_reader *reader, const config_setting_t *list, int k,
                             sf_error *err) {
    const sf_law_curves *card = sf_material_curves(reader->material);
    const config_setting_t *file[2];
    sf_curve_fall fall;
    if (k == 0 || !sf_law_curve_falls(card, k, &fall))
        return SF_OK;
    for (int i = 0; i < 2; i++)
        file[i] = config_setting_get_member(config_setting_get_elem(list, (unsigned)(k - 1 + i)), "file");
    return SF_REFUSE_AT(
        reader, file[1], err,
        "%s.curves: at a strain of %.3g the stress falls with the rate, from %.4g kPa at %g s-1 (%s) "
        "to %.4g kPa at %g s-1 (%s): are the rates or the files exchanged? Such a foam would create "
        "energy",
        reader->material_group, fall.strain, 1e-3 * fall.slow, card->curve_rate[k - 1],
        config_setting_get_string(file[0]), 1e-3 * fall.fast, card->curve_rate[k],
        config_setting_get_string(file[1]));
}

/* The curve at part x of the way from curve k to the next, by the logarithm of the stress at the strains of
 * both, up to the end of the shorter one. */
static sf_status interpolate(const sf_law_curves *c, int64_t k, double x, sf_case_curve *out, sf_error *err) {
    int64_t first = c->curve_ptr[k], count = c->curve_ptr[k + 2] - first;
    double end = fmin(c->curve_strain[c->curve_ptr[k + 1] - 1], c->curve_strain[c->curve_ptr[k + 2] - 1]);
    double *strain = sf_alloc(err, count, sizeof *strain, "curve"),
           *stress = sf_alloc(err, count, sizeof *stress, "curve");
    *out = (sf_case_curve){.strain = strain, .stress = stress};
    SF_TRY(err->status);
    memcpy(strain, &c->curve_strain[first], (size_t)count * sizeof *strain);
    gsl_sort(strain, 1, (size_t)count);
    for (int64_t i = 0; i < count && strain[i] <= end; i++) {
        if (out->count > 0 && strain[i] - strain[out->count - 1] < 1e-9)
            continue;
        double at = strain[i], low = sf_law_curve_stress(c, k, at), high = sf_law_curve_stress(c, k + 1, at);
        strain[out->count] = at;
        stress[out->count++] = low > 0 && high > 0 ? exp((1 - x) * log(low) + x * log(high)) : 0;
    }
    return SF_OK;
}

/* Leaves the curve at the pad's temperature, of several, whose temperatures stand in place of rates. */
static sf_status take_temperature(sf_case_reader *reader, const config_setting_t *setting, sf_error *err) {
    sf_law_curves *card = sf_material_curves(reader->material);
    const double *t = card->curve_rate, at = reader->out->run.temperature;
    int64_t last = card->curve_count - 1, k = 0;
    SF_OWNED_BY(sf_case_curve_free) sf_case_curve curve = {0};
    if (last < 1 || at == 0)
        return SF_REFUSE_AT(
            reader, setting, err, "%s.curves: curves at temperatures need %s", reader->material_group,
            at == 0 ? "pad.temperature, such as \"23 degC\", in the case" : "two of them or more");
    if (at < t[0] || at > t[last])
        return SF_REFUSE_AT(reader, setting, err,
                            "%s.curves: pad.temperature is %.6g degC, outside the curves' %.6g to %.6g degC: "
                            "there is no extrapolation",
                            reader->material_group, at - SF_CELSIUS, t[0] - SF_CELSIUS, t[last] - SF_CELSIUS);
    while (k < last - 1 && at > t[k + 1])
        k++;
    if (interpolate(card, k, (at - t[k]) / (t[k + 1] - t[k]), &curve, err) == SF_OK) {
        sf_sink_tell(reader->sink, SF_NOTE,
                     "%s: the curve at %g degC lies between those at %g and %g degC; E, unloading, memory "
                     "and rate are the same at any temperature",
                     reader->material_group, at - SF_CELSIUS, t[k] - SF_CELSIUS, t[k + 1] - SF_CELSIUS);
        sf_law_curves_free(card);
        add_curve(card, 0, &curve, err);
        reader->out->temperature_acts = reader->thermal = true;
    }
    return err->status;
}

/* Multiplies the stresses by pad.stress_factor. */
static void scale_stresses(sf_case_reader *reader) {
    sf_law_curves *card = sf_material_curves(reader->material);
    double factor = reader->out->stress_factor;
    reader->out->has_curves = true;
    for (int64_t i = 0; factor > 0 && i < card->curve_points; i++)
        card->curve_stress[i] *= factor;
}

sf_status sf_case_read_curves(sf_case_reader *reader, const config_setting_t *setting, char *detail,
                              size_t size, sf_error *err) {
    if (sf_material_curves(reader->material)->curve_count > 0)
        return SF_REFUSE_AT(reader, setting, err,
                            "%s has both curve and curves; only one of them may be given",
                            reader->material_group);
    if (strcmp(config_setting_name(setting), "curve") == 0) {
        SF_TRY(read_file(reader, setting, 0.0, err));
    } else {
        if (!config_setting_is_list(setting) || config_setting_length(setting) == 0)
            return SF_REFUSE_AT(reader, setting, err,
                                "%s.curves must be a list: ( { rate = \"0.0017 1/s\"; file = \"name.csv\"; } "
                                ")",
                                reader->material_group);
        if (config_setting_length(setting) > MOST_CURVES)
            return SF_REFUSE_AT(reader, setting, err, "%s.curves: %d curves" SF_AT_MOST("%d"),
                                reader->material_group, config_setting_length(setting), MOST_CURVES);
        bool thermal = config_setting_get_member(config_setting_get_elem(setting, 0), "temperature") != NULL;
        const curve_order *order = thermal ? &TEMPERATURES : &RATES;
        for (int i = 0; i < config_setting_length(setting); i++)
            if (read_entry(reader, config_setting_get_elem(setting, (unsigned)i), order, err) != SF_OK ||
                (!thermal && check_order(reader, setting, i, err) != SF_OK))
                return err->status;
        if (thermal)
            SF_TRY(take_temperature(reader, setting, err));
    }
    scale_stresses(reader);
    const sf_law_curves *card = sf_material_curves(reader->material);
    snprintf(detail, size, "%lld point%s, strain to %g", (long long)card->curve_points,
             card->curve_points == 1 ? "" : "s", card->curve_strain[card->curve_points - 1]);
    return SF_OK;
}

/* ---- the motion of a driven missile ---- */

/* The key missile.motion: the displacement over time of a missile that a machine drives, and the rules that
 * join it with other keys. */

static sf_status check_motion_point(const sf_table_point *p, sf_error *err) {
    if (p->index == 0) {
        for (int c = 0; c < 2; c++)
            if (p->value[c] != 0.0)
                return SF_REFUSE(err, "%s:%d: %s %s in the first point; a motion starts at (0, 0)", p->path,
                                 p->line, c ? "displacement" : "time", p->text[c]);
        return SF_OK;
    }
    double span = p->value[0] - p->before[0];
    if (!(span > 0.0))
        return SF_REFUSE(err, "%s:%d: time %s is not above the one before it (%g)", p->path, p->line,
                         p->text[0], p->last[0]);
    double speed = fabs(p->value[1] - p->before[1]) / span;
    if (!(speed <= SF_MOTION_MAX_SPEED))
        return SF_REFUSE(
            err, "%s:%d: displacement %s after %g means a speed of %g m/s; at most %g m/s are allowed",
            p->path, p->line, p->text[1], p->last[1], speed, SF_MOTION_MAX_SPEED);
    return SF_OK;
}

static const sf_table_layout motion_layout = {.what = "motion",
                                              .kind = "motion",
                                              .column = {&sf_column_time, &sf_column_displacement},
                                              .check = check_motion_point};

static sf_status check_motion_table(const char *path, const sf_table *table, sf_error *err) {
    double largest = 0.0;
    for (int64_t k = 0; k < table->count; k++)
        largest = fmax(largest, fabs(table->value[1][k]));
    if (table->count < 2)
        return SF_REFUSE(err, "%s: %lld points" SF_AT_LEAST("2"), path, (long long)table->count);
    if (!(largest > 0.0))
        return SF_REFUSE(err, "%s: the displacement is zero everywhere", path);
    return SF_OK;
}

sf_status sf_case_read_motion(sf_case_reader *reader, const config_setting_t *setting, char *detail,
                              size_t size, sf_error *err) {
    char where[SF_CASE_WHERE_SIZE];
    sf_case *c = reader->out;
    const char *text = config_setting_get_string(setting);
    if (!text || !*text)
        return SF_REFUSE_AT(reader, setting, err, "missile.motion: expected the name of a CSV file");
    SF_OWNED char *path = sf_case_resolve(reader, setting, text, err);
    SF_TRY(err->status);
    sf_table table = {0};
    sf_error inner = SF_ERROR_INIT;
    if (sf_table_read(path, &motion_layout, &table, &inner) == SF_OK)
        check_motion_table(path, &table, &inner);
    c->motion_count = table.count;
    c->motion_time = table.value[0];
    c->motion_displacement = table.value[1];
    free(table.line);
    if (inner.status != SF_OK)
        return SF_FAIL(err, inner.status, "%s (named at %s)", inner.text,
                       sf_case_where(reader, setting, where));
    snprintf(detail, size, "%lld points, to %g s", (long long)table.count, table.value[0][table.count - 1]);
    return SF_OK;
}
