/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Variants of an axisymmetric model in memory against models that are built, and batches of drops. */
#include "model_fixture.h"
#include "post_check.h"
#include "softfall/softfall.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static const char *const KEYS[] = {"a_max_g", "hic", "max_indentation_mm"};
enum { FIGURES = 3, MOST = 12 };

/* The model of the example's section on 10 mm, with `overrides` up to NULL. */
static softfall_model *build(const char *const *overrides) {
    const char *all[MOST] = {"geometry.model=\"axisymmetric\"", "geometry.parameters.fine_spacing=10.0",
                             "geometry.missile_parameters.element_size=20.0", "pad.mesh_error_limit=1"};
    int count = 4;
    softfall_case *c = NULL;
    softfall_model *m = NULL;
    softfall_error error;
    for (; overrides && *overrides; overrides++)
        all[count++] = *overrides;
    if (softfall_case_read(fixture_source("examples/eva50-v4.5/case.cfg"), all, count, NULL, &c, &error) !=
            SOFTFALL_OK ||
        softfall_model_build(c, NULL, &m, &error) != SOFTFALL_OK)
        fail_msg("%s", error.text);
    softfall_case_free(c);
    return m;
}

static softfall_model *vary(const softfall_model *from, const softfall_variant *variant) {
    softfall_model *m = NULL;
    softfall_error error;
    if (softfall_model_vary(from, variant, &m, &error) != SOFTFALL_OK)
        fail_msg("%s", error.text);
    return m;
}

static void run(const softfall_model *const *models, int count, int threads, double *values) {
    const softfall_batch batch = {threads, 1000, FIGURES, KEYS};
    softfall_error errors[8], error;
    assert_int_equal(softfall_batch_run(models, count, &batch, values, errors, &error), SOFTFALL_OK);
    for (int k = 0; k < count; k++)
        if (errors[k].status != SOFTFALL_OK)
            fail_msg("%s", errors[k].text);
}

static void variant_is_the_model_of_a_case_with_its_values(void **state) {
    (void)state;
    char foam[4200];
    double values[2 * FIGURES];
    softfall_material *material = NULL;
    softfall_error error;
    const char *path = fixture_source("tests/materials/eva35_first.cfg");
    snprintf(foam, sizeof foam, "material=@%s", path);
    softfall_model *base = build(NULL);
    softfall_model *built =
        build((const char *const[]){"missile.velocity=\"4 m/s\"", "missile.mass=\"5 kg\"", foam, NULL});
    assert_int_equal(softfall_material_read(path, 0, &material, &error), SOFTFALL_OK);
    softfall_model *varied = vary(base, &(softfall_variant){.speed = 4, .mass = 5, .material = material});
    softfall_material_free(material);
    run((const softfall_model *const[]){built, varied}, 2, 1, values);
    for (int k = 0; k < FIGURES; k++)
        assert_true(values[k] == values[FIGURES + k]);
    softfall_model_free(base);
    softfall_model_free(built);
    softfall_model_free(varied);
}

static softfall_status foam_of(const char *example, const char *override, softfall_material **foam,
                               softfall_error *error) {
    softfall_case *c = NULL;
    if (softfall_case_read(fixture_source(example), &override, 1, NULL, &c, error) == SOFTFALL_OK)
        softfall_case_material(c, foam, error);
    softfall_case_free(c);
    return error->status;
}

static void foam_of_a_case_has_its_factor_on_the_stresses(void **state) {
    (void)state;
    double values[2 * FIGURES], rate;
    const double *strain, *stress, *strain_twice, *stress_twice;
    softfall_material *once = NULL, *twice = NULL, *none = NULL;
    softfall_error error;
    const char *example = "examples/eva50-v4.5/case.cfg";
    assert_int_equal(foam_of(example, "pad.stress_factor=1", &once, &error), SOFTFALL_OK);
    assert_int_equal(foam_of(example, "pad.stress_factor=2", &twice, &error), SOFTFALL_OK);
    int64_t points = softfall_material_curve(once, 0, &rate, &strain, &stress);
    assert_true(points > 0 &&
                points == softfall_material_curve(twice, 0, &rate, &strain_twice, &stress_twice));
    for (int64_t i = 0; i < points; i++)
        assert_true(strain[i] == strain_twice[i] && 2 * stress[i] == stress_twice[i]);
    softfall_model *base = build(NULL);
    softfall_model *built = build((const char *const[]){"pad.stress_factor=2", NULL});
    softfall_model *varied = vary(base, &(softfall_variant){.material = twice});
    run((const softfall_model *const[]){built, varied}, 2, 1, values);
    for (int k = 0; k < FIGURES; k++)
        assert_true(values[k] == values[FIGURES + k]);
    assert_int_equal(foam_of("examples/layers/case.cfg", "pad.stress_factor=2", &none, &error),
                     SOFTFALL_INPUT);
    assert_null(none);
    assert_non_null(strstr(error.text, "has a pad of layers"));
    softfall_material_free(once);
    softfall_material_free(twice);
    softfall_model_free(base);
    softfall_model_free(built);
    softfall_model_free(varied);
}

static void thickness_is_that_of_a_mesh_with_as_many_rows(void **state) {
    (void)state;
    double values[3 * FIGURES];
    softfall_model *base = build(NULL);
    softfall_model *built = build((const char *const[]){"geometry.parameters.thickness=53.0", NULL});
    softfall_model *varied = vary(base, &(softfall_variant){.thickness = 0.053});
    assert_close(softfall_model_describe(varied).thickness, 0.053, 1e-15);
    run((const softfall_model *const[]){built, varied, base}, 3, 1, values);
    for (int k = 0; k < FIGURES; k++)
        assert_relative(values[FIGURES + k], values[k], 1e-3); /* outside the zone gmsh draws triangles */
    assert_true(values[0] < values[2 * FIGURES]);              /* of the thinner pad */
    softfall_model_free(base);
    softfall_model_free(built);
    softfall_model_free(varied);
}

static void figures_do_not_depend_on_the_threads(void **state) {
    enum { DROPS = 4 };
    (void)state;
    double one[DROPS * FIGURES], three[DROPS * FIGURES];
    softfall_model *base = build(NULL), *models[DROPS];
    for (int k = 0; k < DROPS; k++)
        models[k] = vary(base, &(softfall_variant){.speed = 4 + 0.2 * k});
    run((const softfall_model *const *)models, DROPS, 1, one);
    run((const softfall_model *const *)models, DROPS, 3, three);
    assert_memory_equal(one, three, sizeof one);
    for (int k = 1; k < DROPS; k++)
        assert_true(one[k * FIGURES] > one[(k - 1) * FIGURES]);
    for (int k = 0; k < DROPS; k++)
        softfall_model_free(models[k]);
    softfall_model_free(base);
}

static void refuse(const softfall_model *from, const softfall_variant *variant, const char *text) {
    softfall_model *m = NULL;
    softfall_error error;
    assert_int_equal(softfall_model_vary(from, variant, &m, &error), SOFTFALL_INPUT);
    assert_null(m);
    if (!strstr(error.text, text))
        fail_msg("\"%s\" is not in \"%s\"", text, error.text);
}

static void what_cannot_be_varied_is_refused(void **state) {
    (void)state;
    softfall_model *base = build(NULL);
    softfall_error errors[1], error;
    double value;
    refuse(base, &(softfall_variant){.speed = -1}, "speed: -1 is neither 0");
    refuse(base, &(softfall_variant){.mass = NAN}, "mass: nan is neither 0");
    refuse(base, &(softfall_variant){.thickness = 0.1}, "2 times that of the model, outside 0.7 to 1.4");
    const softfall_batch unknown = {1, 1000, 1, (const char *const[]){"a_max"}};
    const softfall_model *const one[] = {base};
    assert_int_equal(softfall_batch_run(one, 1, &unknown, &value, errors, &error), SOFTFALL_INPUT);
    assert_non_null(strstr(error.text, "unknown figure \"a_max\""));
    softfall_model_free(base);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(variant_is_the_model_of_a_case_with_its_values),
        cmocka_unit_test(foam_of_a_case_has_its_factor_on_the_stresses),
        cmocka_unit_test(thickness_is_that_of_a_mesh_with_as_many_rows),
        cmocka_unit_test(figures_do_not_depend_on_the_threads),
        cmocka_unit_test(what_cannot_be_varied_is_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
