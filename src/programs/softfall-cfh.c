/* SPDX-License-Identifier: GPL-3.0-or-later */
/* softfall-cfh CASE -o DIR: critical fall height of a pad, from drops that it simulates. */
#include "base/text.h"
#include "case/read.h"
#include "study/cfh/cfh_report.h"
#include "study/setup.h"

#include <gsl/gsl_sort.h>
#include <omp.h>

/* ---- options ---- */

static const double LOWEST_HEIGHT = 0.01, GREATEST_HEIGHT = 100; /* m */
static const double DEFAULT_MAX_HEIGHT = 10;                     /* m */
enum { DEFAULT_CHECKS = 5 };

/* Texts are borrowed from argv. Heights as given: of free fall, or on the rig. */
typedef struct options {
    const char *material;  /* NULL: the case's own */
    const char *rig_path;  /* NULL: free fall */
    const char *posterior; /* folder of draws, NULL: none */
    int checks;            /* draws to simulate */
    int override_count;    /* at most SF_RUNNER_OVERRIDES - 1: one is used for the speed */
    const char *overrides[SF_RUNNER_OVERRIDES];
    double limit[SF_CFH_CRITERIA]; /* g, - */
    double height;                 /* m, 0: not given */
    double max_height;             /* m */
    int list_count;
    double list[SF_CFH_MAX_POINTS]; /* m, ascending */
    bool max_given, checks_given;
} options;

static sf_status read_override(const char *option, const char *text, void *values, sf_error *err) {
    static const char speed[] = "missile.velocity";
    options *o = values;
    if (strncmp(text + strspn(text, " \t"), speed, strlen(speed)) == 0)
        return SF_REFUSE(err, "%s %s: the drop height decides the speed; --height gives the first one",
                         option, text);
    for (int k = 0; k < o->override_count; k++)
        sf_program_compare_texts(option, o->overrides[k], text);
    if (o->override_count == SF_RUNNER_OVERRIDES - 1)
        return SF_REFUSE(err, "%d %s options" SF_AT_MOST("%d"), SF_RUNNER_OVERRIDES, option,
                         SF_RUNNER_OVERRIDES - 1);
    o->overrides[o->override_count++] = text;
    return SF_OK;
}

static sf_status read_height(const char *option, const char *text, void *value, sf_error *err) {
    double *height = value;
    sf_error reason = SF_ERROR_INIT;
    if (sf_units_read(text, SF_LENGTH, height, &reason) != SF_OK)
        return SF_FAIL(err, reason.status, "%s: %.900s", option, reason.text);
    if (!(*height >= LOWEST_HEIGHT && *height <= GREATEST_HEIGHT))
        return SF_REFUSE(err, "%s: the drop height" SF_OUTSIDE("%s", "1 cm", "%g m"), option, text,
                         GREATEST_HEIGHT);
    return SF_OK;
}

static sf_status read_heights(const char *option, const char *text, void *values, sf_error *err) {
    options *o = values;
    SF_OWNED char *copy = strdup(text);
    char *list = copy;
    const char *item;
    o->list_count = 0;
    if (!copy)
        SF_NO_MEMORY(err, "%s", option);
    while (err->status == SF_OK && (item = strsep(&list, ",")) != NULL) {
        if (o->list_count == SF_CFH_MAX_POINTS)
            return SF_REFUSE(err, "%s: %d heights" SF_AT_MOST("%d"), option, SF_CFH_MAX_POINTS + 1,
                             SF_CFH_MAX_POINTS);
        read_height(option, item + strspn(item, " \t"), &o->list[o->list_count++], err);
    }
    if (err->status == SF_OK && o->list_count < SF_CFH_MIN_POINTS)
        SF_REFUSE(err, "%s: %d heights" SF_AT_LEAST("%d"), option, o->list_count, SF_CFH_MIN_POINTS);
    gsl_sort(o->list, 1, (size_t)o->list_count);
    for (int k = 1; k < o->list_count; k++)
        if (o->list[k] < o->list[k - 1] * (1 + 1e-6))
            SF_REFUSE(err, "%s: %g m is given twice", option, o->list[k]);
    return err->status;
}

/* Refuses options that contradict each other. */
static sf_status check_options(const options *o, sf_error *err) {
    if (o->checks_given && !o->posterior)
        return SF_REFUSE(err, "--check-drops %d: there are no draws to simulate without --posterior",
                         o->checks);
    if (o->list_count && (o->height > 0 || o->max_given))
        return SF_REFUSE(err, "--heights is the whole list: %s does not go with it",
                         o->height > 0 ? "--height" : "--max-height");
    if (o->height > o->max_height)
        return SF_REFUSE(err, "--height of %g m is above the greatest height of %g m", o->height,
                         o->max_height);
    return SF_OK;
}

#define AT(member) offsetof(options, member)
static const sf_option known[] = {
    {"set", 0, "GROUP.KEY=VALUE", "override a key of the case, as softfall-pre does", .read = read_override,
     .group = 1, .repeats = true},
    {"material", 0, "FILE", "another foam: replaces the case's group material", .member = AT(material),
     .group = 1},
    {"limit-g", 0, "G", "limit of a_max in g (default " SF_UNITS_QUOTE(SF_DEFAULT_LIMIT_G) ")",
     .member = AT(limit[SF_CFH_A_MAX]), .read = sf_program_read_limit, .group = 2},
    {"limit-hic", 0, "HIC", "limit of HIC (default " SF_UNITS_QUOTE(SF_DEFAULT_LIMIT_HIC) ")",
     .member = AT(limit[SF_CFH_HIC]), .read = sf_program_read_limit, .group = 2},
    {"height", 0, "LENGTH", "first drop height, e.g. \"1.5 m\" (default: that of the case's velocity)",
     .member = AT(height), .read = read_height, .group = 3},
    {"max-height", 0, "LENGTH", "go no higher (default \"10 m\")", .member = AT(max_height),
     .read = read_height, .group = 3, .noted = AT(max_given)},
    {"heights", 0, "LIST", "these heights instead of a search: \"0.5 m,1 m,1.5 m,2 m\"", .read = read_heights,
     .group = 3},
    {"rig", 0, "CSV",
     "heights are those of a rig with friction: v^2 = 2 g_eff h, with g_eff fitted to the columns h_m "
     "(or height_m) and v_test_m_s (or speed_m_s)",
     .member = AT(rig_path), .group = 3},
    {"posterior", 0, "FOLDER",
     "draws of the foam, draw-001.cfg ..., as softfall-fit drop writes them: gives the interval of the height",
     .member = AT(posterior), .group = 4},
    {"check-drops", 0, "N", "simulate N of the draws to check the columns that stand for them (default 5)",
     .member = AT(checks), .high = SF_CFH_CHECKS, .group = 4, .noted = AT(checks_given)},
    {0},
};

/* ---- the case ---- */

enum { MAX_DROPS = 8 };

/* The figures of the drop before the first simulation. */
typedef struct setting {
    options options; /* first: the values of the command line */
    double speed;    /* m s-1, of the case */
    double mass;     /* kg */
    sf_cfh_foams foams;
    char *text, *parameters; /* of the case; owned */
    char counted[SF_RUNNER_COUNTED];
    sf_material material; /* with --posterior: the case's own; owned, as its law and the draws */
    sf_material_law law;
    sf_cfh_draws draws;
} setting;

static void list_foams(const sf_case *c, sf_cfh_foams *out) {
    *out = (sf_cfh_foams){.count = c->layer_count > 0 ? c->layer_count : 1};
    for (int k = 0; k < out->count; k++) {
        const sf_material *material = c->layer_count > 0 ? &c->layer[k] : &c->material;
        sf_cfh_foam *foam = &out->foam[k];
        memcpy(foam->name, material->name, sizeof foam->name);
        foam->end = material->law->data_end(material->card);
        foam->words = material->law->data_end_words;
    }
}

/* The case's own material and the draws. */
static sf_status read_posterior(const char *case_path, sf_case *c, setting *out, sf_error *err) {
    const options *o = &out->options;
    if (c->layer_count > 0)
        return SF_REFUSE(
            err, "--posterior: its draws are of one material, the pad of %s has layers (materials.%s)",
            case_path, c->layer[0].name);
    out->material = c->material;
    c->material = (sf_material){0}; /* moved */
    SF_TRY(sf_material_law_build(&out->material, &out->law, err));
    return sf_cfh_draws_read(o->posterior, case_path, o->override_count, o->overrides, &out->material,
                             &out->draws, err);
}

/* One height belongs to all drops of a series, and the columns that stand for draws are of a first drop. */
static sf_status check_series(const sf_case *c, bool posterior, sf_error *err) {
    if (c->drops > 1 && posterior)
        return SF_REFUSE(err, "series.drops = %g: --posterior needs columns, which are of a first drop",
                         c->drops);
    for (int k = 0; k < c->drops; k++)
        if (c->drop[k].own)
            return SF_REFUSE(err, "series.drops: drop %d has own keys: drops from one height are alike",
                             k + 1);
    return SF_OK;
}

static sf_status read_setting(const sf_study *study, setting *out, sf_error *err) {
    const options *o = &out->options;
    sf_case c;
    SF_OWNED char *material = NULL;
    const char *list[SF_RUNNER_OVERRIDES + 1];
    int count = 0;
    if (o->material) {
        if (asprintf(&material, "material=@%s", o->material) < 0)
            return SF_NO_MEMORY(err, "the path %s", o->material);
        list[count++] = material;
    }
    for (int k = 0; k < o->override_count; k++)
        list[count++] = o->overrides[k];
    if (sf_case_read(study->input, count, list, &study->sink, &c, err) == SF_OK) {
        out->speed = c.missile_card.speed;
        out->mass = c.missile_card.mass;
        sf_run_counted_text((int)c.drops, c.counted, out->counted, sizeof out->counted);
        out->text = c.text;
        out->parameters = c.parameters;
        list_foams(&c, &out->foams);
        c.text = c.parameters = NULL; /* moved */
        if (!sf_missile_card_is_vertical(&c.missile_card))
            SF_REFUSE(err, "missile.direction is not [0, 0, -1]: a drop height belongs to a vertical fall");
        else if (check_series(&c, o->posterior, err) == SF_OK && o->posterior)
            read_posterior(study->input, &c, out, err);
        sf_case_free(&c);
    }
    return err->status;
}

/* The options' heights, those of the rig if there is one, as heights of free fall. */
static sf_cfh_plan make_plan(const options *o, const sf_cfh_rig *rig, const setting *s) {
    double unit = 1 / sf_cfh_rig_height(rig, 1);
    sf_cfh_plan plan = {.max_height = o->max_height * unit,
                        .max_drops = MAX_DROPS,
                        .list_count = o->list_count,
                        .unit = unit};
    memcpy(plan.limit, o->limit, sizeof plan.limit);
    plan.first = o->height > 0 ? o->height * unit : sf_cfh_free_fall_height(s->speed);
    plan.first = fmin(plan.first, plan.max_height);
    for (int k = 0; k < o->list_count; k++)
        plan.list[k] = o->list[k] * unit;
    return plan;
}

static sf_status write_output(sf_study *study, const sf_cfh_report *report, sf_error *err) {
    char warning[512] = "", draws[SF_CFH_NOTE_SIZE] = "";
    sf_staging *output = &study->output;
    SF_TRY(sf_cfh_write_csv(output, report, err));
    SF_TRY(sf_cfh_write_draws(output, report, err));
    SF_TRY(sf_cfh_write_json(output, report, err));
    SF_TRY(sf_cfh_plot(output, report, warning, sizeof warning, err));
    SF_TRY(sf_cfh_write_page(output, report, err));
    SF_TRY(sf_staging_commit(output, err));
    sf_cfh_print(stdout, report);
    sf_study_close(study,
                   *warning ? "report.html, cfh.json, cfh.csv" : "report.html, cfh.json, cfh.csv, cfh.png",
                   warning);
    for (int k = 0; k < report->points->count; k++)
        if (report->points->point[k].note[0])
            sf_sink_tell(&study->sink, SF_WARNING, "at %.3f m: %s", report->points->point[k].height,
                         report->points->point[k].note);
    if (report->spread)
        sf_cfh_draws_text(report->spread, draws, sizeof draws);
    if (draws[0])
        sf_sink_tell(&study->sink, SF_WARNING, "%s", draws);
    if (report->spread && !report->spread->with_response)
        sf_sink_tell(&study->sink, SF_WARNING, "%s", sf_cfh_response_text(report->spread));
    if (report->no_interval[0])
        sf_sink_tell(&study->sink, SF_WARNING, "no interval: %s", report->no_interval);
    return SF_OK;
}

/* The interval: columns of every draw, checks of some, random errors. */
static sf_status find_interval(sf_study *study, const setting *s, const sf_cfh_series *series,
                               sf_cfh_report *report, sf_cfh_spread *spread, sf_error *err) {
    const options *o = &s->options;
    sf_error problem = SF_ERROR_INIT;
    if (!o->posterior)
        return SF_OK;
    if (series->pad->columns.count == 0) {
        snprintf(report->no_interval, sizeof report->no_interval, "no simulated drop has figures");
        return SF_OK;
    }
    omp_set_num_threads(study->threads);
    sf_log_print(stdout, "%d draws of %s as columns, then at most %d of them simulated\n", s->draws.count,
                 o->posterior, o->checks);
    if (sf_cfh_spread_build(series->pad, &s->draws, &s->law, report->points, report->result,
                            report->plan->limit, spread, &problem) == SF_ERR_NUMERIC) {
        snprintf(report->no_interval, sizeof report->no_interval, "%s", problem.text);
        return SF_OK;
    }
    if (problem.status != SF_OK) {
        *err = problem;
        return err->status;
    }
    sf_cfh_spread_choose(spread, o->checks, 1e-3 * report->plan->unit);
    SF_TRY(sf_cfh_simulate_checks(series, &s->draws, &study->runner, spread, err));
    SF_TRY(sf_cfh_spread_evaluate(spread, report->rig, err));
    report->spread = spread;
    return SF_OK;
}

static sf_status simulate(sf_study *study, const setting *s, sf_cfh_report *report, sf_cfh_points *points,
                          sf_cfh_result *result, sf_cfh_spread *spread, sf_error *err) {
    const options *o = &s->options;
    sf_study_run_apart(study);
    sf_runner_drop base = {
        .case_path = study->input, .material = o->material, .override_count = o->override_count};
    memcpy(base.overrides, o->overrides, sizeof base.overrides);
    sf_cfh_pad pad = {.mesh_error = NAN};
    const sf_cfh_series series = {report->plan, report->rig, &base, report->foams,
                                  o->posterior ? &pad : NULL};
    sf_log_print(stdout, "%s %d drops, kept in %s; heights %s\n", o->list_count ? "The" : "At most",
                 o->list_count ? o->list_count : SF_CFH_MAX_POINTS, study->runs,
                 report->rig->pairs ? "on the rig" : "of free fall");
    SF_TRY(sf_cfh_simulate(&series, &study->runner, points, &report->ending, err));
    sf_cfh_evaluate(points, report->plan->limit, result);
    return find_interval(study, s, &series, report, spread, err);
}

/* Every file that this program writes; cfh.json last, so that it speaks of files that are there. */
static const char *const output_names[] = {"cfh.csv",       "cfh_band.csv", "cfh_curves.csv",
                                           "cfh_draws.csv", "cfh.gp",       "cfh.png",
                                           "report.html",   "cfh.json",     NULL};

static sf_status run(sf_study *study, void *own, sf_error *err) {
    setting *s = own;
    options *o = &s->options;
    sf_cfh_rig rig = sf_cfh_free_fall();
    sf_cfh_points points = {0};
    sf_cfh_result result;
    SF_OWNED_BY(sf_cfh_spread_free) sf_cfh_spread spread = {0};
    SF_TRY(check_options(o, err));
    SF_TRY(sf_study_check(study, output_names, err));
    if ((o->rig_path && sf_cfh_rig_read(o->rig_path, &rig, err) != SF_OK) ||
        read_setting(study, s, err) != SF_OK)
        return err->status;
    if (rig.interpretation[0])
        printf("rig %s: %s, %d pairs\n", o->rig_path, rig.interpretation, rig.pairs);
    const sf_cfh_plan plan = make_plan(o, &rig, s);
    sf_cfh_report report = {.case_path = study->input,
                            .material = o->material,
                            .command_line = study->command,
                            .rig_path = o->rig_path,
                            .posterior = o->posterior,
                            .plan = &plan,
                            .rig = &rig,
                            .points = &points,
                            .result = &result,
                            .case_text = s->text,
                            .parameters = s->parameters,
                            .mass = s->mass,
                            .foams = &s->foams};
    memcpy(report.counted, s->counted, sizeof report.counted);
    if (sf_study_begin(study, output_names, err) == SF_OK &&
        simulate(study, s, &report, &points, &result, &spread, err) == SF_OK &&
        write_output(study, &report, err) == SF_OK && result.verdict == SF_CFH_UNKNOWN)
        *err = result.problem;
    return err->status;
}

static const sf_study_program program = {
    .name = "softfall-cfh",
    .argument = "CASE",
    .doc = "Critical fall height of a pad: the lowest drop height at which a_max or HIC reaches its limit "
           "(--limit-g, --limit-hic).\vSimulates up to 8 drops with softfall-pre and softfall-solve, with "
           "--posterior 5 more, and writes cfh.json, cfh.csv, cfh.png (and .gp) and report.html. After an "
           "interruption run the same "
           "command again to resume. The height is indicative, not a certification.",
    .drops = true,
    .options = known,
    .run = run,
};

int main(int argc, char **argv) {
    setting s = {.options = {.limit = {SF_DEFAULT_LIMIT_G, SF_DEFAULT_LIMIT_HIC},
                             .max_height = DEFAULT_MAX_HEIGHT,
                             .checks = DEFAULT_CHECKS}};
    int code = sf_study_main(argc, argv, &program, &s);
    SF_FREE(s.text, s.parameters);
    sf_cfh_draws_free(&s.draws);
    sf_material_law_free(&s.law);
    sf_material_free(&s.material);
    return code;
}
