/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/drop/drop_fit.h"

#include "base/hash.h"
#include "io/plain_file.h"
#include "io/table_csv.h"
#include "study/fit/compression/compression_config.h"

static const double LEAST_STRESS = 0.02; /* of the largest, in the scatter */
static const double STRAIN_STEP = 0.01;  /* of a test at the material point */

void sf_joint_data(const sf_joint *joint, double *measured, double *sd) {
    int row = 0;
    for (int t = 0; t < joint->test_count; t++) {
        const sf_joint_test *test = &joint->test[t];
        for (int k = 0; k < test->count; k++, row++) {
            measured[row] = test->stress[k] / test->scale;
            sd[row] = test->sd * hypot(measured[row], LEAST_STRESS);
        }
    }
    for (int c = 0; c < joint->cushion_count; c++)
        for (int k = 0; k < joint->cushion[c].count; k++, row++) {
            measured[row] = log(joint->cushion[c].peak_g[k]);
            sd[row] = joint->cushion[c].sd;
        }
}

/* Takes the point to a strain; the stress there. */
static double drive(const sf_material_law *law, double rate, double to, sf_uniaxial *point) {
    double from = point->strain, stress = 0;
    int steps = (int)ceil(fabs(to - from) / STRAIN_STEP);
    steps = steps > 0 ? steps : 1;
    for (int k = 1; k <= steps; k++)
        stress = law->law->uniaxial(law->numbers, fmax(fabs(to - from), 1e-6) / rate / steps,
                                    from + (to - from) * k / steps, point);
    return stress;
}

static sf_status compress(const sf_joint_test *test, const sf_material_law *law, double *y, sf_error *err) {
    sf_uniaxial point = {0};
    for (int k = 0; k < test->count; k++) {
        if (k == test->loading)
            drive(law, test->rate, test->turn, &point);
        y[k] = drive(law, test->rate, test->strain[k], &point) / test->scale;
        if (!isfinite(y[k]))
            return SF_FAIL(err, SF_ERR_NUMERIC, "the foam of the test %s collapsed at a strain of %g",
                           test->name, test->strain[k]);
    }
    return SF_OK;
}

/* Block of 1 m2 under a flat mass. */
static sf_status drop_flat(const sf_joint_cushion *cushion, double static_stress, const sf_material_law *law,
                           double *y, sf_error *err) {
    const sf_columns block = {.mass = static_stress / SF_STANDARD_GRAVITY,
                              .speed = sqrt(2 * SF_STANDARD_GRAVITY * cushion->height),
                              .thickness = cushion->thickness,
                              .count = 1,
                              .area = {1}};
    sf_columns_figures figures;
    if (sf_columns_respond(&block, law, &figures, NULL, err) == SF_OK)
        *y = log(figures.a_max_g);
    return err->status;
}

sf_status sf_joint_respond(const sf_joint *joint, const sf_material_law *law, double *y, sf_error *err) {
    for (int t = 0; t < joint->test_count; y += joint->test[t++].count)
        SF_TRY(compress(&joint->test[t], law, y, err));
    for (int c = 0; c < joint->cushion_count; c++)
        for (int k = 0; k < joint->cushion[c].count; k++)
            SF_TRY(drop_flat(&joint->cushion[c], joint->cushion[c].static_stress[k], law, y++, err));
    return SF_OK;
}

uint64_t sf_joint_hash(uint64_t hash, const sf_joint *joint) {
    for (int t = 0; t < joint->test_count; t++) {
        const sf_joint_test *test = &joint->test[t];
        const double numbers[] = {test->rate, test->turn, test->scale, test->count, test->loading};
        hash = sf_hash_identity(hash, numbers, sizeof numbers);
        hash = sf_hash_identity(hash, test->strain, (size_t)test->count * sizeof *test->strain);
    }
    for (int c = 0; c < joint->cushion_count; c++) {
        const sf_joint_cushion *cushion = &joint->cushion[c];
        const double numbers[] = {cushion->thickness, cushion->height, cushion->count};
        hash = sf_hash_identity(hash, numbers, sizeof numbers);
        hash = sf_hash_identity(hash, cushion->static_stress, (size_t)cushion->count * sizeof(double));
    }
    return hash;
}

double sf_joint_rms(const sf_joint_test *test, bool unloading, const double *y) {
    int first = unloading ? test->loading : 0, last = unloading ? test->count : test->loading;
    double sum = 0;
    for (int k = first; k < last; k++)
        sum += pow(y[k] - test->stress[k] / test->scale, 2);
    return last > first ? sqrt(sum / (last - first)) : NAN;
}

static const double GRID = 0.05, SPREAD = 0.01; /* strain: between points, and over which each is a mean */
enum { LEAST_POINTS = 2 };                      /* of loading */

sf_status sf_fit_name_read(const sf_config *config, sf_config_item *entry, const char *usual, int number,
                           char name[SF_FIT_NAME_SIZE], sf_error *err) {
    const char *text = NULL;
    SF_TRY(sf_config_text(config, entry, "name", false, &text, err));
    if (text && strlen(text) >= SF_FIT_NAME_SIZE)
        return sf_config_refuse(config, entry, err, "the name \"%.80s\" is longer than %d characters", text,
                                SF_FIT_NAME_SIZE - 1);
    if (text)
        snprintf(name, SF_FIT_NAME_SIZE, "%s", text);
    else
        snprintf(name, SF_FIT_NAME_SIZE, "%s%d", usual, number);
    return SF_OK;
}

/* Twice, data would weigh more than they tell. */
static sf_status refuse_again(const sf_config *config, sf_config_item *entry, const char *what,
                              const char *earlier, sf_error *err) {
    return sf_config_refuse(config, entry, err, "%s those of \"%s\": give the same data once", what, earlier);
}

/* ---- compression tests ---- */

static void put_point(const sf_compression_test *t, int first, int last, double strain, sf_joint_test *out) {
    enum { HALF = 2 };
    double sum = 0;
    if (out->count == SF_JOINT_POINTS)
        return;
    for (int k = -HALF; k <= HALF; k++)
        sum +=
            sf_compression_at(last - first, &t->strain[first], &t->stress[first], strain + SPREAD * k / HALF);
    out->strain[out->count] = strain;
    out->stress[out->count++] = sum / (2 * HALF + 1);
}

/* Points of both branches, half a step and whole steps from rest, clear of the turn and of the strain that
 * loading begins with: below it nothing was measured. One that begins within SPREAD of rest begins there. */
static void take_points(const sf_compression_test *t, sf_joint_test *out) {
    int n = (int)floor((t->largest_strain - SPREAD) / GRID);
    double first = t->strain[0] > SPREAD ? t->strain[0] + SPREAD : 0;
    out->turn = t->largest_strain;
    out->scale = t->largest_stress;
    if (GRID / 2 >= first)
        put_point(t, 0, t->loading, GRID / 2, out);
    for (int k = 1; k <= n; k++)
        if (GRID * k >= first)
            put_point(t, 0, t->loading, GRID * k, out);
    out->loading = out->count;
    double least = t->strain[t->count - 1];
    for (int k = n; k >= 1 && t->count > t->loading + 1 && GRID * k > least + SPREAD; k--)
        put_point(t, t->loading - 1, t->count, GRID * k, out);
}

static sf_status take_test(const sf_config *config, sf_config_item *entry,
                           const sf_compression_source *source, sf_joint *joint, sf_error *err) {
    sf_joint_test *test = &joint->test[joint->test_count];
    SF_OWNED_BY(sf_compression_test_free) sf_compression_test read = {0};
    sf_error inner = SF_ERROR_INIT;
    /* the text of the file, at whatever rate it is said to be, is that of no other test */
    SF_TRY(sf_plain_hash(source->path, NULL, SF_PLAIN_TEXT, &test->file, err));
    for (int t = 0; t < joint->test_count; t++)
        if (joint->test[t].file == test->file)
            return refuse_again(config, config_setting_get_member(entry, "file"),
                                "the contents of the file are", joint->test[t].name, err);
    if (sf_compression_test_read(source, &read, &inner) != SF_OK)
        return SF_FAIL(err, inner.status, "%s (named at %s:%u)", inner.text, config->path,
                       config_setting_source_line(entry));
    take_points(&read, test);
    snprintf(test->interpretation, sizeof test->interpretation, "%s: %.500s", source->path,
             read.interpretation);
    if (test->loading < LEAST_POINTS)
        return sf_config_refuse(
            config, config_setting_get_member(entry, "file"), err,
            "%s: loading from a strain of %.3g to %.3g holds %d of the points %g apart that are "
            "compared" SF_AT_LEAST("%d"),
            source->path, read.strain[0], read.largest_strain, test->loading, GRID, LEAST_POINTS);
    joint->rows += test->count;
    joint->test_count++;
    return SF_OK;
}

static sf_status read_test(const sf_config *config, sf_config_item *entry, sf_joint *joint, sf_error *err) {
    sf_joint_test *test = &joint->test[joint->test_count];
    sf_compression_source source = {0};
    SF_OWNED char *path = NULL;
    *test = (sf_joint_test){.sd = 0.05};
    SF_TRY(sf_config_names(config, entry, "name|file|sd|" SF_COMPRESSION_SOURCE_KEYS, err));
    SF_TRY(sf_fit_name_read(config, entry, "compression ", joint->test_count + 1, test->name, err));
    SF_TRY(sf_config_number(config, entry, "sd", false, 1e-3, 1, &test->sd, err));
    SF_TRY(sf_compression_source_read(config, entry, (sf_compression_specimen){0}, &source, err));
    SF_TRY(sf_config_file(config, entry, "file", true, &path, err));
    source.path = path;
    test->rate = source.rate;
    return take_test(config, entry, &source, joint, err);
}

/* ---- cushion curves ---- */

static sf_status read_table(const char *path, sf_joint_cushion *out, sf_error *err) {
    const sf_table_layout layout = {
        .what = "cushion curve", .kind = "cushion", .column = {&sf_column_static_stress, &sf_column_peak}};
    SF_OWNED_BY(sf_table_free) sf_table table = {0};
    SF_TRY(sf_table_read(path, &layout, &table, err));
    if (table.count > SF_JOINT_POINTS)
        SF_REFUSE(err, "%s: %lld points" SF_AT_MOST("%d"), path, (long long)table.count, SF_JOINT_POINTS);
    for (int64_t k = 0; k < table.count && err->status == SF_OK; k++) {
        if (!(table.value[0][k] > 0 && table.value[1][k] > 1))
            SF_REFUSE(err,
                      "%s:%d: a static stress of %g Pa and a peak of %g g: the stress must be above 0, the "
                      "peak above 1 g",
                      path, table.line[k], table.value[0][k], table.value[1][k]);
        out->static_stress[out->count] = table.value[0][k];
        out->peak_g[out->count++] = table.value[1][k];
    }
    snprintf(out->interpretation, sizeof out->interpretation, "%s: %.383s, %d points", path,
             table.interpretation, out->count);
    return err->status;
}

/* points = ( (5.0, 60.0), ... ): kPa and g */
static sf_status read_points(const sf_config *config, sf_config_item *list, sf_joint_cushion *out,
                             sf_error *err) {
    int n = config_setting_is_list(list) ? config_setting_length(list) : 0;
    if (n == 0 || n > SF_JOINT_POINTS)
        return sf_config_refuse(config, list, err,
                                "points must be a list of 1 to %d pairs of static stress in kPa and peak in "
                                "g: points = ( [5.0, 60.0], [10.0, 75.0] )",
                                SF_JOINT_POINTS);
    for (int k = 0; k < n; k++) {
        sf_config_item *pair = config_setting_get_elem(list, (unsigned)k);
        if (!config_setting_is_aggregate(pair) || config_setting_length(pair) != 2)
            return sf_config_refuse(config, pair ? pair : list, err,
                                    "each of points must be a pair: [5.0, 60.0]");
        double s = config_setting_get_float_elem(pair, 0), g = config_setting_get_float_elem(pair, 1);
        if (!(s > 0 && g > 1))
            return sf_config_refuse(config, pair, err,
                                    "[%g, %g]: expected numbers with a point, the static stress above 0 "
                                    "kPa and the peak above 1 g",
                                    s, g);
        out->static_stress[k] = 1e3 * s;
        out->peak_g[k] = g;
    }
    out->count = n;
    return SF_OK;
}

/* The two numbers of the stress-energy method: G s = A exp(B s h / t), at energies s h / t equally spaced
 * from one to the other. */
static sf_status read_energy(const sf_config *config, sf_config_item *group, sf_joint_cushion *out,
                             sf_error *err) {
    enum { POINTS = 6 };
    double a = 0, b = 0, low = 0, high = 0;
    if (!config_setting_is_group(group))
        return sf_config_refuse(config, group, err,
                                "stress_energy must be a group: stress_energy: { A = \"60 kPa\"; B = 0.02; "
                                "from = \"10 kPa\"; to = \"60 kPa\"; }");
    SF_TRY(sf_config_names(config, group, "A|B|from|to", err));
    SF_TRY(sf_config_quantity(config, group, "A", SF_PRESSURE, true, 0, &a, err));
    SF_TRY(sf_config_number(config, group, "B", true, 1e-6, 10, &b, err));
    SF_TRY(sf_config_quantity(config, group, "from", SF_PRESSURE, true, 0, &low, err));
    SF_TRY(sf_config_quantity(config, group, "to", SF_PRESSURE, true, 0, &high, err));
    if (!(high > low))
        return sf_config_refuse(config, group, err, "to, %g Pa, is not above from, %g Pa", high, low);
    for (int k = 0; k < POINTS; k++) {
        double energy = low + (high - low) * k / (POINTS - 1);
        double s = energy * out->thickness / out->height;
        out->static_stress[k] = s;
        out->peak_g[k] = a * exp(1e-3 * b * energy) / s;
        if (!(out->peak_g[k] > 1))
            return sf_config_refuse(config, group, err,
                                    "the peak at an energy of %g kJ/m3 is %g g; it must be above 1 g",
                                    1e-3 * energy, out->peak_g[k]);
    }
    out->count = POINTS;
    return SF_OK;
}

/* No other cushion curve has its file, or its points at the same thickness and height. */
static sf_status check_cushion(const sf_config *config, sf_config_item *entry, const sf_joint *joint,
                               sf_error *err) {
    const sf_joint_cushion *added = &joint->cushion[joint->cushion_count];
    size_t size = (size_t)added->count * sizeof(double);
    for (int c = 0; c < joint->cushion_count; c++) {
        const sf_joint_cushion *old = &joint->cushion[c];
        if (added->file != 0 && old->file == added->file)
            return refuse_again(config, config_setting_get_member(entry, "file"),
                                "the contents of the file are", old->name, err);
        if (old->thickness == added->thickness && old->height == added->height &&
            old->count == added->count && memcmp(old->static_stress, added->static_stress, size) == 0 &&
            memcmp(old->peak_g, added->peak_g, size) == 0)
            return refuse_again(config, entry, "thickness, drop height and all points are", old->name, err);
    }
    return SF_OK;
}

static sf_status read_cushion(const sf_config *config, sf_config_item *entry, sf_joint *joint,
                              sf_error *err) {
    sf_joint_cushion *cushion = &joint->cushion[joint->cushion_count];
    sf_error inner = SF_ERROR_INIT;
    SF_OWNED char *path = NULL;
    sf_config_item *points = config_setting_get_member(entry, "points"),
                   *energy = config_setting_get_member(entry, "stress_energy"),
                   *file = config_setting_get_member(entry, "file");
    *cushion = (sf_joint_cushion){.sd = 0.05};
    SF_TRY(sf_config_names(config, entry, "name|file|points|stress_energy|thickness|drop_height|sd", err));
    SF_TRY(sf_fit_name_read(config, entry, "cushion ", joint->cushion_count + 1, cushion->name, err));
    SF_TRY(sf_config_number(config, entry, "sd", false, 1e-3, 1, &cushion->sd, err));
    SF_TRY(sf_config_quantity(config, entry, "thickness", SF_LENGTH, true, 0, &cushion->thickness, err));
    SF_TRY(sf_config_quantity(config, entry, "drop_height", SF_LENGTH, true, 0, &cushion->height, err));
    if ((points != NULL) + (energy != NULL) + (file != NULL) != 1)
        return sf_config_refuse(config, entry, err,
                                "a cushion curve needs one of file, points and stress_energy");
    if (points)
        SF_TRY(read_points(config, points, cushion, err));
    if (energy)
        SF_TRY(read_energy(config, energy, cushion, err));
    SF_TRY(sf_config_file(config, entry, "file", false, &path, err));
    if (path && read_table(path, cushion, &inner) != SF_OK)
        return SF_FAIL(err, inner.status, "%s (named at %s:%u)", inner.text, config->path,
                       config_setting_source_line(entry));
    if (path)
        SF_TRY(sf_plain_hash(path, NULL, SF_PLAIN_TEXT, &cushion->file, err));
    SF_TRY(check_cushion(config, entry, joint, err));
    joint->rows += cushion->count;
    joint->cushion_count++;
    return SF_OK;
}

sf_status sf_joint_read(const sf_config *config, sf_config_item *root, sf_joint *joint, sf_error *err) {
    sf_config_item *tests, *cushions;
    *joint = (sf_joint){0};
    SF_TRY(sf_config_list(config, root, "compressions", false, SF_JOINT_MOST, &tests, err));
    SF_TRY(sf_config_list(config, root, "cushions", false, SF_JOINT_MOST, &cushions, err));
    for (int k = 0; tests && k < config_setting_length(tests); k++)
        SF_TRY(read_test(config, config_setting_get_elem(tests, (unsigned)k), joint, err));
    for (int k = 0; cushions && k < config_setting_length(cushions); k++)
        SF_TRY(read_cushion(config, config_setting_get_elem(cushions, (unsigned)k), joint, err));
    return SF_OK;
}
