/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/compression/compression_config.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "case/curves.h"
#include "io/table_csv.h"

static const double TURN = 0.05;       /* strain by which a turn differs from scatter */
static const double RETURN = 0.25;     /* part of the largest strain below which a cycle must end */
static const double UNLOADED = 0.1;    /* the same of a pause */
static const double LONGEST_STEP = 20; /* mean steps of time, above which a step is a pause */
static const double LIMIT = 0.98;      /* strain */

static sf_table_layout time_layout(void) {
    static const sf_table_name names[] = {{"time_s", 0, 1, "s"},
                                          {"time_ms", 0, 1e-3, "ms"},
                                          {"strain", 1, 1, "1"},
                                          {"strain_percent", 1, 0.01, "%"}};
    return (sf_table_layout){.what = "record of cycles",
                             .column = {"time", "strain"},
                             .wanted = {"\"time_s\"", "\"strain\" or \"strain_percent\""},
                             .names = names,
                             .name_count = sizeof names / sizeof *names};
}

double sf_cycle_record_pause(const sf_cycle_record *r, int i) {
    double mean = (r->time[r->count - 1] - r->time[0]) / (r->count - 1), largest = r->strain[r->turn[1]];
    if (i == 0 || r->strain[i - 1] > UNLOADED * largest || r->strain[i] > UNLOADED * largest)
        return 0;
    double step = r->time[i] - r->time[i - 1];
    return step > LONGEST_STEP * fmin(mean, 1) ? step : 0;
}

static sf_status take_tables(const char *path, sf_cycle_record *r, sf_error *err) {
    const sf_table_layout layouts[2] = {sf_case_curve_layout("record of cycles", NULL), time_layout()};
    sf_table stress = {0}, time = {0};
    if (sf_table_read(path, &layouts[0], &stress, err) == SF_OK &&
        sf_table_read(path, &layouts[1], &time, err) == SF_OK && stress.count != time.count)
        SF_FAIL(err, SF_ERR_INPUT, "%s: %lld rows with stress, %lld with time", path, (long long)stress.count,
                (long long)time.count);
    if (err->status == SF_OK) {
        r->count = (int)stress.count;
        r->strain = stress.value[0];
        r->stress = stress.value[1];
        r->time = time.value[0];
        stress.value[0] = stress.value[1] = time.value[0] = NULL;
    }
    for (int i = 0; i < r->count && err->status == SF_OK; i++) {
        if (!(r->strain[i] < LIMIT) || (i > 0 && !(r->time[i] > r->time[i - 1])))
            SF_FAIL(err, SF_ERR_INPUT,
                    "%s:%d: time %g s after %g s, strain %g: time must rise, strain stay below %g", path,
                    stress.line[i], r->time[i], i > 0 ? r->time[i - 1] : 0, r->strain[i], LIMIT);
        r->strain[i] = fmax(0, r->strain[i]);
        r->largest_stress = fmax(r->largest_stress, r->stress[i]);
    }
    sf_table_free(&stress);
    sf_table_free(&time);
    return err->status;
}

/* Turns by strain; a loading that is not followed by an unloading is left out. */
static sf_status find_turns(sf_cycle_record *r, sf_error *err) {
    int turns = 1, at = 0;
    bool up = true;
    for (int i = 0; i < r->count; i++) {
        double gain = up ? r->strain[i] - r->strain[at] : r->strain[at] - r->strain[i];
        if (gain > 0) {
            at = i;
        } else if (-gain > TURN) {
            if (turns == 2 * SF_CYCLES)
                return SF_FAIL(err, SF_ERR_INPUT, "%s: more than %d cycles", r->path, SF_CYCLES);
            r->turn[turns++] = at;
            up = !up;
            at = i;
        }
    }
    r->cycles = turns / 2;
    if (!up)
        r->turn[turns] = at;
    if (r->cycles < 2)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "%s: %d cycle of compression: memory is in the cycles after the first", r->path,
                       r->cycles);
    for (int c = 0; c < r->cycles; c++)
        if (r->strain[r->turn[2 * c + 2]] > RETURN * r->strain[r->turn[2 * c + 1]])
            return SF_FAIL(
                err, SF_ERR_INPUT,
                "%s: cycle %d returns from a strain of %g to %g only; it must unload below a quarter of it",
                r->path, c + 1, r->strain[r->turn[2 * c + 1]], r->strain[r->turn[2 * c + 2]]);
    return SF_OK;
}

sf_status sf_cycle_record_read(const sf_config *file, sf_config_item *root, sf_cycle_record *r,
                               sf_error *err) {
    sf_config_item *group = config_setting_get_member(root, "cycles");
    double fitted = SF_CYCLES;
    sf_error inner = SF_ERROR_INIT;
    if (!group)
        return SF_OK;
    if (!config_setting_is_group(group))
        return sf_config_refuse(file, group, err,
                                "cycles must be a group: cycles = { file = \"cycles.csv\"; };");
    SF_TRY(sf_config_names(file, group, "file|fitted", err));
    SF_TRY(sf_config_whole(file, group, "fitted", false, 2, SF_CYCLES, &fitted, err));
    SF_TRY(sf_config_file(file, group, "file", true, &r->path, err));
    if (take_tables(r->path, r, &inner) != SF_OK || find_turns(r, &inner) != SF_OK)
        return sf_config_refuse(file, group, err, "%s", inner.text);
    r->fitted = fitted < r->cycles ? (int)fitted : r->cycles;
    for (int i = 1; i < r->turn[2 * r->fitted]; i++)
        r->pauses += sf_cycle_record_pause(r, i) > 0;
    return SF_OK;
}

void sf_cycle_record_free(sf_cycle_record *r) {
    free(r->path);
    free(r->time);
    free(r->strain);
    free(r->stress);
    *r = (sf_cycle_record){0};
}
