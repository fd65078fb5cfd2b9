/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/sweep/adaptive.h"

#include "io/process.h"
#include "study/sweep/analysis.h"
#include <gsl/gsl_statistics.h>

enum {
    DRAWN_PART = 40, /* one row of so many is drawn for the first round, within bounds */
    LEAST_DRAWN = 20,
    MOST_DRAWN = 32,
    DESIGN_PER_INPUT = 4, /* further rows of the first round */
    LEAST_POINTS = 6,     /* of a process */
    SAMPLE = 2000,        /* open rows that a round looks at */
    DESIGN_SAMPLE = 20000,
    ROUND_PART = 6,     /* a round simulates one row for so many that are there */
    MOST_POINTS = 3000, /* of a process: 72 MB and 10 s a fit, of a figure eight more */
    MANY_ROWS = 10000   /* whose columns take half a minute */
};

/* Quantities that tell whether the figures of a row can be used, and the sentence of a row in which they
 * probably cannot. */
enum { WATCH_STRAIN, WATCH_DATA, WATCH_CONTACT, WATCH_DISSIPATION, WATCH_USE, WATCHED };
static const struct {
    const char *what, *left_open;
    int trend;          /* of columns; -1: none */
    const char *figure; /* that a check of the run refuses; NULL: another quantity */
    int check;
} watched[WATCHED] = {
    [WATCH_STRAIN] = {"the strain", "not simulated: its missile is expected to reach the anvil",
                      SF_TREND_STRAIN, "max_mean_strain", SF_CHECK_anvil},
    [WATCH_DATA] = {"the energy beyond the foam's data",
                    "not simulated: it is expected to be beyond the data of the foam", SF_TREND_BEYOND,
                    "energy_beyond_data", SF_CHECK_informed},
    [WATCH_CONTACT] = {"the time of contact",
                       "not simulated: its run is expected to end in contact: give a longer solver.end_time",
                       SF_TREND_CONTACT, NULL, 0},
    [WATCH_DISSIPATION] = {"the energy given back by what dissipates",
                           "not simulated: what dissipates is expected to give back too much energy", -1,
                           "negative_dissipation", SF_CHECK_dissipation},
    [WATCH_USE] = {"the verdict", "not simulated: it is expected to have no usable figures", -1, NULL, 0}};
enum { TARGETS = SF_SWEEP_FIGURES + WATCHED, INPUTS = SF_SWEEP_FACTORS + SF_TREND_INDENTATION };
enum { COARSE_INPUTS = 5 }; /* the first outputs of coarse drops */
_Static_assert(INPUTS <= (int)SF_PREDICTOR_INPUTS, "a process has room for all inputs");
static const double COLLAPSED =
    1.5; /* scaled figure of columns that collapse: outside of those of all others */
static const double LIKELY = 0.52;   /* standard deviations beyond a bound: an expectation of 70 % */
static const double LEAST_PART = 0.1; /* of the accuracy asked for: no interval is narrower */
static const double UNUSABLE = 0.5;

struct sf_sweep_adaptive {
    const sf_plan *plan;
    const char *drops;
    int jobs;
    FILE *log;
    int factors, factor[SF_SWEEP_FACTORS]; /* those that vary */
    int inputs;                            /* these, and of a plan with columns their figures */
    bool word[INPUTS];
    double low[INPUTS], range[INPUTS];
    bool *drawn;                /* [rows] random rows, which are simulated first; owned */
    int held[SF_SWEEP_FIGURES]; /* simulated rows that were predicted from others, in their intervals */
    sf_sweep_trend trend;
    double *expected; /* [rows][SF_TRENDS] of the columns; NULL: not yet computed; owned */
    const struct sf_sweep_adaptive *coarse; /* NULL: there are no coarse drops; borrowed, like the next */
    const sf_runs *coarse_runs;
    double *base,
        *doubt; /* [rows][TARGETS] outputs of the coarse drops and their standard deviations; owned */
    int targets;                 /* figures of the plan, and WATCHED */
    sf_predictor model[TARGETS]; /* the plan's figures, then those that are watched */
    double farthest[TARGETS];    /* largest expectation of the rows that a model has learnt from */
    bool all;                    /* too few rows can be used: every row is simulated */
};

/* Judgement of an open row by the processes. */
typedef struct outlook {
    double ratio; /* of the largest standard deviation to its wish; at most one: the row is predicted */
    int target;   /* of that */
    double wish;  /* standard deviation of the target that meets it */
    int unusable; /* quantity by which it probably cannot be used; WATCHED: none */
    double value[SF_SWEEP_FIGURES], half[SF_SWEEP_FIGURES]; /* of the logarithm */
} outlook;

/* ---- inputs ---- */

static void list_inputs(sf_sweep_adaptive *a) {
    const sf_plan *p = a->plan;
    for (int f = 0; f < p->factor_count; f++) {
        double low, high;
        gsl_stats_minmax(&low, &high, p->factor[f].value, 1, (size_t)p->block[p->block_of[f]].rows);
        if (!(high > low))
            continue;
        a->word[a->factors] = p->factor[f].words;
        a->low[a->factors] = low;
        a->range[a->factors] = p->factor[f].words ? 1 : high - low;
        a->factor[a->factors++] = f;
    }
    a->inputs = a->factors;
}

/* The k-th figure of the columns, or of the coarse drops. */
static double figure_of(const sf_sweep_adaptive *a, int64_t row, int k) {
    return a->coarse ? a->base[row * TARGETS + k] : a->expected[row * SF_TRENDS + k];
}

/* Makes these figures inputs, too: foams, which differ as words, are near by them. */
static void add_figures(sf_sweep_adaptive *a) {
    int count = a->coarse ? COARSE_INPUTS : a->trend.problem ? 0 : SF_TREND_INDENTATION;
    for (int k = 0; k < count; k++) {
        double low = INFINITY, high = -INFINITY;
        for (int64_t row = 0; row < a->plan->rows; row++) {
            low = fmin(low, figure_of(a, row, k));
            high = fmax(high, figure_of(a, row, k));
        }
        a->low[a->factors + k] = low;
        a->range[a->factors + k] = high > low ? high - low : 1;
        a->inputs = a->factors + k + 1;
    }
}

static void put_inputs(const sf_sweep_adaptive *a, int64_t row, double *x) {
    for (int i = 0; i < a->factors; i++)
        x[i] = (sf_plan_value(a->plan, a->factor[i], row) - a->low[i]) / a->range[i];
    for (int i = a->factors; i < a->inputs; i++) {
        double value = (figure_of(a, row, i - a->factors) - a->low[i]) / a->range[i];
        x[i] = isfinite(value) ? value : COLLAPSED;
    }
}

/* ---- the first round ---- */

static int64_t count_drawn(const sf_plan *plan) {
    int64_t count = plan->rows / DRAWN_PART;
    count = count < LEAST_DRAWN ? LEAST_DRAWN : count > MOST_DRAWN ? MOST_DRAWN : count;
    return count < plan->rows ? count : plan->rows;
}

int64_t sf_sweep_adaptive_design(const sf_plan *plan) {
    int64_t count = count_drawn(plan) + DESIGN_PER_INPUT * plan->factor_count;
    return count < plan->rows ? count : plan->rows;
}

static bool is_simulated(const sf_runs *runs, int64_t row) {
    return runs->state[row] == SF_SWEEP_DONE || runs->state[row] == SF_SWEEP_FAILED;
}

static double distance(const sf_sweep_adaptive *a, const double *p, const double *q) {
    double sum = 0;
    for (int i = 0; i < a->inputs; i++)
        sum += a->word[i] ? p[i] != q[i] : (p[i] - q[i]) * (p[i] - q[i]);
    return sum;
}

/* Up to `most` open rows, each as far as can be from all that are there and that were chosen before it: every
 * `step`-th row is looked at. */
static int choose_apart(const sf_sweep_adaptive *a, const sf_runs *runs, int most, int64_t *row,
                        sf_error *err) {
    int64_t step = (runs->count + DESIGN_SAMPLE - 1) / DESIGN_SAMPLE, n = (runs->count + step - 1) / step;
    int count = 0;
    SF_OWNED double *x = sf_alloc(err, n, (unsigned long)(a->inputs + 1) * sizeof *x, "rows");
    if (!x)
        return 0;
    double *apart = x + n * a->inputs, own[INPUTS];
    for (int64_t k = 0; k < n; k++) {
        put_inputs(a, k * step, x + k * a->inputs);
        apart[k] = runs->state[k * step] == SF_SWEEP_OPEN ? a->inputs + 1 : -1;
    }
    for (int64_t r = 0; r < runs->count; r++) {
        if (!is_simulated(runs, r))
            continue;
        put_inputs(a, r, own);
        for (int64_t k = 0; k < n; k++)
            apart[k] = fmin(apart[k], distance(a, own, x + k * a->inputs));
    }
    while (count < most) {
        int64_t best = 0;
        for (int64_t k = 1; k < n; k++)
            best = apart[k] > apart[best] ? k : best;
        if (apart[best] < 0)
            break;
        row[count++] = best * step;
        for (int64_t k = 0; k < n; k++)
            apart[k] = k == best ? -1 : fmin(apart[k], distance(a, x + best * a->inputs, x + k * a->inputs));
    }
    return count;
}

/* ---- what the rows are expected to be ---- */

/* Returns what columns or coarse drops have for the output of a target; 0: columns have no such figure; NaN:
 * the figures of the coarse drop cannot be used. */
static double expected_of(const sf_sweep_adaptive *a, int target, int64_t row) {
    int k = target - a->plan->figure_count,
        at = k < 0 ? sf_sweep_trend_find(a->plan->figure[target].figure) : watched[k].trend;
    if (a->coarse)
        return a->base[row * TARGETS + target];
    double expected = at < 0 ? 0 : a->expected[row * SF_TRENDS + at];
    return k == WATCH_STRAIN ? exp(expected) : expected;
}

/* True of a row that can be used and defines every figure of the plan. */
static bool has_figures(const sf_runs *runs, int64_t row) {
    bool all = true;
    for (int k = 0; k < runs->plan->figure_count; k++)
        all &= isfinite(sf_runs_value(runs, row, k));
    return all;
}

/* The output of what is watched from which a row cannot be used. */
static double bound_of(const sf_sweep_adaptive *a, int k, int64_t row) {
    return watched[k].figure    ? sf_good_run_rule_get(watched[k].check)->refuse
           : k == WATCH_CONTACT ? a->expected[row * SF_TRENDS + SF_TREND_TIME]
                                : UNUSABLE;
}

/* True of a row without figures if a process of what is watched besides the verdict tells why. */
static bool is_told(const sf_sweep_adaptive *a, const sf_runs *runs, int64_t row) {
    const double *place = sf_runs_place(runs, row);
    const sf_predictor *model = a->model + a->plan->figure_count;
    for (int k = 0; k < WATCHED; k++)
        if (watched[k].figure && model[k].count > 0 &&
            place[sf_runs_figure(watched[k].figure)] >= bound_of(a, k, row))
            return true;
    return model[WATCH_CONTACT].count > 0 && sf_runs_usable(runs, row) &&
           isnan(place[sf_runs_figure("rebound_time_ms")]);
}

/* The output of a target at a row that was simulated: of a figure and the time of contact the logarithm, of
 * the use 0 or 1. NaN: the row has none. */
static double output_of(const sf_sweep_adaptive *a, const sf_runs *runs, int target, int64_t row) {
    const double *place = sf_runs_place(runs, row);
    int k = target - a->plan->figure_count;
    if (k < 0)
        return log(sf_runs_value(runs, row, target));
    if (watched[k].figure) {
        double value = place[sf_runs_figure(watched[k].figure)], most = 2 * bound_of(a, k, row);
        return value > most ? most : value; /* one run that has gone wrong does not hide the others */
    }
    if (k == WATCH_CONTACT)
        return log(place[sf_runs_figure("rebound_time_ms")] - place[sf_runs_figure("contact_time_ms")]);
    return is_told(a, runs, row) ? NAN : !has_figures(runs, row);
}

/* Finds the output of a target by the coarse drop of a row, which tells nothing of the use; NaN: there is
 * none. What is watched is also known of coarse rows that were not simulated. */
static void take_coarse(const sf_sweep_adaptive *a, int target, int64_t row) {
    const sf_sweep_adaptive *c = a->coarse;
    int k = target - a->plan->figure_count;
    double *value = &a->base[row * TARGETS + target], *doubt = &a->doubt[row * TARGETS + target], x[INPUTS],
           room[MOST_POINTS];
    *value = k == WATCH_USE                               ? 0
             : k < 0 || is_simulated(a->coarse_runs, row) ? output_of(c, a->coarse_runs, target, row)
                                                          : NAN;
    *doubt = k < 0 ? sf_runs_half(a->coarse_runs, row, target) / SF_PREDICTOR_SIDES : 0;
    if (k < 0 || isfinite(*value) || c->model[target].count == 0)
        return;
    put_inputs(c, row, x);
    sf_predictor_at(&c->model[target], x, room, value, doubt);
    *value += expected_of(c, target, row);
}

static sf_status expect_coarse(sf_sweep_adaptive *a, sf_error *err) {
    a->base = sf_alloc(err, a->plan->rows, TARGETS * sizeof *a->base, "coarse rows");
    a->doubt = sf_alloc(err, a->plan->rows, TARGETS * sizeof *a->doubt, "coarse rows");
    for (int64_t row = 0; row < a->plan->rows && err->status == SF_OK; row++)
        for (int t = 0; t < a->targets; t++)
            take_coarse(a, t, row);
    return err->status;
}

static sf_status expect(sf_sweep_adaptive *a, const sf_runs *runs, sf_error *err) {
    if (a->expected)
        return SF_OK;
    if (a->coarse) {
        a->trend = (sf_sweep_trend){.plan = a->plan, .problem = "coarse drops stand in their place"};
        SF_TRY(expect_coarse(a, err));
    } else {
        SF_TRY(sf_sweep_trend_learn(runs, a->drops, &a->trend, err));
    }
    a->expected = sf_alloc(err, runs->count, SF_TRENDS * sizeof *a->expected, "columns of the rows");
    if (runs->count > MANY_ROWS)
        sf_log_print(a->log, "  %lld rows are read, and their columns computed\n", (long long)runs->count);
    for (int64_t row = 0; row < runs->count && err->status == SF_OK; row++) {
        if (sf_process_stopped())
            return SF_FAIL(err, SF_INTERRUPTED, "interrupted");
        sf_sweep_trend_at(&a->trend, row, a->expected + row * SF_TRENDS, err);
    }
    if (err->status == SF_OK)
        add_figures(a);
    if (a->log && err->status == SF_OK && a->trend.problem)
        fprintf(a->log, "  rows are predicted without columns: %s\n", a->trend.problem);
    return err->status;
}

/* Returns what a process learns: the output over what is expected of it. */
static double excess_of(const sf_sweep_adaptive *a, const sf_runs *runs, int target, int64_t row) {
    return output_of(a, runs, target, row) - expected_of(a, target, row);
}

static void free_models(sf_sweep_adaptive *a) {
    for (int t = 0; t < TARGETS; t++)
        sf_predictor_free(&a->model[t]);
}

/* Fits one process; of too many points the last ones of the list are left out. */
static sf_status fit_target(sf_sweep_adaptive *a, const sf_runs *runs, int target, sf_error *err) {
    SF_OWNED double *x = sf_alloc(err, MOST_POINTS, (unsigned long)(a->inputs + 1) * sizeof *x, "rows");
    bool is_figure = target < a->plan->figure_count;
    int n = 0;
    a->farthest[target] = -INFINITY;
    if (is_figure)
        a->held[target] = 0;
    SF_TRY(err->status);
    double *y = x + (int64_t)MOST_POINTS * a->inputs;
    for (int64_t row = 0; row < runs->count && n < MOST_POINTS; row++) {
        double value = is_simulated(runs, row) ? excess_of(a, runs, target, row) : NAN;
        if (!isfinite(value))
            continue;
        a->farthest[target] = fmax(a->farthest[target], expected_of(a, target, row));
        put_inputs(a, row, x + (int64_t)n * a->inputs);
        y[n++] = value;
    }
    if (n < LEAST_POINTS) {
        a->all |= is_figure;
        return SF_OK;
    }
    SF_TRY(sf_predictor_fit(a->inputs, a->word, n, x, y, &a->model[target], err));
    return is_figure ? sf_predictor_validate(&a->model[target], y, &a->held[target], err) : SF_OK;
}

static sf_status fit_models(sf_sweep_adaptive *a, const sf_runs *runs, sf_error *err) {
    bool before = a->all;
    free_models(a);
    a->all = a->inputs == 0;
    for (int t = 0; t < a->targets && !a->all && err->status == SF_OK; t++)
        fit_target(a, runs, t, err);
    if (a->all && !before && a->log)
        fputs("  every row is simulated: too few of the drops have all figures to predict from\n", a->log);
    return err->status;
}

/* ---- outlook of a row ---- */

/* Mean and standard deviation of the output of a target at a row. */
static void predict(const sf_sweep_adaptive *a, int target, int64_t row, const double *x, double *mean,
                    double *deviation) {
    double room[MOST_POINTS];
    sf_predictor_at(&a->model[target], x, room, mean, deviation);
    *mean += expected_of(a, target, row);
    *deviation = a->coarse ? hypot(*deviation, a->doubt[row * TARGETS + target]) : *deviation;
    /* drops that are all within the data tell nothing beyond */
    if (target == a->plan->figure_count + WATCH_DATA)
        *deviation = fmax(*deviation, expected_of(a, target, row) - a->farthest[target]);
}

/* The target whose standard deviation is the largest over its wish decides. */
static void hold_against(const sf_sweep_adaptive *a, int64_t row, outlook *o, int target, double ratio,
                         double wish) {
    double doubt = a->coarse ? a->doubt[row * TARGETS + target] : 0;
    if (ratio > o->ratio) {
        o->ratio = ratio;
        o->target = target;
        o->wish = sqrt(fmax(0, wish * wish - doubt * doubt));
    }
}

static void judge_figure(const sf_sweep_adaptive *a, int target, int64_t row, const double *x, outlook *o) {
    double mean, deviation, wish = log1p(a->plan->figure[target].accuracy) / SF_PREDICTOR_SIDES;
    predict(a, target, row, x, &mean, &deviation);
    o->value[target] = exp(mean);
    o->half[target] = SF_PREDICTOR_SIDES * fmax(deviation, LEAST_PART * wish);
    hold_against(a, row, o, target, isfinite(o->value[target]) ? deviation / wish : INFINITY, wish);
}

static void judge_use(const sf_sweep_adaptive *a, int k, int64_t row, const double *x, outlook *o) {
    int target = a->plan->figure_count + k;
    double mean, deviation, bound = bound_of(a, k, row);
    predict(a, target, row, x, &mean, &deviation);
    double sides = mean > bound ? LIKELY : SF_PREDICTOR_SIDES,
           margin = fmax(1e-12, fabs(bound - mean)) / sides;
    if (mean > bound && deviation <= margin)
        o->unusable = k;
    hold_against(a, row, o, target, isnan(bound - mean) ? INFINITY : deviation / margin, margin);
}

static outlook judge(const sf_sweep_adaptive *a, int64_t row) {
    double x[INPUTS];
    outlook o = {.unusable = WATCHED};
    put_inputs(a, row, x);
    for (int k = 0; k < WATCHED; k++)
        if (a->model[a->plan->figure_count + k].count > 0)
            judge_use(a, k, row, x, &o);
    for (int t = 0; t < a->plan->figure_count; t++)
        judge_figure(a, t, row, x, &o);
    if (o.unusable < WATCHED)
        o.ratio = 0;
    return o;
}

/* Judges `count` rows, side by side. */
static sf_status judge_rows(const sf_sweep_adaptive *a, int64_t count, const int64_t *row, outlook *o,
                            sf_error *err) {
#pragma omp parallel for schedule(dynamic, 64)
    for (int64_t k = 0; k < count; k++)
        if (!sf_process_stopped())
            o[k] = judge(a, row[k]);
    return sf_process_stopped() ? SF_FAIL(err, SF_INTERRUPTED, "interrupted") : SF_OK;
}

/* ---- a further round ---- */

/* The first open rows, every `step`-th, at most `most`; `marked`: of those that it marks. Returns how many.
 */
static int64_t list_open(const sf_runs *runs, const bool *marked, int64_t step, int64_t most, int64_t *row) {
    int64_t count = 0, at = 0;
    for (int64_t r = 0; r < runs->count && count < most; r++)
        if (runs->state[r] == SF_SWEEP_OPEN && (!marked || marked[r]) && at++ % step == 0)
            row[count++] = r;
    return count;
}

/* Chooses the next rows to simulate among those that miss their wishes, by the process that is farthest from
 * its own. */
static int choose_needed(const sf_sweep_adaptive *a, int64_t count, const int64_t *row, const outlook *o,
                         int most, int64_t *next, int *which, sf_error *err) {
    double worst = 1;
    int target = -1, candidates = 0;
    for (int64_t k = 0; k < count; k++)
        if (o[k].ratio > worst) {
            worst = o[k].ratio;
            target = o[k].target;
        }
    if (target < 0)
        return 0;
    *which = target;
    SF_OWNED double *x = sf_alloc(err, SAMPLE, (unsigned long)(a->inputs + 1) * sizeof *x, "rows");
    SF_OWNED int64_t *of = sf_alloc(err, SAMPLE, sizeof *of, "rows");
    SF_OWNED int *chosen = sf_alloc(err, most, sizeof *chosen, "rows");
    if (err->status != SF_OK)
        return 0;
    double *wish = x + (int64_t)SAMPLE * a->inputs;
    for (int64_t k = 0; k < count && candidates < SAMPLE; k++)
        if (o[k].ratio > 1 && o[k].target == target) {
            put_inputs(a, row[k], x + (int64_t)candidates * a->inputs);
            wish[candidates] = isfinite(o[k].ratio) ? o[k].wish : 0;
            of[candidates++] = row[k];
        }
    int n = sf_predictor_choose(&a->model[target], candidates, x, wish, most, chosen);
    if (n < 0)
        SF_NO_MEMORY(err, "predictions");
    for (int k = 0; k < n; k++)
        next[k] = of[chosen[k]];
    return n > 0 ? n : 0;
}

/* Looks at a sample of the open rows, and at all of them once the sample needs no more drops. */
static int choose_round(sf_sweep_adaptive *a, const sf_runs *runs, int most, int64_t *next, sf_error *err) {
    int64_t open = sf_runs_count(runs, SF_SWEEP_OPEN), ended = runs->count - open, count;
    int64_t step = open / SAMPLE + 1;
    SF_OWNED int64_t *row = sf_alloc(err, open, sizeof *row, "rows");
    SF_OWNED outlook *o = sf_alloc(err, open, sizeof *o, "predictions");
    int n = 0, target = 0, wanted = (int)(ended / ROUND_PART);
    wanted = wanted < a->jobs ? a->jobs : wanted;
    wanted = wanted < most ? wanted : most;
    for (; row && o && n == 0 && step > 0; step = step > 1 ? 1 : 0) {
        count = list_open(runs, NULL, step, open, row);
        if (judge_rows(a, count, row, o, err) != SF_OK)
            break;
        n = choose_needed(a, count, row, o, wanted, next, &target, err);
    }
    if (n > 0 && err->status == SF_OK) {
        int k = target - a->plan->figure_count;
        sf_log_print(a->log, "%lld of %lld rows simulated; %d more to know %s of the others\n",
                     (long long)ended, (long long)runs->count, n,
                     k < 0 ? a->plan->figure[target].figure : watched[k].what);
    }
    return n;
}

static int next(void *context, const sf_runs *runs, int most, int64_t *row, sf_error *err) {
    sf_sweep_adaptive *a = context;
    int64_t ended = runs->count - sf_runs_count(runs, SF_SWEEP_OPEN),
            missing = sf_sweep_adaptive_design(a->plan) - ended;
    int drawn = (int)list_open(runs, a->drawn, 1, most, row);
    if (drawn > 0)
        return drawn;
    if (missing > 0 && ended < runs->count)
        return choose_apart(a, runs, missing < most ? (int)missing : most, row, err);
    if (expect(a, runs, err) != SF_OK || fit_models(a, runs, err) != SF_OK)
        return 0;
    return a->all ? (int)list_open(runs, NULL, 1, most, row) : choose_round(a, runs, most, row, err);
}

/* ---- predictions ---- */

static sf_status finish(void *context, sf_runs *runs, sf_error *err) {
    sf_sweep_adaptive *a = context;
    int64_t open = sf_runs_count(runs, SF_SWEEP_OPEN);
    SF_OWNED int64_t *row = sf_alloc(err, open, sizeof *row, "rows");
    SF_OWNED outlook *o = sf_alloc(err, open, sizeof *o, "predictions");
    if (row && o && open > 0 && !a->all) {
        list_open(runs, NULL, 1, open, row);
        judge_rows(a, open, row, o, err);
        for (int64_t k = 0; k < open && err->status == SF_OK; k++)
            if (o[k].unusable < WATCHED)
                sf_runs_leave(runs, row[k], watched[o[k].unusable].left_open, err);
            else if (o[k].ratio <= 1)
                sf_runs_predicted(runs, row[k], o[k].value, o[k].half);
    }
    for (int k = 0; k < a->plan->figure_count; k++) {
        runs->checked[k] = a->model[k].count;
        runs->held[k] = a->held[k];
    }
    return err->status;
}

sf_sweep_adaptive *sf_sweep_adaptive_new(const sf_plan *plan, const char *drops, int jobs, FILE *log,
                                         sf_error *err) {
    sf_sweep_adaptive *a = sf_alloc(err, 1, sizeof *a, "predictions");
    if (!a)
        return NULL;
    *a = (sf_sweep_adaptive){
        .plan = plan, .drops = drops, .jobs = jobs, .log = log, .targets = plan->figure_count + WATCHED};
    list_inputs(a);
    a->drawn = sf_analysis_pick(plan->rows, count_drawn(plan), err);
    return sf_keep(a, err);
}

void sf_sweep_adaptive_correct(sf_sweep_adaptive *a, const sf_sweep_adaptive *coarse, const sf_runs *runs) {
    a->coarse = coarse;
    a->coarse_runs = runs;
}

void sf_sweep_adaptive_free(sf_sweep_adaptive *a) {
    if (!a)
        return;
    free_models(a);
    SF_FREE(a->expected, a->base, a->doubt, a->drawn, a);
}

sf_sweep_chooser sf_sweep_adaptive_chooser(sf_sweep_adaptive *a) {
    return (sf_sweep_chooser){next, finish, a};
}
