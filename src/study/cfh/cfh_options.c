/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/cfh/cfh_options.h"

#include "study/cfh/spread.h"
#include "base/program.h"
#include "base/units.h"
#include "post/figures/verdict.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum {
    KEY_SET = 256,
    KEY_MATERIAL,
    KEY_LIMIT_G,
    KEY_LIMIT_HIC,
    KEY_HEIGHT,
    KEY_HEIGHTS,
    KEY_MAX,
    KEY_RIG,
    KEY_POSTERIOR,
    KEY_CHECKS
};

static const double LOWEST_HEIGHT = 0.01, GREATEST_HEIGHT = 100; /* m */
static const double DEFAULT_MAX_HEIGHT = 10;                     /* m */
enum { DEFAULT_CHECKS = 5 };

enum { HEIGHT, MAX_HEIGHT, HEIGHTS, CHECKS }; /* places in `texts` */

static sf_status add_override(sf_cfh_options *o, const char *text, sf_error *err) {
    static const char speed[] = "missile.velocity";
    const char *name = text + strspn(text, " \t");
    if (strncmp(name, speed, strlen(speed)) == 0)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "--set %s: the drop height decides the speed; --height gives the first one", text);
    if (o->override_count == SF_RUNNER_OVERRIDES - 1)
        return SF_FAIL(err, SF_ERR_INPUT, "at most %d --set options", SF_RUNNER_OVERRIDES - 1);
    o->overrides[o->override_count++] = text;
    return SF_OK;
}

void sf_cfh_options_take(sf_cfh_options *o, int key, const char *text, sf_error *err) {
    switch (key) {
    case KEY_SET:
        add_override(o, text, err);
        break;
    case KEY_MATERIAL:
        o->material = text;
        break;
    case KEY_LIMIT_G:
        sf_program_read_limit("--limit-g", text, &o->limit[SF_CFH_A_MAX], err);
        break;
    case KEY_LIMIT_HIC:
        sf_program_read_limit("--limit-hic", text, &o->limit[SF_CFH_HIC], err);
        break;
    case KEY_HEIGHT:
        o->texts[HEIGHT] = text;
        break;
    case KEY_HEIGHTS:
        o->texts[HEIGHTS] = text;
        break;
    case KEY_MAX:
        o->texts[MAX_HEIGHT] = text;
        break;
    case KEY_RIG:
        o->rig_path = text;
        break;
    case KEY_POSTERIOR:
        o->posterior = text;
        break;
    case KEY_CHECKS:
        o->texts[CHECKS] = text;
        break;
    }
}

static sf_status parse_height(const sf_units *units, const char *option, const char *text, double *height,
                              sf_error *err) {
    sf_error reason = SF_ERROR_INIT;
    if (sf_units_parse(units, text, SF_LENGTH, height, &reason) != SF_OK)
        return SF_FAIL(err, reason.status, "%s: %.900s", option, reason.text);
    if (!(*height >= LOWEST_HEIGHT && *height <= GREATEST_HEIGHT))
        return SF_FAIL(err, SF_ERR_INPUT, "%s: a drop height of %s is not between 1 cm and %g m", option,
                       text, GREATEST_HEIGHT);
    return SF_OK;
}

static int compare_heights(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static sf_status parse_list(const sf_units *units, const char *text, sf_cfh_options *o, sf_error *err) {
    char *copy = strdup(text), *rest = copy, *item;
    if (!copy)
        return SF_FAIL(err, SF_ERR_MEMORY, "out of memory for --heights");
    while (err->status == SF_OK && (item = strsep(&rest, ",")) != NULL) {
        item += strspn(item, " \t");
        if (o->list_count == SF_CFH_MAX_POINTS)
            SF_FAIL(err, SF_ERR_INPUT, "--heights: at most %d heights", SF_CFH_MAX_POINTS);
        else
            parse_height(units, "--heights", item, &o->list[o->list_count++], err);
    }
    free(copy);
    if (err->status == SF_OK && o->list_count < SF_CFH_MIN_POINTS)
        SF_FAIL(err, SF_ERR_INPUT, "--heights: %d heights, at least %d are needed", o->list_count,
                SF_CFH_MIN_POINTS);
    qsort(o->list, (size_t)o->list_count, sizeof o->list[0], compare_heights);
    for (int k = 1; k < o->list_count; k++)
        if (o->list[k] < o->list[k - 1] * (1 + 1e-6))
            SF_FAIL(err, SF_ERR_INPUT, "--heights: %g m stands twice in the list", o->list[k]);
    return err->status;
}

static sf_status parse_heights(sf_cfh_options *o, sf_error *err) {
    const char *height = o->texts[HEIGHT], *most = o->texts[MAX_HEIGHT], *list = o->texts[HEIGHTS];
    sf_units *units = NULL;
    if (list && (height || most))
        return SF_FAIL(err, SF_ERR_INPUT, "--heights is the whole list: %s does not go with it",
                       height ? "--height" : "--max-height");
    if (sf_units_open(&units, err) == SF_OK &&
        (!most || parse_height(units, "--max-height", most, &o->max_height, err) == SF_OK) &&
        (!height || parse_height(units, "--height", height, &o->height, err) == SF_OK) && list)
        parse_list(units, list, o, err);
    sf_units_close(&units);
    if (o->height > o->max_height)
        return SF_FAIL(err, SF_ERR_INPUT, "--height of %g m is above the greatest height of %g m", o->height,
                       o->max_height);
    return err->status;
}

static sf_status parse_checks(sf_cfh_options *o, sf_error *err) {
    const char *text = o->texts[CHECKS];
    char *end = NULL;
    if (!text)
        return SF_OK;
    if (!o->posterior)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "--check-drops %s: there are no draws to simulate without --posterior", text);
    long count = strtol(text, &end, 10);
    if (end == text || *end || count < 0 || count > SF_CFH_CHECKS)
        return SF_FAIL(err, SF_ERR_INPUT, "--check-drops %s: not a number from 0 to %d", text, SF_CFH_CHECKS);
    o->checks = (int)count;
    return SF_OK;
}

const struct argp_option sf_cfh_option_list[] = {
    {"set", KEY_SET, "GROUP.KEY=VALUE", 0, "override a key of the case, as softfall-pre does", 1},
    {"material", KEY_MATERIAL, "FILE", 0, "another foam: replaces the case's group material", 1},
    {"limit-g", KEY_LIMIT_G, "G", 0, "limit of a_max in g (default " SF_LIMIT_TEXT(SF_DEFAULT_LIMIT_G) ")",
     2},
    {"limit-hic", KEY_LIMIT_HIC, "HIC", 0, "limit of HIC (default " SF_LIMIT_TEXT(SF_DEFAULT_LIMIT_HIC) ")",
     2},
    {"height", KEY_HEIGHT, "LENGTH", 0,
     "first drop height, e.g. \"1.5 m\" (default: that of the case's velocity)", 3},
    {"max-height", KEY_MAX, "LENGTH", 0, "go no higher (default \"10 m\")", 3},
    {"heights", KEY_HEIGHTS, "LIST", 0, "these heights instead of a search: \"0.5 m,1 m,1.5 m,2 m\"", 3},
    {"rig", KEY_RIG, "CSV", 0,
     "heights are those of a rig with friction: v^2 = 2 g_eff h, with g_eff fitted to the columns h_m "
     "(or height_m) and v_test_m_s (or speed_m_s)",
     3},
    {"posterior", KEY_POSTERIOR, "FOLDER", 0,
     "draws of the foam, draw-001.cfg ..., as softfall-fit drop writes them: gives the interval of the height",
     4},
    {"check-drops", KEY_CHECKS, "N", 0,
     "simulate N of the draws to check the columns that stand for them (default 5)", 4},
    {0},
};

sf_cfh_options sf_cfh_options_begin(void) {
    return (sf_cfh_options){.limit = {SF_DEFAULT_LIMIT_G, SF_DEFAULT_LIMIT_HIC},
                            .max_height = DEFAULT_MAX_HEIGHT,
                            .checks = DEFAULT_CHECKS};
}

sf_status sf_cfh_options_finish(sf_cfh_options *o, sf_error *err) {
    SF_TRY(parse_checks(o, err));
    return parse_heights(o, err);
}
