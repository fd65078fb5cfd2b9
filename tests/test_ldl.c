/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The solution of sparse systems in branches and trunk (solver/constraint/ldl.h). */
#include "extreme.h"
#include "solver/constraint/ldl.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "model_fixture.h"
#include "post_check.h"

static sf_vec *vectors(int64_t count) {
    sf_error err = SF_ERROR_INIT;
    sf_vec *x = sf_alloc(&err, (unsigned long)count, sizeof *x, "vectors");
    assert_non_null(x);
    return x;
}

/* A Laplacian on a grid of side x side points plus `shift` on the diagonal, its rows shuffled: every entry in
 * two equal halves, which the factorisation must add. Of the shuffled rows, the first are shared and the rest
 * belong to components one to three, as `part` says, without entries between them. */
static sf_ldl_entries laplacian(int side, double shift, uint8_t shared, const int64_t part[4]) {
    int64_t rows = (int64_t)side * side, room = 6 * rows;
    sf_ldl_entries a = {.shared = shared,
                        .row = calloc((size_t)room, sizeof *a.row),
                        .column = calloc((size_t)room, sizeof *a.column),
                        .value = calloc((size_t)room, sizeof *a.value)};
    assert_true(a.row && a.column && a.value && part[3] == rows);
    memcpy(a.part, part, sizeof a.part);
    for (int64_t p = 0; p < rows; p++)
        for (int to = 0; to < 3; to++) {
            int64_t q = to == 0 ? p : to == 1 ? p + 1 : p + side;
            if (q >= rows || (to == 1 && q % side == 0))
                continue;
            int64_t r = p * 7 % rows, s = q * 7 % rows; /* 7 divides no number of rows used here */
            int64_t high = r > s ? r : s, low = r > s ? s : r;
            for (int half = 0; half < 2 && !sf_ldl_apart(&a, low, high); half++) {
                a.row[a.count] = high;
                a.column[a.count] = low;
                a.value[a.count++] = 0.5 * (to == 0 ? 4 + shift : -1);
            }
        }
    return a;
}

static void free_entries(sf_ldl_entries *a) {
    free(a->row);
    free(a->column);
    free(a->value);
}

/* Does component c have this row of A? */
static bool has_row(const sf_ldl_entries *a, int64_t row, int c) {
    return row < a->part[0] ? (a->shared >> c) & 1 : row >= a->part[c] && row < a->part[c + 1];
}

/* Largest |A x - b| over the rows that each component has, and |x| over those that it has not. */
static double residual(const sf_ldl_entries *a, const sf_ldl *f, const sf_vec *b, const sf_vec *x) {
    double largest = 0;
    int64_t *place = calloc((size_t)f->rows, sizeof *place);
    sf_vec *r = vectors(f->rows);
    for (int64_t k = 0; k < f->rows; k++) {
        place[f->order[k]] = k;
        r[k] = b[k];
    }
    for (int64_t k = 0; k < a->count; k++) {
        int64_t i = place[a->row[k]], j = place[a->column[k]];
        r[i] -= a->value[k] * x[j];
        if (i != j)
            r[j] -= a->value[k] * x[i];
    }
    for (int64_t k = 0; k < f->rows; k++)
        for (int c = 0; c < 3; c++)
            largest = larger(largest, fabs(has_row(a, f->order[k], c) ? r[k][c] : x[k][c]));
    free(place);
    free(r);
    return largest;
}

/* Grids of one point, of a few (one branch, no trunk) and of many; shared by all components, by none, with
 * rows of two components besides, and of one component alone. */
static void solution_meets_its_systems(void **state) {
    (void)state;
    static const struct {
        int side;
        uint8_t shared;
        int64_t part[4];
    } grid[] = {{1, 7, {1, 1, 1, 1}},
                {2, 7, {4, 4, 4, 4}},
                {5, 7, {25, 25, 25, 25}},
                {40, 7, {1600, 1600, 1600, 1600}},
                {40, 7, {1300, 1450, 1600, 1600}},
                {40, 7, {1500, 1500, 1500, 1600}},
                {40, 4, {1300, 1450, 1600, 1600}}, /* a sliding base: no row is held in all components */
                {5, 4, {0, 8, 16, 25}},
                {5, 1, {0, 0, 0, 25}}};
    for (size_t k = 0; k < sizeof grid / sizeof grid[0]; k++) {
        sf_error err = SF_ERROR_INIT;
        uint64_t seed = 5;
        sf_ldl f;
        sf_ldl_entries a = laplacian(grid[k].side, 0.1, grid[k].shared, grid[k].part);
        assert_int_equal(sf_ldl_build(&a, &f, &err), SF_OK);
        sf_vec *b = vectors(f.rows), *x = vectors(f.rows);
        for (int64_t i = 0; i < f.rows; i++)
            b[i] = x[i] = (sf_vec){fixture_random(&seed), fixture_random(&seed), fixture_random(&seed)};
        for (int q = SF_LDL_BRANCHES - 1; q >= 0; q--) /* in any order */
            sf_ldl_forward(&f, q, x);
        sf_ldl_trunk(&f, x);
        for (int q = 0; q < SF_LDL_BRANCHES; q++)
            sf_ldl_backward(&f, q, x);
        assert_close(residual(&a, &f, b, x), 0, 1e-13);
        free(b);
        free(x);
        sf_ldl_free(&f);
        free_entries(&a);
    }
}

/* No branch of a large grid holds more than twice its share, and the trunk little. */
static void branches_are_balanced(void **state) {
    (void)state;
    sf_error err = SF_ERROR_INIT;
    sf_ldl f;
    sf_ldl_entries a = laplacian(60, 0.1, 7, (const int64_t[]){3600, 3600, 3600, 3600});
    assert_int_equal(sf_ldl_build(&a, &f, &err), SF_OK);
    double all = (double)f.column[f.rows];
    for (int q = 0; q < SF_LDL_BRANCHES; q++) {
        double share = (double)(f.column[f.branch[q + 1]] - f.column[f.branch[q]]) / all;
        assert_true(share > 0.1 && share < 0.4);
    }
    assert_true((double)(f.column[f.rows] - f.column[f.branch[SF_LDL_BRANCHES]]) < 0.35 * all);
    sf_ldl_free(&f);
    free_entries(&a);
}

/* With little of its diagonal the Laplacian has eigenvalues of both signs. */
static void indefinite_matrix_is_refused(void **state) {
    (void)state;
    sf_error err = SF_ERROR_INIT;
    sf_ldl f;
    sf_ldl_entries a = laplacian(5, -3.9, 7, (const int64_t[]){25, 25, 25, 25});
    assert_int_equal(sf_ldl_build(&a, &f, &err), SF_ERR_MODEL);
    assert_non_null(strstr(err.text, "depend on each other"));
    assert_null(f.value);
    free_entries(&a);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(solution_meets_its_systems),
        cmocka_unit_test(branches_are_balanced),
        cmocka_unit_test(indefinite_matrix_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
