/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A fit writes no material that softfall-pre refuses. */
#include "case/read.h"
#include "study/material_file.h"
#include "model_fixture.h"
#include "program_fixture.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static const sf_material_text TEXT = {.title = "A test", .provenance = "from nothing\n"};

static void good_material_is_written_and_read(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    sf_case c;
    fixture_case(&c, NULL);
    assert_int_equal(sf_material_write_checked(p->folder, "good", &c.material, &TEXT, &err), SF_OK);
    assert_int_equal(sf_case_check_material(program_path(p, "good.cfg"), 0, &err), SF_OK);
    sf_case_free(&c);
}

/* A draw of a posterior: what is written of the errors of the responses is read, of every number. */
static void response_errors_are_written_and_read(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    sf_case c, again;
    sf_response_error error = {0};
    char set[600];
    for (int kind = 0; kind < SF_FIT_SAMPLES; kind++) {
        error.given[kind] = true;
        error.shared[kind] = -0.0123456789 * (kind + 1);
        error.own_sd[kind] = 0.1 / 3 * kind;
    }
    const sf_material_text text = {.title = "A draw", .provenance = "", .response_error = &error};
    fixture_case(&c, NULL);
    assert_int_equal(sf_material_write_checked(p->folder, "draw", &c.material, &text, &err), SF_OK);
    snprintf(set, sizeof set, "material=@%s", program_path(p, "draw.cfg"));
    fixture_case(&again, (const char *const[]){set, NULL});
    for (int kind = 0; kind < SF_FIT_SAMPLES; kind++) {
        assert_true(again.response_error.given[kind]);
        assert_true(fabs(again.response_error.shared[kind] - error.shared[kind]) < 1e-12);
        assert_true(fabs(again.response_error.own_sd[kind] - error.own_sd[kind]) < 1e-12);
    }
    assert_true(sf_material_hash(1, &again.material) == sf_material_hash(1, &c.material));
    sf_case_free(&again);
    sf_case_free(&c);
}

/* A fit found E = 0 and E = 2.7e14 Pa, and wrote them. */
static void modulus_out_of_bounds_is_not_written(void **state) {
    const program_place *p = *state;
    static const double modulus[] = {0, 2.7e14};
    for (int k = 0; k < 2; k++) {
        sf_error err = SF_ERROR_INIT;
        sf_case c;
        fixture_case(&c, NULL);
        sf_foam_card_of(&c.material)->modulus = modulus[k];
        assert_int_equal(sf_material_write_checked(p->folder, "wrong", &c.material, &TEXT, &err),
                         SF_ERR_MODEL);
        assert_non_null(strstr(err.text, "softfall-pre would refuse it: wrong.cfg:"));
        assert_non_null(strstr(err.text, "material.E"));
        assert_int_not_equal(program_shell(p, "ls wrong.cfg").code, 0);
        sf_case_free(&c);
    }
}

/* A curve that ends flat: only the law knows. */
static void flat_curve_is_not_written(void **state) {
    const program_place *p = *state;
    sf_error err = SF_ERROR_INIT;
    sf_case c;
    fixture_case(&c, NULL);
    sf_foam_card *card = sf_foam_card_of(&c.material);
    card->densification_start = 0;
    for (int64_t k = card->curves.curve_points - 3; k < card->curves.curve_points; k++)
        card->curves.curve_stress[k] = card->curves.curve_stress[card->curves.curve_points - 4];
    assert_int_equal(sf_material_write_checked(p->folder, "flat", &c.material, &TEXT, &err), SF_ERR_MODEL);
    assert_non_null(strstr(err.text, "the compression curve is flat"));
    assert_int_not_equal(program_shell(p, "ls flat.cfg").code, 0);
    sf_case_free(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(good_material_is_written_and_read),
        cmocka_unit_test(response_errors_are_written_and_read),
        cmocka_unit_test(modulus_out_of_bounds_is_not_written),
        cmocka_unit_test(flat_curve_is_not_written),
    };
    return cmocka_run_group_tests(tests, program_group_folder, program_group_tear_down);
}
