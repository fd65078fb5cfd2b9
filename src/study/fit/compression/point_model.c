/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/fit/compression/point_model.h"

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

/* Stress and energy of a curve at one strain, with gradients by its coefficients and by exponent and limit.
 */
typedef struct ordinate {
    double stress, energy;
    double stress_by[SF_SPLINE_COEFFICIENTS], energy_by[SF_SPLINE_COEFFICIENTS];
    double stress_by_exponent, stress_by_limit, energy_by_exponent, energy_by_limit;
} ordinate;

/* ---- parameters ---- */

static double from_real(const sf_number_range *r, double x, double *slope) {
    if (isinf(r->high)) {
        *slope = 1;
        return x;
    }
    double part = 1 / (1 + exp(-fmax(-30, fmin(30, x)))), change = part * (1 - part);
    if (!r->logarithmic) {
        *slope = (r->high - r->low) * change;
        return r->low + (r->high - r->low) * part;
    }
    double value = r->low * pow(r->high / r->low, part);
    *slope = value * log(r->high / r->low) * change;
    return value;
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
                             sf_number number, double *slope) {
    const sf_number_range *r = &model->range[number];
    double ignored;
    return r->index < 0
               ? r->fixed
               : from_real(r, gsl_vector_get(parameters, (size_t)r->index), slope ? slope : &ignored);
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
        n->value[k] = sf_compression_number(model, parameters, (sf_number)k, NULL);
}

/* ---- the curve and its densification ---- */

/* The densification for a unit slope at its start and no stress or energy there, by which stress = s + s' D,
 * energy = W + s (strain - start) + s' (integral of D): out = {D, its integral}. */
static void densification(double start, double exponent, double limit, double strain, double out[2]) {
    const sf_densification unit = sf_densification_join(start, limit, exponent, 0, 1, 0);
    double slope;
    sf_densification_evaluate(&unit, strain, &out[0], &slope, &out[1]);
}

static double product(int count, const double *row, const double *coefficient) {
    double sum = 0;
    for (int j = 0; j < count; j++)
        sum += row[j] * coefficient[j];
    return sum;
}

/* The exponent that makes A vanish, m = room s'/s, and its gradient by the coefficients. */
static double natural_exponent(const sf_compression_model *model, const double *c, double *by) {
    int n = model->spline.count;
    double room = 1 - model->data->start, s = product(n, model->start_row[0], c),
           d = product(n, model->start_row[1], c);
    for (int j = 0; j < n && by; j++)
        by[j] = room * (model->start_row[1][j] / s - d * model->start_row[0][j] / (s * s));
    return sf_densification_natural_exponent(model->data->start, 1, s, d);
}

static void evaluate_beyond(const sf_compression_model *model, const double *c, double exponent, double limit,
                            double strain, ordinate *o) {
    int n = model->spline.count;
    const double(*row)[SF_SPLINE_COEFFICIENTS] = model->start_row;
    double start = model->data->start, h = 1e-5, by[SF_SPLINE_COEFFICIENTS] = {0}, d[2], up[2], down[2];
    bool automatic = model->form.rule == SF_H1_AUTO;
    if (automatic)
        exponent = natural_exponent(model, c, by);
    densification(start, exponent, limit, strain, d);
    double s = product(n, row[0], c), slope = product(n, row[1], c), width = strain - start;
    o->stress = s + slope * d[0];
    o->energy = product(n, row[2], c) + s * width + slope * d[1];
    densification(start, exponent * (1 + h), limit, strain, up);
    densification(start, exponent * (1 - h), limit, strain, down);
    o->stress_by_exponent = slope * (up[0] - down[0]) / (2 * h * exponent);
    o->energy_by_exponent = slope * (up[1] - down[1]) / (2 * h * exponent);
    h *= limit - strain;
    densification(start, exponent, limit + h, strain, up);
    densification(start, exponent, limit - h, strain, down);
    o->stress_by_limit = slope * (up[0] - down[0]) / (2 * h);
    o->energy_by_limit = slope * (up[1] - down[1]) / (2 * h);
    for (int j = 0; j < n; j++) {
        o->stress_by[j] = row[0][j] + row[1][j] * d[0] + o->stress_by_exponent * by[j];
        o->energy_by[j] = row[2][j] + row[0][j] * width + row[1][j] * d[1] + o->energy_by_exponent * by[j];
    }
    if (automatic)
        o->stress_by_exponent = o->energy_by_exponent = 0;
}

/* `area` may be NULL where no energy is wanted. */
static void evaluate(const sf_compression_model *model, const double *c, const numbers *n, double strain,
                     const double *value, const double *area, ordinate *o) {
    int count = model->spline.count;
    if (strain > model->data->start) {
        evaluate_beyond(model, c, n->value[SF_NUMBER_EXPONENT], n->value[SF_NUMBER_LIMIT], strain, o);
        return;
    }
    o->stress = product(count, value, c);
    memcpy(o->stress_by, value, (size_t)count * sizeof *value);
    o->stress_by_exponent = o->stress_by_limit = o->energy_by_exponent = o->energy_by_limit = 0;
    if (area) {
        o->energy = product(count, area, c);
        memcpy(o->energy_by, area, (size_t)count * sizeof *area);
    }
}

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

/* ---- derivatives into the parameter vector ---- */

/* Adds `factor` times a gradient by the coefficients of a curve: an increment raises all coefficients after
 * it, and is its own derivative by its logarithm. */
static void add_coefficients(const sf_compression_model *model, const numbers *n, int curve, const double *by,
                             double factor, double *gradient) {
    int per_curve = model->spline.count - 1;
    const double *c = n->coefficient[curve];
    double sum = 0;
    for (int j = per_curve - 1; j >= 0; j--) {
        sum += by[j + 1];
        gradient[curve * per_curve + j] += factor * sum * (c[j + 1] - c[j]);
    }
}

static void add_number(const sf_compression_model *model, const gsl_vector *parameters, sf_number number,
                       double by, double *gradient) {
    double slope = 0;
    if (model->range[number].index < 0)
        return;
    sf_compression_number(model, parameters, number, &slope);
    gradient[model->range[number].index] += by * slope;
}

static void add_densification(const sf_compression_model *model, const gsl_vector *parameters,
                              double by_exponent, double by_limit, double *gradient) {
    add_number(model, parameters, SF_NUMBER_EXPONENT, by_exponent, gradient);
    add_number(model, parameters, SF_NUMBER_LIMIT, by_limit, gradient);
}

/* Walks along a test with three decay rates: the one wanted, and one on either side for its derivative. */
typedef struct branch {
    int test;
    sf_compression_walk walk[3];
} branch;

static double predict_maxwell(const sf_compression_model *model, const gsl_vector *parameters,
                              const numbers *n, int i, branch *m, double *gradient) {
    const sf_compression_data *d = model->data;
    const sf_compression_test *t = &d->config->test[d->test[i]];
    double modulus = n->value[SF_NUMBER_ED], beta = n->value[SF_NUMBER_BETA1], h = 1e-5, unit[3] = {0};
    const double rate[3] = {beta, beta * (1 + h), beta * (1 - h)};
    if (m->test != d->test[i])
        *m = (branch){.test = d->test[i]};
    for (int k = 0; k < (gradient ? 3 : 1); k++)
        unit[k] = sf_compression_maxwell(rate[k], t->rate, t->largest_strain, d->strain[i], d->unloading[i],
                                         &m->walk[k]);
    if (gradient) {
        add_number(model, parameters, SF_NUMBER_ED, unit[0], gradient);
        add_number(model, parameters, SF_NUMBER_BETA1, modulus * (unit[1] - unit[2]) / (2 * h * beta),
                   gradient);
    }
    return modulus * unit[0];
}

/* Stress of loading at the rate of a test; `row`: of the spline at this strain. Adds to `gradient` or NULL.
 */
static double loading_stress(const sf_compression_model *model, const gsl_vector *parameters,
                             const numbers *n, int test, double strain, const double *row, double *gradient) {
    int curve = model->curve_count > 1 ? test : 0;
    const sf_compression_test *t = model->data->config->test;
    double logarithm = model->form.rate == SF_RATE_LOG ? log(t[test].rate / t[0].rate) : 0,
           factor = 1 + n->value[SF_NUMBER_LOG_RATE] * logarithm;
    ordinate o;
    evaluate(model, n->coefficient[curve], n, strain, row, NULL, &o);
    if (gradient) {
        add_coefficients(model, n, curve, o.stress_by, factor, gradient);
        add_densification(model, parameters, factor * o.stress_by_exponent, factor * o.stress_by_limit,
                          gradient);
        add_number(model, parameters, SF_NUMBER_LOG_RATE, logarithm * o.stress, gradient);
    }
    return factor * o.stress;
}

/* Unloading runs on the slowest curve: the rate overstress follows the filtered rate of compression, which is
 * zero. At a temperature of its own there is one curve. */
static double predict_unloading(const sf_compression_model *model, const gsl_vector *parameters,
                                const numbers *n, int i, double *gradient) {
    const sf_compression_data *d = model->data;
    const sf_compression_test *t = &d->config->test[d->test[i]];
    int count = model->spline.count, curve = d->config->thermal ? d->test[i] : 0;
    double hu = n->value[SF_NUMBER_HU], shape = n->value[SF_NUMBER_SHAPE], alpha = n->value[SF_NUMBER_ALPHA];
    ordinate o, peak;
    evaluate(model, n->coefficient[curve], n, d->strain[i], &model->value_row[i * count],
             &model->area_row[i * count], &o);
    evaluate(model, n->coefficient[curve], n, t->largest_strain, model->peak_row[d->test[i]][0],
             model->peak_row[d->test[i]][1], &peak);
    double ratio = fmax(1e-12, fmin(1, o.energy / peak.energy)), power = pow(ratio, shape);
    double rest = fmax(1e-9, 1 - power), loss = pow(rest, alpha),
           slope = (1 - hu) * alpha * loss / rest * power;
    double factor = sf_unloading_factor(hu, shape, alpha, ratio), bend = shape * slope * o.stress;
    if (gradient) {
        double by_energy = bend / fmax(o.energy, 1e-12 * peak.energy), by_peak = -bend / peak.energy;
        add_coefficients(model, n, curve, o.stress_by, factor, gradient);
        add_coefficients(model, n, curve, o.energy_by, by_energy, gradient);
        add_coefficients(model, n, curve, peak.energy_by, by_peak, gradient);
        add_densification(model, parameters,
                          factor * o.stress_by_exponent + by_energy * o.energy_by_exponent +
                              by_peak * peak.energy_by_exponent,
                          factor * o.stress_by_limit + by_energy * o.energy_by_limit +
                              by_peak * peak.energy_by_limit,
                          gradient);
        add_number(model, parameters, SF_NUMBER_HU, loss * o.stress, gradient);
        add_number(model, parameters, SF_NUMBER_SHAPE, slope * log(ratio) * o.stress, gradient);
        add_number(model, parameters, SF_NUMBER_ALPHA, -(1 - hu) * loss * log(rest) * o.stress, gradient);
    }
    return factor * o.stress;
}

void sf_compression_predict(const sf_compression_model *model, const gsl_vector *parameters, double *stress,
                            gsl_matrix *jacobian) {
    const sf_compression_data *d = model->data;
    branch maxwell = {.test = -1};
    numbers n;
    unpack(model, parameters, &n);
    if (jacobian)
        gsl_matrix_set_zero(jacobian);
    for (int i = 0; i < d->count; i++) {
        double *gradient = jacobian ? gsl_matrix_ptr(jacobian, (size_t)i, 0) : NULL;
        stress[i] = d->unloading[i] ? predict_unloading(model, parameters, &n, i, gradient)
                                    : loading_stress(model, parameters, &n, d->test[i], d->strain[i],
                                                     &model->value_row[i * model->spline.count], gradient);
        if (model->form.rate == SF_RATE_MAXWELL)
            stress[i] += predict_maxwell(model, parameters, &n, i, &maxwell, gradient);
    }
}

double sf_compression_exponent(const sf_compression_model *model, const gsl_vector *parameters,
                               double *gradient) {
    numbers n;
    double by[SF_SPLINE_COEFFICIENTS];
    unpack(model, parameters, &n);
    memset(gradient, 0, (size_t)model->parameter_count * sizeof *gradient);
    if (model->form.rule != SF_H1_AUTO) {
        add_number(model, parameters, SF_NUMBER_EXPONENT, 1, gradient);
        return n.value[SF_NUMBER_EXPONENT];
    }
    double exponent = natural_exponent(model, n.coefficient[0], by);
    add_coefficients(model, &n, 0, by, 1, gradient);
    return exponent;
}

double sf_compression_curve(sf_compression_model *model, const gsl_vector *parameters, int test,
                            double strain, double *gradient) {
    double row[SF_SPLINE_COEFFICIENTS];
    numbers n;
    unpack(model, parameters, &n);
    sf_spline_value(&model->spline, fmin(strain, model->data->start), row);
    if (gradient)
        memset(gradient, 0, (size_t)model->parameter_count * sizeof *gradient);
    return loading_stress(model, parameters, &n, test, strain, row, gradient);
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
