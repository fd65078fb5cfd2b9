/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/cfh/cfh_options.h"

#include "build_info.h"
#include "study/engine.h"
#include "study/cfh/spread.h"
#include "base/program.h"
#include "base/units.h"
#include "io/process.h"
#include "post/figures/verdict.h"
#include <argp.h>
#include <math.h>
#include <omp.h>
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

typedef struct parser_state {
    sf_cfh_options *options;
    const char *height, *max_height, *heights; /* texts, read when the units are loaded */
    const char *checks;
    sf_error *err;
} parser_state;

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

static error_t parse_option(int key, char *text, struct argp_state *state) {
    parser_state *p = state->input;
    sf_cfh_options *o = p->options;
    switch (key) {
    case 'o':
        o->directory = text;
        break;
    case 'f':
        o->force = true;
        break;
    case 't':
        sf_program_read_threads(text, &o->threads, p->err);
        break;
    case 'j':
        if (sf_program_read_threads(text, &o->jobs, p->err) != SF_OK || o->jobs > SF_PROCESS_JOBS)
            argp_error(state, "--jobs takes a number from 1 to %d, not \"%s\"", SF_PROCESS_JOBS, text);
        break;
    case KEY_SET:
        add_override(o, text, p->err);
        break;
    case KEY_MATERIAL:
        o->material = text;
        break;
    case KEY_LIMIT_G:
        sf_program_read_limit("--limit-g", text, &o->limit[SF_CFH_A_MAX], p->err);
        break;
    case KEY_LIMIT_HIC:
        sf_program_read_limit("--limit-hic", text, &o->limit[SF_CFH_HIC], p->err);
        break;
    case KEY_HEIGHT:
        p->height = text;
        break;
    case KEY_HEIGHTS:
        p->heights = text;
        break;
    case KEY_MAX:
        p->max_height = text;
        break;
    case KEY_RIG:
        o->rig_path = text;
        break;
    case KEY_POSTERIOR:
        o->posterior = text;
        break;
    case KEY_CHECKS:
        p->checks = text;
        break;
    case ARGP_KEY_ARG:
        if (o->case_path)
            argp_error(state, "one case at a time: \"%s\" is one too many", text);
        o->case_path = text;
        break;
    case ARGP_KEY_END:
        if (!o->case_path || !o->directory)
            argp_error(state, "give a case, and the output directory with -o");
        break;
    default:
        return sf_engine_option(key, text, &o->engine, p->err) ? 0 : ARGP_ERR_UNKNOWN;
    }
    return 0;
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

static sf_status parse_heights(const parser_state *p, sf_error *err) {
    sf_cfh_options *o = p->options;
    sf_units *units = NULL;
    if (p->heights && (p->height || p->max_height))
        return SF_FAIL(err, SF_ERR_INPUT, "--heights is the whole list: %s does not go with it",
                       p->height ? "--height" : "--max-height");
    if (sf_units_open(&units, err) == SF_OK &&
        (!p->max_height ||
         parse_height(units, "--max-height", p->max_height, &o->max_height, err) == SF_OK) &&
        (!p->height || parse_height(units, "--height", p->height, &o->height, err) == SF_OK) && p->heights)
        parse_list(units, p->heights, o, err);
    sf_units_close(&units);
    if (o->height > o->max_height)
        return SF_FAIL(err, SF_ERR_INPUT, "--height of %g m is above the greatest height of %g m", o->height,
                       o->max_height);
    return err->status;
}

static sf_status parse_checks(const parser_state *p, sf_error *err) {
    char *end = NULL;
    if (!p->checks)
        return SF_OK;
    if (!p->options->posterior)
        return SF_FAIL(err, SF_ERR_INPUT,
                       "--check-drops %s: there are no draws to simulate without --posterior", p->checks);
    long count = strtol(p->checks, &end, 10);
    if (end == p->checks || *end || count < 0 || count > SF_CFH_CHECKS)
        return SF_FAIL(err, SF_ERR_INPUT, "--check-drops %s: not a number from 0 to %d", p->checks,
                       SF_CFH_CHECKS);
    p->options->checks = (int)count;
    return SF_OK;
}

static void print_version(FILE *stream, struct argp_state *state) {
    (void)state;
    fputs("softfall-cfh " SF_VERSION " (" SF_GIT_REVISION ")\n", stream);
}

sf_status sf_cfh_options_parse(int argc, char **argv, sf_cfh_options *options, sf_error *err) {
    static const struct argp_option known[] = {
        {"output", 'o', "DIR", 0, "write everything there (required); the drops stay in DIR/runs", 0},
        {"force", 'f', NULL, 0, "replace the report of an earlier run in DIR; finished drops are used again",
         0},
        {"threads", 't', "N", 0, "OpenMP threads (default: all processors, or OMP_NUM_THREADS)", 0},
        {"jobs", 'j', "N", 0,
         "drops side by side, which share the threads (default: as many as threads); the same results", 0},
        {"set", KEY_SET, "GROUP.KEY=VALUE", 0, "override a key of the case, as softfall-pre does", 1},
        {"material", KEY_MATERIAL, "FILE", 0, "another foam: replaces the case's group material", 1},
        {"limit-g", KEY_LIMIT_G, "G", 0,
         "limit of a_max in g (default " SF_LIMIT_TEXT(SF_DEFAULT_LIMIT_G) ")", 2},
        {"limit-hic", KEY_LIMIT_HIC, "HIC", 0,
         "limit of HIC (default " SF_LIMIT_TEXT(SF_DEFAULT_LIMIT_HIC) ")", 2},
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
        SF_ENGINE_OPTIONS(5),
        SF_ENGINE_RETRY(5),
        {0},
    };
    const struct argp parser = {
        .options = known,
        .parser = parse_option,
        .args_doc = "CASE -o DIR",
        .doc =
            "Critical fall height of a pad: the lowest drop height at which a_max or HIC reaches its limit "
            "(--limit-g, --limit-hic).\vSimulates up to 8 drops with softfall-pre and softfall-solve, with "
            "--posterior 5 more, and writes cfh.json, cfh.csv, cfh.png (and .gp) and report.html. After an interruption run the same "
            "command again to resume. The height is indicative, not a certification.",
    };
    parser_state state = {.options = options, .err = err};
    argp_program_version_hook = print_version;
    *options = (sf_cfh_options){.threads = omp_get_max_threads(),
                                .limit = {SF_DEFAULT_LIMIT_G, SF_DEFAULT_LIMIT_HIC},
                                .max_height = DEFAULT_MAX_HEIGHT,
                                .checks = DEFAULT_CHECKS};
    if (argp_parse(&parser, argc, argv, 0, NULL, &state) != 0)
        return SF_FAIL(err, SF_ERR_INPUT, "the command line cannot be read");
    if (err->status == SF_OK && parse_checks(&state, err) == SF_OK)
        parse_heights(&state, err);
    return err->status;
}
