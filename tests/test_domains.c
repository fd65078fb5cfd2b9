/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The identities of the smoothed gradient on the real graded pad (quarter, 5 mm) and on a jittered block, and
 * the supports that grow where a cloud is too sparse. Everything is measured here, not by
 * pre/cloud/domains.c.
 */
#include "extreme.h"
#include "model_fixture.h"

#include "pre/cloud/cloud.h"
#include <math.h>
#include <omp.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <cmocka.h>

#include "post_check.h"

static const double BOUND = 1e-11;
static const double CONDITION_LIMIT = 1e4;

typedef struct cloud {
    sf_mesh mesh;
    sf_dual dual;
    sf_domains domains;
    double *spacing, *support;
    double volume;    /* m3, of the body */
    uint8_t *surface; /* [n] 1: on the boundary */
} cloud;

enum { BLOCK, PAD, CLOUDS };

static sf_status cloud_domains(cloud *c, double ratio, double limit, sf_error *err) {
    for (int64_t i = 0; i < c->mesh.node_count; i++)
        c->support[i] = ratio * c->spacing[i];
    return sf_domains_build(&c->mesh, &c->dual, limit, c->support, &c->domains, err);
}

/* All but the domains; the mesh moves in. */
static void cloud_take(cloud *c, sf_mesh *mesh) {
    sf_error err = SF_ERROR_INIT;
    *c = (cloud){.mesh = *mesh};
    unsigned long n = (unsigned long)mesh->node_count;
    c->spacing = sf_alloc(&err, n, sizeof *c->spacing, "spacing");
    c->support = sf_alloc(&err, n, sizeof *c->support, "support");
    c->surface = sf_alloc(&err, n, 1, "surface");
    if (err.status != SF_OK || sf_cloud_reorder(&c->mesh, &err) != SF_OK ||
        sf_dual_build(&c->mesh, &c->dual, &err) != SF_OK)
        fail_msg("%s", err.text);
    sf_cloud_spacing(&c->mesh, &c->dual, c->spacing);
    for (int64_t f = 0; f < c->dual.face_count; f++)
        for (int v = 0; v < c->dual.face[f].size; v++)
            c->surface[c->dual.face[f].node[v]] = 1;
    for (int64_t k = 0; k < c->mesh.cell_count; k++)
        c->volume += sf_mesh_cell_volume(&c->mesh, k);
}

static void cloud_block(cloud *c, const fixture_block *block) {
    sf_mesh mesh;
    fixture_block_mesh(block, &mesh);
    cloud_take(c, &mesh);
}

static void cloud_free(cloud *c) {
    sf_domains_free(&c->domains);
    sf_dual_free(&c->dual);
    sf_mesh_free(&c->mesh);
    free(c->spacing);
    free(c->support);
    free(c->surface);
}

static int set_up(void **state) {
    cloud *c = calloc(CLOUDS, sizeof *c);
    sf_error err = SF_ERROR_INIT;
    const fixture_block block = {.cells = {8, 7, 6}, .spacing = 0.005, .jitter = 0.25, .surface_jitter = 0.2};
    cloud_block(&c[BLOCK], &block);
    sf_case example;
    sf_mesh mesh;
    sf_surface surface;
    fixture_case(&example, NULL);
    fixture_geometry(&example, &mesh, &surface);
    sf_surface_free(&surface);
    sf_case_free(&example);
    cloud_take(&c[PAD], &mesh);
    for (int k = 0; k < CLOUDS; k++)
        if (cloud_domains(&c[k], 1.4, CONDITION_LIMIT, &err) != SF_OK)
            fail_msg("%s", err.text);
    *state = c;
    return 0;
}

static int tear_down(void **state) {
    cloud *c = *state;
    for (int k = 0; k < CLOUDS; k++)
        cloud_free(&c[k]);
    free(c);
    return 0;
}

/* Sum over the row of B (times X - X_i, if `linear`), at its worst against zero or the identity. */
static double worst_row(const cloud *c, bool linear) {
    const sf_domains *d = &c->domains;
    double worst = 0;
    for (int64_t i = 0; i < c->mesh.node_count; i++) {
        double sum[3][3] = {{0}};
        for (int64_t k = d->ptr[i]; k < d->ptr[i + 1]; k++)
            for (int r = 0; r < (linear ? 3 : 1); r++)
                for (int q = 0; q < 3; q++)
                    sum[r][q] += d->b[3 * k + q] * (linear ? c->mesh.position[3 * (int64_t)d->node[k] + r] -
                                                                 c->mesh.position[3 * i + r]
                                                           : c->spacing[i]);
        for (int r = 0; r < (linear ? 3 : 1); r++)
            for (int q = 0; q < 3; q++)
                worst = larger(worst, fabs(sum[r][q] - (linear && r == q)));
    }
    return worst;
}

static void smoothed_gradients_of_a_constant_vanish(void **state) {
    const cloud *c = *state;
    for (int k = 0; k < CLOUDS; k++)
        assert_close(worst_row(&c[k], false), 0, BOUND);
}

static void smoothed_gradients_of_the_coordinates_are_the_identity(void **state) {
    const cloud *c = *state;
    for (int k = 0; k < CLOUDS; k++)
        assert_close(worst_row(&c[k], true), 0, BOUND);
}

static void shape_functions_at_the_nodes_reproduce_linear_fields(void **state) {
    const cloud *c = *state;
    for (int k = 0; k < CLOUDS; k++) {
        const sf_domains *d = &c[k].domains;
        for (int64_t i = 0; i < c[k].mesh.node_count; i++) {
            double sum = 0, moment[3] = {0};
            for (int64_t q = d->phi_ptr[i]; q < d->phi_ptr[i + 1]; q++) {
                sum += d->phi_value[q];
                for (int r = 0; r < 3; r++)
                    moment[r] += d->phi_value[q] * (c[k].mesh.position[3 * (int64_t)d->phi_node[q] + r] -
                                                    c[k].mesh.position[3 * i + r]);
            }
            assert_close(sum, 1, BOUND);
            for (int r = 0; r < 3; r++)
                assert_close(moment[r] / c[k].spacing[i], 0, BOUND);
        }
    }
}

static void domain_volumes_sum_to_the_body(void **state) {
    const cloud *c = *state;
    const double exact[CLOUDS] = {[BLOCK] = 8 * 7 * 6 * 125e-9, [PAD] = 0.2 * 0.2 * 0.05};
    for (int k = 0; k < CLOUDS; k++) {
        double sum = 0;
        for (int64_t i = 0; i < c[k].mesh.node_count; i++) {
            assert_true(c[k].domains.volume[i] > 0);
            sum += c[k].domains.volume[i];
        }
        assert_relative(sum, c[k].volume, 1e-12);
        assert_relative(sum, exact[k], 1e-11);
    }
}

/* Sum over the domains of V B_I, for every node I: [n][3]. */
static double *telescoped(const cloud *c) {
    const sf_domains *d = &c->domains;
    double *sum = calloc(3 * (size_t)c->mesh.node_count, sizeof *sum);
    assert_non_null(sum);
    for (int64_t l = 0; l < c->mesh.node_count; l++)
        for (int64_t k = d->ptr[l]; k < d->ptr[l + 1]; k++)
            for (int q = 0; q < 3; q++)
                sum[3 * (int64_t)d->node[k] + q] += d->volume[l] * d->b[3 * k + q];
    return sum;
}

/* Each internal facet enters its two domains with opposite signs: only the integral of phi N over the
 * boundary is left. */
static void internal_facets_cancel_and_leave_the_boundary_integral(void **state) {
    const cloud *c = *state;
    for (int k = 0; k < CLOUDS; k++) {
        const sf_domains *d = &c[k].domains;
        int64_t n = c[k].mesh.node_count;
        double *sum = telescoped(&c[k]), *boundary = calloc(3 * (size_t)n, sizeof *boundary);
        assert_non_null(boundary);
        sf_domains_boundary_integral(&c[k].mesh, &c[k].dual, d, boundary);
        for (int64_t i = 0; i < n; i++)
            for (int q = 0; q < 3; q++)
                assert_close((sum[3 * i + q] - boundary[3 * i + q]) / (c[k].spacing[i] * c[k].spacing[i]), 0,
                             BOUND);
        free(sum);
        free(boundary);
    }
}

static void boundary_integral_satisfies_the_divergence_theorem(void **state) {
    const cloud *c = *state;
    for (int k = 0; k < CLOUDS; k++) {
        double *sum = telescoped(&c[k]), closed[3] = {0}, moment[3][3] = {{0}};
        bool *reached = calloc((size_t)c[k].mesh.node_count, sizeof *reached);
        const sf_domains *d = &c[k].domains;
        assert_non_null(reached);
        for (int64_t i = 0; i < c[k].mesh.node_count; i++)
            for (int64_t q = d->phi_ptr[i]; q < d->phi_ptr[i + 1] && c[k].surface[i]; q++)
                reached[d->phi_node[q]] = true;
        int64_t inner = 0;
        for (int64_t i = 0; i < c[k].mesh.node_count; i++) {
            inner += !reached[i];
            for (int q = 0; q < 3; q++) {
                closed[q] += sum[3 * i + q];
                for (int r = 0; r < 3; r++)
                    moment[r][q] += c[k].mesh.position[3 * i + r] * sum[3 * i + q];
                if (!reached[i])
                    assert_close(sum[3 * i + q] / (c[k].spacing[i] * c[k].spacing[i]), 0, BOUND);
            }
        }
        assert_true(inner > 10);
        for (int r = 0; r < 3; r++) {
            assert_close(closed[r] / pow(c[k].volume, 2.0 / 3), 0, BOUND);
            for (int q = 0; q < 3; q++)
                assert_close(moment[r][q] / c[k].volume, r == q, BOUND);
        }
        free(sum);
        free(reached);
    }
}

/* The facets of a domain, with the boundary's, close: their area vectors add up to nothing. */
static void every_domain_is_closed(void **state) {
    const cloud *c = *state;
    for (int k = 0; k < CLOUDS; k++) {
        const sf_dual *dual = &c[k].dual;
        double *sum = calloc(3 * (size_t)c[k].mesh.node_count, sizeof *sum);
        assert_non_null(sum);
        for (int64_t e = 0; e < dual->edge_count; e++)
            for (int64_t u = dual->use_ptr[e]; u < dual->use_ptr[e + 1]; u++) {
                sf_facet_triangle t[2];
                sf_dual_facet(&c[k].mesh, &dual->use[u], t);
                for (int q = 0; q < 3; q++) {
                    sum[3 * (int64_t)dual->edge[2 * e] + q] += t[0].area[q] + t[1].area[q];
                    sum[3 * (int64_t)dual->edge[2 * e + 1] + q] -= t[0].area[q] + t[1].area[q];
                }
            }
        for (int64_t f = 0; f < dual->face_count; f++)
            for (int v = 0; v < dual->face[f].size; v++) {
                sf_facet_triangle t[2];
                double weight[2][4];
                sf_dual_boundary(&c[k].mesh, &dual->face[f], v, t, weight);
                for (int q = 0; q < 3; q++)
                    sum[3 * (int64_t)dual->face[f].node[v] + q] += t[0].area[q] + t[1].area[q];
            }
        for (int64_t i = 0; i < 3 * c[k].mesh.node_count; i++)
            assert_close(sum[i] / (c[k].spacing[i / 3] * c[k].spacing[i / 3]), 0, BOUND);
        free(sum);
    }
}

/* A regular lattice: h3 inside, half on faces, a quarter on edges, an eighth at corners; the spacing is h
 * everywhere. */
static void lattice_domains_are_cubes_and_their_parts(void **state) {
    (void)state;
    const fixture_block block = {.cells = {5, 4, 3}, .spacing = 0.005};
    sf_error err = SF_ERROR_INIT;
    cloud c;
    cloud_block(&c, &block);
    assert_int_equal(cloud_domains(&c, 1.4, CONDITION_LIMIT, &err), SF_OK);
    int64_t kinds[4] = {0};
    for (int64_t i = 0; i < c.mesh.node_count; i++) {
        int planes = 0;
        for (int q = 0; q < 3; q++) {
            double place = c.mesh.position[3 * i + q] / block.spacing;
            planes += place < 0.5 || place > block.cells[q] - 0.5;
        }
        kinds[planes]++;
        assert_relative(c.domains.volume[i], 125e-9 / (1 << planes), 1e-12);
        assert_relative(c.spacing[i], block.spacing, 1e-12);
    }
    assert_int_equal(kinds[0], 4 * 3 * 2);
    assert_int_equal(kinds[3], 8);
    assert_int_equal(c.domains.figures.enlarged_count, 0);
    cloud_free(&c);
}

/* Supports below the spacing leave points without neighbours: they grow until the identities hold. */
static void too_small_supports_are_enlarged(void **state) {
    (void)state;
    const fixture_block block = {.cells = {5, 5, 5}, .spacing = 0.005, .jitter = 0.2};
    sf_error err = SF_ERROR_INIT;
    cloud c;
    cloud_block(&c, &block);
    if (cloud_domains(&c, 0.8, CONDITION_LIMIT, &err) != SF_OK)
        fail_msg("%s", err.text);
    assert_true(c.domains.figures.enlarged_count > 0);
    assert_true(c.domains.figures.largest_enlargement > 1.1);
    double largest = 0;
    int64_t enlarged = 0;
    for (int64_t i = 0; i < c.mesh.node_count; i++) {
        largest = larger(largest, c.support[i] / (0.8 * c.spacing[i]));
        enlarged += c.support[i] > 0.8 * c.spacing[i] * (1 + 1e-12);
    }
    assert_relative(c.domains.figures.largest_enlargement, largest, 1e-12);
    assert_int_equal(c.domains.figures.enlarged_count, enlarged);
    assert_true(c.domains.figures.worst_condition <= CONDITION_LIMIT);
    assert_close(worst_row(&c, false), 0, BOUND);
    assert_close(worst_row(&c, true), 0, BOUND);
    cloud_free(&c);
}

/* A sheet a ten-thousandth of its spacing thick: no support makes the moment matrix well-conditioned. */
static void hopelessly_flat_cloud_is_refused_with_its_position(void **state) {
    (void)state;
    const fixture_block block = {.cells = {5, 5, 1}, .spacing = 0.005, .flatness = 1e-4};
    sf_error err = SF_ERROR_INIT;
    cloud c;
    cloud_block(&c, &block);
    assert_int_equal(cloud_domains(&c, 1.4, CONDITION_LIMIT, &err), SF_ERR_MODEL);
    assert_non_null(strstr(err.text, "stay ill-conditioned"));
    assert_non_null(strstr(err.text, "near ("));
    assert_null(c.domains.b); /* released on failure */
    cloud_free(&c);
}

static void domains_are_the_same_bits_for_any_thread_count(void **state) {
    const cloud *c = &((const cloud *)*state)[BLOCK];
    int threads = omp_get_max_threads();
    for (int count = 1; count <= 3; count++) {
        sf_error err = SF_ERROR_INIT;
        cloud again = *c;
        memset(&again.domains, 0, sizeof again.domains);
        omp_set_num_threads(count);
        assert_int_equal(cloud_domains(&again, 1.4, CONDITION_LIMIT, &err), SF_OK);
        size_t n = (size_t)c->mesh.node_count, entries = (size_t)c->domains.ptr[n];
        assert_int_equal(again.domains.ptr[n], c->domains.ptr[n]);
        assert_memory_equal(again.domains.node, c->domains.node, entries * sizeof *c->domains.node);
        assert_memory_equal(again.domains.b, c->domains.b, 3 * entries * sizeof *c->domains.b);
        assert_memory_equal(again.domains.volume, c->domains.volume, n * sizeof *c->domains.volume);
        sf_domains_free(&again.domains);
    }
    omp_set_num_threads(threads);
}

/* The model's masses: positive, density x volume in sum. */
static void lumped_masses_sum_to_density_times_volume(void **state) {
    (void)state;
    const fixture_block block = {.cells = {4, 4, 4}, .spacing = 0.01, .jitter = 0.25};
    fixture f;
    fixture_held_block(&block, &f);
    double sum = 0;
    for (int64_t i = 0; i < f.model.node_count; i++) {
        assert_true(f.model.mass[i] > 0);
        sum += f.model.mass[i];
    }
    assert_relative(sum, sf_foam_card_of(&f.model.material[0])->shared.density * 64e-6, 1e-12);
    fixture_free(&f);
}

/* The shares of the top's nodes add up to its area; inner ones of the lattice have a cell's face each. The
 * nodes of the sides, which the missile may touch, too, have shares of their own. */
static void contact_areas_tile_the_top(void **state) {
    (void)state;
    fixture f;
    fixture_pad((const char *const[]){"geometry.parameters.fine_spacing=10.0",
                                      "geometry.parameters.outer_spacing=20.0", NULL},
                &f);
    double sum = 0;
    int64_t whole = 0, sides = 0;
    for (int64_t k = 0; k < f.model.contact_count; k++) {
        double area = f.model.contact_area[k];
        bool top = f.model.position[3 * (int64_t)f.model.contact_node[k] + 2] > f.model.thickness - 1e-9;
        assert_true(area > 0);
        sum += top ? area : 0;
        whole += top && fabs(area - 1e-4) < 1e-12;
        sides += !top;
    }
    assert_true(fabs(sum - 0.2 * 0.2) < 1e-12);
    assert_true(whole >= 81); /* 9 x 9 inside the quarter's zone of 10 x 10 cells */
    assert_true(sides > 0);
    fixture_free(&f);
}

static void a_surface_knows_how_much_of_it_faces_the_missile(void **state) {
    static const double along[] = {-1, 0.45, 0.55, 1};
    const fixture_block block = {.cells = {4, 3, 2}, .spacing = 0.01};
    cloud c;
    sf_error err = SF_ERROR_INIT;
    (void)state;
    cloud_block(&c, &block);
    const sf_node_set *top = sf_mesh_find_set(&c.mesh, "top");
    assert_non_null(top);
    for (int k = 0; k < 4; k++) {
        const double direction[3] = {sqrt(1 - along[k] * along[k]), 0, along[k]};
        sf_surface_sides sides;
        assert_int_equal(sf_surface_find_sides(&c.mesh, &c.dual, top, direction, &sides, &err), SF_OK);
        assert_relative(sides.area, 0.04 * 0.03, 1e-12);
        assert_close(sides.facing / sides.area, larger(0, -along[k]), 1e-12);
    }
    cloud_free(&c);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(smoothed_gradients_of_a_constant_vanish),
        cmocka_unit_test(smoothed_gradients_of_the_coordinates_are_the_identity),
        cmocka_unit_test(shape_functions_at_the_nodes_reproduce_linear_fields),
        cmocka_unit_test(domain_volumes_sum_to_the_body),
        cmocka_unit_test(internal_facets_cancel_and_leave_the_boundary_integral),
        cmocka_unit_test(boundary_integral_satisfies_the_divergence_theorem),
        cmocka_unit_test(every_domain_is_closed),
        cmocka_unit_test(lattice_domains_are_cubes_and_their_parts),
        cmocka_unit_test(too_small_supports_are_enlarged),
        cmocka_unit_test(hopelessly_flat_cloud_is_refused_with_its_position),
        cmocka_unit_test(domains_are_the_same_bits_for_any_thread_count),
        cmocka_unit_test(lumped_masses_sum_to_density_times_volume),
        cmocka_unit_test(contact_areas_tile_the_top),
        cmocka_unit_test(a_surface_knows_how_much_of_it_faces_the_missile),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
