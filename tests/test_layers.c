/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Pads of several layers: clouds that end at the interface, ties that pass the patch test, and drops on
 * stacks. verify/study_layers.c has the closed forms of slow compression and waves. */
#include "extreme.h"
#include "layer_fixture.h"
#include "model/model_check.h"

#include "pre/cloud/cloud.h"
#include "solver/constraint/constraint.h"
#include "solver/step.h"
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

static const double GRADIENT[9] = {0.06, -0.11, 0.04, 0.09, -0.05, 0.13, -0.07, 0.08, -0.32};
static const double SHIFT[3] = {0.013, -0.004, 0.021};

static const double H = 0.01; /* m */
static const char *const BASE[] = {"base", NULL};

/* ---- blocks of layers ---- */

static int flat(const double x[3]) {
    return x[2] > 3;
}

/* Two materials side by side. */
static int beside(const double x[3]) {
    return x[0] > 3;
}

/* An interface with two steps, so that it has edges and corners. */
static int stepped(const double x[3]) {
    return x[2] > 2 + (x[0] > 3) + (x[1] > 2 && x[0] > 3);
}

/* Three layers that meet in a line: below, and above left and right. */
static int junction(const double x[3]) {
    return x[2] < 2 ? 0 : x[0] < 3 ? 1 : 2;
}

/* An island in the middle of another material. */
static int inclusion(const double x[3]) {
    return fabs(x[0] - 3) < 1.1 && fabs(x[1] - 2.5) < 1 && fabs(x[2] - 2.5) < 1;
}

static void build_block(const fixture_block *block, layering layer, int count, fixture *out) {
    sf_case c;
    layers_case(&c, NULL, (const char *const[]){"base", "top", "sides", NULL}, count);
    layers_under_plate(&c, block, layer, out);
}

/* ---- clouds ---- */

static const fixture_block JITTERED = {
    .cells = {6, 5, 5}, .spacing = 0.01, .jitter = 0.2, .surface_jitter = 0.2};

static void no_list_reaches_across_an_interface(void **state) {
    fixture f;
    (void)state;
    build_block(&JITTERED, stepped, 2, &f);
    const sf_model *m = &f.model;
    const int64_t *ptr[] = {m->domain_ptr, m->phi_ptr, m->edge_ptr};
    const int32_t *node[] = {m->domain_node, m->phi_node, m->edge_node};
    for (int k = 0; k < 3; k++)
        for (int64_t i = 0; i < m->node_count; i++)
            for (int64_t q = ptr[k][i]; q < ptr[k][i + 1]; q++)
                assert_int_equal(m->node_material[node[k][q]], m->node_material[i]);
    assert_int_equal(m->material_count, 2);
    assert_true(m->tie_count > 0);
    fixture_free(&f);
}

static void a_model_whose_layers_are_out_of_order_is_refused(void **state) {
    fixture f;
    sf_error err = SF_ERROR_INIT;
    (void)state;
    build_block(&JITTERED, flat, 2, &f);
    assert_int_equal(sf_model_check(&f.model, &err), SF_OK);
    f.model.node_material[1] = 1;
    assert_int_equal(sf_model_check(&f.model, &err), SF_ERR_MODEL);
    assert_non_null(strstr(err.text, "node 2 is of material 0, after one of 1: they must ascend"));
    fixture_free(&f);
}

static void the_hash_of_a_mesh_knows_its_layers(void **state) {
    sf_mesh mesh;
    char one[17], other[17];
    (void)state;
    fixture_block_mesh(&JITTERED, &mesh);
    layers_assign(&JITTERED, flat, &mesh);
    sf_cloud_hash(&mesh, one);
    mesh.cell_layer[mesh.cell_count - 1] ^= 1;
    sf_cloud_hash(&mesh, other);
    assert_string_not_equal(one, other);
    sf_mesh_free(&mesh);
}

static void nodes_of_an_interface_exist_once_per_layer(void **state) {
    fixture f;
    (void)state;
    build_block(&JITTERED, flat, 2, &f);
    assert_int_equal(f.model.node_count, 7 * 6 * 6 + 7 * 6);
    assert_int_equal(f.model.tie_count, 5 * 4); /* those on the sides are held on both */
    fixture_free(&f);
}

static void junction_of_three_layers_is_a_chain_of_ties(void **state) {
    fixture f;
    (void)state;
    build_block(&JITTERED, junction, 3, &f);
    /* inner nodes: of the plane z = 2, 5 x 4, one of whose lines has a third layer; of the plane x = 3, 2
     * more heights */
    assert_int_equal(f.model.tie_count, 5 * 4 + 4 + 2 * 4);
    fixture_free(&f);
}

/* A thin core between two parts of one layer. */
static int core(const double x[3]) {
    return x[2] > 2 && x[2] < 3;
}

/* What the other layer fills is no gap; a slit through both is one. */
static void gaps_are_those_of_the_whole_pad(void **state) {
    const fixture_block block = {.cells = {6, 5, 5}, .spacing = 0.01};
    (void)state;
    for (int slit = 0; slit < 2; slit++) {
        fixture f;
        sf_case c;
        sf_mesh mesh;
        sf_surface surface;
        fixture_block_mesh(&block, &mesh);
        layers_assign(&block, core, &mesh);
        if (slit)
            fixture_open_slit(&block, 3, 1, 0.002, &mesh);
        layers_case(&c, NULL, BASE, 2);
        c.self_contact = SF_SELF_CONTACT_OFF;
        fixture_plate(1, 0, 0, &surface);
        fixture_build(&c, &mesh, &surface, &f);
        assert_int_equal(f.report.domains.hidden_count > 0, slit);
        assert_int_equal(f.model.slit_fraction > 0, slit);
        assert_true(!slit || fabs(f.report.domains.hidden_distance - 0.002) < 1e-9);
        fixture_free(&f);
    }
}

/* ---- patch test ---- */

static const struct {
    layering layer;
    int count;
} PATCHES[] = {{flat, 2}, {stepped, 2}, {junction, 3}, {inclusion, 2}};

static void affine_field_across_interfaces_is_in_equilibrium(void **state) {
    (void)state;
    for (size_t k = 0; k < sizeof PATCHES / sizeof *PATCHES; k++) {
        fixture f;
        build_block(&JITTERED, PATCHES[k].layer, PATCHES[k].count, &f);
        fixture_start(&f);
        fixture_set_affine(&f, GRADIENT, SHIFT);
        fixture_forces(&f);
        for (int64_t i = 0; i < f.model.node_count; i++)
            for (int q = 0; q < 9; q++)
                assert_close(f.state.f[9 * i + q], GRADIENT[q] + (q % 4 == 0), 1e-12);
        assert_close(fixture_held_acceleration(&f, &f.operators.constraint), 0, 1e-10);
        fixture_free(&f);
    }
}

static void without_ties_the_patch_test_fails(void **state) {
    fixture f;
    (void)state;
    build_block(&JITTERED, stepped, 2, &f);
    f.model.tie_count = 0;
    fixture_start(&f);
    fixture_set_affine(&f, GRADIENT, SHIFT);
    fixture_forces(&f);
    assert_true(fixture_held_acceleration(&f, &f.operators.constraint) > 1e-2);
    fixture_free(&f);
}

/* A layer of negative viscosity beside one of a larger positive one: the viscous work of the pad is positive
 * at every step, and yet single nodes give energy back. */
static void what_single_nodes_give_back_is_seen_behind_the_pads_sum(void **state) {
    const fixture_block block = {.cells = {6, 5, 5}, .spacing = 0.01};
    static const double sign[] = {-0.01, 1};
    sf_case c;
    fixture f;
    (void)state;
    layers_case(&c, NULL, BASE, 2);
    layers_under_plate(&c, &block, flat, &f);
    for (int wrong = 0; wrong < 2; wrong++) {
        for (int k = 0; k < 2; k++) {
            sf_foam_shared *card = &sf_foam_card_of(&f.model.material[k])->shared;
            card->damp = card->maxwell_modulus = card->rate_factor = 0;
            card->kelvin_viscosity = 200 * (wrong ? sign[k] : 1);
        }
        fixture_start(&f);
        double least = 0;
        for (int step = 0; step < 200; step++) {
            fixture_advance(&f);
            least = smaller(least, f.state.ledger.viscous);
            double lost = 0;
            for (int64_t i = 0; i < f.model.node_count; i++)
                lost += larger(0, -f.state.viscous_work[i]) + larger(0, -f.state.pair_work[i]);
            assert_true(f.state.given_back >= lost * (1 - 1e-12));
        }
        assert_true(f.state.ledger.viscous > 1e-3 * f.state.ledger.reference);
        assert_true(least == 0);
        assert_int_equal(f.state.given_back > 1e-3 * f.state.ledger.viscous, wrong);
    }
    fixture_free(&f);
}

/* ---- sliding ---- */

static void start_sliding(layering layer, fixture *f) {
    const fixture_block block = {.cells = {6, 5, 5}, .spacing = 0.01};
    sf_case c;
    layers_case(&c, NULL, BASE, 2);
    layers_join(&c, 1, 0, SF_INTERFACE_SLIDING, 0);
    layers_under_plate(&c, &block, layer, f);
    fixture_start(f);
}

/* Adds the reaction's part in the motion: what the constraints leave of a velocity field of the upper layer.
 */
static double kept_velocity(fixture *f, int axis) {
    sf_state *s = &f->state;
    memset(s->force, 0, 3 * (size_t)f->model.node_count * sizeof *s->force);
    for (int64_t i = 0; i < f->model.node_count; i++)
        for (int c = 0; c < 3; c++)
            s->v[3 * i + c] = f->model.node_material[i] == 1 && c == axis;
    sf_constraint_step step = {.force = s->force, .v = s->v, .dt = 1e-5, .reaction = s->reaction};
    sf_constraint_project(&f->operators.constraint, &step);
    double least = 1;
    for (int64_t i = 0; i < f->model.node_count; i++)
        if (f->model.node_material[i] == 1)
            least = smaller(least, 1 - s->reaction[3 * i + axis] * step.dt / f->model.mass[i]);
    return least;
}

static void sliding_layers_are_free_along_their_interface_and_tied_across_it(void **state) {
    fixture f;
    (void)state;
    start_sliding(flat, &f);
    assert_int_equal(f.model.tie_mask[0], SF_FIX_Z);
    assert_close(kept_velocity(&f, 0), 1, 1e-12);
    assert_close(kept_velocity(&f, 1), 1, 1e-12);
    assert_true(kept_velocity(&f, 2) < 0.9);
    assert_true(f.report.hold.slides[0] && f.report.hold.slides[1] && f.report.hold.turns);
    assert_false(f.report.hold.lifts);
    fixture_free(&f);
}

/* The edges of a step hold the components of each of its faces. */
static void sliding_steps_hold_each_other_along_their_faces(void **state) {
    fixture f;
    (void)state;
    start_sliding(stepped, &f);
    for (int axis = 0; axis < 3; axis++)
        assert_true(kept_velocity(&f, axis) < 0.9);
    assert_false(f.report.hold.slides[0] || f.report.hold.slides[1] || f.report.hold.turns);
    fixture_free(&f);
}

/* The sentence about a block of two layers that slide, held by its group `held`. */
static sf_error refusal_of(const fixture_block *block, layering layer, const char *held) {
    sf_error err = SF_ERROR_INIT;
    sf_case c;
    sf_mesh mesh;
    sf_surface surface;
    sf_model m;
    sf_build_report report;
    fixture_block_mesh(block, &mesh);
    layers_assign(block, layer, &mesh);
    layers_case(&c, NULL, (const char *const[]){held, NULL}, 2);
    layers_join(&c, 1, 0, SF_INTERFACE_SLIDING, 0);
    fixture_plate(1, 0, 0, &surface);
    if (sf_model_build(&c, &mesh, &surface, &m, &report, NULL, &err) == SF_OK)
        sf_hold_check(&report.hold, false, &m, &err);
    sf_model_free(&m);
    sf_surface_free(&surface);
    sf_mesh_free(&mesh);
    sf_case_free(&c);
    return err;
}

/* Two parts of A with B between them; the second does not reach the plane x = 0. */
static int parted(const double x[3]) {
    return !(x[1] < 1 || (x[1] > 4 && x[0] > 1));
}

/* B is held, and so is one part of A. */
static void loose_part_of_a_layer_is_refused(void **state) {
    const fixture_block even = {.cells = {6, 5, 5}, .spacing = 0.01};
    (void)state;
    sf_error loose = refusal_of(&even, parted, "plane_x");
    assert_int_equal(loose.status, SF_ERR_INPUT);
    assert_non_null(strstr(loose.text, "nothing keeps the part of the layer \"A\" about (35, 45, 25) mm"));
    assert_int_equal(refusal_of(&even, parted, "base").status, SF_OK);
}

static void sliding_interfaces_that_cannot_be_held_are_refused(void **state) {
    const fixture_block even = {.cells = {6, 5, 5}, .spacing = 0.01};
    (void)state;
    sf_error bent = refusal_of(&JITTERED, flat, "base");
    assert_int_equal(bent.status, SF_ERR_INPUT);
    assert_non_null(strstr(bent.text, "the interface of \"A\" and \"B\" at ("));
    assert_non_null(strstr(bent.text, "is not normal to x, y or z"));
    sf_error loose = refusal_of(&even, beside, "plane_x");
    assert_int_equal(loose.status, SF_ERR_INPUT);
    assert_non_null(strstr(loose.text, "nothing keeps the layer \"B\" from being lifted or tilted"));
}

/* ---- series compression ---- */

/* Strain of the second material at the same stress. */
static double partner_strain(const sf_model *m, double strain) {
    double stress = layers_stress(&m->material[0], strain), low = 0, high = 0.9;
    for (int k = 0; k < 60; k++) {
        double middle = 0.5 * (low + high);
        *(layers_stress(&m->material[1], middle) < stress ? &low : &high) = middle;
    }
    return 0.5 * (low + high);
}

/* Two foams, the second three times as stiff, on a base; free sides. */
static void start_pair(fixture *f) {
    const fixture_block block = {.cells = {3, 3, 6}, .spacing = 0.01};
    sf_case c;
    layers_case(&c, NULL, (const char *const[]){"base", "top", NULL}, 2);
    layers_make_elastic(&c.layer[0], 1);
    layers_make_elastic(&c.layer[1], 3);
    layers_under_plate(&c, &block, flat, f);
    fixture_start(f);
}

/* The exact solution has a kink at the interface; it is in the space of the layers' shape functions. */
static void strains_of_a_stack_jump_at_its_interface(void **state) {
    static const double STRAINS[] = {0.05, 0.5, 0.8};
    fixture f;
    (void)state;
    start_pair(&f);
    const sf_model *m = &f.model;
    for (int k = 0; k < 3; k++) {
        double strain[2] = {STRAINS[k], partner_strain(m, STRAINS[k])};
        for (int64_t i = 0; i < m->node_count; i++) {
            double z = m->position[3 * i + 2], beyond = larger(0, z - 3 * H);
            f.state.d[3 * i] = f.state.d[3 * i + 1] = 0;
            f.state.d[3 * i + 2] = -strain[0] * (z - beyond) - strain[1] * beyond;
        }
        fixture_forces(&f);
        for (int64_t i = 0; i < m->node_count; i++)
            assert_close(f.state.f[9 * i + 8], 1 - strain[m->node_material[i]], 1e-12);
        assert_close(fixture_held_acceleration(&f, &f.operators.constraint), 0, 1e-9);
        double stress = layers_stress(&m->material[0], STRAINS[k]) * 9 * H * H;
        assert_true(strain[1] < 0.9 * strain[0]);
        sf_constraint_step step = {
            .force = f.state.force, .v = f.state.v, .dt = 1e-5, .reaction = f.state.reaction};
        sf_constraint_project(&f.operators.constraint, &step);
        assert_close(step.all[2] / stress, 0, 1e-9); /* base and top */
    }
    fixture_free(&f);
}

/* ---- drops ---- */

typedef struct drop {
    double peak, severity; /* m s-2; integral of (a/g)^2.5, s */
    double energy_error, momentum_error, residual, penetration;
    double least_contact; /* of the impact energy, the lowest energy lost in contact */
    int64_t nodes;
} drop;

static void run_drop(fixture *f, drop *out) {
    const sf_model *m = &f->model;
    sf_state *s = &f->state;
    *out = (drop){.nodes = m->node_count};
    fixture_start(f);
    while (s->time < 0.03) {
        fixture_step(f);
        double a = sf_missile_reading(m, &s->missile);
        out->peak = larger(out->peak, a);
        out->severity += pow(a / 9.80665, 2.5) * s->dt;
        out->momentum_error = larger(out->momentum_error, fabs(s->ledger.momentum_error));
        out->residual = larger(out->residual, s->constraint_residual);
        out->penetration = larger(out->penetration, s->penetration);
        out->least_contact = smaller(out->least_contact, s->ledger.contact / s->ledger.reference);
        sf_step_advance(m, s);
    }
    out->energy_error = s->ledger.largest_error;
    print_message("%lld nodes: a_max %.3f g, severity %.4f s, energy %.1e, momentum %.1e, |G v| %.1e m/s, "
                  "penetration %.1e m, contact %.1e\n",
                  (long long)out->nodes, out->peak / 9.80665, out->severity, out->energy_error,
                  out->momentum_error, out->residual, out->penetration, out->least_contact);
}

/* A quarter of a pad of 160 x 160 x 60 mm under the hemisphere. `layer` NULL: one material. */
static void build_drop_on(int base, layering layer, int count, const double *factor, int sliding,
                          fixture *f) {
    const fixture_block block = {.cells = {8, 8, 6}, .spacing = 0.01};
    sf_case c;
    sf_mesh mesh;
    sf_surface surface;
    fixture_block_mesh(&block, &mesh);
    fixture_case(&c, NULL);
    fixture_hold(&c, BASE);
    c.base_rule = base;
    fixture_mirror(&c, 2);
    if (layer) {
        layers_assign(&block, layer, &mesh);
        layers_make(&c, count);
        for (int k = 0; k < count; k++) {
            sf_foam_card *card = sf_foam_card_of(&c.layer[k]);
            card->modulus *= factor[k];
            card->shared.density *= factor[k];
            for (int64_t p = 0; p < card->curves.curve_points; p++)
                card->curves.curve_stress[p] *= factor[k];
        }
        if (sliding)
            layers_join(&c, count - 1, count - 2, SF_INTERFACE_SLIDING, 0);
    }
    fixture_dome(0.08, 12, 0, 0, &surface);
    fixture_build(&c, &mesh, &surface, f);
}

static void build_drop(layering layer, int count, const double *factor, int sliding, fixture *f) {
    build_drop_on(SF_BASE_GLUED, layer, count, factor, sliding, f);
}

static void assert_balanced(const drop *d) {
    assert_close(d->energy_error, 0, 2e-4);
    assert_close(d->momentum_error, 0, 1e-12);
    assert_close(d->residual, 0, 1e-11);
    assert_close(d->penetration, 0, 2e-5);
    assert_true(d->least_contact > -1e-4);
}

static const double EQUAL[] = {1, 1, 1}, STIFFENING[] = {3, 1, 4};

/* Below, middle and a cover of one cell. */
static int sandwich(const double x[3]) {
    return x[2] < 2 ? 0 : x[2] < 5 ? 1 : 2;
}

static void stack_of_equal_layers_gives_the_drop_of_one(void **state) {
    fixture f;
    drop one, two, three;
    (void)state;
    build_drop(NULL, 1, EQUAL, 0, &f);
    run_drop(&f, &one);
    fixture_free(&f);
    build_drop(flat, 2, EQUAL, 0, &f);
    run_drop(&f, &two);
    fixture_free(&f);
    build_drop(sandwich, 3, EQUAL, 0, &f);
    run_drop(&f, &three);
    fixture_free(&f);
    assert_balanced(&two);
    assert_balanced(&three);
    assert_close(two.peak / one.peak, 1, 0.003);
    assert_close(two.severity / one.severity, 1, 0.003);
}

static void drops_on_layers_keep_energy_and_momentum(void **state) {
    static const struct {
        layering layer;
        int count, sliding;
    } rows[] = {{sandwich, 3, 0}, {sandwich, 3, 1}, {beside, 2, 0}, {beside, 2, 1}};
    (void)state;
    for (int k = 0; k < 4; k++) {
        fixture f;
        drop d;
        build_drop(rows[k].layer, rows[k].count, STIFFENING, rows[k].sliding, &f);
        run_drop(&f, &d);
        fixture_free(&f);
        assert_balanced(&d);
    }
}

/* Missile and anvil act on the copies of a seam as on one point: neither side of it runs away from them, and
 * the contact gives no energy. */
static void contact_on_a_seam_is_that_of_one_pad(void **state) {
    static const int bases[] = {SF_BASE_GLUED, SF_BASE_RESTING};
    static const double frictions[] = {0, 0.5};
    (void)state;
    for (int k = 0; k < 4; k++) {
        fixture f;
        drop d[2];
        for (int parts = 1; parts <= 2; parts++) {
            build_drop_on(bases[k / 2], parts == 2 ? beside : NULL, parts, EQUAL, 0, &f);
            f.model.missile.friction = f.model.anvil.friction = frictions[k % 2];
            run_drop(&f, &d[parts - 1]);
            fixture_free(&f);
        }
        assert_balanced(&d[1]);
        assert_close(d[1].penetration, 0, 5e-6);
        assert_close(d[1].peak / d[0].peak, 1, 0.003);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(no_list_reaches_across_an_interface),
        cmocka_unit_test(a_model_whose_layers_are_out_of_order_is_refused),
        cmocka_unit_test(the_hash_of_a_mesh_knows_its_layers),
        cmocka_unit_test(nodes_of_an_interface_exist_once_per_layer),
        cmocka_unit_test(junction_of_three_layers_is_a_chain_of_ties),
        cmocka_unit_test(gaps_are_those_of_the_whole_pad),
        cmocka_unit_test(affine_field_across_interfaces_is_in_equilibrium),
        cmocka_unit_test(without_ties_the_patch_test_fails),
        cmocka_unit_test(what_single_nodes_give_back_is_seen_behind_the_pads_sum),
        cmocka_unit_test(sliding_layers_are_free_along_their_interface_and_tied_across_it),
        cmocka_unit_test(sliding_steps_hold_each_other_along_their_faces),
        cmocka_unit_test(loose_part_of_a_layer_is_refused),
        cmocka_unit_test(sliding_interfaces_that_cannot_be_held_are_refused),
        cmocka_unit_test(strains_of_a_stack_jump_at_its_interface),
        cmocka_unit_test(stack_of_equal_layers_gives_the_drop_of_one),
        cmocka_unit_test(drops_on_layers_keep_energy_and_momentum),
        cmocka_unit_test(contact_on_a_seam_is_that_of_one_pad),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
