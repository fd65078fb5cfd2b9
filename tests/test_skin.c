/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What contact takes from a model: the edges of the pad's faces, the friction of each body, the side of a
 * symmetry plane. */
#include "solver/contact/pair.h"
#include "solver/contact/shapes.h"
#include "solver/contact/skin.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

enum { NODES = 6 };

/* A slit along x = y through the axis of a quarter: its two faces are triangles with an edge each on the
 * axis. The foam behind the first one (y > x) goes on beyond x = 0, that behind the second one beyond y = 0,
 * and both are wedges of 90 degrees. */
static void an_edge_on_the_axis_goes_on_beyond_the_plane_at_its_foam(void **state) {
    (void)state;
    double position[3 * NODES] = {0, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1, 1, 1, 0},
                        spacing[NODES] = {1, 1, 1, 1, 1, 1}, mass[NODES] = {1, 1, 1, 1, 1, 1},
                        phi[NODES] = {1, 1, 1, 1, 1, 1};
    int64_t start[NODES + 1] = {0, 1, 2, 3, 4, 5, 6};
    int32_t own[NODES] = {0, 1, 2, 3, 4, 5}, triangle[6] = {0, 1, 2, 3, 4, 5}, fixed[1] = {0};
    uint8_t half[2] = {0, 0}, mask[1] = {SF_FIX_X | SF_FIX_Y}, base[1] = {0};
    const sf_model model = {.node_count = NODES,
                            .position = position,
                            .spacing = spacing,
                            .mass = mass,
                            .thickness = 1,
                            .phi_ptr = start,
                            .phi_node = own,
                            .phi_value = phi,
                            .fixed_count = 1,
                            .fixed_node = fixed,
                            .fixed_mask = mask,
                            .fixed_base = base,
                            .skin_count = 2,
                            .skin_triangle = triangle,
                            .skin_half = half};
    sf_skin skin;
    sf_error err = SF_ERROR_INIT;
    assert_int_equal(sf_skin_build(&model, &skin, &err), SF_OK);
    assert_true(skin.facet_normal[0] > 0.7 && skin.facet_normal[3] < -0.7);
    assert_int_equal(skin.line_count, 2);
    assert_int_equal(skin.sharp_count, 2);
    for (int64_t k = 0; k < 2; k++) {
        int64_t slot =
            k == 0 ? 2 : 0; /* from the triangle's node at the top, or at the bottom, of the axis */
        assert_int_equal(skin.line[4 * (int64_t)skin.line_of[3 * k + slot] + 3], k == 0 ? -1 : -2);
    }
    sf_skin_free(&skin);
}

/* Of a resting pad the base and all other faces rub on the anvil alike; no other base has a coefficient. */
static void each_body_has_its_friction(void **state) {
    (void)state;
    double supports[2] = {0.4, 0.5};
    sf_model m = {.missile.friction = 0.1,
                  .anvil.friction = 0.2,
                  .skin_friction = 0.3,
                  .support_friction = supports,
                  .rest_count = 1};
    static const struct {
        int body;
        double friction;
    } of[] = {{SF_BODY_MISSILE, 0.1},    {SF_BODY_ANVIL, 0.2},    {SF_BODY_PAD, 0.3},
              {SF_BODY_SYMMETRY_X, 0},   {SF_BODY_SYMMETRY_Y, 0}, {SF_BODY_SUPPORT, 0.4},
              {SF_BODY_SUPPORT + 1, 0.5}};
    const sf_scene scene = {.model = &m};
    for (size_t k = 0; k < sizeof of / sizeof of[0]; k++) {
        const sf_contact_pair pair = {.body = of[k].body, .facet = SF_FIRST_BODY - of[k].body};
        assert_true(sf_pair_friction(&scene, &pair) == of[k].friction);
    }
    m.rest_count = 0;
    assert_true(sf_pair_friction(&scene, &(sf_contact_pair){.body = SF_BODY_ANVIL, .facet = SF_FIRST_BODY}) ==
                0.3);
}

/* The pad is on its side of a symmetry plane however narrow it is beside the spacing of its contact points.
 */
static void a_narrow_pad_is_on_its_side_of_the_plane(void **state) {
    (void)state;
    for (int side = -1; side <= 1; side += 2) {
        double position[6] = {0, 0, 0, side * 0.2, 0, 0}, spacing[2] = {1, 1};
        const double middle[3] = {side * 0.1, 0, 0};
        int32_t fixed[1] = {0}, contact[1] = {1};
        uint8_t mask[1] = {SF_FIX_X}, base[1] = {0};
        const sf_model m = {.node_count = 2,
                            .position = position,
                            .spacing = spacing,
                            .contact_count = 1,
                            .contact_node = contact,
                            .fixed_count = 1,
                            .fixed_node = fixed,
                            .fixed_mask = mask,
                            .fixed_base = base};
        double gap, normal[3];
        sf_body plane;
        sf_error err = SF_ERROR_INIT;
        assert_int_equal(sf_body_build(&m, SF_BODY_SYMMETRY_X, &plane, &err), SF_OK);
        assert_true(sf_body_gap(&plane, middle, &gap, normal) && gap > 0.09 && normal[0] == side);
        sf_body_free(&plane);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(an_edge_on_the_axis_goes_on_beyond_the_plane_at_its_foam),
        cmocka_unit_test(each_body_has_its_friction),
        cmocka_unit_test(a_narrow_pad_is_on_its_side_of_the_plane),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
