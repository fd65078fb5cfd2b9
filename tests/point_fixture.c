/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "extreme.h"
#include "point_fixture.h"

#include <assert.h>
#include <gsl/gsl_eigen.h>
#include <math.h>
#include <string.h>

double point_eva_stress(double strain) {
    double x = strain / (1 - strain);
    return 7.4e3 * -expm1(-413.6 / 7.4 * strain) + 134e3 * x + 23.3e3 * pow(x, 2.8);
}

sf_foam_shared point_elastic_foam(double density) {
    return (sf_foam_shared){.density = density,
                            .hysteresis_hu = 1,
                            .hysteresis_shape = 1,
                            .hysteresis_alpha = 1,
                            .maxwell_rate = 5000,
                            .rate_reference = 0.01,
                            .rate_filter_time = 1e-4};
}

void point_card_init(point_card *card) {
    memset(card, 0, sizeof *card);
    card->card = (sf_foam_card){
        .shared.density = 35,
        .modulus = 0.4e6,
        .shared.hysteresis_hu = 1,
        .shared.hysteresis_shape = 1,
        .shared.hysteresis_alpha = 1,
        .tension_cutoff = 1e30,
        .densification_limit = 1,
        .shared.rate_filter_time = 1e-4,
        .curves.curve_rate = card->rate,
        .curves.curve_ptr = card->ptr,
        .curves.curve_strain = card->strain,
        .curves.curve_stress = card->stress,
    };
}

void point_card_add(point_card *card, double rate, int64_t count, const double *strain,
                    const double *stress) {
    int64_t first = card->card.curves.curve_points;
    assert(card->card.curves.curve_count < POINT_CURVES && first + count <= POINT_CURVE_ROOM);
    memcpy(&card->strain[first], strain, (size_t)count * sizeof *strain);
    memcpy(&card->stress[first], stress, (size_t)count * sizeof *stress);
    card->rate[card->card.curves.curve_count++] = rate;
    card->card.curves.curve_points += count;
    card->ptr[card->card.curves.curve_count] = card->card.curves.curve_points;
}

void point_card_add_eva(point_card *card, double rate, int64_t count, double last, double factor) {
    double strain[POINT_CURVE_ROOM], stress[POINT_CURVE_ROOM];
    for (int64_t k = 0; k < count; k++) {
        strain[k] = last * (double)k / (double)(count - 1);
        stress[k] = factor * point_eva_stress(strain[k]);
    }
    point_card_add(card, rate, count, strain, stress);
}

void point_card_add_line(point_card *card, double modulus, double last) {
    double strain[5], stress[5];
    for (int k = 0; k < 5; k++) {
        strain[k] = last * k / 4;
        stress[k] = modulus * strain[k];
    }
    point_card_add(card, 0, 5, strain, stress);
}

/* splitmix64 */
double point_random(uint64_t *seed, double low, double high) {
    uint64_t z = (*seed += 0x9e3779b97f4a7c15ULL);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
    return low + (high - low) * ((double)((z ^ (z >> 31)) >> 11) * 0x1p-53);
}

void point_rotation_about(const double axis[3], double angle, double q[9]) {
    double c = cos(angle), s = sin(angle);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            q[3 * i + j] = (1 - c) * axis[i] * axis[j] + (i == j ? c : 0);
    for (int i = 0; i < 3; i++) { /* + s [axis]x */
        int j = (i + 1) % 3, k = (i + 2) % 3;
        q[3 * i + j] -= s * axis[k];
        q[3 * j + i] += s * axis[k];
    }
}

void point_rotation(uint64_t *seed, double q[9]) {
    double z = point_random(seed, -1, 1), angle = point_random(seed, 0, 2 * M_PI), r = sqrt(1 - z * z);
    const double axis[3] = {r * cos(angle), r * sin(angle), z};
    point_rotation_about(axis, point_random(seed, 0, M_PI), q);
}

void point_deformation(uint64_t *seed, double low, double high, double f[9]) {
    double left[9], right[9], scaled[9];
    point_rotation(seed, left);
    point_rotation(seed, right);
    for (int i = 0; i < 3; i++) {
        double stretch = point_random(seed, low, high);
        for (int j = 0; j < 3; j++)
            scaled[3 * i + j] = stretch * right[3 * i + j];
    }
    point_product(left, scaled, f);
}

void point_product(const double a[9], const double b[9], double out[9]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out[3 * i + j] = a[3 * i] * b[j] + a[3 * i + 1] * b[3 + j] + a[3 * i + 2] * b[6 + j];
}

void point_transpose(const double a[9], double out[9]) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out[3 * j + i] = a[3 * i + j];
}

double point_distance(int count, const double *a, const double *b) {
    double largest = 0;
    for (int k = 0; k < count && !isnan(largest); k++)
        largest = larger(largest, fabs(a[k] - b[k]));
    return largest;
}

double point_norm(int count, const double *a) {
    double sum = 0;
    for (int k = 0; k < count; k++)
        sum += a[k] * a[k];
    return sqrt(sum);
}

double point_largest_eigenvalue(int n, const double *a) {
    gsl_matrix *m = gsl_matrix_alloc((size_t)n, (size_t)n);
    gsl_vector *values = gsl_vector_alloc((size_t)n);
    gsl_eigen_symm_workspace *work = gsl_eigen_symm_alloc((size_t)n);
    for (int i = 0; i < n; i++)
        for (int j = 0; j < n; j++)
            gsl_matrix_set(m, (size_t)i, (size_t)j, 0.5 * (a[i * n + j] + a[j * n + i]));
    gsl_eigen_symm(m, values, work);
    double largest = gsl_vector_max(values);
    gsl_eigen_symm_free(work);
    gsl_vector_free(values);
    gsl_matrix_free(m);
    return largest;
}
