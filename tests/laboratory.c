/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "extreme.h"
#include "laboratory.h"

#include "material/low_density_foam.h"
#include <assert.h>
#include <gsl/gsl_randist.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { COLUMNS = 15, FORM_UNKNOWNS = 4, UNKNOWNS = FORM_UNKNOWNS + 3 };
static const double speed[LAB_DROPS] = {4.5, 5.2, 6.2, 5.0, 5.7};
static const double thickness[LAB_DROPS] = {0.07, 0.07, 0.07, 0.05, 0.07};
static const double A_MAX_SD = 0.015, HIC_SD = 0.03, WINDOW_RESOLUTION = 0.5; /* ms */

typedef struct model {
    const char *form;
    sf_foam_parameter unknown[UNKNOWNS];
} model;

/* Curve, rate (a factor or a Maxwell branch) and unloading. */
static const model models[LAB_MODELS] = {
    {"gas",
     {SF_PARAMETER_S0, SF_PARAMETER_P0, SF_PARAMETER_B, SF_PARAMETER_M, SF_PARAMETER_RATE_FACTOR,
      SF_PARAMETER_HU, SF_PARAMETER_SHAPE}},
    {"gas_solid",
     {SF_PARAMETER_S0, SF_PARAMETER_P0, SF_PARAMETER_B, SF_PARAMETER_M, SF_PARAMETER_ED, SF_PARAMETER_HU,
      SF_PARAMETER_SHAPE}},
    {"avalle",
     {SF_PARAMETER_AVALLE_A, SF_PARAMETER_AVALLE_M, SF_PARAMETER_AVALLE_B, SF_PARAMETER_AVALLE_N,
      SF_PARAMETER_RATE_FACTOR, SF_PARAMETER_HU, SF_PARAMETER_SHAPE}},
};

/* A hemisphere of 160 mm on a pad; `area` and `thinner` make the simulation differ from the surrogate. */
static sf_columns columns_of(double v, double pad, double area, double thinner) {
    sf_columns c = {.mass = 4.6, .speed = v, .thickness = pad * thinner, .count = COLUMNS};
    double height = fmin(0.08, pad);
    for (int k = 0; k < c.count; k++) {
        c.gap[k] = height * (k + 0.5) / c.count;
        c.area[k] = area * 2 * M_PI * (0.08 - c.gap[k]) * height / c.count;
    }
    return c;
}

static void start_rate(sf_foam_parameter unknown, double *value) {
    if (unknown == SF_PARAMETER_RATE_FACTOR)
        sf_foam_form_start_rate(value);
    if (unknown == SF_PARAMETER_ED) {
        value[SF_PARAMETER_ED] = 1e6;
        value[SF_PARAMETER_BETA1] = 3000;
    }
}

static void put_prior(sf_fit_input *in, int k) {
    in->prior[k] = in->start[in->unknown[k]];
    in->prior_sd[k] = sf_foam_form_prior_sd(&in->form, in->unknown[k]);
}

static void fill_input(const laboratory *lab, int m, sf_fit_input *in) {
    *in = (sf_fit_input){
        .form = {.curve = sf_curve_form_find(models[m].form), .base = lab->start.card, .solid_density = 940},
        .drop_count = LAB_DROPS,
        .unknown_count = UNKNOWNS};
    sf_foam_form_start(&in->form, in->start);
    for (int k = 0; k < UNKNOWNS; k++) {
        in->unknown[k] = models[m].unknown[k];
        start_rate(in->unknown[k], in->start);
        put_prior(in, k);
    }
    if (lab->locks) {
        sf_foam_form_start_lock(in->start);
        in->unknown[UNKNOWNS] = SF_PARAMETER_LOCKED;
        put_prior(in, in->unknown_count++);
    }
    for (int d = 0; d < LAB_DROPS; d++) {
        in->drop[d].predicted = d >= LAB_MEASURED;
        for (int kind = 0; kind < SF_FIT_SAMPLES; kind++)
            in->drop[d].value[kind] = NAN;
    }
}

void laboratory_init(laboratory *lab) {
    memset(lab, 0, sizeof *lab);
    lab->locks = getenv("SF_LOCK") != NULL;
    point_card_init(&lab->start);
    point_card_add_eva(&lab->start, 0, 100, 0.9, 1);
    lab->start.card.hysteresis_hu = 0.1;
    lab->start.card.hysteresis_shape = 1;
    for (int m = 0; m < LAB_MODELS; m++)
        fill_input(lab, m, &lab->input[m]);
    for (int d = 0; d < LAB_DROPS; d++) {
        lab->surrogate[d] = columns_of(speed[d], thickness[d], 1, 1);
        lab->real[d] = columns_of(speed[d], thickness[d], 1.15, 0.97);
    }
}

/* ---- the true foam ---- */

/* A gas curve with solid fraction, bent by a random smooth function, at three rates by a power law: loads and
 * unloads as none of the models. */
static void draw_foam(const laboratory *lab, gsl_rng *random, point_card *foam) {
    enum { POINTS = 300, WAVES = 4 };
    double strain[POINTS], stress[POINTS], amplitude[WAVES], phase[WAVES], pole = 1 - 1.4 * 35 / 940.;
    double yield = 8e3 * exp(gsl_ran_gaussian(random, 0.4)),
           gas = 115e3 * exp(gsl_ran_gaussian(random, 0.15)),
           dense = 30e3 * exp(gsl_ran_gaussian(random, 0.5)),
           exponent = 2.2 * exp(gsl_ran_gaussian(random, 0.15)),
           rate_exponent = gsl_ran_flat(random, 0.01, 0.05);
    for (int w = 0; w < WAVES; w++) {
        amplitude[w] = gsl_ran_gaussian(random, 0.08 / (w + 1));
        phase[w] = gsl_ran_flat(random, 0, 2 * M_PI);
    }
    point_card_init(foam);
    foam->card.modulus = lab->start.card.modulus;
    foam->card.hysteresis_hu = 0.1 * exp(gsl_ran_gaussian(random, 0.4));
    foam->card.hysteresis_shape = exp(gsl_ran_gaussian(random, 0.3));
    foam->card.hysteresis_alpha = gsl_ran_flat(random, 0.6, 1);
    for (int k = 0; k < POINTS; k++) {
        double e = strain[k] = 0.93 * k / (POINTS - 1), bend = 0;
        for (int w = 0; w < WAVES; w++)
            bend += amplitude[w] * (sin(2 * M_PI * (w + 0.5) * e + phase[w]) - sin(phase[w]));
        stress[k] = exp(bend) * (-yield * expm1(-0.3e6 * e / yield) + gas * e / (1 - e - 35 / 940.) +
                                 dense * pow(e / (pole - e), exponent));
        if (k > 0)
            stress[k] = larger(stress[k], 1.001 * stress[k - 1]);
    }
    if (lab->locks) { /* where it is earlier than the curve's own, from the prior of the models */
        double own = 1 - 1.4 * 35 / 940. * exp(gsl_ran_gaussian(random, 0.7));
        if (own < pole) {
            foam->card.densification_rule = SF_DENSIFICATION_H2;
            foam->card.densification_start = 0.95 * own;
            foam->card.densification_limit = own;
            foam->card.densification_exponent = 1;
        }
    }
    for (int c = 0; c < 3; c++) {
        double rate = pow(100, c), faster[POINTS];
        for (int k = 0; k < POINTS; k++)
            faster[k] = stress[k] * pow(rate, rate_exponent);
        point_card_add(foam, 0.01 * rate, POINTS, strain, faster);
    }
}

static sf_status measure(laboratory *lab, const sf_foam_card *card, sf_error *err) {
    const sf_material material = sf_foam_material(card);
    sf_material_law law;
    if (sf_material_law_build(&material, &law, err) != SF_OK)
        return err->status;
    for (int d = 0; d < LAB_DROPS && err->status == SF_OK; d++) {
        double y[SF_COLUMNS_LOGARITHMS];
        if (sf_columns_expect(&lab->real[d], &law, y, err) != SF_OK)
            break;
        memcpy(lab->truth[d], y, sizeof lab->truth[d]);
    }
    sf_material_law_free(&law);
    return err->status;
}

void laboratory_measure(laboratory *lab, gsl_rng *random) {
    sf_error err;
    do {
        point_card foam;
        err = (sf_error)SF_ERROR_INIT;
        draw_foam(lab, random, &foam);
        measure(lab, &foam.card, &err);
    } while (err.status != SF_OK);
    for (int d = 0; d < LAB_MEASURED; d++) {
        double window = WINDOW_RESOLUTION * round(exp(lab->truth[d][SF_FIT_WINDOW]) / WINDOW_RESOLUTION),
               a_max = exp(lab->truth[d][SF_FIT_A_MAX] + gsl_ran_gaussian(random, A_MAX_SD)),
               hic = exp(lab->truth[d][SF_FIT_HIC] + gsl_ran_gaussian(random, HIC_SD));
        for (int m = 0; m < LAB_MODELS; m++) {
            sf_fit_drop *drop = &lab->input[m].drop[d];
            drop->value[SF_FIT_A_MAX] = a_max;
            drop->sd[SF_FIT_A_MAX] = A_MAX_SD;
            drop->value[SF_FIT_HIC] = hic;
            drop->sd[SF_FIT_HIC] = HIC_SD;
            drop->value[SF_FIT_WINDOW] = window;
            drop->sd[SF_FIT_WINDOW] = sqrt(2. / 12) * WINDOW_RESOLUTION / window;
        }
    }
}

/* ---- identification by one model ---- */

sf_status laboratory_respond(const sf_drop_fit *fit, const sf_columns *columns, int count, int last,
                             const double *u, double *y, sf_error *err) {
    sf_drop_fit other = *fit;
    sf_foam_card card;
    memcpy(other.columns, columns, (size_t)count * sizeof *columns);
    SF_TRY(sf_drop_fit_card(other.input, u, &card, err));
    sf_drop_fit_respond(&other, 0, last, &card, NULL, y, err);
    sf_foam_card_free(&card);
    return err->status;
}

typedef struct bench {
    laboratory *lab;
    sf_drop_fit *fit;
} bench;

static sf_status surrogate(void *context, const double *u, double *y, sf_error *err) {
    const bench *b = context;
    return laboratory_respond(b->fit, b->lab->surrogate, LAB_DROPS, LAB_MEASURED, u, y, err);
}

static sf_status simulate(void *context, const double *u, double *y, sf_error *err) {
    const bench *b = context;
    return laboratory_respond(b->fit, b->lab->real, LAB_DROPS, LAB_MEASURED, u, y, err);
}

static void begin_fit(laboratory *lab, int m, sf_drop_fit *fit, double *measured, double *sd, double *y) {
    const sf_fit_input *in = &lab->input[m];
    *fit = (sf_drop_fit){.input = in,
                         .measured_drops = LAB_MEASURED,
                         .parameters = in->unknown_count,
                         .measured = measured,
                         .sd = sd,
                         .y = y};
    for (int d = 0; d < LAB_DROPS; d++) {
        fit->row[d + 1] = fit->row[d] + SF_FIT_SAMPLES + 1;
        fit->speed[d] = -1;
        fit->columns[d] = lab->surrogate[d];
        for (int kind = 0; kind < SF_FIT_SAMPLES; kind++) {
            bool known = !isnan(in->drop[d].value[kind]);
            measured[fit->row[d] + kind] = known ? log(in->drop[d].value[kind]) : 0;
            sd[fit->row[d] + kind] = known ? in->drop[d].sd[kind] : INFINITY;
        }
        sd[fit->row[d] + SF_FIT_SAMPLES] = INFINITY; /* the indentation, which is not bounded here */
    }
}

static sf_status fit_model(laboratory *lab, sf_drop_fit *fit, sf_error *err) {
    double prior[UNKNOWNS + 1];
    const int unknowns = fit->input->unknown_count;
    bench b = {lab, fit};
    for (int k = 0; k < unknowns; k++)
        prior[k] = log(fit->input->prior[k]);
    const sf_mapping_problem p = {.parameters = unknowns,
                                  .responses = fit->row[LAB_MEASURED],
                                  .start = prior,
                                  .prior = prior,
                                  .prior_sd = fit->input->prior_sd,
                                  .measured = fit->measured,
                                  .sd = fit->sd,
                                  .surrogate = surrogate,
                                  .simulate = simulate,
                                  .context = &b,
                                  .max_iterations = 6,
                                  .tolerance = 0.2};
    if (sf_mapping_solve(&p, &fit->result, err) != SF_OK)
        return err->status;
    return laboratory_respond(fit, lab->real, LAB_DROPS, LAB_DROPS, fit->result.u, fit->y, err);
}

/* ---- the tally ---- */

static void count(const laboratory *lab, const sf_drop_average *a, int which,
                  int inside[LAB_DROPS][LAB_KINDS], laboratory_tally *t) {
    static const double probability[] = {0.025, 0.5, 0.975};
    const sf_drop_inference *in = a->model[0];
    for (int q = 0; q < in->quantities; q++) {
        int d = in->quantity[q].drop, kind = in->quantity[q].kind;
        double value[3], truth = exp(lab->truth[d][kind]);
        sf_error err = SF_ERROR_INIT;
        sf_drop_average_quantiles(a, which, q, 3, probability, value, &err);
        assert(err.status == SF_OK);
        inside[d][kind] += truth >= value[0] && truth <= value[2];
        if (t) {
            t->open[d][kind] += isinf(value[2]);
            t->width[d][kind] += isinf(value[2]) ? 0 : log(value[2] / value[0]);
            t->miss[d][kind] += fabs(log(value[1] / truth));
            t->bias[d][kind] += log(value[1] / truth);
        }
    }
}

void laboratory_identify(laboratory *lab, const sf_inference_options *options, laboratory_tally *t) {
    enum { ROWS = LAB_DROPS * (SF_FIT_SAMPLES + 1) };
    static _Thread_local double measured[LAB_MODELS][ROWS], sd[LAB_MODELS][ROWS], y[LAB_MODELS][ROWS];
    sf_drop_fit *fit = calloc(LAB_MODELS, sizeof *fit);
    sf_drop_inference *inference = calloc(LAB_MODELS, sizeof *inference);
    const sf_drop_inference *list[LAB_MODELS];
    sf_drop_average average;
    sf_error err = SF_ERROR_INIT;
    assert(fit && inference);
    for (int m = 0; m < LAB_MODELS && err.status == SF_OK; m++) {
        begin_fit(lab, m, &fit[m], measured[m], sd[m], y[m]);
        list[m] = &inference[m];
        if (fit_model(lab, &fit[m], &err) == SF_OK)
            sf_drop_infer(&fit[m], options, &inference[m], &err);
    }
    t->foams++;
    if (err.status == SF_OK && sf_drop_average_build(LAB_MODELS, list, 1, &average, &err) == SF_OK) {
        t->reached += sf_drop_average_reached(&average);
        for (int m = 0; m < LAB_MODELS; m++)
            t->weight[m] += average.weight[m];
        count(lab, &average, -1, t->inside, t);
        count(lab, &average, sf_drop_average_best(&average), t->best_inside, NULL);
    }
    if (err.status != SF_OK) {
        t->failed++;
        fprintf(stderr, "%s\n", err.text);
    }
    for (int m = 0; m < LAB_MODELS; m++) {
        sf_drop_inference_free(&inference[m]);
        sf_mapping_free(&fit[m].result);
    }
    free(inference);
    free(fit);
}
