/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/drop/inference.h"

static const double THREE[] = {0.025, 0.5, 0.975};

static const char *label_of(const sf_drop_average *a, int m) {
    return a->model[m]->fit->input->label;
}

/* Worst R-hat and least effective size of a model's chains. */
static void find_worst(const sf_chains *c, double *rhat, double *effective) {
    *rhat = 0;
    *effective = INFINITY;
    for (int i = 0; i < c->parameters + c->quantities; i++) {
        if (isnan(c->effective[i])) /* no state has it */
            continue;
        *rhat = fmax(*rhat, isnan(c->rhat[i]) ? INFINITY : c->rhat[i]);
        *effective = fmin(*effective, c->effective[i]);
    }
}

static const char *drop_of(const sf_drop_inference *in, int quantity) {
    return in->fit->input->drop[in->quantity[quantity].drop].name;
}

/* ---- quantiles: low, median, high; INFINITY: among the draws that collapse ---- */

enum { SHARE = 24, MISSING = 128, SHOWN = 64 };

/* "0.4 %"; more than nothing does not read "0 %". */
static const char *share_text(double share, char text[SHARE]) {
    if (share > 0 && share < 1e-4)
        snprintf(text, SHARE, "less than 0.01 %%");
    else
        snprintf(text, SHARE, "%.3g %%", 100 * share);
    return text;
}

/* "; the columns of 3 % of the draws collapse"; empty where all have a value. */
static const char *missing_text(const sf_drop_average *a, int q, const char *joint, char text[MISSING]) {
    char share[SHARE];
    double missing = sf_drop_average_missing(a, q);
    *text = '\0';
    if (missing > 0 && !sf_drop_average_has_columns(a, q))
        snprintf(text, MISSING, "%sno columns, as its simulation failed before the pad was touched", joint);
    else if (missing > 0)
        snprintf(text, MISSING, "%sthe columns of %s of the draws collapse", joint,
                 share_text(missing, share));
    return text;
}

static const char *median_text(int digits, const double *value, char text[SHOWN]) {
    if (isnan(value[1]))
        snprintf(text, SHOWN, "–");
    else if (isinf(value[1]))
        snprintf(text, SHOWN, "above what the columns reach");
    else
        snprintf(text, SHOWN, "%.*f", digits, value[1]);
    return text;
}

static const char *interval_text(int digits, const double *value, char text[SHOWN]) {
    if (isnan(value[1]))
        snprintf(text, SHOWN, "–");
    else if (isinf(value[0]))
        snprintf(text, SHOWN, "above what the columns reach");
    else if (isinf(value[2]))
        snprintf(text, SHOWN, "from %.*f, open above", digits, value[0]);
    else
        snprintf(text, SHOWN, "%.*f to %.*f", digits, value[0], digits, value[2]);
    return text;
}

/* ---- report.html ---- */

static void put_models(FILE *f, const sf_drop_average *a) {
    sf_html_heading(f, "Models and their weights");
    sf_html_note(
        f, "%s",
        a->by_evidence
            ? "Weights by the evidence, as only one drop was measured. The evidence depends on the widths of the priors."
            : "Weights by the leave-one-out predictive densities: each drop predicted by the others, averaged over a "
              "Bayesian bootstrap of the drops. The evidence, which depends on the widths of the priors, stands beside for "
              "comparison. Misfit: at the maximum.");
    SF_HTML_TABLE table = sf_html_table_begin(
        f,
        "model|>weight|>log predictive density of left-out drops|>log evidence|>± (1 sd)|>weight by evidence|>unknowns|>misfit");
    for (int m = 0; m < a->models; m++) {
        const sf_drop_inference *in = a->model[m];
        SF_HTML_ROW(&table, "%s%s", label_of(a, m), m == sf_drop_average_best(a) ? " (written)" : "");
        sf_html_line(&table, NULL, "%.3f|%.2f|%.2f|%.2f|%.3f|%d|%.2f", a->weight[m], a->predictive[m],
                     in->evidence.log_value, in->evidence.error, a->evidence_weight[m],
                     in->fit->input->unknown_count, in->fit->result.misfit);
    }
    for (int m = 0; m < a->failed; m++) {
        SF_HTML_ROW(&table, "%s: FAILED, %s", a->failure[m].label, a->failure[m].sentence);
        sf_html_line(&table, NULL, "0.000|–|–|–|–|–|–");
    }
}

static bool has_missing(const sf_drop_average *a) {
    for (int q = 0; q < a->model[0]->quantities; q++)
        if (sf_drop_average_missing(a, q) > 0)
            return true;
    return false;
}

static void put_prediction_notes(FILE *f, const sf_drop_average *a) {
    sf_html_note(
        f,
        "Medians and 95 %% intervals of the posterior predictive distribution. They hold the "
        "uncertainty of the parameters, of the form (by the weights), of a loading curve that "
        "differs from every form, and of the model's other errors. Not in them: the discretisation. A single pad and drop has, of a_max and HIC, the scatter "
        "of thickness and speed beside (pad.thickness_tolerance, missile.speed_scatter): hold one measured drop against that interval.");
    if (has_missing(a))
        sf_html_note(
            f, "Of draws whose columns collapse (the foam is too soft for the drop), a_max and HIC count as "
               "above every value: an end of an interval among them is open. The HIC window has no such "
               "order: its median and interval are those of the draws that do not collapse.");
}

static sf_status put_predictions(FILE *f, const sf_drop_average *a, sf_error *err) {
    const sf_drop_inference *in = a->model[0];
    char text[64], missing[MISSING], median[SHOWN], shown[SHOWN], single[SHOWN], alone[SHOWN];
    if (in->quantities == 0)
        return SF_OK;
    sf_html_heading(f, "Predictions, averaged over the models");
    put_prediction_notes(f, a);
    SF_HTML_TABLE table = sf_html_table_begin(
        f,
        "drop|quantity|>median|>95 %|>95 % of a single pad and drop|>95 % of the model with the largest weight alone");
    for (int q = 0; q < in->quantities; q++) {
        const sf_drop_kind_info *about = sf_drop_kind_get(in->quantity[q].kind);
        double all[3], one[3], best[3];
        SF_TRY(sf_drop_average_quantiles(a, SF_ALL_MODELS, q, 3, THREE, all, err));
        SF_TRY(sf_drop_average_quantiles(a, SF_SINGLE_DROP, q, 3, THREE, one, err));
        SF_TRY(sf_drop_average_quantiles(a, sf_drop_average_best(a), q, 3, THREE, best, err));
        snprintf(text, sizeof text, *about->unit ? "%s (%s)" : "%s", about->name, about->unit);
        sf_html_row(&table);
        missing_text(a, q, "", missing);
        sf_html_cell(&table, *missing ? "%s (%s)" : "%s", drop_of(in, q), missing);
        sf_html_line(&table, NULL, "%s|%s|%s|%s|%s", text, median_text(about->digits, all, median),
                     interval_text(about->digits, all, shown), interval_text(about->digits, one, single),
                     interval_text(about->digits, best, alone));
    }
    return SF_OK;
}

/* Quantiles of a parameter, SI. */
static sf_status find_parameter(const sf_drop_inference *in, int k, double value[3], sf_error *err) {
    SF_TRY(sf_drop_parameter_quantiles(in, k, 3, THREE, value, err));
    for (int q = 0; q < 3; q++)
        value[q] = sf_drop_inference_value(in, k, value[q]);
    return SF_OK;
}

static sf_status put_parameters(FILE *f, const sf_drop_average *a, sf_error *err) {
    sf_html_heading(f, "Posterior of the parameters");
    sf_html_note(
        f,
        "Medians and 95 %% intervals by Markov chains. tau: standard deviation of the logarithm of "
        "the true loading curve over the form's; a large one says that the form does not fit. kappa: the model's other "
        "errors, as a multiple of 1 %% of a_max and 2 %% of the other numbers.");
    SF_HTML_TABLE table =
        sf_html_table_begin(f, "model|parameter|>median|>95 %|>R-hat|>effective sample size");
    for (int m = 0; m < a->models; m++) {
        const sf_drop_inference *in = a->model[m];
        for (int k = 0; k < in->parameters; k++) {
            bool size = k >= in->fit->input->unknown_count;
            const sf_parameter_info *about = size ? NULL : sf_parameter_get(in->fit->input->unknown[k]);
            double value[3], s = size ? 1 : about->per_unit;
            SF_TRY(find_parameter(in, k, value, err));
            sf_html_line(&table, k == 0 ? label_of(a, m) : "", "%s%s%s|%.4g|%.4g to %.4g|%.3f|%.0f",
                         sf_drop_inference_name(in, k), !size && *about->unit ? ", " : "",
                         size ? "" : about->unit, value[1] / s, value[0] / s, value[2] / s,
                         in->chains.rhat[k], in->chains.effective[k]);
        }
    }
    return SF_OK;
}

static void put_left_out(FILE *f, const sf_drop_average *a) {
    if (a->by_evidence)
        return;
    sf_html_heading(f, "Drops left out one by one");
    sf_html_note(f, "log p of a drop's data given the others'. By importance weights of the whole posterior "
                    "where their Pareto k is below 0.5; else by draws of a wider distribution if enough of "
                    "them count; else by chains without the drop.");
    SF_HTML_TABLE table = sf_html_table_begin(f, "model|drop|>log density|>Pareto k|by");
    for (int m = 0; m < a->models; m++)
        for (int d = 0; d < a->model[m]->fit->measured_drops; d++) {
            const sf_left_out *out = &a->model[m]->left_out[d];
            sf_html_line(&table, d == 0 ? label_of(a, m) : "", "%s|%.2f|%.2f|%s%s",
                         a->model[m]->fit->input->drop[d].name, out->log_density, out->pareto_k,
                         out->sampled ? "chains"
                         : out->drawn ? "draws"
                                      : "weights",
                         out->converged ? "" : " (criteria not reached)");
        }
}

static void put_diagnostics(FILE *f, const sf_drop_average *a) {
    sf_html_heading(f, "Diagnostics of the chains");
    sf_html_note(f,
                 "Reached: R-hat below 1.02 and an effective sample size above 400 for every parameter and "
                 "prediction; the evidence from at least 100 effective draws.");
    SF_HTML_TABLE table = sf_html_table_begin(
        f,
        "model|>largest R-hat|>least effective size|>states kept|>accepted (%)|>evaluations|>effective draws of the evidence|reached");
    for (int m = 0; m < a->models; m++) {
        const sf_drop_inference *in = a->model[m];
        double rhat, effective;
        find_worst(&in->chains, &rhat, &effective);
        sf_html_line(&table, label_of(a, m), "%.3f|%.0f|%d x %d|%.0f|%lld|%.0f of %d|%s%s", rhat, effective,
                     in->chains.chains, in->chains.kept, 100 * in->chains.accepted, in->chains.evaluations,
                     in->evidence.effective, in->evidence.draws, in->chains.converged ? "yes" : "NO: chains",
                     in->evidence.trusted ? "" : "; NO: evidence");
    }
}

/* Models and simulations that ended without a result. */
static void put_failures(FILE *f, const sf_drop_average *a) {
    for (int m = 0; m < a->failed; m++)
        sf_html_banner(f, "bad", "a model failed", "%s: %s. It has no weight.", a->failure[m].label,
                       a->failure[m].sentence);
    for (int m = 0; m < a->models; m++) {
        const sf_drop_fit *fit = a->model[m]->fit;
        if (!fit->result.converged)
            sf_html_banner(f, "bad", "a model did not converge", "%s: %s. Its values are not to be used.",
                           label_of(a, m), fit->result.reason);
        for (int d = fit->measured_drops; d < fit->input->drop_count; d++)
            if (*fit->simulated[d].failure)
                sf_html_banner(
                    f, "bad", "a predicted drop failed",
                    "%s, model %s: %s. The averaged prediction has this model by its columns, corrected as the measured drops are.",
                    fit->input->drop[d].name, label_of(a, m), fit->simulated[d].failure);
    }
}

sf_status sf_inference_html(FILE *f, const sf_drop_average *a, sf_error *err) {
    if (!sf_drop_average_reached(a))
        sf_html_banner(
            f, "bad", "criteria not reached",
            "Some chains or importance weights did not reach their criteria (see Diagnostics): weights "
            "and intervals are less certain than they look.");
    put_failures(f, a);
    SF_TRY(put_predictions(f, a, err));
    put_models(f, a);
    SF_TRY(put_parameters(f, a, err));
    put_left_out(f, a);
    put_diagnostics(f, a);
    return SF_OK;
}

/* ---- fit.json ---- */

static void json_quantiles(sf_json *j, const double *value) {
    SF_JSON_NUMBERS(j, {"median", value[1]}, {"low95", value[0]}, {"high95", value[2]});
}

static sf_status json_parameters(sf_json *j, const sf_drop_inference *in, sf_error *err) {
    SF_JSON_ARRAY(j, "parameters");
    for (int k = 0; k < in->parameters; k++) {
        double value[3];
        SF_TRY(find_parameter(in, k, value, err));
        SF_JSON_OBJECT(j, NULL);
        SF_JSON_TEXTS(j, {"name", sf_drop_inference_name(in, k)}, {"unit", "SI"});
        json_quantiles(j, value);
        SF_JSON_NUMBERS(j, {"rhat", in->chains.rhat[k]}, {"effective_sample_size", in->chains.effective[k]});
    }
    return SF_OK;
}

/* Predicted drops without a figure of a simulation, with the reason. */
static void json_failed_drops(sf_json *j, const sf_drop_fit *fit) {
    SF_JSON_ARRAY(j, "failed_predictions");
    for (int d = fit->measured_drops; d < fit->input->drop_count; d++)
        if (*fit->simulated[d].failure) {
            SF_JSON_OBJECT(j, NULL);
            SF_JSON_TEXTS(j, {"drop", fit->input->drop[d].name}, {"failure", fit->simulated[d].failure});
        }
}

static sf_status json_model(sf_json *j, const sf_drop_average *a, int m, sf_error *err) {
    const sf_drop_inference *in = a->model[m];
    double rhat, effective;
    find_worst(&in->chains, &rhat, &effective);
    SF_JSON_OBJECT(j, NULL);
    sf_json_text(j, "model", label_of(a, m));
    SF_JSON_NUMBERS(j, {"weight", a->weight[m]}, {"weight_by_evidence", a->evidence_weight[m]},
                    {"log_predictive_density", a->predictive[m]}, {"log_evidence", in->evidence.log_value},
                    {"log_evidence_sd", in->evidence.error},
                    {"log_evidence_effective_draws", in->evidence.effective},
                    {"misfit", in->fit->result.misfit});
    sf_json_bool(j, "converged", in->fit->result.converged);
    sf_json_text(j, "reason", in->fit->result.reason);
    sf_json_bool(j, "chains_reached", in->chains.converged);
    SF_JSON_NUMBERS(j, {"largest_rhat", rhat}, {"least_effective_sample_size", effective});
    sf_json_integer(j, "evaluations", in->chains.evaluations);
    sf_json_open(j, "left_out", '[');
    for (int d = 0; d < in->fit->measured_drops && !a->by_evidence; d++) {
        SF_JSON_OBJECT(j, NULL);
        sf_json_text(j, "drop", in->fit->input->drop[d].name);
        SF_JSON_NUMBERS(j, {"log_density", in->left_out[d].log_density},
                        {"pareto_k", in->left_out[d].pareto_k});
        sf_json_bool(j, "by_chains", in->left_out[d].sampled);
        sf_json_bool(j, "by_draws", in->left_out[d].drawn);
        sf_json_bool(j, "reached", in->left_out[d].converged);
    }
    sf_json_close(j);
    json_failed_drops(j, in->fit);
    json_parameters(j, in, err);
    return err->status;
}

static sf_status json_prediction(sf_json *j, const sf_drop_average *a, int q, sf_error *err) {
    const sf_drop_inference *in = a->model[0];
    const sf_drop_kind_info *about = sf_drop_kind_get(in->quantity[q].kind);
    double value[3], one[3];
    SF_TRY(sf_drop_average_quantiles(a, SF_ALL_MODELS, q, 3, THREE, value, err));
    SF_TRY(sf_drop_average_quantiles(a, SF_SINGLE_DROP, q, 3, THREE, one, err));
    SF_JSON_OBJECT(j, NULL);
    SF_JSON_TEXTS(j, {"drop", drop_of(in, q)}, {"quantity", about->key});
    json_quantiles(j, value);
    sf_json_text(j, "open", isnan(value[1]) ? NULL : isinf(value[2]) ? "above" : "no");
    SF_JSON_NUMBERS(j, {"single_drop_low95", one[0]}, {"single_drop_high95", one[2]});
    sf_json_number(j, "share_of_draws_without_value", sf_drop_average_missing(a, q));
    return SF_OK;
}

sf_status sf_inference_json(sf_json *j, const sf_drop_average *a, sf_error *err) {
    SF_JSON_OBJECT(j, "inference");
    sf_json_integer(j, "seed", (int64_t)a->seed);
    sf_json_bool(j, "criteria_reached", sf_drop_average_reached(a));
    sf_json_text(j, "weights_by", a->by_evidence ? "evidence" : "leave-one-out predictive density");
    sf_json_open(j, "models", '[');
    for (int m = 0; m < a->models && err->status == SF_OK; m++)
        json_model(j, a, m, err);
    for (int m = 0; m < a->failed; m++) {
        SF_JSON_OBJECT(j, NULL);
        sf_json_text(j, "model", a->failure[m].label);
        sf_json_number(j, "weight", 0);
        sf_json_text(j, "failure", a->failure[m].sentence);
    }
    sf_json_close(j);
    SF_JSON_ARRAY(j, "predictions");
    for (int q = 0; q < a->model[0]->quantities && err->status == SF_OK; q++)
        json_prediction(j, a, q, err);
    return err->status;
}

/* ---- posterior.csv ---- */

static int find_unknown(const sf_fit_input *in, int parameter) {
    int k = 0;
    while (k < in->unknown_count && (int)in->unknown[k] != parameter)
        k++;
    return k < in->unknown_count ? k : -1;
}

static bool is_unknown(const sf_drop_average *a, int parameter) {
    for (int m = 0; m < a->models; m++)
        if (find_unknown(a->model[m]->fit->input, parameter) >= 0)
            return true;
    return false;
}

static void put_csv_heading(sf_csv *csv, const sf_drop_average *a) {
    sf_csv_print(csv, "draw,model,tau,kappa");
    for (int p = 0; p < SF_PARAMETER_COUNT; p++) {
        const sf_parameter_info *about = sf_parameter_get((sf_foam_parameter)p);
        if (is_unknown(a, p))
            sf_csv_print(csv, *about->unit ? "%s (%s)" : "%s", about->name, about->unit);
    }
    for (int kind = 0; kind < SF_FIT_SAMPLES; kind++) {
        const char *name = sf_drop_kind_get(kind)->error_key;
        sf_csv_print(csv, "%s_error,%s_error_sd", name, name);
    }
    sf_csv_end(csv);
}

static sf_status put_csv_draw(sf_csv *csv, const sf_drop_average *a, int k, const sf_posterior_draw *draw,
                              sf_error *err) {
    const sf_drop_inference *in = a->model[draw->model];
    const double *u = &in->chains.sample[draw->state * in->parameters];
    double delta[SF_DISCREPANCY_PLACES];
    sf_response_error error;
    sf_discrepancy_size size = sf_drop_inference_size(in, u);
    SF_TRY(sf_drop_average_discrepancy(a, k, draw, delta, &error, err));
    sf_csv_print(csv, "%d", k + 1);
    sf_csv_quoted(csv, label_of(a, draw->model));
    SF_CSV_NUMBERS(csv, size.tau, size.kappa);
    for (int p = 0; p < SF_PARAMETER_COUNT; p++) {
        int at = find_unknown(in->fit->input, p);
        if (is_unknown(a, p))
            SF_CSV_NUMBERS(csv, at < 0 ? NAN : exp(u[at]) / sf_parameter_get((sf_foam_parameter)p)->per_unit);
    }
    for (int kind = 0; kind < SF_FIT_SAMPLES; kind++)
        SF_CSV_NUMBERS(csv, error.shared[kind], error.own_sd[kind]);
    sf_csv_end(csv);
    return SF_OK;
}

sf_status sf_inference_csv(const sf_drop_average *a, const sf_staging *output, sf_error *err) {
    sf_posterior_draw draw[SF_POSTERIOR_DRAWS];
    SF_CSV_FILE(csv, output, "posterior.csv", err);
    put_csv_heading(&csv, a);
    sf_drop_average_draw(a, draw);
    for (int k = 0; k < SF_POSTERIOR_DRAWS && err->status == SF_OK; k++)
        put_csv_draw(&csv, a, k, &draw[k], err);
    sf_csv_close(&csv, err);
    return err->status;
}

void sf_inference_comment(FILE *f, const sf_drop_average *a) {
    fprintf(f,
            "Weights of the models (%s): ", a->by_evidence ? "evidence" : "leave-one-out predictive density");
    for (int m = 0; m < a->models; m++)
        fprintf(f, "%s%s %.3f%s", m > 0 ? "; " : "", label_of(a, m), a->weight[m],
                m == sf_drop_average_best(a) ? " (this file, its maximum)" : "");
    for (int m = 0; m < a->failed; m++)
        fprintf(f, "; %s 0 (failed)", a->failure[m].label);
    fputs(".\n", f);
    if (!sf_drop_average_reached(a))
        fputs("The chains did not reach their criteria: see report.html.\n", f);
}

void sf_inference_print_chains(FILE *f, const sf_drop_inference *in) {
    double rhat, effective;
    find_worst(&in->chains, &rhat, &effective);
    fprintf(
        f,
        "Markov chains: %lld evaluations, %.0f %% accepted, largest R-hat %.3f, least effective sample size %.0f%s\n",
        in->chains.evaluations, 100 * in->chains.accepted, rhat, effective,
        in->chains.converged ? "" : ": criteria NOT reached");
    fflush(f);
}

static sf_status print_prediction(FILE *f, const sf_drop_average *a, int q, sf_error *err) {
    const sf_drop_inference *in = a->model[0];
    const sf_drop_kind_info *about = sf_drop_kind_get(in->quantity[q].kind);
    double value[3], one[3];
    char median[SHOWN], interval[SHOWN], single[SHOWN], missing[MISSING];
    SF_TRY(sf_drop_average_quantiles(a, SF_ALL_MODELS, q, 3, THREE, value, err));
    SF_TRY(sf_drop_average_quantiles(a, SF_SINGLE_DROP, q, 3, THREE, one, err));
    interval_text(about->digits, one, single);
    fprintf(f, "  %-20s %s %s %s (95 %%: %s%s%s)%s\n", drop_of(in, q), about->name,
            median_text(about->digits, value, median), isfinite(value[1]) ? about->unit : "",
            interval_text(about->digits, value, interval),
            isnan(one[1]) ? "" : "; of a single pad and drop: ", isnan(one[1]) ? "" : single,
            missing_text(a, q, "; ", missing));
    return SF_OK;
}

sf_status sf_inference_print(FILE *f, const sf_drop_average *a, sf_error *err) {
    fputs("\nPosterior by Markov chains:\n", f);
    for (int m = 0; m < a->models; m++) {
        fprintf(f, "  weight %.3f  ", a->weight[m]);
        if (isfinite(a->predictive[m]))
            fprintf(f, "log predictive density %7.2f  ", a->predictive[m]);
        fprintf(f, "log evidence %8.2f  %s\n", a->model[m]->evidence.log_value, label_of(a, m));
    }
    for (int m = 0; m < a->failed; m++)
        fprintf(f, "  weight 0      FAILED: %s: %s\n", a->failure[m].label, a->failure[m].sentence);
    for (int q = 0; q < a->model[0]->quantities; q++)
        SF_TRY(print_prediction(f, a, q, err));
    if (!sf_drop_average_reached(a))
        fputs("  The chains did NOT reach their criteria: see report.html.\n", f);
    return SF_OK;
}
