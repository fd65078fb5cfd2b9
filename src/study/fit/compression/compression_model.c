/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/compression/compression_model.h"

#include "material/low_density_foam.h"

static const double LAST_PART = 0.85; /* densification is fitted from this part of the shortest test on */
static const double FINER = 1.4; /* than cross-validation: the bend that a smoother curve cuts off stays below
                                    the scatter, of which alone the intervals tell */

void sf_compression_branch(const sf_compression_data *data, int test, bool unloading, int *first,
                           int *count) {
    const sf_compression_test *t = data->config->test;
    *first = 0;
    for (int k = 0; k < test; k++)
        *first += t[k].count;
    *first += unloading ? t[test].loading : 0;
    *count = unloading ? t[test].count - t[test].loading : t[test].loading;
}

static void fill(sf_compression_data *data) {
    int at = 0;
    double shortest = 1;
    for (int k = 0; k < data->config->test_count; k++) {
        const sf_compression_test *t = &data->config->test[k];
        data->end = fmax(data->end, t->largest_strain);
        shortest = fmin(shortest, t->largest_strain);
        for (int i = 0; i < t->count; i++, at++) {
            data->test[at] = k;
            data->unloading[at] = i >= t->loading;
            data->strain[at] = fmax(0, t->strain[i]);
            data->stress[at] = t->stress[i];
            data->largest = fmax(data->largest, t->stress[i]);
        }
    }
    data->start =
        data->config->densification_start > 0 ? data->config->densification_start : LAST_PART * shortest;
}

/* The branches on the chosen sides, 0 loading, 1 unloading. */
static int list_branches(const sf_compression_data *data, int sides,
                         sf_scatter_branch branches[SF_SCATTER_BRANCHES]) {
    int branch_count = 0;
    for (int k = 0; k < data->config->test_count; k++)
        for (int side = 0; side < sides; side++) {
            int first, count;
            sf_compression_branch(data, k, side == 1, &first, &count);
            if (count > 0)
                branches[branch_count++] =
                    (sf_scatter_branch){count, &data->strain[first], &data->stress[first],
                                        &data->smooth[first], &data->sigma[first]};
        }
    return branch_count;
}

static sf_status estimate(sf_compression_data *data, sf_error *err) {
    sf_scatter_branch branches[SF_SCATTER_BRANCHES];
    int intervals, all = list_branches(data, 2, branches);
    SF_TRY(sf_scatter_estimate(all, branches, &data->scatter, err));
    int loading = list_branches(data, 1, branches);
    SF_TRY(sf_scatter_intervals(loading, branches, &intervals, err));
    data->intervals = (int)ceil(FINER * intervals * sf_spline_part(data->end, data->start));
    return SF_OK;
}

sf_status sf_compression_data_init(const sf_compression_config *config, sf_compression_data *data,
                                   sf_error *err) {
    *data = (sf_compression_data){.config = config};
    for (int k = 0; k < config->test_count; k++)
        data->count += config->test[k].count;
    unsigned long n = (unsigned long)data->count;
    SF_TRY(SF_ALLOC_ALL(err, "test points", SF_ROOM(data->test, n), SF_ROOM(data->unloading, n),
                        SF_ROOM(data->strain, 4 * n)));
    data->stress = data->strain + n;
    data->smooth = data->stress + n;
    data->sigma = data->smooth + n;
    fill(data);
    return estimate(data, err);
}

void sf_compression_data_free(sf_compression_data *data) {
    SF_CLEAR(data, data->test, data->unloading, data->strain /* and all behind it */);
}

static const double MAXWELL_STEP = 0.0025; /* of strain: the law is exact for a constant rate of the Green
                                              strain, whose change over such a step is of no account */

/* The parameters in their own units. */
typedef struct numbers {
    double coefficient[SF_COMPRESSION_TESTS][SF_SPLINE_COEFFICIENTS]; /* Pa */
    double value[SF_NUMBERS];
} numbers;

/* ---- parameters ---- */

static double from_real(const sf_number_range *r, double x) {
    double part = 1 / (1 + exp(-fmax(-30, fmin(30, x))));
    if (isinf(r->high))
        return x;
    return r->logarithmic ? r->low * pow(r->high / r->low, part) : r->low + (r->high - r->low) * part;
}

static double to_real(const sf_number_range *r, double value) {
    if (isinf(r->high))
        return value;
    double part =
        r->logarithmic ? log(value / r->low) / log(r->high / r->low) : (value - r->low) / (r->high - r->low);
    part = fmax(1e-3, fmin(1 - 1e-3, part));
    return log(part / (1 - part));
}

double sf_compression_number(const sf_compression_model *model, const gsl_vector *parameters,
                             sf_number number) {
    const sf_number_range *r = &model->range[number];
    return r->index < 0 ? r->fixed : from_real(r, gsl_vector_get(parameters, (size_t)r->index));
}

static void unpack(const sf_compression_model *model, const gsl_vector *parameters, numbers *n) {
    int per_curve = model->spline.count - 1;
    for (int c = 0; c < model->curve_count; c++) {
        n->coefficient[c][0] = 0; /* no stress at no strain */
        for (int j = 0; j < per_curve; j++)
            n->coefficient[c][j + 1] =
                n->coefficient[c][j] + exp(gsl_vector_get(parameters, (size_t)(c * per_curve + j)));
    }
    for (int k = 0; k < SF_NUMBERS; k++)
        n->value[k] = sf_compression_number(model, parameters, (sf_number)k);
}

/* ---- the curve and its densification ---- */

static double product(int count, const double *row, const double *coefficient) {
    double sum = 0;
    for (int j = 0; j < count; j++)
        sum += row[j] * coefficient[j];
    return sum;
}

static double exponent_of(const sf_compression_model *model, const double *c, const numbers *n) {
    int count = model->spline.count;
    return model->form.rule != SF_H1_AUTO ? n->value[SF_NUMBER_EXPONENT]
                                          : sf_densification_natural_exponent(
                                                model->data->start, 1, product(count, model->start_row[0], c),
                                                product(count, model->start_row[1], c));
}

/* Stress (Pa) of a curve; `area` NULL: no energy is wanted. */
static double evaluate(const sf_compression_model *model, int curve, const numbers *n, double strain,
                       const double *value, const double *area, double *energy) {
    const double *c = n->coefficient[curve];
    int count = model->spline.count;
    double start = model->data->start, stress, slope, unused;
    if (!(strain > start)) {
        if (area)
            *energy = product(count, area, c);
        return product(count, value, c);
    }
    const sf_densification beyond =
        sf_densification_join(start, n->value[SF_NUMBER_LIMIT], exponent_of(model, c, n),
                              product(count, model->start_row[0], c), product(count, model->start_row[1], c),
                              product(count, model->start_row[2], c));
    sf_densification_evaluate(&beyond, strain, &stress, &slope, area ? energy : &unused);
    return stress;
}

/* ---- the Maxwell branch ---- */

/* Takes `held` (Pa, second Piola-Kirchhoff stress of a branch of 1 Pa) from one strain to another at a
 * constant rate, by steps of the law. */
static double maxwell_leg(double decay_rate, double rate, double from, double to, double held) {
    int steps = 1 + (int)(fabs(to - from) / MAXWELL_STEP);
    double dt = fabs(to - from) / rate / steps, old = 1 - from;
    for (int k = 1; k <= steps && dt > 0; k++) {
        double now = 1 - (from + (to - from) * k / steps);
        held = sf_foam_maxwell(1, decay_rate, dt, 0.5 * (now * now - old * old) / dt, held);
        old = now;
    }
    return held;
}

double sf_compression_maxwell(double decay_rate, double rate, double turn, double strain, bool unloading,
                              sf_compression_walk *walk) {
    if (unloading && !walk->unloading) {
        walk->held = maxwell_leg(decay_rate, rate, walk->strain, turn, walk->held);
        walk->strain = turn;
    }
    walk->held = maxwell_leg(decay_rate, rate, walk->strain, strain, walk->held);
    walk->strain = strain;
    walk->unloading = unloading;
    return -(1 - strain) * walk->held;
}

/* ---- prediction ---- */

/* Stress of loading at the rate of a test; `row`: of the spline at this strain. */
static double loading_stress(const sf_compression_model *model, const numbers *n, int test, double strain,
                             const double *row) {
    const sf_compression_test *t = model->data->config->test;
    double factor = model->form.rate == SF_RATE_LOG
                        ? 1 + n->value[SF_NUMBER_LOG_RATE] * log(t[test].rate / t[0].rate)
                        : 1;
    return factor * evaluate(model, model->curve_count > 1 ? test : 0, n, strain, row, NULL, NULL);
}

/* Unloading runs on the slowest curve: the rate overstress follows the filtered rate of compression, which is
 * zero. At a temperature of its own there is one curve. `peak`: energy at the turn of the point's test. */
static double unloading_stress(const sf_compression_model *model, const numbers *n, int i, double peak) {
    const sf_compression_data *d = model->data;
    int count = model->spline.count;
    double energy, stress = evaluate(model, d->config->thermal ? d->test[i] : 0, n, d->strain[i],
                                     &model->value_row[i * count], &model->area_row[i * count], &energy);
    return stress * sf_unloading_factor(n->value[SF_NUMBER_HU], n->value[SF_NUMBER_SHAPE],
                                        n->value[SF_NUMBER_ALPHA], fmax(1e-12, fmin(1, energy / peak)));
}

static double peak_energy(const sf_compression_model *model, const numbers *n, int test) {
    double energy;
    evaluate(model, model->data->config->thermal ? test : 0, n,
             model->data->config->test[test].largest_strain, model->peak_row[test][0],
             model->peak_row[test][1], &energy);
    return energy;
}

void sf_compression_predict(const sf_compression_model *model, const gsl_vector *parameters, bool unloading,
                            double *stress) {
    const sf_compression_data *d = model->data;
    sf_compression_walk walk = {0};
    double peak = 0;
    numbers n;
    unpack(model, parameters, &n);
    for (int i = 0, test = -1; i < d->count; i++) {
        const sf_compression_test *t = &d->config->test[d->test[i]];
        if (test != d->test[i]) {
            test = d->test[i];
            walk = (sf_compression_walk){0};
            peak = unloading ? peak_energy(model, &n, test) : 0;
        }
        double viscous = model->form.rate == SF_RATE_MAXWELL
                             ? n.value[SF_NUMBER_ED] *
                                   sf_compression_maxwell(n.value[SF_NUMBER_BETA1], t->rate, t->largest_strain,
                                                          d->strain[i], d->unloading[i], &walk)
                             : 0;
        if (d->unloading[i] == unloading)
            stress[i] = viscous + (unloading ? unloading_stress(model, &n, i, peak)
                                             : loading_stress(model, &n, test, d->strain[i],
                                                              &model->value_row[i * model->spline.count]));
    }
}

double sf_compression_exponent(const sf_compression_model *model, const gsl_vector *parameters) {
    numbers n;
    unpack(model, parameters, &n);
    return exponent_of(model, n.coefficient[0], &n);
}

double sf_compression_curve(const sf_compression_model *model, const gsl_vector *parameters, int test,
                            double strain) {
    sf_spline spline = model->spline; /* GSL's workspace is scratch */
    double row[SF_SPLINE_COEFFICIENTS];
    numbers n;
    unpack(model, parameters, &n);
    sf_spline_value(&spline, fmin(strain, model->data->start), row);
    return loading_stress(model, &n, test, strain, row);
}

/* ---- set-up ---- */

static void set_ranges(sf_compression_model *model) {
    const sf_compression_data *d = model->data;
    const sf_compression_config *c = d->config;
    double size = 0, longest = 0, shortest = INFINITY;
    bool hysteresis = false, maxwell = model->form.rate == SF_RATE_MAXWELL;
    for (int k = 0; k < c->test_count; k++) {
        hysteresis = hysteresis || c->test[k].count > c->test[k].loading;
        size = fmax(size, c->test[k].largest_stress);
        longest = fmax(longest, c->test[k].largest_strain / c->test[k].rate);
        shortest = fmin(shortest, c->test[k].largest_strain / c->test[k].rate);
    }
    const sf_number_range range[SF_NUMBERS] = {
        [SF_NUMBER_HU] = {hysteresis, false, 1e-4, 1, 1},
        [SF_NUMBER_SHAPE] = {hysteresis, true, 0.05, 50, 1},
        [SF_NUMBER_ALPHA] = {hysteresis && model->form.alpha, true, 0.1, 10, 1},
        [SF_NUMBER_LOG_RATE] = {model->form.rate == SF_RATE_LOG, false, 0, INFINITY, 0},
        [SF_NUMBER_ED] = {maxwell, true, 1e-5 * size, 1e3 * size, 0},
        [SF_NUMBER_BETA1] = {maxwell, true, 0.01 / longest, 100 / shortest, 5000},
        [SF_NUMBER_EXPONENT] = {model->form.rule != SF_H1_AUTO, true, 0.05, 60, 0},
        [SF_NUMBER_LIMIT] = {model->form.rule == SF_H2, false, d->end + 0.05 * (1 - d->end), 1, 1},
    };
    memcpy(model->range, range, sizeof range);
    int index = model->curve_count * (model->spline.count - 1);
    for (int k = 0; k < SF_NUMBERS; k++) {
        if (k == SF_NUMBER_HU)
            model->loading_count = index;
        model->range[k].index = model->range[k].index ? index++ : -1;
    }
    model->parameter_count = index;
}

/* Knots as fine as the data's intervals, and no finer than the points of every test. */
static sf_status make_spline(sf_compression_model *model, sf_error *err) {
    const sf_compression_data *d = model->data;
    sf_spline_data sets[SF_COMPRESSION_TESTS];
    double breaks[SF_SPLINE_BREAKS];
    int tests = d->config->test_count;
    for (int k = 0; k < tests; k++) {
        int first;
        sf_compression_branch(d, k, false, &first, &sets[k].count);
        sets[k].x = &d->strain[first];
    }
    int count = sf_spline_place(SF_GRADING_FOAM, d->intervals, 0, d->start, tests, sets, breaks);
    return sf_spline_init(&model->spline, count, breaks, err);
}

static void fill_rows(sf_compression_model *model) {
    const sf_compression_data *d = model->data;
    int count = model->spline.count;
    for (int i = 0; i < d->count; i++) {
        if (d->strain[i] > d->start)
            continue;
        sf_spline_value(&model->spline, d->strain[i], &model->value_row[i * count]);
        if (d->unloading[i])
            sf_spline_integral(&model->spline, d->strain[i], &model->area_row[i * count]);
    }
    sf_spline_value(&model->spline, d->start, model->start_row[0]);
    sf_spline_slope(&model->spline, d->start, model->start_row[1]);
    sf_spline_integral(&model->spline, d->start, model->start_row[2]);
    for (int k = 0; k < d->config->test_count; k++) {
        double turn = fmin(d->start, d->config->test[k].largest_strain);
        sf_spline_value(&model->spline, turn, model->peak_row[k][0]);
        sf_spline_integral(&model->spline, turn, model->peak_row[k][1]);
    }
}

sf_status sf_compression_model_init(const sf_compression_data *data, sf_compression_form form,
                                    sf_compression_model *model, sf_error *err) {
    *model = (sf_compression_model){.data = data, .form = form};
    model->curve_count = form.rate == SF_RATE_CURVES ? data->config->test_count : 1;
    SF_TRY(make_spline(model, err));
    unsigned long items = (unsigned long)data->count * (unsigned long)model->spline.count;
    SF_TRY(
        SF_ALLOC_ALL(err, "spline rows", SF_ROOM(model->value_row, items), SF_ROOM(model->area_row, items)));
    set_ranges(model);
    fill_rows(model);
    return SF_OK;
}

void sf_compression_model_free(sf_compression_model *model) {
    sf_spline_free(&model->spline);
    SF_CLEAR(model, model->value_row, model->area_row);
}

/* ---- where a search begins ---- */

/* Smoothed loading stress of a test at a strain. */
static double smoothed(const sf_compression_data *d, int test, double strain) {
    int first, count;
    sf_compression_branch(d, test, false, &first, &count);
    return sf_compression_at(count, &d->strain[first], &d->smooth[first], strain);
}

static void guess_curve(const sf_compression_model *model, int curve, gsl_vector *parameters) {
    const sf_compression_data *d = model->data;
    int per_curve = model->spline.count - 1;
    double before = 0, least = 1e-4 * smoothed(d, curve, d->start) / per_curve;
    for (int j = 0; j < per_curve; j++) {
        double value = smoothed(d, curve, sf_spline_abscissa(&model->spline, j + 1));
        double increment = fmax(least, value - before);
        gsl_vector_set(parameters, (size_t)(curve * per_curve + j), log(increment));
        before += increment;
    }
}

void sf_compression_guess(const sf_compression_model *model, double decay, gsl_vector *parameters) {
    const sf_number_range *r = model->range;
    for (int c = 0; c < model->curve_count; c++)
        guess_curve(model, c, parameters);
    const double start[SF_NUMBERS] = {
        [SF_NUMBER_HU] = 0.1,
        [SF_NUMBER_SHAPE] = 2,
        [SF_NUMBER_ALPHA] = 1,
        [SF_NUMBER_LOG_RATE] = 0.03,
        [SF_NUMBER_ED] = 0.1 * smoothed(model->data, 0, model->data->start),
        [SF_NUMBER_BETA1] =
            r[SF_NUMBER_BETA1].low * pow(r[SF_NUMBER_BETA1].high / r[SF_NUMBER_BETA1].low, decay),
        [SF_NUMBER_EXPONENT] = model->form.rule == SF_H2 ? 1.5 : 2.5,
        [SF_NUMBER_LIMIT] = 0.5 * (r[SF_NUMBER_LIMIT].low + r[SF_NUMBER_LIMIT].high),
    };
    for (int k = 0; k < SF_NUMBERS; k++)
        if (r[k].index >= 0)
            gsl_vector_set(parameters, (size_t)r[k].index, to_real(&r[k], start[k]));
}
