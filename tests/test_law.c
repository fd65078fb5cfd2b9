/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The table of laws, entry by entry, and models of several materials. */
#include "extreme.h"
#include "model_fixture.h"

#include "point_fixture.h"
#include "material/hyperfoam.h"
#include "model/model_check.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

static bool is_number(const sf_parameter *p) {
    return p->kind == SF_PARAMETER_NUMBER || p->kind == SF_PARAMETER_QUANTITY;
}

/* The number of a default in libconfig syntax; the word's for a word, 0 of what may be absent. */
static double default_of(const sf_parameter *p) {
    double value = 0;
    sf_error err = SF_ERROR_INIT;
    sf_units *units = NULL;
    char text[128];
    if (p->kind == SF_PARAMETER_NUMBER || !*p->fallback)
        return strtod(p->fallback, NULL);
    assert_true(p->fallback[0] == '"');
    snprintf(text, sizeof text, "%.*s", (int)strlen(p->fallback) - 2, p->fallback + 1);
    if (p->words && strcmp(text, p->words) == 0)
        return p->word_value;
    assert_int_equal(sf_units_open(&units, &err), SF_OK);
    if (sf_units_parse(units, text, p->quantity, &value, &err) != SF_OK)
        fail_msg("%s: %s", p->key, err.text);
    sf_units_close(&units);
    return value;
}

static void check_parameters(const sf_law *law) {
    for (int k = 0; k < law->parameter_count; k++) {
        const sf_parameter *p = &law->parameter[k];
        assert_true(strncmp(p->group, "material", 8) == 0 && p->meaning && *p->meaning);
        assert_true(p->offset + 8 <= law->card_size);
        for (int j = 0; j < k; j++)
            assert_false(strcmp(p->group, law->parameter[j].group) == 0 &&
                         strcmp(p->key, law->parameter[j].key) == 0);
        if (!is_number(p))
            continue;
        assert_true(p->low < p->high);
        if (!p->fallback || !*p->fallback)
            continue;
        double value = default_of(p);
        bool word = p->words && value == p->word_value;
        if (!word && !(value >= p->low && value <= p->high))
            fail_msg("%s: %s: its default %g is not between %g and %g", law->name, p->key, value, p->low,
                     p->high);
    }
}

static void parameters_and_history_of_every_law_are_consistent(void **state) {
    (void)state;
    for (int n = 0; sf_law_get(n); n++) {
        const sf_law *law = sf_law_get(n);
        int used[SF_LAW_HISTORY] = {0}, most = 0;
        assert_ptr_equal(sf_law_find(law->name), law);
        check_parameters(law);
        for (int k = 0; k < law->history_count; k++)
            for (int c = 0; c < law->history[k].components; c++) {
                assert_in_range(law->history[k].first + c, 0, SF_LAW_HISTORY - 1);
                assert_int_equal(used[law->history[k].first + c]++, 0);
                most++;
            }
        sf_material m;
        sf_error err = SF_ERROR_INIT;
        assert_int_equal(sf_material_create(law, &m, &err), SF_OK);
        assert_in_range(sf_material_history_rows(&m), 0, most);
        sf_material_free(&m);
    }
    assert_null(sf_law_find("no such law"));
}

/* A value for a key without a default. */
static double required(const char *key) {
    static const struct {
        const char *key;
        double value;
    } known[] = {{"density", 35}, {"E", 4e5}, {"mu", 1.5e5}, {"alpha", 6}};
    for (size_t k = 0; k < sizeof known / sizeof *known; k++)
        if (strcmp(known[k].key, key) == 0)
            return known[k].value;
    fail_msg("no value for %s", key);
    return 0;
}

/* A material of a law with all that a point can do: every parameter that has a default and a bound acts. */
static void make_material(const sf_law *law, sf_material *m) {
    sf_error err = SF_ERROR_INIT;
    point_card eva;
    assert_int_equal(sf_material_create(law, m, &err), SF_OK);
    for (int k = 0; k < law->parameter_count; k++) {
        const sf_parameter *p = &law->parameter[k];
        if (is_number(p))
            *(double *)((char *)m->card + p->offset) = !p->fallback ? required(p->key) : default_of(p);
    }
    sf_law_curves *curves = sf_material_curves(m);
    if (!curves)
        return;
    point_card_init(&eva);
    point_card_add_eva(&eva, 0, 120, 0.9, 1);
    curves->curve_count = 1;
    curves->curve_points = 120;
    curves->curve_rate = calloc(1, sizeof(double));
    curves->curve_ptr = calloc(2, sizeof(int64_t));
    curves->curve_strain = malloc(120 * sizeof(double));
    curves->curve_stress = malloc(120 * sizeof(double));
    curves->curve_ptr[1] = 120;
    memcpy(curves->curve_strain, eva.strain, 120 * sizeof(double));
    memcpy(curves->curve_stress, eva.stress, 120 * sizeof(double));
}

/* The default card; one with hysteresis, Maxwell branch and Kelvin viscosity; that with ALPHA and a rate
 * factor, and for the hyperfoam lateral strain and a second term. */
static void make_variant(const sf_law *law, int variant, sf_material *m) {
    make_material(law, m);
    if (variant > 0) {
        sf_foam_shared *card = m->card;
        card->hysteresis_hu = 0.05;
        card->hysteresis_shape = 2.5;
        card->maxwell_modulus = 3e6;
        card->maxwell_rate = 4000;
        card->kelvin_viscosity = 300;
        card->hysteresis_alpha = variant == 2 ? 0.3 : 1;
    }
    if (variant == 2)
        ((sf_foam_shared *)m->card)->rate_factor = 0.3;
    if (variant == 2 && law == &sf_hyperfoam_law) {
        sf_hyperfoam_card *card = m->card;
        card->term[0].nu = 0.2;
        card->term[1] = (sf_hyperfoam_term){.mu = 3e4, .alpha = -2, .beta = 0.1};
    }
}

static void set_stretch(double f[9][SF_LANES], double stretch) {
    memset(f, 0, 9 * sizeof *f);
    for (int l = 0; l < SF_LANES; l++) {
        f[0][l] = stretch;
        f[4][l] = f[8][l] = 1;
    }
}

/* Compression and release at changing speed, with steps of 2 us, 20 us and 2 ms. */
static void assert_uniaxial(const sf_material *m, double dt) {
    sf_material_law law;
    sf_error err = SF_ERROR_INIT;
    sf_uniaxial point = {0};
    static sf_law_batch batch;
    double largest = 0;
    memset(&batch, 0, sizeof batch);
    if (sf_material_check(m, 0, &err) != SF_OK || sf_material_law_build(m, &law, &err) != SF_OK)
        fail_msg("%s", err.text);
    set_stretch(batch.f, 1);
    for (int k = 1; k <= 1000; k++) {
        double strain = 0.75 * (1 - cos(0.012 * k)) / 2 * (1 + 0.2 * sin(0.033 * k));
        memcpy(batch.f_old, batch.f, sizeof batch.f);
        set_stretch(batch.f, 1 - strain);
        for (int l = 0; l < SF_LANES; l++)
            batch.length[l] = 1;
        law.law->update(law.numbers, dt, &batch);
        double stress = law.law->uniaxial(law.numbers, dt, strain, &point);
        largest = larger(largest, fabs(stress));
        assert_true(fabs(stress + batch.p[0][0]) < 1e-9 * fmax(largest, 1));
    }
    assert_true(largest > 1e3);
    sf_material_law_free(&law);
}

static void uniaxial_stress_is_that_of_the_batch(void **state) {
    (void)state;
    static const double dt[] = {2e-6, 2e-5, 2e-3};
    for (int n = 0; sf_law_get(n); n++)
        for (int variant = 0; variant < 3; variant++)
            for (int k = 0; k < 3; k++) {
                sf_material m;
                make_variant(sf_law_get(n), variant, &m);
                assert_uniaxial(&m, dt[k]);
                sf_material_free(&m);
            }
}

static void stress_is_the_derivative_of_the_energy(void **state) {
    (void)state;
    for (int n = 0; sf_law_get(n); n++) {
        sf_material m;
        sf_material_law law;
        sf_error err = SF_ERROR_INIT;
        make_material(sf_law_get(n), &m);
        assert_int_equal(sf_material_law_build(&m, &law, &err), SF_OK);
        for (double strain = 0.03; strain < 0.85; strain += 0.0371) {
            const double h = 1e-6;
            sf_uniaxial point = {0}; /* at rest, as slowly as it gets */
            double slope =
                (law.law->energy(law.numbers, strain + h) - law.law->energy(law.numbers, strain - h)) /
                (2 * h);
            double stress = law.law->uniaxial(law.numbers, 1e9, strain, &point);
            assert_true(fabs(slope / stress - 1) < 1e-5);
        }
        sf_material_law_free(&law);
        sf_material_free(&m);
    }
}

/* ---- models of two materials ---- */

/* Gives nodes from `first` a copy of the material with stresses times `factor`, and HU. */
static void add_material(sf_model *m, int64_t first, double factor, double hu) {
    sf_error err = SF_ERROR_INIT;
    const sf_foam_card *one = sf_foam_card_of(&m->material[0]);
    sf_material *list = sf_alloc(&err, 2, sizeof *list, "materials");
    list[0] = m->material[0];
    assert_int_equal(sf_material_create(list[0].law, &list[1], &err), SF_OK);
    sf_foam_card *two = sf_foam_card_of(&list[1]);
    size_t points = (size_t)one->curves.curve_points;
    *two = *one;
    two->curves.curve_rate = malloc(sizeof(double));
    two->curves.curve_ptr = malloc(2 * sizeof(int64_t));
    two->curves.curve_strain = malloc(points * sizeof(double));
    two->curves.curve_stress = malloc(points * sizeof(double));
    two->curves.curve_rate[0] = one->curves.curve_rate[0];
    memcpy(two->curves.curve_ptr, one->curves.curve_ptr, 2 * sizeof(int64_t));
    memcpy(two->curves.curve_strain, one->curves.curve_strain, points * sizeof(double));
    for (size_t k = 0; k < points; k++)
        two->curves.curve_stress[k] = factor * one->curves.curve_stress[k];
    two->modulus *= factor;
    two->shared.hysteresis_hu = hu;
    two->shared.maxwell_modulus = 0; /* other rows of history than the first's */
    free(m->material);
    m->material = list;
    m->material_count = 2;
    for (int64_t i = first; i < m->node_count; i++)
        m->node_material[i] = 1;
    if (sf_model_check(m, &err) != SF_OK)
        fail_msg("%s", err.text);
}

/* A state of compression of every node, twice: with history. */
static void compress(fixture *f) {
    static const double gradient[2][9] = {{0.02, 0, 0, 0, -0.01, 0.05, 0, 0, -0.5},
                                          {0.01, 0, 0, 0, -0.01, 0.02, 0, 0, -0.3}};
    static const double still[3] = {0};
    fixture_start(f);
    for (int k = 0; k < 2; k++) {
        fixture_set_affine(f, gradient[k], still);
        f->state.dt_old = 2e-5;
        fixture_forces(f);
    }
}

/* Every node of a model of two materials has the stress, stiffness and history that it has in a model of its
 * own material alone; the border lies between batches, and within one. */
static void every_node_has_the_law_of_its_material(void **state) {
    (void)state;
    const fixture_block block = {.cells = {6, 6, 6}, .spacing = 0.01, .jitter = 0.1};
    fixture alone[2], both;
    fixture_held_block(&block, &alone[0]);
    fixture_held_block(&block, &alone[1]);
    add_material(&alone[1].model, 0, 2, 0.3);
    compress(&alone[0]);
    compress(&alone[1]);
    for (int k = 0; k < 2; k++) {
        int64_t border = 10 * SF_LANES + 5 * k;
        fixture_held_block(&block, &both);
        add_material(&both.model, border, 2, 0.3);
        compress(&both);
        for (int64_t i = 0; i < both.model.node_count; i++) {
            const sf_state *s = &both.state, *own = &alone[i >= border].state;
            assert_memory_equal(&s->stiffness[i], &own->stiffness[i], sizeof(double));
            assert_memory_equal(&s->tangent[i], &own->tangent[i], sizeof(double));
            assert_memory_equal(&s->f[9 * i], &own->f[9 * i], 9 * sizeof(double));
            assert_true(fixture_peak(&both, i) == fixture_peak(&alone[i >= border], i));
        }
        assert_true(both.state.stiffness[border] > 1.5 * both.state.stiffness[border - 1]);
        fixture_free(&both);
    }
    fixture_free(&alone[0]);
    fixture_free(&alone[1]);
}

static void materials_in_disorder_are_refused(void **state) {
    (void)state;
    const fixture_block block = {.cells = {4, 4, 4}, .spacing = 0.01};
    fixture f;
    sf_error err = SF_ERROR_INIT;
    fixture_held_block(&block, &f);
    add_material(&f.model, SF_LANES, 2, 1);
    f.model.node_material[40] = 0;
    assert_int_equal(sf_model_check(&f.model, &err), SF_ERR_MODEL);
    assert_non_null(strstr(err.text, "node 40 is of material 0, after one of 1"));
    err = (sf_error)SF_ERROR_INIT;
    f.model.node_material[40] = 2;
    assert_int_equal(sf_model_check(&f.model, &err), SF_ERR_MODEL);
    assert_non_null(strstr(err.text, "material of node 40 is 2, outside 0 to 1"));
    fixture_free(&f);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parameters_and_history_of_every_law_are_consistent),
        cmocka_unit_test(uniaxial_stress_is_that_of_the_batch),
        cmocka_unit_test(stress_is_the_derivative_of_the_energy),
        cmocka_unit_test(every_node_has_the_law_of_its_material),
        cmocka_unit_test(materials_in_disorder_are_refused),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
