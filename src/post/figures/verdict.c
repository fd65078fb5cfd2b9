/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "post/figures/verdict.h"

#include "base/text.h"
#include <string.h>

const char *sf_verdict_phrase(sf_grade grade) {
    static const char *const phrases[] = {"valid", "valid with remarks", "do not use"};
    return phrases[grade];
}

/* ---- the value of each check; NaN: not defined ---- */

static double ending_value(const sf_results *r, const sf_figures *f) {
    if (!f->touched)
        return 2;
    if (!r->has_summary || strcmp(r->status, "interrupted") == 0)
        return 1;
    return sf_results_ended_well(r) ? 0 : 2;
}

static double ended_in_contact_value(const sf_results *r, const sf_figures *f) {
    (void)r;
    if (!f->touched || f->driven)
        return NAN;
    if (f->rebounded)
        return 0;
    double left = f->raw.value[f->raw.count - 1] / f->injury.a_max_g;
    return fmax(left, 1e-6); /* still in contact: never 0 */
}

static bool has_step_artefact(const sf_figures *f) {
    return f->raw_peak_rows > 0 && f->raw_peak_rows < 3;
}

static double filter_value(const sf_results *r, const sf_figures *f) {
    (void)r;
    if (has_step_artefact(f) || f->driven || !(f->injury.a_max_g > 0))
        return NAN;
    return f->injury_raw.a_max_g / f->injury.a_max_g - 1;
}

static double notes_value(const sf_results *r, const sf_figures *f) {
    (void)f;
    int count = 0;
    for (int k = 0; k < r->note_count; k++)
        count += !r->note_of_ending[k];
    return count;
}

/* Checks whose value is a member of the results or the figures, or a short expression of them. */
#define SHORT_VALUE(name, expression)                                                                        \
    static double name##_value(const sf_results *r, const sf_figures *f) {                                   \
        (void)r, (void)f;                                                                                    \
        return expression;                                                                                   \
    }
SHORT_VALUE(energy_error, f->energy_error)
SHORT_VALUE(momentum, fmax(fabs(f->momentum_error),
                           fmax(fabs(f->momentum_error_space), fabs(f->angular_momentum_error))))
SHORT_VALUE(stabilisation, f->stabilisation_energy_fraction)
SHORT_VALUE(contact, f->contact_energy_fraction)
SHORT_VALUE(dissipation, f->negative_dissipation)
SHORT_VALUE(vibration, f->vibration_energy_fraction)
SHORT_VALUE(step_artefact, f->driven || !f->touched ? NAN : has_step_artefact(f))
SHORT_VALUE(coarse, isnan(f->local_strain_excess) ? NAN : fmax(0, -f->local_strain_excess))
SHORT_VALUE(local_collapse, f->local_collapse)
SHORT_VALUE(mesh, f->a_max_mesh_error)
SHORT_VALUE(slit, r->slit_fraction)
SHORT_VALUE(informed, f->energy_beyond_data)
SHORT_VALUE(edge, fmax(fabs(f->a_max_by_speed), fabs(f->a_max_by_thickness)))
SHORT_VALUE(anvil, f->max_mean_strain)
SHORT_VALUE(rim, fmax(f->cut.share, f->cut.spacing > 0 ? f->max_penetration / f->cut.spacing : 0))
SHORT_VALUE(below_anvil, f->below_anvil / r->thickness)
#undef SHORT_VALUE

typedef double (*value_of)(const sf_results *results, const sf_figures *figures);
#define VALUE(name, ...) name##_value,
static const value_of values[SF_CHECKS] = {SF_GOOD_RUN(VALUE)};
#undef VALUE

/* ---- rows ---- */

/* A value as a sentence shows it. */
static void show(double value, bool percent, char text[32]) {
    snprintf(text, 32, percent ? "%.3g %%" : "%.3g", percent ? 100 * value : value);
}

void sf_check_judge(sf_check *c, bool percent) {
    double size = fabs(c->value);
    char value[32], bound[32];
    c->grade = size > c->bound ? SF_GRADE_REMARKS : SF_GRADE_VALID;
    if (size > c->use_bound)
        c->grade = SF_GRADE_DO_NOT_USE;
    bool refused = c->grade == SF_GRADE_DO_NOT_USE;
    show(c->value, percent, value);
    show(refused ? c->use_bound : c->bound, percent, bound);
    snprintf(c->text, sizeof c->text, "%s %s (%s %s)", c->title, value,
             refused ? "not to be used beyond" : "good up to", bound);
}

/* True of a check that says yes or no: a sentence shows no numbers of it. */
static bool is_flag(const sf_check *check) {
    return check->key == sf_good_run_rule_get(SF_CHECK_step_artefact)->key;
}

/* The first note that does not only repeat the row `ending`. */
static const char *first_note(const sf_results *r) {
    int k = 0;
    while (k + 1 < r->note_count && r->note_of_ending[k])
        k++;
    return r->notes[k];
}

/* The sentence of solver/run/run.c is the reason, not only a failure. */
static bool ended_on_anvil(const sf_results *r) {
    static const char reason[] = SF_ENDED_ON_ANVIL;
    return r->has_summary && strncmp(r->status, reason, sizeof reason - 1) == 0;
}

static const char *describe_ending(const sf_results *r, const sf_figures *f, bool failed) {
    if (ended_on_anvil(r))
        return r->status;
    if (!f->touched)
        return "the missile never touched the pad";
    if (!r->has_summary)
        return "the run has no end: it still runs or was killed";
    return failed ? "the run failed" : "the run was interrupted";
}

/* Writes the findings that are not only a value and its bound. */
static void describe(const sf_results *r, const sf_figures *f, sf_check *c) {
    if (c->grade != SF_GRADE_VALID && c->key == sf_good_run_rule_get(SF_CHECK_notes)->key)
        snprintf(c->text, sizeof c->text, "%.0f of the programs' notes, the first: %.*s", c->value,
                 sf_utf8_cut(first_note(r), 200), first_note(r));
    else if (c->grade != SF_GRADE_VALID && c->key == sf_good_run_rule_get(SF_CHECK_ending)->key)
        snprintf(c->text, sizeof c->text, "%.250s", describe_ending(r, f, c->value > c->use_bound));
    else if (isnan(c->value) && f->turns && c->key == sf_good_run_rule_get(SF_CHECK_edge)->key)
        snprintf(c->text, sizeof c->text,
                 "edge and scatter: not estimated of a free missile, as the estimate knows no rotation");
    else if (isnan(c->value))
        snprintf(c->text, sizeof c->text, "%s: not defined by this run", c->title);
    else if (is_flag(c))
        snprintf(c->text, sizeof c->text, "the raw peak is %s",
                 c->value > 0 ? "one or two time steps long" : "longer than two time steps");
    if (c->grade != SF_GRADE_VALID && c->key == sf_good_run_rule_get(SF_CHECK_rim)->key)
        sf_text_add(c->text, sizeof c->text, ", at (%.4g, %.4g, %.4g) mm: take a finer mesh there",
                    1e3 * f->cut.place[0], 1e3 * f->cut.place[1], 1e3 * f->cut.place[2]);
}

static void fill_row(int k, const sf_results *r, const sf_figures *f, sf_check *c) {
    const sf_good_run_rule *rule = sf_good_run_rule_get(k);
    *c = (sf_check){.key = rule->key,
                    .title = rule->title,
                    .why = rule->why,
                    .unit = "1",
                    .value = values[k](r, f),
                    .bound = rule->remark,
                    .use_bound = rule->refuse};
    sf_check_judge(c, rule->percent);
    describe(r, f, c);
}

const char *sf_limit_phrase(const sf_limit *limit) {
    if (!limit->judged)
        return "not judged";
    return limit->passed ? "passed" : "failed";
}

/* Peak and HIC window may lie in the part of the drop that was not computed. */
static bool ended_early(const sf_verdict *v, const sf_figures *f) {
    const sf_check *ending = &v->rows[SF_CHECK_ending];
    return ending->grade == SF_GRADE_DO_NOT_USE ||
           v->rows[SF_CHECK_ended_in_contact].grade == SF_GRADE_DO_NOT_USE ||
           (ending->grade != SF_GRADE_VALID && !f->rebounded);
}

static sf_limit limit_of(const char *key, const char *title, const char *unit, double value, double bound,
                         bool whole) {
    bool judged = whole && isfinite(value);
    return (sf_limit){key, title, unit, value, bound, judged, judged && value <= bound};
}

/* Up to this many times its bound a part of a_max is sure: how much a_max errs beyond was never measured. */
static const double SURE_TO = 3;

void sf_verdict_compute(const sf_results *results, const sf_figures *figures, const sf_limits *limits,
                        sf_verdict *verdict) {
    *verdict = (sf_verdict){.count = SF_CHECKS, .sure = 1};
    for (int k = 0; k < SF_CHECKS; k++) {
        sf_check *row = &verdict->rows[k];
        fill_row(k, results, figures, row);
        if (row->grade > verdict->grade)
            verdict->grade = row->grade;
        const sf_good_run_rule *rule = sf_good_run_rule_get(k);
        bool known = rule->sure == 1 || fabs(row->value) <= SURE_TO * rule->refuse;
        if (row->grade == SF_GRADE_DO_NOT_USE)
            verdict->sure = fmin(verdict->sure, known ? rule->sure : 0);
    }
    if (figures->driven)
        return;
    verdict->limit_count = SF_LIMITS;
    const sf_injury *injury = &figures->injury;
    bool whole = !ended_early(verdict, figures) && verdict->grade != SF_GRADE_DO_NOT_USE;
    verdict->limits[0] = limit_of("a_max_g", "a_max", "g", injury->a_max_g, limits->a_max_g, whole);
    verdict->limits[1] = limit_of("hic", "HIC", "1", injury->hic.value, limits->hic, whole);
}

void sf_check_line(sf_grade grade, int count, const sf_check *rows, int shown, char *text, size_t size) {
    int found = 0;
    snprintf(text, size, "%s", sf_verdict_phrase(grade));
    for (int bad = SF_GRADE_DO_NOT_USE; bad > SF_GRADE_VALID; bad--)
        for (int k = 0; k < count; k++)
            if (rows[k].grade == (sf_grade)bad && found++ < shown)
                sf_text_add(text, size, "%s%s", found == 1 ? ": " : "; ", rows[k].text);
    if (found > shown)
        sf_text_add(text, size, "; and %d more", found - shown);
}

void sf_verdict_line(const sf_verdict *verdict, char *text, size_t size) {
    sf_check_line(verdict->grade, verdict->count, verdict->rows, 3, text, size);
}
