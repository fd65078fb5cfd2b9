/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/sweep/sweep_report.h"

#include "base/text.h"
#include "build_info.h"
#include "report/chart.h"
#include <gsl/gsl_statistics.h>

enum { LISTED = 50, CELLS_LISTED = 200 };

static const char caution[] = "Figures of simulated drops: indicative, not a certification.";
static const char *const sampling_words[] = {[SF_SAMPLING_RANDOM] = "random",
                                             [SF_SAMPLING_LATIN] = "Latin hypercube",
                                             [SF_SAMPLING_SOBOL] = "Sobol' sequence",
                                             [SF_SAMPLING_SALTELLI] = "Sobol' sequence, for indices"};

/* ---- factors in words ---- */

static void list_text(const sf_factor *f, char *text, size_t size) {
    double low, high;
    if (f->words) {
        snprintf(text, size, "%lld %s", f->count, f->uncertain ? "draws" : "levels");
        return;
    }
    gsl_stats_minmax(&low, &high, f->number, 1, (size_t)f->count);
    snprintf(text, size, "%lld values, %.6g to %.6g %s", f->count, low, high, f->unit);
}

/* Writes the values of a factor in a few words: "5 values, 4 to 6 m/s". */
static void factor_text(const sf_plan *p, int factor, char *text, size_t size) {
    const sf_factor *f = &p->factor[factor];
    const sf_block *b = &p->block[p->block_of[factor]];
    if (f->distribution)
        sf_factor_distribution_text(f, text, size);
    else
        list_text(f, text, size);
    if (b->kind == SF_BLOCK_ZIP)
        sf_text_add(text, size, ", with %s",
                    p->factor[b->first == factor ? b->first + b->count - 1 : b->first].name);
    else if (b->kind == SF_BLOCK_SAMPLE)
        sf_text_add(text, size, "; %s of %lld rows", sampling_words[b->method], b->rows);
}

void sf_sweep_print_table(FILE *out, const sf_plan *p, int rows) {
    char text[SF_SWEEP_OVERRIDE_SIZE];
    for (int f = 0; f < p->factor_count; f++) {
        factor_text(p, f, text, sizeof text);
        fprintf(out, "  %-36s %s\n", p->factor[f].name, text);
    }
    fprintf(out, "%lld runs\n  id", p->rows);
    for (int f = 0; f < p->factor_count; f++)
        fprintf(out, ", %s", sf_factor_heading(&p->factor[f], text, sizeof text));
    for (long long row = 0; row < p->rows && row < rows; row++) {
        fprintf(out, "\n  %lld", row + 1);
        for (int f = 0; f < p->factor_count; f++)
            fprintf(out, ", %s", sf_factor_text(&p->factor[f], sf_plan_value(p, f, row), text, sizeof text));
    }
    fputs(p->rows > rows ? "\n  ...\n" : "\n", out);
}

/* ---- sweep.json ---- */

static void json_factors(sf_json *j, const sf_plan *p) {
    char text[512];
    SF_JSON_ARRAY(j, "factors");
    for (int f = 0; f < p->factor_count; f++) {
        factor_text(p, f, text, sizeof text);
        SF_JSON_OBJECT(j, NULL);
        SF_JSON_TEXTS(j, {"key", p->factor[f].key}, {"name", p->factor[f].name},
                      {"unit", *p->factor[f].unit ? p->factor[f].unit : NULL}, {"values", text});
        sf_json_bool(j, "uncertain", p->factor[f].uncertain);
    }
}

static void json_effects(sf_json *j, const sf_sweep_report *r, int figure) {
    SF_JSON_ARRAY(j, "main_effects");
    for (int f = 0; f < r->plan->factor_count; f++) {
        const sf_effect *e = &r->analysis->effect[figure][f];
        SF_JSON_OBJECT(j, NULL);
        sf_json_text(j, "factor", r->plan->factor[f].name);
        SF_JSON_NUMBERS(j, {"low", e->low}, {"high", e->high}, {"at_least_value", e->first},
                        {"at_greatest_value", e->last});
        sf_json_bool(j, "by_response_surface", sf_effect_is_by_surface(r->plan, f));
        sf_json_integer(j, "combinations", e->used);
        sf_json_integer(j, "all_combinations", e->of);
    }
}

static void json_indices(sf_json *j, const sf_sweep_report *r, int figure) {
    const sf_analysis *a = r->analysis;
    if (!a->with_indices)
        return;
    sf_json_integer(j, "sobol_samples", a->index_samples[figure]);
    SF_JSON_ARRAY(j, "sobol_indices");
    for (int f = 0; f < r->plan->factor_count; f++) {
        const sf_index *i = &a->index[figure][f];
        SF_JSON_OBJECT(j, NULL);
        sf_json_text(j, "factor", r->plan->factor[f].name);
        SF_JSON_NUMBERS(j, {"first", i->first}, {"first_low", i->first_low}, {"first_high", i->first_high},
                        {"total", i->total}, {"total_low", i->total_low}, {"total_high", i->total_high});
    }
}

static void json_surface(sf_json *j, const sf_sweep_report *r, int figure) {
    const sf_sweep_surface *s = &r->analysis->surface[figure];
    const sf_quadratic *fit = &s->fit;
    char text[512];
    SF_JSON_OBJECT(j, "response_surface");
    sf_json_text(j, "problem", *fit->problem ? fit->problem : NULL);
    SF_JSON_NUMBERS(j, {"rows", (double)s->rows}, {"rms", fit->rms}, {"left_out_rms", fit->left_out_rms},
                    {"q2", fit->q2});
    sf_json_open(j, "numbers", '[');
    int list[SF_SWEEP_FACTORS];
    sf_analysis_numbers(r->plan, list);
    for (int i = 0; i < fit->d && fit->terms > 0; i++) {
        SF_JSON_OBJECT(j, NULL);
        sf_json_text(j, "factor", r->plan->factor[list[i]].name);
        SF_JSON_NUMBERS(j, {"centre", fit->centre[i]}, {"half_range", fit->half[i]});
    }
    sf_json_close(j);
    SF_JSON_ARRAY(j, "terms");
    for (int t = 0; t < fit->terms; t++) {
        sf_analysis_term(r->analysis, fit, t, text, sizeof text);
        SF_JSON_OBJECT(j, NULL);
        sf_json_text(j, "term", text);
        sf_json_number(j, "coefficient", fit->c[t]);
    }
}

static void json_probability(sf_json *j, const sf_sweep_report *r, int figure) {
    const sf_probabilities *q = &r->analysis->probability;
    char text[SF_SWEEP_OVERRIDE_SIZE];
    if (isnan(r->plan->figure[figure].limit) || q->cells == 0)
        return;
    SF_JSON_ARRAY(j, "probability_below_limit");
    for (int64_t k = 0; k < q->cells; k++) {
        const sf_probability *c = &q->cell[figure * q->cells + k];
        SF_JSON_OBJECT(j, NULL);
        for (int f = 0; f < r->plan->factor_count; f++) {
            if (!sf_block_is_chosen(r->plan, r->plan->block_of[f]))
                continue;
            sf_factor_text(&r->plan->factor[f], sf_plan_value(r->plan, f, q->row[k]), text, sizeof text);
            sf_json_text(j, r->plan->factor[f].name, text);
        }
        SF_JSON_NUMBERS(j, {"probability", c->share}, {"low", c->low}, {"high", c->high},
                        {"below", (double)c->below}, {"above", (double)c->above},
                        {"unknown", (double)c->unknown}, {"within_scatter", (double)c->within});
    }
}

static void json_refined(sf_json *j, const sf_runs *runs) {
    SF_JSON_ARRAY(j, "refined");
    for (int64_t row = 0; row < runs->count; row++) {
        const sf_runs_pair pair = sf_runs_refine(runs, row);
        SF_JSON_OBJECT(j, NULL);
        sf_rows_json(j, sf_runs_pair_rows, &pair);
    }
}

sf_status sf_sweep_write_json(const sf_staging *output, const sf_sweep_report *r, sf_error *err) {
    const sf_analysis *a = r->analysis;
    SF_JSON_FILE(j, output, "sweep.json", err);
    SF_JSON_TEXTS(&j, {"plan", r->plan->path}, {"judged_by", *r->series ? r->series : NULL});
    SF_JSON_NUMBERS(&j, {"runs", (double)r->plan->rows}, {"done", (double)a->done},
                    {"failed", (double)a->failed}, {"open", (double)a->open},
                    {"predicted", (double)a->predicted}, {"do_not_use", (double)a->unusable});
    if (r->coarse > 0)
        sf_json_number(&j, "coarse_drops", (double)r->coarse);
    json_factors(&j, r->plan);
    if (r->plan->refine)
        json_refined(&j, r->runs);
    sf_sweep_views_json(&j, r->views);
    sf_json_open(&j, "figures", '[');
    for (int k = 0; k < r->plan->figure_count; k++) {
        SF_JSON_OBJECT(&j, NULL);
        sf_json_text(&j, "figure", r->plan->figure[k].figure);
        sf_json_number(&j, "limit", r->plan->figure[k].limit);
        if (sf_plan_is_adaptive(r->plan))
            SF_JSON_NUMBERS(&j, {"accuracy", r->plan->figure[k].accuracy},
                            {"widest_prediction", a->widest[k]}, {"checked_rows", r->runs->checked[k]},
                            {"held_rows", r->runs->held[k]});
        json_probability(&j, r, k);
        json_effects(&j, r, k);
        json_indices(&j, r, k);
        json_surface(&j, r, k);
    }
    sf_json_close(&j);
    sf_json_close(&j);
    return sf_staging_close(j.file, "sweep.json", err);
}

/* ---- report.html ---- */

static void put_tiles(FILE *page, const sf_sweep_report *r) {
    const sf_analysis *a = r->analysis;
    SF_HTML_DIVISION(page, "tiles");
    SF_PRINTED(value, 64, "%lld of %lld", a->done, r->plan->rows);
    SF_PRINTED(remark, 96, "%lld predicted, %lld failed, %lld open", a->predicted, a->failed, a->open);
    sf_html_tile(page, a->failed + a->open > 0 ? "fair" : "good", "runs done", value, remark);
    snprintf(value, sizeof value, "%lld", a->usable);
    snprintf(remark, sizeof remark, "%lld with remarks; %lld more are not to be used", a->remarks,
             a->unusable);
    sf_html_tile(page, a->unusable > 0 ? "fair" : "good", "runs whose figures count", value, remark);
    for (int k = 0; k < r->plan->figure_count && a->probability.cells == 1; k++) {
        const sf_probability *c = &a->probability.cell[k];
        if (isnan(r->plan->figure[k].limit))
            continue;
        SF_PRINTED(title, 96, "P(%s < %g)", r->plan->figure[k].figure, r->plan->figure[k].limit);
        snprintf(value, sizeof value, "%.3f", c->share);
        snprintf(remark, sizeof remark, "95 %% interval %.3f to %.3f", c->low, c->high);
        if (c->unknown > 0)
            snprintf(remark, sizeof remark, "%.3f to %.3f; %lld unknown runs are taken as above", c->low,
                     c->high, c->unknown);
        sf_html_tile(page, "plain", title, value, remark);
    }
}

static void put_factors(FILE *page, const sf_plan *p, const char *series) {
    char text[512];
    sf_html_heading(page, "Plan");
    sf_html_table t = sf_html_table_begin(page, "factor|key of the case|values|role");
    for (int f = 0; f < p->factor_count; f++) {
        sf_html_row(&t);
        factor_text(p, f, text, sizeof text);
        sf_html_cell(&t, "%s", p->factor[f].name);
        sf_html_cell(&t, "%s", p->factor[f].key);
        sf_html_cell(&t, "%s", text);
        sf_html_cell(&t, "%s", p->factor[f].uncertain ? "uncertain" : "chosen");
    }
    sf_html_table_end(&t);
    sf_html_paragraph(page, "%lld runs of %s, a row each in runs.csv.", p->rows, p->case_path);
    if (*series)
        sf_html_paragraph(
            page, "A run is a series of drops on one pad, judged by %s; drops.csv has each drop.", series);
}

static void put_predictions(FILE *page, const sf_sweep_report *r) {
    const sf_analysis *a = r->analysis;
    if (!sf_plan_is_adaptive(r->plan))
        return;
    sf_html_heading(page, "Predicted runs");
    sf_html_table t = sf_html_table_begin(
        page,
        "figure|>accuracy asked for|>widest half of a 95 % interval|>left-out drops in their intervals");
    for (int k = 0; k < r->plan->figure_count; k++) {
        SF_HTML_ROW(&t, "%s", r->plan->figure[k].figure);
        sf_html_cell(&t, "%.3g %%", 100 * r->plan->figure[k].accuracy);
        sf_html_cell(&t, a->predicted > 0 ? "%.3g %%" : "–", 100 * a->widest[k]);
        sf_html_cell(&t, "%d of %d", r->runs->held[k], r->runs->checked[k]);
    }
    sf_html_table_end(&t);
    sf_html_note(
        page,
        "%lld of %lld rows were not simulated but predicted from the others; runs.csv has the state and the "
        "interval of each. Each eighth of the simulated rows was also predicted from the other seven; the last "
        "column counts those in their intervals, before these were widened to hold 95 %% of them. In "
        "probabilities a prediction whose interval holds the limit is unknown. %lld rows are open: each is "
        "expected with 70 %% at least to fail, to be not to be used or to lack a figure; runs.csv says why.",
        a->predicted, r->plan->rows, a->open);
    if (r->coarse > 0)
        sf_html_note(page,
                     "What is predicted is the ratio to coarse drops, of which %lld were simulated; they "
                     "tell the coarse figures of the other rows within half of the accuracy, which is part "
                     "of the interval. The table is coarse/runs.csv.",
                     (long long)r->coarse);
}

/* Refines the first rows, for a table; `pair` [LISTED]. */
static sf_records list_pairs(const sf_runs *runs, sf_runs_pair *pair) {
    int64_t count = 0;
    for (; count < runs->count && count < LISTED; count++)
        pair[count] = sf_runs_refine(runs, count);
    return (sf_records){pair, sizeof *pair, count};
}

static void put_refined(FILE *page, const sf_runs *runs) {
    sf_runs_pair pair[LISTED];
    sf_html_heading(page, "Figures for ever finer meshes");
    sf_rows_html_table(page, sf_runs_pair_rows, list_pairs(runs, pair));
    sf_html_note(
        page,
        "Extrapolated from the drop of a row and one with %d times its spacings; runs.csv has all rows. All "
        "else in this report is of the rows as they are, with the error of their meshes.",
        SF_SWEEP_RATIO);
}

static void put_pictures(FILE *page, const sf_staging *output) {
    for (const sf_sweep_picture *p = sf_sweep_pictures(); p->name; p++) {
        SF_PRINTED(script, 64, "%s.gp", p->name);
        if (sf_staging_has(output, script))
            sf_chart_figure(page, output, p->name, "softfall-sweep", p->caption);
    }
}

static void put_probability_row(sf_html_table *t, const sf_sweep_report *r, int64_t cell) {
    const sf_probabilities *q = &r->analysis->probability;
    char text[SF_SWEEP_OVERRIDE_SIZE];
    sf_html_row(t);
    for (int f = 0; f < r->plan->factor_count; f++)
        if (sf_block_is_chosen(r->plan, r->plan->block_of[f])) {
            sf_factor_text(&r->plan->factor[f], sf_plan_value(r->plan, f, q->row[cell]), text, sizeof text);
            sf_html_cell(t, "%s", text);
        }
    for (int k = 0; k < r->plan->figure_count; k++) {
        const sf_probability *c = &q->cell[k * q->cells + cell];
        if (isnan(r->plan->figure[k].limit))
            continue;
        sf_html_line(t, NULL, "%.3f (%.3f to %.3f)|%lld / %lld / %lld / %lld", c->share, c->low, c->high,
                     c->below, c->above, c->unknown, c->within);
    }
}

static void put_probability(FILE *page, const sf_sweep_report *r) {
    const sf_probabilities *q = &r->analysis->probability;
    char columns[4096] = "";
    if (q->cells == 0)
        return;
    for (int f = 0; f < r->plan->factor_count; f++)
        if (sf_block_is_chosen(r->plan, r->plan->block_of[f])) {
            char text[SF_FACTOR_KEY_SIZE + SF_FACTOR_UNIT_SIZE + 8];
            sf_factor_heading(&r->plan->factor[f], text, sizeof text);
            sf_text_add(columns, sizeof columns, "%s%s", *columns ? "|" : "", text);
        }
    for (int k = 0; k < r->plan->figure_count; k++)
        if (!isnan(r->plan->figure[k].limit))
            sf_text_add(columns, sizeof columns,
                        "%s>P(%s < %g), 95 %% interval|>below / above / unknown / within scatter",
                        *columns ? "|" : "", r->plan->figure[k].figure, r->plan->figure[k].limit);
    if (!*columns)
        return;
    sf_html_heading(page, "Probability of staying below the limits");
    sf_html_table t = sf_html_table_begin(page, columns);
    for (int64_t k = 0; k < q->cells && k < CELLS_LISTED; k++)
        put_probability_row(&t, r, k);
    sf_html_table_end(&t);
    sf_html_note(
        page,
        "Over the uncertain factors of the plan, all draws equally probable; the interval (Clopper and Pearson) "
        "is that of the number of runs. Unknown ones (failed, not to be used, or left open as they are "
        "expected to be so) are taken as above, and as below for the high end of the interval alone. A run that reached the anvil counts as above. Within scatter: runs "
        "whose limit another pad or drop may find on the other side, by the scatter of speed and thickness (95 %%). The "
        "interval holds neither that nor the error of the model nor what the plan does not vary.%s%s",
        q->open > 0 ? " Runs that are still to be made are not counted." : "",
        q->cells > CELLS_LISTED ? " sweep.json has the other combinations." : "");
}

/* Means and fits of a part that the outcome has chosen. */
static void note_missing(FILE *page, const sf_sweep_report *r, const char *what) {
    long long missing = r->plan->rows - r->analysis->usable;
    if (missing > 0)
        sf_html_note(page,
                     "%lld of %lld runs are left out (failed, not to be used, or open). These are no random "
                     "part, but mostly the hardest drops: %s.",
                     missing, r->plan->rows, what);
}

/* Puts the number of combinations behind a main effect. */
static void put_ground(sf_html_table *t, const sf_plan *p, int factor, const sf_effect *e) {
    if (sf_effect_is_by_surface(p, factor))
        sf_html_cell(t, isnan(e->low) ? "no good response surface" : "the response surface");
    else if (sf_effect_is_scatter(p, factor))
        sf_html_cell(t, "–");
    else if (e->of > 0)
        sf_html_cell(t, "%lld of %lld combinations", e->used, e->of);
    else
        sf_html_cell(t, "all runs that count");
}

static void put_effects(FILE *page, const sf_sweep_report *r) {
    bool scatter = false;
    sf_html_heading(page, "Main effects");
    sf_html_table t = sf_html_table_begin(
        page, "figure|factor|>lowest mean|>highest mean|>at the least value|>at the greatest value|over");
    for (int k = 0; k < r->plan->figure_count; k++)
        for (int f = 0; f < r->plan->factor_count; f++) {
            const sf_effect *e = &r->analysis->effect[k][f];
            SF_HTML_ROW(&t, "%s", r->plan->figure[k].figure);
            sf_html_cell(&t, "%s", r->plan->factor[f].name);
            SF_HTML_NUMBERS(&t, 1, e->low, e->high, e->first, e->last);
            put_ground(&t, r->plan, f, e);
            scatter |= sf_effect_is_scatter(r->plan, f);
        }
    sf_html_table_end(&t);
    sf_html_note(page,
                 "All else equal: means over those combinations of the other blocks of the plan of which "
                 "all runs count. More than %d numbers are taken in %d parts; of draws of an unknown the "
                 "means at 5 and 95 %% of them are shown. Numbers that a sample mixes with others: between "
                 "their least and their greatest value by the response surface, if its Q² is %g or more.",
                 SF_EFFECT_LEVELS, SF_EFFECT_BINS, SF_EFFECT_Q2);
    note_missing(page, r, "an effect there may be far greater than in the combinations that are whole");
    if (scatter)
        sf_html_note(page,
                     "Draws, or many words, that a sample mixes with other factors have no bar where each "
                     "has fewer than %d runs: their means are mostly scatter of the others. A saltelli "
                     "sample tells their share (Sobol' indices).",
                     SF_EFFECT_RUNS);
}

static void put_indices(FILE *page, const sf_sweep_report *r) {
    const sf_analysis *a = r->analysis;
    if (!a->with_indices)
        return;
    sf_html_heading(page, "Sobol' indices");
    sf_html_table t =
        sf_html_table_begin(page, "figure|factor|>first order|95 % interval|>total|95 % interval|>samples");
    for (int k = 0; k < r->plan->figure_count; k++)
        for (int f = 0; f < r->plan->factor_count; f++) {
            const sf_index *i = &a->index[k][f];
            SF_HTML_ROW(&t, "%s", r->plan->figure[k].figure);
            sf_html_cell(&t, "%s", r->plan->factor[f].name);
            sf_html_line(&t, NULL, "%.3f|%.3f to %.3f|%.3f|%.3f to %.3f|%lld of %lld", i->first, i->first_low,
                         i->first_high, i->total, i->total_low, i->total_high, a->index_samples[k],
                         sf_plan_saltelli(r->plan)->samples);
        }
    sf_html_table_end(&t);
    sf_html_note(page,
                 "Estimators of Saltelli (2010) and Jansen, intervals by bootstrap. A sample of which one "
                 "run has no figure (failed, or not to be used) is left out as a whole. Such runs are "
                 "mostly the hardest drops: a figure has no indices where fewer than %.0f %% of the samples "
                 "are left, as these are no random part of all. Take narrower ranges, or a thicker pad.",
                 100 * SF_INDEX_SHARE);
}

static void put_surfaces(FILE *page, const sf_sweep_report *r) {
    sf_html_heading(page, "Response surface");
    sf_html_table t = sf_html_table_begin(
        page, "figure|>runs|>terms|>rms of the residuals|>rms error at runs left out|>Q²|remark");
    for (int k = 0; k < r->plan->figure_count; k++) {
        const sf_sweep_surface *s = &r->analysis->surface[k];
        sf_html_line(&t, r->plan->figure[k].figure, "%lld|%d|%.3f|%.3f|%.3f", (long long)s->rows,
                     s->fit.terms, s->fit.rms, s->fit.left_out_rms, s->fit.q2);
        sf_html_cell(&t, "%s%s%s", s->fit.problem, *s->fit.problem && s->rows < s->of ? "; " : "",
                     s->rows < s->of ? "a part of the runs, drawn at random" : "");
    }
    sf_html_table_end(&t);
    sf_html_note(
        page,
        "A quadratic of the factors that are numbers, with a constant for each level of chosen words; what is "
        "uncertain and no number is scatter about it. The error is that at each run by the surface without "
        "all runs of its place in these factors; Q² is 1 less its square over the variance. The coefficients are in sweep.json.");
    note_missing(page, r, "the surface says nothing about where they are");
}

static void put_failures(FILE *page, const sf_sweep_report *r) {
    int listed = 0;
    const sf_analysis *a = r->analysis;
    if (a->failed + a->unusable == 0)
        return;
    sf_html_heading(page, "Runs that failed or are not to be used");
    sf_html_table t = sf_html_table_begin(page, ">id|what|sentence");
    for (long long row = 0; row < r->runs->count && listed < LISTED; row++) {
        bool failed = r->runs->state[row] == SF_SWEEP_FAILED;
        if (!failed && (r->runs->state[row] != SF_SWEEP_DONE || sf_runs_usable(r->runs, row)))
            continue;
        listed++;
        SF_HTML_ROW(&t, "%lld", row + 1);
        sf_html_cell(&t, "%s", failed ? "failed" : "do not use");
        sf_html_cell(&t, "%s", r->runs->message[row] ? r->runs->message[row] : "");
    }
    sf_html_table_end(&t);
    if (a->failed + a->unusable > LISTED)
        sf_html_note(page, "The others are in runs.csv.");
    if (a->failed > 0)
        sf_html_note(page, "The same command with --retry does the failed ones again.");
}

sf_status sf_sweep_write_page(const sf_staging *output, const sf_sweep_report *r, sf_error *err) {
    const sf_analysis *a = r->analysis;
    FILE *page = sf_html_begin(output, "Sweep", r->plan->title, err);
    SF_TRY(err->status);
    bool whole = a->failed + a->open + a->unusable == 0;
    sf_html_banner(
        page,
        whole           ? "good"
        : a->usable > 0 ? "fair"
                        : "bad",
        whole ? "complete" : "with gaps",
        "%lld of %lld runs are done, %lld are predicted, %lld failed, %lld are open; the figures of %lld are not to "
        "be used. %s",
        a->done, r->plan->rows, a->predicted, a->failed, a->open, a->unusable, caution);
    put_tiles(page, r);
    put_factors(page, r->plan, r->series);
    put_predictions(page, r);
    if (r->plan->refine)
        put_refined(page, r->runs);
    put_pictures(page, output);
    put_probability(page, r);
    put_effects(page, r);
    put_indices(page, r);
    put_surfaces(page, r);
    put_failures(page, r);
    sf_sweep_views_put(page, r->runs, r->views);
    return sf_html_end(page, r->command_line, "softfall-sweep " SF_VERSION " (" SF_GIT_REVISION ")", err);
}

/* ---- terminal ---- */

void sf_sweep_print(FILE *out, const sf_sweep_report *r) {
    const sf_analysis *a = r->analysis;
    fprintf(out, "%lld runs: %lld done, %lld failed, %lld open; the figures of %lld are not to be used\n",
            r->plan->rows, a->done, a->failed, a->open, a->unusable);
    if (*r->series)
        fprintf(out, "  each of a series of drops, judged by %s\n", r->series);
    for (int k = 0; k < r->plan->figure_count && a->predicted > 0; k++)
        fprintf(out, "  %lld predicted: %s within %.3g %% (95 %%), %.3g %% asked for\n", a->predicted,
                r->plan->figure[k].figure, 100 * a->widest[k], 100 * r->plan->figure[k].accuracy);
    sf_runs_pair pair[LISTED];
    if (r->plan->refine)
        sf_rows_text_table(out, sf_runs_pair_rows, list_pairs(r->runs, pair));
    int listed = 0;
    for (long long row = 0; row < r->runs->count && listed < 5; row++)
        if (r->runs->state[row] == SF_SWEEP_FAILED && ++listed)
            fprintf(out, "  run %lld failed: %s\n", row + 1, r->runs->message[row]);
    if (a->failed > listed)
        fprintf(out, "  %lld more in runs.csv; --retry does them again\n", a->failed - listed);
    for (int k = 0; k < r->plan->figure_count && a->with_indices; k++)
        if (isnan(a->index[k][0].first))
            fprintf(
                out,
                "  %s: no Sobol' indices: it does not vary, or too few samples have all runs, %lld of %lld\n",
                r->plan->figure[k].figure, a->index_samples[k], sf_plan_saltelli(r->plan)->samples);
    for (int k = 0; k < r->plan->figure_count; k++) {
        const sf_quadratic *s = &a->surface[k].fit;
        if (s->terms > 0 && *s->problem)
            fprintf(out, "  %s: response surface of %d terms; %s\n", r->plan->figure[k].figure, s->terms,
                    s->problem);
        else if (s->terms > 0)
            fprintf(out, "  %s: response surface of %d terms, rms error at runs left out %.4g, Q2 %.4f\n",
                    r->plan->figure[k].figure, s->terms, s->left_out_rms, s->q2);
    }
    fprintf(out, "%s\n", caution);
}
