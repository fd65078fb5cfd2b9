/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "case/curves.h"
#include "study/fit/compression/form_fit.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_statistics_double.h>

#include "material/low_density_foam.h"

/* ---- the record ---- */

static const double TURN = 0.05;       /* strain by which a turn differs from scatter */
static const double RETURN = 0.25;     /* part of the largest strain below which a cycle must end */
static const double UNLOADED = 0.1;    /* the same of a pause */
static const double LONGEST_STEP = 20; /* mean steps of time, above which a step is a pause */
static const double LIMIT = 0.98;      /* strain */

/* The pause (s) before point i; 0: none. */
static double pause_before(const sf_cycle_record *r, int i) {
    double mean = (r->time[r->count - 1] - r->time[0]) / (r->count - 1), largest = r->strain[r->turn[1]];
    if (i == 0 || r->strain[i - 1] > UNLOADED * largest || r->strain[i] > UNLOADED * largest)
        return 0;
    double step = r->time[i] - r->time[i - 1];
    return step > LONGEST_STEP * fmin(mean, 1) ? step : 0;
}

static sf_status take_tables(const char *path, sf_cycle_record *r, sf_error *err) {
    const sf_table_layout layouts[2] = {
        sf_case_curve_layout("record of cycles", NULL),
        {.what = "record of cycles", .kind = "compression", .column = {&sf_column_time, &sf_column_strain}}};
    SF_OWNED_BY(sf_table_free) sf_table stress = {0}, time = {0};
    SF_TRY(sf_table_read(path, &layouts[0], &stress, err));
    SF_TRY(sf_table_read(path, &layouts[1], &time, err));
    if (stress.count != time.count)
        return SF_REFUSE(err, "%s: %lld rows with stress, %lld with time", path, (long long)stress.count,
                         (long long)time.count);
    r->count = (int)stress.count;
    r->strain = stress.value[0];
    r->stress = stress.value[1];
    r->time = time.value[0];
    stress.value[0] = stress.value[1] = time.value[0] = NULL;
    for (int i = 0; i < r->count; i++) {
        if (!(r->strain[i] < LIMIT) || (i > 0 && !(r->time[i] > r->time[i - 1])))
            return SF_REFUSE(
                err, "%s:%d: time %g s after %g s, strain %g: time must rise, strain stay below %g", path,
                stress.line[i], r->time[i], i > 0 ? r->time[i - 1] : 0, r->strain[i], LIMIT);
        r->strain[i] = fmax(0, r->strain[i]);
        r->largest_stress = fmax(r->largest_stress, r->stress[i]);
    }
    return err->status;
}

/* Turns by strain; a loading that is not followed by an unloading is left out. */
static sf_status find_turns(sf_cycle_record *r, sf_error *err) {
    int turns = 1, at = 0;
    bool up = true;
    for (int i = 0; i < r->count; i++) {
        double gain = up ? r->strain[i] - r->strain[at] : r->strain[at] - r->strain[i];
        if (gain > 0) {
            at = i;
        } else if (-gain > TURN) {
            if (turns == 2 * SF_CYCLES)
                return SF_REFUSE(err, "%s: more than %d cycles", r->path, SF_CYCLES);
            r->turn[turns++] = at;
            up = !up;
            at = i;
        }
    }
    r->cycles = turns / 2;
    if (!up)
        r->turn[turns] = at;
    if (r->cycles < 2)
        return SF_REFUSE(err, "%s: %d cycle of compression: memory is in the cycles after the first", r->path,
                         r->cycles);
    for (int c = 0; c < r->cycles; c++)
        if (r->strain[r->turn[2 * c + 2]] > RETURN * r->strain[r->turn[2 * c + 1]])
            return SF_REFUSE(err,
                             "%s: cycle %d returns from a strain of %g to %g only; it must unload below a "
                             "quarter of it",
                             r->path, c + 1, r->strain[r->turn[2 * c + 1]], r->strain[r->turn[2 * c + 2]]);
    return SF_OK;
}

static sf_status read_record(const sf_config *file, sf_config_item *group, sf_cycle_record *r,
                             sf_error *err) {
    double fitted = SF_CYCLES;
    sf_error inner = SF_ERROR_INIT;
    if (!config_setting_is_group(group))
        return sf_config_refuse(
            file, group, err,
            "cycles must be a group or a list of groups: cycles = { file = \"cycles.csv\"; };");
    SF_TRY(sf_config_names(file, group, "file|fitted", err));
    SF_TRY(sf_config_whole(file, group, "fitted", false, 2, SF_CYCLES, &fitted, err));
    SF_TRY(sf_config_file(file, group, "file", true, &r->path, err));
    if (take_tables(r->path, r, &inner) != SF_OK || find_turns(r, &inner) != SF_OK)
        return sf_config_refuse(file, group, err, "%s", inner.text);
    r->fitted = fitted < r->cycles ? (int)fitted : r->cycles;
    for (int i = 1; i < r->turn[2 * r->fitted]; i++)
        r->pauses += pause_before(r, i) > 0;
    return SF_OK;
}

static bool is_same_record(const sf_cycle_record *a, const sf_cycle_record *b) {
    return a->count == b->count && memcmp(a->stress, b->stress, (size_t)a->count * sizeof *a->stress) == 0;
}

sf_status sf_cycle_records_read(const sf_config *file, sf_config_item *root, sf_compression_config *c,
                                sf_error *err) {
    sf_config_item *item = config_setting_get_member(root, "cycles");
    bool list = item && config_setting_is_list(item);
    if (list)
        SF_TRY(sf_config_list(file, root, "cycles", true, SF_CYCLE_RECORDS, &item, err));
    for (int k = 0; item && k < (list ? config_setting_length(item) : 1); k++) {
        sf_config_item *group = list ? config_setting_get_elem(item, (unsigned)k) : item;
        SF_TRY(read_record(file, group, &c->cycles[c->record_count++], err));
        for (int j = 0; j < k; j++)
            if (is_same_record(&c->cycles[j], &c->cycles[k]))
                return sf_config_refuse(file, group, err, "cycles: the record %s is given twice",
                                        c->cycles[j].path);
    }
    return SF_OK;
}

void sf_cycle_record_free(sf_cycle_record *r) {
    SF_CLEAR(r, r->path, r->time, r->strain, r->stress);
}

/* ---- the law along the record ---- */

enum { HYSTERESIS = 3, MEMORY = SF_CYCLE_MEMORY, MOST = SF_FORM_UNKNOWNS + HYSTERESIS + MEMORY };
static const double FAR = 10; /* deviation where the values make no foam */

/* Bounds of HU, SHAPE and ALPHA; those of the memory are the parameters' own. The logarithm is searched. */
static const double LEAST[HYSTERESIS] = {1e-4, 0.05, 0.1}, LARGEST[HYSTERESIS] = {0.999, 20, 5};

static double least_of(int k) {
    return k < HYSTERESIS ? LEAST[k] : sf_cycle_parameter(k - HYSTERESIS)->low;
}

static double largest_of(int k) {
    return k < HYSTERESIS ? LARGEST[k] : sf_cycle_parameter(k - HYSTERESIS)->high;
}

typedef struct problem {
    const sf_form_fit *fit;
    int memory;     /* unknowns of MEMORY: those that the records can tell come first */
    double *stress; /* [count of the longest record] Pa, of the law at the last evaluation */
} problem;

/* Points of a record that are fitted. */
static int fitted_points(const sf_cycle_record *r) {
    return r->turn[2 * r->fitted] + 1;
}

static double bounded(double low, double high, double x) {
    return low * pow(high / low, sf_logistic(x));
}

static double unbounded(double low, double high, double value) {
    double part = fmin(0.999, fmax(0.001, log(value / low) / log(high / low)));
    return log(part / (1 - part));
}

static void take(const problem *p, const gsl_vector *x, double *value, double own[HYSTERESIS + MEMORY]) {
    const sf_form_request *r = &p->fit->config->form;
    memcpy(value, p->fit->value, SF_PARAMETER_COUNT * sizeof *value);
    for (int k = 0; k < r->unknown_count; k++) {
        const sf_parameter_info *about = sf_parameter_get(r->unknown[k]);
        value[r->unknown[k]] = bounded(about->low, about->high, gsl_vector_get(x, (size_t)k));
    }
    for (int k = 0; k < HYSTERESIS + MEMORY; k++)
        own[k] = k < HYSTERESIS + p->memory
                     ? bounded(least_of(k), largest_of(k), gsl_vector_get(x, (size_t)(r->unknown_count + k)))
                     : 0;
}

static void put_hysteresis(const double own[HYSTERESIS + MEMORY], sf_foam_card *card) {
    card->hysteresis_hu = own[0];
    card->hysteresis_shape = own[1];
    card->hysteresis_alpha = own[2];
    card->memory = (sf_memory){.reload = own[3], .drift = own[4], .recovery = own[5], .start = 1};
}

/* Stress (Pa) of the card along the record up to point `end`. */
static sf_status follow(const sf_cycle_record *r, const sf_foam_card *card, int end, double *stress,
                        sf_error *err) {
    const sf_material material = sf_foam_material(card);
    SF_OWNED_BY(sf_material_law_free) sf_material_law law = {0};
    sf_uniaxial point = {0};
    SF_TRY(sf_material_law_build(&material, &law, err));
    for (int i = 0; i < end; i++) {
        double pause = pause_before(r, i);
        if (pause > 0)
            sf_material_point_rest(&law, pause, &point);
        double step = i > 0 ? r->time[i] - r->time[i - 1] : 1;
        stress[i] = law.law->uniaxial(law.numbers, step, r->strain[i], &point);
    }
    return SF_OK;
}

static int deviate(const gsl_vector *x, void *data, gsl_vector *out) {
    const problem *p = data;
    double value[SF_PARAMETER_COUNT], own[HYSTERESIS + MEMORY];
    SF_OWNED_BY(sf_foam_card_free) sf_foam_card card = {0};
    sf_error err = SF_ERROR_INIT;
    size_t row = 0;
    take(p, x, value, own);
    bool made = sf_foam_form_card(&p->fit->config->form.form, value, &card, &err) == SF_OK;
    put_hysteresis(own, &card);
    for (int k = 0; k < p->fit->config->record_count; k++) {
        const sf_cycle_record *r = &p->fit->config->cycles[k];
        made = made && follow(r, &card, fitted_points(r), p->stress, &err) == SF_OK;
        for (int i = 0; i < fitted_points(r); i++) {
            double d = made ? (p->stress[i] - r->stress[i]) / r->largest_stress : FAR;
            gsl_vector_set(out, row++, isfinite(d) ? fmin(FAR, fmax(-FAR, d)) : FAR);
        }
    }
    return GSL_SUCCESS;
}

static void put_start(const problem *p, gsl_vector *x) {
    static const double memory[MEMORY] = {0.4, 0.2, 0.1};
    const sf_form_request *r = &p->fit->config->form;
    for (int k = 0; k < r->unknown_count; k++) {
        const sf_parameter_info *about = sf_parameter_get(r->unknown[k]);
        gsl_vector_set(x, (size_t)k, unbounded(about->low, about->high, p->fit->value[r->unknown[k]]));
    }
    for (int k = 0; k < HYSTERESIS + p->memory; k++)
        gsl_vector_set(x, (size_t)(r->unknown_count + k),
                       unbounded(least_of(k), largest_of(k),
                                 k < HYSTERESIS ? p->fit->unloading.fit.value[k] : memory[k - HYSTERESIS]));
}

/* The half widths, from the slope of each bounded value. */
static void take_errors(const problem *p, const gsl_vector *x, const gsl_matrix *covariance, double variance,
                        const double own[HYSTERESIS + MEMORY], sf_form_fit *fit) {
    int first = p->fit->config->form.unknown_count;
    for (int k = 0; k < first + HYSTERESIS + p->memory; k++) {
        double part = sf_logistic(gsl_vector_get(x, (size_t)k)),
               error = part * (1 - part) * sqrt(variance * gsl_matrix_get(covariance, (size_t)k, (size_t)k));
        int of_law = k - first;
        if (of_law < 0) {
            const sf_parameter_info *about = sf_parameter_get(p->fit->config->form.unknown[k]);
            fit->error[k] = log(about->high / about->low) * error;
            fit->at_bound[k] = sf_is_at_end(part);
        } else if (of_law < HYSTERESIS) {
            fit->unloading.fit.at_bound[of_law] = sf_is_at_end(part);
        } else {
            fit->memory_width[of_law - HYSTERESIS] =
                sf_is_at_end(part) ? NAN
                                   : 2 * own[of_law] * log(largest_of(of_law) / least_of(of_law)) * error;
        }
    }
}

/* Compares a record with the fitted law. */
static sf_status follow_record(const sf_cycle_record *r, const sf_foam_card *card, sf_cycle_result *c,
                               sf_error *err) {
    c->stress = sf_alloc(err, r->count, sizeof *c->stress, "cycles");
    if (err->status != SF_OK || follow(r, card, r->count, c->stress, err) != SF_OK)
        return err->status;
    for (int k = 0; k < 2 * r->cycles; k++)
        c->rms[k % 2][k / 2] =
            sf_form_rms(r->stress, r->largest_stress, c->stress, r->turn[k], r->turn[k + 1] + 1);
    return SF_OK;
}

/* The strain at which a stress reaches 1 % of the record's largest, from point `first` on and before `end`.
 */
static double taken_up(const sf_cycle_record *r, const double *stress, int first, int end) {
    const double least = 0.01 * r->largest_stress, *strain = r->strain;
    int i = first;
    while (i < end && stress[i] < least)
        i++;
    return i == first ? strain[i]
                      : strain[i - 1] + (least - stress[i - 1]) / (stress[i] - stress[i - 1]) *
                                            (strain[i] - strain[i - 1]);
}

static void measure_set(sf_form_fit *fit) {
    double part[SF_CYCLE_RECORDS * SF_CYCLES], time = 0;
    size_t n = 0;
    for (int k = 0; k < fit->config->record_count; k++) {
        const sf_cycle_record *r = &fit->config->cycles[k];
        for (int c = 1; c < r->cycles; c++) {
            int begin = r->turn[2 * c], end = r->turn[2 * c + 1], top = r->turn[2 * c - 1], left = begin;
            while (left > top && r->stress[left] < 0.01 * r->largest_stress)
                left--;
            part[n++] =
                (taken_up(r, r->stress, begin, end) - taken_up(r, fit->cycles[k].stress, begin, end)) /
                r->strain[top];
            time += r->time[begin] - r->time[left];
        }
    }
    fit->set = n > 1 ? gsl_stats_mean(part, 1, n) : NAN;
    fit->set_width =
        n > 1 ? gsl_cdf_tdist_Pinv(0.975, (double)n - 1) * gsl_stats_sd(part, 1, n) / sqrt((double)n) : NAN;
    fit->set_time = n > 1 ? time / (double)n : NAN;
}

static sf_status conclude(const double *value, const double own[HYSTERESIS + MEMORY], sf_form_fit *fit,
                          sf_error *err) {
    double informed = fit->card.informed_strain, squares[2] = {0, 0};
    int records = fit->config->record_count;
    sf_foam_card_free(&fit->card);
    SF_TRY(sf_foam_form_card(&fit->config->form.form, value, &fit->card, err));
    put_hysteresis(own, &fit->card);
    fit->card.informed_strain = informed;
    memcpy(fit->value, value, sizeof fit->value);
    memcpy(fit->unloading.fit.value, own, sizeof fit->unloading.fit.value);
    memcpy(&fit->value[SF_PARAMETER_HU], own, HYSTERESIS * sizeof *own); /* and SHAPE and ALPHA behind it */
    memcpy(&fit->value[SF_PARAMETER_RELOAD], own + HYSTERESIS, MEMORY * sizeof *own);
    for (int k = 0; k < records; k++) {
        SF_TRY(follow_record(&fit->config->cycles[k], &fit->card, &fit->cycles[k], err));
        for (int branch = 0; branch < 2; branch++)
            squares[branch] += fit->cycles[k].rms[branch][0] * fit->cycles[k].rms[branch][0];
    }
    measure_set(fit);
    fit->loading_rms = sqrt(squares[0] / records);
    fit->unloading.fit.rms = sqrt(squares[1] / records);
    fit->unloading.factor_rms = NAN; /* of the first cycles alone */
    return sf_form_fit_follow(fit, err);
}

sf_status sf_cycle_fit_run(sf_form_fit *fit, sf_error *err) {
    const sf_compression_config *c = fit->config;
    problem p = {.fit = fit};
    int longest = 0;
    size_t count = 0;
    for (int k = 0; k < c->record_count; k++) {
        const sf_cycle_record *r = &c->cycles[k];
        int told = r->fitted < 3 ? 1 : r->pauses > 0 ? 3 : 2;
        p.memory = told > p.memory ? told : p.memory;
        longest = r->count > longest ? r->count : longest;
        count += (size_t)fitted_points(r);
    }
    if (c->record_count == 0)
        return SF_OK;
    if (!fit->has_unloading)
        return SF_REFUSE(err, "%s: a test without unloading has no memory", c->cycles[0].path);
    p.stress = sf_alloc(err, longest, sizeof *p.stress, "cycles");
    SF_TRY(err->status);
    gsl_error_handler_t *handler = gsl_set_error_handler_off();
    size_t size = (size_t)(c->form.unknown_count + HYSTERESIS + p.memory);
    SF_VECTOR *x = gsl_vector_alloc(size), *out = gsl_vector_alloc(count);
    SF_MATRIX *covariance = gsl_matrix_calloc(size, size);
    double value[SF_PARAMETER_COUNT], own[HYSTERESIS + MEMORY];
    put_start(&p, x);
    double sum = sf_least_squares(deviate, &p, count, x, covariance);
    if (isfinite(sum)) {
        take(&p, x, value, own);
        deviate(x, &p, out);
        for (int k = 0; k < MEMORY; k++)
            fit->memory_width[k] = NAN;
        double r1 = fmin(0.98, fmax(0, sf_neighbour_correlation(count, out->data)));
        take_errors(&p, x, covariance, sum / (double)(count - size) * ((1 + r1) / (1 - r1)), own, fit);
        conclude(value, own, fit, err);
    } else {
        SF_FAIL(err, SF_ERR_NUMERIC, "no search for the memory in %s converges", c->cycles[0].path);
    }
    free(p.stress);
    gsl_set_error_handler(handler);
    return err->status;
}

double sf_cycle_fit_worst(const sf_cycle_result *cycles, int unloading, int first, int last) {
    double worst = 0;
    for (int k = first; k < last; k++)
        worst = fmax(worst, cycles->rms[unloading][k]);
    return worst;
}
