/* SPDX-License-Identifier: GPL-3.0-or-later */
/* B in six bytes a number: what softfall-pre has rounded packs without change and keeps the identities; the
 * rest is rounded to nearest. */
#include "model_fixture.h"

#include "core/packed_gradient.h"
#include "pre/cloud/rounding.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

enum { LATTICE, BLOCK, PAD, MODELS };
enum { MOST = 200 }; /* entries of a row */

static int set_up(void **state) {
    const fixture_block lattice = {.cells = {8, 7, 6}, .spacing = 0.005};
    const fixture_block block = {.cells = {8, 7, 6}, .spacing = 0.005, .jitter = 0.25, .surface_jitter = 0.2};
    fixture *f = calloc(MODELS, sizeof *f);
    fixture_held_block(&lattice, &f[LATTICE]);
    fixture_held_block(&block, &f[BLOCK]);
    fixture_pad(NULL, &f[PAD]);
    *state = f;
    return 0;
}

static int tear_down(void **state) {
    fixture *f = *state;
    for (int k = 0; k < MODELS; k++)
        fixture_free(&f[k]);
    free(f);
    return 0;
}

static int64_t row_order(const sf_model *m, int64_t i, int32_t *order) {
    int64_t count = m->domain_ptr[i + 1] - m->domain_ptr[i];
    assert_true(count <= MOST);
    sf_packed_order(m->position, &m->domain_node[m->domain_ptr[i]], count, (int32_t)i, order);
    return count;
}

static uint8_t *packed_model(const sf_model *m) {
    uint8_t *bytes = malloc((size_t)sf_packed_start(m->node_count, m->domain_nnz));
    assert_non_null(bytes);
    for (int64_t i = 0; i < m->node_count; i++) {
        int32_t order[MOST];
        int64_t count = row_order(m, i, order), first = m->domain_ptr[i];
        sf_pack_row(count, order, &m->domain_b[3 * first], &bytes[sf_packed_start(i, first)]);
    }
    return bytes;
}

static void rounded_models_are_packed_without_change(void **state) {
    const fixture *f = *state;
    for (int k = 0; k < MODELS; k++) {
        const sf_model *m = &f[k].model;
        uint8_t *bytes = packed_model(m);
        int64_t zeros = 0;
        for (int64_t i = 0; i < m->node_count; i++) {
            int32_t order[MOST];
            int64_t count = row_order(m, i, order), first = m->domain_ptr[i];
            for (int64_t p = 0; p < count; p++)
                for (int c = 0; c < 3; c++) {
                    double b = m->domain_b[3 * (first + order[p]) + c];
                    double packed =
                        sf_packed_number(&bytes[sf_packed_start(i, first) + sf_packed_place(p, c)]);
                    zeros += b == 0 && p >= SF_TAKERS;
                    if (b == 0 && p >= SF_TAKERS)
                        assert_close(packed, 0, 2 * SF_PACKED_LEAST);
                    else
                        assert_memory_equal(&packed, &b, sizeof b);
                }
        }
        free(bytes);
        if (k == LATTICE) /* else zeros are not tested */
            assert_true(zeros > 0);
    }
}

static void check_rows(const sf_model *m, double bound) {
    for (int64_t i = 0; i < m->node_count; i++)
        for (int c = 0; c < 3; c++) {
            double sum = 0, moment[3] = {0};
            for (int64_t q = m->domain_ptr[i]; q < m->domain_ptr[i + 1]; q++) {
                sum += m->domain_b[3 * q + c];
                for (int a = 0; a < 3; a++)
                    moment[a] += (m->position[3 * (int64_t)m->domain_node[q] + a] - m->position[3 * i + a]) *
                                 m->domain_b[3 * q + c];
            }
            assert_close(sum * m->spacing[i], 0, bound);
            for (int a = 0; a < 3; a++)
                assert_close(moment[a], a == c, bound);
        }
}

static void rounded_rows_are_complete(void **state) {
    const fixture *f = *state;
    for (int k = 0; k < MODELS; k++)
        check_rows(&f[k].model, 5e-15);
}

/* 8.3e-12 on the pad if every number goes to its nearest. */
static void rounded_domains_balance_a_uniform_stress(void **state) {
    const fixture *f = *state;
    for (int k = 0; k < MODELS; k++)
        assert_close(f[k].report.invariants.telescope, 0, 7e-12);
}

static void in_place_is_the_same_as_out_of_place(void **state) {
    const sf_model *m = &((const fixture *)*state)[PAD].model;
    uint8_t *apart = packed_model(m), *bytes = malloc(3 * (size_t)m->domain_nnz * sizeof *m->domain_b);
    assert_non_null(bytes);
    memcpy(bytes, m->domain_b, 3 * (size_t)m->domain_nnz * sizeof *m->domain_b);
    for (int64_t i = 0; i < m->node_count; i++) {
        int32_t order[MOST];
        double b[3 * MOST];
        int64_t count = row_order(m, i, order), first = m->domain_ptr[i];
        memcpy(b, &bytes[24 * first], 3 * (size_t)count * sizeof *b);
        sf_pack_row(count, order, b, &bytes[sf_packed_start(i, first)]);
    }
    assert_memory_equal(bytes, apart, (size_t)sf_packed_start(m->node_count, m->domain_nnz));
    free(apart);
    free(bytes);
}

/* Rows that no softfall-pre has rounded: of all lengths, with signs, zeros and huge ratios, in one piece of
 * memory, so that a row that writes beyond its end spoils the next. */
static void other_rows_are_rounded_to_nearest(void **state) {
    (void)state;
    enum { ROWS = 3000 };
    uint64_t seed = 48;
    double *b = calloc(3 * MOST * ROWS, sizeof *b), worst = 0;
    int64_t *ptr = calloc(ROWS + 1, sizeof *ptr);
    uint8_t *bytes = calloc(MOST * ROWS, 24);
    assert_true(b && ptr && bytes);
    for (int64_t i = 0; i < ROWS; i++) {
        int32_t order[MOST];
        int64_t count = i < 500 ? 1 + i % 5 : 1 + (int64_t)(30 * (1 + fixture_random(&seed)));
        ptr[i + 1] = ptr[i] + count;
        for (int64_t k = 0; k < count; k++)
            order[k] = (int32_t)(count - 1 - k);
        for (int64_t q = 3 * ptr[i]; q < 3 * ptr[i + 1]; q++)
            b[q] = fixture_random(&seed) * (i % 2 ? 1 : pow(10, 100 * fixture_random(&seed)));
        for (int64_t q = 3 * ptr[i]; q < 3 * ptr[i + 1]; q += 7)
            b[q] = q % 2 ? 0 : -0.0;
        sf_pack_row(count, order, &b[3 * ptr[i]], &bytes[sf_packed_start(i, ptr[i])]);
    }
    for (int64_t i = 0; i < ROWS; i++) {
        int64_t count = ptr[i + 1] - ptr[i];
        for (int64_t q = 0; q < 3 * count; q++) {
            double exact = b[3 * ptr[i] + q];
            int64_t place = sf_packed_place(count - 1 - q / 3, (int)(q % 3));
            double packed = sf_packed_number(&bytes[sf_packed_start(i, ptr[i]) + place]);
            if (count - 1 - q / 3 < SF_TAKERS)
                assert_memory_equal(&packed, &exact, sizeof exact);
            else if (exact == 0) {
                assert_true(fabs(packed) > 0.5 * SF_PACKED_LEAST && fabs(packed) < 2 * SF_PACKED_LEAST);
                assert_int_equal(!signbit(packed), !signbit(exact));
            } else {
                worst = fmax(worst, fabs(packed / exact - 1));
            }
        }
    }
    assert_true(worst <= 0x1p-37);
    assert_true(worst > 0x1p-38); /* or rows of takers were all that was looked at */
    free(b);
    free(ptr);
    free(bytes);
}

static void rows_fill_their_bytes(void **state) {
    (void)state;
    for (int64_t count = 1; count < 100; count++) {
        int64_t end = sf_packed_place(count - 1, 2) + 8;
        if (count >= SF_TAKERS)
            assert_int_equal(end, sf_packed_start(1, count));
        else
            assert_true(end <= sf_packed_start(1, count));
        for (int64_t q = 1; q < 3 * count; q++) {
            int64_t stride =
                sf_packed_place(q / 3, (int)(q % 3)) - sf_packed_place((q - 1) / 3, (int)((q - 1) % 3));
            assert_int_equal(stride, q < 3 * SF_TAKERS ? 8 : 6);
        }
    }
}

static void takers_are_the_corners_of_the_largest_tetrahedron_so_far(void **state) {
    (void)state;
    const double position[][3] = {{0, 0, 0},  {1, 0, 0}, {3, 0, 0}, {3, 0, 0}, {1, 2, 0},
                                  {1, -2, 0}, {1, 0, 1}, {2, 0, 2}, {1, 1, -1}};
    const int32_t node[] = {1, 2, 3, 4, 5, 6, 7, 8}, from_origin[] = {0, 1, 2, 3, 4, 5, 6, 7, 8};
    int32_t order[9];
    /* from the origin: 3 m, the first of two; 2 m from that line, the first of three; 2 m from that plane */
    sf_packed_order(position[0], from_origin, 9, 0, order);
    const int32_t expected[] = {0, 2, 4, 7, 1, 3, 5, 6, 8};
    assert_memory_equal(order, expected, sizeof expected);
    /* not in the row: from its first node, (1, 0, 0), to (2, 0, 2) */
    sf_packed_order(position[0], node, 8, 0, order);
    assert_int_equal(order[0], 0);
    assert_int_equal(order[1], 6);
}

/* In another unit the last bits differ: of equals in a lattice still the same is taken. */
static void order_is_the_same_in_another_unit(void **state) {
    const fixture *f = *state;
    for (int k = 0; k < MODELS; k++) {
        sf_model other = f[k].model;
        other.position = malloc(3 * (size_t)other.node_count * sizeof *other.position);
        assert_non_null(other.position);
        for (int64_t q = 0; q < 3 * other.node_count; q++)
            other.position[q] = f[k].model.position[q] / 0.0254;
        for (int64_t i = 0; i < other.node_count; i++) {
            int32_t order[MOST], again[MOST];
            size_t count = (size_t)row_order(&f[k].model, i, order);
            row_order(&other, i, again);
            assert_memory_equal(order, again, count * sizeof *order);
        }
        free(other.position);
    }
}

/* No volume, or one that is too large for a double: every entry still has its place. */
static void nodes_without_a_volume_are_all_packed(void **state) {
    (void)state;
    double line[21] = {0}, huge[21];
    const int32_t node[] = {0, 1, 2, 3, 4, 5, 6}, expected[] = {3, 0, 1, 2, 4, 5, 6};
    int32_t order[7], seen[7] = {0};
    uint64_t seed = 3;
    for (int k = 0; k < 7; k++)
        line[3 * k] = 0.1 * k;
    sf_packed_order(line, node, 7, 3, order);
    assert_memory_equal(order, expected, sizeof expected);
    for (int q = 0; q < 21; q++)
        huge[q] = 1e308 * fixture_random(&seed);
    memset(order, 0x7f, sizeof order);
    sf_packed_order(huge, node, 7, 3, order);
    for (int k = 0; k < 7; k++) {
        assert_in_range(order[k], 0, 6);
        assert_int_equal(seen[order[k]]++, 0);
    }
}

/* The pad's B, disturbed: other numbers go to one of their two neighbours, zeros stay, takers put the rows
 * right again. */
static void rounding_moves_a_number_to_a_neighbour_and_leaves_zeros(void **state) {
    sf_model *m = &((fixture *)*state)[PAD].model;
    sf_error err = SF_ERROR_INIT;
    sf_mesh mesh = {.node_count = m->node_count, .position = m->position};
    size_t bytes = 3 * (size_t)m->domain_nnz * sizeof *m->domain_b;
    double *exact = malloc(bytes), *b = malloc(bytes), worst = 0;
    assert_true(exact && b);
    uint64_t seed = 9;
    for (int64_t q = 0; q < 3 * m->domain_nnz; q++)
        exact[q] = q % 11 ? m->domain_b[q] * (1 + 1e-6 * fixture_random(&seed)) : 0;
    memcpy(b, exact, bytes);
    sf_domains d = {.ptr = m->domain_ptr, .node = m->domain_node, .volume = m->volume, .b = b};
    assert_int_equal(sf_domains_round(&mesh, &d, &err), SF_OK);
    for (int64_t i = 0; i < m->node_count; i++) {
        int32_t order[MOST];
        int64_t count = row_order(m, i, order), first = m->domain_ptr[i];
        for (int64_t p = SF_TAKERS; p < count; p++)
            for (int c = 0; c < 3; c++) {
                int64_t q = 3 * (first + order[p]) + c;
                double change = fabs(b[q] / exact[q] - 1);
                if (exact[q] == 0)
                    assert_true(b[q] == 0);
                else if (p == SF_TAKERS && c == 0) /* and to nearest again, behind the corrected takers */
                    assert_true(change <= 0x1.8p-36);
                else
                    worst = fmax(worst, change);
            }
    }
    assert_true(worst <= 0x1p-36);
    assert_true(worst > 0x1p-37); /* some go the longer way */
    sf_model rounded = *m;
    rounded.domain_b = b;
    check_rows(&rounded, 5e-14);
    free(exact);
    free(b);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rounded_models_are_packed_without_change),
        cmocka_unit_test(rounded_rows_are_complete),
        cmocka_unit_test(rounded_domains_balance_a_uniform_stress),
        cmocka_unit_test(in_place_is_the_same_as_out_of_place),
        cmocka_unit_test(other_rows_are_rounded_to_nearest),
        cmocka_unit_test(rows_fill_their_bytes),
        cmocka_unit_test(takers_are_the_corners_of_the_largest_tetrahedron_so_far),
        cmocka_unit_test(order_is_the_same_in_another_unit),
        cmocka_unit_test(nodes_without_a_volume_are_all_packed),
        cmocka_unit_test(rounding_moves_a_number_to_a_neighbour_and_leaves_zeros),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
